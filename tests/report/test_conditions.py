"""Conditions make the front: what is chosen under random conditions against brute force over all trials."""

import itertools
import json
import random
import re

import numpy as np
import pytest

import pareto_monoped as pm
from pareto_monoped.analysis.choices import choose, settled_front
from pareto_monoped.cli import _run as cli
from pareto_monoped.definition.study import study_from_dict
from pareto_monoped.errors import SelectionError
from pareto_monoped.measures import measure
from pareto_monoped.pareto.selectors import Among, Condition
from pareto_monoped.report.card import Source
from pareto_monoped.report.page import build, page
from pareto_monoped.report.resimulation import resimulate
from pareto_monoped.storage.reader import read_study
from pareto_monoped.study.run import run

SETS = pytest.mark.parametrize("sets", [15, pytest.param(500, marks=pytest.mark.long)])
"""How many sets of conditions are drawn."""
STUDIES = {
    "mechanical": {"seed": 1},
    "battery": {"seed": 2, "objectives": ["height_m", "electrical_energy_j"]},
    "light": {"seed": 3, "objectives": ["height_m", "mass_kg"]},
    "three": {"seed": 4, "objectives": ["height_m", "electrical_energy_j", "mass_kg"]},
    "cheap": {"seed": 5, "objectives": ["height_m", "energy_j", "cost_eur"]},
}
NAMES = ("height_m", "energy_j", "electrical_energy_j", "mass_kg", "efficiency", "cost_eur", "peak_power_knee_w",
         "drift_m", "knee_ratio", "thigh_length_m", "stiffness_n_per_m")  # fmt: skip


@pytest.fixture(scope="session")
def studies(tmp_path_factory, pytestconfig):
    """Five real studies of two and three objectives, without audits; those that long tests look at are larger."""
    folder = tmp_path_factory.mktemp("conditions")
    found, budget = {}, 150 if pytestconfig.getoption("markexpr") == "not long" else 300
    for name, changes in STUDIES.items():
        values = {"name": name, "case": "C", "evaluations": budget, "algorithm": {"name": "nsga2"}, "audit": False}
        found[name] = folder / f"{name}.db"
        run(study_from_dict(values | changes, source="test"), found[name], workers=2)
    return found


@pytest.fixture(scope="session")
def records(studies):
    """Every feasible trial of each study, as plain dictionaries."""
    return {
        name: [row for row in read_study(db).trials.to_dict(orient="records") if row["state"] == "feasible"]
        for name, db in studies.items()
    }


def drawn(rng, designs):
    """One to four conditions, near values that designs have, so that some sets can be met and others cannot."""
    found = {}
    for name in rng.sample(NAMES, rng.randint(1, 4)):
        values = sorted(one[name] for one in designs)
        side = rng.choice(["min", "max"])
        # Between two stored values that single precision, which the page has, tells apart.
        apart = [0.5 * (a + b) for a, b in itertools.pairwise(values) if b - a > 1e-6 * abs(b)]
        at = min(int(rng.random() ** 1.5 * len(apart)), len(apart) - 1)
        found[name] = (side, apart[at if side == "min" else -1 - at])
    return found


def meets(design, conditions):
    return all(
        design[name] >= value if side == "min" else design[name] <= value for name, (side, value) in conditions.items()
    )


def sign(name):
    return -1.0 if measure(name).direction == "maximise" else 1.0


def wanted_first(objectives, conditions):
    """The objective to be best in: the first without a condition, else the second; then the others in their order."""
    first = next((name for name in objectives if name not in conditions), objectives[1])
    return [first, *(name for name in objectives if name != first)]


def best(designs, objectives, conditions):
    able = [one for one in designs if meets(one, conditions)]
    order = wanted_first(objectives, conditions)
    return min(able, key=lambda one: [sign(name) * one[name] for name in order]) if able else None


def front_of(designs, objectives):
    """The designs that no other one betters, by the definition; of equal ones the first."""
    points = [[sign(name) * one[name] for name in objectives] for one in designs]
    return [
        one
        for i, (one, own) in enumerate(zip(designs, points, strict=True))
        if own not in points[:i]
        and not any(other != own and all(a <= b for a, b in zip(other, own, strict=True)) for other in points)
    ]


def sides(conditions):
    at_least = {name: value for name, (side, value) in conditions.items() if side == "min"}
    return at_least, {name: value for name, (side, value) in conditions.items() if side == "max"}


@SETS
def test_the_api_and_pick_answer_as_brute_force_over_all_trials(studies, records, capsys, sets):
    rng, refused = random.Random(12), 0
    stored = {name: pm.load_study(db) for name, db in studies.items()}
    for k in range(sets):
        name = list(STUDIES)[k % 5]
        designs, objectives = records[name], stored[name].study.objectives.names
        conditions = drawn(rng, designs)
        at_least, at_most = sides(conditions)
        answer = best(designs, objectives, conditions)
        command = ["pick", str(studies[name]), "--json"]
        command += [word for n, v in at_least.items() for word in ("--min", f"{n}={v!r}")]
        command += [word for n, v in at_most.items() for word in ("--max", f"{n}={v!r}")]
        if answer is None:
            refused += 1
            with pytest.raises(SelectionError, match="no stored design meets"):
                stored[name].pick(at_least=at_least, at_most=at_most)
            assert len(stored[name].front(at_least=at_least, at_most=at_most)) == 0
            continue
        assert stored[name].pick(at_least=at_least, at_most=at_most).trial == answer["trial"]
        able = [one for one in designs if meets(one, conditions)]
        extreme, how = rng.choice(NAMES), rng.choice(["least", "most"])
        if k % 3 == 0:
            found = stored[name].pick(at_least=at_least, at_most=at_most, **{how: extreme})
            assert found.trial == most_or_least(able, objectives, extreme, how)["trial"]
        if k % 7 == 0:
            assert cli(command) == 0
            assert json.loads(capsys.readouterr().out)["trial"] == answer["trial"]
            inside = stored[name].front(at_least=at_least, at_most=at_most)
            assert set(inside["trial"]) == {one["trial"] for one in front_of(able, objectives)}
    assert sets / 20 < refused < sets / 2


def weighted(designs, objectives, weights):
    """The weighted sum of each design, by trial, scaled to the extent of the whole front: less is better."""
    whole = front_of(designs, objectives)
    ends = {n: (min(one[n] for one in whole), max(one[n] for one in whole)) for n in objectives}
    return {
        one["trial"]: sum(
            w * sign(n) * (one[n] - ends[n][0]) / (ends[n][1] - ends[n][0])
            for n, w in zip(objectives, weights, strict=True)
        )
        for one in designs
    }


@pytest.mark.long
def test_choosers_on_the_front_within_are_scaled_to_the_whole_front(studies, records):
    """A condition that the answer meets never changes it; one that it misses brings the next best."""
    rng = random.Random(8)
    loaded = {name: pm.load_study(db) for name, db in studies.items()}
    for k in range(30):
        name = list(STUDIES)[k % 5]
        stored, designs = loaded[name], records[name]
        objectives = stored.study.objectives.names
        weights = [rng.choice([0.5, 1.0, 2.0]) for _ in objectives]
        costs = weighted(designs, objectives, weights)
        conditions = drawn(rng, designs)
        at_least, at_most = sides(conditions)
        able = [one for one in designs if meets(one, conditions)]
        if not able:
            continue
        found = stored.pick(weights=weights, at_least=at_least, at_most=at_most)
        assert costs[found.trial] == pytest.approx(min(costs[one["trial"]] for one in able), abs=1e-12)
        free = stored.pick(weights=weights)
        assert (found.trial == free.trial) == meets(free.row, conditions)


def test_a_refusal_offers_what_brute_force_finds(studies, records):
    rng, checked = random.Random(9), 0
    loaded = {name: pm.load_study(db) for name, db in studies.items()}
    for k in range(120):
        name = list(STUDIES)[k % 5]
        designs = records[name]
        conditions = drawn(rng, designs)
        if any(meets(one, conditions) for one in designs):
            continue
        at_least, at_most = sides(conditions)
        with pytest.raises(SelectionError) as caught:
            loaded[name].pick(at_least=at_least, at_most=at_most)
        offered = re.findall(r"(min|max) (\w+) = (\S+)", str(caught.value).partition("; met with ")[2])
        for side, about, value in offered:
            assert conditions[about][0] == side
            others = {n: one for n, one in conditions.items() if n != about}
            values = [one[about] for one in designs if meets(one, others)]
            assert any(meets(one, others | {about: (side, float(value))}) for one in designs)
            assert float(value) == pytest.approx(max(values) if side == "min" else min(values), rel=1e-4)
            checked += 1
    assert checked > 10


@pytest.fixture(scope="module")
def audited(tmp_path_factory):
    """A study whose front is audited."""
    db = tmp_path_factory.mktemp("audited") / "s.db"
    run(study_from_dict({"name": "audited", "case": "C", "evaluations": 120, "seed": 3}, source="test"), db, workers=2)
    return db


def brought(data):
    """Conditions whose best design is behind the whole front and has no audit yet."""
    front = set(data.front()["trial"])
    for share in np.linspace(0.2, 0.8, 13):
        mass = float(data.sound["mass_kg"].quantile(share))
        conditions = (Condition(name="mass_kg", side="max", value=mass),)
        inside = data.front(conditions=conditions)
        if len(set(inside["trial"]) - front) > 1 and int(inside["trial"].iloc[-1]) not in front:
            return conditions
    raise AssertionError("no conditions bring anything to the front")


def test_what_conditions_bring_to_the_front_is_audited_before_it_is_the_answer(audited, capsys):
    before = read_study(audited)
    conditions = brought(before)
    chosen = choose(before, Among(conditions=conditions), notify=print)
    assert chosen.picked.trial not in set(before.audits["trial"])
    after = read_study(audited)
    assert chosen.picked.trial in set(after.audits.loc[after.audits["well_conditioned"].astype(bool), "trial"])
    assert after.content_hash == before.content_hash
    assert cli(["verify", str(audited)]) == 0
    # A second question is answered from what is stored, and the whole front within can be asked for.
    assert choose(before, Among(conditions=conditions), notify=print).picked.trial == chosen.picked.trial
    front = settled_front(audited, conditions, notify=print)
    assert set(front["trial"]) <= set(read_study(audited).audits["trial"])
    assert "not audited" not in capsys.readouterr().out


def test_a_design_that_fails_its_audit_is_not_the_answer(audited, monkeypatch):
    """The audit of whatever is asked for first fails; the next best design by brute force is the answer."""
    from pareto_monoped.study import audits

    data = read_study(audited)
    conditions = (Condition(name="mass_kg", side="max", value=brought(data)[0].value * 1.01),)
    rows = data.sound[(data.sound["mass_kg"] <= conditions[0].value)]
    order = rows.sort_values(["height_m", "energy_j"], ascending=[False, True])["trial"].tolist()
    fails = set(order[:2])

    def failing(now, trials, store, simulator):
        store.set_audits([(int(n), int(n) not in fails, {"reason": "made to fail"}) for n in trials["trial"]])

    monkeypatch.setattr(audits, "audit_trials", failing)
    chosen = choose(pm.load_study(audited).data, Among(conditions=conditions), notify=print)
    left = [n for n in order if n not in set(read_study(audited).ill_conditioned.tolist())]
    assert chosen.picked.trial == left[0]


def test_a_study_that_asks_for_no_audits_gets_none(studies):
    data = read_study(studies["mechanical"])
    heaviest = float(data.sound["mass_kg"].median())
    choose(data, Among(conditions=(Condition(name="mass_kg", side="max", value=heaviest),)), notify=print)
    assert len(read_study(studies["mechanical"]).audits) == 0


PAGES = [("light",), ("cheap",), ("mechanical", "battery"), ("mechanical",), ("three",)]
FEW = 3
"""Pages that other than long tests open: of two, of three objectives, and of two studies."""


@pytest.fixture(scope="module")
def files(studies, tmp_path_factory, pytestconfig):
    """A page of each of ``PAGES``, without jumps."""
    folder, found = tmp_path_factory.mktemp("pages"), {}
    for names in PAGES[:FEW] if pytestconfig.getoption("markexpr") == "not long" else PAGES:
        data = [read_study(studies[name]) for name in names]
        sources = [Source(data=one, resimulation=resimulate(one, most_jumps=0), models={}) for one in data]
        found[names] = folder / f"{'_'.join(names)}.html"
        found[names].write_text(page(build(sources)), encoding="utf-8")
    return found


@pytest.mark.parametrize(
    "sets", [30, pytest.param(500, marks=pytest.mark.long)]
)  # a page costs more than its questions
@pytest.mark.browser
def test_the_page_answers_as_brute_force_over_all_trials_shown(files, records, studies, open_tab, sets):
    rng, refused, ways = random.Random(10), 0, ["", "", "knee", "compromise", "least", "most"]
    for names in files:
        tab = open_tab(files[names])
        tab.page.evaluate("scrollTo(0, document.body.scrollHeight)")  # charts out of sight are not drawn again
        objectives = pm.load_study(studies[names[0]]).study.objectives.names
        designs = [one | {"study": name} for name in names for one in records[name]]
        losses = {way: scaled_losses(designs, objectives, way) for way in ("knee", "compromise")}
        for _ in range(sets // len(files)):
            conditions, way = drawn(rng, designs), rng.choice(ways)
            extreme = rng.choice(NAMES)
            able = [one for one in designs if meets(one, conditions)]
            said = asked(tab, conditions, f"{way}:{extreme}" if way in ("least", "most") else way)
            if not able:
                refused += 1
                assert said.startswith("No stored design meets")
                continue
            inside = front_of(able, objectives)
            # The page has single precision, in which designs may be equal that differ in their sixteenth digit.
            single = [one | {name: float(np.float32(one[name])) for name in (*objectives, *NAMES)} for one in able]
            seen = front_of(single, objectives)
            if way == "":
                wanted = best(designs, objectives, conditions)
            elif way in losses:
                wanted = min(inside, key=lambda one: losses[way][one["study"], one["trial"]])
            else:
                wanted = most_or_least(single, objectives, extreme, way)
            of = f" of {wanted['study']}" if len(names) > 1 else ""
            assert said.startswith(f"Trial {wanted['trial']}{of}"), (names, conditions, way, extreme)
            count = (
                f"{len(able)} {'design meets' if len(able) == 1 else 'designs meet'} this, {len(seen)} on the front."
            )
            assert said.endswith(count)
        assert tab.complaints == []
    assert refused > sets / 20


def asked(tab, conditions, way):
    """What the page says to conditions and a way to choose that its address has."""
    parts = [f"range={name}:{value!r}:" if side == "min" else f"range={name}::{value!r}"
             for name, (side, value) in conditions.items()]  # fmt: skip
    fragment = "&".join(["view=1", *parts, *([f"best={way}"] if way else [])])
    return tab.page.evaluate(
        """(fragment) => new Promise((done) => {
            const told = () => done(document.getElementById("ask-answer").textContent);
            addEventListener("hashchange", told, { once: true });
            location.hash = fragment;
        })""",
        fragment,
    )


def most_or_least(designs, objectives, name, way):
    """The design with the most or the least of something; of equal ones the best in the objectives, in their order."""
    way = 1.0 if way == "least" else -1.0
    return min(designs, key=lambda one: [way * one[name], *(sign(n) * one[n] for n in objectives)])


def scaled_losses(designs, objectives, way):
    """The sum, or the root of the sum of squares, of each design's losses on the scale of the whole front."""
    whole = front_of(designs, objectives)
    found = {}
    for one in designs:
        losses = []
        for name in objectives:
            values = [sign(name) * other[name] for other in whole]
            losses.append((sign(name) * one[name] - min(values)) / (max(values) - min(values)))
        found[one["study"], one["trial"]] = sum(losses) if way == "knee" else sum(x * x for x in losses) ** 0.5
    return found

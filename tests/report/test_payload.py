import base64
import json
import math
import re
import struct
import zlib
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from pareto_monoped.analysis.choices import default_pick
from pareto_monoped.design import NAMES, PAPER_CASES, PAPER_NAMES
from pareto_monoped.pareto.pick import pick
from pareto_monoped.pareto.selectors import Knee
from pareto_monoped.report import page as page_module
from pareto_monoped.report import trials as trials_module
from pareto_monoped.report.card import Source
from pareto_monoped.report.packing import unpacked
from pareto_monoped.report.page import build, deflated
from pareto_monoped.robot.build import build_robot
from tests.report import conftest
from tests.report.conftest import cut, grown


def test_the_budget_is_that_of_the_last_run(source):
    """A study that was resumed with another total has it there, and the first one in its settings."""
    resumed = replace(source.data, meta=replace(source.data.meta, budget=777))
    assert build([replace(source, data=resumed)]).studies[0].budget == 777


def test_rows_are_the_trials(payload, data):
    (card,) = payload.studies
    assert card.trials.trial == data.trials["trial"].tolist()
    assert card.counts["total"] == card.trials.total == len(data.trials)
    np.testing.assert_allclose(
        np.array([card.trials.columns[n] for n in PAPER_NAMES], dtype=float).T,
        data.trials[list(PAPER_NAMES)],
        rtol=1e-4,
        atol=1e-9,
    )


def test_front_has_the_readers_designs_in_order(payload, data):
    (card,) = payload.studies
    assert [card.trials.trial[row] for row in card.front] == data.front()["trial"].tolist()
    heights = [card.trials.columns["height_m"][row] for row in card.front]
    assert heights == sorted(heights)


def test_first_pick_is_the_knee_of_the_pick_command(payload, data):
    (card,) = payload.studies
    by_name = {one.name: card.trials.trial[one.row] for one in card.picks}
    assert by_name["knee"] == pick(data.front(), Knee()).trial
    assert card.trials.trial[card.picks[0].row] == default_pick(data, [data]).trial != by_name["knee"]
    why = default_pick(data, [data]).why
    assert why.startswith("trial ")
    assert "): of the designs below 1.5 times the least battery energy, the knee, " in why


def test_masses_of_the_bodies_add_up_to_the_simulated_robot(payload):
    (card,) = payload.studies
    for at, row in enumerate(card.front):
        bodies = sum(card.more[f"{body}_kg"][at] for body in ("base", "thigh", "shank"))
        assert bodies == pytest.approx(card.trials.columns["mass_kg"][row], abs=3e-4)


def test_gearboxes_are_those_of_the_built_robot(payload, data):
    from pareto_monoped.design import Design

    (card,) = payload.studies
    for row in card.front:
        design = Design.from_array(data.trials.loc[row, list(NAMES)].to_numpy(dtype=float))
        robot = build_robot(design, data.case_kit)
        for joint, actuator in (("hip", robot.hip), ("knee", robot.knee)):
            gearbox = payload.gearboxes[card.trials.columns[f"{joint}_gearbox"][row]]
            assert (gearbox.sun_teeth, gearbox.ring_teeth) == (actuator.gears.sun_teeth, actuator.gears.ring_teeth)
            assert gearbox.family == actuator.family
            assert gearbox.mass_kg == pytest.approx(actuator.mass_kg, abs=1e-4)


def test_cases_come_with_their_jump(payload):
    (card,) = payload.studies
    assert [case.name for case in card.cases] == list(PAPER_CASES)
    assert list(card.case_jumps.keys) == list(range(len(card.cases)))
    for place, case in enumerate(card.cases):
        assert case.status == "ok"
        assert unpacked(card.case_jumps, place)["base_z_m"].max() == pytest.approx(case.height_m, abs=3e-4)


def test_a_page_of_many_trials_keeps_the_front_and_says_what_it_leaves_out(data, resimulation, monkeypatch):
    monkeypatch.setattr(trials_module, "MOST_ROWS", 300)
    big = grown(data, 900)
    (card,) = build([Source(data=big, resimulation=resimulation, models={})]).studies
    assert len(card.trials.trial) == 300
    assert card.trials.total == card.counts["total"] == 900
    assert [card.trials.trial[row] for row in card.front] == big.front()["trial"].tolist()
    assert card.counts["infeasible"] == int((big.trials["state"] == "infeasible").sum())


def test_each_set_of_rules_has_a_map_of_its_own(source, data):
    """Two studies of one motor share its map only if their gearboxes follow the same rules."""
    rated = replace(data, study=replace(data.study, rules="iso6336"))
    page = build([source, replace(source, data=rated), source])
    assert len(page.maps) == 2
    assert [card.kit for card in page.studies] == [0, 1, 0]


def test_same_names_get_labels_that_differ(source):
    other = replace(source, data=replace(source.data, db=Path("copy.db")))
    labels = page_module._labels([source, other, other])
    assert len(set(labels)) == 3
    assert all("small" in label for label in labels)


def test_what_is_embedded_reads_back_and_holds_no_markup(data, resimulation):
    nasty = "</script><script>alert(1)</script><!-- \u2028"
    study = replace(data.study, name=nasty)
    payload = build([Source(data=replace(data, study=study), resimulation=resimulation, models={})])
    text = deflated(payload)
    assert re.fullmatch(r"\d+ [A-Za-z0-9+/=]+", text)
    length, letters = text.split(" ")
    content = zlib.decompress(base64.b64decode(letters))
    (read,) = json.loads(content[int(length) :])["studies"]
    assert read["name"] == nasty
    # Every number stands where the rest says, in four bytes, or in two for a jump.
    (card,) = payload.studies
    for name, values in card.trials.columns.items():
        place = read["trials"]["columns"][name]
        if isinstance(place, list):
            assert place == list(values)
            continue
        expected = [math.nan if value is None else value for value in values]
        found = struct.unpack_from(f"<{place['count']}f", content, place["at"])
        assert found == pytest.approx(expected, rel=1e-6, nan_ok=True), name
    for name, packed in card.trials.packed.items():
        place = read["trials"]["packed"][name]
        found = struct.unpack_from(f"<{place['count']}f", content, place["at"])
        assert found == pytest.approx(conftest.unpacked(packed), nan_ok=True), name
    place, names = read["jumps"]["data"], list(card.jumps.counts)
    for at, trial in enumerate(card.jumps.keys):
        changes = np.frombuffer(content, "<i2", place["count"], place["at"]).reshape(-1, len(names), card.jumps.frames)
        counts = np.cumsum(changes[at, names.index("base_z_m")])
        heights_m = unpacked(card.jumps, trial)["base_z_m"]
        assert card.jumps.counts["base_z_m"] * counts[: len(heights_m)] == pytest.approx(heights_m)


@pytest.mark.parametrize("count", [0, 1])
def test_studies_with_nothing_to_choose_from_give_a_payload(data, resimulation, count):
    keep = np.zeros(len(data.trials), dtype=bool)
    keep[np.flatnonzero(data.trials["state"] == "feasible")[:count]] = True
    (card,) = build([Source(data=cut(data, keep), resimulation=replace(resimulation, jumps={}), models={})]).studies
    assert len(card.front) == count
    assert len(card.picks) == min(count, 1) or count == 1
    assert card.notes[0].startswith(f"Unfinished: {count} of ")


def test_weighted_runs_give_the_trial_of_least_cost(weighted):
    from pareto_monoped.report.resimulation import resimulate
    from pareto_monoped.storage.reader import read_study

    data = read_study(weighted)
    source = Source(data=data, resimulation=resimulate(data, most_jumps=1), models={})
    (card,) = build([source]).studies
    assert [weight for weight, _ in card.weighted] == [0.2, 0.6]
    scale = data.study.algorithm.height_scale_j
    for weight, row in card.weighted:
        run = data.trials[(data.trials["height_weight"] == weight) & (data.trials["state"] == "feasible")]
        costs = [
            weight * scale * np.exp(-h) + (1.0 - weight) * e
            for h, e in zip(run["height_m"], run["energy_j"], strict=True)
        ]
        assert card.trials.trial[row] == run["trial"].iloc[int(np.argmin(costs))]


def test_axes_are_what_trials_differ_in():
    columns = {"same": [1.0, 1.0], "one": [None, 2.0], "other": [1.0, 2.0], "motor": [0, 1]}
    card = SimpleNamespace(trials=SimpleNamespace(columns=columns, packed={}), robust=None)
    assert page_module._axes([card]) == ["other"]

"""Every way to choose against brute force on random fronts, and against pymoo."""

import math
import re
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pareto_monoped.errors import SelectionError
from pareto_monoped.pareto.objectives import HEIGHT_AND_ENERGY
from pareto_monoped.pareto.pick import pick
from pareto_monoped.pareto.selectors import (
    Among,
    Compromise,
    Condition,
    Extreme,
    Knee,
    MaxEnergy,
    Nearest,
    Tradeoff,
    Trial,
    Weights,
)
from pareto_monoped.pareto.trade_offs import NEIGHBOURHOOD, tradeoff
from tests.pareto.fronts import THREE, fronts, losses, not_dominated


def meets(record, condition):
    value = record[condition.name]
    return value >= condition.value if condition.side == "min" else value <= condition.value


def chosen(front, selector, objectives):
    """The picked row by its trial; the scores of all designs decide whether it is a right one."""
    trial = pick(front, selector, objectives).trial
    return int(np.flatnonzero(front["trial"] == trial)[0])


@pytest.mark.parametrize("objectives", [HEIGHT_AND_ENERGY, THREE], ids=["two", "three"])
@given(data=st.data())
def test_choosers_agree_with_brute_force(objectives, data):
    front = not_dominated(data.draw(fronts(objectives)), objectives)
    loss, m = losses(front, objectives), len(objectives.names)
    row = chosen(front, Compromise(values=(1.0, 2.0, 0.5)[:m]), objectives)
    distance = [math.sqrt(sum((w * x) ** 2 for w, x in zip((1.0, 2.0, 0.5), one, strict=False))) for one in loss]
    assert distance[row] == pytest.approx(min(distance), abs=1e-12)
    row = chosen(front, Weights(values=(1.0, 2.0, 0.5)[:m]), objectives)
    total = [sum(w * x for w, x in zip((1.0, 2.0, 0.5), one, strict=False)) for one in loss]
    assert total[row] == pytest.approx(min(total), abs=1e-12)
    row = chosen(front, Tradeoff(), objectives)
    worth = [bargain(loss, i) for i in range(len(loss))]
    assert worth[row] == pytest.approx(max(worth), rel=1e-9)


def bargain(loss, i):
    """The least sacrifice per gain of a step to a neighbour, by its definition."""
    others = [j for j in range(len(loss)) if j != i]
    nearest = sorted(math.dist(loss[i], loss[j]) for j in others)[: 2 * len(loss[i])]
    near = [j for j in others if math.dist(loss[i], loss[j]) <= max([NEIGHBOURHOOD, *nearest]) + 1e-9]
    ratios = []
    for j in near:
        gain = sum(max(a - b, 0.0) for a, b in zip(loss[i], loss[j], strict=True))
        if gain > 0.0:
            ratios.append(sum(max(b - a, 0.0) for a, b in zip(loss[i], loss[j], strict=True)) / gain)
    return min(ratios, default=math.inf)


@given(front=fronts(), height=st.floats(0.4, 1.1), energy=st.floats(0.4, 1.1))
def test_the_nearest_has_the_least_greatest_shortfall(front, height, energy):
    row = chosen(front, Nearest(wish={"height_m": height, "energy_j": energy}), HEIGHT_AND_ENERGY)
    whole = not_dominated(front, HEIGHT_AND_ENERGY)
    extents = [np.ptp(whole[name]) or np.ptp(front[name]) or 1.0 for name in HEIGHT_AND_ENERGY.names]
    worst = [
        max((height - h) / extents[0], (e - energy) / extents[1])
        for h, e in zip(front["height_m"], front["energy_j"], strict=True)
    ]
    assert worst[row] == pytest.approx(min(worst), abs=1e-12)


def convex_front(n):
    height = np.linspace(0.6, 1.2, n)
    return pd.DataFrame({"trial": range(n), "height_m": height, "energy_j": 5.0 + 40.0 * (height - 0.6) ** 3})


def test_the_nearest_is_the_least_of_pymoos_achievement_function():
    from pymoo.decomposition.asf import ASF

    front = convex_front(60)
    values = HEIGHT_AND_ENERGY.minimised(front[["height_m", "energy_j"]].to_numpy())
    for wish in ((0.9, 3.0), (1.1, 10.0), (0.7, 30.0)):
        point = HEIGHT_AND_ENERGY.minimised(np.array(wish))
        scores = ASF().do(values, np.ptp(values, axis=0), utopian_point=point)
        picked = pick(front, Nearest(wish=dict(zip(HEIGHT_AND_ENERGY.names, wish, strict=True))))
        assert picked.trial == int(np.argmin(scores))


@pytest.mark.filterwarnings("ignore:Please import `cKDTree`:DeprecationWarning")  # pymoo's own import
def test_the_tradeoff_is_that_of_pymoo():
    """With many designs in every neighbourhood, pymoo's rule for few neighbours plays no part."""
    from pymoo.core.decision_making import NeighborFinder

    front = convex_front(200)
    loss = losses(front, HEIGHT_AND_ENERGY)
    finder = NeighborFinder(loss, epsilon=NEIGHBOURHOOD, n_min_neigbors="auto", consider_2d=False)
    worth = []
    for i in range(len(loss)):
        change = loss[[j for j in finder.find(i) if j != i]] - loss[i]
        worth.append(float((np.maximum(change, 0.0).sum(axis=1) / np.maximum(-change, 0.0).sum(axis=1)).min()))
    values = front[["height_m", "energy_j"]].to_numpy()
    scored = tradeoff(values, values, HEIGHT_AND_ENERGY)
    assert scored.score == pytest.approx(worth)
    assert pick(front, Tradeoff()).trial == int(np.argmax(worth))


def test_a_compromise_reaches_into_a_hollow_that_no_weighted_sum_reaches():
    """On a front that is bent inwards, weighted sums only ever choose an end."""
    front = pd.DataFrame({"trial": [1, 2, 3], "height_m": [0.6, 0.9, 1.2], "energy_j": [5.0, 28.0, 45.0]})
    assert {pick(front, Weights(values=(w, 1.0 - w))).trial for w in np.linspace(0.0, 1.0, 101)} == {1, 3}
    assert pick(front, Compromise(values=(1.0, 1.0))).trial == 2


CONDITIONS = st.lists(
    st.builds(
        Condition,
        name=st.sampled_from(["height_m", "energy_j", "mass_kg", "drift_m", "knee_ratio"]),
        side=st.sampled_from(["min", "max"]),
        value=st.integers(-1, 7).map(lambda k: 0.55 + 0.07 * k),
    ),
    min_size=1,
    max_size=4,
)


@given(front=fronts(), conditions=CONDITIONS)
def test_conditions_agree_with_brute_force(front, conditions):
    records = front.to_dict(orient="records")
    able = [record for record in records if all(meets(record, one) for one in conditions)]
    selector = Among(conditions=tuple(conditions))
    if not able:
        with pytest.raises(SelectionError) as caught:
            pick(front, selector)
        message = str(caught.value)
        assert "\n" not in message
        named = next(record for record in records if f"trial {record['trial']} " in message)
        assert shortfall(named, conditions, front) == pytest.approx(
            min(shortfall(record, conditions, front) for record in records)
        )
        said = re.findall(r"(min|max) (\w+) = (\S+)", message.partition("; met with ")[2])
        wanted = giving(records, conditions)
        assert [(side, name) for side, name, _ in said] == [(one.side, one.name) for one, _ in wanted]
        for (_, _, value), (one, best) in zip(said, wanted, strict=True):
            assert float(value) == pytest.approx(best, rel=2e-5)
            assert meets({one.name: best}, replace(one, value=float(value)))
        return
    limited = {one.name for one in conditions}
    if "height_m" not in limited:
        best = max(able, key=lambda record: (record["height_m"], -record["energy_j"]))
    else:
        best = min(able, key=lambda record: (record["energy_j"], -record["height_m"]))
    found = next(record for record in records if record["trial"] == pick(front, selector).trial)
    assert found in able
    assert [found[name] for name in HEIGHT_AND_ENERGY.names] == [best[name] for name in HEIGHT_AND_ENERGY.names]
    inside = not_dominated(pd.DataFrame(able), HEIGHT_AND_ENERGY)
    assert f"of the {len(inside)} designs" in pick(front, selector).why
    whole, by = not_dominated(front, HEIGHT_AND_ENERGY), inside.set_index("trial")
    loss = pd.Series(losses(inside, HEIGHT_AND_ENERGY, whole).sum(axis=1), index=by.index)
    for chooser in (Knee(), Weights(values=(1.0, 1.0))):
        trial = pick(front, Among(conditions=tuple(conditions), chooser=chooser)).trial
        assert loss[trial] == pytest.approx(loss.min(), abs=1e-12)
    assert pick(front, Among(conditions=tuple(conditions), chooser=Tradeoff())).trial in by.index
    least = pick(front, Among(conditions=tuple(conditions), chooser=Extreme(name="mass_kg", most=False))).trial
    best = min(able, key=lambda record: (record["mass_kg"], -record["height_m"], record["energy_j"]))
    same = [r["trial"] for r in able if all(r[n] == best[n] for n in ("mass_kg", "height_m", "energy_j"))]
    assert least in same


def giving(records, conditions):
    """What the message offers: conditions, each with the value that the others would leave, by plain Python."""
    offered = []
    for k, one in enumerate(conditions):
        others = [other for j, other in enumerate(conditions) if j != k]
        left = [record[one.name] for record in records if all(meets(record, other) for other in others)]
        if left:
            offered.append((one, max(left) if one.side == "min" else min(left)))
    return offered


def shortfall(record, conditions, front):
    """The greatest share of the front's extent by which a design misses a condition."""
    return max(
        max(one.value - record[one.name] if one.side == "min" else record[one.name] - one.value, 0.0)
        / (np.ptp(front[one.name]) or 1.0)
        for one in conditions
    )


def test_a_condition_does_not_change_what_is_near_on_a_front_of_one_design():
    """Shortfalls were scaled to the designs that meet the condition."""
    front = pd.DataFrame(
        {
            "trial": [100, 101, 103, 104],
            "energy_j": 0.55,
            "height_m": [0.83, 0.62, 0.76, 0.62],
            "mass_kg": [0.76, 0.55, 0.55, 0.9],
        }
    )
    wish = Nearest(wish={"height_m": 0.8, "mass_kg": 0.7})
    heavy = Condition(name="mass_kg", side="max", value=0.76)
    assert pick(front, wish).trial == pick(front, Among(conditions=(heavy,), chooser=wish)).trial


@given(front=fronts())
def test_a_condition_that_the_choice_meets_does_not_change_it(front):
    nearest = Nearest(wish={"height_m": 0.8, "mass_kg": 0.7})
    for chooser in (Knee(), Weights(values=(1.0, 1.0)), Compromise(values=(1.0, 2.0)), nearest):
        alone = pick(front, chooser)
        mass = float(front.loc[front["trial"] == alone.trial, "mass_kg"].iloc[0])
        condition = Condition(name="mass_kg", side="max", value=mass)
        assert pick(front, Among(conditions=(condition,), chooser=chooser)).trial == alone.trial


FRONT = pd.DataFrame(
    {
        "trial": [1, 2, 3],
        "height_m": [0.6, 0.9, 1.2],
        "energy_j": [5.0, 12.0, 45.0],
        "mass_kg": [3.9, 4.2, 4.0],
        "knee_ratio": [4.0, 6.1, np.nan],
    }
)


def test_the_reason_names_all_conditions():
    light = Condition(name="mass_kg", side="max", value=4.1)
    why = pick(FRONT, Among(conditions=(Condition(name="height_m", side="min", value=0.7), light))).why
    assert why == (
        "trial 3 (1.200 m on 45.00 J): the least energy of the 1 designs on the front that reach 0.7 m and have at "
        "most 4.1 kg of mass"
    )
    why = pick(FRONT, Among(conditions=(light, MaxEnergy(energy_j=40.0)), chooser=Knee())).why
    assert why.endswith(", of the 1 designs on the front that have at most 4.1 kg of mass and need at most 40 J")


def test_the_nearest_design_is_named_where_none_meets_all():
    conditions = (
        Condition(name="height_m", side="min", value=0.8, asked="min-height"),
        Condition(name="energy_j", side="max", value=11.0),
    )
    with pytest.raises(SelectionError) as caught:
        pick(FRONT, Among(conditions=conditions))
    assert str(caught.value) == (
        "min-height = 0.8 m, max energy_j = 11 J: no stored design meets all; the nearest is trial 2 (0.900 m "
        "on 12.00 J) with energy 12 J; met with min-height = 0.6 m (0.2 m less) or max energy_j = 12 J (1 J more), or "
        "run the study longer"
    )


def test_the_greatest_shortfall_decides_which_design_is_nearest():
    """Trial 1 misses both by 0.3 of the extents, trial 2 only one, by 0.5."""
    front = pd.DataFrame({"trial": [1, 2, 3, 4], "height_m": [0.7, 0.5, 1.0, 0.0], "mass_kg": [1.3, 1.0, 2.0, 1.0]})
    front["energy_j"] = [1.0, 2.0, 3.0, 0.0]
    conditions = (Condition(name="height_m", side="min", value=1.0), Condition(name="mass_kg", side="max", value=1.0))
    with pytest.raises(SelectionError, match="the nearest is trial 1 "):
        pick(front, Among(conditions=conditions))


@pytest.mark.parametrize(
    ("selector", "words"),
    [
        (Compromise(values=(1.0,)), ["compromise = 1", "two finite numbers"]),
        (
            Among(conditions=(Condition(name="mass_kg", side="max", value=4.1),), chooser=Trial(number=2)),
            ["trial = 2", "meets the conditions", "1, 3"],
        ),
        (
            Among(conditions=(Condition(name="knee_ratio", side="min", value=7.0),)),
            ["knee_ratio", "min knee_ratio = 6.1 (0.9 less)"],
        ),
    ],
)
def test_what_cannot_be_had_is_refused(selector, words):
    with pytest.raises(SelectionError) as caught:
        pick(FRONT, selector)
    for word in words:
        assert word in str(caught.value)


def test_a_design_without_a_value_never_meets_a_condition():
    assert pick(FRONT, Among(conditions=(Condition(name="knee_ratio", side="max", value=100.0),))).trial == 2


def test_a_wish_that_can_be_surpassed_says_so():
    assert "better than the wish" in pick(FRONT, Nearest(wish={"height_m": 0.85, "energy_j": 20.0})).why
    why = pick(FRONT, Nearest(wish={"height_m": 0.95, "energy_j": 10.0})).why
    assert why.startswith("trial 2 ")
    assert "nearest to the wish (height 0.950 m, energy 10.00 J), at most 0.083" in why

"""What the search leaves out changes nothing: every rule on every set, without any of the short cuts."""

from dataclasses import replace

import numpy as np
import pytest

from pareto_monoped.actuator import judge
from pareto_monoped.actuator.actuator import actuator_mass_kg
from pareto_monoped.actuator.judge import Judge, candidates
from pareto_monoped.actuator.layout import layout, radial_room_mm
from pareto_monoped.actuator.motors import load_motor
from pareto_monoped.actuator.rating.width import LOAD_RULES, face_width_mm
from pareto_monoped.actuator.rules import CONSTRAINTS, CandidateSets, violations
from pareto_monoped.actuator.search import build_map
from pareto_monoped.actuator.settings import ActuatorSettings

FEW = {"iso6336": (0.6,), "paper": (0.5, 0.6)}
"""Modules of these tests; the search has nine."""


def small_search(rules):
    """A motor and settings with few sets, one of whose rules is so hard that many intervals stay empty."""
    settings = ActuatorSettings(rules=rules, modules_mm=FEW[rules], planets_max=4)
    return load_motor("MAD_M6C12"), settings


@pytest.mark.parametrize(("rules", "first"), [("paper", 8), ("iso6336", 8), ("iso6336", 1)])
def test_nothing_that_is_left_out_matters(monkeypatch, rules, first):
    monkeypatch.setattr(judge, "_FIRST", first)
    motor, settings = small_search(rules)
    gears = candidates(radial_room_mm(motor, "ESSPG", settings), settings)
    # Width, layout, rules and mass of every set that has a rating, also of those that teeth alone rule out.
    ring = gears.ring()
    gears = gears.where(np.asarray(ring.tip_radius_mm > ring.base_radius_mm))
    width = np.asarray(face_width_mm(gears, motor, "ESSPG", settings))
    at = layout(motor, "ESSPG", gears, width, settings)
    sets = CandidateSets(gears=gears, face_width_mm=width, at=at, motor=motor, family="ESSPG", settings=settings)
    names, broken = violations(sets)
    mass = np.asarray(actuator_mass_kg(at, motor, "ESSPG", settings))
    ratio = (gears.sun_teeth + gears.ring_teeth) / gears.sun_teeth
    tenths = np.floor(10.0 * ratio + 1e-9).astype(int)
    found = build_map(motor, settings)
    filled = 0
    for entry in found.entries:
        inside = np.flatnonzero(tenths == round(10 * entry.ratio_low))
        good = inside[~broken[:, inside].any(axis=0) & np.isfinite(mass[inside])]
        result = entry.families["ESSPG"]
        best = good[np.argsort(mass[good], kind="stable")][:2]
        for got, place in zip((result.best, result.runner_up), (0, 1), strict=True):
            if place >= len(best):
                assert got is None
                continue
            assert got is not None
            assert got.mass_kg == pytest.approx(mass[best[place]], rel=1e-12)
        if len(best):
            filled += 1
            one_short = inside[(broken[:, inside].sum(axis=0) == 1) & (mass[inside] < mass[best[0]])]
            assert set(result.in_the_way) == {
                n for n, row in zip(names, broken[:, one_short], strict=True) if row.any()
            }
    assert 5 < filled < 100


@pytest.mark.parametrize("gap_mm", [5.0, 60.0])
@pytest.mark.parametrize("rules", ["paper", "iso6336"])
def test_where_no_set_comes_near_the_nearest_ones_name_all_their_rules(rules, gap_mm):
    """With a contact ratio that no set has, and in one case with planets that are never far enough apart."""
    motor, settings = small_search(rules)
    settings = replace(settings, planet_gap_mm=gap_mm, contact_ratio_min=3.0)
    gears = candidates(radial_room_mm(motor, "ESSPG", settings), settings)
    judged = Judge(motor=motor, family="ESSPG", settings=settings).judge(gears)
    width = judged.width_mm
    at = layout(motor, "ESSPG", gears, width, settings)
    laid_out = [name for name in judged.names if CONSTRAINTS[name].laid_out]
    sets = CandidateSets(gears=gears, face_width_mm=width, at=at, motor=motor, family="ESSPG", settings=settings)
    _, broken = violations(sets, tuple(laid_out))
    rows = [judged.names.index(name) for name in laid_out]
    hard = np.array([name not in LOAD_RULES for name in judged.names])
    assert judged.broken[hard].any(axis=0).all()
    checked = 0
    for tenths in np.unique(judged.tenths):
        inside = np.flatnonzero(judged.tenths == tenths)
        whole = judged.broken[:, inside].copy()
        whole[rows] = broken[:, inside]
        count = whole.sum(axis=0)
        nearest = inside[count == count.min()]
        assert count.min() >= 1
        assert np.array_equal(judged.broken[:, nearest], whole[:, count == count.min()])
        nearness = judged.nearness[inside]
        assert np.array_equal(inside[nearness == nearness.min()], nearest)
        checked += 1
    assert checked > 50

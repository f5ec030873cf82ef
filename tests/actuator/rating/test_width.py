"""The least face width: nothing narrower is enough, and it follows torque and steel as it must."""

from dataclasses import replace
from functools import reduce

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pareto_monoped.actuator.gearset import GearSet
from pareto_monoped.actuator.motors import load_motor
from pareto_monoped.actuator.rating import width as width_module
from pareto_monoped.actuator.rating.build import build_stage
from pareto_monoped.actuator.rating.stage import required
from pareto_monoped.actuator.rating.width import least_width_mm, strength_margins, width_bounds
from pareto_monoped.actuator.settings import ActuatorSettings

SETTINGS = ActuatorSettings(rules="iso6336")
MOTOR = load_motor("U8")


def drawn(count, seed):
    rng = np.random.default_rng(seed)
    sun = rng.integers(18, 45, count)
    planet = (sun * rng.uniform(1.0, 3.0, count)).astype(int)
    module = rng.choice([0.5, 0.6, 0.7, 0.8], count)
    return GearSet(
        sun_teeth=sun,
        planet_teeth=planet,
        ring_teeth=sun + 2 * planet,
        module_mm=module,
        planets=rng.integers(3, 6, count),
        backlash_mm=SETTINGS.tooth_thinning_mm(module),
        tips_fitted=True,
    )


def keeps(stage, width):
    """Whether all safety factors are kept, without the product's margins."""
    least = required(SETTINGS)
    return np.all([got >= wanted for got, wanted in zip(stage.safeties(width), least, strict=True)], axis=0)


def test_it_is_the_first_of_all_widths_that_is_enough():
    """Every multiple of 0.1 mm tried, one after the other, for 150 gear sets and a strong motor."""
    stage = build_stage(drawn(150, 1), load_motor("U12"), "ESSPG", SETTINGS)
    found = least_width_mm(stage)
    expected = np.full(150, np.nan)
    for steps in range(int(np.max(stage.width_high_mm) / 0.1) + 1, 59, -1):
        width = np.full(150, steps / 10.0)
        inside = (width >= stage.width_low_mm - 1e-9) & (width <= stage.width_high_mm + 1e-9)
        expected = np.where(inside & keeps(stage, width), width, expected)
    possible = np.isfinite(expected)
    assert 0.1 < np.mean(~possible) < 0.9
    assert found[possible].tolist() == expected[possible].tolist()
    assert not keeps(stage, found)[~possible].any()


def test_one_gear_set_gets_the_width_that_it_has_among_others():
    many = drawn(30, 2)
    together = least_width_mm(build_stage(many, MOTOR, "ISSPG", SETTINGS))
    for k in range(30):
        alone = least_width_mm(build_stage(many.chosen(k), MOTOR, "ISSPG", SETTINGS))
        assert alone.shape == ()
        assert alone == together[k]


def test_some_rows_of_a_stage_are_as_safe_as_among_all():
    """The search for the width leaves the sets alone that have one."""
    stage = build_stage(drawn(60, 5), MOTOR, "ESSPG", SETTINGS)
    width = np.linspace(6.0, 25.0, 60)
    everything = stage.safeties(width)
    mask = np.arange(60) % 7 < 3
    for chosen in (mask, np.array([41, 3, 3, 17])):
        for got, expected in zip(stage.rows(chosen).safeties(width[chosen]), everything, strict=True):
            assert np.array_equal(got, expected[chosen])


def test_a_set_that_no_width_suits_gets_the_safest_of_those_tried():
    stage = build_stage(drawn(200, 6), load_motor("U12"), "ESSPG", SETTINGS)
    found = least_width_mm(stage)
    hopeless = ~keeps(stage, found)
    assert 10 < hopeless.sum() < 190
    low = np.ceil(np.round(stage.width_low_mm / 0.1, 6))
    high = np.maximum(low, np.floor(np.round(stage.width_high_mm / 0.1, 6)))
    margins = []
    for share in np.linspace(0.0, 1.0, 12):
        width = np.round(low + share * (high - low)) * 0.1
        margins.append(reduce(np.minimum, strength_margins(stage.safeties(width), stage).values()))
    got = reduce(np.minimum, strength_margins(stage.safeties(found), stage).values())
    assert got[hopeless] == pytest.approx(np.max(margins, axis=0)[hopeless], rel=1e-9)


WIDE = replace(
    SETTINGS,
    parts=replace(SETTINGS.parts, rating=replace(SETTINGS.parts.rating, face_over_sun_max=6.0, face_modules_max=200.0)),
)
"""Faces so wide that misalignment eats what width gains."""


BOUNDS = [
    pytest.param("U12", SETTINGS, 300, id="U12-default"),
    pytest.param("U8", WIDE, 60, id="U8-wide"),
    *(
        pytest.param(motor, limits, 300, id=f"{motor}-{name}-300", marks=pytest.mark.long)
        for motor in ("U8", "VT8020", "U12")
        for name, limits in (("default", SETTINGS), ("wide", WIDE))
    ),
]


@pytest.mark.parametrize(("motor", "limits", "count"), BOUNDS)
def test_no_set_goes_below_its_bound(motor, limits, count):
    """All widths tried, one after the other: the bounds assume that load factors grow with the width."""
    stage = build_stage(drawn(count, 7), load_motor(motor), "ESSPG", limits)
    bounds, found = width_bounds(stage), least_width_mm(stage)
    first, places = np.full(count, np.nan), np.arange(count)
    steps = np.arange(int(np.max(stage.width_high_mm) / 0.1) + 1, 59, -1)
    for several in np.array_split(steps, np.ceil(len(steps) / 10)):  # at a time, which takes a third of the time
        width = np.repeat(several / 10.0, count).reshape(-1, count)
        rows = np.tile(places, len(several))
        kept = keeps(stage.rows(rows), width.ravel()).reshape(width.shape)
        for one, held in zip(width, kept, strict=True):
            inside = (one >= stage.width_low_mm - 1e-9) & (one <= stage.width_high_mm + 1e-9)
            first = np.where(inside & held, one, first)
    possible = np.isfinite(first)
    assert found[possible].tolist() == first[possible].tolist()
    assert (bounds.floor_mm <= found).all()
    assert possible[bounds.enough].all()
    assert not possible[bounds.hopeless].any()
    assert bounds.floor_mm[bounds.hopeless].tolist() == found[bounds.hopeless].tolist()
    # The bounds are of use: nearly all sets are told apart, and few lie far above.
    assert (bounds.enough | bounds.hopeless).mean() > 0.95
    assert np.median((found / bounds.floor_mm)[bounds.enough]) < 1.6


def test_a_part_of_the_widths_may_be_enough(monkeypatch):
    """A margin that is a parabola over the width instead of the rating's, which grows up to the limits of the tests."""
    stage = build_stage(drawn(400, 8), MOTOR, "ESSPG", WIDE)
    low, high = (np.round(limit / 0.1) for limit in (stage.width_low_mm, stage.width_high_mm))

    def peak(some):
        return 12.0 * some.gears.planet_teeth

    def margin_and_need(some, steps, off):
        return some.gears.planets - 3.5 - np.square((steps - peak(some)) / 200.0), steps

    monkeypatch.setattr(width_module, "_margin_and_need", margin_and_need)
    bounds, found = width_bounds(stage), np.round(least_width_mm(stage) / 0.1)
    reach = 200.0 * np.sqrt(np.maximum(stage.gears.planets - 3.5, 0.0))
    first = np.maximum(np.ceil(peak(stage) - reach - 1e-9), low)
    tops = stage.gears.planets > 3
    good = tops & (first <= high) & (peak(stage) + reach >= low)
    rising = ~good & (peak(stage) > high)
    inside = good & (peak(stage) + reach < high)
    for some in (good & bounds.enough, rising, inside, ~tops & (peak(stage) < high)):
        assert some.sum() > 10
    assert found[good].tolist() == first[good].tolist()
    assert found[rising].tolist() == np.floor(np.round(stage.width_high_mm / 0.1, 6))[rising].tolist()
    assert bounds.hopeless[rising].all()
    assert not bounds.hopeless[good].any()
    assert not bounds.enough[inside].any()


def test_a_limit_that_is_off_does_not_widen_the_gears():
    stage = build_stage(drawn(300, 3), MOTOR, "ESSPG", SETTINGS)
    everything = least_width_mm(stage)
    kept = keeps(stage, everything)
    for rule in strength_margins(stage.safeties(everything), stage):
        relaxed = least_width_mm(stage, {rule})
        assert (relaxed[kept] <= everything[kept]).all()
    assert np.allclose(least_width_mm(stage, strength_margins(stage.safeties(everything), stage)), stage.width_low_mm)


factors = st.floats(1.01, 1.5)
FEWER = settings(max_examples=settings.default.max_examples // 4)
"""Each example rates a hundred gear sets."""


@FEWER
@given(factor=factors, seed=st.integers(0, 10_000))
def test_more_torque_never_gives_a_thinner_face_or_more_safety(factor, seed):
    gears = drawn(100, seed)
    strong = replace(MOTOR, peak_torque_n_m=factor * MOTOR.peak_torque_n_m)
    before, after = (build_stage(gears, motor, "ESSPG", SETTINGS) for motor in (MOTOR, strong))
    width = least_width_mm(before)
    for less, more in zip(after.safeties(width), before.safeties(width), strict=True):
        assert (less < more).all()
    kept = keeps(after, least_width_mm(after))
    assert (least_width_mm(after)[kept] >= width[kept]).all()


@FEWER
@given(
    factor=factors,
    seed=st.integers(0, 10_000),
    grade=st.sampled_from(["case_hardened_16mncr5", "nitrided_42crmo4", "through_hardened_42crmo4"]),
)
def test_a_stronger_steel_never_needs_a_wider_face(factor, seed, grade):
    gears = drawn(100, seed)
    data = replace(SETTINGS.parts.rating, sun_grade=grade, planet_grade=grade, ring_grade=grade)
    plain = replace(SETTINGS, parts=replace(SETTINGS.parts, rating=data))
    steel = plain.gear_steels.sun
    better = replace(
        steel, flank_limit_mpa=factor * steel.flank_limit_mpa, root_limit_mpa=factor * steel.root_limit_mpa
    )
    strong = replace(plain, steels=replace(plain.gear_steels, sun=better, planet=better, ring=better))
    before, after = (build_stage(gears, MOTOR, "ESSPG", chosen) for chosen in (plain, strong))
    width = least_width_mm(before)
    kept = keeps(before, width)
    assert (least_width_mm(after)[kept] <= width[kept]).all()


@pytest.mark.parametrize("rule", ["face_over_sun_max", "face_modules_max"])
def test_no_face_is_wider_than_its_limits(rule):
    data = replace(SETTINGS.parts.rating, **{rule: getattr(SETTINGS.parts.rating, rule) * 0.7})
    chosen = replace(SETTINGS, parts=replace(SETTINGS.parts, rating=data))
    gears = drawn(200, 4)
    width = least_width_mm(build_stage(gears, MOTOR, "ESSPG", chosen))
    low = np.maximum(6.0, 6.0 * gears.module_mm)
    high = np.minimum(
        data.face_over_sun_max * gears.module_mm * gears.sun_teeth, data.face_modules_max * gears.module_mm
    )
    assert (width <= np.maximum(high, np.ceil(low / 0.1 - 1e-9) * 0.1) + 1e-9).all()
    assert (width >= low - 1e-9).all()

"""Single factors: points of the standard's own curves, closed forms and limits."""

from dataclasses import replace
from itertools import product

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pareto_monoped.actuator.assumptions import DutyData
from pareto_monoped.actuator.gearset import GearSet, load_sharing
from pareto_monoped.actuator.motors import load_motor
from pareto_monoped.actuator.rating import load
from pareto_monoped.actuator.rating.build import build_stage
from pareto_monoped.actuator.rating.capacity import (
    FLANK_CURVES,
    ROOT_CURVES,
    elasticity_factor,
    equivalent_cycles,
    highest_share,
    mean_stress_factor,
    passes_per_rad,
    roughness_factor,
    work_hardening_factor,
)
from pareto_monoped.actuator.rating.geometry import (
    ToothForm,
    external_rim_factor,
    internal_rim_factor,
    single_contact_factors,
    tooth_form,
    zone_factor,
)
from pareto_monoped.actuator.settings import ActuatorSettings
from pareto_monoped.errors import InputError
from pareto_monoped.geometry.gears import ExternalGear, InternalGear
from pareto_monoped.materials import GEAR_GRADES, MATERIALS
from tests.actuator.rating import iso6336

CASE_HARDENED = GEAR_GRADES["case_hardened_18crnimo7_6"]
TEMPERED = GEAR_GRADES["through_hardened_42crmo4"]


def test_figures_that_every_handbook_prints():
    """Z_H of 20 degrees on standard centres, and Z_E of steel on steel: ISO 6336-2, Niemann/Winter, Shigley."""
    assert zone_factor(np.radians(20.0)) == pytest.approx(2.495, abs=5e-4)
    assert elasticity_factor(MATERIALS.gear_steel) == pytest.approx(189.8, abs=0.05)


def test_a_rack_has_the_form_factor_of_a_straight_sided_tooth():
    """In the limit of many teeth, by hand: fillet of 0.38 modules round a point 0.87 below the pitch line."""
    a = np.pi / 9
    centre = np.pi / 4 + 0.87 * np.tan(a) + 0.38 / np.cos(a)  # from the tooth's middle
    epsilon = 1.98
    chord = 2 * (centre - 0.38 * np.cos(np.pi / 6))
    # The load's height on a rack: back from the tip by the path's share beyond single contact.
    height = 1.0 - (epsilon - 1.0) * np.pi * np.cos(a) * np.sin(a)
    # It meets the middle of the tooth at the height of its flank point less what the slope takes.
    arm = height + (1.25 - 0.38 * (1 - np.sin(np.pi / 6))) - (np.pi / 4 - height * np.tan(a)) * np.tan(a)
    found = tooth_form(ExternalGear(teeth=1e7, module_mm=1.0), epsilon)
    assert found.form_factor == pytest.approx(6 * arm / chord**2, rel=1e-4)
    assert found.notch == pytest.approx(chord / (2 * 0.38), rel=1e-4)


def test_life_curves_pass_through_their_points():
    for curves, points in (
        (FLANK_CURVES, {"case_hardened": (1e5, 1.6, 5e7), "nitrided": (1e5, 1.3, 2e6)}),
        (
            ROOT_CURVES,
            {"case_hardened": (1e3, 2.5, 3e6), "nitrided": (1e3, 1.6, 3e6), "through_hardened": (1e4, 2.5, 3e6)},
        ),
    ):
        for treatment, (start, factor, reference) in points.items():
            cycles = np.array([1.0, start, reference, 1e10, 1e12])
            assert curves[treatment].factor(cycles) == pytest.approx([factor, factor, 1.0, 0.85, 0.85])


@pytest.mark.parametrize(
    ("curve", "torque_exponent"),
    [
        (FLANK_CURVES["case_hardened"], 6.610),
        (FLANK_CURVES["nitrided"], 5.709),
        (ROOT_CURVES["case_hardened"], 8.738),
        (ROOT_CURVES["nitrided"], 17.035),
        (ROOT_CURVES["through_hardened"], 6.225),
    ],
)
def test_slopes_are_those_that_iso_6336_6_prints(curve, torque_exponent):
    """Table A.1 of ISO 6336-6 gives the exponents of the equivalent torque; ours follow from the curves' points."""
    half = 0.5 if curve in FLANK_CURVES.values() else 1.0
    assert half / curve.exponent == pytest.approx(torque_exponent, abs=2e-3)


def test_equivalent_cycles_by_hand():
    """Levels of 1.0 and 0.5 over 1 and 2 rad; 0.6 passes per rad make 1 and 2 whole ones; slope 8.738."""
    duty = DutyData(jumps=1e4, torque_shares=(1.0, 0.5), output_angles_rad=(1.0, 2.0))
    expected = 1e4 * (1.0 + 2.0 * 0.5**8.738)
    found = equivalent_cycles(0.6, duty, ROOT_CURVES["case_hardened"].exponent, flank=False)
    assert found == pytest.approx(expected, rel=1e-5)


def test_reversed_levels_load_the_other_flank_of_sun_and_ring_and_both_of_a_planet():
    """One pass at 1.0, two at 0.5 forward and four at 0.5 backward; slope 8.738."""
    duty = DutyData(
        jumps=1e4, torque_shares=(1.0, 0.5, 0.5), output_angles_rad=(1.0, 2.0, 4.0), reversed=(False, False, True)
    )
    exponent, half = ROOT_CURVES["case_hardened"].exponent, 0.5**8.738
    one_side = equivalent_cycles(1.0, duty, exponent, flank=False)
    assert one_side == pytest.approx(1e4 * (1.0 + 2.0 * half), rel=1e-5)
    both = equivalent_cycles(1.0, duty, exponent, flank=False, both_ways=True)
    assert both == pytest.approx(1e4 * (1.0 + 6.0 * half), rel=1e-5)
    turned = replace(duty, reversed=(True, True, False))
    assert equivalent_cycles(1.0, turned, exponent, flank=False) == pytest.approx(one_side)


@pytest.mark.parametrize(
    ("steel", "ratio", "expected"),
    [
        ("nitrided_31crmov9", 0.0, 1.0),
        ("nitrided_31crmov9", 0.25, 0.861),  # 1 / (1 + 0.3 x 0.7 / 1.3)
        ("nitrided_31crmov9", 1.0, 0.607),
        ("case_hardened_18crnimo7_6", 0.25, 0.909),  # M = 0.5 at Y_S = 2: 1 / (1 + 0.3 / 3)
        ("case_hardened_18crnimo7_6", 1.0, 0.714),  # close to the 0.7 of idlers (ISO 6336-5)
    ],
)
def test_mean_stress_factor_by_hand(steel, ratio, expected):
    form = ToothForm(form_factor=1.3, stress_correction=2.0, notch=2.0)
    assert mean_stress_factor(GEAR_GRADES[steel], form, ratio) == pytest.approx(expected, abs=5e-4)


def test_a_stop_struck_in_each_jump_is_the_level_that_counts():
    """At twice the peak torque: its own cycles count whole, those of the push-off 0.5^6.61 each."""
    duty = DutyData(jumps=1e4, torque_shares=(1.0, 2.0), output_angles_rad=(1.0, 0.1))
    found = equivalent_cycles(0.6, duty, FLANK_CURVES["case_hardened"].exponent, flank=True)
    assert found == pytest.approx(1e4 * (1.0 + 0.5**6.6107), rel=1e-4)
    assert highest_share(duty) == 2.0


def test_struck_stops_leave_less_safety_the_harder_they_are():
    one = GearSet(sun_teeth=22, planet_teeth=44, ring_teeth=110, module_mm=0.6, planets=3)
    settings = ActuatorSettings(rules="iso6336")
    roots = []
    for share in (0.5, 1.0, 1.5, 2.5):
        duty = DutyData(jumps=1e5, torque_shares=(1.0, share), output_angles_rad=(1.0, 0.1))
        chosen = replace(settings, parts=replace(settings.parts, duty=duty))
        roots.append(build_stage(one, load_motor("VT8020"), "ESSPG", chosen).safeties(8.0).root)
    assert (np.diff(roots) < 0.0).all()
    # Far above the push-off, only the stop counts: with one pass each, its safety falls with its torque.
    assert roots[3] / roots[2] == pytest.approx(1.5 / 2.5, rel=0.02)


def test_a_duty_beyond_the_overload_is_the_overload():
    one = GearSet(sun_teeth=22, planet_teeth=44, ring_teeth=110, module_mm=0.6, planets=3)
    settings = ActuatorSettings(rules="iso6336")
    duty = DutyData(jumps=1e5, torque_shares=(1.0, 4.0), output_angles_rad=(1.0, 0.1))
    struck = replace(settings.parts, duty=duty)
    stated = replace(settings.parts, rating=replace(settings.parts.rating, overload_factor=4.0))
    found, expected = (
        build_stage(one, load_motor("VT8020"), "ESSPG", replace(settings, parts=parts)).safeties(8.0)
        for parts in (struck, stated)
    )
    assert found[2:] == expected[2:]


def test_passes_by_counting_meshes():
    """18/36/90 with three planets, carrier held: over one turn of the output the sun turns 5 times against it."""
    one = GearSet(sun_teeth=18, planet_teeth=36, ring_teeth=90, module_mm=0.5, planets=3)
    per_turn = [2.0 * np.pi * passes for passes in passes_per_rad(one)]
    assert per_turn == pytest.approx([5.0 * 3, 2.5, 3.0])


@given(cycles=st.floats(1.0, 1e11), more=st.floats(1.0, 1e3))
def test_life_falls_with_cycles(cycles, more):
    for curve in (*FLANK_CURVES.values(), *ROOT_CURVES.values()):
        assert curve.factor(cycles * more) <= curve.factor(cycles)


def test_rim_factors_meet_one_where_the_standard_ends_them():
    assert external_rim_factor(1.2) == 1.0
    assert external_rim_factor(1.2 - 1e-9) == pytest.approx(1.0, abs=2e-4)
    assert external_rim_factor(0.5) == pytest.approx(1.6 * np.log(4.484))
    assert internal_rim_factor(3.5) == 1.0
    assert internal_rim_factor(1.75) == pytest.approx(1.15 * np.log(8.324 / 1.75))


def test_single_contact_factors_by_hand():
    """18/36: M1 = 0.36397 / sqrt(0.28188 x 0.40512) with the contact ratio of 1.61; the wheel's is below 1."""
    sun, planet, ring = (
        kind(teeth=z, module_mm=1.0) for kind, z in ((ExternalGear, 18), (ExternalGear, 36), (InternalGear, 90))
    )
    pinion, wheel = single_contact_factors(sun, planet, 1.61, np.radians(20.0))
    assert (pinion, wheel) == (pytest.approx(1.077, abs=1e-3), 1.0)
    assert single_contact_factors(planet, ring, 1.94, np.radians(20.0))[1] == 1.0
    # Tips so short that one base pitch before the end of contact there is no flank.
    stubs = (ExternalGear(teeth=12, module_mm=1.0, tip_shortening=0.8), ExternalGear(teeth=12, module_mm=1.0))
    assert single_contact_factors(*stubs, 0.5, np.radians(20.0))[0] > 1e3


def test_twist_of_a_single_mesh_is_the_torsional_share_of_iso_6336_1():
    """0.0161 um per N/mm and (b/d)^2: 70 percent of the 0.023 that stand for bending and torsion together."""
    twist = load.sun_twist_um(1.0, 20.0, 20.0, 1, MATERIALS.gear_steel) / 1.33
    assert twist == pytest.approx(0.7 * 0.023, rel=5e-3)


def test_a_planet_on_stiff_pins_does_not_tilt_and_on_soft_ones_the_meshes_hold_it():
    tilt = [load.pin_tilt_um(400.0, 20.0, 1.5, pin, 0.0, 10.0, MATERIALS.steel) for pin in (6.0, 60.0, 600.0)]
    assert tilt[0] > 100.0 * tilt[1] > 1e5 * tilt[2]
    # Without pins, both meshes carry the moment F L / 2 between them: c b^3 / 12 against it.
    soft = load.pin_tilt_um(400.0, 20.0, 1.5, 1e-3, 0.0, 10.0, MATERIALS.steel)
    assert soft == pytest.approx(1e3 * 20.0 * 400.0 * 23.0 / 2 / (1e4 * 20.0**3 / 12), rel=1e-6)


def test_webs_hold_the_second_carrier_and_so_the_planets():
    tilt = [load.pin_tilt_um(400.0, 20.0, 1.1, 6.0, web, 10.0, MATERIALS.steel) for web in (0.0, 1e4, 1e5, 1e12)]
    assert tilt[0] > 1.3 * tilt[1] > 3.0 * tilt[2] > 1e6 * tilt[3]


CROWNINGS, LOADS, ASKEW = (0.0, 1.0, 5.0, 12.0), (5.0, 60.0, 600.0), (0.0, 4.0, 19.0, 21.0, 39.0, 41.0, 120.0)


@pytest.mark.parametrize(("crowning", "carries"), list(product(CROWNINGS, LOADS)))
def test_face_load_factor_is_that_of_springs_side_by_side(crowning, carries):
    """All of the face in contact, a part in the middle, or one end; askew, or not at all."""
    together = load.face_load_factor(np.array(ASKEW), 15.0, carries, crowning)
    alone = [load.face_load_factor(misalignment, 15.0, carries, crowning) for misalignment in ASKEW]
    expected = [iso6336.springs(misalignment, 15.0, carries, crowning) for misalignment in ASKEW]
    assert together == pytest.approx(alone, rel=1e-12)
    assert alone == pytest.approx(expected, rel=2e-6)
    loads = np.array([[carries], [2.0 * carries]])
    table = load.face_load_factor(np.array(ASKEW), 15.0, loads, crowning)
    assert table[0] == pytest.approx(alone, rel=1e-12)
    assert table[1] == pytest.approx(load.face_load_factor(np.array(ASKEW), 15.0, 2.0 * carries, crowning), rel=1e-12)


@pytest.mark.parametrize("misalignment", ASKEW)
def test_springs_without_crowning_are_the_closed_form_of_iso_6336_1(misalignment):
    """Clause 7.3.2: 1 + F c / (2 F_m / b) up to 2, beyond it the root of 2 F c / (F_m / b)."""
    twice = misalignment * 15.0 / 60.0
    expected = 1.0 + twice / 2.0 if twice <= 2.0 else (2.0 * twice) ** 0.5
    assert iso6336.springs(misalignment, 15.0, 60.0, 0.0) == pytest.approx(expected, rel=1e-6)
    assert load.face_load_factor(misalignment, 15.0, 60.0) == pytest.approx(expected, rel=1e-12)
    # Next to none is as good as none.
    assert load.face_load_factor(misalignment, 15.0, 60.0, 1e-4) == pytest.approx(expected, rel=1e-4)


def test_face_load_factor_is_continuous_where_contact_parts():
    below, above = (load.face_load_factor(misalignment, 10.0, 20.0) for misalignment in (4.0 - 1e-9, 4.0 + 1e-9))
    assert below == pytest.approx(2.0)
    assert above == pytest.approx(2.0)


def test_dynamic_factor_by_hand():
    """V = 1.885 m/s, z1 = 18, u = 2, class 6, light load: pace 0.3035, slope 1.963: 1 + (0.149 + 0.0193) x 0.596."""
    assert load.dynamic_factor(20.0, 1.885, 18, 2.0, 6) == pytest.approx(1.1003, abs=1e-4)


def test_dynamic_factor_never_falls_with_speed():
    speeds = np.linspace(0.0, 40.0, 400)
    assert (np.diff(load.dynamic_factor(50.0, speeds, 30, 3.0, 6)) > 0.0).all()


def test_load_sharing_is_read_by_the_number_of_planets():
    settings = ActuatorSettings(rules="iso6336")
    assert load_sharing(np.array([2, 3, 7, 9]), settings).tolist() == [1.16, 1.23, 1.47, 1.47]


def test_only_a_soft_flank_gains_by_a_hard_mate():
    assert work_hardening_factor(TEMPERED, CASE_HARDENED) == pytest.approx(1.2 - 170.0 / 1700.0)
    assert work_hardening_factor(TEMPERED, TEMPERED) == work_hardening_factor(CASE_HARDENED, TEMPERED) == 1.0


def test_roughness_of_the_test_gear_changes_nothing():
    for grade in GEAR_GRADES.values():
        assert roughness_factor(grade, 10.0) == pytest.approx(1.0, abs=6e-3)


def test_levels_of_the_duty_need_an_angle_each():
    with pytest.raises(ValueError, match="2 and 1 values: must be one per level"):
        DutyData(jumps=1.0, torque_shares=(1.0, 0.5), output_angles_rad=(1.0,))
    with pytest.raises(ValueError, match=r"reversed and torque_shares have 1 and 2 values"):
        DutyData(jumps=1.0, torque_shares=(1.0, 0.5), output_angles_rad=(1.0, 1.0), reversed=(True,))


def test_unknown_rules_are_refused():
    with pytest.raises(InputError, match="rules = 'agma': must be one of paper, iso6336"):
        ActuatorSettings(rules="agma")

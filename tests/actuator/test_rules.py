"""Each rule at its limit, on sets chosen so that only that rule is at stake."""

import numpy as np
import pytest

from pareto_monoped.actuator.gearset import GearSet
from pareto_monoped.actuator.layout import layout
from pareto_monoped.actuator.motors import load_motor
from pareto_monoped.actuator.rating.width import lewis_width_mm
from pareto_monoped.actuator.rules import CONSTRAINTS, CandidateSets, violations
from pareto_monoped.actuator.settings import ActuatorSettings
from pareto_monoped.design import CONSTRAINT_NAMES
from pareto_monoped.geometry.gears import ExternalGear, InternalGear

MOTOR = load_motor("VT8020")


def broken(family, sun, planet, module, planets, settings=None):
    settings = settings or ActuatorSettings(rules="paper")
    gears = GearSet(
        sun_teeth=sun,
        planet_teeth=planet,
        ring_teeth=sun + 2 * planet,
        module_mm=module,
        planets=planets,
        backlash_mm=settings.tooth_thinning_mm(module),
    )
    width = lewis_width_mm(gears, MOTOR, settings)
    at = layout(MOTOR, family, gears, width, settings)
    names, flags = violations(
        CandidateSets(gears=gears, face_width_mm=width, at=at, motor=MOTOR, family=family, settings=settings)
    )
    return {name for name, flag in zip(names, flags, strict=True) if flag}


@pytest.mark.parametrize(
    ("family", "teeth", "expected"),
    [
        # The published sets.
        ("ISSPG", (18, 36, 0.5, 3), set()),
        ("ISSPG", (30, 30, 0.5, 5), set()),
        ("ESSPG", (22, 65, 0.5, 3), set()),
        # 20 + 154 = 174 is no multiple of 4, and four planets of 67 teeth overlap; so do six of 30 around 30.
        ("ESSPG", (20, 67, 0.5, 4), {"meshing", "no_interference"}),
        ("ISSPG", (30, 30, 0.5, 6), {"no_interference"}),
        ("ISSPG", (29, 29, 0.5, 4), set()),
        # 17 teeth undercut.
        ("ISSPG", (17, 34, 0.5, 3), {"teeth_min"}),
        # The ring's roots: 46.25 mm fit into 48 mm, 48.75 do not; 79.25 do not fit into 79 where 78 does.
        ("ISSPG", (19, 38, 0.5, 3), {"ring_root"}),
        ("ESSPG", (20, 68, 0.5, 2), {"ring_root"}),
        ("ESSPG", (20, 70, 0.5, 2), {"ring_root", "gearbox_diameter"}),
        # The sun's wall at module 0.5: 1.375 mm with 20 teeth, 1.125 with 19; 1.35 needed. None in the ISSPG.
        ("ESSPG", (19, 62, 0.5, 2), {"sun_rim"}),
        # Planets on an 8 mm bore: 24 teeth leave 1.375 mm, 23 leave 1.125.
        ("ISSPG", (23, 23, 0.5, 4), {"planet_rim"}),
        ("ISSPG", (24, 24, 0.5, 4), set()),
        # The ring's wall: 2.5 mm less 1.25 modules, at least 3.5 modules.
        ("ISSPG", (24, 24, 0.55, 4), {"ring_rim"}),
        # 20 teeth inside 60 are met below their base circle; 63 is the least for 20 (z2 >= (z1^2 sin^2 - 4) / (2 z1
        # sin^2 - 4)).
        ("ESSPG", (20, 20, 0.6, 4), {"planet_rim", "ring_interference", "bearing_room"}),
        # Two planets at 6.1:1 need 31 mm of width; the stator is 29.5 mm high.
        ("ISSPG", (18, 37, 0.5, 2), {"within_stator"}),
    ],
)
def test_sets_break_just_the_rules_they_should(family, teeth, expected):
    assert broken(family, *teeth) == expected


@pytest.mark.parametrize("name", sorted(CONSTRAINTS))
def test_each_rule_can_be_switched_off(name):
    # A set that breaks nearly everything; the rule asked about is no longer among the names.
    everything = broken("ESSPG", 12, 14, 1.125, 7)
    without = broken("ESSPG", 12, 14, 1.125, 7, ActuatorSettings(rules="paper", constraints_off=frozenset({name})))
    assert without == everything - {name}


def test_every_rule_says_what_it_is_and_where_it_comes_from():
    for name, rule in CONSTRAINTS.items():
        assert name.isidentifier()
        assert len(rule.says) > 20
        assert rule.source


def test_a_limit_met_exactly_is_kept_whatever_the_rounding():
    # The room is made 0.55 x (85 + 2.5) mm, which floats reach by different ways.
    settings = ActuatorSettings(rules="paper", diameter_clearance_mm=58.0 - 0.55 * 87.5)
    assert "ring_root" not in broken("ISSPG", 25, 30, 0.55, 4, settings)
    assert "ring_root" in broken("ISSPG", 25, 31, 0.55, 4, settings)


def test_arrays_and_single_sets_agree():
    settings = ActuatorSettings(rules="paper")
    sun, planet = np.array([18, 30, 19, 23]), np.array([36, 30, 38, 23])
    module, planets = np.array([0.5, 0.5, 0.5, 0.5]), np.array([3, 5, 3, 4])
    gears = GearSet(
        sun_teeth=sun,
        planet_teeth=planet,
        ring_teeth=sun + 2 * planet,
        module_mm=module,
        planets=planets,
        backlash_mm=settings.tooth_thinning_mm(module),
    )
    width = lewis_width_mm(gears, MOTOR, settings)
    at = layout(MOTOR, "ISSPG", gears, width, settings)
    names, flags = violations(
        CandidateSets(gears=gears, face_width_mm=width, at=at, motor=MOTOR, family="ISSPG", settings=settings)
    )
    for k in range(4):
        single = broken("ISSPG", int(sun[k]), int(planet[k]), float(module[k]), int(planets[k]))
        assert {name for name, flag in zip(names, flags[:, k], strict=True) if flag} == single


def test_every_constraint_has_its_rule_and_no_rule_is_without_a_name():
    assert tuple(CONSTRAINTS) == CONSTRAINT_NAMES


def test_without_a_shift_all_teeth_are_thick_at_their_tips_and_two_arcs_fit_in_a_ring_s_root():
    """The rules ``tip_thickness`` and ``root_fillet`` look at shifted sets only."""
    data = ActuatorSettings().parts
    for module in ActuatorSettings().modules_mm:
        teeth = np.arange(12, 400)
        thinning = ActuatorSettings().tooth_thinning_mm(module)
        outer = ExternalGear(teeth=teeth, module_mm=module, backlash_mm=thinning)
        inner = InternalGear(teeth=teeth[24:], module_mm=module, backlash_mm=thinning)
        assert (outer.tip_thickness_mm >= data.rating.tip_thickness_modules * module).all()
        assert (inner.fillet_angle_rad > 0.0).all()

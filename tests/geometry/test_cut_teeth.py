"""Roots, flanks and tips against teeth cut as in a workshop, with which they share no formula."""

from dataclasses import replace
from itertools import product

import numpy as np
import pytest
import shapely

from pareto_monoped.actuator.gearset import CENTRE_TOLERANCE_MM, GearSet
from pareto_monoped.actuator.motors import motor_names
from pareto_monoped.actuator.rating.sheet import tip_depths_mm
from pareto_monoped.actuator.search import map_for
from pareto_monoped.geometry.gears import ExternalGear, half_angle
from tests.geometry.cutting import cut_gear, cut_ring, deepest, tip_corner

GEARS = [
    (18, 0.5, 0.0, 0.04),  # slightly undercut
    (12, 0.5, 0.0, 0.04),  # much
    (14, 0.5, 0.5, 0.015),
    (18, 0.5, 0.9, 0.015),
    (21, 0.6, 0.6, 0.018),
    (30, 0.8, -0.4, 0.024),
    (67, 0.5, 0.1, 0.02),
]


@pytest.mark.parametrize(("teeth", "module", "shift", "thinning"), GEARS)
def test_a_tooth_is_what_the_rack_leaves(teeth, module, shift, thinning):
    gear = ExternalGear(teeth=teeth, module_mm=module, backlash_mm=thinning, shift=shift)
    cut = cut_gear(teeth, module, shift, thinning, float(gear.tip_radius_mm))
    root = gear.root_curve_mm(200)
    radii = np.linspace(float(gear.form_radius_mm), float(gear.tip_radius_mm), 100)
    beside = np.pi / teeth - half_angle(gear, radii)
    flank = np.stack([radii * np.cos(beside), radii * np.sin(beside)], axis=1)
    for points in (root, flank):
        off = shapely.distance(shapely.points(points[:, ::-1]), cut.exterior)
        assert off.max() < 2e-4
    assert gear.area_mm2() / teeth == pytest.approx(cut.area, rel=2e-5)
    bottom = np.hypot(*np.array(cut.exterior.coords).T)
    assert gear.root_radius_mm == pytest.approx(bottom[bottom > 0.0].min(), abs=2e-4)


def unfitted(sun, planet, module, shift):
    """A set whose tips are not fitted."""
    return GearSet(
        sun_teeth=sun,
        planet_teeth=planet,
        ring_teeth=sun + 2 * planet,
        module_mm=module,
        planets=3,
        sun_shift=shift,
        backlash_mm=0.03 * module,
    )


def interfering():
    """Forty sets whose tips are not fitted, with rings whose tips are too long."""
    numbers = product((14, 16, 18, 20, 21), (18, 21, 24, 30), (0.5, 0.8), (0.0, 0.4))
    found = [gears for gears in (unfitted(*one) for one in numbers) if max(tip_depths_mm(gears).values()) > 0.0]
    return found[:40]


def measured(gears, tip, root, metal, off_mm=0.0):
    """How deep a tip comes into the metal around a space of its mate, at a centre distance that is off by some mm."""
    shape, mate = getattr(gears, tip)(), getattr(gears, root)()
    inner, distance = "ring" in (tip, root), float(gears.carrier_radius_mm)
    bases = np.array([shape.base_radius_mm, mate.base_radius_mm], dtype=float)
    between = abs(bases[0] - bases[1]) if inner else bases.sum()
    # Off their place, flanks part by the change of the involute function times the base radii (ISO 21771).
    angles = np.arccos(between / np.array([distance + off_mm, distance]))
    parted = (-1.0 if inner else 1.0) * between * np.subtract(*(np.tan(angles) - angles)) / bases[0]
    module, thinning = float(gears.module_mm), float(gears.backlash_mm)
    outwards = float(shape.shift) * (-1.0 if tip == "ring" else 1.0)
    thick = 0.5 * np.pi * module + 2.0 * outwards * module * np.tan(np.radians(20.0)) - thinning
    corner = tip_corner(int(shape.teeth), module, float(shape.tip_radius_mm), thick, internal=tip == "ring")
    return deepest(
        metal,
        teeth=(int(mate.teeth), int(shape.teeth)),
        distance_mm=float(gears.carrier_radius_mm) + off_mm,
        corner=(float(shape.tip_radius_mm), corner),
        taken_rad=2.0 * thinning / (module * int(shape.teeth)) + parted,
        kind={"ring": "ring in planet"}.get(tip, "planet in ring" if root == "ring" else "outside"),
    )


def metal_of(gears, root):
    """The metal around one space of a gear of a set, cut."""
    shape = getattr(gears, root)()
    numbers = int(shape.teeth), float(gears.module_mm), float(shape.shift), float(gears.backlash_mm)
    return (cut_ring if root == "ring" else cut_gear)(*numbers, float(shape.tip_radius_mm))


@pytest.mark.parametrize(
    ("sets", "count"),
    [
        (lambda: [unfitted(14, 18, 0.5, 0.0), unfitted(16, 24, 0.5, 0.0)], 2),
        pytest.param(interfering, 40, marks=pytest.mark.long),
    ],
)
def test_how_deep_tips_reach_into_roots_is_what_is_measured_on_cut_teeth(sets, count):
    compared = 0
    for gears in sets():
        for (tip, root), depth in tip_depths_mm(gears).items():
            if depth > 0.0:
                found = measured(gears, tip, root, metal_of(gears, root))
                assert found == pytest.approx(depth, abs=2e-4), (gears, tip, root)
                compared += 1
    assert compared >= count


@pytest.mark.long
@pytest.mark.parametrize("motor", motor_names())
def test_no_tip_of_a_winner_reaches_into_a_root(motor):
    """Also with the planet's axis at either end of its tolerance."""
    winners = list(dict.fromkeys(entry.actuator.gears for entry in map_for(motor).entries if entry.actuator))
    assert len(winners) > 20
    for gears in winners:
        for tip, root in tip_depths_mm(gears):
            metal = metal_of(gears, root)
            for off in (-CENTRE_TOLERANCE_MM, 0.0, CENTRE_TOLERANCE_MM):
                assert measured(gears, tip, root, metal, off) < 2e-4, (gears, tip, root, off)


def test_tips_that_are_not_fitted_do_reach_into_roots():
    """The check above would find them."""
    gears = next(e.actuator.gears for e in map_for("U8").entries if e.actuator)
    depths = tip_depths_mm(replace(gears, tips_fitted=False))
    assert depths["ring", "planet"] > 1e-3
    assert max(tip_depths_mm(gears).values()) == 0.0  # as it won

"""Stiffness and backlash at the output: finite elements, energy, rigid rolling, and handbook values."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pareto_monoped.actuator.actuator import build_actuator
from pareto_monoped.actuator.gearset import GearSet
from pareto_monoped.actuator.layout import layout
from pareto_monoped.actuator.search import map_of
from pareto_monoped.actuator.service.sheet import service_sheet
from pareto_monoped.actuator.service.stiffness import backlash_arcmin, mesh_compliance, pin_compliance


def layout_of(actuator, settings):
    return layout(actuator.motor, actuator.family, actuator.gears, actuator.face_width_mm, settings)


def hand_stiffness(small, large, contact_ratio, load):
    """c_gamma,alpha from the standard's own numbers; ``large`` is infinite for a ring."""
    pair = 0.8 * 0.975 / (0.04723 + 0.15551 / small + 0.25791 / large)
    return pair * min(1.0, load / 100.0) ** 0.25 * (0.75 * contact_ratio + 0.25)


@pytest.mark.parametrize("ratio", [4.0, 7.9])
def test_teeth_give_way_as_two_springs_and_a_lever_do(vt_map, ratio):
    """Statics of one planet written out: forces on its rim, springs along the line of action, motion of its centre."""
    actuator = vt_map.lookup(ratio)
    gears, width = actuator.gears, actuator.face_width_mm
    r_carrier = 1e-3 * gears.carrier_radius_mm
    pin_force = actuator.peak_torque_n_m / gears.planets / r_carrier
    rim_force = 0.5 * pin_force  # sun and ring push alike, or the planet would spin
    line_force = rim_force / math.cos(math.radians(20.0))
    moved = []
    for pair in (
        (*sorted((gears.sun_teeth, gears.planet_teeth)), actuator.contact_ratio_sun),
        (gears.planet_teeth, math.inf, actuator.contact_ratio_ring),
    ):
        spring = 1e6 * width * hand_stiffness(*pair, rim_force / width)
        moved.append(line_force / spring / math.cos(math.radians(20.0)))  # along the pitch circle
    turned = 0.5 * sum(moved) / r_carrier
    assert mesh_compliance(actuator) == pytest.approx(turned / actuator.peak_torque_n_m, rel=1e-9)


def beam_mean_deflection_mm(length_mm, stiffness_n_mm2, force_n, elements=40, *, spring=0.0):
    """Finite elements: clamped at one end, the other end free to move against a spring, but not to turn."""
    step = length_mm / elements
    beam = (stiffness_n_mm2 / step**3) * np.array(
        [
            [12, 6 * step, -12, 6 * step],
            [6 * step, 4 * step**2, -6 * step, 2 * step**2],
            [-12, -6 * step, 12, -6 * step],
            [6 * step, 2 * step**2, -6 * step, 4 * step**2],
        ]
    )
    load = force_n / length_mm
    loads = load * np.array([step / 2, step**2 / 12, step / 2, -(step**2) / 12])
    size = 2 * (elements + 1)
    matrix, right = np.zeros((size, size)), np.zeros(size)
    for e in range(elements):
        matrix[2 * e : 2 * e + 4, 2 * e : 2 * e + 4] += beam
        right[2 * e : 2 * e + 4] += loads
    matrix[size - 2, size - 2] += spring
    free = list(range(2, size - 1))
    moved = np.zeros(size)
    moved[free] = np.linalg.solve(matrix[np.ix_(free, free)], right[free])
    return float(right @ moved) / force_n  # work of the load: its mean deflection


@pytest.mark.parametrize("ratio", [4.0, 6.0, 7.9])
def test_pins_bend_as_finite_elements_do(vt_map, ratio):
    actuator, settings = vt_map.lookup(ratio), vt_map.settings
    at = layout_of(actuator, settings)
    length = actuator.face_width_mm + 2 * settings.parts.carrier.planet_clearance_mm
    stiffness = 206e3 * math.pi * 6.0**4 / 64.0
    radius = actuator.gears.carrier_radius_mm
    force = 1e3 / (actuator.gears.planets * radius)  # of each pin at 1 N m
    turned = beam_mean_deflection_mm(length, stiffness, force) / radius
    assert pin_compliance(actuator.gears, at, settings) == pytest.approx(turned, rel=1e-6)


@pytest.mark.parametrize("ratio", [4.0, 6.0])
def test_webs_are_springs_at_the_pins_second_ends(vt8020, ratio):
    """The same finite elements with the stiffness of one web at the guided end."""
    tied = map_of(vt8020, "iso6336")
    actuator, settings = tied.lookup(ratio), tied.settings
    at = layout_of(actuator, settings)
    length = actuator.face_width_mm + 2 * settings.planet_clearance_mm
    stiffness, radius = 206e3 * math.pi * 6.0**4 / 64.0, actuator.gears.carrier_radius_mm
    web = float(at.webs.section.stiffness_n_per_mm(length, settings.materials.aluminium))
    assert web > 1e4
    force = 1e3 / (actuator.gears.planets * radius)
    turned = beam_mean_deflection_mm(length, stiffness, force, spring=web) / radius
    found = pin_compliance(actuator.gears, at, settings)
    assert found == pytest.approx(turned, rel=1e-6)
    assert found < 0.8 * beam_mean_deflection_mm(length, stiffness, force) / radius


@pytest.mark.parametrize(("ratio", "radius_mm"), [(4.0, 4.9), (7.9, 4.0)])
def test_shaft_and_carrier_twist_as_tubes_do(vt_map, ratio, radius_mm):
    """ISSPG: shaft of 9.8 mm in one piece with the sun; ESSPG: of 8 mm, with two reliefs of 1 mm and 7.8 mm diameter.

    From coupling to the middle of the teeth.
    """
    actuator, settings = vt_map.lookup(ratio), vt_map.settings
    found = service_sheet(actuator, settings).stiffness
    parts = {part.name: part for part in actuator.parts}
    coupling = max(prism.z1_mm for prism in parts["coupling"].prisms)
    ring = parts["ring"].prisms[0]
    length = 0.5 * (ring.z0_mm + ring.z1_mm) - coupling
    reliefs = 2.0 if actuator.family == "ESSPG" else 0.0
    polar = math.pi / 32.0 * (2 * radius_mm) ** 4
    softness = (length - reliefs) / polar + reliefs / (math.pi / 32.0 * 7.8**4)
    shear = 206e3 / 2.6
    assert found.shaft == pytest.approx(1e3 * softness / shear / actuator.ratio**2)
    # The carrier is stiffer than a plain tube of the bearing's bore with the largest hole, and less than a solid bar.
    bore = settings.parts and layout_of(actuator, settings).bearing.inner_diameter_mm
    depth = -min(prism.z0_mm for prism in parts["carrier"].prisms)
    bar = 1e3 * depth / (70e3 / 2.66 * math.pi / 32.0 * float(bore) ** 4)
    assert bar < found.carrier < 4.0 * bar


def test_parts_in_series_make_the_whole(vt_map):
    found = service_sheet(vt_map.lookup(6.0), vt_map.settings).stiffness
    whole = found.mesh + found.pins + found.shaft + found.carrier
    assert found.stiffness_n_m_per_rad == pytest.approx(1.0 / whole)
    assert found.stiffness_n_m_per_rad < min(1.0 / found.pins, 1.0 / found.shaft)


def test_a_stiffer_steel_and_more_planets_never_soften(vt_map, vt8020, settings):
    actuator = vt_map.lookup(4.0)
    stiff = replace(
        settings,
        materials=replace(settings.materials, steel=replace(settings.materials.steel, youngs_modulus_mpa=250e3)),
    )
    usual = service_sheet(actuator, settings).stiffness
    assert service_sheet(actuator, stiff).stiffness.stiffness_n_m_per_rad > usual.stiffness_n_m_per_rad
    fewer = build_actuator(vt8020, "ISSPG", replace(actuator.gears, planets=4), settings)
    same_width = replace(actuator, gears=fewer.gears)
    assert mesh_compliance(same_width) > mesh_compliance(actuator)


teeth = st.integers(18, 80)


@given(teeth, teeth, st.floats(0.3, 1.2), st.floats(0.001, 0.1))
def test_backlash_is_that_of_rigid_wheels_with_play(sun, planet, module, thinning):
    """Turn the sun through the play of both meshes with the carrier held, then divide by the ratio."""
    gears = GearSet(sun_teeth=sun, planet_teeth=planet, ring_teeth=sun + 2 * planet, module_mm=module, planets=3)
    r_sun = 0.5 * module * sun
    play = 2 * (2 * thinning)  # two meshes, each with both of its teeth thinned; the planet only passes motion on
    at_sun = play / r_sun
    assert backlash_arcmin(gears, thinning) == pytest.approx(math.degrees(at_sun / gears.ratio) * 60.0)


def test_teeth_of_the_cad_are_as_thin_as_the_backlash_says(vt_map):
    """On the pitch circle, tooth and mating tooth together leave 0.08 mm of the pitch free.

    Teeth that end a little above it have more area than those that end below, by their thickness there.
    """
    gears, thinning = vt_map.lookup(6.0).gears, vt_map.settings.tooth_thinning_mm(vt_map.lookup(6.0).gears.module_mm)
    thick = 0.0
    for wheel in (gears.sun(), gears.planet()):
        low, high = (replace(wheel, tip_shortening=1.0 + above).moments().area for above in (1e-3, -1e-3))
        thick += (high - low) / (2e-3 * float(wheel.module_mm) * int(wheel.teeth))
    assert np.pi * float(gears.module_mm) - thick == pytest.approx(2 * thinning, rel=1e-4)


def test_the_greatest_backlash_has_all_teeth_at_the_end_of_their_tolerance(vt8020):
    """6:1 under iso6336: mean of both meshes, each with twice the thinning and the tolerances of both its gears."""
    tied = map_of(vt8020, "iso6336")
    actuator = tied.lookup(6.0)
    gears, sheet = actuator.gears, service_sheet(actuator, tied.settings)
    tolerance = sheet.greatest_backlash_arcmin / sheet.backlash_arcmin
    thinning = next(
        float(prism.outline.backlash_mm)
        for part in actuator.parts
        for prism in part.prisms
        if hasattr(prism.outline, "backlash_mm") and float(prism.outline.backlash_mm) > 0.0
    )
    sun, planet, ring = (table(gears.module_mm * z) for z in (gears.sun_teeth, gears.planet_teeth, gears.ring_teeth))
    more = 0.5 * ((sun + planet) + (planet + ring))
    assert sun < planet
    assert tolerance == pytest.approx(1.0 + more / (2.0 * thinning))


def table(diameter_mm):
    """DIN 3967, series 23."""
    return next(t for most, t in ((10.0, 0.008), (50.0, 0.012), (125.0, 0.016)) if diameter_mm <= most)


@pytest.mark.parametrize("ratio", [4.0, 7.5])
def test_needles_give_way_by_what_the_work_of_the_worst_one_says(vt8020, ratio):
    """A planet's centre moves by two contacts of 3.84e-5 Q^0.9 / l^0.8 mm; its torque about the axis is n F r."""
    tied = map_of(vt8020, "iso6336")
    actuator = tied.lookup(ratio)
    force = 1e3 * actuator.peak_torque_n_m / (actuator.gears.planets * actuator.gears.carrier_radius_mm)
    (needles,) = (part for part in actuator.parts if part.name == "planet_needles")
    rows = len(needles.places_mm)
    length = float(needles.prisms[0].z1_mm - needles.prisms[0].z0_mm) - 0.6
    worst = 4.08 * force / (15 * rows)
    moved = 2 * 3.84e-5 * worst**0.9 / length**0.8
    turned = moved / actuator.gears.carrier_radius_mm
    found = service_sheet(actuator, tied.settings).stiffness
    assert found.needles == pytest.approx(turned / actuator.peak_torque_n_m)
    assert 1.0 / found.stiffness_n_m_per_rad > found.needles + found.mesh + found.shaft

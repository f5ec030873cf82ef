"""Webs between the planets: shape by distances, section by strips, stiffness by finite elements."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pareto_monoped.actuator.gearset import GearSet
from pareto_monoped.actuator.settings import ActuatorSettings
from pareto_monoped.actuator.webs import webs_of
from pareto_monoped.cad.shape.outlines import all_polygons
from pareto_monoped.materials import MATERIALS

SETTINGS = ActuatorSettings(rules="iso6336")
FIVE = GearSet(sun_teeth=30, planet_teeth=30, ring_teeth=90, module_mm=0.5, planets=5)
THREE = GearSet(sun_teeth=22, planet_teeth=44, ring_teeth=110, module_mm=0.6, planets=3)


def gap_mm(points, centres):
    return float(np.hypot(*(points[:, None] - centres[None]).T).min())


@pytest.mark.parametrize("gears", [FIVE, THREE], ids=str)
def test_webs_keep_clear_of_planets_and_ring_and_fill_the_gap(gears):
    webs = webs_of(gears, SETTINGS)
    assert webs.count == gears.planets
    angles = 2.0 * np.pi * np.arange(gears.planets) / gears.planets
    pins = gears.carrier_radius_mm * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    polygons = all_polygons([webs.outline], 1e-4)
    assert len(polygons) == gears.planets
    for points in polygons:
        assert gap_mm(points, pins) == pytest.approx(gears.planet().tip_radius_mm + 0.5, abs=1e-3)
        reach = np.hypot(*points.T)
        assert reach.max() == pytest.approx(webs.r_out_mm, abs=1e-3)
        assert reach.max() <= gears.ring().tip_radius_mm - 0.5 + 1e-9
        # The screw's tapping hole has its metal all around.
        screw = webs.r_screw_mm * points.mean(axis=0) / np.hypot(*points.mean(axis=0))
        assert gap_mm(points, screw[None]) >= 1.25 + 1.0 - 1e-2


@pytest.mark.parametrize("gears", [FIVE, THREE], ids=str)
def test_section_is_that_of_its_polygon(gears):
    webs = webs_of(gears, SETTINGS)
    x, y = all_polygons([webs.path], 1e-5)[0].T
    x_next, y_next = np.roll(x, -1), np.roll(y, -1)
    twice = x * y_next - x_next * y
    assert webs.section.area_mm2 == pytest.approx(0.5 * twice.sum(), rel=1e-4)
    second = (twice * (y**2 + y * y_next + y_next**2)).sum() / 12.0
    assert webs.section.second_moment_mm4 == pytest.approx(second, rel=1e-4)


def test_a_web_bends_and_shears_as_finite_elements_do():
    """Timoshenko elements: one end clamped, the other guided without slope, a force of 1 N there."""
    webs, length, count = webs_of(THREE, SETTINGS), 12.0, 50
    bending = 70e3 * webs.section.second_moment_mm4
    shear = MATERIALS.aluminium.shear_modulus_mpa * webs.section.area_mm2 / 1.2
    h = length / count
    phi = 12.0 * bending / (shear * h**2)
    k = (
        bending
        / (h**3 * (1.0 + phi))
        * np.array(
            [
                [12, 6 * h, -12, 6 * h],
                [6 * h, (4 + phi) * h**2, -6 * h, (2 - phi) * h**2],
                [-12, -6 * h, 12, -6 * h],
                [6 * h, (2 - phi) * h**2, -6 * h, (4 + phi) * h**2],
            ]
        )
    )
    size = 2 * (count + 1)
    whole = np.zeros((size, size))
    for e in range(count):
        whole[2 * e : 2 * e + 4, 2 * e : 2 * e + 4] += k
    free = list(range(2, size - 1))
    load = np.zeros(len(free))
    load[-1] = 1.0
    sway = np.linalg.solve(whole[np.ix_(free, free)], load)[-1]
    assert webs.section.stiffness_n_per_mm(length, MATERIALS.aluminium) == pytest.approx(1.0 / sway, rel=1e-6)


@given(st.integers(18, 60), st.integers(18, 120), st.integers(3, 7), st.sampled_from([0.5, 0.6, 0.8, 1.0]))
def test_one_set_has_the_webs_it_has_among_many(sun, planet, planets, module):
    one = GearSet(sun_teeth=sun, planet_teeth=planet, ring_teeth=sun + 2 * planet, module_mm=module, planets=planets)
    many = GearSet(
        **{
            name: np.array([getattr(gears, name) for gears in (FIVE, one, THREE)])
            for name in ("sun_teeth", "planet_teeth", "ring_teeth", "module_mm", "planets")
        }
    )
    alone, among = webs_of(one, SETTINGS), webs_of(many, SETTINGS)
    for name in ("count", "room_mm", "r_out_mm", "r_screw_mm"):
        assert np.asarray(getattr(among, name))[1] == pytest.approx(getattr(alone, name), rel=1e-12)
    for name in ("area_mm2", "second_moment_mm4"):
        assert np.asarray(getattr(among.section, name))[1] == pytest.approx(getattr(alone.section, name), rel=1e-12)
        assert not alone.count or getattr(alone.section, name) > 0.0
    assert (among.section.stiffness_n_per_mm(10.0, MATERIALS.aluminium)[1] > 0.0) == bool(alone.count)


def test_no_webs_without_room_with_two_planets_or_by_the_rules_of_the_paper():
    assert webs_of(replace(FIVE, planets=7), SETTINGS).count == 0
    assert webs_of(replace(THREE, planets=2), SETTINGS).count == 0
    assert webs_of(THREE, ActuatorSettings(rules="paper")).count == 0
    assert webs_of(THREE, ActuatorSettings(rules="paper")).section.stiffness_n_per_mm(10.0, MATERIALS.aluminium) == 0.0

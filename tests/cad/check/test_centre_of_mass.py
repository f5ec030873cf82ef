"""Centres of mass: the check did not look at them once, and passed with one moved by 50 mm."""

import dataclasses

import numpy as np
import pytest

from pareto_monoped.cad.check import mass
from pareto_monoped.cad.check.mass import weigh_bodies, weigh_parts
from pareto_monoped.cad.check.result import CENTRE_OF_MASS
from pareto_monoped.geometry.parts import MassProperties
from tests.cad.check.faults import moved, shifted

BODIES = ("base", "thigh", "shank")


def displaced(arrays, body, axis, distance_mm):
    com = arrays.body_com_m.copy()
    com[0, BODIES.index(body), axis] += 1e-3 * distance_mm
    return dataclasses.replace(arrays, body_com_m=com)


@pytest.fixture(scope="module")
def weighed(product):
    return weigh_bodies(product, weigh_parts(product))


@pytest.mark.long
def test_a_displaced_centre_of_mass_is_the_only_failure(arrays, failing):
    assert failing(arrays=displaced(arrays, "base", 0, 50.0)) == ["base has the centre of mass that was simulated"]


@pytest.mark.parametrize("body", BODIES)
@pytest.mark.parametrize(("axis", "distance_mm"), [(0, 50.0), (0, 0.052), (1, -0.052), (2, 0.052)])
def test_a_displaced_centre_of_mass_is_found(arrays, weighed, body, axis, distance_mm):
    checks = mass.check_centre_of_mass(weighed, displaced(arrays, body, axis, distance_mm))
    (check,) = (one for one in checks if not one.passed)
    assert check.name == f"{body} has the centre of mass that was simulated"
    assert check.measured == pytest.approx(abs(distance_mm), abs=2e-3)
    assert check.failures == (f"{body}: centre of mass {check.measured:.2f} mm off what was simulated",)


def test_a_centre_of_mass_within_the_limit_passes(arrays, weighed):
    for axis in range(3):
        checks = mass.check_centre_of_mass(weighed, displaced(arrays, "thigh", axis, 0.95 * CENTRE_OF_MASS.value))
        assert all(check.passed for check in checks)


def test_the_distance_counts_and_not_the_greatest_of_its_components(arrays):
    """Three components of 0.03 mm, each within the limit, are a distance of 0.052 mm."""
    bodies = {
        body: MassProperties(
            mass_kg=np.asarray(2.0), first_kg_m=2.0 * arrays.body_com_m[0, k], second_kg_m2=np.zeros((3, 3))
        )
        for k, body in enumerate(BODIES)
    }
    broken = displaced(displaced(displaced(arrays, "thigh", 0, 0.03), "thigh", 1, -0.03), "thigh", 2, 0.03)
    base, thigh, shank = mass.check_centre_of_mass(bodies, broken)
    assert (base.passed, thigh.passed, shank.passed) == (True, False, True)
    assert thigh.measured == pytest.approx(0.03 * np.sqrt(3.0), abs=1e-6)


def test_a_moved_part_moves_the_centre_of_mass_of_its_body_alone(product):
    """By its share of the mass, in the body's frame: the foot hangs with its y axis along the shank."""
    foot = next(kind for kind in product.unique if kind.name == "foot")
    before = weigh_bodies(product, weigh_parts(product))
    after = weigh_bodies(moved(product, "foot/foot", shifted(y=-7.0)), weigh_parts(product))
    share = float(foot.part.unit_mass_kg()) / float(before["shank"].mass_kg)
    assert 1e3 * (after["shank"].com_m - before["shank"].com_m) == pytest.approx([0.0, 0.0, -7.0 * share], abs=1e-3)
    for body in ("base", "thigh"):
        assert np.array_equal(after[body].com_m, before[body].com_m)

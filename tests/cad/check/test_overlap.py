"""What must not touch does not; planted overlaps are found, named and measured."""

import dataclasses

import numpy as np
import pytest

from pareto_monoped.cad.assembly import turn_z
from pareto_monoped.cad.check import overlap
from pareto_monoped.cad.check.limits import OVERLAP
from tests.cad.check.faults import moved, shifted, with_instance


def raised(product, distance_mm):
    """The product with its foot pushed up along the shank, where the check looks for it in the pose."""
    matrix = shifted(y=distance_mm)
    return with_instance(product, "foot/foot", lambda i: dataclasses.replace(i, world=i.world @ matrix))


def test_a_part_pushed_into_another_is_named(product, examine, failing):
    broken = raised(product, 0.2)
    assert failing(product=broken) == ["no two parts overlap"]
    check = examine(product=broken)["no two parts overlap"]
    (text,) = check.failures
    assert "shank/foot_block and foot/foot overlap by " in text
    assert text.endswith(f"{check.measured:.3f} mm deep, in the pose")
    assert OVERLAP.value < check.measured < 0.2


def test_an_overlap_as_deep_as_facets_passes(product, examine):
    check = examine(product=raised(product, 0.012))["no two parts overlap"]
    assert 0.001 < check.measured < OVERLAP.value
    assert check.passed


def test_a_planet_turned_by_one_degree_is_found(product):
    found, pairs = overlap.in_pose(moved(product, "knee_actuator/planet_2", turn_z(np.radians(1.0))))
    assert {frozenset((o.one, o.other)) for o in found if o.depth_mm > OVERLAP.value} == {
        frozenset(("knee_actuator/planet_2", "knee_actuator/ring")),
        frozenset(("knee_actuator/planet_2", "knee_actuator/sun")),
    }
    assert max(o.volume_mm3 for o in found) > 1.0
    count = len(product.instances)
    assert pairs == count * (count - 1) / 2


def test_the_depth_is_that_of_two_plates_pushed_together():
    """Twice the volume over the surface is the depth of a shallow overlap."""
    import manifold3d as m3

    from pareto_monoped.cad.check.contact import PlacedMesh, overlap_of

    plate = m3.Manifold.cube((100.0, 100.0, 1.0))
    one, other = (PlacedMesh.of(name, plate, shifted(z=z)) for name, z in (("low", 0.0), ("high", 0.95)))
    (found,) = overlap_of(one, other, "here")
    assert found.volume_mm3 == pytest.approx(500.0)
    assert found.depth_mm == pytest.approx(0.05, rel=2e-3)
    assert list(overlap_of(one, PlacedMesh.of("far", plate, shifted(z=1.0)), "here")) == []

"""What must not touch does not; planted overlaps are found, named and measured."""

import dataclasses

import numpy as np
import pytest

from pareto_monoped.cad.assembly import Instance, turn_z
from pareto_monoped.cad.check import overlap
from pareto_monoped.cad.check.result import OVERLAP
from pareto_monoped.cad.product import UniquePart
from pareto_monoped.cad.shape.meshes import mesh_of
from pareto_monoped.geometry.gears import InternalGear
from pareto_monoped.geometry.parts import Part, Prism
from pareto_monoped.geometry.roles import Role
from pareto_monoped.geometry.shapes import Circle, Pattern
from pareto_monoped.materials import MATERIALS
from pareto_monoped.robot.units import PART_TO_BODY
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


def test_an_overlap_as_deep_as_facets_passes(product):
    check = overlap.check(raised(product, 0.012))
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

    from pareto_monoped.cad.check.overlap import PlacedMesh, overlap_of

    plate = m3.Manifold.cube((100.0, 100.0, 1.0))
    one, other = (PlacedMesh.of(name, plate, shifted(z=z)) for name, z in (("low", 0.0), ("high", 0.95)))
    (found,) = overlap_of(one, other, "here")
    assert found.volume_mm3 == pytest.approx(500.0)
    assert found.depth_mm == pytest.approx(0.05, rel=2e-3)
    assert list(overlap_of(one, PlacedMesh.of("far", plate, shifted(z=1.0)), "here")) == []


def turned(name, *prisms):
    return Part(name=name, role=Role.SHAFT, material=MATERIALS.steel, prisms=prisms, process="machined")


def disc(radius_mm, low, high, *holes):
    return Prism(outline=Circle(radius_mm=radius_mm), z0_mm=low, z1_mm=high, holes=holes)


def on_one_axis(product, *parts):
    """A product of a few parts on the hip axis."""
    world = np.eye(4)
    world[:3, :3] = PART_TO_BODY
    return dataclasses.replace(
        product,
        unique=tuple(UniquePart(name=p.name, part=p, mesh=mesh_of(p), count=1, units=("unit",)) for p in parts),
        instances=tuple(
            Instance(name=p.name, unit="unit", part=p, body="base", in_body=world, moves=world, world=world)
            for p in parts
        ),
        kinds=tuple(range(len(parts))),
    )


RING_GEAR = InternalGear(teeth=60, module_mm=1.0)
TEETH = float(RING_GEAR.tip_radius_mm), float(RING_GEAR.root_radius_mm)


@pytest.mark.parametrize(
    ("shaft", "around", "overlaps"),
    [
        (disc(9.9, 0.0, 20.0), disc(30.0, 5.0, 10.0, Circle(radius_mm=10.0)), False),
        (disc(10.2, 0.0, 20.0), disc(30.0, 5.0, 10.0, Circle(radius_mm=10.0)), True),
        (disc(10.0, 0.0, 5.0), disc(30.0, 5.0, 10.0), False),
        (disc(10.0, 0.0, 5.2), disc(30.0, 5.0, 10.0), True),
        # The hole is beside the axis.
        (disc(10.0, 0.0, 20.0), disc(50.0, 5.0, 10.0, Circle(radius_mm=15.0, x_mm=30.0)), True),
        (disc(10.0, 0.0, 20.0), disc(50.0, 5.0, 10.0, Circle(radius_mm=15.0, y_mm=30.0)), True),
        (disc(0.99 * TEETH[0], 0.0, 20.0), disc(40.0, 5.0, 10.0, RING_GEAR), False),
        (disc(0.5 * sum(TEETH), 0.0, 20.0), disc(40.0, 5.0, 10.0, RING_GEAR), True),
    ],
)
def test_parts_on_one_axis_overlap_where_one_meets_the_other(product, shaft, around, overlaps):
    """A second prism of the shaft that is far from the other part changes nothing."""
    parts = turned("shaft", shaft, disc(3.0, shaft.z0_mm - 30.0, shaft.z0_mm)), turned("around", around)
    found, pairs = overlap.in_pose(on_one_axis(product, *parts))
    assert pairs == 1
    assert any(o.depth_mm > OVERLAP.value for o in found) is overlaps


PLATE = turned("plate", disc(20.0, 0.0, 5.0, Pattern(radius_mm=2.0, pitch_radius_mm=10.0, count=4, phase_rad=0.3)))


@pytest.mark.parametrize(
    ("pin", "away_mm", "looked_at", "overlaps"),
    [
        (disc(2.0, -3.0, 8.0), 0.0, False, False),
        (disc(2.1, -3.0, 8.0), 0.0, True, True),
        (disc(1.8, -3.0, 8.0), 0.19, False, False),
        (disc(1.8, -3.0, 8.0), 0.5, True, True),
    ],
)
def test_a_pin_in_a_hole_is_left_to_the_records_and_no_other(product, pin, away_mm, looked_at, overlaps):
    """The plate is turned about its axis, and the pin stands in its third hole."""
    plate, shaft = on_one_axis(product, PLATE, turned("pin", pin)).instances
    turn, place = turn_z(0.7), np.eye(4)
    place[:3, 3] = [*PLATE.prisms[0].holes[0].centres_mm()[2], 0.0]
    place[0, 3] += away_mm
    plate = dataclasses.replace(plate, world=plate.world @ turn)
    shaft = dataclasses.replace(shaft, world=plate.world @ place)
    one, other = (overlap._stack(i, overlap._record(i.part)) for i in (plate, shaft))
    assert overlap._apart(one, other) is overlap._apart(other, one) is not looked_at
    both = dataclasses.replace(on_one_axis(product, plate.part, shaft.part), instances=(plate, shaft))
    found, _ = overlap.in_pose(both)
    assert any(o.depth_mm > OVERLAP.value for o in found) is overlaps


def test_a_pin_that_reaches_a_layer_without_a_hole_is_looked_at(product):
    """Two layers, of which the second has no hole."""
    closed = turned("closed", *PLATE.prisms, disc(20.0, 5.0, 6.0))
    plate, shaft = on_one_axis(product, closed, turned("pin", disc(2.0, 1.0, 5.5))).instances
    place = np.eye(4)
    place[:3, 3] = [*PLATE.prisms[0].holes[0].centres_mm()[0], 0.0]
    shaft = dataclasses.replace(shaft, world=plate.world @ place)
    assert not overlap._apart(*(overlap._stack(i, overlap._record(i.part)) for i in (plate, shaft)))

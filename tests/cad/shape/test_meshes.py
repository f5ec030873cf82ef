"""Meshes stay closed in their files: what rounding would merge is welded or moved apart, all else stays as it is."""

import dataclasses

import numpy as np
import pytest

from pareto_monoped.cad.shape import meshes
from pareto_monoped.cad.shape.meshes import flaws
from pareto_monoped.geometry.features import Bevel
from pareto_monoped.geometry.parts import Ball, Prism
from pareto_monoped.geometry.shapes import Circle, rectangle

TOLERANCE_MM = 0.1
HERE = np.eye(4)


def mesh(prisms=(), balls=()):
    return meshes._mesh(tuple(prisms), tuple(balls), (), TOLERANCE_MM)


def disc(radius_mm, z0_mm, z1_mm, hole_mm):
    return Prism(outline=Circle(radius_mm=radius_mm), z0_mm=z0_mm, z1_mm=z1_mm, holes=(Circle(radius_mm=hole_mm),))


def at(x=0.0, y=0.0, z=0.0):
    matrix = np.eye(4)
    matrix[:3, 3] = (x, y, z)
    return matrix


def test_a_foot_s_pocket_leaves_no_points_that_merge():
    """The pocket's rim and the flat of the ball differed by 3e-9 mm: four triangles of foot.stl had no area."""
    pocket = Prism(outline=rectangle(width_mm=16.0, height_mm=15.0, y_mm=-347.7), z0_mm=-5.0, z1_mm=5.0)
    ball = Ball(radius_mm=33.0, y_mm=-360.0, top_mm=19.8, pocket=pocket)
    raw = meshes.mesh_from(meshes._ball(ball, TOLERANCE_MM))
    welded = mesh(balls=(ball,))
    assert flaws(welded.points_mm[welded.triangles]) == ""
    assert "no area" in flaws(raw.points_mm[raw.triangles])
    assert welded.volume_mm3 == pytest.approx(float(ball.integrals()[0]), rel=0.03)


def test_short_edges_are_welded_and_nothing_else_moves():
    points = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [0, 0, 1 + 0.5 * meshes.WELD_MM]])
    triangles = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 4], [1, 4, 3], [2, 3, 4]])
    raw = meshes.Mesh(points_mm=points, triangles=triangles, body=None)
    welded = meshes._welded(raw)
    assert np.array_equal(welded.points_mm, points[:4])
    assert welded.triangles.tolist() == [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]
    points[4, 2] = 1.0 + 1.5 * meshes.WELD_MM
    longer = meshes.Mesh(points_mm=points, triangles=triangles, body=None)
    assert meshes._welded(longer) is longer


def test_prisms_that_rounding_sets_apart_are_united():
    """z0 + (z1 - z0) is not z1 here: the casing of a MAD_M6C12 at 4.375 to 1 was two bodies that touch."""
    prisms = [
        disc(43.0, -60.009414936981884, -57.009414936981884, 38.3),
        disc(40.3, -57.009414936981884, -23.50941493698188, 38.3),
        disc(40.3, -23.50941493698188, -21.50941493698188, 29.0),
    ]
    # A bolt's hole beside the bore, as the casing has: slices with a bore alone are regrouped before.
    bolt = Circle(radius_mm=0.5, x_mm=39.3)
    prisms = [dataclasses.replace(prism, holes=(*prism.holes, bolt)) for prism in prisms]
    apart = meshes._united(prisms, (), (), TOLERANCE_MM)
    assert len(apart.body.decompose()) == 2
    assert flaws(apart.points_mm[apart.triangles])
    united = mesh(prisms)
    assert len(united.body.decompose()) == 1
    assert flaws(united.points_mm[united.triangles]) == ""
    assert united.volume_mm3 == pytest.approx(apart.volume_mm3, rel=1e-9)


def test_parts_that_touch_are_moved_apart_by_micrometres():
    ring = mesh([disc(10.0, 0.0, 2.0, 5.0)])
    stack = [(ring, at(z=2.0 * k)) for k in range(4)] + [(ring, at(x=50.0))]
    merged = np.concatenate([(one.points_mm + matrix[:3, 3])[one.triangles] for one, matrix in stack])
    assert "do not border two triangles" in flaws(1e-3 * merged)
    whole = meshes.joined(stack, 1e-3)
    assert not flaws(1e-3 * whole.points_mm[whole.triangles])
    moved = (whole.points_mm[whole.triangles] - merged).reshape(5, -1, 3)
    assert np.abs(moved[:, :, [0, 2]]).max() < 1e-12
    steps = moved[:, :, 1] / meshes.APART_MM
    assert steps == pytest.approx(np.broadcast_to(np.round(steps[:, :1]), steps.shape), abs=1e-6)
    # Neighbours in the stack stand at different heights; the first and the one that touches nothing stay.
    assert steps[0, 0] == steps[4, 0] == 0.0
    assert np.all(np.round(np.diff(steps[:4, 0])) != 0.0)
    assert np.abs(steps).max() < 4.0
    assert whole.volume_mm3 == pytest.approx(5.0 * ring.volume_mm3)
    assert np.asarray(whole.body.bounding_box()) == pytest.approx(
        [*whole.points_mm.min(axis=0), *whole.points_mm.max(axis=0)]
    )


def test_parts_that_do_not_touch_keep_every_bit():
    ring = mesh([disc(10.0, 0.0, 2.0, 5.0)])
    above = ring.points_mm + np.array([0.0, 0.0, 2.5])
    whole = meshes.joined([(ring, HERE), (ring, at(z=2.5))], 1e-3)
    assert np.array_equal(whole.points_mm, np.concatenate([ring.points_mm, above]))


def plate_with(**bevel):
    """A disc of radius 20 mm with a hole of 3 mm, from z = 5 to 8 mm, and a countersink of 4 mm from above."""
    one = {"at": Circle(radius_mm=3.0), "edge_mm": 4.0, "face_mm": 8.0, "end_mm": 7.0, "hole": True} | bevel
    return meshes._mesh((disc(20.0, 5.0, 8.0, 3.0),), (), (Bevel(**one),), 0.001)


def test_a_countersink_takes_away_a_cone_less_its_hole():
    whole = meshes._mesh((disc(20.0, 5.0, 8.0, 3.0),), (), (), 0.001)
    cone = np.pi / 3.0 * (4.0**2 + 4.0 * 3.0 + 3.0**2) - np.pi * 3.0**2
    plate = plate_with()
    assert flaws(plate.points_mm[plate.triangles]) == ""
    assert whole.volume_mm3 - plate.volume_mm3 == pytest.approx(cone, rel=0.002)


@pytest.mark.parametrize(
    ("bevel", "said"),
    [
        ({"at": Circle(radius_mm=3.5)}, "8) mm, 1 mm deep: must stand on an edge of radius 3.5 mm"),
        ({"face_mm": 7.5, "end_mm": 7.0}, "7.5) mm, 0.5 mm deep: must stand on an edge of radius 3 mm"),
        ({"end_mm": 4.0}, "8) mm, 4 mm deep: .* be less deep than its cylinder"),
        ({"end_mm": 5.0}, "8) mm, 3 mm deep: .* be less deep than its cylinder"),
    ],
)
def test_a_bevel_that_its_cylinder_cannot_have_is_refused(bevel, said):
    with pytest.raises(ValueError, match=said.replace(")", "\\)")):
        plate_with(**bevel)

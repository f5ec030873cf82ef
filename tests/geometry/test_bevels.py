"""Cones on cylinders: integrals against quadrature and against textbook frustums."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pareto_monoped.geometry.features import Bevel, CountersunkHead, Hole, Mouth, ShaftEnd, bored, turned
from pareto_monoped.geometry.parts import Part, Prism
from pareto_monoped.geometry.roles import Role
from pareto_monoped.geometry.screws import M3, M4, clearance, tapped
from pareto_monoped.geometry.shapes import Circle, Pattern
from pareto_monoped.materials import Material

STEEL = Material(name="steel", density_kg_per_m3=7850.0, colour=(0.5, 0.5, 0.5))
sizes = st.floats(0.2, 20.0)
places = st.floats(-30.0, 30.0)


def by_quadrature(bevel, x, y):
    """The integrals over one ring as sums over thin washers, each of them in closed form."""
    nodes, weights = np.polynomial.legendre.leggauss(8)
    share = 0.5 * (nodes + 1.0)
    a, b = bevel.edge_mm, bevel.at.radius_mm
    z = bevel.face_mm + share * (bevel.end_mm - bevel.face_mm)
    dz = 0.5 * weights * abs(bevel.end_mm - bevel.face_mm)
    radius = a + share * (b - a)
    sign = -1.0 if bevel.hole else 1.0
    area, second = sign * np.pi * (radius**2 - b**2), sign * 0.25 * np.pi * (radius**4 - b**4)
    return np.array(
        [
            np.sum(area * dz),
            np.sum(area * x * dz),
            np.sum(area * y * dz),
            np.sum(area * z * dz),
            np.sum((second + area * x * x) * dz),
            np.sum((second + area * y * y) * dz),
            np.sum(area * z * z * dz),
            np.sum(area * x * y * dz),
            np.sum(area * x * z * dz),
            np.sum(area * y * z * dz),
        ]
    )


@given(sizes, sizes, places, places, places, places, st.booleans())
def test_a_ring_has_the_integrals_of_its_washers(wall, edge, face, end, x, y, hole):
    bevel = Bevel(at=Circle(radius_mm=wall, x_mm=x, y_mm=y), edge_mm=edge, face_mm=face, end_mm=end, hole=hole)
    expected = by_quadrature(bevel, x, y)
    assert np.array(bevel.integrals(), dtype=float) == pytest.approx(expected, rel=1e-9, abs=1e-6)


def test_rings_on_a_circle_are_the_sum_of_single_ones():
    at = Pattern(radius_mm=1.6, pitch_radius_mm=12.0, count=5, phase_rad=0.3, x_mm=2.0, y_mm=-7.0)
    bevel = Bevel(at=at, edge_mm=3.36, face_mm=4.0, end_mm=2.24, hole=True)
    expected = sum(by_quadrature(bevel, x, y) for x, y in bevel.centres_mm())
    assert len(bevel.centres_mm()) == 5
    assert np.array(bevel.integrals(), dtype=float) == pytest.approx(expected, rel=1e-12, abs=1e-9)


def test_arrays_give_the_same_as_single_numbers():
    edges, faces = np.array([2.0, 1.5, 3.36]), np.array([0.0, 1.0, -4.0])
    at = Circle(radius_mm=1.5, x_mm=3.0)
    many = Bevel(at=at, edge_mm=edges, face_mm=faces, end_mm=faces + 0.7, hole=True).integrals()
    for k in range(3):
        one = Bevel(at=at, edge_mm=edges[k], face_mm=faces[k], end_mm=faces[k] + 0.7, hole=True).integrals()
        assert [float(value[k]) for value in np.broadcast_arrays(*many)] == [float(value) for value in one]
    assert np.array(many[0])[1] == 0.0  # as wide as its hole


def frustum_mm3(a, b, h):
    return np.pi * h / 3.0 * (a * a + a * b + b * b)


def plate(*features, holes=()):
    return Part(
        name="plate",
        role=Role.PLATE,
        material=STEEL,
        process="laser cut",
        prisms=(Prism(outline=Circle(radius_mm=20.0), z0_mm=1.0, z1_mm=4.0, holes=holes),),
        features=features,
    )


def test_a_countersink_takes_a_frustum_less_its_hole():
    holes = Pattern(radius_mm=1.6, pitch_radius_mm=12.0, count=6)
    sunk = plate(clearance(M3, (holes,), 1.0, 4.0, countersunk="high"), holes=(holes,))
    (cone,) = sunk.bevels
    assert (cone.face_mm, cone.end_mm) == (4.0, pytest.approx(4.0 - (3.36 - 1.6)))
    ring = frustum_mm3(3.36, 1.6, 1.76) - np.pi * 1.6**2 * 1.76
    assert plate(holes=(holes,)).volume_mm3() - sunk.volume_mm3() == pytest.approx(6 * ring)


def test_a_tapped_hole_has_its_thread_and_leads_at_the_ends_where_screws_enter():
    holes = (Circle(radius_mm=M4.core, x_mm=5.0), Circle(radius_mm=M4.core, x_mm=-5.0))
    hole = tapped(M4, holes, 1.0, 4.0, enters="both")
    assert hole.thread.text == "M4x0.7 - 6H"
    assert hole.thread.diameter_mm - hole.thread.pitch_mm == pytest.approx(2.0 * M4.core)  # ISO 2306: the drill
    assert [(c.face_mm, round(float(c.end_mm), 9), c.edge_mm) for c in hole.bevels] == [
        (1.0, 1.35, 2.0),
        (4.0, 3.65, 2.0),
    ] * 2
    assert [c.face_mm for c in tapped(M4, holes, 1.0, 4.0, enters="low").bevels] == [1.0, 1.0]


def test_shafts_lose_chamfers_and_gain_heads():
    shaft = Circle(radius_mm=10.0)
    (chamfer,) = ShaftEnd(at=shaft, face_mm=4.0, inwards=-1.0, width_mm=0.5, depth_mm=1.5).bevels
    assert chamfer.integrals()[0] == pytest.approx(frustum_mm3(9.5, 10.0, 1.5) - np.pi * 100.0 * 1.5)
    (head,) = CountersunkHead(shank_mm=1.5, radius_mm=3.36, face_mm=-2.0, inwards=1.0).bevels
    assert head.end_mm == pytest.approx(-0.14)
    assert head.integrals()[0] == pytest.approx(frustum_mm3(3.36, 1.5, 1.86) - np.pi * 1.5**2 * 1.86)


def test_mass_and_inertia_count_cones():
    """A disc with a cone in its bore, against the disc and the cone weighed apart."""
    bore = Circle(radius_mm=5.0)
    mouth = Mouth(radius_mm=6.0, depth_mm=2.0)
    holed = plate(Hole(shapes=(bore,), low_mm=1.0, high_mm=4.0, low=mouth), holes=(bore,)).mass_properties()
    plain = plate(holes=(bore,)).mass_properties()
    lost = frustum_mm3(6.0, 5.0, 2.0) - np.pi * 25.0 * 2.0
    assert plain.mass_kg - holed.mass_kg == pytest.approx(lost * 7.85e-6)
    # Axial moment of a frustum: pi h / 10 (a^5 - b^5) / (a - b) (any table of solids).
    axial = 0.1 * np.pi * 2.0 * (6.0**5 - 5.0**5) / (6.0 - 5.0) - 0.5 * np.pi * 5.0**4 * 2.0
    assert plain.inertia_kg_m2[2, 2] - holed.inertia_kg_m2[2, 2] == pytest.approx(axial * 7.85e-12)


def test_bores_and_turned_ends_lead_in_where_something_enters():
    bore = Circle(radius_mm=16.0)
    ((both_low, both_high), (press,)) = (
        bored(bore, 0.0, 7.0, enters="both").bevels,
        bored(bore, 0.0, 7.0, enters="high", pressed=True).bevels,
    )
    assert (both_low.face_mm, both_low.end_mm, both_low.edge_mm) == (0.0, 0.3, 16.3)
    assert (both_high.face_mm, both_high.end_mm) == (7.0, 6.7)
    assert (press.face_mm, press.end_mm, press.edge_mm) == (7.0, pytest.approx(6.4), 16.2)
    (end,) = turned(10.0, -3.0, 1.0).bevels
    assert (end.face_mm, end.end_mm, end.edge_mm, end.hole) == (-3.0, -2.7, 9.7, False)

"""Masses and inertias of parts against textbook bodies, grids, and the rules of adding and moving bodies."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pareto_monoped.geometry.parts import MassProperties, Part, Prism, total
from pareto_monoped.geometry.roles import Role
from pareto_monoped.geometry.shapes import Circle, Pattern, rectangle
from pareto_monoped.materials import Material

ALUMINIUM = Material(name="aluminium", density_kg_per_m3=2710.0, colour=(0.8, 0.8, 0.8))
sizes = st.floats(min_value=1.0, max_value=60.0)


def part(*prisms, **changes):
    return Part(name="thing", role=Role.PLATE, material=ALUMINIUM, prisms=prisms, process="machined", **changes)


@given(radius=sizes, height=sizes, z=st.floats(min_value=-50.0, max_value=50.0))
def test_cylinder_is_the_textbook_cylinder(radius, height, z):
    properties = part(Prism(outline=Circle(radius_mm=radius), z0_mm=z, z1_mm=z + height)).mass_properties()
    r, h = radius * 1e-3, height * 1e-3
    mass = np.pi * r * r * h * 2710.0
    across = mass * (3.0 * r * r + h * h) / 12.0
    assert properties.mass_kg == pytest.approx(mass, rel=1e-12)
    assert properties.com_m == pytest.approx([0.0, 0.0, (z + height / 2) * 1e-3], abs=1e-15)
    expected = np.diag([across, across, 0.5 * mass * r * r])
    assert properties.inertia_kg_m2 == pytest.approx(expected, rel=1e-6, abs=1e-15)


@given(a=sizes, b=sizes, c=sizes)
def test_box_off_centre_is_the_textbook_box(a, b, c):
    prism = Prism(outline=rectangle(width_mm=a, height_mm=b, x_mm=30.0, y_mm=-12.0), z0_mm=4.0, z1_mm=4.0 + c)
    properties = part(prism).mass_properties()
    mass = a * b * c * 1e-9 * 2710.0
    expected = mass / 12.0 * 1e-6 * np.diag([b * b + c * c, a * a + c * c, a * a + b * b])
    assert properties.mass_kg == pytest.approx(mass, rel=1e-10)
    assert properties.com_m == pytest.approx([0.03, -0.012, (4.0 + c / 2) * 1e-3], rel=1e-9)
    # Moving back to the centre subtracts numbers some thousand times larger than what is left.
    assert properties.inertia_kg_m2 == pytest.approx(expected, rel=1e-7, abs=1e-12 * mass)


def test_a_hole_takes_away_what_fills_it():
    hole = Circle(radius_mm=5.0, x_mm=8.0)
    solid = part(Prism(outline=Circle(radius_mm=20.0), z0_mm=0.0, z1_mm=6.0))
    pierced = part(Prism(outline=Circle(radius_mm=20.0), z0_mm=0.0, z1_mm=6.0, holes=(hole,)))
    plug = part(Prism(outline=hole, z0_mm=0.0, z1_mm=6.0))
    both = pierced.mass_properties() + plug.mass_properties()
    assert both.mass_kg == pytest.approx(solid.mass_properties().mass_kg)
    assert both.first_kg_m == pytest.approx(solid.mass_properties().first_kg_m, abs=1e-18)
    assert both.second_kg_m2 == pytest.approx(solid.mass_properties().second_kg_m2, abs=1e-15)


@pytest.mark.parametrize("count", [3, 4, 6])
def test_instances_on_a_circle_are_copies_moved_there(count):
    prism = Prism(outline=rectangle(width_mm=4.0, height_mm=9.0), z0_mm=1.0, z1_mm=7.0)
    ring = part(prism, count=count, pitch_radius_mm=25.0)
    single = part(prism).mass_properties()
    copies = []
    for k in range(count):
        c, s = np.cos(2 * np.pi * k / count), np.sin(2 * np.pi * k / count)
        turn = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
        copies.append(single.placed(turn, 0.025 * np.array([c, s, 0.0])))
    expected = total(copies)
    got = ring.mass_properties()
    assert got.mass_kg == pytest.approx(expected.mass_kg)
    assert got.first_kg_m == pytest.approx(expected.first_kg_m, abs=1e-12)
    assert got.second_kg_m2 == pytest.approx(expected.second_kg_m2, rel=1e-9, abs=1e-14)
    assert ring.mass_kg() == pytest.approx(count * part(prism).mass_kg())


def test_catalogue_mass_replaces_the_density_and_keeps_the_shape():
    prism = Prism(outline=Circle(radius_mm=20.0), z0_mm=0.0, z1_mm=10.0, holes=(Circle(radius_mm=15.0),))
    plain, bought = part(prism), part(prism, catalogue_mass_kg=0.031, count=2)
    assert bought.mass_kg() == pytest.approx(0.062)
    assert bought.unit_mass_kg() == pytest.approx(0.031)
    scale = 0.062 / plain.mass_kg()
    assert bought.mass_properties().inertia_kg_m2 == pytest.approx(plain.mass_properties().inertia_kg_m2 * scale)


@given(
    angle=st.floats(min_value=-3.0, max_value=3.0),
    move=st.tuples(*[st.floats(min_value=-0.3, max_value=0.3)] * 3),
)
def test_placing_keeps_mass_and_principal_inertias(angle, move):
    body = part(Prism(outline=rectangle(width_mm=40.0, height_mm=10.0, x_mm=5.0), z0_mm=0.0, z1_mm=70.0))
    before = body.mass_properties()
    c, s = np.cos(angle), np.sin(angle)
    turn = np.array([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]])
    after = before.placed(turn, np.array(move))
    assert after.mass_kg == pytest.approx(before.mass_kg)
    assert after.com_m == pytest.approx(turn @ before.com_m + np.array(move), abs=1e-12)
    eigenvalues = (np.linalg.eigvalsh(p.inertia_kg_m2) for p in (before, after))
    assert next(eigenvalues) == pytest.approx(next(eigenvalues), rel=1e-6)


def test_a_population_weighs_what_its_members_do():
    radii, counts = np.array([10.0, 12.5, 30.0]), np.array([3, 4, 5])

    def ring(radius, count):
        holes = (Circle(radius_mm=0.3 * radius), Pattern(radius_mm=1.0, pitch_radius_mm=0.6 * radius, count=count))
        prism = Prism(outline=Circle(radius_mm=radius), z0_mm=-radius, z1_mm=2.0, holes=holes)
        return part(prism, count=count, pitch_radius_mm=2.0 * radius)

    many = ring(radii, counts)
    for index in range(3):
        one = ring(float(radii[index]), int(counts[index]))
        assert np.asarray(many.mass_kg())[index] == pytest.approx(one.mass_kg(), rel=1e-14)
        properties = many.mass_properties()
        assert properties.second_kg_m2[index] == pytest.approx(one.mass_properties().second_kg_m2, rel=1e-12)


def test_the_inertia_about_z_is_the_last_of_the_tensor_to_the_last_bit():
    rng = np.random.default_rng(4)
    for shape in ((), (7,), (3, 4)):
        body = MassProperties(
            mass_kg=rng.uniform(0.1, 2.0, shape),
            first_kg_m=rng.normal(size=(*shape, 3)),
            second_kg_m2=rng.normal(size=(*shape, 3, 3)) * rng.choice([1e-6, 1.0, 1e3], (*shape, 3, 3)),
        )
        assert np.array_equal(body.inertia_about_z_kg_m2, body.inertia_kg_m2[..., 2, 2])


def test_nothing_is_the_neutral_element():
    body = part(Prism(outline=Circle(radius_mm=3.0), z0_mm=0.0, z1_mm=1.0)).mass_properties()
    assert (MassProperties.zero() + body).second_kg_m2 == pytest.approx(body.second_kg_m2)
    assert MassProperties.zero().com_m == pytest.approx(0.0)

"""Balls and repeated places of parts, against brute-force sums over small cubes and against moved copies."""

import numpy as np
import pytest

from pareto_monoped.geometry.parts import Ball, Part, Prism, total
from pareto_monoped.geometry.roles import Role
from pareto_monoped.geometry.shapes import Circle, rectangle
from pareto_monoped.materials import Material

STEEL = Material(name="steel", density_kg_per_m3=7850.0, colour=(0.5, 0.5, 0.5))


@pytest.mark.parametrize("top_mm", [33.0, 20.0, 0.0, -5.0])
def test_integrals_of_a_cut_ball_match_a_fine_grid(top_mm):
    ball = Ball(radius_mm=33.0, y_mm=-12.0, top_mm=top_mm)
    step = 0.5
    axis = np.arange(-33.0 + step / 2, 33.0, step)
    x, t, z = np.meshgrid(axis, axis, axis, indexing="ij")
    inside = (x**2 + t**2 + z**2 <= 33.0**2) & (t <= top_mm)
    x, y, z = x[inside], t[inside] - 12.0, z[inside]
    grid = [np.sum(v) * step**3 for v in (np.ones_like(x), x, y, z, x * x, y * y, z * z, x * y, x * z, y * z)]
    scale = np.array([1.0] + [33.0] * 3 + [33.0**2] * 6) * grid[0]
    assert np.abs(np.array(ball.integrals()) - grid) / scale == pytest.approx(0.0, abs=2e-3)


def test_whole_ball_is_the_textbook_ball():
    part = Part(
        name="ball",
        role=Role.FOOT,
        material=STEEL,
        prisms=(),
        balls=(Ball(radius_mm=10.0, y_mm=0.0, top_mm=10.0),),
        process="bought",
    )
    mass = 4.0 / 3.0 * np.pi * 0.01**3 * 7850.0
    assert part.mass_kg() == pytest.approx(mass, rel=1e-12)
    assert part.mass_properties().inertia_kg_m2 == pytest.approx(np.eye(3) * 0.4 * mass * 0.01**2, rel=1e-12)


def test_a_pocket_takes_its_own_moments_away():
    pocket = Prism(outline=rectangle(width_mm=4.0, height_mm=6.0, y_mm=2.0), z0_mm=-2.0, z1_mm=2.0)
    plain = Ball(radius_mm=10.0, y_mm=0.0, top_mm=5.0)
    hollow = Ball(radius_mm=10.0, y_mm=0.0, top_mm=5.0, pocket=pocket)
    difference = np.array(plain.integrals()) - np.array(hollow.integrals())
    assert difference == pytest.approx(np.array(pocket.integrals()))


def test_places_are_moved_copies_with_every_length_of_a_population():
    lengths = np.array([300.0, 400.0])
    pin = Prism(outline=Circle(radius_mm=1.5), z0_mm=-3.0, z1_mm=5.0)
    places = ((4.0, -lengths, 0.0), (-4.0, -0.5 * lengths, 2.0))
    several = Part(
        name="pin",
        role=Role.PIN,
        material=STEEL,
        prisms=(pin,),
        process="bought",
        count=4,
        pitch_radius_mm=12.0,
        places_mm=places,
    )
    one = Part(
        name="pin", role=Role.PIN, material=STEEL, prisms=(pin,), process="bought", count=4, pitch_radius_mm=12.0
    )
    for index, length in enumerate(lengths):
        moves = [np.array([4.0, -length, 0.0]), np.array([-4.0, -0.5 * length, 2.0])]
        expected = total(one.mass_properties().placed(translation_m=move * 1e-3) for move in moves)
        found = several.mass_properties()
        assert several.mass_kg() == pytest.approx(2 * one.mass_kg())
        assert found.mass_kg[index] == pytest.approx(expected.mass_kg, rel=1e-12)
        assert found.com_m[index] == pytest.approx(expected.com_m, rel=1e-12)
        assert found.inertia_kg_m2[index] == pytest.approx(expected.inertia_kg_m2, rel=1e-9, abs=1e-12)

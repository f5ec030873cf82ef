"""Dowels have catalogue lengths, fill their holes and name what holds them."""

import numpy as np
import pytest

from pareto_monoped.errors import DesignError
from pareto_monoped.geometry.dowels import Dowel, dowel_part
from pareto_monoped.geometry.making import interference_mm
from pareto_monoped.geometry.roles import JointKind, Role
from pareto_monoped.geometry.shapes import Pattern
from pareto_monoped.materials import MATERIALS


def part(room_mm, direction=1.0):
    return dowel_part(
        "dowel",
        Dowel(diameter_mm=3.0),
        end_mm=-5.0,
        room_mm=room_mm,
        direction=direction,
        holes=Pattern(radius_mm=1.5, pitch_radius_mm=10.0, count=3, phase_rad=0.5),
        partner="plate",
    )


@pytest.mark.parametrize(("room_mm", "length_mm"), [(8.0, 8.0), (9.9, 8.0), (10.0, 10.0), (50.0, 30.0)])
def test_the_longest_length_sold_is_taken(room_mm, length_mm):
    assert Dowel(diameter_mm=3.0).length_mm(room_mm) == length_mm
    found = part(room_mm)
    assert (found.prisms[0].z0_mm, found.prisms[0].z1_mm) == (-5.0, length_mm - 5.0)
    assert [one.designation for one in found.purchases] == [f"parallel pin ISO 8734 - 3 m6 x {length_mm:g} - A - St"]


def test_a_population_has_its_own_lengths():
    assert Dowel(diameter_mm=3.0).length_mm(np.array([8.5, 12.0])).tolist() == [8.0, 12.0]


def test_the_other_direction_reaches_down():
    assert (part(8.0, -1.0).prisms[0].z0_mm, part(8.0, -1.0).prisms[0].z1_mm) == (-13.0, -5.0)


def test_mass_role_and_joint():
    found = part(8.0)
    assert found.mass_kg() == pytest.approx(3 * np.pi * 1.5**2 * 8.0 * 1e-9 * MATERIALS.steel.density_kg_per_m3)
    assert (found.role, found.joint.kind, found.joint.partner) == (Role.PIN, JointKind.BONDED, "plate")
    assert [fit.text for fit in found.fits] == ["3 m6"]


def test_too_little_room_is_refused():
    with pytest.raises(
        DesignError, match=r"^dowel of 3 mm with room for 7\.9 mm: must have room for 8 mm; make a plate"
    ):
        Dowel(diameter_mm=3.0).length_mm(7.9)


@pytest.mark.parametrize("diameter_mm", [2.5, 3.0, 4.0])
def test_the_fit_is_a_slight_press_at_most(diameter_mm):
    """H7/m6 overlaps by 3 per mille at most: more would yield aluminium around small pins, see strength.press_fit."""
    dowel = Dowel(diameter_mm=diameter_mm)
    least, most = interference_mm(diameter_mm, dowel.hole_fit.zone, dowel.fit.zone)
    assert least < 0.0 < most <= 3.3e-3 * diameter_mm

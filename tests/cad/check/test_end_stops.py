"""End stops meet where the joints' ranges end; a stop that is off, missing or blocked is found."""

import dataclasses

import numpy as np
import pytest

from pareto_monoped.cad.check import free_motion
from pareto_monoped.cad.check.result import END_STOP
from pareto_monoped.cad.product import build_product
from pareto_monoped.geometry.roles import Role
from tests.cad.check.faults import bare, with_unit


def stops_of(product):
    """The check of the end stops."""
    return next(check for check in free_motion.check_free_motion(product) if check.name == END_STOP.name)


def moved_parts(names, x=0.0, y=0.0):
    """A change of a unit that moves some of its parts, in mm."""

    def change(unit):
        assert set(names) <= {part.name for part in unit.parts}
        parts = tuple(
            dataclasses.replace(part, places_mm=tuple((a + x, b + y, c) for a, b, c in part.places_mm))
            if part.name in names
            else part
            for part in unit.parts
        )
        return dataclasses.replace(unit, parts=parts)

    return change


def without_role(role):
    """A change of a unit that leaves out its parts of a role."""
    return lambda unit: dataclasses.replace(unit, parts=tuple(part for part in unit.parts if part.role is not role))


def test_all_four_ends_meet_within_a_twentieth_of_a_degree(product):
    check = stops_of(build_product(bare(product.robot), product.pose))
    assert check.passed
    assert check.measured < 0.05


@pytest.mark.parametrize(
    ("unit", "names", "shift", "end", "least_deg"),
    [
        ("thigh", ("knee_seat_extension", "knee_bumper_extension"), {"x": -1.0}, "knee at 15.0", 0.8),
        ("thigh", ("knee_seat_flexion", "knee_bumper_flexion"), {"x": 1.0}, "knee at 133.0", 0.9),
        ("shank", ("knee_striker",), {"x": 1.0}, "knee at 133.0", 0.7),
        ("base_frame", ("hip_seat_front", "hip_bumper_front"), {"y": -1.0}, "hip at -100.0", 0.8),
        ("thigh", ("hip_striker_rear",), {"x": -1.0}, "hip at 100.0", 0.8),
    ],
)
def test_a_seat_or_striker_that_is_1_mm_off_is_found(product, unit, names, shift, end, least_deg):
    check = stops_of(with_unit(product, unit, moved_parts(names, **shift)))
    assert not check.passed
    assert check.failures[0].startswith(f"{end} deg: bumper and striker meet at ")
    # 1 mm on a lever of 51 mm is 1.12 degrees, across the face; the worst of a part with two faces is reported.
    assert least_deg < check.measured < 1.2


@pytest.mark.parametrize(
    ("unit", "role", "ends"),
    [
        ("shank", Role.STRIKER, ("knee at 15.0", "knee at 133.0")),
        ("thigh", Role.STRIKER, ("hip at -100.0", "hip at 100.0")),
        ("thigh", Role.BUMPER, ("knee at 15.0", "knee at 133.0")),
        ("base_frame", Role.BUMPER, ("hip at -100.0", "hip at 100.0")),
    ],
)
def test_a_stop_without_striker_or_bumper_is_found(product, unit, role, ends):
    check = stops_of(with_unit(product, unit, without_role(role)))
    assert set(check.failures) == {f"{end} deg: no bumper meets a striker" for end in ends}
    assert check.measured == 180.0


def test_metal_that_meets_before_a_bumper_is_fully_squeezed_is_found(product):
    """The flexion seat 4 mm off its edge, under a bumper that stays: the striker then runs into the seat's lips."""

    def thicker(unit):
        return moved_parts(("knee_seat_flexion",), x=-8.0)(unit)

    (failure,) = free_motion.check_free_motion(with_unit(product, "thigh", thicker))[0].failures
    assert failure.startswith("thigh/knee_seat_flexion and shank/knee_striker overlap")
    angle = float(failure.split()[-2])
    assert angle > np.degrees(2.4435)


def test_a_part_that_meets_a_bumper_within_the_range_is_found(product):
    """The core's upper end in the way of the flexion bumper."""
    unit_parts = {part.name for unit in product.robot.units if unit.name == "shank" for part in unit.parts}
    assert "shank_core" in unit_parts
    failures = free_motion.check_free_motion(with_unit(product, "shank", moved_parts(("shank_core",), y=25.0)))[
        0
    ].failures
    assert any(text.startswith("thigh/knee_bumper_flexion and shank/shank_core overlap") for text in failures)

"""The leg folds freely; parts in its way are found, and so is a shank that reaches the base."""

import dataclasses
import re

import manifold3d as m3
import numpy as np
import pytest

from pareto_monoped.cad.assembly import Pose, body_frames, instances
from pareto_monoped.cad.check import free_motion
from pareto_monoped.cad.check.overlap import PlacedMesh
from pareto_monoped.cad.check.result import FREE_MOTION
from pareto_monoped.cad.product import build_product
from pareto_monoped.leg.stops import hip_stop, knee_stop
from pareto_monoped.robot.build import build_robot
from tests.cad.check.faults import bare, shifted, with_unit

ZERO = Pose(hip_rad=0.0, knee_rad=0.0)


def with_range(monkeypatch, joint, **angles):
    """Let a joint be looked at through another range."""
    true = getattr(free_motion, f"{joint}_stop")
    monkeypatch.setattr(free_motion, f"{joint}_stop", lambda d: dataclasses.replace(true(d), **angles))


@pytest.mark.long
def test_a_range_that_leads_the_thigh_into_the_frame_is_found(examine, failing, monkeypatch):
    with_range(monkeypatch, "hip", upper_rad=3.14)
    assert failing() == ["the leg moves freely", "end stops meet at the ends of the ranges"]
    check = examine()["the leg moves freely"]
    assert check.measured > FREE_MOTION.value
    assert all(" with the hip at 1" in text and "base_frame/" in text and "thigh/" in text for text in check.failures)


@pytest.mark.long
def test_a_range_that_leads_the_shank_into_the_thigh_is_found(examine, monkeypatch):
    with_range(monkeypatch, "knee", lower_rad=-3.14)
    check = examine()["the leg moves freely"]
    assert not check.passed
    assert all(" with the knee at -" in text for text in check.failures)


@pytest.fixture(scope="module")
def small(product):
    """The robot without its actuators."""
    return build_product(bare(product.robot), product.pose)


def test_a_shank_that_reaches_the_base_is_found(small, examine, monkeypatch):
    monkeypatch.setattr(free_motion, "_shank_clearance_mm", lambda *_: -3.21)
    (check,) = (one for one in free_motion.check_free_motion(small) if not one.passed)
    assert check.name == "the shank passes the base"
    assert check.name in examine()
    assert check.failures == ("shank and base come 3.2 mm into each other's reach",)
    assert check.measured == -3.21


def test_the_shank_s_clearance_is_the_least_distance_of_its_points_from_the_reach_of_the_base(product, small):
    """Slowly: all corners, the knee in small steps; corners alone may miss the nearest point by a facet's depth.

    Parts that have no common stretch along the axis pass each other at any distance from it.
    """
    robot = small.robot
    clearance = free_motion.check_free_motion(small)[-1].measured
    bodies = {"base": [], "shank": []}
    for instance, kind in zip(instances(robot, ZERO), small.kinds, strict=True):
        if instance.body in bodies:
            points = small.unique[kind].mesh.points_mm
            bodies[instance.body].append(points @ instance.in_body[:3, :3].T + instance.in_body[:3, 3])
    least = np.inf
    stop = knee_stop(robot.leg)
    for knee in np.linspace(stop.lower_rad - stop.travel_rad, stop.upper_rad + stop.travel_rad, 22):
        frame = body_frames(robot, Pose(hip_rad=0.0, knee_rad=float(knee)))["shank"]
        for shank in bodies["shank"]:
            placed = shank @ frame[:3, :3].T + frame[:3, 3]
            nearest = np.hypot(*placed[:, [0, 2]].T).min()
            for base in bodies["base"]:
                if base[:, 1].min() < placed[:, 1].max() - 1e-6 and placed[:, 1].min() < base[:, 1].max() - 1e-6:
                    least = min(least, nearest - np.hypot(*base[:, [0, 2]].T).max())
    assert clearance == pytest.approx(least, abs=1.5)
    assert clearance <= least + 1e-9


def test_a_frame_in_the_thigh_s_way_is_found(product):
    def lower(unit):
        parts = tuple(
            dataclasses.replace(part, places_mm=tuple((x, y - 30.0, z) for x, y, z in part.places_mm))
            if part.name == "base_rod"
            else part
            for part in unit.parts
        )
        return dataclasses.replace(unit, parts=parts)

    failures = free_motion.check_free_motion(with_unit(product, "base_frame", lower))[0].failures
    assert any(re.match(r"base_frame/base_rod_\d and thigh/thigh_plate_outer overlap", text) for text in failures)
    assert all("with the hip at" in text for text in failures)


@pytest.mark.parametrize("lengths", [(0.3, 0.3), (0.3, 0.5), pytest.param((0.5, 0.3), marks=pytest.mark.long)])
def test_short_and_long_links_fold_freely(product, actuator_map, lengths):
    design = product.robot.design.replace({"thigh_length_m": lengths[0], "shank_length_m": lengths[1]})
    checks = free_motion.check_free_motion(build_product(bare(build_robot(design, actuator_map)), product.pose))
    assert all(check.passed for check in checks)
    assert checks[-1].measured > 5.0


@pytest.mark.parametrize(
    ("low", "size", "least", "greatest"),
    [
        ((3.0, 0.0, -10.0), (2.0, 5.0, 20.0), 3.0, np.hypot(5.0, 10.0)),  # the nearest point is on no corner
        ((3.0, 0.0, 4.0), (2.0, 5.0, 2.0), 5.0, np.hypot(5.0, 6.0)),
        ((-7.0, 0.0, -2.0), (10.0, 5.0, 13.0), 0.0, np.hypot(7.0, 11.0)),  # the axis runs through it
    ],
)
def test_the_reach_of_a_block_is_from_its_nearest_to_its_farthest_point(low, size, least, greatest):
    block = PlacedMesh.of("block", m3.Manifold.cube(size), shifted(*low))
    assert free_motion.radii_mm(block) == (pytest.approx(least), pytest.approx(greatest))


@pytest.mark.parametrize("stop_of", [hip_stop, knee_stop])
def test_a_joint_is_looked_at_through_its_range_and_its_stops_in_steps_of_16_degrees(product, stop_of):
    stop = stop_of(product.robot.leg)
    angles = free_motion._angles(stop)
    assert (angles[0], angles[-1]) == (stop.lower_rad - stop.travel_rad, stop.upper_rad + stop.travel_rad)
    assert (angles[1], angles[-2]) == (stop.lower_rad, stop.upper_rad)
    assert np.all(np.diff(angles) > 0.0)
    assert np.diff(angles).max() <= np.radians(16.0) + 1e-12

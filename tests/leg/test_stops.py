"""End stops: the law of a rubber bar, and the angles and levers that the parts themselves have."""

import numpy as np
import pytest
import shapely

from pareto_monoped.actuator.motors import motor_names
from pareto_monoped.actuator.search import map_for
from pareto_monoped.geometry.roles import Role
from pareto_monoped.leg.base import base_parts
from pareto_monoped.leg.dimensions import leg_dimensions
from pareto_monoped.leg.shank import shank_parts
from pareto_monoped.leg.stops import Bumper, JointStop, hip_stop, knee_stop
from pareto_monoped.leg.thigh import thigh_parts
from pareto_monoped.materials import MATERIALS
from tests.leg.polygons import polygon

BAR = Bumper(diameter_mm=20.0, length_mm=28.0, elastomer=MATERIALS.fluoroelastomer)
STOP = JointStop(lower_rad=-1.0, upper_rad=1.0, lever_mm=60.0, half_face_mm=9.0, bumper=BAR)


@pytest.mark.parametrize(
    ("compression_mm", "force_n"),
    [
        # By hand, with E d l = 7.05 x 20 x 28 = 3948 N: 1.25 c^1.5 + 50 c^6.
        (-1.0, 0.0),
        (0.0, 0.0),
        (2.0, 3948.0 * (0.0395285 + 0.00005)),  # c = 0.1
        (4.0, 3948.0 * (0.1118034 + 0.0032)),  # 0.2
        (8.0, 3948.0 * (0.3162278 + 0.2048)),  # 0.4
        (10.0, 3948.0 * (0.4419417 + 0.78125)),  # 0.5: 4.83 kN
    ],
)
def test_force_is_lindley_s(compression_mm, force_n):
    assert BAR.force_n(compression_mm) == pytest.approx(force_n, rel=1e-6)


def test_force_of_arrays_is_that_of_numbers_and_grows():
    compression = np.linspace(0.0, 10.0, 41)
    force = BAR.force_n(compression)
    assert force == pytest.approx([BAR.force_n(float(c)) for c in compression])
    assert np.all(np.diff(force) > 0.0)


def test_torque_is_force_times_lever_and_its_work_is_the_bar_s():
    assert pytest.approx(10.0 / 60.0) == STOP.travel_rad
    beyond = np.linspace(0.0, STOP.travel_rad, 2001)
    torque = STOP.torque_n_m(beyond)
    assert torque == pytest.approx(0.06 * BAR.force_n(60.0 * beyond))
    # In closed form E d^2 l (0.5 c^2.5 + 50 c^7 / 7), here at c = 0.5.
    work_j = 1e-3 * 7.05 * 20.0**2 * 28.0 * (0.5 * 0.5**2.5 + 50.0 * 0.5**7 / 7.0)
    assert np.trapezoid(torque, beyond) == pytest.approx(work_j, rel=1e-5)
    assert 11.0 < work_j < 12.0


class Side:
    """The bumpers or strikers of one link as flat shapes in the link's frame, drawn from its prisms."""

    def __init__(self, parts, role, origin_y_mm=0.0):
        shapes = []
        for part in parts:
            if part.role is role:
                for x, y, z in part.places_mm:
                    # Where bumper and striker overlap along the axis: the middle plane is in both.
                    (prism,) = [p for p in part.prisms if p.z0_mm + z < 0.0 < p.z1_mm + z]
                    shapes.append(shapely.affinity.translate(drawn(prism.outline), x, y - origin_y_mm))
        self.shape = shapely.union_all(shapes)

    def turned(self, angle_rad):
        """After the joint has turned by an angle: clockwise, seen along -z."""
        return shapely.affinity.rotate(self.shape, -angle_rad, origin=(0.0, 0.0), use_radians=True)


def drawn(outline):
    if hasattr(outline, "pieces"):
        return polygon(outline)
    return shapely.Point(outline.x_mm, outline.y_mm).buffer(outline.radius_mm, quad_segs=400)


def sides(joint, length_m, d):
    """What stands still and what turns at a joint, with the joint's axis at the origin."""
    thigh = thigh_parts(length_m, d)
    if joint == "hip":
        base = base_parts(0.07, d)
        return Side(base, Role.BUMPER), Side([p for p in thigh if p.name.startswith("hip_")], Role.STRIKER)
    return Side(thigh, Role.BUMPER, -1000.0 * length_m), Side(shank_parts(length_m, d), Role.STRIKER)


@pytest.mark.parametrize("motor", motor_names())
@pytest.mark.parametrize("length_m", [0.25, 0.4037, 0.55])
@pytest.mark.parametrize("joint", ["hip", "knee"])
def test_parts_meet_at_the_ends_of_the_range_and_nowhere_in_it(joint, length_m, motor):
    d = leg_dimensions(map_for(motor))
    fixed, moving = sides(joint, length_m, d)
    stop = {"hip": hip_stop, "knee": knee_stop}[joint](d)
    for angle in np.linspace(stop.lower_rad, stop.upper_rad, 60)[1:-1]:
        assert fixed.shape.distance(moving.turned(float(angle))) > 0.5
    for end, sign in ((stop.lower_rad, -1.0), (stop.upper_rad, 1.0)):
        assert fixed.shape.distance(moving.turned(end - sign * np.radians(0.5))) > 0.3
        assert fixed.shape.distance(moving.turned(end)) < 0.02
        assert fixed.shape.intersection(moving.turned(end + sign * np.radians(0.5))).area > 0.1


@pytest.mark.parametrize("motor", motor_names())
@pytest.mark.parametrize("joint", ["hip", "knee"])
def test_the_lever_is_the_change_of_the_gap_with_the_angle(joint, motor):
    """Near the end of the range the gap closes by the lever times the angle."""
    d = leg_dimensions(map_for(motor))
    fixed, moving = sides(joint, 0.4, d)
    stop = {"hip": hip_stop, "knee": knee_stop}[joint](d)
    for end, sign in ((stop.lower_rad, -1.0), (stop.upper_rad, 1.0)):
        angles = np.array([0.010, 0.014])
        gaps = [fixed.shape.distance(moving.turned(end - sign * angle)) for angle in angles]
        assert np.diff(gaps) / np.diff(angles) == pytest.approx(stop.lever_mm, rel=0.02)


def test_the_ranges_are_those_of_the_docs(leg):
    knee, hip = knee_stop(leg), hip_stop(leg)
    assert np.degrees([knee.lower_rad, knee.upper_rad]) == pytest.approx([15.0, 133.0])
    assert np.degrees([hip.lower_rad, hip.upper_rad]) == pytest.approx([-100.0, 100.0])
    assert (knee.lever_mm, hip.lever_mm) == (51.0, pytest.approx(68.47, abs=0.02))

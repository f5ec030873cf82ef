"""A leg fits its motor: holes, threads, chain and bearings come from the actuator map, and an empty map is refused."""

import dataclasses
import re

import pytest

from pareto_monoped.actuator.motors import motor_names
from pareto_monoped.actuator.ratiomap import JointMaps
from pareto_monoped.actuator.search import map_for
from pareto_monoped.errors import DesignError
from pareto_monoped.leg.dimensions import CHAIN_DRIVES, leg_dimensions


@pytest.mark.parametrize("other", ["VT8020", "U12"])
@pytest.mark.parametrize("motor", motor_names())
def test_a_leg_is_drilled_for_all_actuators_of_each_joint_s_motor(motor, other):
    maps = JointMaps(hip=map_for(motor), knee=map_for(other))
    leg = leg_dimensions(maps)
    for joint in ("hip", "knee"):
        fit = leg.of(joint)
        for actuator in (entry.actuator for entry in maps.of(joint).entries if entry.actuator is not None):
            assert 2.0 * fit.mount_pitch_radius_mm == pytest.approx(actuator.mount.bolts.pitch_circle_mm)
            assert fit.mount_holes == actuator.mount.bolts.count
            assert fit.mount_thread_mm == actuator.mount.thread_depth_mm - 0.5
            assert fit.housing_radius_mm == actuator.mount.housing_radius_mm
            assert 2.0 * fit.back_pitch_radius_mm == pytest.approx(actuator.mount.back_bolts.pitch_circle_mm)
            assert (fit.back_holes, fit.back_screw_mm) == (
                actuator.mount.back_bolts.count,
                actuator.mount.back_bolts.diameter_mm,
            )
            assert 2.0 * fit.output_pitch_radius_mm == actuator.output.bolts.pitch_circle_mm
            assert fit.output_holes == actuator.output.bolts.count
            assert fit.output_thread_mm == actuator.output.thread_depth_mm - 0.5
            assert fit.coupler_radius_mm == actuator.output.flange_radius_mm


@pytest.mark.parametrize(("hip", "knee"), [("U12", "U8"), ("U8", "U12")])
def test_the_wider_motor_sets_the_rods_and_the_knee_s_the_chain(hip, knee):
    leg = leg_dimensions(JointMaps(hip=map_for(hip), knee=map_for(knee)))
    alone = {name: leg_dimensions(map_for(name)) for name in (hip, knee)}
    assert leg.rod_circle_mm == alone["U12"].rod_circle_mm > alone["U8"].rod_circle_mm
    assert leg.thigh_window_half_width_mm == alone["U12"].thigh_window_half_width_mm
    assert leg.chain == alone[knee].chain != alone[hip].chain
    assert leg.first_bridge_mm == alone["U12"].first_bridge_mm > alone["U8"].first_bridge_mm
    assert (leg.hip, leg.knee) == (alone[hip].hip, alone[knee].knee)


@pytest.mark.parametrize("motor", motor_names())
def test_a_leg_s_chain_holds_five_times_what_the_stop_makes_of_its_motor_s_torque(motor):
    found = map_for(motor)
    drive = leg_dimensions(found).chain
    torque = max(entry.actuator.peak_torque_n_m for entry in found.entries if entry.actuator is not None)
    holds = 1e-3 * drive.breaking_n * drive.pitch_radius_mm >= 5.0 * 1.8 * torque
    # The chain bounds the jumps of motors that are too strong for the strongest one.
    assert holds or drive is CHAIN_DRIVES[-1]
    weaker = CHAIN_DRIVES[: CHAIN_DRIVES.index(drive)]
    assert all(1e-3 * one.breaking_n * one.pitch_radius_mm < 5.0 * 1.8 * torque for one in weaker)


def test_where_mounts_differ_the_leg_fits_that_of_the_lowest_ratio(leg):
    found = map_for("VT8020")
    last = max(index for index, entry in enumerate(found.entries) if entry.actuator is not None)
    actuator = found.entries[last].actuator
    wider = dataclasses.replace(actuator, mount=dataclasses.replace(actuator.mount, housing_radius_mm=99.0))
    entries = list(found.entries)
    entries[last] = dataclasses.replace(entries[last], actuator=wider)
    assert leg_dimensions(dataclasses.replace(found, entries=tuple(entries))) == leg


def test_the_vt8020_s_leg_has_the_documented_dimensions(leg):
    """Golden values of the default motor's leg: plates, chain and bearings of the example in the docs."""
    fit = leg.hip
    assert (fit.mount_pitch_radius_mm, fit.housing_radius_mm, fit.back_pitch_radius_mm) == (49.0, 51.5, 25.5)
    assert (fit.back_holes, fit.back_screw_mm, leg.chain.name) == (4, 5.0, "084")
    bearing = (leg.bearing_bore_radius_mm, leg.bearing_outer_radius_mm, leg.bearing_width_mm, leg.bearing_kg)
    assert bearing == (10.0, 16.0, 7.0, 0.017)  # 6804
    # Derived, from z = 0 in the middle of the leg outwards.
    assert (leg.thigh_face_mm, leg.knee_mount_mm, leg.hip_mount_mm, leg.shank_gap_mm) == (14.5, 14.5, -23.5, 33.0)
    assert (leg.rim_radius_mm, leg.first_bridge_mm, leg.rod_circle_mm) == (55.0, 60.0, 70.5)


def test_the_u12_s_leg_is_larger():
    """Once the report weighed and drew every leg with the dimensions of the VT8020's."""
    leg = leg_dimensions(map_for("U12"))
    assert (leg.hip.housing_radius_mm, leg.chain.name) == (60.4, "084")


def test_a_map_without_actuators_has_no_leg():
    found = map_for("VT8020")
    none = tuple(dataclasses.replace(entry, actuator=None) for entry in found.entries)
    message = "actuators of VT8020 = 0: a leg needs at least one to be drilled for; choose another motor"
    with pytest.raises(DesignError, match="^" + re.escape(message)):
        leg_dimensions(dataclasses.replace(found, entries=none))


@pytest.mark.parametrize("motor", motor_names())
def test_a_stronger_actuator_has_wider_sides_of_the_thigh_and_a_weaker_one_none_narrower(motor):
    leg = leg_dimensions(map_for(motor))
    side_mm = leg.thigh_half_width_mm - leg.thigh_window_half_width_mm
    assert side_mm >= 9.0 - 1e-9
    # No more than 5 N m per mm; exactly that where 9 mm are too few.
    assert leg.hip.torque_n_m / side_mm <= 5.0 + 1e-9
    assert side_mm == pytest.approx(9.0) or leg.hip.torque_n_m / side_mm == pytest.approx(5.0)

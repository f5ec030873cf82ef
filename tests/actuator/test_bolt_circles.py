"""What is screwed to a motor's own circles has room there and thread enough."""

from dataclasses import replace

import numpy as np
import pytest

from pareto_monoped.actuator.actuator import build_actuator
from pareto_monoped.actuator.motor import FramedMotor, HolePattern
from pareto_monoped.actuator.motors import load_motor, motor_names
from pareto_monoped.actuator.search import map_for
from pareto_monoped.geometry.roles import Role
from pareto_monoped.geometry.shapes import Pattern
from pareto_monoped.leg.dimensions import leg_dimensions
from pareto_monoped.leg.journal import SHOULDER_RADIUS, journal_parts


def esspg(found):
    return next(e.actuator for e in found.entries if e.actuator is not None and e.actuator.family == "ESSPG")


def thread_mm(actuator):
    """Depth to which the coupling's screws reach into the motor's turning face, and the face's thickness."""
    coupling = next(part for part in actuator.parts if part.role is Role.COUPLING)
    screw = next(part for part in actuator.parts if part.name == "coupling_screw")
    rotor = next(part for part in actuator.parts if part.role is Role.MOTOR_ROTOR)
    face = rotor.prisms[0]
    bottom = min(float(prism.z0_mm) for prism in coupling.prisms)
    end = min(float(prism.z0_mm) for prism in screw.prisms)
    assert float(face.z1_mm) == bottom
    return bottom - end, float(face.z1_mm) - float(face.z0_mm)


@pytest.mark.parametrize("name", motor_names())
def test_the_coupling_s_screws_hold_in_the_motor_s_face(name):
    motor = load_motor(name)
    depth, face = thread_mm(esspg(map_for(name)))
    assert 0.6 * motor.output_holes.diameter_mm <= depth <= face


@pytest.mark.parametrize("name", motor_names())
def test_screws_stand_in_the_tapped_holes_of_a_framed_motor(name):
    """As wide as their cores, on their circle; the shank ends at the motor's face."""
    actuator = esspg(map_for(name))
    motor, parts = load_motor(name), {part.name: part for part in actuator.parts}
    for screw, owner, through, circle in (
        ("stator_screw", "motor_stator", "backplate", motor.mount_holes),
        ("coupling_screw", "motor_rotor", "coupling", motor.output_holes),
    ):
        *_, shank, thread = parts[screw].prisms
        # Dowels stand between the screws, in holes of the same size.
        holes = [(p, h) for p in parts[owner].prisms for h in p.holes if isinstance(h, Pattern)]
        ((base, hole),) = [(p, h) for p, h in holes if h.phase_rad == parts[screw].phase_rad]
        assert hole.radius_mm == pytest.approx(thread.outline.radius_mm)
        assert (2.0 * hole.pitch_radius_mm, hole.count) == (circle.pitch_circle_mm, circle.count)
        assert (2.0 * parts[screw].pitch_radius_mm, parts[screw].count) == (circle.pitch_circle_mm, circle.count)
        assert 2.0 * shank.outline.radius_mm == circle.diameter_mm
        assert 0.5 <= circle.diameter_mm - 2.0 * hole.radius_mm <= 0.8  # tapping drills of M3 and M4 (ISO 2306)
        heights = [float(z) for p in parts[through].prisms for z in (p.z0_mm, p.z1_mm)]
        # From the back of the backplate forwards, and from the front of the coupling backwards.
        ends = (min(heights), base.z0_mm) if through == "backplate" else (base.z1_mm, max(heights))
        assert (shank.z0_mm, shank.z1_mm) == pytest.approx(ends)
        assert ends[through == "backplate"] in (pytest.approx(thread.z0_mm), pytest.approx(thread.z1_mm))
        assert thread.z1_mm - thread.z0_mm <= 5.0
    (coupling,) = parts["coupling"].prisms
    clear = [h for h in coupling.holes if isinstance(h, Pattern) and h.radius_mm > 0.5 * motor.output_holes.diameter_mm]
    assert any(2.0 * h.radius_mm == pytest.approx(motor.output_holes.diameter_mm + 0.2) for h in clear)


@pytest.mark.parametrize("name", motor_names())
def test_the_heads_of_the_coupling_s_screws_do_not_break_out_of_its_rim(name):
    coupling = next(part for part in esspg(map_for(name)).parts if part.role is Role.COUPLING)
    (prism,) = coupling.prisms
    heads = [bevel for bevel in coupling.bevels if bevel.hole]
    assert heads
    for head in heads:
        reach = max(float(np.hypot(x, y)) for x, y in head.centres_mm()) + float(head.edge_mm)
        assert reach < float(prism.outline.radius_mm)


@pytest.mark.parametrize("length_mm", [12.0, 20.0, 40.0])
@pytest.mark.parametrize("hole_mm", [2.5, 3.0, 4.0, 5.0, 6.0, 8.0])
def test_they_hold_in_short_motors_and_with_thick_screws(hole_mm, length_mm):
    motor = replace(
        load_motor("MN8014"),
        framed=FramedMotor(mass_kg=0.392, outer_diameter_mm=87.8, length_mm=length_mm),
        output_holes=HolePattern(pitch_circle_mm=30.0, diameter_mm=hole_mm, count=4),
    )
    usual = esspg(map_for("MN8014"))
    depth, face = thread_mm(build_actuator(motor, "ESSPG", usual.gears, map_for("MN8014").settings))
    assert 0.6 * hole_mm <= depth <= face
    assert face < 0.5 * length_mm


@pytest.mark.parametrize("name", motor_names())
def test_the_journal_s_screw_heads_clear_its_shoulder(name):
    leg = leg_dimensions(map_for(name))
    journal, screw = journal_parts(0.06, leg)
    head = max(float(prism.outline.radius_mm) for prism in screw.prisms)
    assert leg.knee.back_pitch_radius_mm - head > SHOULDER_RADIUS
    assert leg.knee.back_pitch_radius_mm + head <= float(journal.prisms[0].outline.radius_mm) + 0.1

"""The kinetic energy of MuJoCo's model is the sum over all parts, each with its own absolute speed.

The oracle adds up masses, centres and spins of single parts; it knows nothing of armature, tendons or the sums of
``robot.rotation``.
"""

from dataclasses import replace

import mujoco
import numpy as np
import pytest

from pareto_monoped.actuator.motors import motor_names
from pareto_monoped.actuator.search import map_for
from pareto_monoped.design import BASE_START_HEIGHT_M, CONTROL, LOWER, PAPER_CASES, UPPER, Design, columns
from pareto_monoped.geometry.roles import Group, Role
from pareto_monoped.jump import controller, single
from pareto_monoped.jump.calibration import load_calibration
from pareto_monoped.jump.controller_record import origin
from pareto_monoped.jump.document import mjcf
from pareto_monoped.jump.evaluate import Evaluator, evaluate_robots
from pareto_monoped.jump.model import start_pose
from pareto_monoped.jump.population import first_records
from pareto_monoped.leg.dimensions import leg_dimensions
from pareto_monoped.robot.build import build_robot
from pareto_monoped.robot.population import robot_arrays

_REFERENCE = load_calibration("reference-3")
ARMATURE = replace(_REFERENCE, joints=replace(_REFERENCE.joints, rotors="armature"))
ABSOLUTE = replace(_REFERENCE, joints=replace(_REFERENCE.joints, rotors="absolute"))
NODES, WEIGHTS = np.polynomial.legendre.leggauss(32)


def turned(angle, x, z):
    """A vector (x, z) turned about +y."""
    return np.array([np.cos(angle) * x + np.sin(angle) * z, np.cos(angle) * z - np.sin(angle) * x])


def across(speed, arm):
    """Speed of the end of an arm (x, z) that turns about +y."""
    return speed * np.array([arm[1], -arm[0]])


def weighed(robot):
    """Mass properties of every part by unit and part: in its body if it moves as this does, else in its unit."""
    return {
        (unit.name, part.name): (replace(unit, parts=(part,)) if is_fixed(part) else part).mass_properties()
        for unit in robot.units
        for part in unit.parts
    }


def is_fixed(part):
    return part.group in (Group.FIXED, Group.HOUSING)


def part_energies(robot, leg, weights, q, v):
    """Kinetic energy of every part."""
    base = v[:2]
    thigh, shank = q[2], q[2] + q[3]
    knee = base + across(v[2], turned(thigh, 0.0, -robot.design.thigh_length_m))
    frames = {"base": (base, 0.0, 0.0), "thigh": (base, thigh, v[2]), "shank": (knee, shank, v[2] + v[3])}
    for unit in robot.units:
        origin, angle, spin = frames[unit.body]
        actuator = {"hip_actuator": robot.hip, "knee_actuator": robot.knee}.get(unit.name)
        rate = {"hip_actuator": v[2], "knee_actuator": v[3], "thigh": v[3]}.get(unit.name, 0.0)
        for part in unit.parts:
            if part.role in (Role.CHAIN, Role.TURNBUCKLE):
                continue
            weight = weights[unit.name, part.name]
            if is_fixed(part):
                centre = turned(angle, weight.com_m[0], weight.com_m[2])
                speed = origin + across(spin, centre)
                yield 0.5 * weight.mass_kg * speed @ speed + 0.5 * weight.inertia_kg_m2[1, 1] * spin**2
                continue
            # On the joint's axis: what follows is seen along it.
            moment, mass = float(weight.inertia_kg_m2[2, 2]), float(weight.mass_kg)
            if part.role is Role.MOTOR_ROTOR:
                moment = actuator.motor.rotor_inertia_kg_m2
            if part.group is Group.PLANET:
                gears, radius = actuator.gears, 1e-3 * float(part.pitch_radius_mm)
                own = moment - mass * radius**2
                itself = spin + (1.0 - gears.ring_teeth / gears.planet_teeth) * rate
                for k in range(int(part.count)):
                    place = turned(2.0 * np.pi * k / part.count, radius, 0.0)
                    if part.count == 2:  # the records spread two planets evenly around the circle
                        speed2 = origin @ origin + (spin + rate) ** 2 * radius**2
                    else:
                        speed = origin + across(spin + rate, place)
                        speed2 = speed @ speed
                    yield 0.5 * mass / part.count * speed2
                yield 0.5 * own * itself**2
                continue
            turning = actuator.ratio if part.group is Group.ROTOR else 1.0
            yield 0.5 * mass * origin @ origin + 0.5 * moment * (spin + turning * rate) ** 2
    yield from chain_energies(robot, leg, base, thigh, v)


def chain_energies(robot, leg, base, angle, v):
    """The chain as a line of mass around both sprockets and 4 pitches beside them, joined by a bar in each strand."""
    length, radius = robot.design.thigh_length_m, 1e-3 * leg.chain.pitch_radius_mm
    parts = {part.name: part for unit in robot.units if unit.name == "thigh" for part in unit.parts}
    chain = [part for part in parts.values() if part.role is Role.CHAIN]
    buckles = [part for part in parts.values() if part.role is Role.TURNBUCKLE]
    density, straight = leg.chain.kg_per_m, 2.0 * 4.0 * 1e-3 * leg.chain.pitch_mm  # of a strand, both ends
    own = sum(float(part.mass_kg()) for part in chain)
    around = density * 0.5e-3 * leg.chain.teeth * leg.chain.pitch_mm  # links lie on a polygon around the teeth
    assert own == pytest.approx(2.0 * (density * straight + around), rel=1e-9)
    # How the parts are drawn decides what of their mass turns rigidly with the thigh: take that as it is.
    rigid = next(replace(unit, parts=(*chain, *buckles)) for unit in robot.units if unit.name == "thigh")
    drawn = rigid.mass_properties()
    centre = turned(angle, drawn.com_m[0], drawn.com_m[2])
    speed = base + across(v[2], centre)
    yield 0.5 * drawn.mass_kg * speed @ speed + 0.5 * drawn.inertia_kg_m2[1, 1] * v[2] ** 2
    # Running along: momentum and energy of the motion against the thigh, element by element.
    running = radius * v[3]

    def element(mass, x, z, along_x, along_z):
        carried = base + across(v[2], turned(angle, x, z))
        against = running * turned(angle, along_x, along_z)
        return mass * (carried @ against + 0.5 * against @ against)

    for side in (-1.0, 1.0):
        strand = density * straight
        yield element(strand, side * radius, -0.5 * length, 0.0, -side)
        yield element(0.5 * sum(float(p.mass_kg()) for p in buckles), side * radius, -0.5 * length, 0.0, -side)
    for top, first in ((0.0, 0.0), (-length, np.pi)):
        for node, weight in zip(NODES, WEIGHTS, strict=True):
            a = first + 0.5 * np.pi * (node + 1.0)
            mass = 0.5 * around * weight
            # About +y, from z towards x: at the top (a = 90 degrees) the chain runs to +x.
            yield element(mass, radius * np.cos(a), top + radius * np.sin(a), np.sin(a), -np.cos(a))


@pytest.mark.parametrize(
    "motor",
    [pytest.param(name, marks=() if name in ("VT8020", "MN8014") else pytest.mark.long) for name in motor_names()],
)
def test_kinetic_energy_is_the_sum_over_all_parts(motor):
    rng = np.random.default_rng(7)
    actuator_map = map_for(motor)
    leg = leg_dimensions(actuator_map)
    tried = 0
    for values in rng.uniform(LOWER, UPPER, (60, len(LOWER))):
        robots = robot_arrays(values, actuator_map)
        if robots.reason[0] or start_pose(robots, ABSOLUTE).reason[0]:
            continue
        robot = build_robot(Design.from_array(values), actuator_map)
        weights = weighed(robot)
        model = mujoco.MjModel.from_xml_string(mjcf(robots, ABSOLUTE))
        data = mujoco.MjData(model)
        for _ in range(8):
            data.qpos[:] = rng.uniform([-1, 0.3, -1.5, 0.2], [1, 1.5, 1.5, 2.4])
            data.qvel[:] = rng.uniform(-1.0, 1.0, 4) * [3.0, 5.0, 30.0, 40.0]
            mujoco.mj_forward(model, data)
            matrix = np.zeros((4, 4))
            mujoco.mj_fullM(model, data, matrix)
            energy = 0.5 * data.qvel @ matrix @ data.qvel
            expected = sum(part_energies(robot, leg, weights, data.qpos, data.qvel))
            assert energy == pytest.approx(expected, rel=1e-9)
            tried += 1
        if tried >= 24:  # three robots of each motor
            break
    assert tried >= 24


FINE = replace(ABSOLUTE, simulation=replace(ABSOLUTE.simulation, timestep_s=1e-4, control_period_s=1e-3))
GEARED_DOFS = [0, 1, 2, 4]  # of the geared model, without its rotor


def geared_model(robots):
    """The robot with the knee's turning parts as one body on the thigh, geared to the knee by a stiff constraint."""
    xml = mjcf(robots, FINE)
    plain = mujoco.MjModel.from_xml_string(xml)
    inertia, lever = float(plain.tendon_armature[0]), float(plain.wrap_prm[1])
    head, rest = xml.split("\n  <tendon>")
    body = (
        '<body name="rotor"><joint name="rotor" type="hinge" axis="0 1 0"/>'
        f'<inertial pos="0 0 0" mass="1e-9" diaginertia="{inertia!r} {inertia!r} {inertia!r}"/></body>\n        '
    )
    gear = (
        f'<equality><joint joint1="rotor" joint2="knee" polycoef="0 {lever!r} 0 0 0" solref="0.0002 1" '
        'solimp="0.9999 0.9999 0.001"/></equality>\n</mujoco>'
    )
    xml = (head + rest.split("</tendon>", 1)[1]).replace('<body name="shank"', body + '<body name="shank"', 1)
    xml = xml[: xml.index("<keyframe>")] + xml[xml.index("</keyframe>") + len("</keyframe>") :]
    model = mujoco.MjModel.from_xml_string(xml.replace("</mujoco>", gear))
    # Foot and stops are springs by these numbers: the same springs as in the plain model.
    model.dof_invweight0[GEARED_DOFS] = plain.dof_invweight0
    model.body_invweight0[[0, 1, 2, 4]] = plain.body_invweight0
    return model, lever


def jump_with_geared_rotor(robots, control):
    """Height and energy of a jump of the geared model under the same controller."""
    model, lever = geared_model(robots)
    data = mujoco.MjData(model)
    pose = start_pose(robots, FINE)
    data.qpos[:] = [0.0, BASE_START_HEIGHT_M, pose.hip_rad[0], lever * pose.knee_rad[0], pose.knee_rad[0]]
    record, act = first_records(robots, control, FINE)[0], single._controller(origin())
    while record["status"] <= controller.FLYING:
        act(data.qpos[GEARED_DOFS], data.qvel[GEARED_DOFS], data.ctrl, record)
        mujoco.mj_step(model, data)
    return float(record["height_m"]), float(record["energy_j"].sum())


def test_a_rotor_as_a_geared_body_makes_the_same_jump():
    """An independent way to the same physics: no tendon, no armature, but a body and a constraint."""
    actuator_map = map_for("VT8020")
    for name in ("nominal", "C"):
        values = PAPER_CASES[name].design.as_array()[None]
        robots = robot_arrays(values, actuator_map)
        control = columns(values, CONTROL)
        plain = evaluate_robots(robots, control, FINE)
        height, energy = jump_with_geared_rotor(robots, control)
        assert abs(height - plain.height_m[0]) < 0.001
        assert abs(energy / plain.energy_j[0] - 1.0) < 0.001


def test_the_coupling_is_worth_a_centimetre():
    """What armature at the joint alone leaves out: the rotor rides on the thigh and turns with it."""
    actuator_map = map_for("VT8020")
    values = np.array([case.design.as_array() for case in PAPER_CASES.values()])
    gain = Evaluator(actuator_map, ABSOLUTE)(values).height_m - Evaluator(actuator_map, ARMATURE)(values).height_m
    assert np.all((gain > 0.005) & (gain < 0.020))

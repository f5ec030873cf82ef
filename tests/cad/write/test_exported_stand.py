"""The jump on the test stand from exported files alone, by a simulator that is neither MuJoCo nor the package."""

import json
from xml.etree import ElementTree as ET

import numpy as np
import pytest

from pareto_monoped.actuator.search import map_for
from pareto_monoped.cad.as_built import as_built
from pareto_monoped.cad.write.mjcf import jump_record, mjcf_with_meshes
from pareto_monoped.design import LOWER, PAPER_CASES, PAPER_CONTROL, UPPER, Design, complete
from pareto_monoped.jump.calibration import load_calibration
from pareto_monoped.jump.document import mjcf
from pareto_monoped.robot.population import robot_arrays
from tests.jump import planar
from tests.jump.test_independent_simulator import LOADS

STANDS = {"rigid": load_calibration("stand-1"), "elastic": load_calibration("stand")}
RANDOM = complete(np.random.default_rng(21).uniform(LOWER, UPPER, (11, len(LOWER))))
DESIGNS = [("VT8020", case.design) for case in PAPER_CASES.values()]
DESIGNS += [("U12" if i > 6 else "VT8020", Design.from_array(values)) for i, values in enumerate(RANDOM)]


def numbers(element, name):
    return np.array([float(text) for text in element.get(name).split()])


def every(elements, name, place=0):
    return np.array([numbers(element, name)[place] for element in elements])


def spring(element, ref, imp, inverse):
    """K, C, w and D of docs/model.md, from MuJoCo's parameters."""
    full, width = numbers(element, imp)[1:3]
    return (*(-numbers(element, ref) / (inverse * (1.0 - full))), width, full)


def machine(document, jump):
    """The numbers of a robot on its stand, from ``monoped_stand.xml`` and ``jump_stand.json``."""
    root = ET.fromstring(document)
    bodies = {body.get("name"): body for body in root.iter("body")}
    weighed = [bodies[name].find("inertial") for name in ("base", "thigh", "shank")]
    joints = {joint.get("name"): joint for joint in root.find("worldbody").iter("joint")}
    drives = root.findall("tendon/fixed[@stiffness]")
    moved = ["hip_motor", "knee_motor"] if drives else ["hip", "knee"]
    assert set(joints) == {"slide_z", "hip", "knee", *moved}
    hinges, motors = [joints[name] for name in ("hip", "knee")], [joints[name] for name in moved]
    foot, tendon = root.find(".//geom[@name='foot']"), root.find("tendon/fixed[@name='knee_rotor']")
    rotor, lever = numbers(tendon, "armature")[0], numbers(tendon.find(f"joint[@joint='{moved[1]}']"), "coef")[0]
    bumper = np.array([jump[name] for name in ("bumper_n_m", "bumper_per_rad", "bumper_s_per_rad")]).T
    mass = every(weighed, "mass")
    held = mass.sum() - jump["weight_n"] / 9.81  # the controller knows the robot alone
    bare = planar.with_inverse_masses(
        planar.Machine(
            thigh=-numbers(bodies["shank"], "pos")[2],
            shank=-numbers(foot, "pos")[2],
            radius=numbers(foot, "size")[0],
            mass=mass - [held, 0.0, 0.0],
            centres=tuple(tuple(numbers(each, "pos")[[0, 2]]) for each in weighed[1:]),
            inertia=every(weighed[1:], "diaginertia", 1) + np.array([rotor, 0.0]),
            reflected=every(motors, "armature") + np.array([0.0, rotor * lever**2]),
            coupling=rotor * lever,
            lower=np.array(jump["lower_stop_rad"]),
            upper=np.array(jump["upper_stop_rad"]),
            stop=None,
            peak=np.array(jump["torque_limit_n_m"]),
            no_load=np.array(jump["no_load_speed_rad_per_s"]),
            corner=np.array(jump["corner_speed_rad_per_s"]),
            loss=np.array(jump["loss"]),
            heat=np.array(jump["heat_w_per_n2_m2"]),
            gains=tuple(jump[name] for name in PAPER_CONTROL),
            rest=jump["rest_length_m"],
            release=jump["knee_release_rad"],
            damping=every(motors, "damping"),
            friction=every(motors, "frictionloss"),
            loss_speed=jump["loss_speed_rad_per_s"],
            foot=None,
            mu=numbers(foot, "friction")[0],
            slip=numbers(root.find("option"), "impratio")[0],
            fade=jump["fade_length_m"],
            inverse=np.zeros(3),
            start=numbers(root.find("keyframe/key"), "qpos")[0],
            delay=int(jump["delay_periods"]),
            guided=True,
            stand=held,
            rails=numbers(joints["slide_z"], "frictionloss")[0],
            bus=bool(jump["bus"]),
            rotor=np.array(jump["rotor_kg_m2"]) * jump["ratio"],
            ratio=jump["ratio"][1],
            sprocket=jump["sprocket_radius_m"],
            bumper=bumper,
            **({"spring": every(drives, "stiffness"), "damper": every(drives, "damping")} if drives else {}),
        )
    )
    stops = ((1.0, 1.0, 1.0, 0.5),) * 2
    if not bumper.any():
        stops = tuple(spring(each, "solreflimit", "solimplimit", bare.inverse[k]) for k, each in enumerate(hinges))
    return bare._replace(stop=stops, foot=spring(foot, "solref", "solimp", bare.inverse[2]))


@pytest.mark.parametrize(
    "number",
    [*range(6), *(pytest.param(number, marks=pytest.mark.long) for number in range(6, len(DESIGNS) - 2)), 13, 14],
)
@pytest.mark.parametrize("drive", STANDS)
def test_an_independent_simulator_makes_the_jump_of_the_files(drive, number):
    """Measured at worst in percent: rigid 0.02 of height, 0.06 of energies; elastic 0.06, 0.08, and 1.8 of loads."""
    (motor, design), stand = DESIGNS[number], STANDS[drive]
    design = as_built(design, map_for(motor))
    robot = robot_arrays(design.as_array(), map_for(motor), stand.mass)
    jump = json.loads(jump_record(robot, design, stand))
    found = machine(mjcf_with_meshes(mjcf(robot, stand), (), ()), jump)
    height_m, energy_j, battery_j, loads = planar.jump(found, planar.standing(found))
    if drive == "elastic":
        for name, load in zip(LOADS, loads, strict=True):
            assert jump["expected"][name] == pytest.approx(load, rel=0.02)
    assert jump["expected"]["height_m"] == pytest.approx(height_m, rel=0.0005 if drive == "rigid" else 0.001)
    assert jump["expected"]["energy_j"] == pytest.approx(energy_j, rel=0.0015)
    assert jump["expected"]["electrical_energy_j"] == pytest.approx(battery_j, rel=0.0015)

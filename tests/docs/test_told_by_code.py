"""Numbers in running prose that no table shows, but that the package computes in seconds."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from pareto_monoped.actuator.motors import load_motor
from pareto_monoped.actuator.search import map_for
from pareto_monoped.design import CONTROL, LOWER, NAMES, PAPER_CASES, UPPER, columns, complete
from pareto_monoped.jump.balance import balanced
from pareto_monoped.jump.calibration import load_calibration
from pareto_monoped.jump.evaluate import Evaluator
from pareto_monoped.jump.gravity import least_energy_j
from pareto_monoped.jump.landing import LANDING
from pareto_monoped.robot.population import robot_arrays
from tests.docs.prose import between, untold
from tests.docs.scripts import imported

MAP = map_for("VT8020")
DUTY = MAP.settings.parts.duty
PAPER = complete(np.array([case.design.as_array() for case in PAPER_CASES.values()]))
NOMINAL, A, B, C = range(4)
REFERENCE, RIGID = (load_calibration(name) for name in ("reference", "reference-3"))


@cache
def jumps(calibration=REFERENCE, **changed):
    """Of the paper's designs, with some variables changed."""
    designs = PAPER.copy()
    for name, value in changed.items():
        designs[:, NAMES.index(name)] = value
    return Evaluator(MAP, calibration)(designs)


def actuators():
    four, lewis, six, eight = (
        MAP.lookup(4.0),
        map_for("VT8020", "paper").lookup(4.0),
        MAP.lookup(6.0),
        MAP.lookup(7.9),
    )

    def teeth(one):
        return f"{one.gears.sun_teeth:.0f}/{one.gears.planet_teeth:.0f}/{one.gears.ring_teeth:.0f}"

    yield (
        f"At 4:1, {teeth(four)} with module {four.gears.module_mm:g} and three planets needs "
        f"{four.face_width_mm:.0f} mm where Lewis needs {teeth(lewis)} with five planets and "
        f"{lewis.face_width_mm:.1f} mm"
    )
    assert (four.gears.planets, lewis.gears.planets, eight.gears.is_shifted) == (3, 5, True)
    yield f"At 6:1, {teeth(six)} with module {six.gears.module_mm:g} sits in the stator"
    yield f"The paper's {teeth(eight)} with module {eight.gears.module_mm:g} wins 7.9:1 with shifted teeth"
    empty = [f"[{one.ratio_low:.1f}, {one.ratio_high:.1f})" for one in MAP.entries if not one.actuator]
    yield f"Up to 9.1:1, only {' and '.join(empty[:2])} are empty"
    assert float(empty[2][1:4]) > 9.1
    peaks = np.array([MAP.lookup(ratio).peak_torque_n_m for ratio in PAPER[:, NAMES.index("knee_ratio")]])
    struck = jumps().peak_gear_torque_knee_n_m / peaks
    yield (
        f"strike theirs with {struck[C]:.1f} (Case C), {struck[B]:.1f} (Case B), {struck[A]:.1f} (Case A) and "
        f"{struck[NOMINAL]:.1f} times (nominal) the peak torque"
    )
    eased = jumps(knee_release_rad=0.4)
    less = eased.peak_gear_torque_knee_n_m / peaks
    yield f"for Case C, 0.4 rad brings the {struck[C]:.1f} times down to {less[C]:.1f} without loss of height"
    assert eased.height_m[C] >= jumps().height_m[C]
    yield f"For the U8, the estimate is {1e5 * load_motor('U8').estimated_rotor_inertia_kg_m2():.2f}e-5 kg m2"
    links = PAPER[:1].copy()
    links[:, [NAMES.index(name) for name in ("thigh_length_m", "shank_length_m")]] = 0.4
    robot = robot_arrays(links, MAP)
    masses, at = robot.body_mass_kg[0], np.linalg.norm(robot.body_com_m[0][:, [0, 2]], axis=1)
    _, thigh, shank = robot.body_inertia_kg_m2[0][:, 1, 1] + masses * at**2  # about hip and knee
    fastest = 2.0 * np.pi / 0.2**2  # 1 rad in 0.2 s
    knee, hip = fastest * shank, 0.5 * fastest * (thigh + masses[2] * 0.4**2 - shank)
    lewis = [entry for entry in map_for("VT8020", "paper").entries if entry.actuator]
    ends = [max(e.actuator.ratio for e in lewis if e.actuator.family == name) for name in ("ISSPG", "ESSPG")]
    yield f"ISSPG at {ends[0]:g}:1, ESSPG at {ends[1]:g}:1"
    assert map_for("VT8020", "paper").lookup(5.9).family == "ESSPG"
    told = DUTY.torque_shares[2] * 33.0 * 4.0 / 6.0  # at 4:1
    yield f"A hip of 4:1 folds in {0.2 * np.sqrt(hip / told):.2f} s with this torque"
    yield f"Shank and foot ({shank:.3f} kg m2) need {knee:.1f} N m at the knee, {knee / 33.0:.2f} of"
    yield f"need {hip:.1f} N m at the hip, {hip / 33.0:.2f} of it"
    yield f"The VT8020's estimate is {1e4 * load_motor('VT8020').rotor_inertia_kg_m2:.2f}e-4 kg m2"


def landing():
    ratio = LANDING.damping_ratio  # of a body that comes with speed 1 onto a spring with omega = 1
    times = np.linspace(0.0, 4.0, 40001)
    swing = np.sqrt(1.0 - ratio**2)
    way = np.exp(-ratio * times) * np.sin(swing * times) / swing
    force = -np.gradient(np.gradient(way, times), times)[2:]
    yield f"{2.0 * way.max() * force.max():.2f} times that of a constant force"  # which stops it within 1 / 2 a


def losses():
    with imported("losses_front") as script:
        shares = [one.joints.motor_damping_share_s_per_rad for one in script.settings().values()]
    yield f"has gears that lose {load_calibration('printed').drive.gear_loss:g} times as much under load"
    yield f"a public leg rubs {shares[2] / shares[0]:.0f} times as much at speed"


def model():
    usual, rigid = jumps(), jumps(RIGID)
    armature = jumps(replace(RIGID, joints=replace(RIGID.joints, rotors="armature")))
    yield f"jump {between(1e3 * (rigid.height_m - armature.height_m))} mm higher with rigid drives"
    eased = jumps(knee_release_rad=0.4)
    less, higher = 100.0 * (1.0 - eased.energy_j / usual.energy_j), 1e3 * (eased.height_m - usual.height_m)
    yield f"spend {between(less)} percent less energy and jump {between(higher)} mm higher"
    stands = usual.height_m - usual.above_standing_m
    yield (
        f"Case C reaches {usual.height_m[C]:.3f} m, of which it stands {stands[C]:.3f} m, and its centre of mass "
        f"rises by {usual.rise_m[C]:.3f} m"
    )
    torque = usual.peak_gear_torque_knee_n_m[NOMINAL]
    peak = MAP.lookup(PAPER_CASES["nominal"].design.knee_ratio).peak_torque_n_m
    yield (
        f"transmits {torque:.0f} N m, {torque / peak:.1f} "
        f"times its peak torque, and its chain {1e-3 * usual.peak_chain_tension_n[NOMINAL]:.1f} kN"
    )
    robots = robot_arrays(PAPER, MAP, REFERENCE.mass)
    start = PAPER[:, NAMES.index("start_height_m")]
    below = [
        100.0 * (1.0 - least_energy_j(robots, REFERENCE, heights) / (usual.mass_kg * 9.81 * (heights - start)))
        for heights in (usual.height_m, np.full(4, 0.7))
    ]
    there, low = map(between, below)
    yield f"is {there} percent below it at the heights that they reach, and {low} percent at 0.7 m"
    euros = [f"{round(euro, -2):,.0f}" for euro in usual.cost_eur]
    yield f"thus costs {euros[B]} EUR, Cases A and C {euros[A]} and {euros[C]}"
    ratios = [one.actuator.ratio for one in MAP.entries if one.actuator]
    every = np.repeat(PAPER[:1], 2 * len(ratios), axis=0)
    every[:, NAMES.index("knee_ratio")] = every[:, NAMES.index("hip_ratio")] = ratios * 2
    every[:, NAMES.index("thigh_length_m")] = np.repeat((LOWER[0], UPPER[0]), len(ratios))  # of the chain
    hip, knee = robot_arrays(every, MAP, REFERENCE.mass).drive_stiffness_n_m_per_rad.T
    spans = [f"{round(min(k), -2):,.0f} to {round(max(k), -2):,.0f}" for k in (knee, hip)]
    yield f"With the VT8020 this is {spans[0]} N m/rad at the knee and {spans[1]} at the hip"
    yield f"{robots.stand_mass_kg[0]:.3f} kg with the VT8020"
    random = complete(np.random.default_rng(0).uniform(LOWER, UPPER, (150, len(LOWER))))
    simulation = replace(REFERENCE.simulation, timestep_s=0.1 * REFERENCE.simulation.timestep_s)
    fine = Evaluator(MAP, replace(REFERENCE, simulation=simulation))(random).rise_m
    more = 1e3 * (fine - Evaluator(MAP, REFERENCE)(random).rise_m)
    yield (
        f"rises of 150 random designs are {np.median(more):.1f} mm larger in the median and {more.max():.1f} mm at most"
    )
    robots = robot_arrays(random[:100], MAP, REFERENCE.mass)
    error = balanced(robots, columns(random[:100], CONTROL), REFERENCE).error
    yield f"The energy balance is open by {100.0 * error.max():.2f} percent at most on 100 random designs"


def python():
    spans = []
    for name in ("U8", "VT8020"):
        found = map_for(name)
        ratios = [one.actuator.ratio for one in found.entries if one.actuator and one.ratio_low < UPPER[2] + 0.05]
        both = np.array(
            [(length, length, one, other) for length in (LOWER[0], UPPER[0]) for one in ratios for other in ratios]
        )
        designs = np.repeat(PAPER[:1], len(both), axis=0)
        designs[:, :4] = both
        spans.append(between(robot_arrays(designs, found).body_mass_kg.sum(axis=1), 1))
    assert MAP.lookup(4.41) is MAP.lookup(4.47)
    yield "4.41 and 4.47 are one gearbox and one jump"
    yield f"legs with the U8 weigh about {spans[0]} kg, those with the VT8020, the default, {spans[1]} kg"


@pytest.mark.parametrize(
    "page",
    [actuators, landing, losses, pytest.param(model, marks=pytest.mark.long), python],
    ids=["actuators", "landing", "losses", "model", "python"],
)
def test_figures_are_those_that_the_package_computes(page):
    assert untold(f"docs/{page.__name__}.md", page()) == []

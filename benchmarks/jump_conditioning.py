"""How accurate jumps are and what they cost: the tables of docs/model.md.

Prints the conditioning of each calibration over 200 random designs; and with rigid drives, conditioning and speed of
integrators and steps, and how each open choice of the model changes height and energy of two of the paper's designs.

    python benchmarks/jump_conditioning.py [DESIGNS]
"""

import statistics
import sys
import time
from collections.abc import Iterator
from dataclasses import replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.actuator.search import map_for
from pareto_monoped.design import LOWER, PAPER_CASES, UPPER
from pareto_monoped.jump.audit import finer, perturbed
from pareto_monoped.jump.calibration import Calibration, FadeGate, SpringContact, load_calibration
from pareto_monoped.jump.end_stops import end_stops
from pareto_monoped.jump.evaluate import Evaluations, Evaluator
from pareto_monoped.robot.population import robot_arrays

Floats = NDArray[np.float64]
MAP = map_for("VT8020")
PERTURBATIONS = 5
DEFAULT_DESIGN = PAPER_CASES["nominal"].design.as_array()


def main(count: int) -> None:
    """Print the three tables."""
    designs = np.random.default_rng(0).uniform(LOWER, UPPER, (count, len(LOWER)))
    print(f"{count} random designs; median / 90th percentile / worst; inf: a jump was lost")
    print("| calibration | jump | 1e-6: height mm | energy % | half step: height mm | energy % |")
    print("|---|---|---|---|---|---|")
    for name in ("reference", "ideal", "stand", "reference-3", "reference-1", "paper"):
        calibration = load_calibration(name)
        print(f"| {name} | {' | '.join(_conditioning(designs, calibration))} |")

    print("\n| integrator | step ms | speed | 1e-6: height mm | energy % | half step: height mm | energy % |")
    print("|---|---|---|---|---|---|---|")
    reference = load_calibration("reference-3")
    steps: tuple[tuple[Literal["Euler", "implicitfast", "RK4"], float], ...] = (
        ("Euler", 0.5),
        ("Euler", 1.0),
        ("Euler", 2.0),
        ("implicitfast", 1.0),
        ("RK4", 1.0),
        ("RK4", 2.0),
    )
    for integrator, step in steps:
        # The control period is 1 ms, or a step where that is longer.
        simulation = replace(
            reference.simulation,
            integrator=integrator,
            timestep_s=step * 1e-3,
            control_period_s=max(step, 1.0) * 1e-3,
            positions_read="state" if integrator == "RK4" else "half_step_back",
        )
        calibration = replace(reference, simulation=simulation)
        _, *changes = _conditioning(designs, calibration)
        print(f"| {integrator} | {step:g} | {_speed(designs, calibration, reference):.2f} | {' | '.join(changes)} |")

    print("\n| choice | nominal: height m | energy J | C: height m | energy J |")
    print("|---|---|---|---|---|")
    cases = np.array([PAPER_CASES[name].design.as_array() for name in ("nominal", "C")])
    for text, calibration in _choices(reference):
        found = Evaluator(MAP, calibration)(cases)
        cells = [f"{found.height_m[i]:.3f} | {found.energy_j[i]:.1f}" for i in range(2)]
        print(f"| {text} | {' | '.join(cells)} |")


def _conditioning(designs: Floats, calibration: Calibration) -> tuple[str, ...]:
    """The share of designs that jump, and the four distributions, as text."""
    base = Evaluator(MAP, calibration)(designs)
    copies = perturbed(designs, PERTURBATIONS, np.random.default_rng(1))
    spread = Evaluator(MAP, calibration)(copies)
    half = Evaluator(MAP, finer(calibration, 2))(designs)
    cells = [f"{base.ok.mean():.0%}"]
    for other, repeats in ((spread, PERTURBATIONS), (half, 1)):
        height, energy = _change(base, other, repeats)
        cells += [_three(height * 1e3), _three(energy * 1e2)]
    return tuple(cells)


def _change(base: Evaluations, other: Evaluations, repeats: int) -> tuple[Floats, Floats]:
    """Absolute change of height and relative change of energy per design that jumps; infinite for a lost jump."""
    jumped = np.repeat(base.ok, repeats)
    height = np.abs(other.height_m - np.repeat(base.height_m, repeats))[jumped]
    energy = np.abs(other.energy_j / np.repeat(base.energy_j, repeats) - 1.0)[jumped]
    return np.nan_to_num(height, nan=np.inf), np.nan_to_num(energy, nan=np.inf)


def _three(values: Floats) -> str:
    return " / ".join(f"{v:.2g}" for v in np.percentile(values, [50, 90, 100], method="higher"))


def _speed(designs: Floats, calibration: Calibration, other: Calibration) -> float:
    """Speed under ``calibration`` relative to ``other``, in designs per processor second: median of paired runs."""

    def seconds(evaluator: Evaluator) -> float:
        start = time.process_time()
        evaluator(designs)
        return time.process_time() - start

    ours, theirs = Evaluator(MAP, calibration), Evaluator(MAP, other)
    return statistics.median(seconds(theirs) / seconds(ours) for _ in range(5))


def _choices(reference: Calibration) -> Iterator[tuple[str, Calibration]]:
    """The last reference with rigid drives, then variants of it that differ in one choice each."""
    joints, drive, contact, gate = reference.joints, reference.drive, reference.contact, reference.gate
    assert isinstance(contact, SpringContact)
    assert isinstance(gate, FadeGate)
    hip, knee = end_stops(robot_arrays(DEFAULT_DESIGN, MAP), joints)
    assert knee is not None
    yield "`reference-3`", reference
    yield "`ideal-3` (no losses)", load_calibration("ideal-3")
    for scale in (0.0, 2.0, 20.0):
        damping = joints.damping_n_m_s_per_rad * scale
        yield (
            f"joint damping {damping:g} N m s/rad",
            replace(reference, joints=replace(joints, damping_n_m_s_per_rad=damping)),
        )
    for friction in (0.0, 1.0):
        yield f"joint friction {friction:g} N m", replace(reference, joints=replace(joints, friction_n_m=friction))
    yield (
        "no losses in gears and chain",
        replace(reference, drive=replace(drive, mesh_losses=False, chain_efficiency=1.0)),
    )
    yield "no voltage limit", replace(reference, drive=replace(drive, voltage_limit=False))
    yield "peak torque + 5 %", replace(reference, drive=replace(drive, peak_torque_scale=1.05))
    yield "base structure of 0.2 kg", replace(reference, mass=replace(reference.mass, base_structure_mass_kg=0.2))
    yield "links 10 % lighter", replace(reference, mass=replace(reference.mass, link_mass_scale=0.9))
    for scale in (0.5, 2.0):
        stiffness, damping = contact.stiffness_n_per_m * scale, contact.damping_n_s_per_m * scale
        yield (
            f"foot {scale:g} times as stiff",
            replace(reference, contact=replace(contact, stiffness_n_per_m=stiffness, damping_n_s_per_m=damping)),
        )
    for friction in (0.6, 3.0):
        yield f"friction {friction:g} on the floor", replace(reference, contact=replace(contact, friction=friction))
    for length in (0.005, 0.02):
        yield f"torque fades over {length * 1e3:g} mm", replace(reference, gate=replace(gate, length_m=length))
    yield "torque comes back with the floor", replace(reference, gate=replace(gate, latch=False))
    yield (
        "no m g in the controller",
        replace(reference, controller=replace(reference.controller, gravity_feed_forward=0.0)),
    )
    yield "base on a vertical guide", replace(reference, simulation=replace(reference.simulation, base_slides=False))
    for scale in (0.5, 2.0):
        stop = replace(
            knee,
            stiffness_n_m_per_rad=knee.stiffness_n_m_per_rad * scale,
            damping_n_m_s_per_rad=knee.damping_n_m_s_per_rad * scale,
        )
        given = replace(joints, stops="given", hip_stop=hip, knee_stop=stop)
        yield f"knee stop {scale:g} times as stiff", replace(reference, joints=given)
    yield "no end stops", replace(reference, joints=replace(joints, stops="given"))
    yield "rotors as armature of their joints", replace(reference, joints=replace(joints, rotors="armature"))
    yield (
        "positions read as they are",
        replace(reference, simulation=replace(reference.simulation, positions_read="state")),
    )
    yield (
        "control period of 0.25 ms",
        replace(reference, simulation=replace(reference.simulation, timestep_s=2.5e-4, control_period_s=2.5e-4)),
    )
    yield "`reference-1`", load_calibration("reference-1")


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 200)

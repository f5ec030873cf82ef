"""Where the energy of jumps goes, what the end stops do, and how good a front's audit is: tables of docs/model.md.

Prints the energy balance of the paper's designs, the constants of the end stops as simulated, how the error depends on
which positions the controller reads, and the audits of a stored study.

    python benchmarks/jump_energies.py [DESIGNS] [STUDY.db]
"""

import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.actuator.search import map_for
from pareto_monoped.design import CONTROL, LOWER, NAMES, PAPER_CASES, UPPER, columns, complete
from pareto_monoped.jump.audit import audit
from pareto_monoped.jump.balance import balanced, energy_balance
from pareto_monoped.jump.calibration import Calibration, load_calibration
from pareto_monoped.jump.end_stops import end_stops, slow_torque_n_m
from pareto_monoped.jump.evaluate import Evaluator
from pareto_monoped.robot.population import robot_arrays
from pareto_monoped.storage.reader import read_study

Floats = NDArray[np.float64]
MAP = map_for("VT8020")
FULL_AUDITS = 500
"""The most designs of a front that are audited in full."""
FINE_S = 50e-6
"""Step of the integration that counts as converged."""


def main(count: int, db: Path | None) -> None:
    """Print the tables."""
    reference = load_calibration("reference-3")
    designs = complete(np.random.default_rng(0).uniform(LOWER, UPPER, (count, len(LOWER))))
    _print_balances(reference)
    _print_stops(reference)
    robots = robot_arrays(designs, MAP, reference.mass)
    errors = 100.0 * balanced(robots, columns(designs, CONTROL), reference).error
    print(f"\nbalance of {count} random designs as the audit counts: {_percentiles(errors)} %")
    _print_readings(reference, designs)
    if db is not None:
        _print_audits(db)


def _percentiles(values: Floats) -> str:
    """Median / 90th percentile / worst."""
    return " / ".join(f"{v:.2g}" for v in np.percentile(values, [50, 90, 100], method="higher"))


def _print_balances(reference: Calibration) -> None:
    titles = "case | height m | energy | work | drive loss | bodies | rotors | potential | damping | friction | stops"
    print(f"| {titles} | contact | integrator | open |")
    print("|---" * 14 + "|")
    for name, case in PAPER_CASES.items():
        design = case.design.as_array()[None]
        found = Evaluator(MAP, reference)(design)
        balance = energy_balance(robot_arrays(design, MAP, reference.mass), columns(design, CONTROL), reference)
        entries = (
            balance.motor_work_j,
            balance.mesh_loss_j + balance.chain_loss_j,
            balance.bodies_kinetic_j,
            balance.rotors_kinetic_j,
            balance.potential_j,
            balance.damping_j,
            balance.friction_j,
            balance.stops_absorbed_j + balance.stops_stored_j,
            balance.contact_j,
            balance.integration_j,
        )
        share = 100.0 * abs(balance.residual_j) / balance.joint_work_j
        cells = [f"{found.height_m[0]:.3f}", f"{found.energy_j[0]:.2f}", *(f"{value:.2f}" for value in entries)]
        print(f"| {name} | {' | '.join(cells)} | {share:.3f} % |")


def _print_stops(reference: Calibration) -> None:
    robots = robot_arrays(PAPER_CASES["nominal"].design.as_array(), MAP)
    print("\n| stop | K, N m/rad | C, N m s/rad | w, rad | fit off by, % of the full torque | root mean square, % |")
    print("|---" * 6 + "|")
    for joint, stop in zip(("hip", "knee"), end_stops(robots, reference.joints), strict=True):
        assert stop is not None
        part = getattr(robots.stops, joint)
        beyond = np.linspace(0.0, part.travel_rad, 201)
        off = 100.0 * (slow_torque_n_m(stop, beyond) / part.torque_n_m(part.travel_rad) - _torque_share(part, beyond))
        cells = (
            f"{stop.stiffness_n_m_per_rad:.1f}",
            f"{stop.damping_n_m_s_per_rad:.2f}",
            f"{stop.width_rad:.4f}",
            f"{np.abs(off).max():.1f}",
            f"{np.sqrt(np.mean(np.square(off))):.1f}",
        )
        print(f"| {joint} | {' | '.join(cells)} |")


def _torque_share(part: Any, beyond: Floats) -> Floats:
    """Torque of a stop's part over that at its full travel."""
    return np.asarray(part.torque_n_m(beyond) / part.torque_n_m(part.travel_rad))


def _print_readings(reference: Calibration, designs: Floats) -> None:
    """Against MuJoCo's RK4 with a fine step and the same held torques."""

    def jumps(**changes: Any) -> tuple[Floats, Floats, Floats]:
        simulation = replace(reference.simulation, **changes)
        found = Evaluator(MAP, replace(reference, simulation=simulation))(designs)
        return found.height_m, found.energy_j, found.electrical_energy_j

    exact = jumps(integrator="RK4", timestep_s=FINE_S, positions_read="state")
    print("\n| controller reads | height mm | energy % | energy at the battery % |")
    print("|---|---|---|---|")
    for text, reads in (("half a step back", "half_step_back"), ("the state", "state")):
        found = jumps(positions_read=reads)
        height = 1e3 * np.abs(found[0] - exact[0])
        shares = [100.0 * np.abs(ours / theirs - 1.0) for ours, theirs in zip(found[1:], exact[1:], strict=True)]
        kept = np.isfinite(height)
        print(f"| {text} | {' | '.join(_percentiles(values[kept]) for values in (height, *shares))} |")


def _print_audits(db: Path) -> None:
    """90th percentile / worst of full audits of designs of a study's front; the study itself needs only brief ones."""
    data = read_study(db)
    front = data.front()
    designs = front.iloc[:: -(-len(front) // FULL_AUDITS)][list(NAMES)].to_numpy(dtype=np.float64)
    audits = audit(designs, MAP, data.calibration, workers=2)
    kinds = {
        "1e-6": "spread",
        "half step": "half_step",
        "quarter step": "quarter_step",
        "control period a quarter": "control_period",
    }
    print()
    print(f"| | {' | '.join(kinds)} | balance off |")
    print("|---" * 6 + "|")
    print(f"| designs | {len(designs)} of {len(front)} | | | | |")
    for text, ending, scale in (("height mm", "height_m", 1e3), ("energy %", "energy", 1e2)):
        cells = [_two(scale * getattr(audits, f"{kind}_{ending}")) for kind in kinds.values()]
        balance = _two(1e2 * audits.energy_balance_error) if ending == "energy" else ""
        print(f"| {text} | {' | '.join(cells)} | {balance} |")


def _two(values: Floats) -> str:
    return " / ".join(f"{v:.2g}" for v in np.percentile(values, [90, 100], method="higher"))


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 200, Path(sys.argv[2]) if len(sys.argv) > 2 else None)

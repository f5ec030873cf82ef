"""What each difference between the calibrations `reference-3` and `reference` does to jumps: a table of docs/model.md.

Prints height, energies and peak loads of the paper's designs and of three from a front, with one difference after
another.

python benchmarks/jump_machine.py
"""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from pareto_monoped.actuator.search import map_for
from pareto_monoped.design import PAPER_CASES, complete
from pareto_monoped.jump.calibration import Calibration, load_calibration, on_stand
from pareto_monoped.jump.evaluate import Evaluator

MAP = map_for("VT8020")
FRONT = (
    (0.4143, 0.3009, 4.0909, 4.0909, 5.0, 9.98, 0.0),
    (0.3903, 0.4999, 5.2, 4.0909, 5.0, 9.99, 0.0),
    (0.5, 0.4998, 7.0588, 4.0909, 5.717, 0.0, 0.06),
)
"""Of 2,000 jumps of studies/quick.toml under `reference`, nearest to 0.8, 1.0 and 1.2 m."""


def machines() -> Iterator[tuple[str, Calibration]]:
    """Yield calibrations, each with one thing more than the one before, from ``reference-3`` to ``reference``."""
    now, wanted = load_calibration("reference-3"), load_calibration("reference")
    yield "`reference-3`", now
    now = replace(
        now,
        joints=replace(now.joints, stop_law=wanted.joints.stop_law),
        simulation=replace(now.simulation, timestep_s=wanted.simulation.timestep_s),
    )
    yield "bumpers", now
    now = replace(now, drive=replace(now.drive, elastic=True, drive_damping_ratio=wanted.drive.drive_damping_ratio))
    yield "drives", now
    now = replace(now, drive=replace(now.drive, battery=wanted.drive.battery))
    yield "bus", now
    now = replace(now, drive=replace(now.drive, winding_rise_k=wanted.drive.winding_rise_k))
    yield "60 degC", now
    yield "friction: `reference`", wanted
    yield "on the stand", on_stand(wanted)


def main() -> None:
    """Print the table, a row for each design and machine."""
    names = [*PAPER_CASES, "front, 0.8 m", "front, 1.0 m", "front, 1.2 m"]
    paper = np.array([case.design.as_array() for case in PAPER_CASES.values()])
    designs = np.vstack([complete(paper), complete(np.array(FRONT))])
    found = {text: Evaluator(MAP, calibration)(designs) for text, calibration in machines()}
    print("| design | with | height m | J | J, battery | chain N | foot N | stop N m |")
    print("|---|---|---|---|---|---|---|---|")
    for i, name in enumerate(names):
        for text, jumps in found.items():
            energies = f"{jumps.height_m[i]:.3f} | {jumps.energy_j[i]:.1f} | {jumps.electrical_energy_j[i]:.1f}"
            loads = (jumps.peak_chain_tension_n[i], jumps.peak_foot_force_n[i], jumps.peak_stop_torque_n_m[i])
            print(f"| {name} | {text} | {energies} | {' | '.join(f'{load:.0f}' for load in loads)} |")


if __name__ == "__main__":
    main()

"""Torque over time against the law ``tracking`` on robots as built: the table of docs/limit.md.

    python benchmarks/limit_as_built.py [--jumps N]

Every cell has the least energy's torques over time first, then those of the law ``tracking`` at the same height; the
shares begin with those of the virtual leg.
"""

import argparse

from pareto_monoped.actuator.search import map_for
from pareto_monoped.analysis.limit import JUMPS, limit_of
from pareto_monoped.design import PAPER_CASES, Design
from pareto_monoped.jump.calibration import load_calibration

PAPER = {f"paper's {name}": PAPER_CASES[name].design for name in ("nominal", "B", "C")}
DESIGNS = {
    "VT8020": PAPER
    | {
        "0.90 m": Design.from_array([0.5, 0.301, 4.09, 4.09, 5.0, 10.0, 0.0]),
        "1.25 m": Design.from_array([0.5, 0.5, 7.2, 4.09, 7.5, 0.2, 0.0]),
    },
    "U8": PAPER,
}


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--jumps", type=int, default=JUMPS)
    given = parser.parse_args()
    calibration = load_calibration("reference")
    heads = ("motor, design", "height, m", "energy, J", "late, mm", "-5 %, mm", "+5 %, mm", "as built, m")
    print(f"| {' | '.join((*heads, 'high, %', 'hold, %'))} |\n|{'---|' * (len(heads) + 2)}")
    for motor, designs in DESIGNS.items():
        for name, design in designs.items():
            one = limit_of(design.as_array(), map_for(motor), calibration, jumps=given.jumps, workers=2)
            both = [jump for jump in (one.over_time, one.tracking) if jump is not None]
            built = [jump.perturbed for jump in both if jump.perturbed is not None]
            if one.perturbed is None or len(built) < 2:
                raise SystemExit(f"{motor}, {name}: no tracking law was found; give more jumps")
            cells = [" / ".join(f"{jump.energy_j:.2f}" for jump in both)]
            for change in ("late_m", "weak_m", "strong_m"):
                cells.append(" / ".join(f"{1000.0 * getattr(found, change):+.0f}" for found in built))
            cells.append(" / ".join(f"{found.p05_m:.2f}-{found.p95_m:.2f}" for found in built))
            for share in ("reaches", "holds"):
                cells.append(" / ".join(f"{100.0 * getattr(found, share):.0f}" for found in (one.perturbed, *built)))
            print(f"| {motor}, {name} | {one.height_m:.3f} | {' | '.join(cells)} |", flush=True)


if __name__ == "__main__":
    main()

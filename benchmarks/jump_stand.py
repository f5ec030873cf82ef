"""What the test stand does to the jumps of the paper's designs: the table of docs/model.md.

Prints height, mechanical energy and energy from the battery, with one difference after another.

python benchmarks/jump_stand.py
"""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from pareto_monoped.actuator.search import map_for
from pareto_monoped.design import PAPER_CASES
from pareto_monoped.jump.calibration import Calibration, Stand, load_calibration, on_stand
from pareto_monoped.jump.evaluate import Evaluator

MAP = map_for("VT8020")


def machines() -> Iterator[tuple[str, Calibration]]:
    """Yield calibrations, each with one thing more than the one before, from ``reference-3`` to ``stand-1``."""
    reference = load_calibration("reference-3")
    guided = replace(reference, simulation=replace(reference.simulation, base_slides=False))
    yield "`reference-3`", reference
    yield "the base moves in z only", guided
    yield "arms and carriages", replace(guided, stand=Stand(rail_friction_n=0.0))
    yield "friction of the rails: `stand-1`", on_stand(reference)


def main() -> None:
    """Print the table."""
    names = list(PAPER_CASES)
    print(f"| with | {' | '.join(f'{name}: m | J | J, battery' for name in names)} |")
    print("|---" * (1 + 3 * len(names)) + "|")
    designs = np.array([case.design.as_array() for case in PAPER_CASES.values()])
    for text, calibration in machines():
        found = Evaluator(MAP, calibration)(designs)
        columns = zip(found.height_m, found.energy_j, found.electrical_energy_j, strict=True)
        cells = (f"{height:.3f} | {energy:.1f} | {battery:.1f}" for height, energy, battery in columns)
        print(f"| {text} | {' | '.join(cells)} |")


if __name__ == "__main__":
    main()

"""Fit the calibration ``paper`` to Table I and write its file.

Three numbers are fitted; everything else in the calibration is data or follows the paper's text. Errors are those of
medians over perturbations of 1e-6, because rounding may decide a single jump of the literal model.

    python tools/fit_paper.py [--evaluations N] [--write]
"""

import argparse
import re
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import cma
import numpy as np
from numpy.typing import NDArray

import pareto_monoped
from pareto_monoped.actuator.search import map_for
from pareto_monoped.design import PAPER_CASES, PAPER_MOTOR
from pareto_monoped.files import write_text
from pareto_monoped.jump.calibration import Calibration, load_calibration
from pareto_monoped.jump.table1 import Spread, paper_spreads

Floats = NDArray[np.float64]

FITTED: dict[str, tuple[float, float, int]] = {
    # key in the TOML file: lower bound, upper bound, digits kept
    "motor_damping_n_m_s_per_rad": (0.0, 0.06, 5),
    "link_mass_scale": (0.6, 2.2, 3),
    "foot_mass_kg": (0.01, 0.6, 3),
}
PUBLISHED: Floats = np.array([[case.height_m, case.energy_j] for case in PAPER_CASES.values()])
_PARTS = ("mass", "joints", "drive", "controller", "contact")
"""Parts of a calibration that may hold a fitted number."""
FIT_PERTURBATIONS = 9
"""Copies per case during the fit: fewer than ``table1.PERTURBATIONS``, and drawn with another seed."""
LINK_SCALES = (0.975, 0.99, 1.0, 1.01, 1.025)
"""Factors on the mass of the links; a fit counts with the worst of them."""


def with_numbers(calibration: Calibration, numbers: Floats) -> Calibration:
    """``calibration`` with the fitted numbers replaced by ``numbers``, rounded to the digits that are kept."""
    values = {key: round(float(x), digits) for x, (key, (_, _, digits)) in zip(numbers, FITTED.items(), strict=True)}
    parts = {}
    for name in _PARTS:
        record = getattr(calibration, name)
        chosen = {key: value for key, value in values.items() if hasattr(record, key)}
        parts[name] = replace(record, **chosen)
    return replace(calibration, **parts)


def errors(spreads: tuple[Spread, ...]) -> Floats:
    """Relative errors of the eight medians, shape (4, 2): height and energy per case; 1 for a case that never jumps."""
    medians = np.array([[spread.height_m, spread.energy_j] for spread in spreads])
    return np.nan_to_num(medians / PUBLISHED - 1.0, nan=1.0)


def objective(start: Calibration) -> Callable[[Floats], float]:
    """What the fit minimises, as a function of the fitted numbers.

    It is the worst of the eight errors, plus a fifth of their mean so that the other errors matter too, plus the share
    of copies that do not jump. The worst over ``LINK_SCALES`` counts: the foot of the literal model chatters, and how
    it does can change within a few grams; a fit must not lie on or beside such a place.
    """
    actuators = map_for(PAPER_MOTOR, "paper")

    def value(numbers: Floats) -> float:
        found = []
        for scale in LINK_SCALES:
            calibration = with_numbers(start, numbers)
            mass = replace(calibration.mass, link_mass_scale=scale * calibration.mass.link_mass_scale)
            spreads = paper_spreads(actuators, replace(calibration, mass=mass), perturbations=FIT_PERTURBATIONS, seed=1)
            off = np.abs(errors(spreads))
            lost = 1.0 - min(spread.jumped_share for spread in spreads)
            found.append(float(off.max() + 0.2 * off.mean() + lost))
        return max(found)

    return value


def fit(start: Calibration, evaluations: int) -> Floats:
    """The fitted numbers, found by CMA-ES within bounds, starting from the current numbers of the file."""
    lower, upper = (np.array([bounds[k] for bounds in FITTED.values()]) for k in (0, 1))
    now = np.array([_current(start, key) for key in FITTED])
    strategy = cma.CMAEvolutionStrategy(
        (np.clip(now, lower, upper) - lower) / (upper - lower),
        0.02,
        {"bounds": [0.0, 1.0], "maxfevals": evaluations, "seed": 1, "verbose": -9, "popsize": 12},
    )
    value = objective(start)
    while not strategy.stop():
        points = strategy.ask()
        strategy.tell(points, [value(lower + np.asarray(point) * (upper - lower)) for point in points])
        print(f"{strategy.result.evaluations:5d} jumps of all cases, {strategy.result.fbest:.4f}", file=sys.stderr)
    return np.asarray(lower + strategy.result.xbest * (upper - lower), dtype=np.float64)


def _current(calibration: Calibration, key: str) -> float:
    for record in (getattr(calibration, name) for name in _PARTS):
        if hasattr(record, key):
            value = getattr(record, key)
            return 0.0 if value is None else float(value)
    raise KeyError(key)


def write(calibration: Calibration, path: Path) -> None:
    """Write the fitted numbers into the calibration's file and leave everything else as it is, comments included."""
    text = path.read_text(encoding="utf-8")
    for key in FITTED:
        text, count = re.subn(rf"(?m)^{key} = .*?(\s+#|$)", rf"{key} = {_current(calibration, key)!r}\1", text)
        if count != 1:
            raise SystemExit(f"{path}: {key} is set {count} times; it must be set exactly once")
    write_text(path, text)


def show(calibration: Calibration) -> None:
    """Print the fitted numbers and, per case, medians, errors and percentiles."""
    spreads = paper_spreads(map_for(PAPER_MOTOR, "paper"), calibration)
    for key in FITTED:
        print(f"{key} = {_current(calibration, key)!r}")
    print("| case | height m | paper | off | 5 to 95 % | energy J | paper | off | 5 to 95 % |")
    print("|---|---|---|---|---|---|---|---|---|")
    for case, s, off in zip(PAPER_CASES.values(), spreads, errors(spreads), strict=True):
        print(
            f"| {case.name} | {s.height_m:.3f} | {case.height_m:.3f} | {off[0]:+.1%} "
            f"| {s.height_p05_m:.3f} to {s.height_p95_m:.3f} | {s.energy_j:.2f} | {case.energy_j:.2f} | {off[1]:+.1%} "
            f"| {s.energy_p05_j:.2f} to {s.energy_p95_j:.2f} |"
        )
    saved = 1.0 - spreads[-1].energy_j / spreads[0].energy_j
    jumped = min(spread.jumped_share for spread in spreads)
    print(
        f"largest error {np.abs(errors(spreads)).max():.1%}; case C takes {saved:.1%} less energy than nominal; "
        f"{jumped:.0%} of the copies jump"
    )


def main() -> None:
    """Fit and print the result; write it to the file if ``--write`` is given."""
    parser = argparse.ArgumentParser(description="Fit the calibration 'paper' to Table I.")
    parser.add_argument("--evaluations", type=int, default=400, help="0 only shows the numbers of the file")
    parser.add_argument("--write", action="store_true", help="write the numbers into data/calibrations/paper.toml")
    arguments = parser.parse_args()
    calibration = load_calibration("paper")
    if arguments.evaluations:
        calibration = with_numbers(calibration, fit(calibration, arguments.evaluations))
    show(calibration)
    if arguments.write:
        write(calibration, Path(pareto_monoped.__file__).parent / "data" / "calibrations" / "paper.toml")


if __name__ == "__main__":
    main()

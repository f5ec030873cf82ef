"""The log of a real jump beside the simulated one, and what of the machine follows from it.

A log has one row per sample. Its header names quantities with their units: ``time_s`` from the start of the push,
``hip_rad`` and ``knee_rad`` of the motors' encoders as angles of their joints, ``hip_current_a`` and
``knee_current_a`` of the motors, ``height_m`` of the base above the floor.

Four numbers of the machine are fitted to the samples of the push by least squares: what is measured less what is
simulated, over the noise of each column, which is estimated from the residuals, with Huber's loss. A wrong zero of a
column does not count. Intervals follow from the slopes and hold for all numbers together with 95 percent (Bonferroni).
Residuals that follow from each other count as fewer samples than they are.
"""

import csv
import math
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import OptimizeResult, least_squares

from pareto_monoped.actuator.ratiomap import Maps
from pareto_monoped.config import MAX_JSON_CHARACTERS
from pareto_monoped.design import Design, Floats, control_of
from pareto_monoped.errors import InputError, SimulationError, complaint
from pareto_monoped.files import open_file
from pareto_monoped.jump.calibration import Calibration
from pareto_monoped.jump.controller_record import MOST_DELAY
from pareto_monoped.jump.engines import PlanarPopulation, population_of
from pareto_monoped.jump.evaluate import evaluate_robots
from pareto_monoped.jump.model import joint_friction_n_m, joint_places, motor_places, start_pose
from pareto_monoped.jump.variations import take
from pareto_monoped.robot.population import robot_arrays

_UNITS = {
    "time": {"s": 1.0, "ms": 1e-3},
    "height": {"m": 1.0, "cm": 1e-2, "mm": 1e-3},
    "hip": {"rad": 1.0, "deg": math.pi / 180.0},
    "knee": {"rad": 1.0, "deg": math.pi / 180.0},
    "hip_current": {"a": 1.0, "ma": 1e-3},
    "knee_current": {"a": 1.0, "ma": 1e-3},
}  #: Quantity -> unit at the end of its column's name -> factor to SI.
SIGNALS = ("height", "hip", "knee", "hip_current", "knee_current")
"""What a log may have besides the time; at least one encoder and one current."""
SI = {"height": "m", "hip": "rad", "knee": "rad", "hip_current": "A", "knee_current": "A"}
PARAMETERS = ("friction", "torque_constant", "delay", "stiffness")
"""Fitted: factors on Coulomb friction of both joints, on both torque constants and on the stiffness of both drives,
and the delay from measuring to acting in s."""
_BEGINS = (0.75, 1.0, 1.35)  # shares of the nominal stiffness at which fits begin, of which the best counts; our choice
_OBSERVED = [1, 14, 15, 12, 13]  # where ``SIGNALS`` stand in ``controller_record.OBSERVED``
_STEP_S = 5e-5  # With that of ``reference``, steps move the fit by as much as the noise of good sensors.
_FEWEST = 50  # samples during the push; our own choice
_STEPS = np.array([0.05, 0.005, 0.0, 0.02])  # of the differences; that of the delay is one control period
_LEAST, _MOST = np.array([0.0, 0.5, 0.0, 0.1]), np.array([10.0, 2.0, np.inf, 10.0])
_PASSES = 3  # of the noise, which is that of the residuals
_STUDENT = 2.50  # half width over standard deviation: 1 - 0.05 / 8 of normal noise, for four intervals together
_BEFORE_END_S = 0.01  # As the foot rises, the push fades with its last micrometres.
_MAD = 1.4826  # standard deviation over median absolute deviation of normal noise
_OUTLIER = 3.0  # standard deviations from which a residual counts less (Huber)


@dataclass(frozen=True, slots=True, kw_only=True)
class Log:
    """A log in SI units."""

    time_s: Floats  #: shape (n,)
    signals: dict[str, Floats]  #: by name of ``SIGNALS``, each of shape (n,)


@dataclass(frozen=True, slots=True, kw_only=True)
class Fitted:
    """One number of the machine."""

    value: float
    #: lower, upper: with 95 percent, the intervals of all numbers hold together
    lower: float
    upper: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Comparison:
    """A log beside the jump as simulated and as fitted."""

    samples: int  #: rows that count
    #: before, after: root mean square of measured less simulated, in ``SI``, as designed and as fitted
    before: dict[str, float]
    after: dict[str, float]
    fitted: dict[str, Fitted]  #: by ``PARAMETERS``


def read_log(path: Path) -> Log:
    """Return the log of a CSV file.

    Raises:
        InputError: unreadable, a column without a known unit or twice, a cell that is no number, times that do not
            rise, or too few rows or columns.
    """
    source = f"log {path.name!r}"
    try:
        with open_file(path) as stream:
            text = stream.read(MAX_JSON_CHARACTERS + 1).decode()
    except OSError as problem:
        raise InputError(f"log {str(path)!r}: cannot be read ({problem.strerror}); check the path") from None
    except ValueError:
        raise InputError(f"{source}: is no text in UTF-8; give a CSV file") from None
    rows = [row for row in csv.reader(text.splitlines()) if row]
    if not rows:
        raise InputError(f"{source}: is empty; give a header and a row per sample")
    names, factors = _header(rows[0], source)
    values = np.empty((len(rows) - 1, len(names)))
    for i, row in enumerate(rows[1:]):
        if len(row) != len(names):
            raise InputError(
                f"{source}, row {i + 2}: has {len(row)} cells, must be {len(names)} as in the header; correct it"
            )
        for k, cell in enumerate(row):
            try:
                values[i, k] = float(cell) * factors[k]
            except ValueError:
                values[i, k] = np.nan
            if not math.isfinite(values[i, k]):
                raise InputError(f"{source}, row {i + 2}: {complaint(names[k], cell, 'a finite number', 'correct it')}")
    found = dict(zip(names, values.T, strict=True))
    time = found.pop("time")
    if not (np.diff(time) > 0.0).all():
        raise InputError(f"{source}: time must rise from row to row; sort the rows and drop those that are twice")
    return Log(time_s=time, signals=found)


def _header(cells: list[str], source: str) -> tuple[list[str], list[float]]:
    """Return names and factors of the columns."""
    names, factors = [], []
    for cell in cells:
        quantity, _, unit = cell.strip().lower().rpartition("_")
        if unit not in _UNITS.get(quantity, {}):
            known = ", ".join(f"{name}_{'|'.join(units)}" for name, units in _UNITS.items())
            raise InputError(f"{source}: {complaint('column', cell, f'one of {known}', 'rename it')}")
        if quantity in names:
            raise InputError(f"{source}: column {cell!r} stands twice; drop one")
        names.append(quantity)
        factors.append(_UNITS[quantity][unit])
    for group in (("time",), ("hip", "knee"), ("hip_current", "knee_current")):
        if not set(group) & set(names):
            raise InputError(f"{source}: has no column {' or '.join(group)} with its unit; add one")
    return names, factors


class _Machine:
    """The simulated jump of a design, as its signals at the samples' times and for any parameters."""

    def __init__(self, design: Design, maps: Maps, calibration: Calibration) -> None:
        if lacks := calibration.lacks_for_compiled():
            raise InputError(complaint("calibration", calibration.label, f"one with {lacks}", "choose another"))
        values = design.as_array()[None, :]
        known = calibration.by("compiled").simulation
        fine = replace(known, timestep_s=known.period_s / math.ceil(known.period_s / _STEP_S - 1e-9))
        self.calibration = calibration = replace(calibration, simulation=replace(fine, control_period_s=known.period_s))
        self.robots = robot_arrays(values, maps, calibration.mass)
        self.control = control_of(values)
        self.pose = start_pose(self.robots, calibration)
        alone = evaluate_robots(self.robots, self.control, calibration)
        if not alone.ok[0]:
            raise SimulationError(f"design: does not jump as simulated, {alone.reason[0]}; compare with another design")
        self.step_s, self.period_s = calibration.simulation.timestep_s, calibration.simulation.period_s
        rubs = bool(joint_friction_n_m(self.robots, calibration.joints).any())
        self.free = [rubs, True, True, calibration.drive.elastic]
        self.most = np.minimum(_MOST, [np.inf, np.inf, (MOST_DELAY - 1) * self.period_s, np.inf])
        self.steps = np.where(_STEPS > 0.0, _STEPS, self.period_s)

    def nominal(self) -> Floats:
        return np.array([1.0, 1.0, self.calibration.simulation.delay_s, 1.0])

    def signals(self, parameters: Floats, times: Floats, names: list[str]) -> Floats:
        """Return the signals of n sets of parameters, shape (n, len of ``names``, len of ``times``).

        A delay of no whole control periods is taken by a parabola through the jumps of three. Currents are held for a
        period; their edges are those of the first set's delay in all sets, since samples see edges only by chance.
        """
        periods = np.clip(parameters[:, 2] / self.period_s, 0.0, MOST_DELAY - 1)
        whole = np.minimum(np.floor(periods), MOST_DELAY - 2)
        late = whole + np.arange(3.0)[:, None]
        ends = [np.column_stack([parameters[:, :2], one * self.period_s, parameters[:, 3]]) for one in late]
        # A delay that is varied by a period meets those of the others: no jump is made twice.
        different, place = np.unique(np.concatenate(ends), axis=0, return_inverse=True)
        jumps = self._population(different)
        # Edges move by three periods at most.
        steps = int(times[-1] / self.step_s) + 3 + 3 * round(self.period_s / self.step_s)
        jumps.records["step_limit"] = steps
        trace = np.full((len(different), steps, len(_OBSERVED)), np.nan)
        for one, seen in zip(trace, jumps.observed(), strict=True):
            one[: len(seen)] = seen[:steps, _OBSERVED]
        trace = trace[place.ravel()]
        constants = self.robots.ratio[0] * self.robots.torque_constant_n_m_per_a[0]
        # The drives take their current from the nominal constant.
        trace[:, :, 3:] /= constants * np.tile(parameters[:, 1], 3)[:, None, None]
        edges = periods[0] - late.ravel()
        column = {name: k for k, name in enumerate(SIGNALS)}
        found = []
        for name in names:
            values = _held(trace[:, :, column[name]])
            if name in ("hip_current", "knee_current"):
                at = times - edges[:, None] * self.period_s
                step = np.minimum(np.floor(at / self.step_s + 1e-6).astype(int), steps - 1)
                found.append(np.where(step >= 0, np.take_along_axis(values, np.maximum(step, 0), axis=1), 0.0))
            else:
                # The positions of a semi-implicit step belong to half a step later (docs/model.md).
                at = np.maximum(times / self.step_s - 0.5, 0.0)
                step = at.astype(int)
                share = at - step
                found.append((1.0 - share) * values[:, step] + share * values[:, step + 1])
        jumped = np.stack(found, axis=1).reshape(3, len(parameters), len(names), len(times))
        u = periods - whole
        parabola = np.array([0.5 * (1.0 - u) * (2.0 - u), u * (2.0 - u), 0.5 * u * (u - 1.0)])
        return np.asarray(np.einsum("kn,knst->nst", parabola, jumped))

    def _population(self, parameters: Floats) -> PlanarPopulation:
        rows = np.zeros(len(parameters), dtype=np.intp)
        jumps = population_of(take(self.robots, rows), self.control[rows], take(self.pose, rows), self.calibration)
        assert isinstance(jumps, PlanarPopulation)
        friction, constant, delay, stiffness = parameters.T
        jumps.grounds["joint_friction_n_m"] *= friction[:, None]
        records = jumps.records
        for name in ("stiffness_n_per_m", "damping_n_s_per_m", "torsional_stiffness_n_m_per_rad", "weight_n"):
            records[name] *= constant
        records["torque_limit_n_m"] *= constant[:, None]
        records["delay_periods"] = np.round(delay / self.period_s)
        records["drive_n_m_per_rad"] *= stiffness[:, None]
        motors, joints = motor_places(self.calibration), joint_places(self.calibration)
        wound = jumps.start[:, motors] - jumps.start[:, joints]
        jumps.start[:, motors] = jumps.start[:, joints] + wound / stiffness[:, None]
        return jumps


def _held(values: Floats) -> Floats:
    """Return rows in which the last number before the end of a jump goes on."""
    places = np.where(np.isfinite(values), np.arange(values.shape[1]), 0)
    return np.asarray(np.take_along_axis(values, np.maximum.accumulate(places, axis=1), axis=1))


def compare(log: Log, design: Design, maps: Maps, calibration: Calibration) -> Comparison:
    """Compare a log with the jump of a design and fit ``PARAMETERS``, less friction or stiffness that a design lacks.

    Raises:
        InputError: too few samples during the push.
        SimulationError: the design does not jump, or the fit does not settle.
    """
    machine = _Machine(design, maps, calibration)
    names = [name for name in SIGNALS if name in log.signals]
    counts = (log.time_s >= 0.0) & (log.time_s <= _pushed_s(log))
    times, measured = log.time_s[counts], np.array([log.signals[name][counts] for name in names])
    if len(times) < _FEWEST:
        raise InputError(complaint("samples", len(times), f"{_FEWEST} at least during the push", "log faster"))
    free, nominal = np.flatnonzero(machine.free), machine.nominal()
    trials = _Trials(machine, free, times, names, measured)
    first = trials.left(nominal[free])
    scale = np.sqrt(np.mean(first**2, axis=1, keepdims=True))

    def fit(start: Floats, scale: Floats) -> OptimizeResult:
        return least_squares(
            lambda x: (trials.left(x) / scale).ravel(),
            start,
            lambda x: (trials.slopes(x) / scale).reshape(len(free), -1).T,
            bounds=(_LEAST[free], machine.most[free]),
            x_scale=machine.steps[free],
            loss="huber",
            f_scale=_OUTLIER,
        )

    # A drive swings, so that a fit may stop at a stiffness with one swing more or less.
    stiffness = free == PARAMETERS.index("stiffness")
    starts = [np.where(stiffness, share, 1.0) * nominal[free] for share in (_BEGINS if stiffness.any() else (1.0,))]
    found = min((fit(start, scale) for start in starts), key=lambda one: one.cost)
    for _ in range(_PASSES):
        left = trials.left(found.x)
        scale = _MAD * np.median(np.abs(left), axis=1, keepdims=True)
        found = fit(found.x, scale)
    values, left = found.x, trials.left(found.x)
    if not found.success:
        raise SimulationError("fit: does not settle; check that log, design and calibration belong together")
    half = _STUDENT * np.sqrt(np.diag(np.linalg.inv(found.jac.T @ found.jac)) * _repeats(left))
    fitted = {
        PARAMETERS[k]: Fitted(value=float(value), lower=float(value - one), upper=float(value + one))
        for k, value, one in zip(free, values, half, strict=True)
    }
    return Comparison(samples=len(times), before=_rms(names, first), after=_rms(names, left), fitted=fitted)


@dataclass(frozen=True, slots=True)
class _Trials:
    """What a log says less what the machine would do, and its slopes."""

    machine: _Machine
    free: NDArray[np.intp]  #: places of what is fitted in ``PARAMETERS``
    times: Floats
    names: list[str]
    measured: Floats  #: shape (len of ``names``, len of ``times``)

    def left(self, values: Floats) -> Floats:
        """Return measured less simulated, shape (len of ``names``, len of ``times``), less what a wrong zero adds."""
        return _centred(self.measured - self._signals(values[None, :])[0])

    def slopes(self, values: Floats) -> Floats:
        """Return the slopes of ``left``, shape (len of ``free``, len of ``names``, len of ``times``)."""
        least, most = _LEAST[self.free], self.machine.most[self.free]
        step = np.diag(self.machine.steps[self.free])
        more, less = np.minimum(values + step, most), np.maximum(values - step, least)
        signals = self._signals(np.concatenate([values[None, :], more, less]))
        n = len(values)
        return _centred((signals[1 + n :] - signals[1 : 1 + n]) / np.diag(more - less)[:, None, None])

    def _signals(self, values: Floats) -> Floats:
        trials = np.tile(self.machine.nominal(), (len(values), 1))
        trials[:, self.free] = values
        return self.machine.signals(trials, self.times, self.names)


def _pushed_s(log: Log) -> float:
    """Return when the push is over: from then on, no current is more than a tenth of the largest."""
    currents = np.abs([log.signals[name] for name in ("hip_current", "knee_current") if name in log.signals])
    flows = (currents > 0.1 * currents.max()).any(axis=0)
    return float(log.time_s[np.flatnonzero(flows)[-1]]) - _BEFORE_END_S if flows.any() else 0.0


def _centred(values: Floats) -> Floats:
    return np.asarray(values - values.mean(axis=-1, keepdims=True))


def _rms(names: list[str], left: Floats) -> dict[str, float]:
    return dict(zip(names, np.sqrt(np.mean(left**2, axis=1)).tolist(), strict=True))


def _repeats(left: Floats) -> float:
    """Return how many samples say the same once: (1 + r) / (1 - r) with the residuals' correlation r to the next."""
    share = [float(np.clip(row[1:] @ row[:-1] / (row @ row), 0.0, 0.99)) for row in left]
    return max((1.0 + r) / (1.0 - r) for r in share)

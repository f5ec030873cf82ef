"""Losses of two printed actuators on a public test bench, held against the package's own: docs/bench.md and its figure.

On that bench, an actuator turns a second one that brakes it. Both drives hold their currents while the speed changes
from run to run, so that losses in windings and switches stay the same, and the slope of a drive's power over the speed
of the shaft is the torque of its motor. This needs neither a torque constant nor a resistance.

python benchmarks/actuator_bench.py [--figure FILE]
"""

import argparse
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq
from scipy.stats import t as student

from pareto_monoped.actuator.gearset import GearSet, efficiency
from pareto_monoped.actuator.motors import load_motor
from pareto_monoped.actuator.search import map_for
from pareto_monoped.actuator.service.sheet import planet_bearing_loss, service_sheet

Floats = NDArray[np.float64]
DATA = Path(__file__).parent / "data" / "actuator_bench.csv"
RECORDS: Any = np.rec  # whose stubs ask for formats
SMALL, COMPOUND = "7.2:1", "14:1"
RATIOS, MOTORS = {SMALL: 7.2, COMPOUND: 14.0}, {SMALL: "MN8014", COMPOUND: "MAD_M6C12"}
GEARS = GearSet(sun_teeth=25.0, planet_teeth=65.0, ring_teeth=155.0, module_mm=0.5, planets=3.0)
"""Of the 7.2:1 actuator (COMPAct, sspg_equations_7.2_7.3.txt)."""
MESHES = (18, 66), (33, 117)
"""Sun and large planet, small planet and ring of the 14:1 actuator (COMPAct, cpg_equations_14.0_15.0.txt)."""
PIN_MM, BALLS = 8.0, 0.0015  # planets turn on ball bearings of 8 mm; their friction is that of service.toml
COULOMB = 0.2 / 18.0  # friction without load over peak torque, and
VISCOUS = 0.01 / 6.0**2 / 3.0  # over ratio squared and the motor's peak torque (Cheetah-Software, MiniCheetah.h)
FRICTIONS = (0.05, 0.1, 0.2, 0.3, 0.5)
PROPORTIONAL = range(1, 14)  # commands up to which losses of the 7.2:1 actuator grow with the torque
SESSIONS = {"A": (2, 3, 4, *range(6, 14)), "B": (5, *range(14, 19))}  # of the 14:1 actuator, by the ratio of speeds


class Line(NamedTuple):
    """y = slope x - offset by least squares, each with half its 95 percent interval."""

    slope: float
    slope_pm: float
    offset: float
    offset_pm: float


def read(name: str) -> Any:
    """Return the runs of an actuator as columns of the file, with the shaft's speed in rad/s as ``speed``."""
    rows = np.genfromtxt(DATA, delimiter=",", skip_header=5, names=True, dtype=None, encoding="utf-8")
    rows = rows[rows["actuator"] == name]
    columns = {key: rows[key] for key in rows.dtype.names} | {"speed": rows["load_rpm"] * np.pi / 30.0}
    return RECORDS.fromarrays(list(columns.values()), names=list(columns))


def torques(runs: Any) -> Any:
    """Return what both motors do at each command, as columns.

    ``driving`` and ``braking`` are the motors' torques at the shaft, ``held`` is the driving one's power at standstill,
    ``cell`` and ``reported`` are means of load cell and braking drive, ``drift`` is what the latter loses with speed.
    """
    lines = []
    for command in np.unique(runs.command_n_m):
        some = runs[runs.command_n_m == command]
        (driving, held), (braking, _), (drift, _) = (
            np.polyfit(some.speed, y, 1) for y in (some.test_w, some.load_w, some.load_n_m)
        )
        reported = np.mean(some.load_n_m)
        lines.append((command, driving, braking, held, np.mean(some.cell_n_m), reported, -drift * braking / reported))
    return RECORDS.fromrecords(lines, names="command,driving,braking,held,cell,reported,drift")


def fitted(columns: Floats, y: Floats) -> tuple[Floats, Floats]:
    """Return least-squares coefficients and half their 95 percent intervals."""
    found = np.linalg.lstsq(columns, y, rcond=None)[0]
    free = len(y) - columns.shape[1]
    spread = np.sum((y - columns @ found) ** 2) / free * np.diag(np.linalg.inv(columns.T @ columns))
    return np.asarray(found, dtype=np.float64), np.asarray(student.ppf(0.975, free) * np.sqrt(spread))


def line(x: Floats, y: Floats) -> Line:
    """Return the line through points."""
    (slope, offset), (slope_pm, offset_pm) = fitted(np.column_stack([x, -np.ones_like(x)]), y)
    return Line(float(slope), float(slope_pm), float(offset), float(offset_pm))


def pair(found: Any, commands: Iterable[int]) -> Line:
    """Return efficiency under load and friction without load of both actuators together."""
    some = found[np.isin(found.command, list(commands))]
    return line(some.driving, some.braking)


def mesh_loss(pinion: int, wheel: int, friction: float, *, internal: bool = False) -> float:
    """Return the loss of one mesh of standard gears with the carrier held (Niemann/Winter; formula of ``gearset``)."""

    def sliding(teeth: int, sign: float) -> float:
        sine, cosine = np.sin(np.radians(20.0)), np.cos(np.radians(20.0))
        reach = np.sqrt(max((0.5 * teeth + sign) ** 2 - (0.5 * teeth * cosine) ** 2, 0.0)) - 0.5 * teeth * sine
        part = sign * reach / (np.pi * cosine)
        return float(0.5 * (part * abs(part) + (1.0 - part) * abs(1.0 - part)))

    sign = -1.0 if internal else 1.0
    return np.pi * friction * (1.0 / pinion + sign / wheel) * (sliding(pinion, 1.0) + sliding(wheel, sign))


def planetary(outer: tuple[int, int], inner: tuple[int, int], friction: float) -> float:
    """Return the mesh efficiency from sun to carrier of sun and planet, planet and ring; planets may be compound."""
    basic = (1.0 - mesh_loss(*outer, friction)) * (1.0 - mesh_loss(*inner, friction, internal=True))
    ratio = outer[1] / outer[0] * inner[1] / inner[0]
    return (1.0 + ratio * basic) / (1.0 + ratio)


def own(name: str, friction: float) -> float:
    """Return the efficiency of a bench actuator's gears and planet bearings by the package's formulas."""
    if name == COMPOUND:
        return planetary(*MESHES, friction)
    return float(efficiency(GEARS, friction)) * (1.0 - float(planet_bearing_loss(GEARS, PIN_MM, BALLS)))


def no_load(name: str) -> tuple[float, float]:
    """Return Coulomb torque and viscous constant at the joint, from the MIT Mini Cheetah's model by size."""
    ratio, peak = RATIOS[name], load_motor(MOTORS[name]).peak_torque_n_m
    return COULOMB * ratio * peak, VISCOUS * ratio**2 * peak


def currents(name: str, command: Floats) -> Floats:
    """Return the DC-equivalent current of a commanded torque, by the motor's Kv."""
    return command / (RATIOS[name] * load_motor(MOTORS[name]).torque_constant_n_m_per_a)


def held(name: str, found: Any) -> tuple[Floats, Floats]:
    """Return voltage drop and resistance that explain the power at standstill, and half their intervals."""
    current = currents(name, found.command)
    return fitted(np.column_stack([current, current**2]), found.held)


def main() -> None:
    """Print the tables of docs/bench.md, and draw its figure if asked."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--figure", type=Path, help="write the figure to this file")
    path = parser.parse_args().figure
    found = {name: torques(read(name)) for name in RATIOS}
    print_tables(found)
    if path:
        from actuator_bench_figure import draw

        draw(read(SMALL), found[SMALL], path)


def print_tables(found: dict[str, Any]) -> None:
    """Print every table."""
    both = pair(found[SMALL], PROPORTIONAL)
    _table(
        "actuator | commanded, N m | driving motor | load cell | braking motor | load cell over braking motor",
        (_energy(name, at, found[name]) for name in RATIOS for at in (2, 4, 6, 7, 10, 13, 14, 18)),
    )
    _table(
        "commanded, N m | load cell | missing | (a) friction under load | (b) friction without load | (c) motor"
        " | (d) load cell | (d) at least, at most",
        (_shares(found[SMALL], both, at) for at in (2, 6, 7, 10, 13, 18)),
    )
    losses = [f"{100.0 * (1.0 - own(SMALL, friction) ** 2):.1f}" for friction in FRICTIONS]
    _table(
        f"friction coefficient | {' | '.join(map(str, FRICTIONS))} | measured",
        [["loss of both under load, %", *losses, f"{100.0 * (1.0 - both.slope):.1f} ± {100.0 * both.slope_pm:.1f}"]],
    )
    _table("what | predicted | measured", _predictions(found, both))
    _table(
        "actuator | torque over command | voltage drop, V | resistance, ohm | data sheet, ohm",
        (_electrical(name, found[name]) for name in RATIOS),
    )
    _table("ratio | gears and bearings at the peak torque, % | without load, % | together, %", _machined())


def _table(titles: str, rows: Iterable[list[str]]) -> None:
    print(f"| {titles} |\n{'|---' * (titles.count(' | ') + 1)}|")
    print("".join(f"| {' | '.join(row)} |\n" for row in rows))


def _energy(name: str, at: int, found: Any) -> list[str]:
    one = found[found.command == at][0]
    return [name, str(at), *(f"{x:.2f}" for x in (one.driving, one.cell, one.braking, one.cell / one.braking))]


def _shares(found: Any, both: Line, at: int) -> list[str]:
    """Return how a command falls apart, in percent of it, if both actuators lose the same."""
    one = found[found.command == at][0]
    driving, braking, cell = (100.0 / at * x for x in (one.driving, one.braking, one.cell))
    idle = 0.5 * 100.0 / at * both.offset
    loaded = 0.5 * (driving - braking) - idle
    unread = driving - loaded - idle - cell
    figures = (cell, 100.0 - cell, loaded, idle, 100.0 - driving, unread)
    return [str(at), *(f"{x:.0f}" for x in figures), f"{braking - cell:.0f}, {driving - cell:.0f}"]


def _predictions(found: dict[str, Any], both: Line) -> Iterator[list[str]]:
    small, half = found[SMALL], pair(found[SMALL], PROPORTIONAL[::2])
    even = small[np.isin(small.command, PROPORTIONAL[1::2])]
    error = np.sqrt(np.mean((half.slope * even.driving - half.offset - even.braking) ** 2))
    yield ["7.2:1, even torques to 13 N m by odd ones: error, N m", "0", f"{error:.2f}"]
    ends = (both.slope, both.slope + both.slope_pm, both.slope - both.slope_pm)
    friction, low, high = (float(brentq(lambda x, y=y: own(SMALL, x) ** 2 - y, 0.0, 2.0)) for y in ends)
    yield ["7.2:1, friction coefficient", "0.1 steel, 0.3 plastic", f"{friction:.2f}, {low:.2f} to {high:.2f}"]
    other, same = own(SMALL, friction), own(COMPOUND, friction)
    loss = " to ".join(f"{100.0 * (1.0 - same * x):.1f}" for x in (other, same))
    for session, commands in SESSIONS.items():
        of = pair(found[COMPOUND], commands)
        measured = f"{100.0 * (1.0 - of.slope):.1f} ± {100.0 * of.slope_pm:.1f}"
        yield [f"14:1, session {session}, with that coefficient: loss of both under load, %", loss, measured]
    sessions = {SMALL: ("", both), COMPOUND: (", session A", pair(found[COMPOUND], SESSIONS["A"]))}
    for name, (text, of) in sessions.items():
        least = f"{2.0 * no_load(name)[0]:.2f}"
        yield [f"{name}{text}, friction of both without load, N m", least, f"{of.offset:.2f} ± {of.offset_pm:.2f}"]
    drift, pm = fitted(np.ones((len(small), 1)), small.drift)
    viscous = 2.0 * no_load(SMALL)[1]
    yield ["7.2:1, viscous friction of both, N m s/rad", f"{viscous:.3f}", f"{drift[0]:.3f} ± {pm[0]:.3f}"]


def _electrical(name: str, found: Any) -> list[str]:
    motor, (values, pms) = load_motor(MOTORS[name]), held(name, found)
    slope = line(found.command, found.driving)
    cells = ((slope.slope, slope.slope_pm, 2), (values[0], pms[0], 2), (values[1], pms[1], 3))
    shown = [f"{value:.{digits}f} ± {pm:.{digits}f}" for value, pm, digits in cells]
    return [name, *shown, f"{motor.terminal_resistance_ohm:.3f}"]


def _machined() -> Iterator[list[str]]:
    shipped = map_for("VT8020")
    for ratio in (4.0, 5.0, 6.0, 7.0, 8.0):
        actuator = shipped.entries[shipped.interval_index(ratio)].actuator
        assert actuator is not None, ratio
        loss = 100.0 * (1.0 - service_sheet(actuator, shipped.settings).losses.efficiency_total)
        yield [f"{actuator.ratio:.2f}", *(f"{x:.1f}" for x in (loss, 100.0 * COULOMB, loss + 100.0 * COULOMB))]


if __name__ == "__main__":
    main()

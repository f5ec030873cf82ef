"""The main figures for papers: SVG and PNG in a plain style that stays readable in black and white."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pareto_monoped.actuator.layout import FAMILIES
from pareto_monoped.actuator.ratiomap import ActuatorMap
from pareto_monoped.design import BASE_START_HEIGHT_M, GRAVITY_M_PER_S2
from pareto_monoped.errors import OutputError, complaint
from pareto_monoped.files import replacing
from pareto_monoped.measures import measure
from pareto_monoped.pareto.objectives import HEIGHT_AND_ENERGY
from pareto_monoped.report.goals import ENERGIES
from pareto_monoped.report.quantities import QUANTITIES
from pareto_monoped.report.schema import Column, Jump, Payload, StudyCard

# Okabe and Ito's colours, each with a marker of its own, so that studies can be told apart without colour.
_STYLES = (("#0072b2", "o"), ("#d55e00", "s"), ("#009e73", "D"), ("#b0548a", "^"), ("#b87d00", "v"), ("#2f9bd8", "p"))
_WIDTH_IN, _HEIGHT_IN = 3.5, 2.6  # one column of an IEEE paper is 3.5 in wide
_DPI = 300
_FORMATS = ("svg", "png")
Mark = tuple[float, float, str]
"""Where a design stands, to the right and upward, in the units shown, and its name."""
Axes2 = tuple[str, str]
"""The measures to the right and upward."""
_FIXED = {"svg": {"Date": None}, "png": {"Software": None}, "pdf": {"CreationDate": None}}
"""File information that would change from one run to the next, left out."""


def write_figures(payload: Payload, folder: Path) -> list[Path]:
    """Write every figure that the payload has data for.

    Returns:
        The files.

    Raises:
        OutputError: the folder cannot be made or written to.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise OutputError(f"folder {str(folder)!r}: cannot be made ({error.strerror}); give another") from error
    makers: dict[str, Callable[[Payload, Any], bool]] = {
        "front": _front,
        "convergence": _convergence,
        "along_the_front": _along,
        "mass_over_ratio": _map,
        "link_mass": _links,
        "states_over_time": _states,
    }
    written = []
    with _style() as figure_class:
        for name, make in makers.items():
            figure = figure_class(figsize=(_WIDTH_IN, _HEIGHT_IN), layout="constrained")
            if not make(payload, figure):
                continue
            for kind in _FORMATS:
                path = folder / f"{name}.{kind}"
                with replacing(path) as temporary:
                    figure.savefig(temporary, format=kind, dpi=_DPI, metadata=_FIXED[kind])
                written.append(path)
    return written


@contextmanager
def _style() -> Iterator[Any]:
    """Matplotlib's figure class, with the style for print in force until the end of the context."""
    import matplotlib
    from matplotlib.figure import Figure

    settings = {
        "font.size": 8.0,
        "axes.linewidth": 0.6,
        "axes.grid": True,
        "grid.linewidth": 0.4,
        "grid.color": "#dddddd",
        "lines.linewidth": 1.1,
        "legend.frameon": False,
        "legend.fontsize": 7.0,
        "svg.hashsalt": "pareto_monoped",
        "svg.fonttype": "none",
    }
    with matplotlib.rc_context(settings):
        yield Figure


def _values(column: Column, rows: Sequence[int] | None = None) -> NDArray[np.float64]:
    chosen = column if rows is None else [column[row] for row in rows]
    return np.array([np.nan if value is None else value for value in chosen], dtype=np.float64)


def _places(card: StudyCard, rows: Sequence[int], across_up: Axes2) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Where trials stand, to the right and upward, in the units shown."""
    across, up = (_values(card.trials.columns[name], rows) * measure(name).scale for name in across_up)
    return across, up


def _front(payload: Payload, figure: Any) -> bool:
    """The first objective upward over the second; a third is the colour of the designs on the front."""
    axes = figure.add_subplot()
    up, across, *third = payload.objectives
    places = (across, up)
    papers_own = (up, across) == HEIGHT_AND_ENERGY.names
    published = [(c["energy_j"], c["height_m"], c["name"]) for c in payload.published] if papers_own else []
    for i, card in enumerate(payload.studies):
        _cloud_and_front(axes, card, i, places, third)
        if i == 0:
            _diamonds(axes, _simulated(card, places), "black", "paper, simulated here")
    _diamonds(axes, published, "white", "paper, published")
    marks = [*published]
    marks += [mark for card in payload.studies for mark in (*_simulated(card, places), *_designs(card, places))]
    _limits(axes, payload, marks, places)
    axes.set(xlabel=_axis_title(across), ylabel=_axis_title(up))
    if third and axes.collections:
        figure.colorbar(axes.collections[-1], ax=axes, label=_axis_title(third[0]))
    axes.legend(loc="best" if third else "lower right")
    return True


def _limits(axes: Any, payload: Payload, marks: Sequence[Mark], places: Axes2) -> None:
    """Limits of both axes that show every mark; with height over energy they begin at the start, and show the floor."""
    right, high = max((mark[0] for mark in marks), default=1.0), max((mark[1] for mark in marks), default=1.0)
    if places[1] == "height_m" and places[0] in ENERGIES:
        _floor(axes, payload, 1.1 * right)
        axes.set(xlim=(0.0, 1.06 * right), ylim=(BASE_START_HEIGHT_M, high + 0.06))
        return
    for found, setter in (
        ([mark[0] for mark in marks], axes.set_xlim),
        ([mark[1] for mark in marks], axes.set_ylim),
    ):
        if not found:
            continue
        room = 0.06 * (max(found) - min(found)) or 0.1
        setter(min(found) - room, max(found) + room)


def _axis_title(name: str) -> str:
    entry = measure(name)
    return f"{entry.label} ({entry.shown_unit})"


def _designs(card: StudyCard, places: Axes2) -> list[Mark]:
    """The designs on the front, unnamed."""
    across, up = _places(card, card.front, places)
    return [(x, y, "") for x, y in zip(across.tolist(), up.tolist(), strict=True) if np.isfinite(x + y)]


def _simulated(card: StudyCard, places: Axes2) -> list[Mark]:
    """The paper's designs as simulated for a study, without those that do not jump."""
    marks = []
    for case in card.cases:
        known = {**case.measures, "height_m": case.height_m, "energy_j": case.energy_j}
        across, up = (known.get(name) for name in places)
        if across is not None and up is not None:
            marks.append((across * measure(places[0]).scale, up * measure(places[1]).scale, case.name))
    return marks


def _cloud_and_front(axes: Any, card: StudyCard, number: int, places: Axes2, third: Sequence[str]) -> None:
    """A study's dominated designs as faint dots, and its front as a line of steps, or as dots if that is no line."""
    tint, symbol = _STYLES[number % len(_STYLES)]
    on_front = set(card.front)
    others = [row for row, letter in enumerate(card.trials.state) if letter == "f" and row not in on_front]
    cloud = axes.scatter(*_places(card, others, places), s=1.5, color=tint if number else "#bbbbbb", alpha=0.35, lw=0)
    cloud.set_rasterized(True)
    across, up = _places(card, card.front, places)
    if third:
        values = _values(card.trials.columns[third[0]], card.front) * measure(third[0]).scale
        axes.scatter(across, up, c=values, s=7, marker=symbol, cmap="viridis", label=card.label, lw=0)
    elif set(card.objectives) == set(places):
        # With less upward the better end is below: a design then holds until the next one is reached.
        steps = "steps-post" if measure(places[1]).direction == "maximise" else "steps-pre"
        axes.plot(across, up, drawstyle=steps, marker=symbol, ms=2.5, color=tint, label=card.label, lw=0.8)
    else:
        axes.plot(across, up, symbol, ms=2.5, color=tint, label=card.label)


def _diamonds(axes: Any, marks: Sequence[Mark], fill: str, label: str) -> None:
    """Designs of the paper, with their names on sides where they do not cover each other."""
    if not marks:
        return
    energy, height, _ = zip(*marks, strict=True)
    axes.plot(energy, height, "D", mfc=fill, mec="black", ms=4, label=label)
    offsets = {"A": (3, -8), "C": (-9, 1)}
    for x, y, name in marks:
        axes.annotate(name, (x, y), xytext=offsets.get(name, (4, -3)), textcoords="offset points", fontsize=6)


def _floor(axes: Any, payload: Payload, energy_j: float) -> None:
    """The height to which an energy raises the lightest robot, from 0 to ``energy_j``."""
    masses = [card.floor_mass_kg for card in payload.studies if card.floor_mass_kg is not None]
    if not masses:
        return
    ends = np.array([0.0, energy_j])
    heights = BASE_START_HEIGHT_M + ends / (min(masses) * GRAVITY_M_PER_S2)
    axes.plot(ends, heights, ":", color="black", lw=0.8, label=f"m g (H - {BASE_START_HEIGHT_M:g} m)")


def _convergence(payload: Payload, figure: Any) -> bool:
    axes = figure.add_subplot()
    # Hypervolumes under different objectives have different units: each then is a share of its last value.
    alike = all(tuple(card.objectives) == tuple(payload.objectives) for card in payload.studies)
    for i, card in enumerate(payload.studies):
        x, y = (_values(card.history[name]) for name in ("evaluations", "hypervolume"))
        if not alike and len(y):
            y = 100.0 * y / (y[-1] or 1.0)
        axes.plot(
            x,
            y,
            drawstyle="steps-post",
            color=_STYLES[i % len(_STYLES)][0],
            ls=("-", "--", ":", "-.")[i % 4],
            label=card.label,
        )
    for growth in payload.comparison.growth if payload.comparison else ():
        x = _values(growth["evaluations"])
        axes.fill_between(x, _values(growth["low"]), _values(growth["high"]), color="#999999", alpha=0.3, lw=0)
        axes.plot(x, _values(growth["median"]), color="black", label=f"median of {len(growth['labels'])} seeds")
    unit = payload.studies[0].hypervolume_unit if alike else "% of the last"
    axes.set(xlabel="evaluations", ylabel=f"hypervolume ({unit})")
    if len(payload.studies) > 1:
        axes.legend(loc="lower right")
    return any(len(card.history["evaluations"]) for card in payload.studies)


def _along(payload: Payload, figure: Any) -> bool:
    figure.set_size_inches(2 * _WIDTH_IN, 1.4 * _HEIGHT_IN)
    names = {quantity.name: quantity for quantity in QUANTITIES}
    along = payload.objectives[0]
    for k, variable in enumerate(payload.variables):
        axes = figure.add_subplot(2, 4, k + 1)
        quantity = names[variable["name"]]
        for i, card in enumerate(payload.studies):
            columns = card.trials.columns
            tint, symbol = _STYLES[i % len(_STYLES)]
            y = _values(columns[variable["name"]], card.front) * quantity.scale
            axes.plot(_values(columns[along], card.front) * measure(along).scale, y, symbol, ms=2, color=tint, ls="")
        unit = "" if quantity.unit == ": 1" else f" ({quantity.unit})"
        axes.set_title(f"{quantity.label}{unit}", fontsize=7)
        axes.tick_params(labelsize=6)
        axes.set_xlabel(_axis_title(along), fontsize=7)
    return any(card.front for card in payload.studies)


def _map(payload: Payload, figure: Any) -> bool:
    axes = figure.add_subplot()
    for k, table in enumerate(payload.maps):
        for family in _FAMILY_STYLES:
            points = [p for p in table.points if family in p.family_mass_kg]
            x, y = [p.ratio_low for p in points], [p.family_mass_kg[family] for p in points]
            _family_points(axes, family, x, y, "" if len(payload.maps) == 1 else table.motor, hollow=k > 0)
    _map_axes(axes)
    return bool(payload.maps)


_FAMILY_STYLES = {"ISSPG": _STYLES[1], "ESSPG": _STYLES[0]}


def _family_points(axes: Any, family: str, x: ArrayLike, y: ArrayLike, of: str, *, hollow: bool) -> None:
    """Masses of one family over the ratio; ``of`` tells several maps apart."""
    tint, symbol = _FAMILY_STYLES[family]
    fill = "white" if hollow else tint
    axes.plot(x, y, symbol, ms=2.5, ls="", color=tint, mfc=fill, label=f"{family}, {of}" if of else family)


def _map_axes(axes: Any) -> None:
    axes.set(xlabel="gear ratio", ylabel="actuator mass (kg)")
    axes.legend(loc="upper left")


def write_map_figure(maps: Mapping[str, ActuatorMap], path: Path) -> None:
    """Draw the least mass of both families over the ratio.

    Args:
        maps: by what tells them apart in the legend, such as the rules; the first is drawn filled, the others hollow.
        path: ends in .svg, .png or .pdf.

    Raises:
        OutputError: another ending, or the file cannot be written.
    """
    kind = path.suffix.removeprefix(".").lower()
    if kind not in _FIXED:
        raise OutputError(complaint("figure", str(path), f"a file in {', '.join(_FIXED)}", "give another ending"))
    with _style() as figure_class:
        figure = figure_class(figsize=(_WIDTH_IN, _HEIGHT_IN), layout="constrained")
        axes = figure.add_subplot()
        for number, (name, actuator_map) in enumerate(maps.items()):
            for family in FAMILIES:
                masses = actuator_map.masses_kg(family)
                found = np.isfinite(masses)
                if found.any():
                    points = actuator_map.ratios_low[found], masses[found]
                    _family_points(axes, family, *points, name, hollow=number > 0)
        _map_axes(axes)
        axes.set_title(" and ".join(dict.fromkeys(m.motor.name for m in maps.values())), fontsize=8)
        with replacing(path) as temporary:
            figure.savefig(temporary, format=kind, dpi=_DPI, metadata=_FIXED[kind])


def _links(payload: Payload, figure: Any) -> bool:
    axes = figure.add_subplot()
    for k, table in enumerate(payload.maps):
        leg, motor = table.leg, f", {table.motor}" if len(payload.maps) > 1 else ""
        length = 1000.0 * _values(leg.length_m)
        more = {"marker": _STYLES[k % len(_STYLES)][1], "ms": 2.5, "markevery": 10} if k else {}
        axes.plot(length, _values(leg.thigh_kg), color=_STYLES[1][0], label=f"thigh{motor}", **more)
        axes.plot(length, _values(leg.shank_kg), "--", color=_STYLES[0][0], label=f"shank{motor}", **more)
    axes.set(xlabel="link length (mm)", ylabel="mass (kg)", ylim=(0.0, None))
    axes.legend(loc="lower right")
    return True


def _states(payload: Payload, figure: Any) -> bool:
    """States and inputs over time, like a figure of the paper, for the first picked design whose jump is kept."""
    jump, title = _knee_jump(payload)
    if jump is None:
        return False
    figure.set_size_inches(_WIDTH_IN, 1.7 * _HEIGHT_IN)
    data = {name: np.array(values) * jump.scale[name] for name, values in jump.columns.items()}
    rows = (
        ("torque (N m)", (("hip_motor_torque_n_m", "hip"), ("knee_motor_torque_n_m", "knee"))),
        ("speed (rad/s)", (("hip_rad_per_s", "hip"), ("knee_rad_per_s", "knee"))),
        ("height (m)", (("base_z_m", "base"), ("foot_z_m", "foot"))),
    )
    for k, (label, series) in enumerate(rows):
        axes = figure.add_subplot(3, 1, k + 1)
        for (name, legend), style in zip(series, ("-", "--"), strict=True):
            axes.plot(
                data["time_s"], data[name], style, color=_STYLES[k == 2][0] if style == "-" else "black", label=legend
            )
        if jump.lift_off_s is not None:
            axes.axvline(float(jump.lift_off_s), color="#888888", lw=0.6)
        axes.set_ylabel(label)
        axes.legend(loc="best")
    axes.set_xlabel("time (s)")
    figure.suptitle(title, fontsize=8)
    return True


def _knee_jump(payload: Payload) -> tuple[Jump | None, str]:
    for card in payload.studies:
        for picked in card.picks:
            trial = card.trials.trial[picked.row]
            if str(trial) in card.jumps:
                return card.jumps[str(trial)], f"{card.label}, trial {trial} ({picked.name})"
    return None, ""

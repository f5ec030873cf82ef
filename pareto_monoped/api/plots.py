"""Figures for notebooks, by plotly or matplotlib: the front, the gearboxes of a motor, one jump."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from pareto_monoped.actuator.ratiomap import ActuatorMap
from pareto_monoped.api.given import truth_of
from pareto_monoped.api.studies import StoredStudy
from pareto_monoped.design import NAMES, VARIABLES, Floats
from pareto_monoped.errors import InputError, complaint, unknown_name
from pareto_monoped.measures import MEASURE_NAMES, is_goal, measure

if TYPE_CHECKING:
    from pandas import DataFrame

Backend = Literal["plotly", "matplotlib"]
# Okabe and Ito's colours, which the report also uses.
_COLOURS = ("#0072b2", "#d55e00", "#009e73", "#b0548a", "#b87d00", "#2f9bd8")
_PALE = 0.25


@dataclass(frozen=True, slots=True, kw_only=True)
class _Series:
    """Points with or without a line."""

    name: str
    x: Floats
    y: Floats
    colour: str
    line: bool = True
    points: bool = False
    pale: bool = False
    hover: tuple[tuple[str, Any], ...] = ()  #: label and column of what plotly shows of the point under the mouse
    shade: Floats | None = None  #: values that colour the points, instead of ``colour``


@dataclass(frozen=True, slots=True, kw_only=True)
class _Panel:
    """One pair of axes."""

    x: str
    y: str
    series: tuple[_Series, ...]
    shade: str = ""  #: what ``shade`` of the series is


def plot_front(
    studies: StoredStudy | Sequence[StoredStudy],
    *,
    x: str | None = None,
    y: str | None = None,
    color: str | None = None,
    trials: bool = True,
    backend: Backend = "plotly",
) -> Any:
    """Return the fronts of one study or several, with all feasible trials behind them.

    Under the mouse, plotly names trial, motors, variables and objectives.

    Args:
        studies: one or several, drawn over each other.
        x: stored measure to the right; by default the second objective of the first study.
        y: stored measure upward; by default its first objective. The front is that of each study's own objectives.
        color: stored measure or variable that colours the fronts; by default the third objective of the first study,
            if it has one, else each study has a colour.
        trials: whether to draw feasible trials behind the front.
        backend: ``plotly`` or ``matplotlib``.

    Returns:
        A ``plotly.graph_objects.Figure`` or a ``matplotlib.figure.Figure``.

    Raises:
        InputError: no study, an unknown measure, or an unknown backend.

    Example:
        >>> import pareto_monoped as pm
        >>> figure = pm.plot_front(pm.load_study("light.db"), backend="matplotlib")
        >>> figure.axes[0].get_xlabel(), figure.axes[0].get_ylabel()
        ('energy (J)', 'height (m)')
    """
    several = [studies] if isinstance(studies, StoredStudy) else studies
    if not isinstance(several, Sequence) or not all(isinstance(one, StoredStudy) for one in several):
        allowed = "a study as load_study returns it, or a list of these"
        raise InputError(complaint("studies", studies, allowed, "give one"))
    if not several:
        raise InputError(complaint("number of studies", 0, "at least 1", "give one"))
    names = several[0].study.objectives.names
    across, up = names[1] if x is None else x, names[0] if y is None else y
    for name in (across, up):
        if not is_goal(name) or not all(name in one.trials for one in several):
            raise InputError(unknown_name("axis", name, MEASURE_NAMES))
    shade = color if color is not None else names[2] if len(names) > 2 else None
    known = shade is None or is_goal(shade) or (isinstance(shade, str) and shade in NAMES)
    if not known or (shade is not None and not all(shade in one.trials for one in several)):
        raise InputError(unknown_name("color", shade, (*MEASURE_NAMES, *NAMES)))
    with_trials = truth_of("trials", trials)
    series: list[_Series] = []
    for k, one in enumerate(several):
        colour = _COLOURS[k % len(_COLOURS)]
        if with_trials:
            feasible = one.trials[one.trials["state"] == "feasible"]
            series.append(_points(f"{one.study.name}, trials", feasible, across, up, colour, pale=True))
        series.append(_points(f"{one.study.name}, front", one.front(), across, up, colour, shade))
    title = "" if shade is None else _title(shade)
    return _drawn([_Panel(x=_title(across), y=_title(up), series=tuple(series), shade=title)], backend)


def plot_actuators(*maps: ActuatorMap, backend: Backend = "plotly") -> Any:
    """Return the mass of the lightest actuator over the gear ratio, for one motor or several.

    Args:
        maps: see ``actuator_map``.
        backend: ``plotly`` or ``matplotlib``.

    Returns:
        A figure, see ``plot_front``.

    Raises:
        InputError: no map, or an unknown backend.

    Example:
        >>> from pareto_monoped import actuator_map, plot_actuators
        >>> figure = plot_actuators(actuator_map("VT8020"), actuator_map("U8"))
        >>> len(figure.data)
        2
    """
    for given in maps:
        if not isinstance(given, ActuatorMap):
            raise InputError(complaint("map", given, "a map as actuator_map returns it", "give one"))
    if not maps:
        raise InputError(complaint("number of maps", 0, "at least 1", "give one"))
    series = []
    for k, one in enumerate(maps):
        built = [entry.actuator for entry in one.entries if entry.actuator is not None]
        places = np.array([(actuator.ratio, actuator.mass_kg) for actuator in built])
        places = places[np.argsort(places[:, 0], kind="stable")]
        series.append(
            _Series(
                name=one.motor.name, x=places[:, 0], y=places[:, 1], colour=_COLOURS[k % len(_COLOURS)], points=True
            )
        )
    return _drawn([_Panel(x="gear ratio", y="actuator mass (kg)", series=tuple(series))], backend)


def plot_jump(trace: "DataFrame", *, backend: Backend = "plotly") -> Any:
    """Return heights, joint angles and motor torques of one jump over time.

    Args:
        trace: see ``trace``.
        backend: ``plotly`` or ``matplotlib``.

    Returns:
        A figure, see ``plot_front``.

    Raises:
        InputError: a column is missing, or an unknown backend.

    Example:
        >>> from pareto_monoped import PAPER_CASES, plot_jump, trace
        >>> figure = plot_jump(trace(PAPER_CASES["C"].design), backend="matplotlib")
        >>> len(figure.axes)
        3
    """
    rows = {
        "height (m)": (("base", "base_z_m"), ("foot", "foot_z_m")),
        "angle (rad)": (("hip", "hip_rad"), ("knee", "knee_rad")),
        "motor torque (N m)": (("hip", "hip_motor_torque_n_m"), ("knee", "knee_motor_torque_n_m")),
    }
    if not hasattr(trace, "columns"):
        raise InputError(complaint("trace", trace, "what pareto_monoped.trace returns", "give it"))
    needed = ["time_s", *(column for pair in rows.values() for _, column in pair)]
    if missing := [column for column in needed if column not in trace]:
        raise InputError(f"trace: lacks {', '.join(missing)}; give what pareto_monoped.trace returns")
    time = trace["time_s"].to_numpy(dtype=np.float64)
    panels = []
    for title, pair in rows.items():
        series = tuple(
            _Series(name=name, x=time, y=trace[column].to_numpy(dtype=np.float64), colour=colour)
            for (name, column), colour in zip(pair, _COLOURS, strict=False)
        )
        panels.append(_Panel(x="time (s)", y=title, series=series))
    return _drawn(panels, backend)


def _points(
    name: str, rows: "DataFrame", x: str, y: str, colour: str, shade: str | None = None, *, pale: bool = False
) -> _Series:
    across, up = (_shown(rows, one) for one in (x, y))
    named = [one for one in ("motor", "hip_motor", "knee_motor") if one in rows]
    objectives = [one for one in rows if is_goal(one) and one in (x, y, shade, "mass_kg")]
    hover = [("trial", rows["trial"].to_numpy()), *((one.replace("_", " "), rows[one].to_numpy()) for one in named)]
    hover += [(_title(one), np.char.mod("%.5g", _shown(rows, one))) for one in (*objectives, *NAMES) if one in rows]
    shaded = None if shade is None else _shown(rows, shade)
    return _Series(
        name=name, x=across, y=up, colour=colour, line=False, points=True, pale=pale, hover=tuple(hover), shade=shaded
    )


def _entry(name: str) -> Any:
    return VARIABLES[name] if name in NAMES else measure(name)


def _shown(rows: "DataFrame", name: str) -> Floats:
    """Return a column in the unit that is shown."""
    values: Floats = rows[name].to_numpy(dtype=np.float64) * _entry(name).scale
    return values


def _title(name: str) -> str:
    entry = _entry(name)
    words = entry.label if name in NAMES else entry.words
    return words if entry.shown_unit in ("1", ": 1") else f"{words} ({entry.shown_unit})"


def _drawn(panels: Sequence[_Panel], backend: Backend) -> Any:
    drawn_by = {"plotly": _by_plotly, "matplotlib": _by_matplotlib}
    if not isinstance(backend, str) or backend not in drawn_by:
        raise InputError(complaint("backend", backend, "'plotly' or 'matplotlib'", "correct it"))
    return drawn_by[backend](panels)


def _by_plotly(panels: Sequence[_Panel]) -> Any:
    from plotly.graph_objects import Scatter
    from plotly.subplots import make_subplots

    figure = make_subplots(rows=len(panels), cols=1, shared_xaxes=True, vertical_spacing=0.06)
    for row, panel in enumerate(panels, 1):
        for one in panel.series:
            figure.add_trace(
                Scatter(
                    x=one.x,
                    y=one.y,
                    name=one.name,
                    mode="+".join(["lines"] * one.line + ["markers"] * one.points),
                    line={"color": one.colour},
                    marker={"color": one.colour, "size": 4 if one.pale else 6} | _shading(one, panel.shade),
                    **_hovering(one),
                    opacity=_PALE if one.pale else 1.0,
                    legendgroup=one.name,
                    showlegend=row == 1,
                ),
                row=row,
                col=1,
            )
        figure.update_yaxes(title=panel.y, row=row, col=1)
    figure.update_xaxes(title=panels[-1].x, row=len(panels), col=1)
    figure.update_layout(template="plotly_white", height=420 if len(panels) == 1 else 220 * len(panels))
    return figure


def _shading(one: _Series, title: str) -> dict[str, Any]:
    """Return how plotly colours points by values; nothing where they have the colour of their study."""
    if one.shade is None:
        return {}
    bar = {"title": {"text": title, "side": "right"}, "y": 0.0, "yanchor": "bottom", "len": 0.75}
    return {"color": one.shade, "colorscale": "Viridis", "showscale": True, "colorbar": bar}


def _hovering(one: _Series) -> dict[str, Any]:
    """Return what plotly shows of a point under the mouse."""
    if not one.hover:
        return {}
    lines = [f"{label}: %{{customdata[{k}]}}" for k, (label, _) in enumerate(one.hover)]
    columns = np.empty((len(one.x), len(one.hover)), dtype=object)
    for k, (_, column) in enumerate(one.hover):
        columns[:, k] = column
    return {"customdata": columns, "hovertemplate": "<br>".join(lines)}


def _by_matplotlib(panels: Sequence[_Panel]) -> Any:
    from matplotlib.figure import Figure

    figure = Figure(figsize=(6.4, 4.4 if len(panels) == 1 else 2.2 * len(panels)), layout="constrained")
    for axes, panel in zip(figure.subplots(len(panels), squeeze=False, sharex=True)[:, 0], panels, strict=True):
        for one in panel.series:
            axes.plot(
                one.x,
                one.y,
                ls="-" if one.line else "",
                marker="o" if one.points else "",
                ms=2 if one.pale else 3.5,
                alpha=_PALE if one.pale else 1.0,
                color=one.colour,
                label=one.name,
            )
            if one.shade is not None:
                dots = axes.scatter(one.x, one.y, c=one.shade, s=14, zorder=3)
                figure.colorbar(dots, ax=axes, label=panel.shade)
        axes.set(ylabel=panel.y)
        axes.grid(color="#dddddd", lw=0.4)
        axes.legend(frameon=False)
    axes.set(xlabel=panels[-1].x)
    return figure

"""Figures for papers, as SVG and PNG in a plain style that stays readable in black and white, and of sensitivities."""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from pareto_monoped.actuator.layout import FAMILIES
from pareto_monoped.actuator.ratiomap import ActuatorMap
from pareto_monoped.errors import OutputError, complaint
from pareto_monoped.files import replacing
from pareto_monoped.measures import Measure, measure
from pareto_monoped.report.front_figure import ABOVE, JOINTS, STYLES, axis_title, front_figure, values
from pareto_monoped.report.packing import lift_off_s, unpacked
from pareto_monoped.report.quantities import QUANTITIES
from pareto_monoped.report.schema import Payload, StudyCard
from pareto_monoped.uncertainty.sensitivity import Sensitivity

_WIDTH_IN, _HEIGHT_IN = 3.5, 2.6  # one column of an IEEE paper is 3.5 in wide
_DPI = 300
_FORMATS = ("svg", "png")
_FIXED = {"svg": {"Date": None}, "png": {"Software": None}, "pdf": {"CreationDate": None}}
"""File information that would change from one run to the next, left out."""
_FAMILY_STYLES = {"ISSPG": STYLES[2], "ESSPG": STYLES[0]}
_TINTS = {**JOINTS, "base": "black", "foot": "#777777"}
_TITLES = {"variables": "variables, moved a little", "assumptions": "what is uncertain in a built robot"}
_COLOURS = ("#3b6ea8", "#b5651d")
_ROW_PX, _MARGIN_PX = 26, 150


def write_figures(payload: Payload, folder: Path, *, force: bool = False) -> list[Path]:
    """Write every figure that the payload has data for, and return the files; raise ``OutputError`` if that fails."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise OutputError(f"folder {str(folder)!r}: cannot be made ({error.strerror}); give another") from error
    makers: dict[str, Callable[[Payload, Any], bool]] = {
        "front": front_figure,
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
                written.append(folder / f"{name}.{kind}")
                _saved(figure, written[-1], kind, force)
    return written


def _saved(figure: Any, path: Path, kind: str, force: bool) -> None:
    with replacing(path, force=force) as temporary:
        figure.savefig(temporary, format=kind, dpi=_DPI, metadata=_FIXED[kind])


@contextmanager
def _style() -> Iterator[Any]:
    """Return Matplotlib's figure class, with the style for print in force until the end of the context."""
    import matplotlib
    from matplotlib.figure import Figure

    settings: dict[Any, Any] = {
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


def _convergence(payload: Payload, figure: Any) -> bool:
    axes = figure.add_subplot()
    # Hypervolumes under different objectives have different units: each then is a share of its last value.
    alike = all(tuple(card.objectives) == tuple(payload.objectives) for card in payload.studies)
    for i, card in enumerate(payload.studies):
        x, y = (values(card.history[name]) for name in ("evaluations", "hypervolume"))
        if not alike and len(y):
            y = 100.0 * y / (y[-1] or 1.0)
        tint, line = STYLES[i % len(STYLES)][0], ("-", "--", ":", "-.")[i % 4]
        axes.plot(x, y, drawstyle="steps-post", color=tint, ls=line, label=card.label)
    for growth in payload.comparison.growth if payload.comparison else ():
        x = values(growth["evaluations"])
        low, high = values(growth["low"]), values(growth["high"])
        axes.fill_between(x, low, high, color="#999999", alpha=0.3, lw=0, step="post")
        axes.plot(x, values(growth["median"]), drawstyle="steps-post", color="black", label=growth["middle"])
    unit = payload.studies[0].hypervolume_unit if alike else "% of the last"
    axes.set(xlabel="evaluations", ylabel=f"hypervolume ({unit})")
    if len(payload.studies) > 1:
        axes.legend(**ABOVE)
    return any(len(card.history["evaluations"]) for card in payload.studies)


def _along(payload: Payload, figure: Any) -> bool:
    rows = max(2, math.ceil(len(payload.variables) / 4))
    figure.set_size_inches(2 * _WIDTH_IN, 0.7 * rows * _HEIGHT_IN)
    names = {quantity.name: quantity for quantity in QUANTITIES}
    along = payload.objectives[0]
    for k, variable in enumerate(payload.variables):
        axes = figure.add_subplot(rows, 4, k + 1)
        quantity = names[variable["name"]]
        for i, card in enumerate(payload.studies):
            columns = card.trials.columns
            tint, symbol = STYLES[i % len(STYLES)]
            y = values(columns[variable["name"]], card.front) * quantity.scale
            x = values(columns[along], card.front) * measure(along).scale
            axes.plot(x, y, symbol, ms=2, color=tint, ls="", label=card.label)
        unit = "" if quantity.unit == ": 1" else f" ({quantity.unit})"
        axes.set_title(f"{quantity.label}{unit}", fontsize=7)
        axes.tick_params(labelsize=6)
        axes.set_xlabel(axis_title(along), fontsize=7)
    if payload.variables:
        handles, labels = figure.axes[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside upper center", ncols=3)
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


def _family_points(axes: Any, family: str, x: ArrayLike, y: ArrayLike, of: str, *, hollow: bool) -> None:
    """Draw masses of one family over the ratio; ``of`` tells several maps apart."""
    tint, symbol = _FAMILY_STYLES[family]
    fill = "white" if hollow else tint
    axes.plot(x, y, symbol, ms=2.5, ls="", color=tint, mfc=fill, label=f"{family}, {of}" if of else family)


def _map_axes(axes: Any) -> None:
    axes.set(xlabel="gear ratio", ylabel="actuator mass (kg)")
    axes.legend(**ABOVE)


def write_map_figure(maps: Mapping[str, ActuatorMap], path: Path, *, force: bool = False) -> None:
    """Draw the least mass of both families over the ratio.

    ``maps`` goes by what tells them apart in the legend, such as the rules: the first is drawn filled, the others
    hollow. ``path`` ends in .svg, .png or .pdf.

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
        _saved(figure, path, kind, force)


def _links(payload: Payload, figure: Any) -> bool:
    axes = figure.add_subplot()
    for k, table in enumerate(payload.maps):
        leg, motor = table.leg, f", {table.motor}" if len(payload.maps) > 1 else ""
        length = 1000.0 * values(leg.length_m)
        more = {"marker": STYLES[k % len(STYLES)][1], "ms": 2.5, "markevery": 10} if k else {}
        axes.plot(length, values(leg.thigh_kg), color=JOINTS["hip"], label=f"thigh{motor}", **more)
        axes.plot(length, values(leg.shank_kg), "--", color=JOINTS["knee"], label=f"shank{motor}", **more)
    axes.set(xlabel="link length (mm)", ylabel="mass (kg)", ylim=(0.0, None))
    axes.legend(**ABOVE)
    return True


def _states(payload: Payload, figure: Any) -> bool:
    """Draw states and inputs over time, like a figure of the paper, for the first picked design with a kept jump."""
    found = _knee_jump(payload)
    if found is None:
        return False
    card, row, title = found
    data, limits = _states_data(card, row), _torque_limits_n_m(payload, card, row)
    figure.set_size_inches(_WIDTH_IN, 1.9 * _HEIGHT_IN)
    rows = (
        ("torque (N m)", (("hip_motor_torque_n_m", "hip"), ("knee_motor_torque_n_m", "knee"))),
        ("speed (rad/s)", (("hip_rad_per_s", "hip"), ("knee_rad_per_s", "knee"))),
        ("height (m)", (("base_z_m", "base"), ("foot_z_m", "foot"))),
    )
    for k, (label, series) in enumerate(rows):
        axes = figure.add_subplot(3, 1, k + 1)
        for (name, legend), style in zip(series, ("-", "--"), strict=True):
            axes.plot(data["time_s"], data[name], style, color=_TINTS[legend], label=legend)
        for joint, limit in limits.items() if k == 0 else ():
            for sign in (1.0, -1.0):
                axes.axhline(sign * limit, color=_TINTS[joint], lw=0.7, ls=":")
        if k == 0 and limits:
            axes.plot([], [], ":", color="black", lw=0.7, label="limits of the gearboxes")
        axes.axvline(data["lift_off_s"], color="#888888", lw=0.6)
        axes.set_ylabel(label)
        axes.legend(**ABOVE)
    axes.set_xlabel("time (s); the vertical line is the lift-off")
    figure.suptitle(title, fontsize=8)
    return True


def _knee_jump(payload: Payload) -> tuple[StudyCard, int, str] | None:
    for card in payload.studies:
        for picked in card.picks:
            trial = card.trials.trial[picked.row]
            if trial in card.jumps.keys:
                return card, picked.row, f"{card.label}, trial {trial} ({picked.name})"
    return None


def _states_data(card: StudyCard, row: int) -> dict[str, Any]:
    """Return the columns of a jump with the height of the foot, and the time of lift-off."""
    trial = card.trials.trial[row]
    data: dict[str, Any] = dict(unpacked(card.jumps, trial))
    thigh, shank = (float(card.trials.columns[name][row] or 0.0) for name in ("thigh_length_m", "shank_length_m"))
    leg = thigh * np.cos(data["hip_rad"]) + shank * np.cos(data["hip_rad"] + data["knee_rad"])
    return data | {"foot_z_m": data["base_z_m"] - leg, "lift_off_s": lift_off_s(card.jumps, trial)}


def _torque_limits_n_m(payload: Payload, card: StudyCard, row: int) -> dict[str, float]:
    """Return the peak torque of the gearbox of each joint; without those that no gearbox is known of."""
    numbers = {joint: card.trials.columns[f"{joint}_gearbox"][row] for joint in ("hip", "knee")}
    return {
        joint: payload.gearboxes[int(number)].peak_torque_n_m
        for joint, number in numbers.items()
        if number is not None and number >= 0
    }


def sensitivity_figure(trial: int, found: Sequence[Sensitivity], shown: Sequence[Measure]) -> Any:
    """Return bars of total Sobol' indices with 95 percent intervals, a panel per kind of factors."""
    from plotly.graph_objects import Bar, Figure
    from plotly.subplots import make_subplots

    counts = [len(one.factors) for one in found]
    figure: Figure = make_subplots(
        rows=len(found),
        cols=1,
        row_heights=[count / sum(counts) for count in counts],
        vertical_spacing=0.12,
        subplot_titles=[f"{_TITLES[one.about]} ({one.jumps} jumps)" for one in found],
    )
    for row, sensitivity in enumerate(found, 1):
        # The greatest stands at the top, and plotly begins at the bottom.
        ranked = sensitivity.ranked(shown[0].name)[::-1]
        for entry, colour in zip(shown, _COLOURS, strict=False):
            influences = [factor.measures[entry.name] for factor in ranked]
            figure.add_trace(
                Bar(
                    orientation="h",
                    name=entry.words,
                    legendgroup=entry.name,
                    showlegend=row == 1,
                    marker_color=colour,
                    y=[f"{factor.factor.label}, {factor.factor.text}" for factor in ranked],
                    x=[100.0 * influence.total for influence in influences],
                    error_x={"type": "data", "array": [100.0 * influence.error for influence in influences]},
                    customdata=[f"{one.change * entry.scale:+.3g} {entry.shown_unit}" for one in influences],
                    hovertemplate="%{y}<br>%{x:.0f} % of the variance<br>%{customdata} from end to end<extra></extra>",
                ),
                row=row,
                col=1,
            )
        figure.update_xaxes(title_text="share of the variance in percent (total Sobol' index)", row=row, col=1)
    figure.update_layout(
        title=f"Sensitivity of trial {trial}",
        template="plotly_white",
        barmode="group",
        height=_MARGIN_PX * len(found) + _ROW_PX * sum(counts),
        margin={"l": 10, "r": 10},
    )
    figure.update_yaxes(automargin=True)
    return figure


def sensitivity_page(trial: int, found: Sequence[Sensitivity], shown: Sequence[Measure]) -> str:
    """Return the chart as HTML that needs no network."""
    return str(sensitivity_figure(trial, found, shown).to_html(include_plotlyjs=True, full_html=True))

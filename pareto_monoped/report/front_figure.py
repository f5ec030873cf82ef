"""The front for print: the objectives of the first study as axes, with the paper's designs beside the front."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.design import BASE_START_HEIGHT_M
from pareto_monoped.measures import ENERGIES, measure
from pareto_monoped.pareto.objectives import HEIGHT_AND_ENERGY
from pareto_monoped.report.schema import Column, Payload, StudyCard

# The page's colours (--c0 to --c5 of its light style), each with a marker of its own, so that studies can be told apart
# without colour.
STYLES = (("#0072b2", "o"), ("#008060", "s"), ("#a3487f", "D"), ("#59636e", "^"), ("#9a6700", "v"), ("#2f9bd8", "p"))
JOINTS = {"hip": "#a3487f", "knee": "#0072b2"}
"""The page's colours of the joints (--hip, --knee)."""
ABOVE: dict[str, Any] = {"loc": "lower left", "bbox_to_anchor": (0.0, 1.0), "ncols": 2, "borderaxespad": 0.1}
"""Where a legend covers no data: in rows above its axes."""
Mark = tuple[float, float, str]  #: Where a design stands, to the right and upward, in the units shown, and its name.
Axes2 = tuple[str, str]  #: The measures to the right and upward.


def values(column: Column, rows: Sequence[int] | None = None) -> NDArray[np.float64]:
    """Return a column, or some of its rows, with NaN where there is no value."""
    chosen = column if rows is None else [column[row] for row in rows]
    return np.array([np.nan if value is None else value for value in chosen], dtype=np.float64)


def _places(card: StudyCard, rows: Sequence[int], across_up: Axes2) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return where trials stand, to the right and upward, in the units shown."""
    across, up = (values(card.trials.columns[name], rows) * measure(name).scale for name in across_up)
    return across, up


def front_figure(payload: Payload, figure: Any) -> bool:
    """Return the first objective upward over the second; a third is the colour of the designs on the front."""
    axes = figure.add_subplot()
    up, across, *third = payload.objectives
    places = (across, up)
    papers_own = (up, across) == HEIGHT_AND_ENERGY.names
    published = [(c["energy_j"], c["height_m"], c["name"]) for c in payload.published] if papers_own else []
    for i, card in enumerate(payload.studies):
        _cloud_and_front(axes, card, i, places, third)
        _motors(axes, payload, card, places, third)
        if i == 0:
            _diamonds(axes, _simulated(card, places), "black", "paper, simulated here")
    _diamonds(axes, published, "white", "paper, published")
    marks = [*published]
    marks += [mark for card in payload.studies for mark in (*_simulated(card, places), *_designs(card, places))]
    _limits(axes, payload, marks, places)
    axes.set(xlabel=axis_title(across), ylabel=axis_title(up))
    if third and axes.collections:
        figure.colorbar(axes.collections[-1], ax=axes, label=axis_title(third[0]))
    # Over the whole width of the figure: long names of studies would not fit over the axes alone.
    figure.legend(loc="outside upper left", ncols=2, columnspacing=1.0, borderaxespad=0.1)
    return True


def _limits(axes: Any, payload: Payload, marks: Sequence[Mark], places: Axes2) -> None:
    """Set limits that show every mark; with height over energy they begin at the start, and show the floor."""
    right, high = max((mark[0] for mark in marks), default=1.0), max((mark[1] for mark in marks), default=1.0)
    if places[1] == "height_m" and places[0] in ENERGIES:
        _floor(axes, payload, 1.1 * right)
        axes.set(xlim=(0.0, 1.06 * right), ylim=(BASE_START_HEIGHT_M, high + 0.06))
        return
    sides = ([mark[0] for mark in marks], axes.set_xlim), ([mark[1] for mark in marks], axes.set_ylim)
    for found, setter in sides:
        if found:
            room = 0.06 * (max(found) - min(found)) or 0.1
            setter(min(found) - room, max(found) + room)


def axis_title(name: str) -> str:
    """Return a measure with the unit that it is shown in."""
    entry = measure(name)
    return f"{entry.label} ({entry.shown_unit})"


def _designs(card: StudyCard, places: Axes2) -> list[Mark]:
    across, up = _places(card, card.front, places)
    return [(x, y, "") for x, y in zip(across.tolist(), up.tolist(), strict=True) if np.isfinite(x + y)]


def _simulated(card: StudyCard, places: Axes2) -> list[Mark]:
    """Return the paper's designs as simulated for a study, without those that do not jump."""
    marks = []
    for case in card.cases:
        known = {**case.measures, "height_m": case.height_m, "energy_j": case.energy_j}
        across, up = (known.get(name) for name in places)
        if across is not None and up is not None:
            marks.append((across * measure(places[0]).scale, up * measure(places[1]).scale, case.name))
    return marks


def _cloud_and_front(axes: Any, card: StudyCard, number: int, places: Axes2, third: Sequence[str]) -> None:
    """Draw a study's dominated designs as faint dots, and its front as steps, or as dots if that is no line."""
    tint, symbol = STYLES[number % len(STYLES)]
    on_front = set(card.front)
    others = [row for row, letter in enumerate(card.trials.state) if letter == "f" and row not in on_front]
    cloud = axes.scatter(*_places(card, others, places), s=1.5, color=tint if number else "#bbbbbb", alpha=0.35, lw=0)
    cloud.set_rasterized(True)
    across, up = _places(card, card.front, places)
    if third:
        tints = values(card.trials.columns[third[0]], card.front) * measure(third[0]).scale
        axes.scatter(across, up, c=tints, s=7, marker=symbol, cmap="viridis", label=card.label, lw=0)
    elif set(card.objectives) == set(places):
        # With less upward the better end is below: a design then holds until the next one is reached.
        steps = "steps-post" if measure(places[1]).direction == "maximise" else "steps-pre"
        axes.plot(across, up, drawstyle=steps, marker=symbol, ms=2.5, color=tint, label=card.label, lw=0.8)
    else:
        axes.plot(across, up, symbol, ms=2.5, color=tint, label=card.label)


def _motors(axes: Any, payload: Payload, card: StudyCard, places: Axes2, third: Sequence[str]) -> None:
    """Draw the designs on the front with a colour and a mark per kit of motors, where the study has several."""
    if "motor" not in card.trials.columns:
        return
    across, up = _places(card, card.front, places)
    chosen = values(card.trials.columns["motor"], card.front)
    for k, number in enumerate(map(int, card.motor_names)):
        rows = chosen == number
        if rows.any():
            tint, symbol = STYLES[k % len(STYLES)]
            # A third objective keeps the colour; the marks then stand around its dots.
            fill = {"mfc": "none", "mew": 0.5} if third else {}
            label = payload.kits[number].motor
            axes.plot(across[rows], up[rows], symbol, ls="", ms=4.5 if third else 3, color=tint, label=label, **fill)


def _diamonds(axes: Any, marks: Sequence[Mark], fill: str, label: str) -> None:
    """Draw designs of the paper, with their names on sides where they do not cover each other."""
    if not marks:
        return
    energy, height, _ = zip(*marks, strict=True)
    axes.plot(energy, height, "D", mfc=fill, mec="black", ms=4, label=label)
    offsets = {"A": (3, -8), "C": (-9, 1)}
    for x, y, name in marks:
        axes.annotate(name, (x, y), xytext=offsets.get(name, (4, -3)), textcoords="offset points", fontsize=6)


def _floor(axes: Any, payload: Payload, energy_j: float) -> None:
    """Draw the least energy of each height over the designs of all studies, up to ``energy_j``."""
    floors = [card.floor_j for card in payload.studies if card.floor_j]
    if not floors:
        return
    least = np.min(floors, axis=0)
    shown = slice(max(int((least == 0.0).sum()) - 1, 0), int(np.searchsorted(least, energy_j)) + 1)
    heights = payload.constants.floor_heights_m[shown]
    axes.plot(least[shown], heights, ":", color="black", lw=0.8, label="physical floor")

"""The tables of a campaign's page; every text from a file or a database is escaped here."""

import math
from collections.abc import Sequence

import numpy as np

from pareto_monoped.campaign.grid import Campaign
from pareto_monoped.campaign.results import Result, levels_of, pair_of
from pareto_monoped.campaign.statistics import SEEDS, Group, Section, Spread, relative, spread_of
from pareto_monoped.measures import Measure, measure
from pareto_monoped.report.quantities import label_of
from pareto_monoped.report.tables import safe

_SINGULAR = {
    "motors": "motor",
    "hip_motors": "hip motor",
    "knee_motors": "knee motor",
    "rules": "gearbox rules",
    "cases": "case",
    "algorithms": "algorithm",
    "seeds": "seed",
    "evaluations": "number of jumps",
}
"""Axis -> what a value of it is called; others by their own name."""
_STRIP_PX, _EDGE_PX = 130.0, 6.0


def section_tables(section: Section) -> str:
    """Medians by group, by each axis where there are several, and by seed."""
    others = [axis for axis in section.axes if axis != SEEDS]
    words = " and ".join(_SINGULAR.get(axis, axis) for axis in others) or "studies"
    parts = [_table(section, section.groups, f"By {words}" if others else "All studies", spread=True)]
    if len(others) > 1:
        parts += [_table(section, section.by(axis), f"By {_SINGULAR.get(axis, axis)} alone") for axis in others]
    if SEEDS in section.axes:
        parts.append(_seeds(section))
    return "\n".join(parts)


def studies_table(campaign: Campaign, results: Sequence[Result]) -> str:
    """All studies and how far they are."""
    head = ["study", "state", "jumps", "feasible", "front", "hypervolume", "time, s"]
    rows = []
    for result in results:
        stored = result.stored
        volume = f"{stored.hypervolume:.3f} {stored.hypervolume_unit}" if stored.evaluations else ""
        share = "" if math.isnan(result.feasible) else f"{100.0 * result.feasible:.0f} %"
        jumps = f"{stored.evaluations:,} of {stored.budget:,}"
        rows.append([result.place.name, stored.state, jumps, share, str(stored.front), volume, f"{stored.seconds:.1f}"])
    return _html(head, [[safe(cell) for cell in row] for row in rows])


def failures(results: Sequence[Result]) -> str:
    """A note for the studies that failed and one for those that are not finished; they are in no median."""
    notes = [f"{one.place.name} failed: {one.stored.reason}" for one in results if one.stored.state == "failed"]
    open_ones = [one.place.name for one in results if one.stored.state in ("waiting", "running", "unfinished")]
    if open_ones:
        some = ", ".join(open_ones[:6]) + (", ..." if len(open_ones) > 6 else "")
        those = "1 study is" if len(open_ones) == 1 else f"{len(open_ones)} studies are"
        notes.append(f"{those} not finished and in no median: {some}")
    return "".join(f'<p class="note" role="note">{safe(note)}</p>' for note in notes)


def _table(section: Section, groups: Sequence[Group], title: str, *, spread: bool = False) -> str:
    """One row per group: medians, and bands where a group has several studies."""
    first, second = (measure(name) for name in pair_of(section.objectives))
    levels = levels_of(section.objectives)
    volumes = [result.stored.hypervolume for result in section.results]
    ends = (min(volumes), max(volumes))
    head = ["", "studies", f"hypervolume, {section.objectives.volume_unit}", *(["each study"] if spread else [])]
    head += [f"best {label_of(first.name)}, {first.shown_unit}", f"knee: {first.shown_unit}, {second.shown_unit}"]
    head += [f"{second.shown_unit} at {level:g} m" for level in levels]
    head += ["feasible, %", "time, s"]
    rows = []
    for group in groups:
        found = group.results
        row = [safe(group.label), str(len(found)), _cell([one.stored.hypervolume for one in found], 3)]
        row += [_strip([one.stored.hypervolume for one in found], ends)] if spread else []
        row += [_measured([one.most for one in found], first), _knees(found, first, second)]
        row += [_least(found, level, second) for level in levels]
        row += [_cell([100.0 * one.feasible for one in found], 0), _cell([one.stored.seconds for one in found], 1)]
        rows.append(row)
    return f"<h3>{safe(title)}</h3>{_html(head, rows)}"


def _seeds(section: Section) -> str:
    """How seeds compare: each study's hypervolume against the median of those that differ in the seed only."""
    shares = relative(section)
    rows = []
    for group in section.by(SEEDS):
        values = [100.0 * shares[one.place.name] for one in group.results]
        times = _cell([one.stored.seconds for one in group.results], 1)
        rows.append([safe(group.label.removeprefix("seed")), str(len(values)), _cell(values, 2), times])
    head = ["seed", "studies", "hypervolume, % of median", "time, s"]
    about = "Hypervolume of each study as a share of the median of the studies that differ from it in the seed only."
    return f'<h3>By seed</h3><p class="small">{about}</p>{_html(head, rows)}'


def _measured(values: Sequence[float], entry: Measure) -> str:
    return _cell([value * entry.scale for value in values], entry.decimals)


def _least(results: Sequence[Result], level: float, entry: Measure) -> str:
    sign = 1.0 if entry.direction != "maximise" else -1.0
    values = [sign * float(result.least(np.array([level]))[0]) for result in results]
    found = spread_of(values)
    ends = [sign * entry.scale * value for value in (found.middle, found.low, found.high)]
    return _told(Spread(middle=ends[0], low=ends[1], high=ends[2]), entry.decimals, len(values))


def _knees(results: Sequence[Result], first: Measure, second: Measure) -> str:
    names = results[0].objectives.names
    middles = []
    for entry in (first, second):
        values = [float(result.knee[names.index(entry.name)]) * entry.scale for result in results]
        middles.append(f"{spread_of(values).middle:.{entry.decimals}f}")
    return ", ".join(middles)


def _cell(values: Sequence[float], decimals: int) -> str:
    return _told(spread_of(values), decimals, len(values))


def _told(found: Spread, decimals: int, count: int) -> str:
    """A median, and under it the band if there are several values."""

    def text(value: float) -> str:
        return f"{value:.{decimals}f}" if math.isfinite(value) else "not reached"

    if count == 1:
        return text(found.middle)
    return f"{text(found.middle)}<small>{text(found.low)} to {text(found.high)}</small>"


def _strip(values: Sequence[float], ends: tuple[float, float]) -> str:
    """One dot per study on a scale from the least to the greatest hypervolume of the section."""
    low, high = ends

    def x(value: float) -> float:
        return _EDGE_PX + (value - low) / (high - low or 1.0) * (_STRIP_PX - 2.0 * _EDGE_PX)

    dots = "".join(f'<circle cx="{x(value):.1f}" cy="9" r="4.5"/>' for value in values)
    words = f"hypervolumes {', '.join(f'{value:.3f}' for value in sorted(values))}"
    frame = f'<line x1="{_EDGE_PX:g}" x2="{_STRIP_PX - _EDGE_PX:g}" y1="9" y2="9"/>'
    return (
        f'<svg class="strip" viewBox="0 0 {_STRIP_PX:g} 18" width="{_STRIP_PX:g}" height="18" role="img" '
        f'aria-label="{words}">{frame}{dots}</svg>'
    )


def _html(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """A table that scrolls sideways on a narrow page; its cells are HTML already."""
    top = "".join(f'<th scope="col"{"" if k == 0 else " class=n"}>{safe(name)}</th>' for k, name in enumerate(head))
    body = "".join(
        f'<tr><th scope="row">{row[0]}</th>' + "".join(f'<td class="n">{cell}</td>' for cell in row[1:]) + "</tr>"
        for row in rows
    )
    return (
        f'<div class="scroll" tabindex="0" role="region" aria-label="Table, which scrolls"><table class="campaign">'
        f"<thead><tr>{top}</tr></thead><tbody>{body}</tbody></table></div>"
    )

"""The report of a campaign: one self-contained page, in which every text from a file or a database is escaped."""

import json
import math
from collections.abc import Callable, Mapping, Sequence
from importlib import resources
from pathlib import Path
from string import Template
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pareto_monoped import __version__
from pareto_monoped.campaign.folder import Place
from pareto_monoped.campaign.grid import Campaign
from pareto_monoped.campaign.results import (
    SEEDS,
    Group,
    Result,
    Section,
    Spread,
    attainment,
    csv_text,
    growth,
    levels_of,
    levels_of_section,
    pair_of,
    relative,
    results_of,
    sections_of,
    spread_of,
)
from pareto_monoped.files import write_text
from pareto_monoped.measures import Measure, measure
from pareto_monoped.report.page import asset, closed, deflated, in_ascii, plotly, policy
from pareto_monoped.report.quantities import label_of, quantities_of
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
}  #: Axis -> what a value of it is called; others by their own name.
_STRIP_PX, _EDGE_PX = 130.0, 6.0
SCRIPTS = ("dom", "scales", "marks", "plots", "chart")  #: Scripts from the report of a study, before the page's own.
MOST_CURVES = 8  #: Groups that the charts show at first: more overlapping bands cannot be told apart.


def section_tables(section: Section) -> str:
    """Return medians by group, by each axis where there are several, and by seed."""
    others = [axis for axis in section.axes if axis != SEEDS]
    words = " and ".join(_SINGULAR.get(axis, axis) for axis in others) or "studies"
    parts = [_table(section, section.groups, f"By {words}" if others else "All studies", spread=True)]
    if len(others) > 1:
        parts += [_table(section, section.by(axis), f"By {_SINGULAR.get(axis, axis)} alone") for axis in others]
    if SEEDS in section.axes:
        parts.append(_seeds(section))
    return "\n".join(parts)


def studies_table(campaign: Campaign, results: Sequence[Result]) -> str:
    """Return all studies and how far they are."""
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
    """Return a note per failed study and one for those that are not finished; they are in no median."""
    notes = [f"{one.place.name} failed: {one.stored.reason}" for one in results if one.stored.state == "failed"]
    open_ones = [one.place.name for one in results if one.stored.state in ("waiting", "running", "unfinished")]
    if open_ones:
        some = ", ".join(open_ones[:6]) + (", ..." if len(open_ones) > 6 else "")
        those = "1 study is" if len(open_ones) == 1 else f"{len(open_ones)} studies are"
        notes.append(f"{those} not finished and in no median: {some}")
    return "".join(f'<p class="note" role="note">{safe(note)}</p>' for note in notes)


def _table(section: Section, groups: Sequence[Group], title: str, *, spread: bool = False) -> str:
    """Return one row per group: medians, and bands where a group has several studies."""
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
    """Return how seeds compare: each study's hypervolume against the median of those that differ in the seed only."""
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
    """Return a median, and under it the band if there are several values."""

    def text(value: float) -> str:
        return f"{value:.{decimals}f}" if math.isfinite(value) else "not reached"

    if count == 1:
        return text(found.middle)
    return f"{text(found.middle)}<small>{text(found.low)} to {text(found.high)}</small>"


def _strip(values: Sequence[float], ends: tuple[float, float]) -> str:
    """Return one dot per study on a scale from the least to the greatest hypervolume of the section."""
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
    """Return a table that scrolls sideways on a narrow page; its cells are HTML already."""
    top = "".join(f'<th scope="col"{"" if k == 0 else " class=n"}>{safe(name)}</th>' for k, name in enumerate(head))
    body = "".join(
        f'<tr><th scope="row">{row[0]}</th>' + "".join(f'<td class="n">{cell}</td>' for cell in row[1:]) + "</tr>"
        for row in rows
    )
    return (
        f'<div class="scroll" tabindex="0" role="region" aria-label="Table, which scrolls"><table class="campaign">'
        f"<thead><tr>{top}</tr></thead><tbody>{body}</tbody></table></div>"
    )


def write_results(
    campaign: Campaign,
    places: Sequence[Place],
    failed: Mapping[str, str],
    *,
    page: Path | None,
    table: Path | None,
    force: bool,
    wrote: Callable[[Path], object] = lambda _: None,
) -> None:
    """Write a page and a table that compare the studies of a campaign, those that are asked for.

    ``failed`` has the reasons of studies that failed, by their names; ``wrote`` is called after each file.
    """
    if page is None and table is None:
        return
    results = results_of(places, failed)
    if table is not None:
        write_text(table, csv_text(campaign, results), force=force)
        wrote(table)
    if page is not None:
        write_text(page, campaign_page(campaign, results), force=force)
        wrote(page)


def campaign_page(campaign: Campaign, results: Sequence[Result]) -> str:
    """Return the whole HTML text."""
    sections = sections_of(results, campaign.axes)
    script = closed(*(asset(f"{name}.js") for name in SCRIPTS), _own("campaign.js"))
    text = Template(_own("campaign.html")).substitute(
        policy=policy(plotly(), script),
        title=safe(campaign.name),
        style=asset("style.css") + asset("print.css") + _own("campaign.css"),
        description=f'<p class="small">{safe(campaign.description)}</p>' if campaign.description else "",
        summary=safe(_summary(results, sections)),
        notes=failures(results),
        links="".join(f'<a href="#section-{k}">{safe(_title(one))}</a>' for k, one in enumerate(sections)),
        sections="\n".join(_section(section, k, len(sections)) for k, section in enumerate(sections)),
        studies=studies_table(campaign, results),
        version=safe(__version__),
        payload=deflated(_payload(sections)),
        plotly=plotly(),
        script=script,
    )
    return in_ascii(text)


def _own(name: str) -> str:
    return (resources.files("pareto_monoped.campaign") / "assets" / name).read_text(encoding="utf-8")


def _summary(results: Sequence[Result], sections: Sequence[Section]) -> str:
    finished = sum(result.finished for result in results)
    jumps = sum(result.stored.evaluations for result in results)
    seconds = sum(result.stored.seconds for result in results)
    if seconds < 120.0:
        time = f"{seconds:.0f} seconds"
    else:
        time = f"{seconds / 60.0:.0f} minutes" if seconds < 7200.0 else f"{seconds / 3600.0:.1f} hours"
    words = f"{finished} of {len(results)} studies are finished: {jumps:,} jumps in {time} of running time."
    if len(sections) > 1:
        words += (
            " Studies with other objectives or another calibration cannot be compared; they have sections of their own."
        )
    return words


def _title(section: Section) -> str:
    labels = [label_of(name) for name in section.objectives.names]
    text = f"{', '.join(labels[:-1])} and {labels[-1]}"
    return f"{text[0].upper()}{text[1:]}, {section.calibration}"


def _section(section: Section, k: int, count: int) -> str:
    first, second = (label_of(name) for name in pair_of(section.objectives))
    extreme = "Most" if section.objectives.directions[pair_of(section.objectives)[1]] == "maximise" else "Least"
    seeds = max(len(group.results) for group in section.groups)
    bands = (
        "Lines are medians over the studies of a group, bands go from what the best tenth of them reaches to what nine "
        "tenths reach; of fewer than ten studies, from the best to the worst."
        if seeds > 1
        else "One study each: there are no bands."
    )
    if any(len(group.results) % 2 == 0 for group in section.groups):
        bands += " A median is always the value of one study: of an even number, one of the middle two."
    if len(section.groups) > MOST_CURVES:
        bands += f" The charts begin with the {MOST_CURVES} groups of most hypervolume; the switches show others."
    return f"""<section id="section-{k}" class="card" aria-labelledby="title-{k}">
<h2 id="title-{k}">{safe(_title(section))}</h2>
<p class="small">{bands}</p>
<div id="switches-{k}" class="switches" role="group" aria-label="Groups shown in the charts"></div>
<div class="pair"><figure><h3>{extreme} {safe(second)} over {safe(first)}</h3>
<div id="attainment-{k}" class="chart tall"></div></figure>
<figure><h3>Hypervolume over jumps</h3><div id="growth-{k}" class="chart tall"></div></figure></div>
{section_tables(section)}
</section>"""


def _payload(sections: Sequence[Section]) -> dict[str, Any]:
    names = [name for section in sections for name in section.objectives.names]
    return {
        "constants": {},
        "objectives": list(pair_of(sections[0].objectives)) if sections else [],
        "quantities": [
            {name: getattr(entry, name) for name in entry.__dataclass_fields__}
            for entry in quantities_of(list(dict.fromkeys(name for name in names if "." in name)))
        ],
        "sections": [_curves(section) for section in sections],
    }


def _curves(section: Section) -> dict[str, Any]:
    levels = levels_of_section(section)
    return {
        "pair": list(pair_of(section.objectives)),
        "unit": section.objectives.volume_unit,
        "levels": _numbers(levels),
        "groups": [_group(group, levels) for group in section.groups],
        "first": _first(section.groups),
    }


def _first(groups: Sequence[Group]) -> list[int]:
    """Return positions of the groups that the charts show at first: those of most hypervolume, in their order."""
    volumes = [spread_of([result.stored.hypervolume for result in group.results]).middle for group in groups]
    return sorted(sorted(range(len(groups)), key=lambda k: -volumes[k])[:MOST_CURVES])


def _group(group: Group, levels: NDArray[np.float64]) -> dict[str, Any]:
    at, volumes = growth(group)
    sides = ("median", "low", "high")
    return {
        "label": group.label,
        "studies": len(group.results),
        "attainment": dict(zip(sides, map(_numbers, attainment(group, levels)), strict=True)),
        "evaluations": _numbers(at),
        "growth": dict(zip(sides, map(_numbers, volumes), strict=True)),
    }


def _numbers(values: NDArray[np.float64]) -> list[float | None]:
    """Return values for JSON, with five digits; None for NaN."""
    return [json.loads(f"{value:.5g}") if math.isfinite(value) else None for value in values.tolist()]

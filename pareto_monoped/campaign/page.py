"""The report of a campaign: one self-contained page in the looks of the report of a study."""

import json
import math
from collections.abc import Sequence
from importlib import resources
from string import Template
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pareto_monoped import __version__
from pareto_monoped.campaign.grid import Campaign
from pareto_monoped.campaign.results import Result, pair_of
from pareto_monoped.campaign.statistics import (
    Group,
    Section,
    attainment,
    growth,
    levels_of_section,
    sections_of,
    spread_of,
)
from pareto_monoped.campaign.tables import failures, section_tables, studies_table
from pareto_monoped.report.page import asset, embedded_json, fingerprint
from pareto_monoped.report.quantities import label_of, quantities_of
from pareto_monoped.report.tables import safe

SCRIPTS = ("dom", "scales", "marks", "plots", "chart")
"""Scripts of the report of a study that this page has, too; its own one follows."""
MOST_CURVES = 8
"""Groups that the charts show at first. Our own choice: more bands, one over the other, cannot be told apart."""


def campaign_page(campaign: Campaign, results: Sequence[Result]) -> str:
    """The whole HTML text.

    Args:
        campaign: the grid.
        results: of all its studies, see ``results_of``.
    """
    sections = sections_of(results, campaign.axes)
    own = "\n".join([*(asset(f"{name}.js") for name in SCRIPTS), _own("campaign.js")])
    script = f"(() => {{\n'use strict';\n{own}\n}})();\n"
    policy = (
        f"default-src 'none'; script-src {fingerprint(script)}; style-src 'unsafe-inline'; "
        "img-src data: blob:; base-uri 'none'; form-action 'none'"
    )
    parts = [_section(section, k, len(sections)) for k, section in enumerate(sections)]
    return Template(_own("campaign.html")).substitute(
        policy=policy,
        title=safe(campaign.name),
        style=asset("style.css") + asset("print.css") + _own("campaign.css"),
        description=f'<p class="small">{safe(campaign.description)}</p>' if campaign.description else "",
        summary=safe(_summary(results, sections)),
        notes=failures(results),
        links="".join(f'<a href="#section-{k}">{safe(_title(one))}</a>' for k, one in enumerate(sections)),
        sections="\n".join(parts),
        studies=studies_table(campaign, results),
        version=safe(__version__),
        payload=embedded_json(_payload(sections)),
        script=script,
    )


def _own(name: str) -> str:
    return (resources.files("pareto_monoped.campaign") / "assets" / name).read_text(encoding="utf-8")


def _summary(results: Sequence[Result], sections: Sequence[Section]) -> str:
    finished = sum(result.finished for result in results)
    jumps = sum(result.stored.evaluations for result in results)
    seconds = sum(result.stored.seconds for result in results)
    minutes, hours = seconds / 60.0, seconds / 3600.0
    time = (
        f"{seconds:.0f} seconds" if minutes < 2.0 else f"{minutes:.0f} minutes" if hours < 2.0 else f"{hours:.1f} hours"
    )
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
<div class="pair"><figure><h3>{safe(_extreme(section))} {safe(second)} over {safe(first)}</h3>
<div id="attainment-{k}" class="chart tall"></div></figure>
<figure><h3>Hypervolume over jumps</h3><div id="growth-{k}" class="chart tall"></div></figure></div>
{section_tables(section)}
</section>"""


def _extreme(section: Section) -> str:
    return "Most" if section.objectives.directions[pair_of(section.objectives)[1]] == "maximise" else "Least"


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
    """Positions of the groups that the charts show at first: those of most hypervolume, in their order."""
    volumes = [spread_of([result.stored.hypervolume for result in group.results]).middle for group in groups]
    best = sorted(range(len(groups)), key=lambda k: -volumes[k])[:MOST_CURVES]
    return sorted(best)


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
    """For JSON, with five digits; None for NaN."""
    return [json.loads(f"{value:.5g}") if math.isfinite(value) else None for value in values.tolist()]

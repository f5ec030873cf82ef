"""The page's text and tables, which are painted before any script runs. Every text from a study is escaped here.

The plain table of the fronts' designs is on the page without scripts and in print. Some words depend on the objectives:
what the page is about, and the questions that the front answers.
"""

from collections.abc import Mapping, Sequence
from html import escape
from math import isfinite
from typing import Any

import numpy as np

from pareto_monoped.measures import Measure, measure
from pareto_monoped.report.packing import unpacked_column
from pareto_monoped.report.quantities import LEADING, label_of
from pareto_monoped.report.schema import Comparison, Number, Payload, Quantity, StudyCard

MOST_ROWS = 60
"""Designs per study in the plain table: two printed pages. Our own choice; the interactive table has all."""


def safe(value: object) -> str:
    """Return text for HTML, inside an element or a quoted attribute."""
    return escape(str(value), quote=True)


def head(payload: Payload) -> str:
    """Return summary and key facts of each study."""
    if len(payload.studies) == 1:
        (card,) = payload.studies
        about = f'<p class="small">{safe(card.description)}</p>' if card.description else ""
        rest = f"{about}<p>{safe(' '.join(card.summary[1:]))}</p>{_facts_list(card)}"
        first = f'<summary class="summary">{safe(card.summary[0])}</summary>'
        return f'<div class="studies"><details>{first}{rest}</details></div>{_notes(card)}'
    # One line per study with the rest folded away, so that the front stays in sight.
    lines = "".join(
        f"<details><summary><b>{safe(card.label)}</b> {safe(card.summary[0])}</summary>"
        f"<p>{safe(' '.join(card.summary[1:]))}</p>{_facts_list(card)}</details>{_notes(card)}"
        for card in payload.studies
    )
    return f'<div class="studies">{lines}</div>'


def _notes(card: StudyCard) -> str:
    return "".join(f'<p class="note" role="note">{safe(note)}</p>' for note in card.notes)


def _facts_list(card: StudyCard) -> str:
    rows = "".join(f"<div><dt>{safe(name)}</dt><dd>{safe(value)}</dd></div>" for name, value in _facts(card))
    return f'<dl class="facts">{rows}</dl>'


def _facts(card: StudyCard) -> list[tuple[str, str]]:
    counts = card.counts
    done = f"{counts['total']:,}" if counts["total"] == card.budget else f"{counts['total']:,} of {card.budget:,}"
    states = f"{counts['feasible']:,} feasible, {counts['infeasible']:,} infeasible, {counts['failed']:,} failed"
    if card.reasons:
        states += f" ({', '.join(f'{name} {count:,}' for name, count in card.reasons.items())})"
    return [
        ("motor", card.motor),
        ("calibration", card.calibration),
        ("search", f"{card.algorithm}, seed {card.seed}"),
        ("evaluations", done),
        ("of these", states),
        ("run time", _duration(card.seconds)),
        ("hypervolume", f"{card.hypervolume:.3f} {card.hypervolume_unit} from {card.reference}"),
    ]


def _duration(seconds: float) -> str:
    if seconds < 120.0:
        return f"{seconds:.0f} s"
    if seconds < 7200.0:
        return f"{seconds / 60.0:.0f} min"
    return f"{seconds / 3600.0:.1f} h"


def _number(value: Number, decimals: int) -> str:
    return "-" if value is None or not isfinite(value) else f"{value:.{decimals}f}"


def html_table(columns: Sequence[str], rows: Sequence[Sequence[str]], *, caption: str = "", scroll: bool = True) -> str:
    """Return an HTML table; the first cell of each row is its heading."""
    first, *others = (safe(name) for name in columns)
    top = f'<th scope="col">{first}</th>' + "".join(f'<th scope="col" class="n">{name}</th>' for name in others)
    body = ""
    for heading, *cells in rows:
        values = "".join(f'<td class="n">{safe(cell)}</td>' for cell in cells)
        body += f'<tr><th scope="row">{safe(heading)}</th>{values}</tr>'
    words = f"<caption>{safe(caption)}</caption>" if caption else ""
    table = f"<table>{words}<thead><tr>{top}</tr></thead><tbody>{body}</tbody></table>"
    return f'<div class="scroll" tabindex="0">{table}</div>' if scroll else table


def cases_table(payload: Payload) -> str:
    """Return the paper's designs, and their heights and energies as published and as simulated here."""
    heads = (f"{v['symbol']}, {v['unit']}" if v["unit"] != "1" else v["symbol"] for v in payload.variables)
    designs = [[_case_name(c["name"]), *(f"{value:g}" for value in c["design"].values())] for c in payload.published]
    parts = [html_table(["design", *heads], designs, caption="The paper's designs (Table I)."), "<p></p>"]
    # Studies with the same motor and calibration share a column: their cases are the same.
    cards = list({(card.case_motor, card.calibration): card for card in payload.studies}.values())
    names = ["height, m", "as published"]
    literal = bool(payload.literal)
    if literal:
        names.append("calibration paper, median (5 to 95 %)")
    names += [f"simulated here: {card.case_motor}, {card.calibration}" for card in cards]
    for quantity, unit, decimals in (("height", "m", 3), ("energy", "J", 2)):
        key = f"{quantity}_{unit.lower()}"
        rows = []
        for i, case in enumerate(payload.published):
            row = [_case_name(case["name"]), f"{case[key]:.{decimals}f}"]
            if literal:
                spread = payload.literal[i]
                low, high = (spread[f"{quantity}_{p}_{unit.lower()}"] for p in ("p05", "p95"))
                row.append(f"{_number(spread[key], decimals)} ({_number(low, decimals)} to {_number(high, decimals)})")
            for card in cards:
                made = card.cases[i]
                value = getattr(made, key)
                row.append(_number(value, decimals) if value is not None else made.status)
            rows.append(row)
        parts.append(html_table([f"{quantity}, {unit}", *names[1:]], rows))
    words = (
        "The figures simulated here can be compared with the front; the published ones cannot, because the paper "
        "leaves losses and contact open."
    )
    if literal:
        words += (
            " The calibration paper follows the paper's simulation, with readings where the text leaves a choice, and "
            "was fitted to its table. It may react to the smallest changes of a design, so the table gives the median "
            "over many of them."
        )
    parts.append(f'<p class="small">{words}</p>')
    return "\n".join(parts)


def _case_name(name: str) -> str:
    return name if name == "nominal" else f"Case {name}"


def left_out(payload: Payload) -> str:
    """Return how many trials the page lacks."""
    left = sum(card.trials.total - len(card.trials.trial) for card in payload.studies)
    words = f"{left} dominated trials are left out of this page to keep it small; every count includes them."
    return words if left else ""


def published_link(payload: Payload) -> str:
    """Return the mass of the published link over its length in mm."""
    line = payload.constants
    return f"{line.published_link_kg:g} kg + {line.published_link_kg_per_m:g} g/mm"


def comparison_tables(payload: Payload) -> str:
    """Return several studies side by side; an empty text for a single one."""
    comparison = payload.comparison
    if comparison is None:
        return ""
    columns = ["study", "motor", "calibration", "search", "seed", "evaluations", "front"]
    other = measure(comparison.other)
    columns += [f"hypervolume, {comparison.hypervolume_unit}"]
    columns += [f"{other.unit} at {height:g} m" for height in comparison.heights_m]
    names = ("label", "motor", "calibration", "algorithm", "seed", "evaluations", "front")
    rows = []
    for row in comparison.rows:
        at_height = (_number(value, 2) for value in row["at_height"])
        rows.append([*(f"{row[name]}" for name in names), _number(row["hypervolume"], 3), *at_height])
    caption = (
        f"All hypervolumes are measured from {comparison.reference}, the first study's reference point. "
        f"{other.unit} at a height: {other.label}, the best on the front for at least that height."
    )
    chart = '<div id="attainment" class="chart"></div>' if comparison.surfaces else ""
    return f"<h3>Studies compared</h3>{html_table(columns, rows, caption=caption)}{chart}{_choices_table(comparison)}"


def _choices_table(comparison: Comparison) -> str:
    """Return what choosing by mechanical energy costs at the battery; '' if the studies are not two such fronts."""
    if not comparison.choices:
        return ""
    found = [side for row in comparison.choices for side in (row["mechanical"], row["battery"]) if side is not None]
    several = len({side["motor"] for side in found}) > 1
    names = ["mechanical, J", "battery, J", "hip", "knee", *(["motor"] if several else [])]
    sides = f'<th scope="colgroup" colspan="{len(names)}" class="n">chosen by mechanical energy</th>'
    sides += f'<th scope="colgroup" colspan="{len(names)}" class="n">chosen by battery energy</th>'
    heads = "".join(f'<th scope="col" class="n">{name}</th>' for name in names)
    top = f'<th scope="col" rowspan="2">height</th>{sides}<th scope="col" rowspan="2" class="n">costs</th>'
    body = ""
    for row in comparison.choices:
        cost = "-" if row["cost"] is None else f"{100.0 * row['cost']:+.1f} %"
        values = (*_choice(row["mechanical"], names), *_choice(row["battery"], names), cost)
        cells = "".join(f'<td class="n">{safe(value)}</td>' for value in values)
        body += f'<tr><th scope="row">{row["height_m"]:.1f} m</th>{cells}</tr>'
    caption = (
        "For each height, the designs of least energy on either front with the ratios of their gearboxes, and what "
        "choosing by mechanical energy costs at the battery."
    )
    table = f"<caption>{caption}</caption><thead><tr>{top}</tr><tr>{heads}{heads}</tr></thead><tbody>{body}</tbody>"
    return f'<h3>The two energies</h3><div class="scroll" tabindex="0" id="energies"><table>{table}</table></div>'


def _choice(chosen: Mapping[str, Any] | None, names: Sequence[str]) -> list[str]:
    if chosen is None:
        return ["-"] * len(names)
    numbers = [_number(chosen[name], 2) for name in ("energy_j", "electrical_energy_j", "hip_ratio", "knee_ratio")]
    return [*numbers, *([chosen["motor"]] if "motor" in names else [])]


def provenance_tables(payload: Payload) -> str:
    """Return versions and settings of each study, and the command that runs it again."""
    parts = []
    for card in payload.studies:
        rows = "".join(
            f'<tr><th scope="row">{safe(key)}</th><td class="wrap">{safe(value)}</td></tr>'
            for key, value in card.provenance
        )
        table = f"<table><tbody>{rows}</tbody></table>"
        parts.append(
            f"<p>{safe(card.label)} is reproduced by <code>{safe(card.reproduce)}</code> with the settings below.</p>"
            f"<details><summary>Settings, versions, hash</summary>{table}</details>"
        )
    return "\n".join(parts)


def kind(payload: Payload) -> str:
    """Return what the page is about, in one line above its title."""
    if tuple(payload.objectives) == ("height_m", "energy_j"):
        return "Pareto report: jump height against energy of a monoped"
    labels = [measure(name).label for name in payload.objectives]
    return f"Pareto report: {', '.join(labels[:-1])} and {labels[-1]} of a monoped"


def order(payload: Payload) -> str:
    """Return the order of the designs on the front, for readers who hear the page."""
    first = payload.objectives[0]
    if first == "height_m":
        return "Designs on the front, from the lowest jump to the highest"
    return f"Designs on the front, from the least {measure(first).label} to the most"


def ask_fields(payload: Payload) -> str:
    """Return the number fields of the form: the first objective wanted, and what may be spent for it."""
    there = {name for card in payload.studies for name in (*card.trials.columns, *card.trials.packed)}
    names = dict.fromkeys((*payload.objectives[:2], *(name for name in LEADING if name in there)))
    ids = ("ask-height", "ask-energy")
    return "\n".join(_field(ids[i] if i < len(ids) else f"ask-{name}", measure(name)) for i, name in enumerate(names))


def _field(name: str, entry: Measure) -> str:
    word = "at least" if entry.direction == "maximise" else "at most"
    label = f"{label_of(entry.name)} {word}"
    return (
        f'<label for="{name}">{safe(label[0].upper() + label[1:])}'
        f' <span class="field"><input id="{name}" data-ask="{entry.name}" type="number" step="any" inputmode="decimal">'
        f"<i>{safe(entry.shown_unit)}</i></span></label>"
    )


def designs_table(payload: Payload) -> str:
    """Return one table per study with a front: its designs, or some evenly along it."""
    names = dict.fromkeys((*payload.goals, *LEADING, *(str(variable["name"]) for variable in payload.variables)))
    quantities = {q.name: q for q in payload.quantities}
    parts = []
    for card in payload.studies:
        if not card.front:
            continue
        there = [name for name in names if name in card.trials.columns or name in card.trials.packed]
        columns = {name: _values(card, name) for name in there}
        rows = evenly(card.front, MOST_ROWS)
        cells = [
            [f"{card.trials.trial[k]}", *(_text(columns[name][k], quantities[name]) for name in there)] for k in rows
        ]
        heads = ["trial", *(_title(quantities[name]) for name in there)]
        whole = len(rows) == len(card.front)
        count = f"All {len(rows)} designs" if whole else f"{len(rows)} of {len(card.front)} designs"
        caption = f"{card.label}: {count} of the front{'' if whole else ', evenly along it'}."
        parts.append(html_table(heads, cells, caption=caption))
    return "\n".join(parts) or '<p class="small">There is no front yet.</p>'


def importance_tables(payload: Payload) -> str:
    """Return which variable decides which measure over all trials of each study, as tables in percent."""
    quantities = {quantity.name: quantity for quantity in payload.quantities}
    parts = []
    for card in payload.studies:
        names = list(card.importances)
        variables = list(dict.fromkeys(name for shares in card.importances.values() for name in shares))
        if not names:
            continue
        variables.sort(key=lambda name: -max(card.importances[one].get(name, 0.0) for one in names))
        cells = [
            [
                quantities[name].label if name in quantities else name.replace("_", " "),
                *(f"{100.0 * card.importances[one].get(name, 0.0):.0f} %" for one in names),
            ]
            for name in variables
        ]
        heads = ["variable", *(quantities[name].label for name in names)]
        caption = (
            f"{card.label}: which variable decides which measure over all trials, as what sets the best tenth apart "
            "(PED-ANOVA, as in Optuna's dashboard)."
        )
        parts.append(html_table(heads, cells, caption=caption))
    return "\n".join(parts)


def _title(quantity: Quantity) -> str:
    return quantity.label if quantity.unit in ("1", ": 1") else f"{quantity.label}, {quantity.unit}"


def evenly(front: Sequence[int], most: int) -> list[int]:
    """Return at most ``most`` of the rows, with both ends, evenly along their order."""
    if len(front) <= most:
        return list(front)
    return [front[i] for i in np.linspace(0, len(front) - 1, most).round().astype(int)]


def _values(card: StudyCard, name: str) -> Sequence[Number]:
    columns = card.trials.columns
    return columns[name] if name in columns else unpacked_column(card.trials.packed[name]).tolist()


def _text(value: Number, quantity: Quantity) -> str:
    if value is None or not np.isfinite(value):
        return "\N{EN DASH}"
    return f"{value * quantity.scale:.{quantity.decimals}f}"

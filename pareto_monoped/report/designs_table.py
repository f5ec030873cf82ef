"""The plain table of the fronts' designs, which is on the page without scripts and in print."""

from collections.abc import Sequence

import numpy as np

from pareto_monoped.report.goals import ASKED
from pareto_monoped.report.packing import unpacked
from pareto_monoped.report.schema import Number, Payload, Quantity, StudyCard
from pareto_monoped.report.tables import html_table

MOST_ROWS = 60
"""Designs per study in the plain table: two printed pages. Our own choice; the interactive table has all."""


def designs_table(payload: Payload) -> str:
    """One table per study with a front: its designs, or some evenly along it."""
    names = dict.fromkeys((*payload.goals, *ASKED, *(str(variable["name"]) for variable in payload.variables)))
    quantities = {q.name: q for q in payload.quantities}
    parts = []
    for card in payload.studies:
        if not card.front:
            continue
        there = [name for name in names if name in card.trials.columns or name in card.trials.packed]
        columns = {name: _values(card, name) for name in there}
        rows = evenly(card.front, MOST_ROWS)
        cells = [
            [f"{card.trials.trial[row]}", *(_text(columns[name][row], quantities[name]) for name in there)]
            for row in rows
        ]
        heads = ["trial", *(_title(quantities[name]) for name in there)]
        whole = len(rows) == len(card.front)
        count = f"All {len(rows)} designs" if whole else f"{len(rows)} of {len(card.front)} designs"
        caption = f"{card.label}: {count} of the front{'' if whole else ', evenly along it'}."
        parts.append(html_table(heads, cells, caption=caption))
    return "\n".join(parts) or '<p class="small">There is no front yet.</p>'


def _title(quantity: Quantity) -> str:
    return quantity.label if quantity.unit in ("1", ": 1") else f"{quantity.label}, {quantity.unit}"


def evenly(front: Sequence[int], most: int) -> list[int]:
    """At most ``most`` of the rows, with both ends, evenly along their order."""
    if len(front) <= most:
        return list(front)
    return [front[i] for i in np.linspace(0, len(front) - 1, most).round().astype(int)]


def _values(card: StudyCard, name: str) -> Sequence[Number]:
    columns = card.trials.columns
    return columns[name] if name in columns else unpacked(card.trials.packed[name]).tolist()


def _text(value: Number, quantity: Quantity) -> str:
    if value is None or not np.isfinite(value):
        return "\N{EN DASH}"
    return f"{value * quantity.scale:.{quantity.decimals}f}"

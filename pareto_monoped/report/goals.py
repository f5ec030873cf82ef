"""The page's words that depend on the objectives: what it is about, and the questions that the front answers."""

from pareto_monoped.measures import Measure, measure
from pareto_monoped.report.quantities import label_of
from pareto_monoped.report.schema import Payload
from pareto_monoped.report.tables import safe

ENERGIES = ("energy_j", "electrical_energy_j")
"""Measures that are never less than the work against gravity, m g (H - start height): the floor of the front chart."""


def kind(payload: Payload) -> str:
    """What the page is about, in one line above its title."""
    if tuple(payload.objectives) == ("height_m", "energy_j"):
        return "Pareto report: jump height against energy of a monoped"
    labels = [measure(name).label for name in payload.objectives]
    return f"Pareto report: {', '.join(labels[:-1])} and {labels[-1]} of a monoped"


def order(payload: Payload) -> str:
    """The order of the designs on the front, for readers who hear the page."""
    first = payload.objectives[0]
    if first == "height_m":
        return "Designs on the front, from the lowest jump to the highest"
    return f"Designs on the front, from the least {measure(first).label} to the most"


ASKED = ("energy_j", "electrical_energy_j", "mass_kg")
"""Measures that the page asks for beside the first two objectives, if a study has them."""


def ask_fields(payload: Payload) -> str:
    """The number fields of the form: the first objective wanted, and what may be spent for it."""
    there = {name for card in payload.studies for name in (*card.trials.columns, *card.trials.packed)}
    names = dict.fromkeys((*payload.objectives[:2], *(name for name in ASKED if name in there)))
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

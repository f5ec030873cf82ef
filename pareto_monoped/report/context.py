"""Where the designs stand among published jumping robots: a table and a chart, both there without scripts."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from math import log10
from typing import Annotated

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from pareto_monoped.config import Positive, Strict, checked, read_shipped
from pareto_monoped.report.front_figure import values
from pareto_monoped.report.packing import unpacked_column
from pareto_monoped.report.schema import Payload, StudyCard
from pareto_monoped.report.tables import safe

Words = Annotated[str, Field(min_length=1)]
_WIDTH, _HEIGHT, _LEFT, _RIGHT, _TOP, _BOTTOM = 460, 415, 46, 14, 12, 40  # pixels of the chart and of its margins
_MASSES_KG, _HEIGHTS_M = (0.005, 20.0), (0.02, 20.0)  # of its axes; lower rises stand at its end
Box = tuple[float, float, float, float]  #: Left, right, top and bottom of a rectangle in the chart.


@dataclass(frozen=True, slots=True, kw_only=True)
class Jumper(Strict):
    """A jumping robot or animal; what its source does not give is None."""

    name: Words  #: what it is called
    drive: Words  #: what moves it
    source: Words  #: where the values were looked up
    year: int | None = None  #: of the publication
    mass_kg: Positive | None = None  #: of all of it
    height_m: Positive | None = None  #: gained in one jump from rest; of our own, the rise of the centre of mass
    agility_m_per_s: Positive | None = None  #: vertical jumping agility, as the measure of that name


@dataclass(frozen=True, slots=True, kw_only=True)
class _Jumpers(Strict):
    robots: tuple[Jumper, ...]


@lru_cache(maxsize=1)
def published_jumpers() -> tuple[Jumper, ...]:
    """Return the jumpers of ``data/jumping_robots.toml``."""
    name = "jumping_robots.toml"
    return checked(_Jumpers, read_shipped(name, what="table of jumpers"), source=f"table of jumpers {name!r}").robots


def own_jumpers(payload: Payload) -> list[Jumper]:
    """Return the paper's Case C as simulated here, and the most agile, the knee and the highest of each front."""
    found = []
    for case in payload.studies[0].cases:
        agility, rise = (case.measures.get(name) for name in ("agility_m_per_s", "rise_m"))
        if case.name == "C" and case.mass_kg is not None and agility is not None and rise is not None:
            case_c = Jumper(
                name="the paper's Case C, simulated here",
                drive=f"one leg; {payload.studies[0].case_motor}",
                source="this report",
                mass_kg=float(case.mass_kg),
                height_m=float(rise),
                agility_m_per_s=float(agility),
            )
            found.append(case_c)
    for card in payload.studies:
        named: dict[int, list[str]] = {}
        for what, place in _places(card).items():
            named.setdefault(place, []).append(what)
        several = f"{card.label}: " if len(payload.studies) > 1 else ""
        for place, whats in named.items():
            found.append(_design(payload, card, place, several + " and ".join(whats)))
    return found


def _places(card: StudyCard) -> dict[str, int]:
    """Return the places on the front of the designs that stand for it, by what they are."""
    rows = list(card.front)
    if not rows:
        return {}
    agility = np.nan_to_num(_of_front(card, "agility_m_per_s")).tolist()
    heights = [card.trials.columns["height_m"][row] or 0.0 for row in rows]
    places = {"most agile": agility.index(max(agility))} if max(agility) > 0.0 else {}
    places |= {picked.name: rows.index(picked.row) for picked in card.picks if picked.name == "knee"}
    return places | {"highest jump": heights.index(max(heights))}


def _of_front(card: StudyCard, name: str) -> NDArray[np.float64]:
    """Return a measure of the designs on the front, in its order; NaN where it is not known."""
    rows = list(card.front)
    if name in card.trials.packed:
        return unpacked_column(card.trials.packed[name])[rows]
    return values(card.trials.columns.get(name, [None] * len(card.trials.trial)), rows)


def _design(payload: Payload, card: StudyCard, place: int, what: str) -> Jumper:
    row, columns = card.front[place], card.trials.columns
    mass = columns["mass_kg"][row]
    numbers = columns.get("motor")
    kit = payload.kits[card.kit if numbers is None else int(numbers[row] or 0)]
    agility, rise = (_of_front(card, name)[place] for name in ("agility_m_per_s", "rise_m"))
    hip, knee = columns["hip_ratio"][row], columns["knee_ratio"][row]
    return Jumper(
        name=f"{what}, trial {card.trials.trial[row]}",
        drive=f"one leg; {kit.motor}, hip {hip:.1f}:1, knee {knee:.1f}:1",
        source="this report",
        mass_kg=None if mass is None else float(mass),
        height_m=float(rise) if rise > 0.0 else None,
        agility_m_per_s=float(agility) if agility > 0.0 else None,
    )


def context_section(payload: Payload) -> str:
    """Return the chart and the table, the most agile first; those without a known agility follow by height."""
    own = own_jumpers(payload)
    everyone = [*((jumper, False) for jumper in published_jumpers()), *((jumper, True) for jumper in own)]
    everyone.sort(key=lambda entry: (-(entry[0].agility_m_per_s or 0.0), -(entry[0].height_m or 0.0)))
    most = max((jumper.agility_m_per_s or 0.0 for jumper, _ in everyone), default=1.0)
    sources = list(dict.fromkeys(jumper.source for jumper, ours in everyone if not ours))
    bar, right = ' class="agility"', ' class="n"'
    heads = [("jumper", ""), ("agility, m/s", bar), ("height gained, m", right)]
    heads += [("mass, kg", right), ("drive", ""), ("source", right)]
    head = "".join(f'<th scope="col"{style}>{safe(words)}</th>' for words, style in heads)
    body = "".join(_row(jumper, ours, most, sources) for jumper, ours in everyone)
    words = (
        "Vertical jumping agility is the height gained in a jump over the time from the start of the push to the apex "
        "(Haldane et al., Science Robotics, 2016); for the designs of this report, the height of the base. An empty "
        "cell: its source does not say, or the study is older than the measure. Robots that load a spring before the "
        "jump are not comparable in agility, because loading takes time. The height gained by a design of this report "
        "is the rise of its centre of mass from lift-off to apex, without what the leg gains by standing up; published "
        "heights are those of the centre of mass or of an obstacle."
    )
    return (
        f'<p class="small">{safe(words)}</p><div class="context-pair"><div>{_chart(own)}'
        f'<h3>Sources</h3><ol class="sources small">'
        f"{''.join(f'<li>{safe(source)}</li>' for source in sources)}</ol></div>"
        f'<div class="scroll" tabindex="0" role="region" aria-label="Jumping robots compared"><table class="context">'
        f"<thead><tr>{head}</tr></thead><tbody>{body}</tbody></table></div></div>"
    )


def _row(jumper: Jumper, ours: bool, most: float, sources: Sequence[str]) -> str:
    year = f" ({jumper.year})" if jumper.year else ""
    agility = ""
    if jumper.agility_m_per_s is not None:
        width = 100.0 * jumper.agility_m_per_s / most
        agility = f'<i style="width: {width:.0f}%"></i><b>{jumper.agility_m_per_s:.2f}</b>'
    values = ("" if value is None else f"{value:.3g}" for value in (jumper.height_m, jumper.mass_kg))
    cells = "".join(f'<td class="n">{value}</td>' for value in values)
    row = '<tr class="ours">' if ours else "<tr>"
    source = jumper.source if ours else f"[{sources.index(jumper.source) + 1}]"
    return (
        f'{row}<th scope="row">{safe(jumper.name + year)}</th><td class="agility">{agility}</td>{cells}'
        f'<td>{safe(jumper.drive)}</td><td class="n">{safe(source)}</td></tr>'
    )


def _chart(own: Sequence[Jumper]) -> str:
    """Return height gained over mass, both logarithmic, as SVG in the page's colours."""
    everyone = [*((jumper, False) for jumper in published_jumpers()), *((jumper, True) for jumper in own)]
    shown = [(jumper, ours) for jumper, ours in everyone if jumper.mass_kg and jumper.height_m]
    places = [(_x(jumper.mass_kg or 1.0), _y(jumper.height_m or 1.0)) for jumper, _ in shown]
    taken = [(x - 5.0, x + 5.0, y - 5.0, y + 5.0) for x, y in places]
    parts = [_axes()]
    for (jumper, ours), (x, y) in zip(shown, places, strict=True):
        about = f"<title>{safe(f'{jumper.name}: {jumper.mass_kg:.3g} kg, {jumper.height_m:.3g} m')}</title>"
        if ours:
            parts.append(f'<path class="ours" d="M{x:.1f} {y - 6:.1f}l6 6l-6 6l-6 -6z">{about}</path>')
            continue
        parts.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="4.5">{about}</circle>')
        box, anchor, dx, dy = _label_place(x, y, 5.8 * len(jumper.name), taken)
        taken.append(box)
        parts.append(f'<text x="{x + dx:.1f}" y="{y + dy:.1f}" text-anchor="{anchor}">{safe(jumper.name)}</text>')
    label = "Height gained over mass of published jumping robots and of this report's designs, both axes logarithmic"
    svg = f'<svg viewBox="0 0 {_WIDTH} {_HEIGHT}" role="img" aria-label="{label}">{"".join(parts)}</svg>'
    note = "Circles: published robots. Diamonds: designs of this report. Both axes are logarithmic."
    return f'<figure class="context-chart">{svg}<figcaption class="small">{note}</figcaption></figure>'


def _label_place(x: float, y: float, wide: float, taken: Sequence[Box]) -> tuple[Box, str, float, float]:
    """Return where the label of a point at (x, y) covers nothing: its rectangle, anchor, and offset from the point."""
    tries = (
        ((x + 8.0, x + 8.0 + wide, y - 6.0, y + 4.0), "start", 8.0, 4.0),
        ((x - 8.0 - wide, x - 8.0, y - 6.0, y + 4.0), "end", -8.0, 4.0),
        ((x - wide / 2, x + wide / 2, y - 19.0, y - 9.0), "middle", 0.0, -9.0),
        ((x - wide / 2, x + wide / 2, y + 7.0, y + 17.0), "middle", 0.0, 17.0),
        ((x - 6.0, x - 6.0 + wide, y - 19.0, y - 9.0), "start", -6.0, -9.0),
    )
    for place in tries:
        left, right, top, bottom = place[0]
        inside = left > _LEFT and right < _WIDTH - _RIGHT
        if inside and not any(left < t[1] and right > t[0] and top < t[3] and bottom > t[2] for t in taken):
            return place
    return tries[-1]


def _x(mass_kg: float) -> float:
    low, high = map(log10, _MASSES_KG)
    return _LEFT + (log10(mass_kg) - low) / (high - low) * (_WIDTH - _LEFT - _RIGHT)


def _y(height_m: float) -> float:
    low, high = map(log10, _HEIGHTS_M)
    return _HEIGHT - _BOTTOM - (max(log10(height_m), low) - low) / (high - low) * (_HEIGHT - _TOP - _BOTTOM)


def _axes() -> str:
    left, right, top, bottom = _LEFT, _WIDTH - _RIGHT, _TOP, _HEIGHT - _BOTTOM
    parts = [f'<rect class="frame" x="{left}" y="{top}" width="{right - left}" height="{bottom - top}"/>']
    for mass in (0.01, 0.1, 1.0, 10.0):
        x = _x(mass)
        parts.append(f'<line class="gridline" x1="{x:.1f}" x2="{x:.1f}" y1="{top}" y2="{bottom}"/>')
        parts.append(f'<text x="{x:.1f}" y="{bottom + 15}" text-anchor="middle">{mass:g}</text>')
    for height in (0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0):
        y = _y(height)
        parts.append(f'<line class="gridline" x1="{left}" x2="{right}" y1="{y:.1f}" y2="{y:.1f}"/>')
        parts.append(f'<text x="{left - 5}" y="{y + 4:.1f}" text-anchor="end">{height:g}</text>')
    middle = (top + bottom) / 2
    parts.append(f'<text x="{(left + right) / 2}" y="{_HEIGHT - 8}" text-anchor="middle">mass, kg</text>')
    turn = f"rotate(-90 13 {middle})"
    parts.append(f'<text x="13" y="{middle}" text-anchor="middle" transform="{turn}">height gained, m</text>')
    return "".join(parts)

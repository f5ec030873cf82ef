"""What parts cost, roughly: stock, hours of machines by removed volume and features, set-ups, list prices by class.

``data/cost.toml`` has every rate with its source. A made part pays for its blank (the smaller of a bar and a block
around it), for its set-ups, once per kind of part, and for its hours. More volume within one outline is less to cut
away and so costs less; a larger part, one more of it or one more feature costs more. Assembly, cables, tools, freight,
tax and the work of drawing are left out.
"""

from collections.abc import Iterable
from dataclasses import dataclass, fields
from functools import lru_cache, reduce
from operator import add
from typing import Annotated, Any

import numpy as np
from pydantic import Field

from pareto_monoped.config import NotNegative, Positive, Strict, checked, read_shipped
from pareto_monoped.geometry.extents import extent, perimeter_mm
from pareto_monoped.geometry.features import Hole
from pareto_monoped.geometry.gears import ExternalGear, InternalGear
from pareto_monoped.geometry.parts import Part
from pareto_monoped.geometry.shapes import Circle, Floats, Numbers, Pattern
from pareto_monoped.materials import MATERIALS, GearGrade

BOUGHT = "bought"  #: The process of parts that nobody makes.


@dataclass(frozen=True, slots=True, kw_only=True)
class MachiningRates(Strict):
    """Of turned and milled parts."""

    hour_eur: Positive
    program_min: NotNegative
    program_step_min: NotNegative
    setups: Annotated[int, Field(ge=1)]
    setup_min: NotNegative
    allowance_mm: NotNegative
    clamp_min: NotNegative
    step_min: NotNegative
    hole_min: NotNegative
    mouth_min: NotNegative
    fit_min: NotNegative


@dataclass(frozen=True, slots=True, kw_only=True)
class LaserRates(Strict):
    """Of parts cut from sheet."""

    hour_eur: Positive
    setup_min: NotNegative
    cut_mm2_per_min: Positive
    sheet_margin_mm: NotNegative


@dataclass(frozen=True, slots=True, kw_only=True)
class PrintingRates(Strict):
    """Of printed parts."""

    hour_eur: Positive
    setup_min: NotNegative
    cm3_per_h: Positive


@dataclass(frozen=True, slots=True, kw_only=True)
class MouldingRates(Strict):
    """Of cast parts."""

    mould_eur: NotNegative
    setup_min: NotNegative
    piece_min: NotNegative


@dataclass(frozen=True, slots=True, kw_only=True)
class GearRates(Strict):
    """Of teeth."""

    hour_eur: Positive
    setup_min: NotNegative
    tooth_min: NotNegative
    tooth_min_per_mm: NotNegative


@dataclass(frozen=True, slots=True, kw_only=True)
class HardeningRates(Strict):
    """Of hardening and grinding."""

    lot_eur: NotNegative
    eur_per_kg: NotNegative
    hour_eur: Positive
    setup_min: NotNegative
    seat_min: NotNegative


@dataclass(frozen=True, slots=True, kw_only=True)
class StockRates(Strict):
    """Of a material."""

    eur_per_kg: Positive
    removal_cm3_per_min: Positive


@dataclass(frozen=True, slots=True, kw_only=True)
class PriceClass(Strict):
    """List price of a bought part: the sum of three shares."""

    each_eur: Positive
    eur_per_mm: NotNegative = 0.0  #: of its size across, along x
    eur_per_kg: NotNegative = 0.0

    def price_eur(self, part: Part) -> Numbers:
        """Return the price of one instance."""
        price = self.each_eur + self.eur_per_kg * part.unit_mass_kg()
        return price + self.eur_per_mm * extent(part).x_mm if self.eur_per_mm else price


@dataclass(frozen=True, slots=True, kw_only=True)
class Rates(Strict):
    """All rates; ``data/cost.toml`` says what each is and where it comes from."""

    robots: Annotated[int, Field(ge=1)]
    machining: MachiningRates
    laser: LaserRates
    printing: PrintingRates
    moulding: MouldingRates
    gears: GearRates
    hardening: HardeningRates
    materials: dict[str, StockRates]
    bought: dict[str, PriceClass]

    def __post_init__(self) -> None:
        """Refuse rates that leave a part without a cost."""
        for table, key, words in (("materials", "steel", "materials"), ("bought", "other", "bought parts")):
            if key not in getattr(self, table):
                raise ValueError(f"{table}.{key} is missing, which stands for all {words} without rates; add it")

    def stock(self, part: Part) -> StockRates:
        """Return the rates of a part's material."""
        return self.materials.get(part.material.name.replace(" ", "_"), self.materials["steel"])

    def price_class(self, part: Part) -> PriceClass:
        """Return the class of a bought part: that of its role, but magnets are no boards."""
        key = "magnet" if part.material is MATERIALS.magnet else part.role.value.replace(" ", "_")
        return self.bought.get(key, self.bought["other"])


def rates_of(values: dict[str, Any], *, source: str = "cost rates") -> Rates:
    """Return rates from plain values; raise ``InputError`` for what is missing, wrong or unknown, in one line."""
    return checked(Rates, values, source=source)


RATES = rates_of(read_shipped("cost.toml", what="cost rates"))  #: The rates that ship with the package.


@dataclass(frozen=True, slots=True, kw_only=True)
class Cost:
    """What all instances of parts cost, and how many they are."""

    material_eur: Numbers = 0.0  #: stock of made parts, or price of bought ones
    hours: Numbers = 0.0  #: of machines and their set-ups
    total_eur: Numbers = 0.0  #: material, hours at their rates, and treatments
    once_eur: Numbers = 0.0  #: share of the total that does not depend on the number of pieces
    made: Numbers = 0.0  #: pieces
    bought: Numbers = 0.0  #: likewise

    def __add__(self, other: "Cost") -> "Cost":
        return Cost(**{name: getattr(self, name) + getattr(other, name) for name in _SUMS})


_SUMS = tuple(one.name for one in fields(Cost))


def part_cost(part: Part, pieces: Numbers | None = None, rates: Rates = RATES) -> Cost:
    """Return the cost of all instances of a part, or of so many; of shape (n,) where the part holds arrays."""
    if pieces is None:
        pieces = part.count * len(part.places_mm)
    if part.process == BOUGHT:
        price = part.catalogue_price_eur
        one = rates.price_class(part).price_eur(part) if price is None else price
        return Cost(material_eur=pieces * one, total_eur=pieces * one, bought=pieces)
    kind, piece = _work_of(part, rates)
    share = np.where(np.asarray(pieces) > 0.0, 1.0 / rates.robots, 0.0)[()]
    return Cost(
        material_eur=pieces * piece.material_eur,
        hours=share * kind.hours + pieces * piece.hours,
        total_eur=share * kind.total_eur + pieces * piece.total_eur,
        once_eur=share * kind.total_eur,
        made=pieces,
    )


def _work_of(part: Part, rates: Rates) -> tuple[Cost, Cost]:
    """Return what a kind of part costs once, and what each piece does; remembered for the shipped rates."""
    if rates is RATES:
        try:
            return _remembered(part, part.fits, part.grade)
        except TypeError:  # arrays have no hash
            pass
    return _WORK[part.process](part, rates)


@lru_cache(maxsize=8192)
def _remembered(part: Part, _fits: object, _grade: object) -> tuple[Cost, Cost]:
    """Return the same of a part of plain numbers; fits and grade are left out where parts are compared."""
    return _WORK[part.process](part, RATES)


def robot_cost(units: Iterable[Iterable[Part]], rates: Rates = RATES) -> Cost:
    """Return the cost of units together. Two actuators of one ratio share their part records and thus set-ups."""
    pieces: dict[int, tuple[Part, Numbers]] = {}
    for part in (part for parts in units for part in parts):
        before = pieces.get(id(part), (part, 0.0))[1]
        pieces[id(part)] = part, before + part.count * len(part.places_mm)
    costs = [part_cost(part, count, rates) for part, count in pieces.values()]
    return Cost(**{name: reduce(add, (getattr(one, name) for one in costs)) for name in _SUMS})


def _work(minutes: Numbers, hour_eur: float) -> Cost:
    hours = minutes / 60.0
    return Cost(hours=hours, total_eur=hours * hour_eur)


def _stock(volume_mm3: Numbers, part: Part, rates: Rates) -> Cost:
    price = volume_mm3 * 1e-9 * part.material.density_kg_per_m3 * rates.stock(part).eur_per_kg
    return Cost(material_eur=price, total_eur=price)


def _machined(part: Part, rates: Rates) -> tuple[Cost, Cost]:
    """Return what a kind of turned or milled part costs once, and what each piece of it does."""
    on, box = rates.machining, extent(part)
    width, height, length = (size + on.allowance_mm for size in (box.x_mm, box.y_mm, box.z_mm))
    bar = np.pi * np.square(box.radius_mm + 0.5 * on.allowance_mm) * length
    blank = np.minimum(bar, width * height * length)
    removed = np.maximum(blank - part.volume_mm3(), 0.0)
    roughing = 1e-3 * removed / rates.stock(part).removal_cm3_per_min
    steps = on.setups * on.clamp_min + on.step_min * len(part.prisms) + on.hole_min * _holes(part)
    programming = on.program_min + on.program_step_min * len(part.prisms)
    kind = _work(programming + on.setups * on.setup_min, on.hour_eur)
    piece = _stock(blank, part, rates) + _work(roughing + steps + on.mouth_min * _mouths(part), on.hour_eur)
    for once, each in (_teeth(part, rates), _fits(part, rates)):
        kind, piece = kind + once, piece + each
    return kind, piece


def _cut(part: Part, rates: Rates) -> tuple[Cost, Cost]:
    """Return the same of a part cut from sheet, whose mouths and fits are worked by hand."""
    on, hand, box = rates.laser, rates.machining, extent(part)
    sheet = (box.x_mm + on.sheet_margin_mm) * (box.y_mm + on.sheet_margin_mm) * box.z_mm
    walls: Numbers = 0.0
    for prism in part.prisms:
        around = reduce(np.add, map(perimeter_mm, (prism.outline, *prism.holes)))
        walls = walls + around * (prism.z1_mm - prism.z0_mm)
    kind, piece = _work(on.setup_min, on.hour_eur), _work(walls / on.cut_mm2_per_min, on.hour_eur)
    piece = piece + _stock(sheet, part, rates) + _work(hand.mouth_min * _mouths(part), hand.hour_eur)
    once, each = _fits(part, rates)
    return kind + once, piece + each


def _printed(part: Part, rates: Rates) -> tuple[Cost, Cost]:
    on, volume = rates.printing, part.volume_mm3()
    piece = _stock(volume, part, rates) + _work(60.0 * 1e-3 * volume / on.cm3_per_h, on.hour_eur)
    return _work(on.setup_min, rates.machining.hour_eur), piece


def _moulded(part: Part, rates: Rates) -> tuple[Cost, Cost]:
    on, hour_eur = rates.moulding, rates.machining.hour_eur
    piece = _stock(part.volume_mm3(), part, rates) + _work(on.piece_min, hour_eur)
    return _work(on.setup_min, hour_eur) + Cost(total_eur=on.mould_eur), piece


_WORK = {"machined": _machined, "laser cut": _cut, "3D printed": _printed, "moulded": _moulded}


def _teeth(part: Part, rates: Rates) -> tuple[Cost, Cost]:
    on, minutes = rates.gears, np.zeros(())
    shapes = [(shape, prism) for prism in part.prisms for shape in (prism.outline, *prism.holes)]
    toothed = [(shape, prism) for shape, prism in shapes if isinstance(shape, ExternalGear | InternalGear)]
    if not toothed:
        return Cost(), Cost()
    for shape, prism in toothed:
        minutes = minutes + shape.teeth * (on.tooth_min + on.tooth_min_per_mm * (prism.z1_mm - prism.z0_mm))
    return _work(on.setup_min, on.hour_eur), _work(minutes, on.hour_eur)


def _fits(part: Part, rates: Rates) -> tuple[Cost, Cost]:
    """Return what faces with a tolerance cost: ground after hardening where the part is hard."""
    hard, fits = rates.hardening, len(part.fits)
    if not (isinstance(part.grade, GearGrade) or any(fit.raceway for fit in part.fits)):
        return Cost(), _work(rates.machining.fit_min * fits, rates.machining.hour_eur)
    kind = Cost(total_eur=hard.lot_eur) + _work(hard.setup_min, hard.hour_eur)
    return kind, _work(hard.seat_min * fits, hard.hour_eur) + Cost(total_eur=hard.eur_per_kg * part.unit_mass_kg())


def _count(shapes: Iterable[object]) -> Numbers:
    """Return how many round holes shapes are."""
    found: Numbers = 0.0
    for shape in shapes:
        found = found + (shape.count if isinstance(shape, Pattern) else float(isinstance(shape, Circle)))
    return found


def _holes(part: Part) -> Numbers:
    """Return the holes of a part; those of one layer go on through the others."""
    holes: Numbers = reduce(np.maximum, [_count(prism.holes) for prism in part.prisms])
    return holes


def _mouths(part: Part) -> Numbers:
    """Return how many holes are tapped, countersunk or chamfered."""
    return _count(shape for one in part.features if isinstance(one, Hole) for shape in one.shapes)


def priced(units: Iterable[Iterable[Part]]) -> Floats:
    """Return total, made and bought pieces of units, and the share of the total that is paid once, shape (4, ...)."""
    cost = robot_cost(units)
    rows = np.broadcast_arrays(cost.total_eur, cost.made, cost.bought, cost.once_eur)
    return np.stack(rows).astype(np.float64)

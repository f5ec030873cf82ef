"""The chain of the thigh: a piece of whole links around each sprocket, joined by a turnbuckle in each strand.

The knee turns by less than half a turn, so that only the links near a sprocket ever run onto it. Between them each
strand is a bar of aluminium, which is lighter than the chain and can be adjusted.
"""

import math
from dataclasses import replace

import numpy as np

from pareto_monoped.geometry.features import Thread
from pareto_monoped.geometry.making import Fit
from pareto_monoped.geometry.parts import Part, Prism, disc, layer, steel_part, strong_part
from pareto_monoped.geometry.roles import Joint, JointKind, Purchase, Role
from pareto_monoped.geometry.screws import M5, ordered_nut
from pareto_monoped.geometry.shapes import Arc, Circle, Line, Numbers, Path, Shape, rectangle
from pareto_monoped.leg.dimensions import LegDimensions
from pareto_monoped.materials import ALLOYS, MATERIALS

# Our own layout, mm along the strand.
_STRAIGHT = 4  # pitches of a piece beside its sprocket, with the knee in the middle of its range
FORK_BOTTOM, FORK_ROOT = 6.5, 10.0  # from the pin to the bottom of the fork's slot and to the stud
HALF_FORK, CHEEK = 4.0, 1.6  # half width of a fork, and thickness of its cheeks
_STUD_DEPTH = 10.5  # in the bar, in the middle of the travel
TRAVEL = 4.0  # of either end to either side, for assembly and wear
LEAST_ENGAGED = _STUD_DEPTH - TRAVEL  # of a stud: 1.3 diameters
_TAPPED = 16.0  # depth of the bar's bores
_THREADED = _STUD_DEPTH + TRAVEL  # of their threads at least: as far as a stud goes
_RUN_OUT = 1.0  # of the stud's thread before the fork at most (DIN 76-1, short); an undercut would weaken the stud
_NUT, _NUT_FLATS = 2.7, 8.0  # height and width across flats of a thin nut M5 (ISO 4035)
_SPARE = 0.3  # between nut and fork at the short end of the travel
# Our own layout across the strand, mm.
BAR_WIDTH = 8.0  # of the bar's square ends: 1.5 mm of metal around the thread
BAR_FLAT = 3.0  # thickness of the bar between its ends
THREAD = M5
_STUD = 3.97  # side of a square of the area of an M5 thread (ISO 724: 15.8 mm2 at the pitch diameter)
_NUT_SIDE = 7.44  # side of a square of the nut's area
_SLOT_PLAY = 0.1  # of the chain's link in the fork, to either side
_PIN_PLAY = 0.05  # radial, of the turnbuckle's pin in the chain
_GAP = 0.45  # between the fork and the next link's plates
_Place = tuple[Numbers, Numbers, Numbers]


def links_of(d: LegDimensions) -> int:
    """Return the number of links of either piece; it begins and ends with an inner link, so that the number is odd."""
    return d.chain.teeth // 2 + 2 * _STRAIGHT


def reach_mm(d: LegDimensions) -> float:
    """Return the distance from a sprocket's axis to the last pins of its piece, the knee in the middle of its range."""
    return _STRAIGHT * d.chain.pitch_mm


_RENOLD_MM_PER_N = 14.51e-5
"""Elastic extension of a simplex roller chain times its pitch squared, per length and pull: Renold, Transmission Chain,
designer guide, "chain extension"; all in mm and N. Quoted from memory."""


def strand_compliance_m_per_n(length_mm: Numbers, d: LegDimensions) -> Numbers:
    """Return by how much one strand stretches per pull, float or shape (n,), between axes ``length_mm`` apart.

    In series: the chain between the sprockets and the last pins, both studs, and the bar, as long as its parts are;
    forks and the teeth of the sprockets are taken as rigid.
    """
    half_bar = 0.5 * (length_mm - 2.0 * reach_mm(d)) - FORK_ROOT - TRAVEL - _NUT - _SPARE
    chain = _RENOLD_MM_PER_N / d.chain.pitch_mm**2 * 2.0 * reach_mm(d)
    steel, aluminium = MATERIALS.steel.youngs_modulus_mpa, MATERIALS.aluminium.youngs_modulus_mpa
    studs = 2.0 * (TRAVEL + _NUT + _SPARE + _STUD_DEPTH - LEAST_ENGAGED) / (steel * _STUD**2)
    ends = 2.0 * _TAPPED / (aluminium * (BAR_WIDTH**2 - _STUD**2))
    middle = 2.0 * (half_bar - _TAPPED) / (aluminium * BAR_WIDTH * BAR_FLAT)
    return 1e-3 * (chain + studs + ends + middle)


def chain_parts(length_mm: Numbers, d: LegDimensions) -> tuple[Part, ...]:
    """Build both pieces of the chain and the turnbuckles between axes ``length_mm`` apart, float or shape (n,).

    They are drawn with the turnbuckles in the middle of the strands, where they are with the knee in the middle of its
    range. The chain's pieces are the same for every thigh; the bars are cut to length.
    """
    radius, links = d.chain.pitch_radius_mm, links_of(d)
    places = tuple((side * radius, -0.5 * length_mm, 0.0) for side in (-1.0, 1.0))
    reach = reach_mm(d)
    return (
        *(
            steel_part(
                name=f"chain_{end}",
                role=Role.CHAIN,
                prisms=_piece(y_mm, sign, reach, radius, d),
                catalogue_mass_kg=d.chain.kg_per_m * 1e-3 * links * d.chain.pitch_mm + 0.0 * length_mm,
                joint=Joint(kind=JointKind.ENGAGED, how="around the teeth of", partner=sprocket),
                purchases=(
                    Purchase(
                        kind="chain",
                        designation=f"roller chain ISO 606 - {d.chain.name} - {links} links of {d.chain.pitch_mm:g} mm",
                        standard="ISO 606",
                        remark="an inner link at both ends",
                    ),
                ),
                note="put on with the knee in the middle of its range",
            )
            for end, y_mm, sign, sprocket in (
                ("hip", 0.0, 1.0, "drive_sprocket"),
                ("knee", -length_mm, -1.0, "knee_axle"),
            )
        ),
        *_turnbuckles(length_mm - 2.0 * reach, places, d),
    )


def _turnbuckles(pins_mm: Numbers, places: tuple[_Place, ...], d: LegDimensions) -> tuple[Part, ...]:
    """Build the turnbuckles of both strands, ``pins_mm`` long between their pins."""
    half_bar = 0.5 * pins_mm - FORK_ROOT - TRAVEL - _NUT - _SPARE
    cut = f", {2.0 * float(half_bar):.1f} mm long" if np.ndim(half_bar) == 0 else ""
    return (
        strong_part(
            name="turnbuckle_bar",
            role=Role.TURNBUCKLE,
            prisms=_bar(half_bar),
            places_mm=places,
            joint=Joint(kind=JointKind.THREADED, how="threaded onto", partner="turnbuckle_end_hip"),
            at_assembly="each nut onto the stud of its fork first, then both forks into the bar by equal turns",
            note=f"{BAR_WIDTH:g} mm square{cut}, milled to {BAR_FLAT:g} mm between the ends; tapped "
            f"{THREAD.thread.text} at one end and {_left(THREAD.thread).text} at the other, {_THREADED:g} mm deep at "
            f"least with a bottoming tap, drill {2.0 * THREAD.core:g} mm, {_TAPPED:g} mm deep, whose point may come "
            f"out into the flats; drawn as square bores; travel {TRAVEL:g} mm at either end to either side",
        ),
        *(
            part
            for side, end in ((1.0, "hip"), (-1.0, "knee"))
            for part in _fastened(end, side, pins_mm, half_bar, places, d)
        ),
    )


def _left(thread: Thread) -> Thread:
    return replace(thread, left_hand=True)


def _fastened(
    end: str, side: float, pins_mm: Numbers, half_bar_mm: Numbers, places: tuple[_Place, ...], d: LegDimensions
) -> tuple[Part, Part]:
    """Build the fork and locknut at the upper (side 1) or lower end (-1) of both turnbuckles."""
    hand = "right-hand" if side > 0.0 else "left-hand"
    thread = replace(THREAD.thread if side > 0.0 else _left(THREAD.thread), tolerance="6g")
    pin = Fit(diameter_mm=d.chain.pin_diameter_mm, zone="H7")

    def shifted(by_mm: Numbers) -> tuple[_Place, ...]:
        return tuple((x, y + side * by_mm, z) for x, y, z in places)

    return (
        Part(
            name=f"turnbuckle_end_{end}",
            role=Role.TURNBUCKLE,
            material=MATERIALS.steel,
            process="machined",
            prisms=_end(side, d),
            places_mm=shifted(0.5 * pins_mm),
            grade=ALLOYS["c45_qt"],
            purchases=(
                Purchase(
                    kind="pin",
                    designation=f"bearing pin of roller chain ISO 606 - {d.chain.name}, {d.chain.pin_diameter_mm:g} mm",
                    standard="ISO 606",
                    remark="from spare links of the same chain; riveted into the fork",
                ),
            ),
            at_assembly="once its chain is there, rivet its pin through the chain's last link with a block of "
            "steel held against its other head, so that no blow reaches plates or sprockets; the link must still turn",
            note=f"fork, its slot {d.chain.inner_link_mm + 2.0 * _SLOT_PLAY:g} +0.1 / 0, with {hand} stud "
            f"{thread.text}, {TRAVEL + _NUT + _SPARE + _STUD_DEPTH:g} mm long without undercut, run-out "
            f"before the fork {_RUN_OUT:g} mm at most: keep the nut clear of it at the short end of the travel; drawn "
            "as a square of its area; the pin, drawn as a boss, is no part of it: it is the chain's "
            f"own, through holes {pin.text} that are reamed in line through both cheeks, and through the chain's inner "
            "link, and is riveted",
        ),
        steel_part(
            name=f"turnbuckle_nut_{end}",
            role=Role.TURNBUCKLE,
            prisms=_nut(side),
            places_mm=shifted(half_bar_mm),
            joint=Joint(kind=JointKind.THREADED, how="threaded onto", partner=f"turnbuckle_end_{end}"),
            purchases=(ordered_nut(f"{THREAD.name}{'-LH' if hand == 'left-hand' else ''}", thin=True, grade="05"),),
            note="locks the bar",
        ),
    )


def _piece(y_mm: Numbers, sign: float, reach_mm: Numbers, radius_mm: float, d: LegDimensions) -> tuple[Prism, ...]:
    """Build link plates around a sprocket and rollers of the free strands; ``sign`` is 1 at the hip, -1 at the knee."""
    half_inner, half_pin, half_plate = 0.5 * d.chain.inner_width_mm, 0.5 * d.chain.pin_mm, 0.5 * d.chain.plate_mm
    end = reach_mm - half_plate - _GAP
    rows = _around(y_mm, sign, end, radius_mm - half_plate, radius_mm + half_plate)
    pin = 0.5 * d.chain.pin_diameter_mm + _PIN_PLAY

    def bars(first_mm: Numbers, last_mm: Numbers, half_mm: float, *, pinned: bool) -> tuple[Prism, ...]:
        return tuple(
            layer(
                rectangle(
                    width_mm=d.chain.roller_mm,
                    height_mm=last_mm - first_mm,
                    x_mm=x,
                    y_mm=y_mm - sign * 0.5 * (first_mm + last_mm),
                ),
                -half_mm,
                half_mm,
                *((Circle(radius_mm=pin, x_mm=x, y_mm=y_mm - sign * reach_mm),) if pinned else ()),
            )
            for x in (-radius_mm, radius_mm)
        )

    return (
        layer(rows, -half_pin, -half_inner),
        # From where on no tooth reaches the strand, whatever the sprocket's angle; then the last link in its fork.
        *bars(2.0 * d.chain.pitch_mm, end, half_inner, pinned=False),
        *bars(end, reach_mm + 0.5 * d.chain.roller_mm, 0.5 * d.chain.inner_link_mm, pinned=True),
        layer(rows, half_inner, half_pin),
    )


def _around(y_mm: Numbers, sign: float, reach_mm: Numbers, inner_mm: float, outer_mm: float) -> Shape:
    """Return a band around half of a sprocket that runs on straight to both sides."""
    end, pi = y_mm - sign * reach_mm, math.pi
    start = 0.0 if sign > 0.0 else pi  # the angle at which the outer arc begins
    one, other = sign * outer_mm, sign * inner_mm
    return Path(
        (
            Line(one, end, one, y_mm),
            Arc(0.0, y_mm, outer_mm, start, start + pi),
            Line(-one, y_mm, -one, end),
            Line(-one, end, -other, end),
            Line(-other, end, -other, y_mm),
            Arc(0.0, y_mm, inner_mm, start + pi, start),
            Line(other, y_mm, other, end),
            Line(other, end, one, end),
        )
    )


def _bar(half_mm: Numbers) -> tuple[Prism, ...]:
    """Build a bar along y with square ends, whose threads are drawn as square bores."""
    half, stud = 0.5 * BAR_WIDTH, 0.5 * _STUD
    wall = half - stud
    middle = half_mm - _TAPPED
    ends = tuple(side * (half_mm - 0.5 * _TAPPED) for side in (-1.0, 1.0))
    return (
        layer(rectangle(width_mm=BAR_WIDTH, height_mm=2.0 * middle), -0.5 * BAR_FLAT, 0.5 * BAR_FLAT),
        *(
            layer(rectangle(width_mm=wall, height_mm=_TAPPED, x_mm=side * (half - 0.5 * wall), y_mm=y_mm), -stud, stud)
            for y_mm in ends
            for side in (-1.0, 1.0)
        ),
        *(
            layer(rectangle(width_mm=BAR_WIDTH, height_mm=_TAPPED, y_mm=y_mm), low, high)
            for y_mm in ends
            for low, high in ((-half, -stud), (stud, half))
        ),
    )


def _across(low_mm: float, high_mm: float, side: float, half_width_mm: float) -> Path:
    """Return a rectangle across the strand, from ``low_mm`` to ``high_mm`` off the turnbuckle's middle."""
    return rectangle(width_mm=2.0 * half_width_mm, height_mm=high_mm - low_mm, y_mm=side * 0.5 * (low_mm + high_mm))


def _nut(side: float) -> tuple[Prism, ...]:
    """Build a nut from the bar's end on; its hexagon is drawn as a square of the same area."""
    half, stud = 0.5 * _NUT_SIDE, 0.5 * _STUD
    wall = half - stud
    whole = _across(0.0, _NUT, side, half)
    return (
        layer(whole, -half, -stud),
        *(
            layer(
                rectangle(width_mm=wall, height_mm=_NUT, x_mm=sign * (half - 0.5 * wall), y_mm=side * 0.5 * _NUT),
                -stud,
                stud,
            )
            for sign in (-1.0, 1.0)
        ),
        layer(whole, stud, half),
    )


def _end(side: float, d: LegDimensions) -> tuple[Prism, ...]:
    """Build a fork around the chain's last link, around its pin, with a stud towards the turnbuckle's middle."""
    stud = 0.5 * _STUD
    half_slot = 0.5 * d.chain.inner_link_mm + _SLOT_PLAY
    half_fork = half_slot + CHEEK
    tip = FORK_ROOT + TRAVEL + _NUT + _SPARE + _STUD_DEPTH
    cheek = _across(-FORK_BOTTOM, HALF_FORK, side, HALF_FORK)
    return (
        layer(cheek, -half_fork, -half_slot),
        disc(0.5 * d.chain.pin_diameter_mm, -half_slot, half_slot),
        layer(cheek, half_slot, half_fork),
        layer(_across(-FORK_ROOT, -FORK_BOTTOM, side, HALF_FORK), -half_fork, half_fork),
        layer(_across(-tip, -FORK_ROOT, side, stud), -stud, stud),
    )

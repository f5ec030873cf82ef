"""The chain of the thigh: two pieces of whole links around the sprockets, joined by a turnbuckle in each strand."""

import math

import numpy as np

from pareto_monoped.geometry.parts import Part, Prism
from pareto_monoped.geometry.roles import Joint, JointKind, Role
from pareto_monoped.geometry.shapes import Arc, Circle, Line, Numbers, Path, Shape, rectangle
from pareto_monoped.leg.dimensions import LegDimensions
from pareto_monoped.materials import ALLOYS, MATERIALS

# Our own layout, mm along the strand. From the straight leg to the end of the knee's stop each strand moves by 68 mm:
# 0.2 m between the axes is the least at which no turnbuckle reaches a sprocket.
TURNBUCKLE = 48.0  # between its pins, in the middle of its travel: room for studs and forks at either end
_BARREL, _BARREL_WIDTH = 28.0, 7.0  # a square bar with 1.5 mm of wall around its M4 threads
_STUD = 3.2  # side of a square of the area of an M4 thread (ISO 724: 9.8 mm2 at the pitch diameter)
_STUD_DEPTH = 10.0  # in the barrel, in the middle of the travel; 1.25 diameters are left at its long end
_FORK_BOTTOM, _FORK_ROOT = 4.0, 7.0  # from the pin to the bottom of the fork's slot and to the stud
_SLOT_PLAY = 0.1  # of the chain's link in the fork, to either side
_PIN_PLAY = 0.05  # radial, of the turnbuckle's pin in the chain
_GAP = 0.45  # between the fork and the next link's plates
_SPARE_TRAVEL = 1.0  # beyond half a pitch, to either side, for tightening


def links_of(length_mm: float, d: LegDimensions) -> tuple[int, int, float]:
    """Numbers of links of the pieces at hip and knee, and the length in mm to which both turnbuckles are set.

    A piece begins and ends with an inner link, so that its number of links is odd. That of both together is even, and
    each turnbuckle, measured between its pins, takes up at most half a pitch more or less than ``TURNBUCKLE``.
    """
    pitch = d.chain.pitch_mm
    around = 2.0 * length_mm + d.chain.teeth * pitch
    both = 2 * math.floor((around - 2.0 * (TURNBUCKLE - 0.5 * pitch)) / (2.0 * pitch) + 1e-9)
    half = both // 2
    first = half if half % 2 else half + 1
    return first, both - first, 0.5 * (around - both * pitch)


def chain_parts(length_mm: Numbers, d: LegDimensions) -> tuple[Part, ...]:
    """Both pieces of the chain and the turnbuckles.

    The parts are drawn and weighed with the turnbuckles in the middle of the strands and of their travel, so that mass
    is a smooth function of length. A real chain has whole links: a turnbuckle then stands up to 6 mm beside the middle
    and is set up to half a pitch shorter or longer, and both pieces together weigh up to 1.5 g (05B-1) more or less.

    Args:
        length_mm: between the axes, float or shape (n,).
        d: dimensions.
    """
    radius = d.chain.pitch_radius_mm
    metres = 1e-3 * (length_mm + 0.5 * d.chain.teeth * d.chain.pitch_mm - TURNBUCKLE)
    places = tuple((side * radius, -0.5 * length_mm, 0.0) for side in (-1.0, 1.0))
    if np.ndim(length_mm) == 0:
        at_hip, at_knee, pins = links_of(float(length_mm), d)
        count = {"hip": f"{at_hip} links", "knee": f"{at_knee} links"}
        setting = f"set to {pins:.1f} mm between pins"
    else:  # many lengths at once: notes are used only for single robots
        count, setting = {"hip": "cut", "knee": "cut"}, "set"
    reach = 0.5 * (length_mm - TURNBUCKLE)
    half_travel = 0.5 * d.chain.pitch_mm + _SPARE_TRAVEL
    travel = f"{TURNBUCKLE - half_travel:g} to {TURNBUCKLE + half_travel:g} mm"
    return (
        *(
            Part(
                name=f"chain_{end}",
                role=Role.CHAIN,
                material=MATERIALS.steel,
                process="bought",
                prisms=_piece(y_mm, sign, reach, radius, d),
                catalogue_mass_kg=d.chain.kg_per_m * metres,
                joint=Joint(kind=JointKind.ENGAGED, how="around the teeth of", partner=sprocket),
                note=f"{d.chain.name} (ISO 606), {count[end]} of {d.chain.pitch_mm:g} mm, an inner link at both ends",
            )
            for end, y_mm, sign, sprocket in (
                ("hip", 0.0, 1.0, "drive_sprocket"),
                ("knee", -length_mm, -1.0, "knee_sprocket"),
            )
        ),
        Part(
            name="turnbuckle_barrel",
            role=Role.TURNBUCKLE,
            material=MATERIALS.aluminium,
            process="machined",
            prisms=_barrel(),
            places_mm=places,
            joint=Joint(kind=JointKind.THREADED, how="threaded onto", partner="turnbuckle_end"),
            grade=ALLOYS["aw_7075_t6"],
            note=f"7 mm square, tapped M4 right-hand and left-hand; {setting}, travel {travel}",
        ),
        Part(
            name="turnbuckle_end",
            role=Role.TURNBUCKLE,
            material=MATERIALS.steel,
            process="machined",
            prisms=_end(d),
            count=2,
            pitch_radius_mm=0.5 * TURNBUCKLE,
            phase_rad=0.5 * math.pi,
            places_mm=places,
            grade=ALLOYS["c45_qt"],
            note="fork with M4 stud and pin for the chain's inner link; one of each two with left-hand thread",
        ),
    )


def _piece(y_mm: Numbers, sign: float, reach_mm: Numbers, radius_mm: float, d: LegDimensions) -> tuple[Prism, ...]:
    """A piece of chain as its rows of link plates around a sprocket, and the rollers of its free strands as bars.

    Args:
        y_mm: of the sprocket's axis.
        sign: 1 at the hip, where the strands run down from the sprocket; -1 at the knee.
        reach_mm: from the axis to the last pins.
        radius_mm: on which the pins run.
        d: dimensions.
    """
    half_inner, half_pin, half_plate = 0.5 * d.chain.inner_width_mm, 0.5 * d.chain.pin_mm, 0.5 * d.chain.plate_mm
    end = reach_mm - half_plate - _GAP
    rows = _around(y_mm, sign, end, radius_mm - half_plate, radius_mm + half_plate)
    pin = 0.5 * d.chain.pin_diameter_mm + _PIN_PLAY

    def bars(first_mm: Numbers, last_mm: Numbers, half_mm: float, *, pinned: bool) -> tuple[Prism, ...]:
        return tuple(
            Prism(
                outline=rectangle(
                    width_mm=d.chain.roller_mm,
                    height_mm=last_mm - first_mm,
                    x_mm=x,
                    y_mm=y_mm - sign * 0.5 * (first_mm + last_mm),
                ),
                z0_mm=-half_mm,
                z1_mm=half_mm,
                holes=(Circle(radius_mm=pin, x_mm=x, y_mm=y_mm - sign * reach_mm),) if pinned else (),
            )
            for x in (-radius_mm, radius_mm)
        )

    return (
        Prism(outline=rows, z0_mm=-half_pin, z1_mm=-half_inner),
        # From where on no tooth reaches the strand, whatever the sprocket's angle; then the last link in its fork.
        *bars(2.0 * d.chain.pitch_mm, end, half_inner, pinned=False),
        *bars(end, reach_mm + 0.5 * d.chain.roller_mm, 0.5 * d.chain.inner_link_mm, pinned=True),
        Prism(outline=rows, z0_mm=half_inner, z1_mm=half_pin),
    )


def _around(y_mm: Numbers, sign: float, reach_mm: Numbers, inner_mm: float, outer_mm: float) -> Shape:
    """A band around half of a sprocket that runs on straight to both sides."""
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


def _barrel() -> tuple[Prism, ...]:
    """A square bar along y with the bore that its studs fill."""
    half, stud = 0.5 * _BARREL_WIDTH, 0.5 * _STUD
    whole = rectangle(width_mm=_BARREL_WIDTH, height_mm=_BARREL)
    wall = half - stud
    return (
        Prism(outline=whole, z0_mm=-half, z1_mm=-stud),
        *(
            Prism(
                outline=rectangle(width_mm=wall, height_mm=_BARREL, x_mm=side * (half - 0.5 * wall)),
                z0_mm=-stud,
                z1_mm=stud,
            )
            for side in (-1.0, 1.0)
        ),
        Prism(outline=whole, z0_mm=stud, z1_mm=half),
    )


def _end(d: LegDimensions) -> tuple[Prism, ...]:
    """A fork around the chain's last link, around its pin; the turnbuckle's middle lies on the -x side."""
    half_pin, half_plate, stud = 0.5 * d.chain.pin_mm, 0.5 * d.chain.plate_mm, 0.5 * _STUD
    half_slot = 0.5 * d.chain.inner_link_mm + _SLOT_PLAY
    bottom, root = _FORK_BOTTOM, _FORK_ROOT
    tip = 0.5 * TURNBUCKLE - 0.5 * _BARREL + _STUD_DEPTH
    cheek = rectangle(width_mm=bottom + half_plate, height_mm=2.0 * half_plate, x_mm=0.5 * (half_plate - bottom))
    return (
        Prism(outline=cheek, z0_mm=-half_pin, z1_mm=-half_slot),
        Prism(outline=Circle(radius_mm=0.5 * d.chain.pin_diameter_mm), z0_mm=-half_slot, z1_mm=half_slot),
        Prism(outline=cheek, z0_mm=half_slot, z1_mm=half_pin),
        Prism(
            outline=rectangle(width_mm=root - bottom, height_mm=2.0 * half_plate, x_mm=-0.5 * (root + bottom)),
            z0_mm=-half_pin,
            z1_mm=half_pin,
        ),
        Prism(
            outline=rectangle(width_mm=tip - root, height_mm=_STUD, x_mm=-0.5 * (tip + root)), z0_mm=-stud, z1_mm=stud
        ),
    )

"""The sprockets of hip and knee (ISO 606), and shaft and needle bearing that support the far side of the knee's
drive.

The chain pulls between two supports, the knee actuator's main bearing and this one in the hip coupling, so that neither
has to carry a tilting moment. The shaft's flange is clamped between sprocket and drive coupling by the screws of the
drive.
"""

from dataclasses import replace
from functools import lru_cache

import numpy as np

from pareto_monoped.actuator.needles import roller_bearing
from pareto_monoped.geometry.dowels import Dowel
from pareto_monoped.geometry.features import Hole, Mouth
from pareto_monoped.geometry.making import RELIEF_MM, Fit
from pareto_monoped.geometry.parts import Part, Prism, disc, layer, steel_part
from pareto_monoped.geometry.roles import GREASE, Group, Joint, JointKind, Purchase, Role
from pareto_monoped.geometry.screws import M3
from pareto_monoped.geometry.shapes import Arc, Circle, Floats, Line, Path, Pattern, Shape
from pareto_monoped.leg.dimensions import ChainDrive, LegDimensions
from pareto_monoped.materials import ALLOYS, MATERIALS

# Our own layout, mm.
BORE_RADIUS = 8.5
_RELIEF_RADIUS, _RELIEF_PITCH_RADIUS = 3.3, 19.0  # one to a tooth, between screws and teeth: 2.3 mm to the roots
HEAD_PLAY = 0.1  # around a sunk screw head


@lru_cache(maxsize=8)
def sprocket_outline(drive: ChainDrive) -> Path:
    """Return a chain sprocket around the origin, with the middle of a tooth gap on the +x axis.

    Seats and tip after ISO 606: pitch diameter p / sin(180 deg / z), least seat radius 0.505 d1, tip diameter half way
    between its limits d + p (1 - 1.6 / z) - d1 and d + 1.25 p - d1. The seat spans 140 degrees, the greatest of ISO 606
    being 140 - 90 / z and the least 120 - 90 / z; the curved flanks are replaced by their tangents.
    """
    teeth, pitch_mm, pitch_radius = drive.teeth, drive.pitch_mm, drive.pitch_radius_mm
    seat = 0.505 * drive.roller_mm
    tip = pitch_radius + 0.25 * (pitch_mm * (1.0 - 1.6 / teeth) + 1.25 * pitch_mm) - 0.5 * drive.roller_mm
    half_seat = np.radians(0.5 * (140.0 - 90.0 / teeth))
    # One gap, with u outward along its middle and v across: the seat ends at (u, v), its tangent runs on to the tip.
    end = np.array([pitch_radius - seat * np.cos(half_seat), seat * np.sin(half_seat)])
    along = np.array([np.sin(half_seat), np.cos(half_seat)])
    reach = -end @ along + np.sqrt((end @ along) ** 2 + tip**2 - end @ end)
    rim = end + reach * along
    rim_angle = float(np.arctan2(rim[1], rim[0]))
    pieces: list[Line | Arc] = []
    for tooth in range(teeth):
        angle = 2.0 * np.pi * tooth / teeth
        turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])

        def line(start: Floats, stop: Floats, turn: Floats = turn) -> Line:
            a, b = turn @ start, turn @ stop
            return Line(float(a[0]), float(a[1]), float(b[0]), float(b[1]))

        x, y = turn @ np.array([pitch_radius, 0.0])
        mirror = np.array([1.0, -1.0])
        pieces += [
            line(rim * mirror, end * mirror),
            # The seat turns clockwise, its material lies outside: from the lower flank through the bottom to the upper.
            Arc(float(x), float(y), seat, angle + np.pi + half_seat, angle + np.pi - half_seat),
            line(end, rim),
            Arc(0.0, 0.0, tip, angle + rim_angle, angle + 2.0 * np.pi / teeth - rim_angle),
        ]
    return Path(tuple(pieces))


def relief_holes(d: LegDimensions) -> Pattern:
    """Return the holes that lighten a sprocket."""
    return Pattern(radius_mm=_RELIEF_RADIUS, pitch_radius_mm=_RELIEF_PITCH_RADIUS, count=d.chain.teeth)


def sprocket_prisms(d: LegDimensions, head_mm: float) -> tuple[Prism, ...]:
    """Build the sprocket; a wide one is counterbored at -z, so that screws of the same length suit any width."""
    half, recess = 0.5 * d.chain.sprocket_width_mm, d.sprocket_recess_mm

    def toothed(z0_mm: float, z1_mm: float, screw_radius_mm: float) -> Prism:
        return layer(
            sprocket_outline(d.chain),
            z0_mm,
            z1_mm,
            Circle(radius_mm=BORE_RADIUS),
            replace(d.knee.output_bolts, radius_mm=screw_radius_mm),
            d.drive_dowel,
            relief_holes(d),
        )

    seat = recess - half
    whole = toothed(seat, half, M3.hole)
    return (whole,) if recess == 0.0 else (toothed(-half, seat, head_mm), whole)


BEARING = roller_bearing("HK1210")
"""Lightest of its kind whose seat leaves 2.4 mm to the screws of the hip coupling."""
# Our own layout, mm.
FRONT = -10.0  # of the bearing, towards the sprocket; 1 mm clear of the heads in front of the inner plate
BACK = FRONT - BEARING.width_mm
SEAT_RADIUS = 0.5 * BEARING.outer_diameter_mm
BOSS_RADIUS = SEAT_RADIUS + 1.0  # of the hip coupling, where it passes through the inner plate
SHAFT_RADIUS = 0.5 * BEARING.inner_diameter_mm
SUPPORT_BORE_RADIUS = 4.0  # lightens the shaft: 2 mm of hardened wall are left under the needles
FLANGE = 3.0  # thickness, clamped between sprocket and drive coupling
_CENTRE = SUPPORT_BORE_RADIUS + 0.5  # of the centres around its ends, between which the shaft is ground
_OVERRUN = 0.5  # of the shaft beyond the bearing
_GREASE_G = 0.5  # fills the space between the needles


def middle_mm() -> float:
    """Return the height of the bearing's middle; the chain runs at 0."""
    return 0.5 * (FRONT + BACK)


def support_parts(d: LegDimensions, flange_radius_mm: float, holes: tuple[Shape, ...]) -> tuple[Part, ...]:
    """Build shaft and bearing; ``holes`` are those of the drive's screws, and what lightens the coupling."""
    half, (relief, depth) = 0.5 * d.chain.sprocket_width_mm, RELIEF_MM
    bore, end, centre = (
        Circle(radius_mm=SUPPORT_BORE_RADIUS),
        BACK - _OVERRUN,
        Mouth.of_centre(_CENTRE, SUPPORT_BORE_RADIUS),
    )
    layers = (
        (flange_radius_mm, half, half + FLANGE, (bore, *holes)),
        (BORE_RADIUS - depth, half - relief, half, (bore,)),
        (BORE_RADIUS, -half, half - relief, (bore,)),
        (SHAFT_RADIUS - depth, -half - relief, -half, (bore,)),
        (SHAFT_RADIUS, end, -half - relief, (bore,)),
    )
    return (
        Part(
            name="drive_shaft",
            role=Role.SHAFT,
            material=MATERIALS.steel,
            process="machined",
            prisms=tuple(disc(radius, z0, z1, *cut) for radius, z0, z1, cut in layers),
            group=Group.KNEE_DRIVE,
            grade=ALLOYS["case_18crnimo7_6"],
            fits=(
                Fit(diameter_mm=2.0 * SHAFT_RADIUS, zone="h6", seat=True, raceway=True),
                Fit(diameter_mm=2.0 * BORE_RADIUS, zone="h6"),
            ),
            features=(Hole(shapes=(bore,), low_mm=end, high_mm=half + FLANGE, low=centre, high=centre),),
            registers=(Dowel(diameter_mm=2.0 * float(d.drive_dowel.radius_mm)).hole_fit,),
            # Makers of needle bearings ask 0.3 mm of raceways at least.
            note="raceway of the needle bearing, case-hardened at least 0.3 mm deep and ground; the flange, whose "
            "holes are reamed, stays soft",
        ),
        steel_part(
            name="drive_bearing",
            role=Role.BEARING,
            prisms=(disc(SEAT_RADIUS, BACK, FRONT, Circle(radius_mm=SHAFT_RADIUS)),),
            catalogue_mass_kg=BEARING.mass_kg,
            joint=Joint(kind=JointKind.PRESSED, how="pressed into", partner="hip_coupling"),
            purchases=(
                Purchase(
                    kind="needle bearing",
                    designation=f"drawn cup needle bearing {BEARING.designation}, open ends",
                    standard="ISO 3245",
                    alternatives=(f"NTN {BEARING.designation}", f"INA {BEARING.designation}"),
                ),
                replace(GREASE, count=_GREASE_G),
            ),
        ),
    )

"""The far side of the knee's drive: a hardened shaft through the sprocket, and its needle bearing in the hip coupling.

The chain then pulls between two supports, the knee actuator's main bearing and this one, so that neither has to carry
a tilting moment. The shaft's flange is clamped between sprocket and drive coupling by the screws of the drive.
"""

from pareto_monoped.actuator.roller_bearings import roller_bearing
from pareto_monoped.geometry.making import Fit
from pareto_monoped.geometry.parts import Part, Prism
from pareto_monoped.geometry.roles import Group, Joint, JointKind, Role
from pareto_monoped.geometry.shapes import Circle, Shape
from pareto_monoped.leg.dimensions import LegDimensions
from pareto_monoped.leg.sprocket import BORE_RADIUS as NECK_RADIUS
from pareto_monoped.materials import ALLOYS, MATERIALS

BEARING = roller_bearing("HK1210")
"""Lightest of its kind whose seat leaves 2.4 mm to the screws of the hip coupling."""
# Our own layout, mm.
FRONT = -10.0  # of the bearing, towards the sprocket; 1 mm clear of the heads in front of the inner plate
BACK = FRONT - BEARING.width_mm
SEAT_RADIUS = 0.5 * BEARING.outer_diameter_mm
BOSS_RADIUS = SEAT_RADIUS + 1.0  # of the hip coupling, where it passes through the inner plate
SHAFT_RADIUS = 0.5 * BEARING.inner_diameter_mm
BORE_RADIUS = 4.0  # lightens the shaft: 2 mm of hardened wall are left under the needles
FLANGE = 3.0  # thickness, clamped between sprocket and drive coupling
_OVERRUN = 0.5  # of the shaft beyond the bearing


def middle_mm() -> float:
    """Height of the bearing's middle; the chain runs at 0."""
    return 0.5 * (FRONT + BACK)


def support_parts(d: LegDimensions, flange_radius_mm: float, holes: tuple[Shape, ...]) -> tuple[Part, ...]:
    """Shaft and bearing.

    Args:
        d: dimensions.
        flange_radius_mm: of the shaft's flange, that of the drive coupling.
        holes: of the drive's screws, and what lightens the coupling between them.
    """
    half = 0.5 * d.chain.sprocket_width_mm
    bore = Circle(radius_mm=BORE_RADIUS)
    layers = (
        (flange_radius_mm, half, half + FLANGE, (bore, *holes)),
        (NECK_RADIUS, -half, half, (bore,)),
        (SHAFT_RADIUS, BACK - _OVERRUN, -half, (bore,)),
    )
    return (
        Part(
            name="drive_shaft",
            role=Role.SHAFT,
            material=MATERIALS.steel,
            process="machined",
            prisms=tuple(
                Prism(outline=Circle(radius_mm=radius), z0_mm=z0, z1_mm=z1, holes=cut) for radius, z0, z1, cut in layers
            ),
            group=Group.KNEE_DRIVE,
            grade=ALLOYS["case_18crnimo7_6"],
            fits=(
                Fit(diameter_mm=2.0 * SHAFT_RADIUS, zone="h6", seat=True, raceway=True),
                Fit(diameter_mm=2.0 * NECK_RADIUS, zone="h6"),
            ),
            # Makers of needle bearings ask 0.3 mm of raceways at least.
            note="raceway of the needle bearing, case-hardened at least 0.3 mm deep and ground",
        ),
        Part(
            name="drive_bearing",
            role=Role.BEARING,
            material=MATERIALS.steel,
            process="bought",
            prisms=(
                Prism(
                    outline=Circle(radius_mm=SEAT_RADIUS),
                    z0_mm=BACK,
                    z1_mm=FRONT,
                    holes=(Circle(radius_mm=SHAFT_RADIUS),),
                ),
            ),
            catalogue_mass_kg=BEARING.mass_kg,
            joint=Joint(kind=JointKind.PRESSED, how="pressed into", partner="hip_coupling"),
            note=f"{BEARING.designation}, {BEARING.inner_diameter_mm:g} x {BEARING.outer_diameter_mm:g} x "
            f"{BEARING.width_mm:g} mm (ISO 3245)",
        ),
    )

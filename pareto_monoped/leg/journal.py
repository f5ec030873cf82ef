"""The journal on the knee actuator's back, by which the base's far cheek carries its free end, and the bearing
there.
"""

from dataclasses import replace

import numpy as np

from pareto_monoped.actuator.bearings import ordered_bearing, width_less_mm
from pareto_monoped.geometry.features import turned
from pareto_monoped.geometry.making import Fit, Length, narrower
from pareto_monoped.geometry.parts import Part, disc, steel_part, strong_part
from pareto_monoped.geometry.roles import Role
from pareto_monoped.geometry.screws import screw_for, screw_part
from pareto_monoped.geometry.shapes import Circle, Numbers, Pattern
from pareto_monoped.leg.dimensions import LegDimensions
from pareto_monoped.leg.sandwich import Place

# Our own layout, mm.
LIP = 2.0  # height of a seat's lip, which holds the outer ring only
SHOULDER_RADIUS = 11.8  # of an axle's shoulder, which touches the inner ring only


def bearing_part(
    name: str, d: LegDimensions, *, z0_mm: Numbers = 0.0, places_mm: tuple[Place, ...] | None = None
) -> Part:
    """Build a bearing from ``z0_mm`` on along z, or one at each place."""
    part = steel_part(
        name=name,
        role=Role.BEARING,
        prisms=(
            disc(
                d.bearing_outer_radius_mm, z0_mm, z0_mm + d.bearing_width_mm, Circle(radius_mm=d.bearing_bore_radius_mm)
            ),
        ),
        catalogue_mass_kg=d.bearing_kg,
        purchases=ordered_bearing(2.0 * d.bearing_bore_radius_mm),
        lengths=(
            Length(
                name="width",
                z0_mm=z0_mm,
                z1_mm=z0_mm + d.bearing_width_mm,
                lower_mm=-width_less_mm(2.0 * d.bearing_bore_radius_mm),
                upper_mm=0.0,
            ),
        ),
    )
    return part if places_mm is None else replace(part, places_mm=places_mm)


# Our own layout, mm.
_FLANGE = 4.0  # thickness, the grip of the screws
_FLANGE_RIM = 5.0  # of metal outside the circle of the screws, whose heads stay within it
_HEAD_ROOM = 6.5  # between flange and far cheek: heads of M5 are 5 mm high
_FLOAT = 1.0  # from the shoulder to the bearing, which moves along the journal: both cheeks would else jam the leg
_BEHIND = 1.0  # of the seat beyond the bearing, as far as the far cheek reaches
_RUN_OUT = 0.05  # of the seat about the hip's axis, with the screws tight
_WALL = 3.0  # between the bearing's seat and the bore for cables
_THREAD = 6.0  # M5 x 10 in the backplate of an ISSPG, M5 x 12 through that of an ESSPG, 5 mm into its motor


def far_cheek_z_mm(knee_actuator_length_m: Numbers, d: LegDimensions) -> Numbers:
    """Return the height z of the far cheek's inner face, where the journal's seat begins."""
    return _flange_z_mm(knee_actuator_length_m, d) + _HEAD_ROOM


def _flange_z_mm(knee_actuator_length_m: Numbers, d: LegDimensions) -> Numbers:
    """Return the height z of the flange's outer face, the seat of the screws."""
    return d.knee_mount_mm + 1000.0 * knee_actuator_length_m + _FLANGE


def journal_parts(
    knee_actuator_length_m: Numbers, d: LegDimensions, *, back_clearance_mm: Numbers = 0.0
) -> tuple[Part, ...]:
    """Build the journal and its screws, in the frame of the thigh, to which the journal belongs.

    ``knee_actuator_length_m``: from the mounting face to the back of the knee actuator, float or shape (n,);
    ``back_clearance_mm``: how much of the knee actuator's back the screws pass through before their threads begin,
    float or shape (n,).
    """
    back = d.knee_mount_mm + 1000.0 * knee_actuator_length_m
    flange, seat = _flange_z_mm(knee_actuator_length_m, d), far_cheek_z_mm(knee_actuator_length_m, d)
    bore = Circle(radius_mm=d.bearing_bore_radius_mm - _WALL)
    # Its core fits the threads that the actuator draws, 0.8 mm below nominal.
    screw = screw_for(d.knee.back_screw_mm, 0.5 * d.knee.back_screw_mm - 0.4)
    holes = Pattern(radius_mm=screw.hole, pitch_radius_mm=d.knee.back_pitch_radius_mm, count=d.knee.back_holes)
    return (
        strong_part(
            name="journal",
            role=Role.SHAFT,
            prisms=(
                disc(d.knee.back_pitch_radius_mm + _FLANGE_RIM, back, flange, bore, holes),
                disc(SHOULDER_RADIUS, flange, seat - _FLOAT, bore),
                disc(d.bearing_bore_radius_mm, seat - _FLOAT, seat + d.bearing_width_mm + _BEHIND, bore),
            ),
            # The bearing's inner ring moves along it.
            fits=(Fit(diameter_mm=2.0 * d.bearing_bore_radius_mm, zone="f6", seat=True),),
            lengths=(narrower("reach", back, seat - _FLOAT),),
            features=(turned(d.bearing_bore_radius_mm, seat + d.bearing_width_mm + _BEHIND, -1.0),),
            note="the bore takes the knee actuator's cables",
        ),
        replace(
            screw_part(
                "journal_screw",
                screw,
                head="cap",
                seat_mm=flange,
                grip_mm=_FLANGE + back_clearance_mm,
                room_mm=_THREAD,
                direction=-1.0,
                holes=holes,
                note=_screwed_into(back_clearance_mm),
            ),
            at_assembly=f"{'' if np.ndim(back_clearance_mm) or not back_clearance_mm else _EXCHANGED}{_SET}",
        ),
    )


_EXCHANGED = (
    "lay the leg down with the knee motor's back downwards, so that the motor rests in its place, and take out the "
    "screws that have held it, whose heads are under the flange; "
)
_SET = (
    "by hand first; hold the base and swing the thigh, with a dial gauge on the journal's seat; tap the journal until "
    f"it runs within {_RUN_OUT:g} mm, then tighten"
)


def _screwed_into(back_clearance_mm: Numbers) -> str:
    """Return where the screws have their threads: behind the plate that they pass, or in it; '' for arrays."""
    if np.ndim(back_clearance_mm):
        return ""
    through = "through the knee actuator's backplate into the threads in its motor's base"
    into = through if back_clearance_mm else "into the threads in the knee actuator's backplate"
    return f"{into}; tighten with the seat's run-out at {_RUN_OUT:g} mm or less, measured as the thigh swings"

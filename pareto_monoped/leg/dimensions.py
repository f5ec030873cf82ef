"""Dimensions of the links, the foot and the base frame.

The lateral layout, along the joint axes with z = 0 in the middle of the leg (z grows to the robot's right):

    hip actuator | near cheek | inner plate, chain and core, outer plate | knee actuator | far cheek
                              (both shank plates straddle the thigh's knee end)

The hip actuator is bolted to the base's near cheek; its output turns the thigh through a coupling. The knee actuator
is bolted to the thigh's outer plate on the same axis; its output turns a sprocket inside the thigh, and a chain turns
the knee, one to one. The far cheek carries the knee actuator's free end in a bearing. The chain is a roller chain of
ISO 606, chosen by torque.
"""

from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from pareto_monoped.actuator.bearings import small_bearing
from pareto_monoped.actuator.ratiomap import Maps, joint_maps
from pareto_monoped.geometry.shapes import Pattern
from pareto_monoped.leg.actuator_fit import ActuatorFit, actuator_fit

_BEARING_BORE_MM = 20.0  # of knee and base, our own choice: four M4 fit into the axle, cables through the journal
_LOWER_ROD = (32.0 / 68.0, 60.0 / 68.0)  # direction from the hip axis: 28 degrees to either side of upright
_LEAST_ROD_CIRCLE_MM = 70.0  # 0.9 mm from a rod to an ear with the bumper fully squeezed
_UPPER_ROD_X, _UPPER_ROD_RISE = 18.0, 30.0  # from the middle, and above the lower rods
THIGH_HALF_WIDTH_MM = 24.0
"""Of the bar of the thigh's plates, our own layout."""
# Width of the metal beside the windows of these plates: 9 mm for the 44 N m of the VT8020, and in proportion for more.
# The VT8020's chain then limits the jumps before the plates do (``strength.links``).
_THIGH_SIDE_MM, _THIGH_SIDE_N_M = 9.0, 45.0
SAFETY = 5.0
"""Breaking load over the largest pull. Makers ask for 5 to 7 under shocks (DIN 8150), for chains up to 3 m/s."""
# Of the knee motor's peak torque: the chain's largest torque in the stop, Case A (its gearbox: 44 N m).
_STOP_SHARE = 1.8


@dataclass(frozen=True, slots=True, kw_only=True)
class ChainDrive:
    """A roller chain (ISO 606) and its two equal sprockets."""

    name: str  #: number of the chain
    pitch_mm: float  #: between two pins
    roller_mm: float  #: diameter of the rollers
    inner_width_mm: float  #: width between the inner plates
    inner_link_mm: float  #: width over the inner plates
    pin_mm: float  #: length of the pins
    pin_diameter_mm: float
    plate_mm: float  #: height of a plate
    kg_per_m: float  #: mass per length, from makers' catalogues
    breaking_n: float  #: least breaking load
    teeth: int  #: of a sprocket, our own choice
    sprocket_width_mm: float  #: of the teeth, 0.93 of the chain's inner width with h14 (ISO 606), in steps of 0.2 mm

    @property
    def pitch_radius_mm(self) -> float:
        """Radius on which the pins run around a sprocket."""
        return float(0.5 * self.pitch_mm / np.sin(np.pi / self.teeth))

    @property
    def torque_limit_n_m(self) -> float:
        """Largest torque at a sprocket: the chain breaks at ``SAFETY`` times it."""
        return 1e-3 * self.pitch_radius_mm * self.breaking_n / SAFETY

    @property
    def bearing_area_mm2(self) -> float:
        """Of a joint, as ISO 606 counts it: the pin's diameter times the width over the inner plates."""
        return self.pin_diameter_mm * self.inner_link_mm


# Half-inch chains are the strongest for their width that run on a sprocket of this size: 084 breaks at 15.6 kN and fits
# the thigh that 06B-1 with 8.9 kN needed. Pitch and rollers are equal, so that only the sprocket's width differs.
# Fourteen teeth are the fewest at which the links clear the knee's bearing cups.
CHAIN_DRIVES = tuple(
    ChainDrive(name=name, pitch_mm=12.7, roller_mm=7.75, inner_width_mm=inner, inner_link_mm=link, pin_mm=pin,
        pin_diameter_mm=diameter, plate_mm=plate, kg_per_m=mass, breaking_n=breaks, teeth=14, sprocket_width_mm=width)
    for name, inner, link, pin, diameter, plate, mass, breaks, width in (
        ("081", 3.3, 5.8, 10.2, 3.66, 9.91, 0.28, 8000.0, 3.0),
        ("083", 4.88, 7.9, 12.9, 4.09, 10.3, 0.42, 11600.0, 4.4),
        ("084", 4.88, 8.8, 14.8, 4.09, 11.15, 0.59, 15600.0, 4.4),
    )
)  # fmt: skip
"""From the weakest to the strongest."""


def chain_drive_for(knee_torque_n_m: float) -> ChainDrive:
    """Return the smallest drive for the knee's torque with its stop, or the strongest (see ``strength.chain``)."""
    for drive in CHAIN_DRIVES:
        if _STOP_SHARE * knee_torque_n_m <= drive.torque_limit_n_m:
            return drive
    return CHAIN_DRIVES[-1]


@dataclass(frozen=True, slots=True, kw_only=True)
class LegDimensions:
    """Every dimension of links and base that does not follow from the link lengths.

    What must fit the motor has no default: it comes from ``leg_dimensions``. The defaults are our own design, sized so
    that a link weighs what the reference link does.
    """

    hip: ActuatorFit
    knee: ActuatorFit
    chain: ChainDrive  #: the thigh's chain and its sprockets
    bearing_bore_radius_mm: float  #: of the bearings of knee and base
    bearing_outer_radius_mm: float
    bearing_width_mm: float
    bearing_kg: float
    thigh_window_half_width_mm: float

    plate_mm: float = 2.5  #: thickness of the aluminium plates of the thigh
    shank_plate_mm: float = 3.0  #: thickness of the aluminium plates of the shank
    #: Distance between the thigh's plates: both knee bearings and the sprocket between them fit in
    gap_mm: float = 24.0
    play_mm: float = 2.0  #: lateral distance between thigh and shank, for the spacers on the knee's axle
    #: Lateral distance between thigh and base, so that M3 x 16 screws join the thigh to the hip's output
    hip_play_mm: float = 3.0
    #: thigh_half_width_mm, thigh_window_half_width_mm: the bar of the thigh's plates
    thigh_half_width_mm: float = THIGH_HALF_WIDTH_MM
    #: thigh_core_half_width_mm, thigh_core_window_half_width_mm: the thigh's printed core, which is at least 3.4 mm
    #: inside the strands of the chain
    thigh_core_half_width_mm: float = 19.5
    thigh_core_window_half_width_mm: float = 16.0
    knee_radius_mm: float = 35.5  #: of the thigh plates at the knee; covers the chain, which reaches out to 34.1 mm
    shank_top_radius_mm: float = 24.0  #: of the shank's plates
    shank_bottom_radius_mm: float = 18.0
    shank_window_half_width_mm: float = 7.5
    shank_core_half_width_mm: float = 17.0  #: of the shank's printed core
    shank_core_window_half_width_mm: float = 12.5
    #: Free depth of the shank's fork below the knee axis, enough for the thigh at the end of ``stops.knee_stop``
    fork_mm: float = 113.0
    foot_radius_mm: float = 33.0  #: of the rubber ball
    rod_radius_mm: float = 5.0  #: of the base's rods: a common tube, with 3.35 mm of wall around its M4 thread
    cheek_mm: float = 6.0  #: thickness of the base's near cheek
    far_cheek_mm: float = 8.0  #: thickness of the base's far cheek: the bearing's seat and a lip of 1 mm

    @property
    def thigh_face_mm(self) -> float:
        """Height of the thigh plates' outer faces above the middle plane."""
        return 0.5 * self.gap_mm + self.plate_mm

    def of(self, joint: str) -> ActuatorFit:
        """Return what the actuators of ``hip`` or ``knee`` need."""
        return {"hip": self.hip, "knee": self.knee}[joint]

    @property
    def drive_dowel(self) -> Pattern:
        """Holes of the dowels between drive sprocket and the knee's output flange, whose actuator is turned over."""
        holes = self.knee.output_dowel
        return replace(holes, phase_rad=-holes.phase_rad)

    @property
    def rim_radius_mm(self) -> float:
        """Radius of the round plates that carry an actuator's housing, of the wider actuator."""
        return max(self.hip.rim_radius_mm, self.knee.rim_radius_mm)

    @property
    def first_bridge_mm(self) -> float:
        """Distance of the thigh's first bridge from the hip axis: keys for its bolts pass either actuator's case."""
        return max(self.hip.housing_radius_mm, self.knee.housing_radius_mm) + 8.5

    @property
    def rod_circle_mm(self) -> float:
        """Distance of the base's lower rods from the hip axis: clear of the thigh's hip end and ears."""
        return max(self.rim_radius_mm + 15.5, _LEAST_ROD_CIRCLE_MM)

    @property
    def lower_rod_mm(self) -> tuple[float, float]:
        """Place x, y of the base's lower rod on the +x side; the other one is its mirror image."""
        return self.rod_circle_mm * _LOWER_ROD[0], self.rod_circle_mm * _LOWER_ROD[1]

    @property
    def upper_rod_mm(self) -> tuple[float, float]:
        """Place x, y of the base's upper rod on the +x side."""
        return _UPPER_ROD_X, self.lower_rod_mm[1] + _UPPER_ROD_RISE

    @property
    def sprocket_recess_mm(self) -> float:
        """Depth by which screw heads are sunk in a wide sprocket: M3 x 6 then hold it by a grip of 4 mm."""
        return max(0.0, self.chain.sprocket_width_mm - 4.0)

    @property
    def foot_flat_mm(self) -> float:
        """Height above its centre at which the foot is cut flat to sit under the shank: a flat of 0.8 of its width."""
        return 0.6 * self.foot_radius_mm

    @property
    def shank_gap_mm(self) -> float:
        """Distance of the shank's plates, which straddle the thigh."""
        return 2.0 * (self.thigh_face_mm + self.play_mm)

    @property
    def hip_mount_mm(self) -> float:
        """Height z of the near cheek's face that carries the hip actuator, whose output points to +z."""
        return -(self.thigh_face_mm + self.hip_play_mm + self.cheek_mm)

    @property
    def knee_mount_mm(self) -> float:
        """Height z of the thigh's face that carries the knee actuator, whose output points to -z."""
        return self.thigh_face_mm


@lru_cache(maxsize=64)
def leg_dimensions(maps: Maps) -> LegDimensions:
    """Return the leg that fits the motors of both joints.

    Its plates are drilled for their actuators, the chain carries the knee's largest torque, and the wider actuator sets
    the places of the base's rods.

    Raises:
        DesignError: a map has no actuator.
    """
    both = joint_maps(maps)
    return leg_for(actuator_fit(both.hip), actuator_fit(both.knee))


def leg_for(hip: ActuatorFit, knee: ActuatorFit) -> LegDimensions:
    """Return the leg that fits these actuators."""
    bearing = small_bearing(_BEARING_BORE_MM)
    torque_n_m = max(hip.torque_n_m, knee.torque_n_m)  # inner and outer plate have the same windows
    return LegDimensions(
        hip=hip,
        knee=knee,
        chain=chain_drive_for(knee.torque_n_m),
        bearing_bore_radius_mm=0.5 * float(bearing.inner_diameter_mm),
        bearing_outer_radius_mm=0.5 * float(bearing.outer_diameter_mm),
        bearing_width_mm=float(bearing.width_mm),
        bearing_kg=float(bearing.mass_kg),
        thigh_window_half_width_mm=THIGH_HALF_WIDTH_MM - _THIGH_SIDE_MM * max(1.0, torque_n_m / _THIGH_SIDE_N_M),
    )

"""Dimensions of the links, the foot and the base frame.

The lateral layout, along the joint axes with z = 0 in the middle of the leg (z grows to the robot's right):

    hip actuator | near cheek | inner plate, chain and core, outer plate | knee actuator | far cheek
                              (both shank plates straddle the thigh's knee end)

The hip actuator is bolted to the base's near cheek; its output turns the thigh through a coupling. The knee actuator
is bolted to the thigh's outer plate on the same axis; its output turns a sprocket inside the thigh, a chain turns the
knee, one to one. The far cheek carries the knee actuator's free end in a bearing.
"""

import math
from dataclasses import dataclass, replace

CHAIN_SAFETY = 2.0  # our own choice: breaking load over the pull of the largest knee torque of the motor


@dataclass(frozen=True, slots=True, kw_only=True)
class LegDimensions:
    """Every dimension of links and base that does not follow from the link lengths.

    The first block repeats the actuator's interface and is filled from the actuator (``robot.leg_dimensions``), as is
    the chain by its torque; the defaults fit the VT8020.
    The others are our own design, sized so that a link weighs what the reference link does.

    Attributes:
        mount_pitch_radius_mm, mount_holes: bolts between housing and plate (M3).
        housing_radius_mm: of the actuator's case.
        output_pitch_radius_mm, output_holes: bolts between output flange and coupling (M3).
        coupler_radius_mm: of the output flange.
        coupler_height_mm: of the output flange's face above the housing's mounting face.
        coupler_thread_mm: depth of the thread in the output flange.
        mount_thread_mm: depth of the thread in the housing.
        back_pitch_radius_mm, back_holes, back_screw_mm: bolts of the motor's own mounting pattern, at the back, and
            their diameter.
        plate_mm: thickness of the aluminium plates of the thigh.
        shank_plate_mm: thickness of the aluminium plates of the shank.
        gap_mm: distance of the thigh's plates.
        play_mm: lateral distance between thigh and shank.
        hip_play_mm: lateral distance between thigh and base, so that M3 x 16 screws join the thigh to the hip's output.
        chain_name, chain_pitch_mm, chain_roller_mm, chain_inner_width_mm, chain_inner_link_mm, chain_pin_mm,
            chain_pin_diameter_mm, chain_plate_mm, chain_kg_per_m, chain_breaking_n: the chain (ISO 606): pitch, roller
            diameter, width between the inner plates and over them, length and diameter of the pins, height of a plate,
            mass, breaking load.
        sprocket_teeth, sprocket_width_mm: both sprockets (ISO 606: width 0.93 b1).
        bearing_bore_radius_mm, bearing_outer_radius_mm, bearing_width_mm, bearing_kg: 6804, 20 x 32 x 7 mm.
        thigh_half_width_mm, thigh_window_half_width_mm, thigh_core_half_width_mm: the thigh's bar.
        knee_radius_mm: of the thigh plates at the knee; covers the chain.
        shank_top_radius_mm, shank_bottom_radius_mm, shank_window_half_width_mm: the shank's plates.
        shank_core_half_width_mm, shank_core_window_half_width_mm: the shank's printed core.
        fork_mm: free depth of the shank's fork below the knee axis, so that the knee bends to 150 degrees.
        foot_radius_mm: of the rubber ball.
        cheek_mm: thickness of the base's near cheek.
        far_cheek_mm: thickness of the base's far cheek.
    """

    mount_pitch_radius_mm: float = 49.0
    mount_holes: int = 6
    housing_radius_mm: float = 51.5
    output_pitch_radius_mm: float = 12.0
    output_holes: int = 6
    coupler_radius_mm: float = 16.5
    coupler_height_mm: float = 0.0
    coupler_thread_mm: float = 4.5
    mount_thread_mm: float = 4.5
    back_pitch_radius_mm: float = 25.5
    back_holes: int = 4
    back_screw_mm: float = 5.0

    plate_mm: float = 2.5
    shank_plate_mm: float = 3.0
    gap_mm: float = 24.0
    play_mm: float = 2.0
    hip_play_mm: float = 3.0
    chain_name: str = "05B-1"
    chain_pitch_mm: float = 8.0
    chain_roller_mm: float = 5.0
    chain_inner_width_mm: float = 3.0
    chain_inner_link_mm: float = 4.77
    chain_pin_mm: float = 8.6
    chain_pin_diameter_mm: float = 2.31
    chain_plate_mm: float = 7.11
    chain_kg_per_m: float = 0.18
    chain_breaking_n: float = 4400.0
    sprocket_teeth: int = 20
    sprocket_width_mm: float = 2.8
    bearing_bore_radius_mm: float = 10.0
    bearing_outer_radius_mm: float = 16.0
    bearing_width_mm: float = 7.0
    bearing_kg: float = 0.017

    thigh_half_width_mm: float = 24.0
    thigh_window_half_width_mm: float = 16.0
    thigh_core_half_width_mm: float = 19.5
    knee_radius_mm: float = 31.0
    shank_top_radius_mm: float = 24.0
    shank_bottom_radius_mm: float = 18.0
    shank_window_half_width_mm: float = 7.5
    shank_core_half_width_mm: float = 17.0
    shank_core_window_half_width_mm: float = 12.5
    fork_mm: float = 100.0
    foot_radius_mm: float = 33.0
    cheek_mm: float = 6.0
    far_cheek_mm: float = 8.0

    @property
    def thigh_face_mm(self) -> float:
        """Height of the thigh plates' outer faces above the middle plane."""
        return 0.5 * self.gap_mm + self.plate_mm

    @property
    def rim_radius_mm(self) -> float:
        """Of the round plates that carry an actuator's housing."""
        return self.mount_pitch_radius_mm + 6.0

    @property
    def first_bridge_mm(self) -> float:
        """Distance of the thigh's first bridge from the hip axis, clear of the actuator's case."""
        return self.housing_radius_mm + 8.5

    @property
    def rod_circle_mm(self) -> float:
        """Distance of the base's lower rods from the hip axis, 8 mm clear of the thigh's round hip end."""
        return self.rim_radius_mm + 13.0

    @property
    def chain_torque_limit_n_m(self) -> float:
        """Largest torque at the sprocket: the chain breaks at ``CHAIN_SAFETY`` times it."""
        pitch_radius_mm = 0.5 * self.chain_pitch_mm / math.sin(math.pi / self.sprocket_teeth)
        return 1e-3 * pitch_radius_mm * self.chain_breaking_n / CHAIN_SAFETY

    @property
    def sprocket_recess_mm(self) -> float:
        """How deep the screws' heads are sunk in a sprocket, so that M3 x 6 hold a wide one too."""
        return max(0.0, self.sprocket_width_mm - 4.05)

    @property
    def foot_flat_mm(self) -> float:
        """Height above its centre at which the foot is cut flat to sit under the shank."""
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


DEFAULT = LegDimensions()
"""Dimensions that fit the default motor."""


def with_chain_for(d: LegDimensions, knee_torque_n_m: float) -> LegDimensions:
    """The same leg with the smallest chain that carries a torque; with the largest one if none does.

    05B-1 with 20 teeth, or 06B-1 with 17, whose pitch circle is 0.7 mm larger, so that it fits the same plates (both:
    ISO 606; mass from makers' catalogues).
    """
    if knee_torque_n_m <= d.chain_torque_limit_n_m:
        return d
    return replace(
        d,
        chain_name="06B-1",
        chain_pitch_mm=9.525,
        chain_roller_mm=6.35,
        chain_inner_width_mm=5.72,
        chain_inner_link_mm=8.53,
        chain_pin_mm=13.5,
        chain_pin_diameter_mm=3.28,
        chain_plate_mm=8.26,
        chain_kg_per_m=0.41,
        chain_breaking_n=8900.0,
        sprocket_teeth=17,
        sprocket_width_mm=5.3,
    )


HIP_RANGE_RAD = (-1.92, 1.92)
"""Working range of the hip, 110 degrees to both sides of hanging straight down; checked on every exported leg."""
KNEE_RANGE_RAD = (-2.62, 2.62)
"""Working range of the knee, 150 degrees of flexion to both sides; checked on every exported leg."""

"""The chain drives that fit the thigh: roller chains of ISO 606 with their sprockets, and the choice by torque."""

from dataclasses import dataclass

import numpy as np

SAFETY = 2.0  # our own choice: breaking load over the pull at the largest knee torque of the motor


@dataclass(frozen=True, slots=True, kw_only=True)
class ChainDrive:
    """A roller chain (ISO 606) and its two equal sprockets.

    Attributes:
        name: number of the chain.
        pitch_mm: between two pins.
        roller_mm: diameter of the rollers.
        inner_width_mm: width between the inner plates.
        inner_link_mm: width over the inner plates.
        pin_mm, pin_diameter_mm: length and diameter of the pins.
        plate_mm: height of a plate.
        kg_per_m: mass per length, from makers' catalogues.
        breaking_n: least breaking load.
        teeth: of a sprocket, our own choice.
        sprocket_width_mm: of the teeth, 0.93 of the chain's inner width.
    """

    name: str
    pitch_mm: float
    roller_mm: float
    inner_width_mm: float
    inner_link_mm: float
    pin_mm: float
    pin_diameter_mm: float
    plate_mm: float
    kg_per_m: float
    breaking_n: float
    teeth: int
    sprocket_width_mm: float

    @property
    def pitch_radius_mm(self) -> float:
        """Radius on which the pins run around a sprocket."""
        return float(0.5 * self.pitch_mm / np.sin(np.pi / self.teeth))

    @property
    def torque_limit_n_m(self) -> float:
        """Largest torque at a sprocket: the chain breaks at ``SAFETY`` times it."""
        return 1e-3 * self.pitch_radius_mm * self.breaking_n / SAFETY


CHAIN_DRIVES = (
    ChainDrive(
        name="05B-1",
        pitch_mm=8.0,
        roller_mm=5.0,
        inner_width_mm=3.0,
        inner_link_mm=4.77,
        pin_mm=8.6,
        pin_diameter_mm=2.31,
        plate_mm=7.11,
        kg_per_m=0.18,
        breaking_n=4400.0,
        teeth=20,
        sprocket_width_mm=2.8,
    ),
    ChainDrive(
        name="06B-1",
        pitch_mm=9.525,
        roller_mm=6.35,
        inner_width_mm=5.72,
        inner_link_mm=8.53,
        pin_mm=13.5,
        pin_diameter_mm=3.28,
        plate_mm=8.26,
        kg_per_m=0.41,
        breaking_n=8900.0,
        teeth=17,  # a pitch circle 0.7 mm larger than that of 05B-1, so that it fits the same plates
        sprocket_width_mm=5.3,
    ),
)
"""From the weakest to the strongest."""


def chain_drive_for(knee_torque_n_m: float) -> ChainDrive:
    """The smallest chain drive that carries a torque; the strongest one if none does, which an export then refuses."""
    for drive in CHAIN_DRIVES:
        if knee_torque_n_m <= drive.torque_limit_n_m:
            return drive
    return CHAIN_DRIVES[-1]

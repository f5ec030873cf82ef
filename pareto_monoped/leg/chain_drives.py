"""The chain drives that fit the thigh: roller chains of ISO 606 with their sprockets, and the choice by torque."""

from dataclasses import dataclass

import numpy as np

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

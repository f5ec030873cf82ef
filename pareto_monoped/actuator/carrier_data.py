"""Settings of carriers and planet bearings under ``iso6336``; values and sources in ``data/actuator_parts.toml``."""

from dataclasses import dataclass
from typing import Annotated, Literal

from pydantic import ConfigDict, Field

Positive = Annotated[float, Field(gt=0.0, allow_inf_nan=False)]
_STRICT = ConfigDict(extra="forbid")

SecondCarrier = Literal["pins", "webs"]
PlanetBearing = Literal["bushes", "needles"]


@dataclass(frozen=True, slots=True, kw_only=True)
class WebData:
    """Webs between the planets, in one piece with the carrier, to which the second carrier is screwed.

    Attributes:
        clearance_mm: to the tips of planets and ring.
        depth_mm: largest radial extent.
        overhang_mm: how far they may reach beyond the metal around the pins.
        screw_wall_mm: least metal around the tapping hole of the screw.
        neck_mm: least half width.
    """

    __pydantic_config__ = _STRICT

    clearance_mm: Positive
    depth_mm: Positive
    overhang_mm: Annotated[float, Field(ge=0.0)]
    screw_wall_mm: Positive
    neck_mm: Positive


@dataclass(frozen=True, slots=True, kw_only=True)
class NeedleData:
    """Rows of loose needle rollers between pin and planet, and the washers beside the planet.

    Attributes:
        diameter_mm: of a needle.
        lengths_mm: to choose from, increasing; a planet takes one row, or two of the same length.
        end_mm: what a rounded end takes from the length that carries, at either end.
        washer_mm, washer_diameter_mm: thickness and diameter of a washer, between planet and carrier.
        washer_play_mm: axial play of the planet at either washer.
        friction_coefficient: at the radius of the pin.
    """

    __pydantic_config__ = _STRICT

    diameter_mm: Positive
    lengths_mm: tuple[Positive, ...]
    end_mm: Positive
    washer_mm: Positive
    washer_diameter_mm: Positive
    washer_play_mm: Positive
    friction_coefficient: Positive

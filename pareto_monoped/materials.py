"""Every material of the robot; the values and their sources stand in ``data/materials.toml``."""

from dataclasses import dataclass
from importlib import resources
from typing import Annotated

from pydantic import ConfigDict, Field

from pareto_monoped.config import checked, read_toml

Positive = Annotated[float, Field(gt=0.0, allow_inf_nan=False)]
Share = Annotated[float, Field(ge=0.0, le=1.0)]
_STRICT = ConfigDict(extra="forbid")


@dataclass(frozen=True, slots=True, kw_only=True)
class Material:
    """A material.

    Attributes:
        name: in words, as it stands in parts lists.
        density_kg_per_m3: mass over volume.
        colour: in CAD and report: red, green, blue from 0 to 1.
    """

    __pydantic_config__ = _STRICT

    name: str
    density_kg_per_m3: Positive
    colour: tuple[Share, Share, Share]


@dataclass(frozen=True, slots=True, kw_only=True)
class GearMaterial(Material):
    """A material for gears.

    Attributes:
        allowable_stress_mpa: in bending at the root of a tooth.
        mesh_friction_coefficient: of two flanks of this material, lubricated.
    """

    allowable_stress_mpa: Positive
    mesh_friction_coefficient: Positive


@dataclass(frozen=True, slots=True, kw_only=True)
class Materials:
    """All materials: one table of ``data/materials.toml`` each."""

    __pydantic_config__ = _STRICT

    aluminium: Material
    steel: Material
    gear_steel: GearMaterial
    bearing_steel: Material
    bush_bronze: Material
    motor_stator: Material
    motor_rotor: Material
    printed_plastic: Material
    rubber: Material


def _shipped() -> Materials:
    with resources.as_file(resources.files("pareto_monoped") / "data" / "materials.toml") as path:
        tables = read_toml(path, what="materials")
    named = {key: {"name": key.replace("_", " ")} | table for key, table in tables.items()}
    return checked(Materials, named, source="materials")


MATERIALS = _shipped()
"""The materials that ship with the package."""

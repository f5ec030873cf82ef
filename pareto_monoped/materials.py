"""Every material of the robot; the values and their sources stand in ``data/materials.toml``."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from types import MappingProxyType
from typing import Annotated, Any, Literal

from pydantic import ConfigDict, Field

from pareto_monoped.config import checked, read_shipped

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
class ElasticMaterial(Material):
    """A material whose parts give way under load.

    Attributes:
        youngs_modulus_mpa, poisson_ratio: of elasticity.
    """

    youngs_modulus_mpa: Positive
    poisson_ratio: Annotated[float, Field(gt=0.0, lt=0.5)]

    @property
    def shear_modulus_mpa(self) -> float:
        """Of an isotropic material."""
        return 0.5 * self.youngs_modulus_mpa / (1.0 + self.poisson_ratio)


@dataclass(frozen=True, slots=True, kw_only=True)
class BushMaterial(Material):
    """A material for plain bushes.

    Attributes:
        friction_coefficient: of a hardened pin in a greased bush.
        pv_limit_mpa_m_per_s, pv_short_limit_mpa_m_per_s: largest pressure times sliding speed, for good and for short
            periods.
    """

    friction_coefficient: Positive
    pv_limit_mpa_m_per_s: Positive
    pv_short_limit_mpa_m_per_s: Positive


@dataclass(frozen=True, slots=True, kw_only=True)
class GearMaterial(ElasticMaterial):
    """A material for gears.

    Attributes:
        allowable_stress_mpa: in bending at the root of a tooth.
        mesh_friction_coefficient: of two flanks of this material, lubricated.
    """

    allowable_stress_mpa: Positive
    mesh_friction_coefficient: Positive


@dataclass(frozen=True, slots=True, kw_only=True)
class Alloy:
    """An alloy in one condition, as it is ordered.

    Attributes:
        name: designation and condition, as they stand in parts lists and on drawings.
        hardness: in words, with its scale.
        yield_mpa: 0.2 % proof stress, the least that the standard of the semi-finished product allows.
    """

    __pydantic_config__ = _STRICT

    name: str
    hardness: str
    yield_mpa: Positive


Treatment = Literal["case_hardened", "nitrided", "through_hardened"]


@dataclass(frozen=True, slots=True, kw_only=True)
class GearGrade:
    """A steel grade in one heat treatment, as ISO 6336-5 rates it.

    Attributes:
        name: steel and treatment in words, as it stands in parts lists.
        treatment: which S-N curves and notch factors apply.
        quality: quality grade of material and treatment.
        hardness_hv: Vickers hardness of the flank.
        hardness: limits of the flank's hardness in words, with their scale.
        core_hardness: likewise of the core.
        making: steps by which teeth are made, in their order.
        layer_modules: limits of the depth of case or nitriding layer in finished teeth, in modules; None without one.
        flank_limit_mpa: allowable contact stress number sigma_H,lim.
        root_limit_mpa: nominal bending stress number sigma_F,lim of the standard test gear.
        yield_mpa: 0.2 % proof stress of the core.
        slip_layer_mm: thickness rho' of the slip layer.
    """

    __pydantic_config__ = _STRICT

    name: str
    treatment: Treatment
    quality: Literal["ML", "MQ", "ME"]
    hardness_hv: Positive
    hardness: str
    core_hardness: str
    making: str
    flank_limit_mpa: Positive
    root_limit_mpa: Positive
    yield_mpa: Positive
    slip_layer_mm: Positive
    layer_modules: tuple[Positive, Positive] | None = None

    @property
    def layer(self) -> str:
        """Which depth ``layer_modules`` means: to 550 HV, or to 50 HV above the core (ISO 18203)."""
        return {"case_hardened": "CHD", "nitrided": "NHD", "through_hardened": ""}[self.treatment]


@dataclass(frozen=True, slots=True, kw_only=True)
class Elastomer(Material):
    """A rubber that absorbs impacts.

    Attributes:
        hardness_shore_a: of the grade.
        youngs_modulus_mpa: at small strain.
        rebound_resilience: share of the energy of an impact that comes back (ISO 4662, 23 degrees Celsius).
    """

    hardness_shore_a: Annotated[float, Field(ge=30.0, le=95.0)]
    youngs_modulus_mpa: Positive
    rebound_resilience: Annotated[float, Field(gt=0.0, lt=1.0)]


@dataclass(frozen=True, slots=True, kw_only=True)
class Materials:
    """All materials: one table of ``data/materials.toml`` each."""

    __pydantic_config__ = _STRICT

    aluminium: ElasticMaterial
    steel: ElasticMaterial
    gear_steel: GearMaterial
    bearing_steel: Material
    bush_bronze: BushMaterial
    motor_stator: Material
    motor_rotor: Material
    printed_plastic: Material
    magnet: Material
    electronics: Material
    rubber: Material
    fluoroelastomer: Elastomer


_GRADES, _ALLOYS = "gear_grades", "alloys"
"""The tables of the file whose own tables are no materials, but grades of gear steel and alloys."""


@lru_cache(maxsize=1)
def _file() -> dict[str, Any]:
    return read_shipped("materials.toml", what="materials")


def _shipped() -> Materials:
    named = {
        key: {"name": key.replace("_", " ")} | table for key, table in _file().items() if key not in (_GRADES, _ALLOYS)
    }
    return checked(Materials, named, source="materials")


def _shipped_grades() -> Mapping[str, GearGrade]:
    tables = _file()[_GRADES]
    grades = {key: checked(GearGrade, table, source=f"materials: {_GRADES}.{key}") for key, table in tables.items()}
    return MappingProxyType(grades)


def _shipped_alloys() -> Mapping[str, Alloy]:
    tables = _file()[_ALLOYS]
    alloys = {key: checked(Alloy, table, source=f"materials: {_ALLOYS}.{key}") for key, table in tables.items()}
    return MappingProxyType(alloys)


MATERIALS = _shipped()
"""The materials that ship with the package."""
ALLOYS = _shipped_alloys()
"""The alloys that ship with the package, by the names that the parts use."""
GEAR_GRADES = _shipped_grades()
"""The steel grades that ship with the package, by the names that the settings use."""

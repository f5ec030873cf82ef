"""Every material of the robot; the values and their sources stand in ``data/materials.toml``."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from types import MappingProxyType
from typing import Annotated, Any, Literal, TypeVar

from pydantic import Field

from pareto_monoped.config import Positive, Strict, checked, read_shipped

T = TypeVar("T")
Share = Annotated[float, Field(ge=0.0, le=1.0)]


@dataclass(frozen=True, slots=True, kw_only=True)
class Material(Strict):
    """A material."""

    name: str  #: in words, as it stands in parts lists
    density_kg_per_m3: Positive  #: mass over volume
    colour: tuple[Share, Share, Share]  #: in CAD and report: red, green, blue from 0 to 1


@dataclass(frozen=True, slots=True, kw_only=True)
class ElasticMaterial(Material):
    """A material whose parts give way under load."""

    #: youngs_modulus_mpa, poisson_ratio: of elasticity
    youngs_modulus_mpa: Positive
    poisson_ratio: Annotated[float, Field(gt=0.0, lt=0.5)]

    @property
    def shear_modulus_mpa(self) -> float:
        """Of an isotropic material."""
        return 0.5 * self.youngs_modulus_mpa / (1.0 + self.poisson_ratio)


@dataclass(frozen=True, slots=True, kw_only=True)
class BushMaterial(Material):
    """A material for plain bushes."""

    friction_coefficient: Positive  #: of a hardened pin in a greased bush
    #: pv_limit_mpa_m_per_s, pv_short_limit_mpa_m_per_s: largest pressure times sliding speed, for good and for short
    #: periods
    pv_limit_mpa_m_per_s: Positive
    pv_short_limit_mpa_m_per_s: Positive


@dataclass(frozen=True, slots=True, kw_only=True)
class GearMaterial(ElasticMaterial):
    """A material for gears."""

    allowable_stress_mpa: Positive  #: in bending at the root of a tooth
    mesh_friction_coefficient: Positive  #: of two flanks of this material, lubricated


@dataclass(frozen=True, slots=True, kw_only=True)
class Alloy(Strict):
    """An alloy in one condition, as it is ordered."""

    name: str  #: designation and condition, as they stand in parts lists and on drawings
    hardness: str  #: in words, with its scale
    yield_mpa: Positive  #: 0.2 % proof stress, the least that the standard of the semi-finished product allows


Treatment = Literal["case_hardened", "nitrided", "through_hardened"]


@dataclass(frozen=True, slots=True, kw_only=True)
class GearGrade(Strict):
    """A steel grade in one heat treatment, as ISO 6336-5 rates it."""

    name: str  #: steel and treatment in words, as it stands in parts lists
    treatment: Treatment  #: which S-N curves and notch factors apply
    quality: Literal["ML", "MQ", "ME"]  #: quality grade of material and treatment
    hardness_hv: Positive  #: Vickers hardness of the flank
    hardness: str  #: limits of the flank's hardness in words, with their scale
    core_hardness: str  #: likewise of the core
    making: str  #: steps by which teeth are made, in their order
    flank_limit_mpa: Positive  #: allowable contact stress number sigma_H,lim
    root_limit_mpa: Positive  #: nominal bending stress number sigma_F,lim of the standard test gear
    yield_mpa: Positive  #: 0.2 % proof stress of the core
    slip_layer_mm: Positive  #: thickness rho' of the slip layer
    #: Limits of the depth of case or nitriding layer in finished teeth, in modules; None without one
    layer_modules: tuple[Positive, Positive] | None = None

    @property
    def layer(self) -> str:
        """Which depth ``layer_modules`` means: to 550 HV, or to 50 HV above the core (ISO 18203)."""
        return {"case_hardened": "CHD", "nitrided": "NHD", "through_hardened": ""}[self.treatment]


@dataclass(frozen=True, slots=True, kw_only=True)
class Elastomer(Material):
    """A rubber that absorbs impacts."""

    hardness_shore_a: Annotated[float, Field(ge=30.0, le=95.0)]  #: of the grade
    youngs_modulus_mpa: Positive  #: at small strain
    #: Share of the energy of an impact that comes back (ISO 4662, 23 degrees Celsius)
    rebound_resilience: Annotated[float, Field(gt=0.0, lt=1.0)]


@dataclass(frozen=True, slots=True, kw_only=True)
class Materials(Strict):
    """All materials: one table of ``data/materials.toml`` each."""

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


_GRADES, _ALLOYS = "gear_grades", "alloys"  #: Tables of the file whose own tables are gear steels and alloys.


@lru_cache(maxsize=1)
def _file() -> dict[str, Any]:
    return read_shipped("materials.toml", what="materials")


def _shipped() -> Materials:
    named = {
        key: {"name": key.replace("_", " ")} | table for key, table in _file().items() if key not in (_GRADES, _ALLOYS)
    }
    return checked(Materials, named, source="materials")


def _shipped_tables(kind: type[T], name: str) -> Mapping[str, T]:
    tables = _file()[name].items()
    return MappingProxyType({key: checked(kind, table, source=f"materials: {name}.{key}") for key, table in tables})


MATERIALS = _shipped()  #: The materials that ship with the package.
ALLOYS = _shipped_tables(Alloy, _ALLOYS)  #: The alloys that ship with the package, by the names that the parts use.
GEAR_GRADES = _shipped_tables(
    GearGrade, _GRADES
)  #: The steel grades that ship with the package, by the names that the settings use.

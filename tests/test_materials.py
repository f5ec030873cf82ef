"""Every material stands in one place, with its source, and the parts are made of these."""

import ast
import dataclasses
from pathlib import Path

import pytest

from pareto_monoped.actuator.search import map_for
from pareto_monoped.design import PAPER_CASES, RULE_SETS
from pareto_monoped.errors import InputError
from pareto_monoped.materials import MATERIALS, GearMaterial, Materials
from pareto_monoped.robot.build import build_robot

PACKAGE = Path(__file__).parent.parent / "pareto_monoped"
ALL = [getattr(MATERIALS, field.name) for field in dataclasses.fields(Materials)]


def test_values_are_the_published_ones():
    """Densities of the authors' part data; a case by hand: 7850 kg/m3 steel, 2710 kg/m3 aluminium."""
    assert (MATERIALS.aluminium.density_kg_per_m3, MATERIALS.steel.density_kg_per_m3) == (2710.0, 7850.0)
    assert MATERIALS.printed_plastic.density_kg_per_m3 == 1430.0
    assert MATERIALS.rubber.density_kg_per_m3 == 1150.0
    assert isinstance(MATERIALS.gear_steel, GearMaterial)
    assert MATERIALS.gear_steel.allowable_stress_mpa == 400.0
    assert MATERIALS.gear_steel.mesh_friction_coefficient == 0.1


def test_densities_of_our_own_choice_are_those_that_their_sources_give():
    assert MATERIALS.bearing_steel.density_kg_per_m3 == 7800.0  # 100Cr6
    assert MATERIALS.bush_bronze.density_kg_per_m3 == 7600.0  # steel back, bronze and PTFE
    # Those of version 0.1.0, which drop out: laminations fill 60 percent of the stator, a rotor is as dense as magnet.
    assert MATERIALS.motor_stator.density_kg_per_m3 == pytest.approx(0.6 * 7800.0)
    assert MATERIALS.motor_rotor.density_kg_per_m3 == 7500.0
    assert MATERIALS.gear_steel.density_kg_per_m3 == MATERIALS.steel.density_kg_per_m3


def test_stiffness_and_friction_are_those_of_their_sources():
    """ISO 6336-2 for steel, EN 1999-1-1 for aluminium, a maker's table for PTFE bronze; G by hand."""
    for steel in (MATERIALS.steel, MATERIALS.gear_steel):
        assert (steel.youngs_modulus_mpa, steel.poisson_ratio) == (206e3, 0.3)
        assert steel.shear_modulus_mpa == pytest.approx(79_231.0, abs=1.0)
    assert MATERIALS.aluminium.shear_modulus_mpa == pytest.approx(26_316.0, abs=1.0)
    bronze = MATERIALS.bush_bronze
    assert 0.05 < bronze.friction_coefficient < 0.10
    assert (bronze.pv_limit_mpa_m_per_s, bronze.pv_short_limit_mpa_m_per_s) == (1.8, 3.6)


def test_names_are_unique_and_in_words():
    names = [material.name for material in ALL]
    assert len(set(names)) == len(names)
    assert "printed plastic" in names


def test_every_part_is_of_one_of_these_materials_and_each_is_used():
    """Bushes are in the gearboxes of the paper's rules alone."""
    design = PAPER_CASES["A"].design
    robots = [build_robot(design, map_for("VT8020", rules)) for rules in RULE_SETS]
    assert {part.material for robot in robots for unit in robot.units for part in unit.parts} == set(ALL)


def test_every_value_has_its_source_beside_it():
    lines = (PACKAGE / "data" / "materials.toml").read_text().splitlines()
    for above, line in zip(["", *lines], lines, strict=False):
        if "=" in line and not line.startswith(("#", "colour")):
            assert "#" in line or above.startswith("#"), line


@pytest.mark.parametrize("path", sorted(PACKAGE.rglob("*.py")), ids=lambda p: str(p.relative_to(PACKAGE)))
def test_no_module_repeats_a_density(path):
    densities = {material.density_kg_per_m3 for material in ALL}
    densities |= {1e-3 * density for density in densities if density != 7500.0}  # in g/cm3; 7.5 may be anything
    found = {node.value for node in ast.walk(ast.parse(path.read_text())) if isinstance(node, ast.Constant)}
    assert not densities & {value for value in found if isinstance(value, float | int)}


def test_a_material_without_a_density_is_refused():
    from pareto_monoped.config import checked

    with pytest.raises(InputError, match=r"materials: rubber.density_kg_per_m3 = -1.0"):
        checked(
            Materials,
            dataclasses.asdict(MATERIALS)
            | {"rubber": {"name": "rubber", "density_kg_per_m3": -1.0, "colour": (0, 0, 0)}},
            source="materials",
        )

"""The same design gives the same bytes in any process, whatever that process has made before."""

import dataclasses
import subprocess
import sys
from pathlib import Path

import pytest

from pareto_monoped.cad.product import build_product, step_assembly
from pareto_monoped.geometry.roles import Role
from tests.lazily import Lazily

process = Lazily("pareto_monoped.cad.kernel.process")
solids = Lazily("pareto_monoped.cad.kernel.solids")

_EXPORTS = """
import sys
from pathlib import Path
from pareto_monoped.actuator.search import map_for
from pareto_monoped.cad.export import export_design
from pareto_monoped.design import PAPER_CASES
from pareto_monoped.jump.calibration import load_calibration

for case in sys.argv[2:]:
    export_design(PAPER_CASES[case].design, map_for("VT8020"), load_calibration(), Path(sys.argv[1]) / case)
"""


def exports(place, *cases):
    subprocess.run([sys.executable, "-c", _EXPORTS, str(place), *cases], check=True, cwd=Path(__file__).parents[2])
    folder = place / cases[-1]
    return {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


@pytest.mark.long
def test_step_files_of_both_actuators_come_out_the_same_twice(product):
    # An ISSPG and an ESSPG: gears have the most faces, whose order must not change. Most else is left out for time.
    units = tuple(
        dataclasses.replace(unit, parts=tuple(part for part in unit.parts if part.role in (Role.GEAR, Role.CARRIER)))
        for unit in product.robot.units
        if unit.name.endswith("_actuator")
    )
    actuators = build_product(dataclasses.replace(product.robot, units=units), product.pose)
    assembly = step_assembly(actuators, "monoped")
    one = process.step_files(assembly)
    solids.solid_from.cache_clear()
    process._part_file.cache_clear()
    assert process.step_files(assembly) == one


@pytest.mark.long
def test_every_file_is_the_same_in_another_process_after_another_design(tmp_path):
    # Case A has both families of actuators, and shares parts with the nominal design.
    one, two = exports(tmp_path / "one", "A"), exports(tmp_path / "two", "nominal", "A")
    assert sorted(one) == sorted(two)
    assert {name for name in one if one[name] != two[name]} == set()
    assert {"assembly.step", "assembly.png", "assembly.glb", "model/monoped.xml"} <= set(one)

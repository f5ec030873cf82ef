"""The assembly's STEP file, put together from the parts' files, against the file that the kernel writes of all solids.

The kernel's own file is the oracle: entity by entity, with white space and the units' uncertainties left out.
"""

import re

import numpy as np
import pytest

from pareto_monoped.cad.assembly import shift, turn_z
from pareto_monoped.cad.kernel.client import StepAssembly, StepPlacement
from pareto_monoped.geometry.parts import Part, Prism
from pareto_monoped.geometry.roles import Role
from pareto_monoped.geometry.shapes import Circle, Pattern
from pareto_monoped.materials import Material
from tests.lazily import Lazily

kernel = Lazily("pareto_monoped.cad.kernel.solids")
step = Lazily("pareto_monoped.cad.kernel.step")

STEEL = Material(name="steel", density_kg_per_m3=7850.0, colour=(0.5, 0.5, 0.5))
ALUMINIUM = Material(name="aluminium", density_kg_per_m3=2700.0, colour=(0.75, 0.8, 0.85))
_STYLE = re.compile(
    rb"#\d+=(MECHANICAL_DESIGN|STYLED|PRESENTATION_STYLE|SURFACE_S|FILL_AREA|COLOUR_RGB|PROPERTY_D|REPRESENTATION|"
    rb"DESCRIPTIVE_R|MEASURE_R|DERIVED_UNIT|\(MASS_UNIT|\(LENGTH_UNIT\(\)NAMED_UNIT\(\*\)SI_UNIT\(.CENTI)"
)


def disc(name, material, *holes, radius_mm=10.0):
    prism = Prism(outline=Circle(radius_mm=radius_mm), z0_mm=0.0, z1_mm=3.0, holes=holes)
    return Part(name=name, role=Role.PLATE, material=material, prisms=(prism,), process="machined")


@pytest.fixture(scope="module")
def assembly():
    """Two units: one shares a part with the other, one part has two bodies, and two parts have one geometry."""
    pads = Prism(outline=Pattern(radius_mm=2.0, pitch_radius_mm=8.0, count=2), z0_mm=0.0, z1_mm=1.0)
    parts = {
        "plate": disc("plate", ALUMINIUM, Circle(radius_mm=3.0), Pattern(radius_mm=1.0, pitch_radius_mm=7.0, count=6)),
        "bolt": disc("bolt", STEEL, radius_mm=1.0),
        "washer": disc("washer", STEEL, Circle(radius_mm=1.5)),
        "shim": disc("shim", ALUMINIUM, Circle(radius_mm=1.5)),
        "pads": Part(name="pads", role=Role.PLATE, material=STEEL, prisms=(pads,), process="machined"),
    }
    at = [StepPlacement(part="bolt", matrix=turn_z(k) @ shift(7.0, 0.0, 1.5)) for k in range(6)]
    one = (StepPlacement(part="plate", matrix=np.eye(4)), *at, StepPlacement(part="washer", matrix=shift(0, 0, 5)))
    two = (StepPlacement(part="shim", matrix=shift(0, 0, 9)), at[0], StepPlacement(part="pads", matrix=np.eye(4)))
    return StepAssembly(name="all", parts=parts, units={"one": one, "two": two})


@pytest.fixture(scope="module")
def solids(assembly):
    from OCP.BRepBuilderAPI import BRepBuilderAPI_Copy

    return {name: BRepBuilderAPI_Copy(kernel.solid_of(part)).Shape() for name, part in assembly.parts.items()}


@pytest.fixture(scope="module")
def parts(assembly):
    return {
        name: step.part_step(kernel.solid_of(part), name, step.Substance.of(part))
        for name, part in assembly.parts.items()
    }


def entities(text):
    """The entities of a file without white space, colours and materials, one uncertainty for all of an assembly."""
    lines = re.sub(rb"\s+", b"", text.partition(b"DATA;")[2]).split(b";")
    lines = [re.sub(rb"(LENGTH_MEASURE\()[^)]*", rb"\1", line) for line in lines]
    return [line for line in lines if not _STYLE.match(line)]


def written(assembly, parts, solids):
    return step.assembly_step(assembly, parts, {"pads": solids["pads"]})


def test_it_has_the_entities_that_the_kernel_writes_of_all_solids(assembly, parts, solids):
    assert entities(written(assembly, parts, solids)) == entities(step.tree_step(assembly, solids))


def test_the_time_in_a_file_is_not_that_at_which_it_was_written(assembly, parts, solids):
    """Two exports of one design have the same bytes, however far apart they are made."""
    for text in (parts["plate"], written(assembly, parts, solids)):
        assert re.search(rb"FILE_NAME\('[^']*',\s*'([^']*)'", text)[1].decode() == step.TIMESTAMP.isoformat()


def test_every_part_keeps_the_uncertainty_of_its_own_file(assembly, parts, solids):
    # A part's tolerance is that of its solid, not that of its stand-in.
    rough = parts | {"plate": parts["plate"].replace(b"LENGTH_MEASURE(1.E-07)", b"LENGTH_MEASURE(3.E-05)")}
    assert rough["plate"] != parts["plate"]
    assert written(assembly, rough, solids).count(b"LENGTH_MEASURE(3.E-05)") == 1


def test_colours_are_those_of_the_parts(assembly, parts, solids):
    text = written(assembly, parts, solids)
    found = {}
    colours = dict(re.findall(rb"#(\d+) = COLOUR_RGB\('',([^)]*)\);", text))
    styled = re.findall(rb"#(\d+) = STYLED_ITEM\('color',\(#\d+\),#(\d+)\);", text)
    for shape in step.shapes_in(text):
        (style,) = (int(item) for item, solid in styled if int(solid) == shape.solid)
        found[shape.name] = tuple(float(v) for v in colours[b"%d" % (style + 7)].split(b","))
    # What has several bodies is no solid, and has no colour.
    assert found == {name: part.material.colour for name, part in assembly.parts.items() if name != "pads"}


def test_materials_and_densities_are_read_by_the_kernel_as_those_of_the_parts(assembly, parts, solids, tmp_path):
    """In a file of schema AP242; what has several bodies is no solid, and has no material."""
    from OCP.collections import Sequence_TDF_Label
    from OCP.STEPCAFControl import STEPCAFControl_Reader
    from OCP.TCollection import TCollection_ExtendedString
    from OCP.TDataStd import TDataStd_Name
    from OCP.TDocStd import TDocStd_Document
    from OCP.XCAFApp import XCAFApp_Application
    from OCP.XCAFDoc import XCAFDoc_DocumentTool, XCAFDoc_MaterialTool

    text = written(assembly, parts, solids)
    assert b"FILE_SCHEMA(('AP242_MANAGED_MODEL_BASED_3D_ENGINEERING_MIM_LF" in re.sub(rb"\s", b"", text)
    assert b"AP242" in parts["plate"]
    (tmp_path / "all.step").write_bytes(text)
    document = TDocStd_Document(TCollection_ExtendedString("MDTV-XCAF"))
    XCAFApp_Application.GetApplication_s().InitDocument(document)
    reader = STEPCAFControl_Reader()
    reader.SetMatMode(True)
    reader.ReadFile(str(tmp_path / "all.step"))
    assert reader.Transfer(document)
    labels, found = Sequence_TDF_Label(), {}
    XCAFDoc_DocumentTool.ShapeTool_s(document.Main()).GetShapes(labels)
    for label in (labels.Value(k) for k in range(1, labels.Length() + 1)):
        name = TDataStd_Name()
        label.FindAttribute(TDataStd_Name.GetID_s(), name)
        found[name.Get().ToExtString()] = XCAFDoc_MaterialTool.GetDensityForShape_s(label)
    made = {name: part.material for name, part in assembly.parts.items() if name != "pads"}
    expected = {name: material.density_kg_per_m3 * 1e-6 for name, material in made.items()}
    assert {name: found[name] for name in expected} == pytest.approx(expected)  # grams per cubic millimetre
    # Grams per cubic centimetre; the kernel reads and ignores this.
    powers = re.findall(rb"DERIVED_UNIT_ELEMENT\(#\d+,(-?\d)\.\)", text)
    assert powers == [b"1", b"-3"] * len(made)
    names = re.findall(rb"DESCRIPTIVE_REPRESENTATION_ITEM\('([^']*)','([^']*)'\)", text)
    assert sorted(names) == sorted((material.name.encode(), b"") for material in made.values())


def test_a_file_of_another_part_is_refused(assembly, parts, solids):
    with pytest.raises(ValueError, match="STEP file of plate: is laid out in an unknown way"):
        step.spliced(step.tree_step(assembly, solids), parts | {"plate": parts["bolt"]})

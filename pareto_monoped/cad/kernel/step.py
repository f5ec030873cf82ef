"""STEP files (AP242) with names, colours and materials; the time stamp is fixed: the same robot gives the same bytes.

The kernel writes geometry and names. It would write colours in an order that changes from run to run, so the styles
(ISO 10303-46) are added here, and so are materials with their densities (ISO 10303-45), whose units it gets wrong. Each
solid is written once, and the file of the assembly is made from those of its parts:

The kernel writes the assembly with stand-ins, one small solid per part. In a STEP file, a part's shape is a run of
consecutive entities: its representation, its solids and their context. Each stand-in's run is replaced by the run of
the part's own file, and all entities are numbered anew. The result has the entities that the kernel would write from
the solids themselves, in the same order and with the same numbers. Lines are broken as in the parts' files, so that
lines with longer numbers than there may have more than 72 characters.
"""

import re
from bisect import bisect_left
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from datetime import datetime
from io import BytesIO
from itertools import accumulate
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray
from OCP.APIHeaderSection import APIHeaderSection_MakeHeader
from OCP.BRepPrimAPI import BRepPrimAPI_MakeSphere
from OCP.gp import gp_Trsf
from OCP.Interface import Interface_Static
from OCP.Message import Message, Message_Gravity
from OCP.STEPCAFControl import STEPCAFControl_Controller, STEPCAFControl_Writer
from OCP.STEPControl import STEPControl_StepModelType
from OCP.TCollection import TCollection_ExtendedString, TCollection_HAsciiString
from OCP.TDataStd import TDataStd_Name
from OCP.TDF import TDF_Label
from OCP.TDocStd import TDocStd_Document
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS_Shape
from OCP.XCAFApp import XCAFApp_Application
from OCP.XCAFDoc import XCAFDoc_DocumentTool
from OCP.XSControl import XSControl_WorkSession

from pareto_monoped.cad.kernel.client import StepAssembly
from pareto_monoped.geometry.parts import Part

_LINK = re.compile(
    rb"^#(\d+) = (SHAPE_DEFINITION_REPRESENTATION|PRODUCT_DEFINITION_SHAPE|PRODUCT_DEFINITION|"
    rb"PRODUCT_DEFINITION_FORMATION|PRODUCT|ADVANCED_BREP_SHAPE_REPRESENTATION)\s*\(([^;]*)\);",
    re.MULTILINE,
)
_REFERENCE = re.compile(rb"(?<!'Context )#(\d+)")
"""An entity's number; the kernel's names of contexts have numbers too, which are none of an entity."""
_AFTER = 4  # entities of a context after its first: the units of length, plane and solid angle, and the uncertainty
_AXES = 4
"""Entities of the axes at the origin, which all representations of a file share: placement, point, two directions."""
_SCHEMA = "AP242_MANAGED_MODEL_BASED_3D_ENGINEERING_MIM_LF {1 0 10303 442 1 1 4 }"  # the kernel's own for AP242DIS
_GRAMS = 1e-3  # per cubic centimetre, of a density in kg per m3
TIMESTAMP = datetime(2025, 1, 1)  #: The time in every STEP file: the real time would make each export differ.
_METRES = 1e-3  # the documents' unit: millimetres
_USAGE = re.compile(rb"(NEXT_ASSEMBLY_USAGE_OCCURRENCE\()\s*'\d+'([^;]*;)")
_NUMBER = re.compile(rb"^#(\d+) =", re.MULTILINE)
_TAIL = 2000  # the last entity of a file, which is a short one, begins within so many characters from its end
_END = b"ENDSEC;\nEND-ISO-10303-21;"


@dataclass(frozen=True, slots=True, kw_only=True)
class Substance:
    """What a STEP file says of a part besides its shape."""

    colour: tuple[float, float, float]
    material: str
    grade: str  #: alloy or steel; '' where the maker is free to choose
    density_g_per_cm3: float

    @classmethod
    def of(cls, part: Part) -> "Substance":
        """Return the substance of a part."""
        return cls(
            colour=part.material.colour,
            material=part.material.name,
            grade="" if part.grade is None else part.grade.name,
            density_g_per_cm3=round(_GRAMS * part.material.density_kg_per_m3, 6),
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class Shape:
    """A part's shape in a STEP file."""

    name: str  #: of the part
    definition: int  #: of the product whose shape it is
    number: int  #: of its representation, the first entity
    axes: int  #: of the axes at the origin; in a part's file these follow the representation
    solid: int  #: of its last solid
    context: int  #: of its context
    start: int  #: where the text of its entities begins
    stop: int  #: where it ends

    @property
    def last(self) -> int:
        """Number of its last entity."""
        return self.context + _AFTER


def shapes_in(text: bytes) -> list[Shape]:
    """Return the shapes of all parts in a STEP file of the kernel, in their order."""
    links = {found[1]: found for found in _LINK.finditer(text)}
    shapes = []
    for link in links.values():
        if link[2] != b"SHAPE_DEFINITION_REPRESENTATION":
            continue
        definition, representation = _REFERENCE.findall(link[3])
        if representation not in links:
            continue  # an assembly
        steps = [definition]
        for _ in range(3):  # shape -> definition -> formation -> product
            steps.append(_REFERENCE.findall(links[steps[-1]][3])[0])
        axes, *solids, context = (int(number) for number in _REFERENCE.findall(links[representation][3]))
        start = links[representation].start()
        shapes.append(
            Shape(
                name=links[steps[-1]][3].split(b"'")[1].decode(),
                definition=int(steps[1]),
                number=int(representation),
                axes=axes,
                solid=solids[-1],
                context=context,
                start=start,
                stop=text.index(b"\n#%d = " % (context + _AFTER + 1), start) + 1,
            )
        )
    return shapes


def spliced(frame: bytes, parts: Mapping[str, bytes]) -> tuple[bytes, list[Shape]]:
    """Return the file of an assembly from ``frame``, the one with a stand-in per part, and the parts' shapes there."""
    stand_ins = shapes_in(frame)
    own = [_own_shape(stand_in, parts[stand_in.name]) for stand_in in stand_ins]
    lasts = [stand_in.last for stand_in in stand_ins]
    growth = [_count(shape) - _count(stand_in) for shape, stand_in in zip(own, stand_ins, strict=True)]
    shifts = [0, *accumulate(growth)]

    def moved(number: int) -> int:
        return number + shifts[bisect_left(lasts, number)]

    def in_frame(found: re.Match[bytes]) -> bytes:
        return b"#%d" % moved(int(found[1]))

    pieces, shapes, done = [], [], 0
    for stand_in, shape, shift in zip(stand_ins, own, shifts, strict=False):
        pieces.append(_REFERENCE.sub(in_frame, frame[done : stand_in.start]))
        pieces.append(_moved(parts[shape.name], shape, stand_in.number + shift, stand_in.axes))
        ahead = stand_in.number + shift - shape.number - _AXES
        shapes.append(
            replace(
                shape,
                definition=moved(stand_in.definition),
                number=stand_in.number + shift,
                solid=shape.solid + ahead,
                context=shape.context + ahead,
            )
        )
        done = stand_in.stop
    pieces.append(_REFERENCE.sub(in_frame, frame[done:]))
    return b"".join(pieces), shapes


def _own_shape(stand_in: Shape, text: bytes) -> Shape:
    (shape,) = shapes_in(text)
    if shape.name != stand_in.name or shape.axes != shape.number + 1 or stand_in.axes > stand_in.number:
        raise ValueError(f"STEP file of {stand_in.name}: is laid out in an unknown way; install the kernel's version")
    return shape


def _count(shape: Shape) -> int:
    """Return how many entities a shape has, without the axes."""
    return shape.last - shape.number + 1 - (_AXES if shape.number < shape.axes else 0)


def _moved(text: bytes, shape: Shape, number: int, axes: int) -> bytes:
    """Return the entities of a shape without its axes, the first of them with a new number, and with other axes."""
    first_after = shape.axes + _AXES
    body = text.index(b"\n#%d = " % first_after, shape.start) + 1
    first = text[shape.start : text.index(b"\n#%d = " % shape.axes, shape.start) + 1]
    ahead = number - shape.number - _AXES

    def in_first(found: re.Match[bytes]) -> bytes:
        own = int(found[1])
        return b"#%d" % {shape.number: number, shape.axes: axes}.get(own, own + ahead)

    return _REFERENCE.sub(in_first, first) + _REFERENCE.sub(
        lambda found: b"#%d" % (int(found[1]) + ahead), text[body : shape.stop]
    )


class _Document:
    """A document of named shapes and assemblies of them."""

    def __init__(self) -> None:
        name = TCollection_ExtendedString("MDTV-XCAF")
        self.document = TDocStd_Document(name)
        application = XCAFApp_Application.GetApplication_s()
        application.NewDocument(name, self.document)
        application.InitDocument(self.document)
        XCAFDoc_DocumentTool.SetLengthUnit_s(self.document, _METRES)
        self.shapes = XCAFDoc_DocumentTool.ShapeTool_s(self.document.Main())
        self.shapes.SetAutoNaming_s(False)

    def part(self, solid: TopoDS_Shape, name: str) -> TDF_Label:
        label = self.shapes.AddShape(solid, False)
        TDataStd_Name.Set_s(label, TCollection_ExtendedString(name))
        return label

    def assembly(self, name: str, members: Sequence[tuple[str, TDF_Label, NDArray[np.float64]]]) -> TDF_Label:
        label = self.shapes.NewShape()
        TDataStd_Name.Set_s(label, TCollection_ExtendedString(name))
        for member, shape, matrix in members:
            component = self.shapes.AddComponent(label, shape, _location(matrix))
            TDataStd_Name.Set_s(component, TCollection_ExtendedString(member))
        return label

    def text(self, name: str) -> bytes:
        """Return the file without colours and materials."""
        STEPCAFControl_Controller.Init_s()
        Interface_Static.SetCVal_s("write.step.schema", "AP242DIS")
        self.shapes.UpdateAssemblies()
        for printer in Message.DefaultMessenger_s().Printers():
            printer.SetTraceLevel(Message_Gravity.Message_Fail)
        writer = STEPCAFControl_Writer(XSControl_WorkSession(), False)
        writer.SetColorMode(False)
        writer.SetNameMode(True)
        model = writer.Writer().Model()
        header = APIHeaderSection_MakeHeader(model)
        if not header.IsDone():
            header = APIHeaderSection_MakeHeader(0)
            header.Apply(model)
        header.SetName(TCollection_HAsciiString(name))
        header.SetSchemaIdentifiersValue(1, TCollection_HAsciiString(_SCHEMA))
        header.SetTimeStamp(TCollection_HAsciiString(TIMESTAMP.isoformat()))
        header.SetOriginatingSystem(TCollection_HAsciiString("pareto-monoped"))
        # Curves on surfaces would double time and size; planes and cylinders do not need them.
        Interface_Static.SetIVal_s("write.surfacecurve.mode", 0)
        writer.Transfer(self.document, STEPControl_StepModelType.STEPControl_AsIs)
        stream = BytesIO()
        writer.WriteStream(stream)
        return _renumbered(stream.getvalue())


def part_step(solid: TopoDS_Shape, name: str, substance: Substance) -> bytes:
    """Return one part, in millimetres."""
    document = _Document()
    document.part(solid, name)
    text = document.text(name)
    return _finished(text, shapes_in(text), {name: substance})


def assembly_step(
    assembly: StepAssembly, parts: Mapping[str, bytes], compounds: Mapping[str, TopoDS_Shape] = MappingProxyType({})
) -> bytes:
    """Return the assembly as a tree: the robot, its units, their parts. Each unique part is written once.

    ``compounds`` are parts of several bodies, which the kernel writes in another form, here once more.
    """
    stand_ins = {name: compounds.get(name) or BRepPrimAPI_MakeSphere(1.0).Shape() for name in assembly.parts}
    text, shapes = spliced(tree_step(assembly, stand_ins), parts)
    return _finished(text, shapes, {name: Substance.of(part) for name, part in assembly.parts.items()})


def tree_step(assembly: StepAssembly, solids: Mapping[str, TopoDS_Shape]) -> bytes:
    """Return what the kernel writes of solids by name: no colours, no materials. No two names may share a solid."""
    document = _Document()
    labels = {name: document.part(solid, name) for name, solid in solids.items()}
    units = []
    for unit, placements in assembly.units.items():
        members = [(placement.part, labels[placement.part], placement.matrix) for placement in placements]
        units.append((unit, document.assembly(unit, members), np.eye(4)))
    document.assembly(assembly.name, units)
    return document.text(assembly.name)


def _location(matrix: NDArray[np.float64]) -> TopLoc_Location:
    move = gp_Trsf()
    move.SetValues(*(float(v) for v in matrix[:3].ravel()))
    return TopLoc_Location(move)


def _renumbered(text: bytes) -> bytes:
    """Number the usages of parts from 1, as the kernel's own count continues from file to file."""
    count = 0

    def usage(found: re.Match[bytes]) -> bytes:
        nonlocal count
        count += 1
        return found[1] + b"'%d'" % count + re.sub(rb"\s*\n\s*", b"", found[2])

    return _USAGE.sub(usage, text)


def _finished(text: bytes, shapes: Sequence[Shape], substances: Mapping[str, Substance]) -> bytes:
    """Add colour and material to each named shape: one style per solid, a name and a density per product."""
    number = int(_NUMBER.findall(text, max(len(text) - _TAIL, 0))[-1])
    lines = []
    for shape in shapes:
        own = substances[shape.name]
        red, green, blue = own.colour
        entities = (
            f"MECHANICAL_DESIGN_GEOMETRIC_PRESENTATION_REPRESENTATION('',(@1),#{shape.context})",
            f"STYLED_ITEM('color',(@2),#{shape.solid})",
            "PRESENTATION_STYLE_ASSIGNMENT((@3))",
            "SURFACE_STYLE_USAGE(.BOTH.,@4)",
            "SURFACE_SIDE_STYLE('',(@5))",
            "SURFACE_STYLE_FILL_AREA(@6)",
            "FILL_AREA_STYLE('',(@7))",
            "FILL_AREA_STYLE_COLOUR('',@8)",
            f"COLOUR_RGB('',{red!r},{green!r},{blue!r})",
            f"PROPERTY_DEFINITION('material property','material name',#{shape.definition})",
            "PROPERTY_DEFINITION_REPRESENTATION(@9,@11)",
            f"REPRESENTATION('material name',(@12),#{shape.context})",
            f"DESCRIPTIVE_REPRESENTATION_ITEM('{_escaped(own.material)}','{_escaped(own.grade)}')",
            f"PROPERTY_DEFINITION('material property','density',#{shape.definition})",
            "PROPERTY_DEFINITION_REPRESENTATION(@13,@15)",
            f"REPRESENTATION('density',(@16),#{shape.context})",
            f"MEASURE_REPRESENTATION_ITEM('density measure',POSITIVE_RATIO_MEASURE({own.density_g_per_cm3!r}),@17)",
            "DERIVED_UNIT((@18,@20))",
            "DERIVED_UNIT_ELEMENT(@19,1.)",
            "(MASS_UNIT()NAMED_UNIT(*)SI_UNIT($,.GRAM.))",
            "DERIVED_UNIT_ELEMENT(@21,-3.)",
            "(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.CENTI.,.METRE.))",
        )
        first = number + 1
        for entity in entities:
            number += 1
            numbered = re.sub(r"@(\d+)", lambda found: f"#{first + int(found[1])}", entity)  # noqa: B023
            lines.append(f"#{number} = {numbered};")
    return text.replace(_END, "\n".join([*lines, ""]).encode() + _END)


def _escaped(text: str) -> str:
    """Return a string as such files have it: in ASCII, apostrophes twice."""
    return text.encode("ascii", "replace").decode().replace("'", "''")

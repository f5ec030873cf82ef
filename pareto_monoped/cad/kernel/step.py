"""STEP files (ISO 10303-21) with names and colours; the time stamp is fixed, so the same robot gives the same bytes.

The kernel writes geometry and names. It would write colours in an order that changes from run to run, so the styles
(ISO 10303-46) are added here.
"""

import re
from collections.abc import Mapping, Sequence
from datetime import datetime
from io import BytesIO

import numpy as np
from numpy.typing import NDArray
from OCP.APIHeaderSection import APIHeaderSection_MakeHeader
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

Colour = tuple[float, float, float]

TIMESTAMP = datetime(2025, 1, 1)
"""The time in every STEP file: the real time would make each export differ."""
_METRES = 1e-3  # the documents' unit: millimetres
_USAGE = re.compile(rb"(NEXT_ASSEMBLY_USAGE_OCCURRENCE\()\s*'\d+'([^;]*;)")


_LINK = re.compile(
    rb"#(\d+) = (SHAPE_DEFINITION_REPRESENTATION|PRODUCT_DEFINITION_SHAPE|PRODUCT_DEFINITION|"
    rb"PRODUCT_DEFINITION_FORMATION|PRODUCT|ADVANCED_BREP_SHAPE_REPRESENTATION)\s*\(([^;]*)\);"
)
_REFERENCE = re.compile(rb"#(\d+)")
_END = b"ENDSEC;\nEND-ISO-10303-21;"


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

    def text(self, name: str, colours: Mapping[str, Colour]) -> bytes:
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
        header.SetTimeStamp(TCollection_HAsciiString(TIMESTAMP.isoformat()))
        header.SetOriginatingSystem(TCollection_HAsciiString("pareto-monoped"))
        STEPCAFControl_Controller.Init_s()
        # Curves on surfaces would double time and size; planes and cylinders do not need them.
        Interface_Static.SetIVal_s("write.surfacecurve.mode", 0)
        writer.Transfer(self.document, STEPControl_StepModelType.STEPControl_AsIs)
        stream = BytesIO()
        writer.WriteStream(stream)
        return _coloured(_renumbered(stream.getvalue()), colours)


def part_step(solid: TopoDS_Shape, name: str, colour: Colour) -> bytes:
    """One part, in millimetres."""
    document = _Document()
    document.part(solid, name)
    return document.text(name, {name: colour})


def assembly_step(assembly: StepAssembly, solids: Mapping[str, TopoDS_Shape]) -> bytes:
    """The assembly as a tree: the robot, its units, their parts. Each unique part is written once."""
    document = _Document()
    labels = {name: document.part(solid, name) for name, solid in solids.items()}
    units = []
    for unit, placements in assembly.units.items():
        members = [(placement.part, labels[placement.part], placement.matrix) for placement in placements]
        units.append((unit, document.assembly(unit, members), np.eye(4)))
    document.assembly(assembly.name, units)
    return document.text(assembly.name, {name: part.material.colour for name, part in assembly.parts.items()})


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


def _coloured(text: bytes, colours: Mapping[str, Colour]) -> bytes:
    """Add a colour to the solid of each named product, as the kernel would: one style per solid."""
    links: dict[bytes, bytes] = {}
    shapes = []
    for number, kind, arguments in _LINK.findall(text):
        links[number] = arguments
        if kind == b"SHAPE_DEFINITION_REPRESENTATION":
            shapes.append(_REFERENCE.findall(arguments))
    number = max(int(n) for n in re.findall(rb"^#(\d+) =", text, re.MULTILINE))
    lines = []
    for definition, representation in shapes:
        if representation not in links:
            continue  # an assembly
        for _ in range(3):  # shape -> definition -> formation -> product
            definition = _REFERENCE.findall(links[definition])[0]
        name = links[definition].split(b"'")[1].decode()
        *items, context = _REFERENCE.findall(links[representation])
        red, green, blue = colours[name]
        a = [number + k for k in range(1, 10)]
        number += 9
        lines += [
            f"#{a[0]} = MECHANICAL_DESIGN_GEOMETRIC_PRESENTATION_REPRESENTATION('',(#{a[1]}),#{context.decode()});",
            f"#{a[1]} = STYLED_ITEM('color',(#{a[2]}),#{items[-1].decode()});",
            f"#{a[2]} = PRESENTATION_STYLE_ASSIGNMENT((#{a[3]}));",
            f"#{a[3]} = SURFACE_STYLE_USAGE(.BOTH.,#{a[4]});",
            f"#{a[4]} = SURFACE_SIDE_STYLE('',(#{a[5]}));",
            f"#{a[5]} = SURFACE_STYLE_FILL_AREA(#{a[6]});",
            f"#{a[6]} = FILL_AREA_STYLE('',(#{a[7]}));",
            f"#{a[7]} = FILL_AREA_STYLE_COLOUR('',#{a[8]});",
            f"#{a[8]} = COLOUR_RGB('',{red!r},{green!r},{blue!r});",
        ]
    return text.replace(_END, "\n".join([*lines, ""]).encode() + _END)

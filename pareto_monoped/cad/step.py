"""STEP files (ISO 10303-21) with names, colours and a fixed time stamp, so that the same robot gives the same bytes."""

import re
from collections.abc import Sequence
from datetime import datetime
from io import BytesIO
from pathlib import Path

import build123d as bd
import numpy as np
from numpy.typing import NDArray
from OCP.gp import gp_Trsf
from OCP.TopLoc import TopLoc_Location

from pareto_monoped.cad.product import Product
from pareto_monoped.cad.solids import Solid

_USAGE = re.compile(rb"(NEXT_ASSEMBLY_USAGE_OCCURRENCE\()\s*'\d+'([^;]*;)")

TIMESTAMP = datetime(2025, 1, 1)
"""Written into every STEP file: a real time would make each export differ."""


def part_shape(solid: Solid, name: str, colour: Sequence[float]) -> Solid:
    """A named, coloured copy of a solid that shares its geometry."""
    shape = type(solid)(solid.wrapped)
    shape.label = name
    shape.color = bd.Color(*colour)
    return shape


def assembly_shape(product: Product, name: str) -> bd.Compound:
    """The assembly as a tree: the robot, its units, their parts. Leaves carry the names of the unique parts."""
    units: dict[str, list[Solid]] = {unit.name: [] for unit in product.robot.units}
    shapes = [part_shape(kind.solid, kind.name, kind.part.material.colour) for kind in product.unique]
    for instance, kind in zip(product.instances, product.kinds, strict=True):
        shape = shapes[kind].moved(location(instance.world))
        shape.label, shape.color = shapes[kind].label, shapes[kind].color
        units[instance.unit].append(shape)
    return bd.Compound(
        label=name, children=[bd.Compound(label=unit, children=leaves) for unit, leaves in units.items()]
    )


def location(matrix: NDArray[np.float64]) -> bd.Location:
    """A 4 x 4 matrix as a location."""
    move = gp_Trsf()
    move.SetValues(*(float(v) for v in matrix[:3].ravel()))
    return bd.Location(TopLoc_Location(move))


def write_step(shape: bd.Shape, path: Path) -> None:
    """Write one shape, in millimetres."""
    stream = BytesIO()
    bd.export_step(shape, stream, write_pcurves=False, timestamp=TIMESTAMP)
    path.write_bytes(_renumbered(stream.getvalue()))


def _renumbered(text: bytes) -> bytes:
    """Number the usages of parts from 1: OCCT goes on counting from file to file."""
    count = 0

    def usage(found: re.Match[bytes]) -> bytes:
        nonlocal count
        count += 1
        return found[1] + b"'%d'" % count + re.sub(rb"\s*\n\s*", b"", found[2])

    return _USAGE.sub(usage, text)

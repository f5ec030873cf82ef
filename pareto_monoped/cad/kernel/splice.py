"""The STEP file of an assembly from the files of its parts, so that each solid is written once.

The kernel writes the assembly with stand-ins, one small solid per part. In a STEP file, a part's shape is a run of
consecutive entities: its representation, its solids and their context. Each stand-in's run is replaced by the run of
the part's own file, and all entities are numbered anew. The result has the entities that the kernel would write from
the solids themselves, in the same order and with the same numbers. Lines are broken as in the parts' files, so that
lines with longer numbers than there may have more than 72 characters.
"""

import re
from bisect import bisect_left
from collections.abc import Mapping
from dataclasses import dataclass, replace
from itertools import accumulate

_LINK = re.compile(
    rb"^#(\d+) = (SHAPE_DEFINITION_REPRESENTATION|PRODUCT_DEFINITION_SHAPE|PRODUCT_DEFINITION|"
    rb"PRODUCT_DEFINITION_FORMATION|PRODUCT|ADVANCED_BREP_SHAPE_REPRESENTATION)\s*\(([^;]*)\);",
    re.MULTILINE,
)
_REFERENCE = re.compile(rb"(?<!'Context )#(\d+)")
"""An entity's number; the kernel's names of contexts have numbers too, which are none of an entity."""
_AFTER = 4
"""Entities of a context after its first: the units of length, plane and solid angle, and the uncertainty."""
_AXES = 4
"""Entities of the axes at the origin, which all representations of a file share: placement, point, two directions."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Shape:
    """A part's shape in a STEP file.

    Attributes:
        name: of the part.
        number: of its representation, the first entity.
        axes: of the axes at the origin; in a part's file these follow the representation.
        solid: of its last solid.
        context: of its context.
        start, stop: where the text of its entities begins and ends.
    """

    name: str
    number: int
    axes: int
    solid: int
    context: int
    start: int
    stop: int

    @property
    def last(self) -> int:
        """Number of its last entity."""
        return self.context + _AFTER


def shapes_in(text: bytes) -> list[Shape]:
    """The shapes of all parts in a STEP file of the kernel, in their order."""
    links = {found[1]: found for found in _LINK.finditer(text)}
    shapes = []
    for link in links.values():
        if link[2] != b"SHAPE_DEFINITION_REPRESENTATION":
            continue
        definition, representation = _REFERENCE.findall(link[3])
        if representation not in links:
            continue  # an assembly
        for _ in range(3):  # shape -> definition -> formation -> product
            definition = _REFERENCE.findall(links[definition][3])[0]
        axes, *solids, context = (int(number) for number in _REFERENCE.findall(links[representation][3]))
        start = links[representation].start()
        shapes.append(
            Shape(
                name=links[definition][3].split(b"'")[1].decode(),
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
    """The file of an assembly, and the shapes of its parts there.

    Args:
        frame: the file of the assembly with a stand-in for each part.
        parts: the file of each part, by name.
    """
    stand_ins = shapes_in(frame)
    own = [_own_shape(stand_in, parts[stand_in.name]) for stand_in in stand_ins]
    lasts = [stand_in.last for stand_in in stand_ins]
    growth = [_count(shape) - _count(stand_in) for shape, stand_in in zip(own, stand_ins, strict=True)]
    shifts = [0, *accumulate(growth)]

    def in_frame(found: re.Match[bytes]) -> bytes:
        number = int(found[1])
        return b"#%d" % (number + shifts[bisect_left(lasts, number)])

    pieces, shapes, done = [], [], 0
    for stand_in, shape, shift in zip(stand_ins, own, shifts, strict=False):
        pieces.append(_REFERENCE.sub(in_frame, frame[done : stand_in.start]))
        moved = _moved(parts[shape.name], shape, stand_in.number + shift, stand_in.axes)
        pieces.append(moved)
        ahead = stand_in.number + shift - shape.number - _AXES
        shapes.append(
            replace(shape, number=stand_in.number + shift, solid=shape.solid + ahead, context=shape.context + ahead)
        )
        done = stand_in.stop
    pieces.append(_REFERENCE.sub(in_frame, frame[done:]))
    return b"".join(pieces), shapes


def _own_shape(stand_in: Shape, text: bytes) -> Shape:
    """The shape of a part's own file.

    Raises:
        ValueError: the files are not laid out as this module expects of the kernel.
    """
    (shape,) = shapes_in(text)
    if shape.name != stand_in.name or shape.axes != shape.number + 1 or stand_in.axes > stand_in.number:
        raise ValueError(f"STEP file of {stand_in.name}: is laid out in an unknown way; install the kernel's version")
    return shape


def _count(shape: Shape) -> int:
    """How many entities a shape has, without the axes."""
    return shape.last - shape.number + 1 - (_AXES if shape.number < shape.axes else 0)


def _moved(text: bytes, shape: Shape, number: int, axes: int) -> bytes:
    """The entities of a shape without its axes, the first of them with a new number, and with other axes."""
    first_after = shape.axes + _AXES
    body = text.index(b"\n#%d = " % first_after, shape.start) + 1
    first = text[shape.start : text.index(b"\n#%d = " % shape.axes, shape.start) + 1]
    ahead = number - shape.number - _AXES

    def renumbered(found: re.Match[bytes]) -> bytes:
        return b"#%d" % (int(found[1]) + ahead)

    def in_first(found: re.Match[bytes]) -> bytes:
        own = int(found[1])
        return b"#%d" % {shape.number: number, shape.axes: axes}.get(own, own + ahead)

    return _REFERENCE.sub(in_first, first) + _REFERENCE.sub(renumbered, text[body : shape.stop])

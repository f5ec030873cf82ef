"""``parameters.csv`` and ``monoped_equations.txt``: all dimensions of a design by name, for a team's CAD template.

The equations file has the form of text files that SolidWorks links models to: one global variable per line, its name in
quotation marks, then the value with its unit (SolidWorks help, "Creating Equations in External Files", which also asks
for a file name other than ``equations.txt``). Many other CAD programs read such lines or the CSV.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np

from pareto_monoped.cad.assembly import ACTUATOR_UNITS
from pareto_monoped.cad.product import Product, UniquePart
from pareto_monoped.cad.write.folder import csv_text
from pareto_monoped.geometry.features import CountersunkHead, Hole, ShaftEnd
from pareto_monoped.geometry.gears import ExternalGear, InternalGear
from pareto_monoped.geometry.shapes import Arc, Circle, Line, Numbers, Path, Pattern, Shape
from pareto_monoped.leg.dimensions import LegDimensions

_COLUMNS = ("name", "value", "unit", "part", "meaning")
_DIGITS = 6  # decimals: a nanometre
_LEG = {
    "bearing_bore_radius": (_BEARING := "of the bearings of knee and base."),
    "bearing_outer_radius": _BEARING,
    "bearing_width": _BEARING,
    "thigh_window_half_width": (_THIGH := "the bar of the thigh's plates."),
    "plate": "thickness of the aluminium plates of the thigh.",
    "shank_plate": "thickness of the aluminium plates of the shank.",
    "gap": "distance between the thigh's plates: both knee bearings and the sprocket between them fit in.",
    "play": "lateral distance between thigh and shank, for the spacers on the knee's axle.",
    "hip_play": "lateral distance between thigh and base, so that M3 x 16 screws join the thigh to the hip's output.",
    "thigh_half_width": _THIGH,
    "thigh_core_half_width": (
        _CORE := "the thigh's printed core, which is at least 3.4 mm inside the strands of the chain."
    ),
    "thigh_core_window_half_width": _CORE,
    "knee_radius": "of the thigh plates at the knee; covers the chain, which reaches out to 34.1 mm.",
    "shank_top_radius": (_SHANK := "the shank's plates."),
    "shank_bottom_radius": _SHANK,
    "shank_window_half_width": _SHANK,
    "shank_core_half_width": (_SHANK_CORE := "the shank's printed core."),
    "shank_core_window_half_width": _SHANK_CORE,
    "fork": (
        "free depth of the shank's fork below the knee axis, enough for the thigh at the end of ``stops.knee_stop``."
    ),
    "foot_radius": "of the rubber ball.",
    "rod_radius": "of the base's rods: a common tube, with 3.35 mm of wall around its M4 thread.",
    "cheek": "thickness of the base's near cheek.",
    "far_cheek": "thickness of the base's far cheek: the bearing's seat and a lip of 1 mm.",
}
"""What the lengths of ``LegDimensions`` are, by their names without the unit, in the order of the files."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Parameter:
    """One dimension."""

    name: str  #: unique in the design; letters, digits and underscores
    value: float  #: in ``unit``
    unit: str  #: ``mm``, ``deg``, or empty for numbers and counts
    part: str  #: file name of the part that has it; empty for the whole leg
    meaning: str  #: what it is

    @property
    def text(self) -> str:
        """The value in as few digits as it needs, without its unit."""
        digits = f"{self.value:.{_DIGITS}f}".rstrip("0").rstrip(".")
        return "0" if digits == "-0" else digits


def parameters(product: Product, leg: LegDimensions) -> tuple[Parameter, ...]:
    """Return all dimensions of a design, its leg and every part that is made; ``ValueError`` if two have one name."""
    of_leg = (_length("", f"leg_{name}", getattr(leg, f"{name}_mm"), meaning) for name, meaning in _LEG.items())
    found = (*_of_design(product), *of_leg, *(p for unique in product.unique for p in _of_part(unique)))
    names = [parameter.name for parameter in found]
    if len(set(names)) < len(names):
        twice = next(name for k, name in enumerate(names) if name in names[:k])
        raise ValueError(f"parameter {twice!r}: must be the name of one dimension only; rename a part")
    return found


def parameters_csv(rows: Iterable[Parameter]) -> str:
    """Return the text of ``parameters.csv``."""
    return csv_text(_COLUMNS, ((row.name, row.text, row.unit, row.part, row.meaning) for row in rows))


def equations(rows: Iterable[Parameter]) -> str:
    """Return the text of the equations file: a line such as ``"thigh_length" = 320mm`` per dimension."""
    return "".join(f'"{row.name}" = {row.text}{row.unit}\n' for row in rows)


def _of_design(product: Product) -> Iterator[Parameter]:
    robot = product.robot
    for link, length_m in (("thigh", robot.design.thigh_length_m), ("shank", robot.design.shank_length_m)):
        yield _length("", f"{link}_length", 1e3 * length_m, f"{link}: between its joints, or knee and foot centre")
    for unit, joint in ACTUATOR_UNITS.items():
        actuator = {"hip": robot.hip, "knee": robot.knee}[joint]
        yield _number(unit, f"{joint}_ratio", actuator.ratio, f"gear ratio of the {joint}")
        yield _length(unit, f"{joint}_face_width", actuator.face_width_mm, f"face width of the {joint}'s gears")


def _of_part(unique: UniquePart) -> Iterator[Parameter]:
    """Yield heights, outlines, holes and cones of a part that is made."""
    part, name = unique.part, unique.name
    if part.process == "bought":
        return
    for k, prism in enumerate(part.prisms, 1):
        layer = f"{name}_layer_{k}"
        yield _length(name, f"{layer}_from", prism.z0_mm, f"layer {k}: lower end along the axis")
        yield _length(name, f"{layer}_to", prism.z1_mm, f"layer {k}: upper end along the axis")
        yield from _of_shape(name, f"{layer}_outline", prism.outline, f"layer {k}, outline")
        for j, hole in enumerate(prism.holes, 1):
            yield from _of_shape(name, f"{layer}_hole_{j}", hole, f"layer {k}, hole {j}")
    for k, ball in enumerate(part.balls, 1):
        yield _length(name, f"{name}_ball_{k}_diameter", 2.0 * ball.radius_mm, f"ball {k}: diameter")
        yield _length(name, f"{name}_ball_{k}_flat", ball.top_mm, f"ball {k}: height of its flat above its centre")
    for k, feature in enumerate(part.features, 1):
        yield from _of_feature(name, f"{name}_feature_{k}", feature)


def _of_shape(part: str, name: str, shape: Shape, what: str) -> Iterator[Parameter]:
    if isinstance(shape, ExternalGear | InternalGear):
        yield _number(part, f"{name}_teeth", shape.teeth, f"{what}: number of teeth")
        yield _length(part, f"{name}_module", shape.module_mm, f"{what}: module")
        yield _angle(part, f"{name}_pressure_angle", shape.pressure_angle_rad, f"{what}: pressure angle")
        yield _length(part, f"{name}_tip_diameter", 2.0 * shape.tip_radius_mm, f"{what}: tip circle")
        yield _length(part, f"{name}_root_diameter", 2.0 * shape.root_radius_mm, f"{what}: root circle")
        yield _angle(part, f"{name}_phase", shape.phase_rad, f"{what}: angle of a tooth or space from the x axis")
    elif isinstance(shape, Circle | Pattern):
        yield _length(part, f"{name}_diameter", 2.0 * shape.radius_mm, f"{what}: diameter")
        yield _length(part, f"{name}_x", shape.x_mm, f"{what}: x of its centre")
        yield _length(part, f"{name}_y", shape.y_mm, f"{what}: y of its centre")
        if isinstance(shape, Pattern):
            yield _number(part, f"{name}_count", shape.count, f"{what}: how many on a circle")
            yield _length(part, f"{name}_pitch_circle", 2.0 * shape.pitch_radius_mm, f"{what}: diameter of that circle")
            yield _angle(part, f"{name}_phase", shape.phase_rad, f"{what}: angle of the first from the x axis")
    elif isinstance(shape, Path):
        for k, piece in enumerate(shape.pieces, 1):
            yield from _of_piece(part, f"{name}_piece_{k}", piece, f"{what}, piece {k}")


def _of_piece(part: str, name: str, piece: Line | Arc, what: str) -> Iterator[Parameter]:
    if isinstance(piece, Line):
        for end, x, y in (("start", piece.x0_mm, piece.y0_mm), ("end", piece.x1_mm, piece.y1_mm)):
            yield _length(part, f"{name}_{end}_x", x, f"{what}, a line: x of its {end}")
            yield _length(part, f"{name}_{end}_y", y, f"{what}, a line: y of its {end}")
    else:
        yield _length(part, f"{name}_x", piece.x_mm, f"{what}, an arc: x of its centre")
        yield _length(part, f"{name}_y", piece.y_mm, f"{what}, an arc: y of its centre")
        yield _length(part, f"{name}_radius", piece.radius_mm, f"{what}, an arc: radius")
        yield _angle(part, f"{name}_start_angle", piece.start_rad, f"{what}, an arc: angle of its start")
        yield _angle(part, f"{name}_end_angle", piece.end_rad, f"{what}, an arc: angle of its end")


def _of_feature(part: str, name: str, feature: Hole | ShaftEnd | CountersunkHead) -> Iterator[Parameter]:
    for k, bevel in enumerate(feature.bevels, 1):
        what = f"cone {k} on a diameter of {2.0 * float(bevel.at.radius_mm):g} mm"
        yield _length(part, f"{name}_cone_{k}_on_diameter", 2.0 * bevel.at.radius_mm, f"{what}: that diameter")
        yield _number(part, f"{name}_cone_{k}_count", len(bevel.centres_mm()), f"{what}: how many")
        yield _length(part, f"{name}_cone_{k}_diameter", 2.0 * bevel.edge_mm, f"{what}: diameter in its face")
        yield _length(part, f"{name}_cone_{k}_face", bevel.face_mm, f"{what}: height of its face along the axis")
        yield _length(part, f"{name}_cone_{k}_depth", abs(float(bevel.end_mm) - float(bevel.face_mm)), f"{what}: depth")
    if isinstance(feature, Hole) and feature.thread is not None:
        yield _length(part, f"{name}_thread", feature.thread.diameter_mm, f"thread {feature.thread.text}: diameter")
        yield _length(part, f"{name}_thread_pitch", feature.thread.pitch_mm, f"thread {feature.thread.text}: pitch")
        if feature.thread_mm is not None:
            yield _length(part, f"{name}_thread_depth", feature.thread_mm, "usable depth of the thread")


def _length(part: str, name: str, value_mm: Numbers, meaning: str) -> Parameter:
    return Parameter(name=name, value=float(value_mm), unit="mm", part=part, meaning=meaning)


def _angle(part: str, name: str, value_rad: Numbers, meaning: str) -> Parameter:
    return Parameter(name=name, value=float(np.degrees(value_rad)), unit="deg", part=part, meaning=meaning)


def _number(part: str, name: str, value: Numbers, meaning: str) -> Parameter:
    return Parameter(name=name, value=float(value), unit="", part=part, meaning=meaning)

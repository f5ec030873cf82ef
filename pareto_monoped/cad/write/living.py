"""``model.py``: one program that makes a design's solids and assembly from named drivers, with build123d alone.

It is written from parts of traced numbers (``drivers``): what is given stands in its first section, what has a name and
follows from it in the second, and the parts' functions have the rest of the formulas. ``monoped_equations.txt`` has the
first two sections in the form of text files that SolidWorks links models to: one global variable per line (SolidWorks
help, "Creating Equations in External Files", which also asks for a file name other than ``equations.txt``).
"""

import builtins
import re
from collections.abc import Iterator, Sequence
from dataclasses import MISSING, dataclass, fields, replace
from importlib import resources
from typing import Any

from pareto_monoped.actuator.actuator import Actuator
from pareto_monoped.actuator.gearset import GearSet
from pareto_monoped.actuator.motor import Motor
from pareto_monoped.actuator.ratiomap import ActuatorMap, Maps, joint_maps
from pareto_monoped.actuator.settings import ActuatorSettings
from pareto_monoped.cad.assembly import ACTUATOR_UNITS
from pareto_monoped.cad.product import Product
from pareto_monoped.cad.write.drivers import Driver, Trace, short, space, table_words, tracing, words_of
from pareto_monoped.cad.write.equations import Formula, Writer, argument, call_of, number, repeated, steps
from pareto_monoped.cad.write.folder import csv_text
from pareto_monoped.cad.write.formulas import OPPOSITE, Condition, Traced, conditions
from pareto_monoped.geometry.parts import Part
from pareto_monoped.geometry.roles import SCREWS, Group, Role
from pareto_monoped.leg.actuator_fit import ActuatorFit
from pareto_monoped.leg.dimensions import LegDimensions
from pareto_monoped.robot.build import Robot
from pareto_monoped.robot.units import UNITS, ActuatorSized

_STANDING_OUT = SCREWS | {Role.ELECTRONICS}
_RACK = ("rack_addendum", "rack_dedendum", "rack_fillet", "rack_pressure_angle")
_ORDER = ("thigh", "shank", "hip", "knee", "gearbox", "motor")  # of the groups of drivers; all others follow
_WIDTH = 118


@dataclass(frozen=True, slots=True, kw_only=True)
class LivingModel:
    """A design as formulas."""

    drivers: tuple[Driver, ...]  #: those that something depends on
    formulas: tuple[Formula, ...]  #: each after what it follows from
    lines: tuple[str, ...]  #: the same for SolidWorks
    program: str  #: the text of ``model.py``

    @property
    def equations(self) -> str:
        """The text of ``monoped_equations.txt``: angles of drivers in degrees, all others in radians."""
        units = {"mm": "mm"}
        given = (f'"{one.name}" = {number(one.value, equation=True)}{units.get(one.unit, "")}' for one in self.drivers)
        return "\n".join([*given, *self.lines, ""])

    @property
    def parameters_csv(self) -> str:
        """The text of ``parameters.csv``."""
        rows = [(one.name, number(one.value, equation=True), one.unit, "", one.meaning) for one in self.drivers]
        rows += [(one.name, number(one.value, equation=True), "", one.text, one.meaning) for one in self.formulas]
        return csv_text(("name", "value", "unit", "formula", "meaning"), rows)


@dataclass(frozen=True, slots=True)
class _Actuator:
    """What units take from an actuator, of traced numbers."""

    parts: tuple[Part, ...]
    family: str
    mount: Any
    length_mm: Any

    @property
    def parts_bolted_at_back(self) -> tuple[Part, ...]:
        return tuple(part for part in self.parts if part.role is not Role.STATOR_SCREW)


_Units = tuple[tuple[tuple[Part, ...], Any], ...]
"""Parts of each unit of a robot in its order, and where its origin lies on the joint's axis, of traced numbers."""


def _traced_units(robot: Robot, maps: Maps, trace: Trace) -> _Units:
    """Return the units of a robot from drivers, inside ``tracing``."""
    both = joint_maps(maps)
    by_joint, plain = {"hip": both.hip, "knee": both.knee}, {"hip": robot.hip, "knee": robot.knee}
    motors = {
        joint: trace.record(one.motor, "motor_" if both.hip.motor == both.knee.motor else f"{joint}_motor_")
        for joint, one in by_joint.items()
    }
    settings = {joint: _settings(one.settings, trace) for joint, one in by_joint.items()}
    made = {
        id(one): _actuator(one, motors[joint], settings[joint], _scope(robot, joint), trace)
        for joint, one in plain.items()
    }
    fits = {
        joint: _fit(joint, one, motors[joint], settings[joint], robot.leg.of(joint), trace)
        for joint, one in by_joint.items()
    }
    leg = _leg(robot.leg, space("leg.dimensions")["leg_for"](fits["hip"], fits["knee"]), trace)
    lengths = {
        name: trace.driver(name.removesuffix("_m"), 1e3 * getattr(robot.design, name), "mm", meaning) / 1e3
        for name, meaning in (
            ("thigh_length_m", "hip axis to knee axis"),
            ("shank_length_m", "knee axis to the middle of the foot"),
        )
    }
    given: list[Any] = [
        made[id(plain[kind.joint])] if isinstance(kind, ActuatorSized) else lengths[kind.length] for kind in UNITS
    ]
    return tuple((kind.parts(one, leg), kind.z_mm(leg)) for kind, one in zip(UNITS, given, strict=True))


def _scope(robot: Robot, joint: str) -> str:
    """Return what the names of a joint's gears begin with: two actuators of one ratio share their parts."""
    return joint if robot.hip is not robot.knee else "gearbox"


def _settings(settings: ActuatorSettings, trace: Trace) -> ActuatorSettings:
    """Return settings whose dimensions of parts are drivers."""
    parts, words = settings.parts, table_words()
    groups = ("gears", "carrier", "casing", "coupling", "spline", "interface", "webs", "needles")
    changes = {name: trace.record(getattr(parts, name), f"{name}_", words) for name in groups}
    interface = changes["interface"]
    # Dowels stand in every second gap between the bolts.
    trace.rules += [count % 2.0 == 0.0 for count in (interface.output_bolt_count, interface.mount_bolt_count)]
    step = trace.driver("face_step", parts.rating.face_step_mm, "mm", "face widths are multiples of this")
    return replace(settings, parts=replace(parts, **changes, rating=replace(parts.rating, face_step_mm=step)))


def _fit(
    joint: str, one: ActuatorMap, motor: Motor, settings: ActuatorSettings, known: ActuatorFit, trace: Trace
) -> ActuatorFit:
    """Return what the leg takes from the actuators of a joint."""
    first = next(entry.actuator for entry in one.entries if entry.actuator is not None)
    interfaces = space("actuator.actuator")
    mount = interfaces["mount_interface"](motor, first.family, settings)
    output = interfaces["output_interface"](settings)
    board = trace.record(known.driver, f"{joint}_driver_")
    fit: ActuatorFit = space("leg.actuator_fit")["fit_of"](mount, output, board, known.driver_note, known.torque_n_m)
    trace.name(fit, f"{joint}_")
    return fit


def _leg(known: LegDimensions, leg: LegDimensions, trace: Trace) -> LegDimensions:
    """Return the leg's dimensions: drivers, and what the actuators give."""
    words, own = words_of(LegDimensions), ("thigh_", "shank_", "knee_", "hip_", "foot_")
    given = [each.name for each in fields(leg) if each.default is not MISSING]
    changes = {
        name: trace.driver(
            short(name if name.startswith(own) else f"leg_{name}"), getattr(known, name), "mm", words.get(name, "")
        )
        for name in given
    }
    leg = replace(leg, **changes, chain=trace.record(known.chain, "chain_"))
    trace.name(leg, "")
    for joint in ("hip", "knee"):
        stop = space("leg.stops")[f"{joint}_stop"](leg)
        trace.name(stop, f"{joint}_stop_")
        trace.ends |= {f"{joint}_lower": stop.lower_rad, f"{joint}_upper": stop.upper_rad}
    return leg


def _actuator(plain: Actuator, motor: Motor, settings: ActuatorSettings, scope: str, trace: Trace) -> _Actuator:
    """Return the parts of an actuator, whose gears mesh by the formulas of ``GearSet``."""
    gears, layouts, trace.scope = _gears(plain, settings, scope, trace), space("actuator.layout"), f"{scope}_"
    width = trace.driver(f"{scope}_face_width", plain.face_width_mm, "mm", f"face width of the {scope}'s gears")
    at = layouts["layout"](motor, plain.family, gears, width, settings)
    shell = layouts["internal_layout" if plain.family == "ISSPG" else "external_layout"](at, motor, settings)
    for record, prefix in ((at, ""), (at.webs, "web_"), (shell, "")):
        trace.name(record, f"{scope}_{prefix}")
    parts = space("actuator.actuator")["actuator_parts"](at, motor, plain.family, settings)
    ends = [prism.z0_mm for part in parts if part.role not in _STANDING_OUT for prism in part.prisms]
    length = -min(ends, key=builtins.float)
    trace.call(length, f"{scope}_length", "from the output face to the back")
    return _Actuator(
        parts, plain.family, space("actuator.actuator")["mount_interface"](motor, plain.family, settings), length
    )


def _gears(plain: Actuator, settings: ActuatorSettings, scope: str, trace: Trace) -> GearSet:
    old, words = plain.gears, words_of(GearSet)

    def given(name: str, unit: str = "") -> Any:
        return trace.driver(short(f"{scope}_{name}"), getattr(old, name), unit, words.get(name, ""))

    sun, planet, module = given("sun_teeth"), given("planet_teeth"), given("module_mm", "mm")
    thinner: Any = settings.tooth_thinning_mm(module)
    gears = GearSet(
        sun_teeth=sun,
        planet_teeth=planet,
        ring_teeth=sun + 2 * planet if old.ring_teeth == old.sun_teeth + 2 * old.planet_teeth else given("ring_teeth"),
        module_mm=module,
        planets=given("planets"),
        centre_shift=given("centre_shift"),
        sun_shift=given("sun_shift"),
        backlash_mm=thinner if abs(thinner - old.backlash_mm) < 1e-12 else given("backlash_mm", "mm"),
        tips_fitted=old.tips_fitted,
    )
    trace.rules.append((gears.sun_teeth + gears.ring_teeth) % gears.planets == 0.0)
    for name, gear in (("sun", gears.sun()), ("planet", gears.planet()), ("ring", gears.ring())):
        trace.name(gear, f"{scope}_{name}_")
    trace.name(gears, f"{scope}_")
    return gears


def living_model(product: Product, maps: Maps) -> LivingModel:
    """Return a product as drivers, formulas and a program."""
    base = (resources.files("pareto_monoped") / "data" / "living_model.py").read_text(encoding="utf-8")
    functions = {*re.findall(r"^def (\w+)", base, re.MULTILINE), *(unique.name for unique in product.unique)}
    trace, pose = Trace(functions), product.pose
    for joint, angle in (("hip", pose.hip_rad), ("knee", pose.knee_rad)):
        trace.driver(f"{joint}_angle", angle, "deg", f"{joint} of the assembly; 0 hangs straight down")
    with tracing(trace):
        units = _traced_units(product.robot, maps, trace)
        found = [(rule, True) for rule in trace.rules if isinstance(rule, Condition)]
        found += [pair for pair in conditions() if _matters(*pair)]
        writer = Writer(trace)
        writer.used |= {"hip_angle", "knee_angle", "thigh_length", *_RACK}
        bought = {unique.name for unique in product.unique if unique.part.process == "bought"}
        # What only bought parts depend on is no driver: these are as they are sold.
        parts = _parts(writer, product, units, without=bought)
        last = [*_units(writer, product, units), *_ranges(writer, trace)]
        writer.kept = frozenset(writer.used)
        parts |= _parts(writer, product, units, without=set(parts))
        last += _conditions(writer, found)
    drivers = tuple(driver for name, driver in trace.drivers.items() if name in writer.used)
    own = tuple(writer.formulas.values())
    body = [*_rule("4. PARTS"), *(line for unique in product.unique for line in parts[unique.name]), *last]
    program = _between(base, "drivers and equations", [*_given(drivers), *_following(own)])
    program = _between(program, "parts and assembly", body)
    return LivingModel(drivers=drivers, formulas=own, lines=tuple(writer.lines), program=program)


def _between(text: str, place: str, lines: Sequence[str]) -> str:
    """Return a text with lines instead of what stands between two marks."""
    (before, _, rest), mark = text.partition(f"# <{place}>\n"), f"# </{place}>\n"
    return before + "\n".join([*lines, ""]) + rest.partition(mark)[2]


def _rule(title: str) -> list[str]:
    line = f"# {117 * '-'}"
    return [line, f"# {title}", line]


def _given(drivers: Sequence[Driver]) -> Iterator[str]:
    first = _ORDER + tuple(dict.fromkeys(driver.name.split("_")[0] for driver in drivers))
    for title, detail in (("1. DRIVERS", False), ("1b. DETAILS: further drivers, of single parts", True)):
        yield from _rule(title)
        own = [driver for driver in drivers if driver.detail == detail]
        group = ""
        for driver in sorted(own, key=lambda one: first.index(one.name.split("_")[0])):
            begins = driver.name.split("_")[0]
            if begins != group:
                group = begins
                yield ""
                yield f"# {group.capitalize()}"
            words = f"{driver.unit}: {driver.meaning}".strip(": ")
            yield f"{driver.name} = {_plain(driver.value)}" + (f"  # {words}" if words else "")
        yield ""
    yield "DRIVERS = {"
    yield from (f'    "{driver.name}": "{driver.unit}",' for driver in drivers)
    yield "}"
    yield "given(globals())"
    yield ""


def _plain(value: float) -> str:
    return f"{value:.12g}" if value != round(value) else f"{value:.1f}"


def _following(formulas: Sequence[Formula]) -> Iterator[str]:
    yield from _rule("2. EQUATIONS")
    for formula in formulas:
        yield f"{formula.name} = {formula.text}" + (f"  # {formula.meaning}" if formula.meaning else "")
    yield ""


def _parts(writer: Writer, product: Product, units: _Units, *, without: set[str]) -> dict[str, list[str]]:
    """Return the functions of all parts but some, as lines by the parts' names."""
    found: dict[str, list[str]] = {}
    for plain, name, part in _named(product, units):
        if name not in without and name not in found:
            found[name] = list(_function(writer, name, plain, part))
    return found


def _function(writer: Writer, name: str, plain: Part, part: Part) -> Iterator[str]:
    grade = "" if plain.grade is None else f", {plain.grade.name}"
    colour = tuple(round(value, 4) for value in plain.material.colour)
    density = plain.material.density_kg_per_m3 / 1e3
    yield ""
    yield ""
    yield f'@part("{plain.material.name}{grade}", {density:.6g}, {colour}, "{plain.process}")'
    yield f"def {name}():"
    words = (plain.described or name.replace("_", " ")).replace("\\", "/").replace('"', "'")
    yield f'    """{words[0].upper()}{words[1:]}."""'
    geometry = (part.prisms, part.balls, part.bevels)
    own: dict[int, str] = {}
    for one in repeated(writer, geometry):
        writer.own = own
        text = writer.text(one)
        own[id(one)] = f"d{len(own) + 1}"
        yield f"    {own[id(one)]} = {text}"
    writer.own = own
    yield "    return ["
    for step in steps(writer, part):
        yield from _broken(f"        {step},")
    yield "    ]"
    writer.own = {}


def _broken(text: str) -> list[str]:
    """Return a call in lines that are not too long, broken at the commas between its arguments."""
    opened = re.match(r"\s*(?:\w+=)?\w*[(\[]", text)
    if len(text) <= _WIDTH or opened is None:
        return [text]
    indent, start = len(text) - len(text.lstrip()), opened.end()
    pieces, depth, last = [], 1, start
    for k in range(start, len(text)):
        depth += (text[k] in "([") - (text[k] in ")]")
        if (text[k] == "," and depth == 1) or depth == 0:
            pieces.append(text[last:k].strip())
            last = k + 1
        if depth == 0:
            break
    if text[last:].strip(",") or len(pieces) < 2:
        return [text]
    inner = [line for piece in pieces for line in _broken(" " * (indent + 4) + piece + ",")]
    return [text[:start], *inner, " " * indent + text[last - 1 :]]


def _named(product: Product, units: _Units) -> Iterator[tuple[Part, str, Part]]:
    """Yield each part with its unique name and its traced twin."""
    names = {id(unique.part): unique.name for unique in product.unique}
    for unit, (parts, _) in zip(product.robot.units, units, strict=True):
        for plain, part in zip(unit.parts, parts, strict=True):
            yield plain, names[id(plain)], part


def _units(writer: Writer, product: Product, units: _Units) -> Iterator[str]:
    yield from ("", "", *_rule("5. ASSEMBLY"))
    names = {id(unique.part): unique.name for unique in product.unique}
    for unit, (parts, z) in zip(product.robot.units, units, strict=True):
        over = bool(unit.turn[1, 1] < 0.0)
        yield f'unit("{unit.name}", "{unit.body}", {writer.text(z)}, {over},'
        for plain, part in zip(unit.parts, parts, strict=True):
            own = [names[id(plain)]]
            if any(isinstance(one, Traced) or one for place in part.places_mm for one in place):
                own.append(argument(writer, list(part.places_mm)))
            if isinstance(part.pitch_radius_mm, Traced) or part.pitch_radius_mm:
                own += [f"radius={writer.text(part.pitch_radius_mm)}", f"count={writer.text(part.count)}"]
                if isinstance(part.phase_rad, Traced) or part.phase_rad:
                    own.append(f"phase={writer.text(part.phase_rad)}")
            moves = _moves(product.robot, unit.name, plain, over)
            yield from _broken(f"    {call_of('use', *own, *moves)},")
        yield ")"


def _moves(robot: Robot, unit: str, part: Part, over: bool) -> list[str]:
    """Return by what a part turns when its joint does, as ``assembly.turns`` has it."""
    if unit == "thigh" and part.group is Group.KNEE_DRIVE:
        return ["moves=lambda place: (-radians(knee_angle), 0.0)"]
    if unit not in ACTUATOR_UNITS or part.group in (Group.HOUSING, Group.FIXED):
        return []
    joint = ACTUATOR_UNITS[unit]
    scope, angle = _scope(robot, joint), f"{'' if over else '-'}radians({joint}_angle)"
    if part.group is Group.OUTPUT:
        return [f"moves=lambda place: ({angle}, 0.0)"]
    if part.group is Group.ROTOR:
        return [f"moves=lambda place: ({angle} * (1 + {scope}_ring_teeth / {scope}_sun_teeth), 0.0)"]
    rolled = f"(place * {scope}_sun_teeth - {angle} * {scope}_ring_teeth) / {scope}_planet_teeth"
    return [f"moves=lambda place: ({angle}, {rolled})"]


def _ranges(writer: Writer, trace: Trace) -> Iterator[str]:
    for joint in ("hip", "knee"):
        ends = [writer.text(trace.ends[f"{joint}_{end}"]) for end in ("lower", "upper")]
        yield f"{joint}_range = (degrees({ends[0]}), degrees({ends[1]}))"


def _conditions(writer: Writer, found: Sequence[tuple[Condition, bool]]) -> Iterator[str]:
    yield "# Under which the parts have the form of section 4."
    yield "CONDITIONS = ["
    texts: dict[str, None] = {}
    for condition, holds in found:
        if condition.op in OPPOSITE:
            left, right = (writer.text(arg, 1) for arg in condition.args)
            text = f"{left} {condition.op if holds else OPPOSITE[condition.op]} {right}"
            if re.search("[a-z]_", text):
                texts[text] = None
    yield from (f'    "{text}",' for text in texts)
    yield "]"
    yield ""
    yield ""


def _matters(condition: Condition, holds: bool) -> bool:
    """Return whether a condition compares drivers, and not with a table; layers of no height are left out anyway."""
    numbers = all(isinstance(arg, Traced) for arg in condition.args)
    return numbers or (condition.op == "<" and condition.args[1] == 1e-9 and holds)

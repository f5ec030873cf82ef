"""Joints of an actuator's drive: motor, coupling, spline, shaft, sun, planet pins, ring, and the second carrier's
webs.

What turns at the motor's speed carries the gearbox's torque over the ratio: in an end stop, the rotor drives from
behind, and the output's torque reaches back through the sun as well. All capacities are torques at the output.

The planets press their pins with half of their load into either carrier. What the second carrier gets, half of the
output's torque, goes back to the first one through the webs; that the pins are clamped as well is not counted.
"""

from collections.abc import Callable

import numpy as np

from pareto_monoped.actuator.bearings import RetainingRing
from pareto_monoped.actuator.front import z_pin_front
from pareto_monoped.actuator.gearset import load_sharing
from pareto_monoped.actuator.layout import Layout, layout
from pareto_monoped.actuator.webs import SCREW as WEB_SCREW
from pareto_monoped.geometry.gears import ExternalGear
from pareto_monoped.geometry.parts import Part, Prism
from pareto_monoped.geometry.roles import Group, Role
from pareto_monoped.geometry.shapes import Arc, Circle, Pattern
from pareto_monoped.geometry.tightening import YIELD_MPA, Fastening
from pareto_monoped.materials import ALLOYS, Materials
from pareto_monoped.strength.connections import (
    BOND_SAFETY,
    FRICTION,
    MISES,
    SHAPE_SAFETY,
    SLIP_SAFETY,
    bearing_force_n,
    bond_torque_n_m,
    least_preload_n,
    pin_bending_force_n,
    shear_force_n,
    slip_force_n,
    spline_torque_n_m,
    torsion_torque_n_m,
)
from pareto_monoped.strength.joint import SIDES, ActuatorJoint, Side, Structure

MOTOR_FACE_MPA = ALLOYS["aw_6082_t6"].yield_mpa
"""Yield of a motor's turning face and bell, whose alloy makers do not publish; our own assumption."""
_SHAPE = "our own choice: dowels and teeth that share a load do not quite share it evenly"
_SLIP = "VDI 2230-1, R12: against slip under static load"


def one(s: Structure, role: Role, group: Group) -> Part:
    """Return the actuator's only part of a role and group."""
    (found,) = (part for part in s.actuator.parts if part.role is role and part.group is group)
    return found


def yield_mpa(part: Part) -> float:
    """Return the yield stress of the alloy that a part is ordered in."""
    assert part.grade is not None
    return part.grade.yield_mpa


def layout_of(s: Structure) -> Layout:
    """Return the heights and radii of the actuator."""
    a = s.actuator
    return layout(a.motor, a.family, a.gears, a.face_width_mm, s.settings)


def engaged_mm(pin: Part, other: Part) -> float:
    """Return the length over which a circle of pins stands in its holes in another part of the same frame."""
    low, high = min(float(p.z0_mm) for p in pin.prisms), max(float(p.z1_mm) for p in pin.prisms)
    return sum(
        max(0.0, min(high, float(prism.z1_mm)) - max(low, float(prism.z0_mm)))
        for prism in other.prisms
        if any(_holds(hole, pin) for hole in prism.holes)
    )


def _holds(hole: object, pin: Part) -> bool:
    outline = pin.prisms[0].outline
    if not isinstance(hole, Pattern) or not isinstance(outline, Circle):
        return False
    of_hole = [float(v) for v in (hole.radius_mm, hole.pitch_radius_mm, hole.phase_rad, hole.count)]
    of_pin = [float(v) for v in (outline.radius_mm, pin.pitch_radius_mm, pin.phase_rad, pin.count)]
    return np.allclose(of_hole, of_pin)


def dowel_force_n(pin: Part, *layers: tuple[float, float]) -> float:
    """Return the force at which a layer (engaged length in mm, yield stress in MPa) or a circle's dowels yield."""
    outline = pin.prisms[0].outline
    assert isinstance(outline, Circle)
    diameter = 2.0 * float(outline.radius_mm)
    holes = min(bearing_force_n(diameter, length, stress) for length, stress in layers)
    return float(pin.count) * min(holes, shear_force_n(diameter, yield_mpa(pin)))


def spline(s: Structure) -> float:
    """Return the output torque at which the spline yields the coupling."""
    coupling = one(s, Role.COUPLING, Group.ROTOR)
    hub, teeth = _spline(coupling)
    length = float(hub.z1_mm) - float(hub.z0_mm)
    torque = spline_torque_n_m(
        float(teeth.teeth), float(teeth.base_radius_mm), float(teeth.tip_radius_mm), length, yield_mpa(coupling)
    )
    return s.actuator.ratio * torque


def _spline(coupling: Part) -> tuple[Prism, ExternalGear]:
    """Return the slab of the coupling with the spline, and the spline."""
    ((hub, teeth),) = (
        (prism, hole) for prism in coupling.prisms for hole in prism.holes if isinstance(hole, ExternalGear)
    )
    return hub, teeth


def shaft(s: Structure) -> float:
    """Return the output torque at which the sun's shaft yields between spline and teeth, at its thinnest.

    Where the spline's roots lie below the shaft, a hob runs out into it. What is left of the section there is at least
    the round one within the roots, which counts.
    """
    sun, (hub, _) = one(s, Role.GEAR, Group.ROTOR), _spline(one(s, Role.COUPLING, Group.ROTOR))
    toothed = [prism for prism in sun.prisms if isinstance(prism.outline, ExternalGear)]
    low, high = float(hub.z0_mm), max(float(prism.z1_mm) for prism in toothed)
    loaded = [prism.outline for prism in sun.prisms if low <= prism.z0_mm and prism.z1_mm <= high]
    radii = [float(shape.root_radius_mm) for shape in loaded if isinstance(shape, ExternalGear)]
    radii += [float(shape.radius_mm) for shape in loaded if isinstance(shape, Circle)]
    return s.actuator.ratio * torsion_torque_n_m(min(radii), s.settings.gear_steels.sun.yield_mpa)


def coupling_dowels(s: Structure) -> float:
    """Return the output torque at which the dowels between motor and coupling yield a hole."""
    pin = one(s, Role.PIN, Group.ROTOR)
    coupling, rotor = one(s, Role.COUPLING, Group.ROTOR), one(s, Role.MOTOR_ROTOR, Group.ROTOR)
    force = dowel_force_n(
        pin, (engaged_mm(pin, coupling), yield_mpa(coupling)), (engaged_mm(pin, rotor), MOTOR_FACE_MPA)
    )
    return s.actuator.ratio * 1e-3 * force * float(pin.pitch_radius_mm)


def screw_slip_torque_n_m(screw: Part, s: Structure) -> float:
    """Return the torque about the actuator's axis at which a circle of screws slips."""
    preload = screw_preload_n(screw, s.settings.materials)
    return 1e-3 * slip_force_n(float(screw.count), preload) * float(screw.pitch_radius_mm)


def screw_preload_n(screw: Part, materials: Materials) -> float:
    """Return the least preload of a steel screw in aluminium."""
    return least_preload_n(
        fastening(screw),
        shank_and_thread_mm(screw)[0],
        steel_mpa=materials.steel.youngs_modulus_mpa,
        clamped_mpa=materials.aluminium.youngs_modulus_mpa,
    )


def fastening(screw: Part) -> Fastening:
    """Return how a screw is tightened."""
    assert screw.fastening is not None
    return screw.fastening


def shank_and_thread_mm(screw: Part) -> tuple[float, float]:
    """Return the length of a screw's shank, which is its grip, and of its thread, which is drawn thinner."""
    nominal = 0.5 * fastening(screw).thread.diameter_mm
    spans = {
        float(prism.outline.radius_mm): float(prism.z1_mm) - float(prism.z0_mm)
        for prism in screw.prisms
        if isinstance(prism.outline, Circle)
    }
    shank = min(spans, key=lambda radius: abs(radius - nominal))
    return spans[shank], spans[min(spans)]


def housing_screws(s: Structure) -> float:
    """Return the output torque of the motor at which a joint of the housing slips that carries the motor's reaction.

    In the ESSPG, base, backplate and casing pass it on to the ring housing. In the ISSPG, the stator is bonded onto the
    ring housing.
    """
    a = s.actuator
    if a.family == "ISSPG":
        stator = one(s, Role.MOTOR_STATOR, Group.HOUSING)
        length = max(float(p.z1_mm) for p in stator.prisms) - min(float(p.z0_mm) for p in stator.prisms)
        return a.ratio * bond_torque_n_m(float(layout_of(s).r_stator_in), length) / BOND_SAFETY * SLIP_SAFETY
    at_least_mm = _RING_SHARE * a.motor.outer_diameter_mm
    screws = [
        part
        for part in a.parts
        if part.role is Role.STATOR_SCREW
        or (part.role is Role.SCREW and part.group is Group.HOUSING and float(part.pitch_radius_mm) > at_least_mm)
    ]
    return a.ratio * min(screw_slip_torque_n_m(part, s) for part in screws)


_RING_SHARE = 0.35
"""Circle of the housing's own screws over the motor's diameter at least: those of small parts lie further in."""


def ring(s: Structure) -> float:
    """Return the output torque at which the bonded ring turns in its housing; it takes 1 - 1 / i of it."""
    at = layout_of(s)
    return bond_torque_n_m(float(at.r_ring), s.actuator.face_width_mm) / (1.0 - 1.0 / s.actuator.ratio)


def ring_housing(s: Structure) -> float:
    """Return the output torque at which the dowels of the ring housing yield a hole; infinite in an ESSPG."""
    pins = [part for part in s.actuator.parts if part.role is Role.PIN and part.group is Group.HOUSING]
    if not pins:
        return float(np.inf)
    (pin,) = pins
    layers = []
    for part in s.actuator.parts:
        if part.role is Role.HOUSING and (length := engaged_mm(pin, part)) > 0.0:
            layers.append((length, yield_mpa(part)))
    return 1e-3 * dowel_force_n(pin, *layers) * float(pin.pitch_radius_mm)


def planet_pins(s: Structure) -> tuple[float, float]:
    """Return the output torques at which a planet's pin yields in bending, and at which it yields its shorter seat."""
    a, at, carrier = s.actuator, layout_of(s), s.settings.parts.carrier
    (pin,) = (part for part in a.parts if part.role is Role.PIN and part.group is Group.OUTPUT)
    seats_mm = (float(z_pin_front(at, s.settings) - at.z_shoulder), carrier.pin_depth_mm)
    span = float(at.z_shoulder - at.z_secondary_front)
    bending = pin_bending_force_n(carrier.pin_diameter_mm, span, yield_mpa(pin))
    # Half of the load on either seat, one of which is short.
    seat = 2.0 * bearing_force_n(carrier.pin_diameter_mm, min(seats_mm), ALLOYS["aw_7075_t6"].yield_mpa)
    lever_m = 1e-3 * float(at.r_pins) * float(a.gears.planets) / float(load_sharing(a.gears.planets, s.settings))
    return bending * lever_m, seat * lever_m


_Row = tuple[str, str, str, tuple[float, str], Callable[[Structure], float], tuple[str, ...]]
"""Name, formula, source, required factor with its reason, capacity, parts: of rows that the gearbox's torque loads."""
_SHAPES, _BONDS = (SHAPE_SAFETY, _SHAPE), (BOND_SAFETY, "our own choice: a bond cannot be inspected")
_DOWELS = "Roloff/Matek, 9.2: pressure in the holes of pins"
_GEARBOX: tuple[_Row, ...] = (
    ("spline", "k z h l r_m Rp0.2 i / T", "Roloff/Matek, 12.3; DIN 5466", _SHAPES, spline, ("sun", "coupling")),
    ("sun_shaft", "tau_y pi r^3 / 2 i / T, r within the roots and the hob's run-out", "torsion, von Mises",
        _SHAPES, shaft, ("sun",)),
    ("coupling_dowels", "n d l Rp0.2 r i / T", _DOWELS, _SHAPES, coupling_dowels, ("coupling_dowel",)),
    ("ring_bond", "tau 2 pi r^2 b / (1 - 1 / i) / T", "bonded cylinder, ISO 10123", _BONDS, ring, ("ring",)),
    ("ring_housing_dowels", "n d l Rp0.2 r / T", _DOWELS, _SHAPES, ring_housing, ("ring_housing_dowel",)),
    ("planet_pin_bending", "8 W Rp0.2 / L n r / K_gamma / T", "beam on two supports", _SHAPES,
        lambda s: planet_pins(s)[0], ("planet_pin",)),
    ("planet_pin_seat", "2 d l Rp0.2 n r / K_gamma / T", _DOWELS, _SHAPES,
        lambda s: planet_pins(s)[1], ("planet_pin",)),
)  # fmt: skip


def _loaded(side: Side, row: _Row) -> ActuatorJoint:
    """Return the row of one side that its gearbox's torque loads."""
    name, formula, source, (required, reason), capacity, parts = row
    return ActuatorJoint(
        name=f"{side}_{name}",
        group="joints",
        side=side,
        formula=formula,
        source=source,
        required=required,
        required_source=reason,
        loads=(f"peak_gear_torque_{side}_n_m",),
        capacity=capacity,
        parts=parts,
        cure=f"release the {side}'s torque before its stop, or another {side}_ratio",
    )


JOINTS = (
    *(_loaded(side, row) for side in SIDES for row in _GEARBOX),
    *(
        ActuatorJoint(name=f"{side}_motor_reaction", group="joints", side=side, capacity=housing_screws,
            formula=f"n {FRICTION} F_V r i / T; ISSPG: bond of the stator, brought to the same required factor",
            source="VDI 2230-1; bonded cylinder, ISO 10123", required=SLIP_SAFETY, required_source=_SLIP,
            loads=(f"peak_torque_{side}_n_m",), cure="larger screws",
            parts=("backplate_screw", "casing_screw", "stator_screw", "motor_stator"))
        for side in SIDES
    ),
)  # fmt: skip
_SHARE = 0.5
"""Of the output's torque, in the second carrier: both seats of a pin are alike."""
_REASON = (
    "our own choice against yield; countersunk heads have no play in their seats, so that all webs carry from the first"
)


def sheared_n(screw: Fastening) -> float:
    """Return the force across a tightened screw at which its core yields: what its preload leaves by von Mises.

    The torsion of tightening has gone by then. The friction of the joint comes on top and is not counted.
    """
    yielding = YIELD_MPA[screw.property_class]
    pulled = screw.preload_n / screw.thread.stress_area_mm2
    return float(screw.thread.core_area_mm2 * np.sqrt((yielding**2 - pulled**2) / 3.0))


def _at_output_n_m(force_n: float, count: float, radius_mm: float) -> float:
    return 1e-3 * count * force_n * radius_mm / _SHARE


def screws(s: Structure) -> float:
    """Return the output torque at which a screw of the webs yields in shear; infinite without webs."""
    webs = layout_of(s).webs
    if not webs.present:
        return float(np.inf)
    (screw,) = (
        part
        for part in s.actuator.parts
        if part.role is Role.SCREW
        and part.group is Group.OUTPUT
        and np.isclose(float(part.pitch_radius_mm), float(webs.r_screw_mm))
        and np.isclose(float(part.phase_rad), float(webs.phase_rad))
    )
    return _at_output_n_m(sheared_n(fastening(screw)), float(screw.count), float(screw.pitch_radius_mm))


def bending(s: Structure) -> float:
    """Return the output torque at which a web, clamped in both carriers, yields at its ends; infinite without webs."""
    at = layout_of(s)
    webs = at.webs
    if not webs.present:
        return float(np.inf)
    outer = webs.path.pieces[0]
    assert isinstance(outer, Arc)
    half_width = float(outer.radius_mm) * float(np.sin(float(outer.end_rad)))
    modulus = (float(webs.section.second_moment_mm4) - 0.25 * np.pi * WEB_SCREW.core**4) / half_width
    length = float(at.z_shoulder - at.z_secondary_front)
    carrier = max(
        (part for part in s.actuator.parts if part.role is Role.CARRIER), key=lambda part: float(part.mass_kg())
    )
    force = 2.0 * modulus * yield_mpa(carrier) / length  # M = F L / 2
    return _at_output_n_m(force, float(webs.count), float(webs.r_screw_mm))


_WEBS: tuple[_Row, ...] = (
    ("web_screws", "n A_d3 sqrt((Rp0.2^2 - (F_M / A_s)^2) / 3) r / (T / 2)",
        "von Mises in the core of a tightened screw; VDI 2230-1, 5.5.6, for what overcomes friction",
        (1.2, _REASON), screws, ("web_screw", "carrier", "secondary_carrier")),
    ("webs", "n 2 W Rp0.2 r / L / (T / 2)",
        "beam clamped at both ends: Roark's Formulas for Stress and Strain, chapter 8",
        (1.2, _REASON), bending, ("carrier",)),
)  # fmt: skip
WEB_JOINTS = tuple(_loaded(side, row) for side in SIDES for row in _WEBS)


def collar_force_n(ring: RetainingRing, yielding_mpa: float) -> float:
    """Return the force along the axis at which a retaining ring yields the metal around its groove.

    The ring presses on half the depth t of the groove d2 in the mean, so that a collar of thickness n bends at its root
    with 3 F t / (pi d2 n^2) and shears with F / (pi d2 n); the groove's wall takes F over its own area. That the collar
    is closed around, and stiffer than a beam, is not counted. Rings of spring steel carry several times as much.
    """
    d1, d2, n = float(ring.size_mm), float(ring.groove_diameter_mm), float(ring.collar_mm)
    depth, around = 0.5 * abs(d2 - d1), np.pi * d2
    bent, sheared, pressed = around * n**2 / (3.0 * depth), around * n * MISES, 0.25 * np.pi * abs(d2**2 - d1**2)
    return float(yielding_mpa * min(bent, sheared, pressed))


def retaining_rings(s: Structure) -> float:
    """Return the force along the axis that the rings beside an actuator's main bearing carry."""
    at, grades = layout_of(s), {part.name: yield_mpa(part) for part in s.actuator.parts if part.grade is not None}
    forces = [collar_force_n(at.shaft_ring, grades["carrier"])]
    if s.actuator.family == "ESSPG":
        forces.append(collar_force_n(at.bore_ring, grades["ring_housing"]))
    return min(forces)


_SIDEWAYS: dict[Side, tuple[str, float, str]] = {
    "hip": ("peak_foot_force_n", 1.0, "rubber slips at 0.6 to 0.9 of its load"),
    "knee": ("peak_chain_tension_n", 0.05, "sprockets out of line by 3 degrees"),
}
"""What the floor or the chain may push along the joint's axis: the load, its share, and why; our own choice, as the leg
is simulated in its plane."""
RING_JOINTS = tuple(
    ActuatorJoint(name=f"{side}_retaining_rings", group="joints", side=side,
        formula=f"least of pi d2 n^2 / (3 t), pi d2 n / sqrt(3), groove's wall, times Rp0.2 / ({share:g} F)",
        source=f"collar as a cantilever and in shear, DIN 471 and 472; {why}", required=1.2,
        required_source="our own choice against yield", loads=(load,),
        capacity=retaining_rings, factor=lambda force, load, share=share: force / (share * load),
        parts=("retaining_ring", "bore_retaining_ring", "carrier", "ring_housing"), cure="jump lower")
    for side, (load, share, why) in _SIDEWAYS.items()
)  # fmt: skip

"""The dimension chains of a robot: those of both gearboxes, and those of the leg between and beside them."""

from collections.abc import Mapping
from dataclasses import replace

from pareto_monoped.actuator.tolerances import gearbox_chains, length_link
from pareto_monoped.geometry.chains import Chain, Link
from pareto_monoped.geometry.parts import Part
from pareto_monoped.leg.chain import TRAVEL, links_of
from pareto_monoped.leg.stops import hip_stop, knee_stop
from pareto_monoped.robot.build import Robot

_PLATE_MM = 0.1
"""Within which plates of 2.5 to 8 mm are as thick as drawn (EN 485-4, cold-rolled, up to 1 m wide)."""
_HOUSING_MM = 0.3
"""Within which an actuator is as long as drawn, over casing, ring housing and backplate; our own choice."""
_HOLES_MM = 0.05
"""Within which holes of a plate stand as far apart as drawn: half the zone of position on the drawings, twice."""
_CUT_MM = 0.1
"""Within which laser-cut edges and milled seats stand where they are drawn (ISO 2768-f, 6 to 30 mm)."""
_BUMPER_MM = 0.5
"""Within which an extruded bar of rubber has its diameter; our own assumption, makers give 0.3 to 0.8 mm."""
_BAR_MM = 0.2
"""Within which the bars of the turnbuckles are cut; our own choice."""
_CHAIN_SHARE = 0.0015
"""By how much a chain may be longer than its links together (ISO 606, clause 4.5)."""
_WEAR_MM = 1.0
"""Of the turnbuckles' travel at either end, to be left for wear; our own choice."""
_STOP_RAD = 0.035
"""Two degrees, within which the end stops meet; our own choice."""


def robot_chains(robot: Robot) -> tuple[Chain, ...]:
    """Return all chains of a robot; those of the gearboxes are named after their joint."""
    parts = {part.name: part for unit in robot.units for part in unit.parts}
    gearboxes = (
        replace(chain, name=f"{joint} actuator: {chain.name}")
        for joint, actuator in (("hip", robot.hip), ("knee", robot.knee))
        for chain in gearbox_chains(actuator)
    )
    return (*gearboxes, *_lateral(robot, parts), *_strand(robot), *_stops(robot))


def _lateral(robot: Robot, parts: Mapping[str, Part]) -> tuple[Chain, ...]:
    """Return the chains along the joints' axes: bearings of the knee, and the leg between both cheeks."""
    leg, core = robot.leg, length_link(parts["thigh_core"], "thickness")
    width = length_link(parts["knee_bearing"], "width", -1.0)

    def plate(part: str, nominal_mm: float, sign: float = -1.0) -> Link:
        return Link.about(part, "thickness", _PLATE_MM, nominal_mm=nominal_mm, sign=sign)

    return (
        Chain(
            name="axial play of the knee",
            links=(core, width, replace(width, which=1), length_link(parts["knee_axle"], "shoulders", -1.0)),
            cure="make the axle's shoulders shorter",
        ),
        Chain(
            name="journal's shoulder to the far bearing",
            links=(
                plate("base_near_cheek", leg.cheek_mm, 1.0),
                length_link(parts["base_rod"], "length"),
                length_link(parts["hip_coupling"], "thickness", -1.0),
                plate("thigh_inner_plate", leg.plate_mm),
                replace(core, sign=-1.0),
                plate("thigh_outer_plate", leg.plate_mm),
                Link.about("knee_actuator", "length", _HOUSING_MM, nominal_mm=robot.knee.length_mm),
                length_link(parts["journal"], "reach", -1.0),
            ),
            cure="raise the float of the far bearing",
        ),
    )


def _strand(robot: Robot) -> tuple[Chain, ...]:
    """Return what the turnbuckles' travel leaves when every length is at its worst; both ends move."""
    leg = robot.leg
    longer_mm = _CHAIN_SHARE * links_of(leg) * leg.chain.pitch_mm

    pieces = (
        Link(part=f"chain_{end}", name="length", sign=-1.0, nominal_mm=0.0, lower_mm=0.0, upper_mm=longer_mm)
        for end in ("hip", "knee")
    )
    forks = (Link.about("turnbuckle_end", "length", _BAR_MM, which=which) for which in (0, 1))
    travel = Link.about("turnbuckle_bar", "travel", _BAR_MM, nominal_mm=2.0 * TRAVEL, sign=1.0)
    plate = Link.about("thigh_inner_plate", "length", _HOLES_MM)
    return (
        Chain(
            name="travel of the turnbuckles",
            links=(travel, plate, *pieces, *forks),
            least_mm=2.0 * _WEAR_MM,
            cure="raise the travel of the turnbuckles",
        ),
    )


def _stops(robot: Robot) -> tuple[Chain, ...]:
    """Return by how much the end stops of either joint may still be off where they meet, on their levers."""
    stops = {"hip": hip_stop(robot.leg), "knee": knee_stop(robot.leg)}

    return tuple(
        Chain(
            name=f"angle of the {joint}'s end stops, on their lever",
            links=(
                Link.about(f"{joint}_stop", "allowed", 0.0, nominal_mm=_STOP_RAD * stop.lever_mm, sign=1.0),
                Link.about(f"{joint}_seat", "face", _CUT_MM),
                Link.about(f"{joint}_bumper", "face", _BUMPER_MM),
                Link.about(f"{joint}_striker", "face", _CUT_MM),
            ),
            cure="grind the bumpers to their diameter",
        )
        for joint, stop in stops.items()
    )

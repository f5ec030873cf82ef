"""What is known of all motors' gearboxes, joints and robots is as it was when the files in ``signatures`` were made.

That was after all other tests had passed. It says that something changed, not that it was right. After a change that
is wanted, make it again: ``PARETO_MONOPED_SIGN=1 python -m pytest tests/robot/test_signatures.py``.
"""

from pathlib import Path

import numpy as np
import pytest

from pareto_monoped.actuator.judge import Judge, candidates
from pareto_monoped.actuator.layout import radial_room_mm
from pareto_monoped.actuator.motors import load_motor, motor_names
from pareto_monoped.actuator.rating.build import build_stage
from pareto_monoped.actuator.rating.width import strength_margins
from pareto_monoped.actuator.ratiomap import joint_maps
from pareto_monoped.actuator.rules import CONSTRAINTS, active_rules
from pareto_monoped.actuator.search import map_for
from pareto_monoped.actuator.service.sheet import service_sheet
from pareto_monoped.actuator.tolerances import gearbox_chains
from pareto_monoped.design import Design
from pareto_monoped.robot.build import build_robot
from pareto_monoped.robot.cost import robot_cost
from pareto_monoped.robot.tolerances import robot_chains
from pareto_monoped.strength.factors import capacities
from tests.records import compare, signature

HERE = Path(__file__).parent / "signatures"
EVERY = 4  #: of the gearboxes of a map; the first of each family stands always


def chosen(found):
    """Some of a map's gearboxes, among them both families where it has them."""
    built = [entry.actuator for entry in found.entries if entry.actuator is not None]
    first = {actuator.family: actuator for actuator in reversed(built)}
    return list({id(one): one for one in (*first.values(), *built[::EVERY])}.values())


def gearboxes(motor):
    """What is known of a motor's gearboxes: what was searched, and some of them with all that follows from them."""
    found = map_for(motor)
    entries = [(entry.ratio_low, entry.runner_up, entry.families) for entry in found.entries]
    yield "searched", (found.motor, entries)
    for actuator in chosen(found):
        sheet = service_sheet(actuator, found.settings)
        known = (actuator, sheet, gearbox_chains(actuator), robot_cost([actuator.parts]))
        yield f"{actuator.family} {actuator.ratio:.4f}", known


def margins(name):
    """By how much some gear sets of a motor keep each rule, or break it."""
    motor, settings = load_motor(name), map_for(name).settings
    for family in ("ISSPG", "ESSPG"):
        if (motor.frameless if family == "ISSPG" else motor.framed) is None:
            continue
        judge = Judge(motor=motor, family=family, settings=settings)
        gears = candidates(radial_room_mm(motor, family, settings), settings)
        some = gears.where(np.arange(len(np.asarray(gears.sun_teeth))) % 499 == 0)
        width = np.maximum(6.0, 6.0 * some.module_mm)
        stage = build_stage(some, motor, family, settings)
        strength = strength_margins(stage.safeties(width), stage)
        sets = judge.sets(some, width, judge.layout(some, width), strength)
        for rule in active_rules(settings):
            yield f"{family} {rule}", np.asarray(CONSTRAINTS[rule].margin(sets), dtype=np.float64)


def robots(motor):
    """Two robots of a motor: all parts, chains, costs and what the joints carry."""
    maps = joint_maps(map_for(motor))
    table = capacities(maps)
    yield "joints", (dict(table.values), [(each.start, each.stop) for each in table.columns])
    ratios = [entry.actuator.ratio for entry in maps.hip.entries if entry.actuator is not None]
    low, high = ratios[0], ratios[-1]
    for thigh_m, shank_m, knee, hip in ((0.31, 0.47, low, high), (0.44, 0.36, high, low)):
        robot = build_robot(Design.from_array([thigh_m, shank_m, knee, hip, 40.0, 2.0, 1.5]), maps)
        yield f"{thigh_m} {shank_m}", (robot.leg, robot.units, robot_chains(robot), robot.cost)
        yield f"{thigh_m} {shank_m} masses", dict(robot.body_mass_properties())


@pytest.mark.parametrize("motor", motor_names())
def test_what_is_known_of_a_motors_gearboxes_and_robots_has_its_signatures(motor):
    known = {**dict(gearboxes(motor)), **dict(margins(motor)), **dict(robots(motor))}
    compare({name: signature(value) for name, value in known.items()}, HERE / f"{motor}.json")

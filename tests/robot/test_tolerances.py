"""Chains of the leg: as drawn, they close on the assembly; at worst nothing jams, for any motor."""

import numpy as np
import pytest

from pareto_monoped.actuator.motors import motor_names
from pareto_monoped.actuator.search import map_for
from pareto_monoped.design import PAPER_CASES
from pareto_monoped.errors import DesignError
from pareto_monoped.robot.build import build_robot
from pareto_monoped.robot.tolerances import robot_chains


def parts_of(robot):
    return {part.name: (part, unit) for unit in robot.units for part in unit.parts}


def ends(part):
    return [float(z) for prism in part.prisms for z in (prism.z0_mm, prism.z1_mm)]


@pytest.mark.parametrize("case", PAPER_CASES)
def test_the_gap_as_drawn_is_that_of_the_assembly(case, actuator_map):
    robot = build_robot(PAPER_CASES[case].design, actuator_map)
    drawn = {chain.name: chain.nominal_mm for chain in robot_chains(robot)}
    parts = parts_of(robot)
    # The shoulder is the journal's step of 11.8 mm radius; the far bearing begins at the far cheek's inner face.
    shoulder = max(float(prism.z1_mm) for prism in parts["journal"][0].prisms if float(prism.outline.radius_mm) == 11.8)
    assert drawn["journal's shoulder to the far bearing"] == pytest.approx(
        min(ends(parts["base_bearing"][0])) - shoulder, abs=1e-9
    )
    lip_to_lip = np.ptp(ends(parts["thigh_core"][0]))
    width = np.ptp(ends(parts["knee_bearing"][0]))
    shoulders = [float(p.z1_mm) for p in parts["knee_axle"][0].prisms if getattr(p.outline, "radius_mm", 0) == 11.8]
    assert drawn["axial play of the knee"] == pytest.approx(lip_to_lip - 2.0 * width - 2.0 * max(shoulders), abs=1e-9)


@pytest.mark.parametrize("name", motor_names())
def test_no_robot_jams_at_the_worst_of_its_limits(name):
    maps = map_for(name)
    built = 0
    for case in PAPER_CASES.values():
        try:
            robot = build_robot(case.design, maps)
        except DesignError:
            continue
        built += 1
        chains = robot_chains(robot)
        assert [chain.text for chain in chains if chain.jams] == []
        assert len({chain.name for chain in chains}) == len(chains)
    assert built

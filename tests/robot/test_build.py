"""One robot from its design: plausible, with the gearboxes asked for, and refused where it cannot be built."""

from pareto_monoped.design import PAPER_CASES
from pareto_monoped.robot.build import build_robot


def test_the_papers_robots_are_plausible(actuator_map):
    for case in PAPER_CASES.values():
        robot = build_robot(case.design, actuator_map)
        assert 3.0 < robot.mass_kg < 5.2
        thigh = robot.body_mass_properties()["thigh"]
        # The knee actuator sits on the hip axis: the thigh's centre of mass is near the hip, below it.
        assert -0.5 * case.design.thigh_length_m < thigh.com_m[2] < 0.0
        shank = robot.body_mass_properties()["shank"]
        assert -case.design.shank_length_m < shank.com_m[2] < 0.0
        # All but the knee's end stops is symmetric about the plane through the joint axes and the links.
        for mass in (thigh, shank):
            assert abs(mass.com_m[0]) < 4e-3


def test_each_joint_has_the_gearbox_of_its_own_ratio(actuator_map):
    robot = build_robot(PAPER_CASES["C"].design.replace({"hip_ratio": 4.5, "knee_ratio": 7.5}), actuator_map)
    assert robot.hip == actuator_map.lookup(4.5)
    assert robot.knee == actuator_map.lookup(7.5)

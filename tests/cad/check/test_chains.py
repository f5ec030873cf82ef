"""An export whose parts could jam at the worst of their limits is refused, with the chain that jams."""

from dataclasses import replace

import pytest

from pareto_monoped.cad.check.run import check_chains


def with_limits(actuator, part, name, **limits):
    """The actuator with other limits of one length."""
    changed = tuple(
        replace(one, lengths=tuple(replace(x, **limits) if x.name == name else x for x in one.lengths))
        if one.name == part
        else one
        for one in actuator.parts
    )
    assert changed != actuator.parts or any(x.name == name for one in changed for x in one.lengths)
    return replace(actuator, parts=changed)


def test_a_sound_robot_keeps_every_gap(product):
    check = check_chains(product.robot)
    assert check.passed
    assert check.measured == 0.0
    assert "dimension chains" in check.looked_at


@pytest.mark.parametrize(
    ("part", "name", "limits", "missing", "says"),
    [
        ("carrier", "web", {"lower_mm": -0.2}, -0.2, "float of the planets = 0.000 mm at worst"),
        ("main_bearing", "width", {"upper_mm": 0.03}, -0.03, "room for bearing and retaining ring on the carrier"),
    ],
)
def test_wider_limits_are_refused_with_the_chain_that_jams(product, examine, part, name, limits, missing, says):
    robot = product.robot
    broken = replace(robot, knee=with_limits(robot.knee, part, name, **limits))
    check = check_chains(broken)
    assert check.measured == pytest.approx(missing, abs=1e-6)
    assert any(f"knee actuator: {says}" in text for text in check.failures)
    assert all("\n" not in text for text in check.failures)
    assert check.name in examine()


def test_teeth_too_thin_for_their_tips_are_refused(product):
    robot = product.robot
    gears = replace(robot.knee.gears, backlash_mm=0.25)
    check = check_chains(replace(robot, knee=replace(robot.knee, gears=gears)))
    assert not check.passed
    assert any("knee actuator: width of the sun's tips = " in text for text in check.failures)

"""Gears in the stop against the slow rating of the standard's equations, and against Lewis by hand."""

from dataclasses import replace

import numpy as np
import pytest

from pareto_monoped.actuator.search import map_for
from pareto_monoped.strength.gears import lewis_torque_n_m, static_torques_n_m
from pareto_monoped.strength.table import TABLE
from tests.actuator.rating import iso6336
from tests.strength.support import structure


@pytest.mark.parametrize("ratio", [4.0, 5.2, 6.0, 7.5, 8.4])
def test_at_its_limit_a_gear_has_exactly_the_required_static_safety(ratio):
    s = structure(map_for("VT8020", rules="iso6336"), ratio)
    data, gears = s.settings.parts.rating, s.settings.parts.gears
    for torque, column, least in zip(
        static_torques_n_m(s), (2, 3), (data.overload_flank_safety, data.overload_root_safety), strict=True
    ):
        at_limit = replace(data, overload_factor=torque / s.actuator.peak_torque_n_m)
        settings = replace(s.settings, parts=replace(s.settings.parts, rating=at_limit))
        safety, _ = iso6336.rate(
            s.actuator.gears,
            s.actuator.motor,
            s.actuator.face_width_mm,
            settings,
            ring_wall=gears.ring_rim_modules * s.actuator.gears.module_mm,
            sun_bore=None,
        )
        # The slow rating's fillet is exact to 1e-4, and the torque grows with the square of the flank's safety.
        assert min(values[column] for values in safety.values()) == pytest.approx(least, rel=2e-4)


def test_gears_of_the_map_carry_the_overload_that_they_are_rated_for():
    actuator_map = map_for("VT8020", rules="iso6336")
    share = actuator_map.settings.parts.rating.overload_factor
    for entry in actuator_map.entries:
        if entry.actuator is not None:
            s = structure(actuator_map, entry.actuator.ratio)
            assert min(static_torques_n_m(s)) >= share * entry.actuator.peak_torque_n_m * (1.0 - 1e-9)


def test_lewis_by_hand():
    """The paper's 6:1 gearbox, 18/36/90 m 0.5 with 3 planets: Y of 18 teeth is 0.309 (Shigley, table 14-2)."""
    s = structure(map_for("VT8020", rules="paper"), 6.0)
    assert (s.actuator.gears.sun_teeth, s.actuator.gears.module_mm, s.actuator.gears.planets) == (18, 0.5, 3)
    force = 400.0 / 1.2 * s.actuator.face_width_mm * 0.5 * 0.309
    assert lewis_torque_n_m(s) == pytest.approx(3 * force * 4.5e-3 * 6.0, rel=1e-12)
    # The face was chosen for twice the peak torque and for Barth's factor at the no-load speed.
    assert lewis_torque_n_m(s) > 2.0 * s.actuator.peak_torque_n_m


def test_flanks_have_no_limit_under_the_paper_rules():
    s = structure(map_for("VT8020", rules="paper"), 6.0)
    (row,) = [joint for joint in TABLE if joint.name == "hip_gear_flank"]
    assert row.factor(*row.capacity(s), np.array([50.0]))[0] == np.inf

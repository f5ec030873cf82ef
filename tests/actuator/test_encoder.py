"""The encoder: its gap, that it touches nothing that turns, and that the shaft turns with its magnet."""

import numpy as np
import pytest

from pareto_monoped.actuator.motors import motor_names
from pareto_monoped.actuator.search import map_for
from pareto_monoped.geometry.roles import Group, Role

from .fit import rings


def of_each_family(name):
    """One actuator of every family that a motor has."""
    found = [entry.actuator for entry in map_for(name, "paper").entries if entry.actuator is not None]
    return {actuator.family: actuator for actuator in found}.values()


@pytest.mark.parametrize("name", motor_names())
def test_the_sensor_reads_the_magnet_over_its_gap(name):
    for actuator in of_each_family(name):
        _is_set(actuator)


def _is_set(actuator):
    parts = {part.name: part for part in actuator.parts}
    (magnet,), (sensor,), (cap,) = (rings(parts[name]) for name in ("encoder_magnet", "encoder", "encoder_cap"))
    assert magnet.z0 - sensor.z1 == pytest.approx(1.0)
    assert (magnet.z1 - magnet.z0, magnet.r1) == (pytest.approx(4.0), 2.0)
    assert (sensor.z1 - sensor.z0, sensor.r1) == (pytest.approx(7.0), 4.0)
    # The cap is flush with the back, and sensor and backplate hold it over its bond.
    assert cap.z0 == pytest.approx(-actuator.length_mm)
    assert min(cap.z1, sensor.z1) - max(cap.z0, sensor.z0) >= 1.0
    backplate = [ring for ring in rings(parts["backplate"]) if ring.z0 < cap.z1 - 1e-9 and ring.z1 > cap.z0 + 1e-9]
    assert {ring.r0 for ring in backplate} == {cap.r1}


@pytest.mark.parametrize("name", motor_names())
def test_the_magnet_fills_a_bore_in_the_end_of_what_the_motor_turns(name):
    for actuator in of_each_family(name):
        _is_in_the_shaft(actuator)


def _is_in_the_shaft(actuator):
    (magnet,) = (part for part in actuator.parts if part.role is Role.ELECTRONICS and part.group is Group.ROTOR)
    (shaft,) = (part for part in actuator.parts if part.name == magnet.joint.partner)
    assert shaft.group is Group.ROTOR
    (ring,) = rings(magnet)
    around = [r for r in rings(shaft) if r.r0 == ring.r1 and np.isclose(r.z0, ring.z0) and np.isclose(r.z1, ring.z1)]
    assert len(around) == 1


def test_the_order_of_the_sensor_asks_for_what_its_name_leaves_open():
    (sensor,) = (part for part in next(iter(of_each_family("VT8020"))).parts if part.name == "encoder")
    assert sensor.described.startswith("RLS RM08, 12 bit, output A, B, Z; supply of the driver; ")

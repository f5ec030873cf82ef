"""Where chain, foot force and bearings act on an actuator, from the parts of built robots."""

import pytest

from pareto_monoped.actuator.actuator import build_actuator
from pareto_monoped.actuator.assumptions import default_service
from pareto_monoped.actuator.needles import roller_bearing
from pareto_monoped.actuator.search import map_for
from pareto_monoped.actuator.service.sheet import service_sheet
from pareto_monoped.design import GRAVITY_M_PER_S2, PAPER_CASES
from pareto_monoped.geometry.roles import Role
from pareto_monoped.geometry.shapes import Circle
from pareto_monoped.leg.dimensions import CHAIN_DRIVES, leg_dimensions
from pareto_monoped.robot.build import build_robot

SERVICE = default_service()


def robot_z_mm(unit, z_mm):
    """From a unit's frame to the leg's."""
    return unit.z_mm + float(unit.turn[2, 2]) * z_mm


def middle_mm(part):
    return 0.5 * (min(float(prism.z0_mm) for prism in part.prisms) + max(float(prism.z1_mm) for prism in part.prisms))


@pytest.fixture(params=PAPER_CASES)
def robot(request):
    return build_robot(PAPER_CASES[request.param].design, map_for("VT8020"))


def units(robot):
    return {unit.name: unit for unit in robot.units}


def output_bearing_z_mm(unit):
    (part,) = (part for part in unit.parts if part.name == "main_bearing")
    return robot_z_mm(unit, middle_mm(part))


def test_the_chain_s_lever_is_that_of_the_parts(robot):
    """From the middle of the sprocket to that of the knee actuator's bearing, times the pull at its pitch circle."""
    sprocket = next(part for part in units(robot)["thigh"].parts if part.role is Role.SPROCKET)
    lever_mm = abs(output_bearing_z_mm(units(robot)["knee_actuator"]) - middle_mm(sprocket))
    drive = leg_dimensions(map_for("VT8020")).chain
    support = next(part for part in units(robot)["thigh"].parts if part.name == "drive_bearing")
    beyond_mm = abs(middle_mm(support) - middle_mm(sprocket))
    pull = robot.knee.peak_torque_n_m / (1e-3 * drive.pitch_radius_mm)
    sheet = service_sheet(robot.knee, map_for("VT8020").settings)
    force = {found.place: found.force_n for found in sheet.bearings}
    assert force["main, knee"] == pytest.approx(pull * beyond_mm / (beyond_mm + lever_mm), rel=1e-3)
    assert force["far, knee"] == pytest.approx(pull * lever_mm / (beyond_mm + lever_mm), rel=1e-3)


def test_the_hip_s_supports_are_where_the_parts_are(robot):
    """Two pivots, the hip's main bearing and the far cheek's; forces act in the leg's middle plane, z = 0."""
    hip = output_bearing_z_mm(units(robot)["hip_actuator"])
    far = [
        float(place[2]) + middle_mm(part)
        for part in units(robot)["base_frame"].parts
        if part.role is Role.BEARING
        for place in part.places_mm
    ]
    (far_z,) = far
    load = SERVICE.foot_force_n + SERVICE.leg_weight_n
    # The sheet takes the same actuator at both joints; here it is that of the knee, whose length sets the far support.
    sheet = service_sheet(robot.knee, map_for("VT8020").settings)
    found = next(item for item in sheet.bearings if item.place == "main, hip")
    same_bearing = robot.hip.family == robot.knee.family
    share = far_z / (far_z - hip)
    assert found.force_n == pytest.approx(load * share, rel=1e-6 if same_bearing else 0.02)


def test_the_leg_weighs_what_the_service_data_say(robot):
    """Everything that hangs on the hip."""
    mass = sum(unit.mass_properties().mass_kg for unit in robot.units if unit.body != "base")
    assert mass * GRAVITY_M_PER_S2 == pytest.approx(SERVICE.leg_weight_n, rel=0.25)


def test_the_chain_s_radius_is_that_of_all_drives():
    for drive in CHAIN_DRIVES:
        assert drive.pitch_radius_mm == pytest.approx(SERVICE.chain_radius_mm, abs=0.01)


def test_an_actuator_built_alone_has_the_same_sheet(robot):
    actuator_map = map_for("VT8020")
    again = build_actuator(robot.knee.motor, robot.knee.family, robot.knee.gears, actuator_map.settings)
    assert service_sheet(again, actuator_map.settings) == service_sheet(robot.knee, actuator_map.settings)


def test_the_drive_s_support_is_where_the_service_data_say(robot):
    """The needle bearing around the drive's shaft, in the hip coupling."""
    thigh = next(unit for unit in robot.units if any(part.name == "drive_bearing" for part in unit.parts))
    parts = {part.name: part for part in thigh.parts}
    (bearing,) = parts["drive_bearing"].prisms
    assert -0.5 * (bearing.z0_mm + bearing.z1_mm) == pytest.approx(SERVICE.drive_support_mm)
    known = roller_bearing(SERVICE.drive_support_bearing)
    assert 2.0 * bearing.outline.radius_mm == known.outer_diameter_mm
    assert bearing.z1_mm - bearing.z0_mm == known.width_mm
    assert parts["drive_bearing"].mass_kg() == known.mass_kg
    # The shaft runs through all of it, the coupling surrounds all of it.
    inside, outside = 0.5 * known.inner_diameter_mm, 0.5 * known.outer_diameter_mm
    for name, radius in (("drive_shaft", inside), ("hip_coupling", outside)):
        on = [
            prism
            for prism in parts[name].prisms
            if radius in (prism.outline.radius_mm, *(h.radius_mm for h in prism.holes if isinstance(h, Circle)))
        ]
        assert min(prism.z0_mm for prism in on) <= bearing.z0_mm
        assert max(prism.z1_mm for prism in on) >= bearing.z1_mm

"""The cables: lengths against a line that is summed up, room for their bends, and nothing that they run through."""

import csv
import dataclasses
import io
import re
from itertools import pairwise

import manifold3d as m3
import numpy as np
import pytest

from pareto_monoped.actuator.search import map_for
from pareto_monoped.cad.assembly import Pose, body_frames
from pareto_monoped.cad.cables import ENCODER_CABLE_M, cables, rounded, rounded_length_mm
from pareto_monoped.cad.product import Listed
from pareto_monoped.cad.shape.meshes import placed
from pareto_monoped.cad.write.assembly_pack import _cables
from pareto_monoped.cad.write.tables import cables_csv, hardware
from pareto_monoped.design import PAPER_CASES
from pareto_monoped.leg.actuator_fit import peak_current_a
from pareto_monoped.robot.build import build_robot

ROBOTS = [("C", "VT8020", "iso6336"), ("A", "U8", "iso6336"), ("B", "U12", "iso6336"), ("C", "VT8020", "paper")]


@pytest.fixture(params=ROBOTS, ids=" ".join, scope="module")
def robot(request):
    case, motor, rules = request.param
    return build_robot(PAPER_CASES[case].design, map_for(motor, rules))


def test_a_square_corner_saves_what_its_arc_is_shorter():
    points = np.array([[0.0, 0.0, 0.0], [40.0, 0.0, 0.0], [40.0, 30.0, 0.0]])
    assert rounded_length_mm(points, 10.0) == pytest.approx(70.0 - 2.0 * 10.0 + 0.5 * np.pi * 10.0)
    assert rounded_length_mm(points, 0.0) == pytest.approx(70.0)


def test_lengths_are_those_of_the_drawn_lines(robot):
    """The arcs are drawn as 16 chords each, which are shorter by a few parts in ten thousand."""
    for cable in cables(robot):
        drawn = np.linalg.norm(np.diff(rounded(cable.points_mm, cable.bend_radius_mm), axis=0), axis=1).sum()
        assert cable.length_mm == pytest.approx(drawn, rel=1e-3)
        assert cable.length_mm + sum(cable.tails_mm) <= cable.cut_mm < cable.length_mm + sum(cable.tails_mm) + 10.0


def test_every_bend_has_room_between_its_neighbours(robot):
    """The arc at a corner takes R tan(t / 2) of both pieces beside it."""
    for cable in cables(robot):
        steps = np.diff(cable.points_mm, axis=0)
        lengths = np.linalg.norm(steps, axis=1)
        ways = steps / lengths[:, None]
        turns = np.arccos(np.clip(np.sum(ways[:-1] * ways[1:], axis=1), -1.0, 1.0))
        taken = np.concatenate([[0.0], cable.bend_radius_mm * np.tan(0.5 * turns), [0.0]])
        assert np.all(taken[:-1] + taken[1:] <= lengths + 1e-9), cable.name
        assert cable.bend_radius_mm > 1.5 * cable.diameter_mm
        assert len(cable.notes) == len(cable.points_mm)


def test_wires_carry_the_peak_current_without_heating(robot):
    """Without any cooling, a second at the motor's peak torque or the driver's limit warms them by 6 K at most."""
    for joint, actuator in (("hip", robot.hip), ("knee", robot.knee)):
        cable = next(c for c in cables(robot) if c.name == f"{joint}_motor")
        area_m2 = 1e-6 * float(cable.designation.split()[2])
        effective_a = min(peak_current_a(actuator.motor), robot.leg.of(joint).driver.peak_current_a) / np.sqrt(2.0)
        heating_k_per_s = (effective_a / area_m2) ** 2 * 1.72e-8 / (8960.0 * 385.0)
        assert heating_k_per_s < 6.0


def test_the_encoder_s_own_cable_is_long_enough(robot):
    for cable in cables(robot):
        if cable.name.endswith("encoder"):
            assert cable.cut_mm <= 1000.0 * ENCODER_CABLE_M
            assert cable.mass_g == 0.0
        else:
            assert 5.0 < cable.mass_g < 80.0


def test_a_bend_that_is_too_tight_is_said_with_its_cure_in_every_output(robot):
    """Wires bend by four diameters at least; the U12's thick ones have no room for that beside the hip's driver."""
    made = cables(robot)
    tight = [cable for cable in made if cable.bend_radius_mm < 4.0 * cable.diameter_mm - 1e-6]
    assert [cable.name for cable in made if cable.warning] == [cable.name for cable in tight]
    assert ("hip_motor" in {cable.name for cable in tight}) == (robot.hip.motor.name == "U12")
    rows = list(csv.DictReader(io.StringIO(cables_csv(Listed(robot=robot, unique=())))))
    for row in rows:
        assert float(row["least_bend_radius_mm"]) == pytest.approx(4.0 * float(row["diameter_mm"]), abs=0.051)
        assert bool(row["warning"]) == (row["cable"] in {cable.name for cable in tight})
    page = "\n".join(_cables(Listed(robot=robot, unique=())))
    for cable in tight:
        assert f"{cable.bend_radius_mm:.1f} mm" in cable.warning
        assert f"at least {4.0 * cable.diameter_mm:.1f} mm" in cable.warning
        assert cable.warning in page
        assert {row["warning"] for row in rows if row["cable"] == cable.name} == {cable.warning}


def test_the_thinner_wires_of_the_cure_have_the_copper_and_the_room():
    """A robot with these wires is made, and bends them by four diameters."""
    robot = build_robot(PAPER_CASES["B"].design, map_for("U12", "iso6336"))
    thick = next(cable for cable in cables(robot) if cable.name == "hip_motor")
    found = re.search(r"lay (\d+) wires of ([\d.]+) mm2", thick.warning)
    count, area = int(found[1]), float(found[2])
    assert count * area >= float(thick.designation.split()[2]) > (count - 1) * area
    # The same robot with a driver that lets only so much current flow takes just these wires.
    current_a = 0.999 * area * 32.0 * np.sqrt(2.0)
    driver = dataclasses.replace(robot.leg.hip.driver, peak_current_a=current_a)
    leg = dataclasses.replace(robot.leg, hip=dataclasses.replace(robot.leg.hip, driver=driver))
    thin = next(c for c in cables(dataclasses.replace(robot, leg=leg)) if c.name == "hip_motor")
    assert float(thin.designation.split()[2]) == area
    assert thin.bend_radius_mm == pytest.approx(4.0 * thin.diameter_mm)
    assert thin.warning == ""


def test_cables_run_through_no_part(product):
    """One wire around each path, as spheres joined by hulls, against the parts' meshes with the leg hanging down."""
    frames = body_frames(product.robot, Pose(hip_rad=0.0, knee_rad=0.0))
    bodies = [
        (instance.name, placed(unique.mesh.body, frames[instance.body] @ instance.in_body))
        for instance, unique in product.placed()
        if instance.body != "shank"
    ]
    for cable in cables(product.robot):
        line = rounded(cable.points_mm, cable.bend_radius_mm)
        # The path begins in the face that it leaves.
        line[0] = line[0] + (line[1] - line[0]) / np.linalg.norm(line[1] - line[0]) * (0.5 * cable.diameter_mm + 0.01)
        balls = [m3.Manifold.sphere(0.5 * cable.diameter_mm, 16).translate(point) for point in line]
        wire = m3.Manifold.batch_boolean(
            [m3.Manifold.batch_hull([one, other]) for one, other in pairwise(balls)],
            m3.OpType.Add,
        )
        met = [name for name, body in bodies if (wire ^ body).volume() > 1e-6]
        assert met == [], cable.name


def test_the_files_have_every_corner_and_every_length(product):
    rows = list(csv.DictReader(io.StringIO(cables_csv(product.listed))))
    made = {cable.name: cable for cable in cables(product.robot)}
    assert {row["cable"] for row in rows} == set(made)
    for name, cable in made.items():
        mine = [row for row in rows if row["cable"] == name]
        points = np.array([[float(row[f"{axis}_mm"]) for axis in "xyz"] for row in mine])
        np.testing.assert_allclose(points, cable.points_mm, atol=0.051)
        assert {float(row["cut_mm"]) for row in mine} == {cable.cut_mm}
        assert sum(row["what"] == "tie" for row in mine) == 1
    bought = [row for row in csv.DictReader(io.StringIO(hardware(product.listed))) if row["kind"] == "cable"]
    wires = next(row for row in bought if "SiF" in row["designation"])
    motors = [made["hip_motor"], made["knee_motor"]]
    assert int(wires["count"]) == sum(cable.wires for cable in motors)
    assert all(f"{cable.name} 3 x {cable.cut_mm:g} mm" in wires["remark"] for cable in motors)
    # As many metres as all pieces of the list have together: each of a motor's three wires is cut to the same length.
    for row in bought:
        pieces = re.findall(r"(\d+) x ([\d.]+) mm", row["remark"])
        metres = re.findall(r"; ([\d.]+) m$", row["remark"])
        assert len(metres) == bool(pieces)
        assert sum(int(count) * float(long) for count, long in pieces) == pytest.approx(
            1e3 * sum(map(float, metres)), abs=5.0
        )
    assert next(int(row["count"]) for row in bought if row["designation"].startswith("cable tie")) == len(made)

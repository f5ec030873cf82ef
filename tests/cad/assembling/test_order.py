"""The order of assembly: toys whose order is known, and the robot, whose ways are tried with its meshes."""

import dataclasses

import numpy as np
import pytest

from pareto_monoped.actuator.search import map_for
from pareto_monoped.cad.as_built import as_built
from pareto_monoped.cad.assembly import Instance, instances
from pareto_monoped.cad.bodies import KEY_REACH_MM, blocking_of, partners_of
from pareto_monoped.cad.check.retention import POSE
from pareto_monoped.cad.shape.meshes import mesh_of, placed
from pareto_monoped.cad.steps import Joined, Whole, steps_of, stuck, take_apart
from pareto_monoped.design import PAPER_CASES
from pareto_monoped.geometry.parts import Part, Prism
from pareto_monoped.geometry.roles import FASTENERS, JointKind, Role
from pareto_monoped.geometry.screws import M3, screw_part
from pareto_monoped.geometry.shapes import Circle
from pareto_monoped.materials import MATERIALS
from pareto_monoped.robot.build import build_robot

UPRIGHT = np.array([[1.0, 0.0, 0.0, 0.0], [0.0, 0.0, -1.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]])
"""From a part's frame to the assembly's: z to -y."""


def disc(name, z0, z1, radius=20.0, *holes, role=Role.PLATE):
    return Part(
        name=name,
        role=role,
        material=MATERIALS.steel,
        process="machined",
        prisms=(Prism(outline=Circle(radius_mm=radius), z0_mm=z0, z1_mm=z1, holes=holes),),
    )


def screw(name, seat, direction, x=0.0, grip=2.0, head="cap"):
    return screw_part(
        name,
        M3,
        head=head,
        seat_mm=seat,
        grip_mm=grip,
        room_mm=6.0,
        direction=direction,
        material=MATERIALS.steel,
        places_mm=((x, 0.0, 0.0),),
    )


def assembled(*parts):
    """Blocking of parts with one instance per place."""
    found = []
    for part in parts:
        for k, place in enumerate(part.places_mm):
            at = np.eye(4)
            at[:3, 3] = place
            world = UPRIGHT @ at
            name = f"toy/{part.name}_{k}"
            found.append(
                Instance(name=name, unit="toy", part=part, body="base", in_body=world, moves=world, world=world)
            )
    return blocking_of(found)


def clear(x):
    return Circle(radius_mm=M3.hole, x_mm=x)


def tapped(x):
    return Circle(radius_mm=M3.core, x_mm=x)


def order(blocking):
    """When each body comes to the others: the number of its step, by name."""
    assembly = take_apart(blocking)
    assert list(stuck(assembly)) == []
    return {
        blocking.bodies[k].instance.part.name: step.number
        for step in reversed(steps_of(assembly))
        for k in step.members
    }, steps_of(assembly)


def test_a_disc_goes_into_its_cup_before_the_lid_and_the_lid_before_its_screw():
    cup = Part(
        name="cup",
        role=Role.HOUSING,
        material=MATERIALS.steel,
        process="machined",
        prisms=(
            Prism(outline=Circle(radius_mm=20.0), z0_mm=0.0, z1_mm=3.0),
            Prism(outline=Circle(radius_mm=20.0), z0_mm=3.0, z1_mm=13.0, holes=(Circle(radius_mm=12.0), tapped(16.0))),
        ),
    )
    inner, lid = disc("inner", 3.0, 12.0, 12.0), disc("lid", 13.0, 15.0, 20.0, clear(16.0))
    blocking = assembled(cup, inner, lid, screw("lid_screw", 15.0, -1.0, 16.0))
    _, steps = order(blocking)
    names = [body.instance.part.name for body in blocking.bodies]
    sequence = []
    for step in steps:
        sequence += [names[k] for k in sorted(step.base)] if step.base_number is None else []
        sequence += [names[k] for addition in step.additions for k in sorted(addition.members)]
        sequence += [names[k] for k in step.fasteners]
    assert sorted(sequence) == ["cup", "inner", "lid", "lid_screw"]
    assert sequence.index("inner") < sequence.index("lid") < sequence.index("lid_screw")
    assert sequence.index("cup") < sequence.index("lid")


def halves(gap, head="cap"):
    """Two plates with a block outside each; their screws are driven from between them. A bolt joins the plates."""
    near = (
        disc("near_block", -10.0, 0.0, 10.0, tapped(0.0)),
        disc("near_plate", 0.0, 2.0, 40.0, clear(0.0), clear(30.0)),
    )
    far = (
        disc("far_plate", 2.0 + gap, 4.0 + gap, 40.0, clear(0.0), tapped(30.0)),
        disc("far_block", 4.0 + gap, 14.0 + gap, 10.0, tapped(0.0)),
    )
    spacer = disc("spacer", 2.0, 2.0 + gap, 4.0, clear(0.0))
    spacer = dataclasses.replace(spacer, places_mm=((30.0, 0.0, 0.0),))
    screws = (
        screw("near_screw", 2.0, -1.0),
        screw("far_screw", 2.0 + gap, 1.0),
        screw("bolt", 0.0, 1.0, 30.0, grip=2.0 + gap, head=head),
    )
    return (*near, *far, spacer, *screws)


def test_halves_whose_screws_face_each_other_are_screwed_before_they_are_joined():
    blocking = assembled(*halves(20.0))
    names = [body.instance.part.name for body in blocking.bodies]
    _, steps = order(blocking)
    for near, far in (("near_screw", "far_plate"), ("far_screw", "near_plate")):
        (step,) = (step for step in steps if names.index(near) in step.fasteners)
        assert names.index(far) not in step.members
    assert [names[k] for k in steps[-1].fasteners] == ["bolt"]


def test_a_bolt_that_no_key_reaches_is_found():
    """The blocks outside are so wide that they cover the bolt: the halves cannot be joined."""

    def widened(part):
        wide = tuple(dataclasses.replace(prism, outline=Circle(radius_mm=40.0)) for prism in part.prisms)
        return dataclasses.replace(part, prisms=wide) if part.name in ("near_block", "far_block") else part

    parts = [widened(part) for part in halves(20.0, head="countersunk")]
    blocking = assembled(*parts)
    (members,) = stuck(take_apart(blocking))
    names = {blocking.bodies[k].instance.part.name for k in members}
    assert {"bolt", "near_screw", "far_screw"} <= names


def test_a_spanner_turns_what_a_key_cannot_reach():
    """A flange hangs over a screw that is driven from its side, with room to come out."""
    spool = Part(
        name="spool",
        role=Role.HOUSING,
        material=MATERIALS.steel,
        process="machined",
        prisms=(
            Prism(outline=Circle(radius_mm=30.0), z0_mm=0.0, z1_mm=2.0, holes=(clear(24.0),)),
            Prism(outline=Circle(radius_mm=18.0), z0_mm=2.0, z1_mm=20.0),
            Prism(outline=Circle(radius_mm=30.0), z0_mm=20.0, z1_mm=22.0),
        ),
    )
    plate = disc("plate", -8.0, 0.0, 30.0, tapped(24.0))

    def blocking(head):
        return assembled(spool, plate, screw("one", 2.0, -1.0, 24.0, head=head))

    assert list(stuck(take_apart(blocking("hexagon")))) == []
    assert len(list(stuck(take_apart(blocking("cap"))))) == 1


def robot_of(case, motor, rules):
    actuator_map = map_for(motor, rules)
    return build_robot(as_built(PAPER_CASES[case].design, actuator_map), actuator_map)


@pytest.fixture(scope="module")
def planned():
    found = instances(robot_of("A", "VT8020", "iso6336"), POSE)
    blocking = blocking_of(found)
    return found, blocking, take_apart(blocking)


def test_every_part_of_a_robot_is_put_in_its_place_once(planned):
    found, blocking, assembly = planned
    assert list(stuck(assembly)) == []
    steps = steps_of(assembly)
    single = [k for step in steps if step.base_number is None for k in step.base]
    single += [k for step in steps for addition in step.additions if addition.number is None for k in addition.members]
    single += [k for step in steps for k in step.fasteners]
    assert sorted(single) == list(range(len(blocking.bodies)))
    assert sorted(k for body in blocking.bodies for k in body.instances) == list(range(len(found)))
    assert steps[-1].members == frozenset(range(len(blocking.bodies)))


@pytest.mark.parametrize("kind", [JointKind.STUCK, JointKind.PRESSED, JointKind.BONDED])
def test_what_is_stuck_or_pressed_into_a_part_comes_with_it(planned, kind):
    """Loose needles would fall out of a planet that comes later; a bearing's cup needs a press. So do some bonds."""
    _, blocking, assembly = planned
    joints = [(k, body.instance.part.joint) for k, body in enumerate(blocking.bodies)]
    pairs = [
        (k, partner)
        for k, joint in joints
        if joint and joint.kind is kind and (joint.first or kind is not JointKind.BONDED)
        for partner in partners_of(blocking.bodies, k)
    ]
    assert len(pairs) >= 2
    for step in steps_of(assembly):
        for k, partner in pairs:
            assert (k in step.members) == (partner in step.members), blocking.bodies[k].instance.name


@pytest.mark.parametrize(
    ("case", "motor"),
    [
        pytest.param(*pair, marks=pytest.mark.long)
        for pair in (("C", "U12"), ("nominal", "MAD_M6C12"), ("C", "VT8020"), ("C", "MN8014"), ("nominal", "U8"))
    ],
)
def test_other_robots_come_together_too(case, motor):
    assembly = take_apart(blocking_of(instances(robot_of(case, motor, "iso6336"), POSE)))
    assert list(stuck(assembly)) == []


def test_hip_and_knee_are_screwed_to_their_plates_before_the_plates_are_joined(planned):
    """The clamshell: both actuators' screws are driven from between the thigh's plates."""
    _, blocking, assembly = planned
    bodies = blocking.bodies
    plates = [k for k, body in enumerate(bodies) if body.unit == "thigh" and body.instance.part.role is Role.PLATE]
    assert len(plates) == 2
    inside = [
        (step, k)
        for step in steps_of(assembly)
        for k in step.fasteners
        if bodies[k].unit == "thigh"
        and any(bodies[j].unit in ("hip_actuator", "knee_actuator") for j in blocking.goes_through[k])
    ]
    assert {bodies[j].unit for _, k in inside for j in blocking.goes_through[k]} >= {"hip_actuator", "knee_actuator"}
    for step, k in inside:
        assert sum(plate in step.members for plate in plates) <= 1, bodies[k].instance.name


@pytest.mark.long
def test_ways_and_keys_are_free_when_tried_with_meshes(planned):
    """Independent of the flat shapes: meshes moved in small steps, and a key as a cylinder, cut with what is there.

    A chain and its turnbuckles give way: to a sprocket that comes after them, too.
    """
    found, blocking, assembly = planned
    meshes = [placed(mesh_of(instance.part, 0.05).body, instance.world) for instance in found]
    boxes = np.array([mesh.bounding_box() for mesh in meshes]).reshape(-1, 2, 3)
    limp = {k for k, body in enumerate(blocking.bodies) if body.instance.part.role in (Role.CHAIN, Role.TURNBUCKLE)}

    def solids(members):
        return np.array([k for m in sorted(members) for k in blocking.bodies[m].instances], dtype=np.intp)

    def near(moved, members):
        """Meshes of the members whose bounding boxes meet that of a mesh."""
        low, high = np.reshape(moved.bounding_box(), (2, 3))
        them = solids(members)
        return [meshes[k] for k in them[((low <= boxes[them, 1]) & (boxes[them, 0] <= high)).all(axis=1)]]

    tried = 0
    for step in steps_of(assembly):
        there = set(step.base)
        for addition in step.additions:
            if not addition.members & limp:
                sign, axis = (1.0 if addition.out[0] == "+" else -1.0), "xyz".index(addition.out[1])
                for distance in (1.0, 4.0, 11.0, 27.0):
                    way = np.zeros(3)
                    way[axis] = sign * distance
                    for moving in solids(addition.members):
                        moved = meshes[moving].translate(way)
                        for other in near(moved, there - limp):
                            common = moved ^ other
                            assert common.volume() <= 0.02 * max(common.surface_area(), 1.0) + 0.5, step.number
                tried += 1
            there |= addition.members
        for k in step.fasteners:
            part = blocking.bodies[k].instance.part
            if part.role not in FASTENERS or part.role is Role.BOLT or part.fastening.head == "hexagon":
                continue
            for index in blocking.bodies[k].instances:
                key = key_of(meshes[index])
                assert all((key ^ other).volume() < 1.0 for other in near(key, there)), found[index].name
                tried += 1
    assert tried > 100


def key_of(body):
    """A cylinder of the head's radius from the head outwards."""
    import manifold3d as m3

    x0, y0, z0, x1, y1, z1 = body.bounding_box()
    radius = 0.5 * (x1 - x0) - 0.15
    wide = body.split_by_plane((0.0, 1.0, 0.0), 0.5 * (y0 + y1))
    up = wide[0].bounding_box()[3] - wide[0].bounding_box()[0] >= wide[1].bounding_box()[3] - wide[1].bounding_box()[0]
    reach = KEY_REACH_MM
    key = m3.Manifold.cylinder(reach, radius).rotate((-90.0, 0.0, 0.0))
    start = y1 + 0.2 if up else y0 - 0.2 - reach
    return key.translate((0.5 * (x0 + x1), start, 0.5 * (z0 + z1)))


def test_wholes_that_are_stuck_are_told_wherever_they_lie_in_an_assembly():
    loose, held, other = (Whole(members=frozenset(each), stuck=len(each) > 1) for each in ({0}, {1, 2}, {3, 4}))
    inner = Joined(kept=loose, added=held, out="+x", fasteners=())
    assert list(stuck(Joined(kept=other, added=inner, out="+z", fasteners=()))) == [other.members, held.members]

"""Every part of a robot is held; a missing ring, screw, shoulder or joint is found and the loose part named."""

import dataclasses

import numpy as np
import pytest

from pareto_monoped.actuator.motors import motor_names
from pareto_monoped.actuator.search import map_for
from pareto_monoped.cad.assembly import Pose, instances
from pareto_monoped.cad.check import retention
from pareto_monoped.cad.check.retention import loose_parts
from pareto_monoped.design import PAPER_CASES
from pareto_monoped.geometry.roles import SCREWS, Joint, JointKind
from pareto_monoped.geometry.screws import LENGTHS_MM
from pareto_monoped.robot.build import build_robot
from tests.cad.check.faults import replaced, without


def loose(robot):
    """Names of what is loose, numbers of instances cut off, with the directions."""
    return {found.name.rstrip("_0123456789"): found.directions for found in loose_parts(robot)[0]}


@pytest.fixture(scope="module")
def robot(actuator_map):
    """Case A: the five-planet ISSPG at the hip, an ESSPG at the knee."""
    return build_robot(PAPER_CASES["A"].design, actuator_map)


@pytest.fixture(scope="module")
def contacts(robot):
    """Names of the whole robot's parts, and what runs into what."""
    placed = instances(robot, retention.POSE)
    return [instance.name for instance in placed], retention._contacts(placed, retention.slabs(placed))


@pytest.fixture
def shaped_alike(contacts, monkeypatch):
    """What is looked at has parts of the whole robot only, whose contacts take three quarters of the time to find."""
    names, runs_into = contacts

    def of_these(placed, _):
        rows = [names.index(instance.name) for instance in placed]
        return {way: blocked[np.ix_(rows, rows)] for way, blocked in runs_into.items()}

    monkeypatch.setattr(retention, "_contacts", of_these)


@pytest.mark.parametrize(
    "motor",
    ["U8", *(pytest.param(name, marks=pytest.mark.long) for name in motor_names() if name != "U8")],
)
def test_every_part_is_held_on_either_family_of_any_motor(motor):
    found = map_for(motor)
    families = {}
    for entry in found.entries:
        if entry.actuator is not None:
            families.setdefault(entry.actuator.family, entry.actuator.ratio)
    ratios = list(families.values())
    design = PAPER_CASES["A"].design.replace({"knee_ratio": ratios[-1], "hip_ratio": ratios[0]})
    assert loose_parts(build_robot(design, found)) == ([], pytest.approx(300, abs=40))


@pytest.mark.parametrize(
    "motor", [pytest.param(name, marks=() if name in ("VT8020", "U8") else pytest.mark.long) for name in motor_names()]
)
def test_spacers_beside_needles_are_long_enough_to_be_held(motor):
    """One of 0.3 mm counted as loose, so that exports with it were refused."""
    actuators = [entry.actuator for entry in map_for(motor).entries if entry.actuator is not None]
    spacers = [part for actuator in actuators for part in actuator.parts if part.name == "needle_spacer"]
    assert spacers
    assert all(float(prism.z1_mm - prism.z0_mm) > 0.31 for part in spacers for prism in part.prisms)


@pytest.mark.usefixtures("shaped_alike")
@pytest.mark.parametrize(
    ("removed", "freed"),
    [
        # The ring holds the carrier in the main bearing, and with it the whole thigh against the base.
        ("hip_actuator/retaining_ring", {"hip_actuator/carrier", "thigh/thigh_plate_inner", "foot/foot"}),
        pytest.param(
            "knee_actuator/retaining_ring", {"knee_actuator/carrier", "thigh/drive_sprocket"}, marks=pytest.mark.long
        ),
        ("knee_actuator/bore_retaining_ring", {"knee_actuator/main_bearing", "knee_actuator/carrier"}),
        ("hip_actuator/planet_needles", {"hip_actuator/planet"}),
        ("knee_actuator/planet_washer", {"knee_actuator/planet"}),
        ("hip_actuator/backplate_screw", {"hip_actuator/backplate", "hip_actuator/motor_rotor"}),
        pytest.param(
            "base_frame/hip_mount_screw", {"hip_actuator/casing", "hip_actuator/motor_stator"}, marks=pytest.mark.long
        ),
        ("journal/journal_screw", {"knee_actuator/motor_stator"}),
        ("thigh/turnbuckle_end_hip", {"thigh/turnbuckle_bar", "thigh/turnbuckle_nut_hip"}),
        pytest.param("thigh/drive_sprocket", {"thigh/drive_coupling"}, marks=pytest.mark.long),
        ("thigh/knee_bearing", {"shank/knee_axle", "foot/foot"}),
        ("shank/knee_axle", {"shank/shank_plate_far", "foot/foot"}),
        pytest.param("shank/foot_bolt", {"shank/foot_block", "foot/foot"}, marks=pytest.mark.long),
    ],
)
def test_what_a_missing_part_held_is_named(robot, removed, freed):
    assert freed <= set(loose(without(robot, removed)))


@pytest.mark.usefixtures("shaped_alike")
def test_a_joint_without_a_shape_must_be_named_and_be_there(robot):
    assert loose(replaced(robot, "hip_actuator/ring", joint=None)) == {"hip_actuator/ring": ("+y",)}
    for partner in ("rear_bearing", "magic"):
        joint = Joint(kind=JointKind.BONDED, how="bonded into", partner=partner)
        assert "hip_actuator/ring" in loose(replaced(robot, "hip_actuator/ring", joint=joint))


@pytest.mark.long
def test_words_alone_hold_nothing(robot):
    joint = Joint(kind=JointKind.BONDED, how="bonded into", partner="backplate")
    moved = replaced(robot, "hip_actuator/rear_bearing", places_mm=((200.0, 0.0, 0.0),), joint=joint)
    assert loose(moved)["hip_actuator/rear_bearing"] == ("+x", "-x", "+y", "-y", "+z", "-z")


@pytest.mark.parametrize(
    ("ways", "tied"), [(("y+",), False), (("x+", "y-"), False), (("y+", "y-"), True), (("x+", "x-"), True)]
)
def test_a_joint_is_believed_if_its_partner_is_in_the_way_on_two_opposite_sides(robot, ways, tied):
    placed = instances(robot, Pose(hip_rad=0.0, knee_rad=0.5 * np.pi))
    pair = [next(i for i in placed if i.name == f"hip_actuator/{name}") for name in ("ring", "ring_housing")]
    assert pair[0].part.joint.partner == pair[1].part.name
    runs_into = {(axis, sign): np.zeros((2, 2), dtype=bool) for axis in "xyz" for sign in "+-"}
    for axis, sign in ways:
        runs_into[axis, sign][0, 1] = True
    assert retention._joints(pair, runs_into)[0, 1] == tied


@pytest.mark.usefixtures("shaped_alike")  # how deep the thread is, is all that changes
@pytest.mark.parametrize(("share", "held"), [(0.4, False), (0.59, False), (0.61, True)])
def test_a_screw_too_short_for_its_thread_is_found(robot, share, held):
    """An M3 screw holds by 0.6 of its diameter."""
    head, shank, thread = next(p for p in robot.hip.parts if p.name == "backplate_screw").prisms
    short = (head, shank, dataclasses.replace(thread, z1_mm=thread.z0_mm + 3.0 * share))
    found = loose(replaced(robot, "hip_actuator/backplate_screw", prisms=short))
    assert ("hip_actuator/backplate_screw" not in found) is held


@pytest.fixture
def on_bushes():
    """A robot by the rules of the paper, whose planets turn on bushes and whose second carrier the pins hold alone."""
    return build_robot(PAPER_CASES["A"].design, map_for("VT8020", "paper"))


@pytest.mark.parametrize(
    ("removed", "freed"),
    [
        ("knee_actuator/planet_pin_screw", {"knee_actuator/secondary_carrier", "knee_actuator/planet"}),
        pytest.param("hip_actuator/planet_bush", {"hip_actuator/planet"}, marks=pytest.mark.long),
    ],
)
def test_what_a_missing_part_held_by_the_rules_of_the_paper(on_bushes, removed, freed):
    assert freed <= set(loose(without(on_bushes, removed)))


@pytest.mark.parametrize(
    ("play_mm", "freed"),
    [
        (0.79, set()),
        (0.81, {"planet_bush", "planet"}),
        pytest.param(1.5, {"planet_bush", "planet"}, marks=pytest.mark.long),
    ],
)
def test_play_beyond_the_limit_is_found(on_bushes, play_mm, freed):
    """Bushes of the planets' own width would leave them 1.5 mm of play to either side."""
    planet = next(p for p in on_bushes.hip.parts if p.name == "planet")
    bush = next(p for p in on_bushes.hip.parts if p.name == "planet_bush")
    low, high = min(p.z0_mm for p in planet.prisms), max(p.z1_mm for p in planet.prisms)
    wider = 1.5 - play_mm
    narrow = (dataclasses.replace(bush.prisms[0], z0_mm=low - wider, z1_mm=high + wider),)
    found = loose(replaced(on_bushes, "hip_actuator/planet_bush", prisms=narrow))
    assert {f"hip_actuator/{name}" for name in freed} <= set(found)
    assert bool(found) is bool(freed)


@pytest.mark.long
def test_a_ring_without_its_joint_is_the_only_failure(product, examine, failing):
    loosened = replaced(product.robot, "hip_actuator/ring", joint=None)
    broken = dataclasses.replace(product, robot=loosened)
    assert failing(product=broken) == ["every part is held"]
    check = examine(product=broken)["every part is held"]
    assert check.failures == ("hip_actuator/ring is not held along +y",)
    assert check.measured == 1.0


def test_the_check_names_what_is_loose(product):
    check = retention.check(without(product.robot, "hip_actuator/backplate_screw"))
    assert not check.passed
    assert "hip_actuator/backplate is not held along +y" in check.failures
    assert check.measured == len(check.failures)
    assert retention.check(product.robot).passed


def test_every_screw_has_a_catalogue_length_that_is_ordered(robot):
    """Length as bought: under the head, or over all where it is flush."""
    seen = 0
    for unit in robot.units:
        for part in unit.parts:
            if part.role not in SCREWS:
                continue
            areas = sorted({float(p.outline.moments().area) for p in part.prisms})
            heads = [] if part.features else [p for p in part.prisms if p.outline.moments().area == areas[-1]]
            shank_mm = 2.0 * np.sqrt(areas[1] / np.pi)
            length = sum(float(p.z1_mm - p.z0_mm) for p in part.prisms if p not in heads)
            assert length == pytest.approx(LENGTHS_MM[abs(LENGTHS_MM - length).argmin()]), part.name
            (bought,) = part.purchases
            assert f" - M{shank_mm:g} x {length:g} - " in bought.designation, bought
            seen += 1
    assert seen >= 17

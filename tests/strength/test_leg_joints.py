"""Joints of the leg against a second way: tables of standards, energy, numeric sections and statics of drawn parts."""

import numpy as np
import pytest
import shapely

from pareto_monoped.actuator.bearings import rated_bearing
from pareto_monoped.actuator.search import map_for
from pareto_monoped.geometry.roles import Role
from pareto_monoped.leg.base import base_parts
from pareto_monoped.leg.chain import chain_parts
from pareto_monoped.leg.dimensions import leg_dimensions
from pareto_monoped.leg.shank import shank_parts
from pareto_monoped.leg.stops import hip_stop, knee_stop
from pareto_monoped.leg.thigh import thigh_parts
from pareto_monoped.strength import chain, knee, stops
from pareto_monoped.strength.connections import least_preload_n
from pareto_monoped.strength.factors import TABLE
from tests.leg.polygons import polygon
from tests.strength.support import structure

MAP = map_for("VT8020")
D = leg_dimensions(MAP)
S = structure(MAP, 6.0)
ROWS = {joint.name: joint for joint in TABLE}
THIGH = {part.name: part for part in thigh_parts(0.4, D)}
SHANK = {part.name: part for part in shank_parts(0.4, D)}
BASE = {part.name: part for part in base_parts(0.07, D)}
CHAIN = {part.name: part for part in chain_parts(400.0, D)}
YIELD, HARD, STEEL = 250.0, 460.0, 490.0  # MPa: EN AW-6082 T6, EN AW-7075 T6, C45E +QT


def capacity(name):
    return ROWS[name].capacity(S)


def extent(part, axis):
    """Least and greatest coordinate of a part's straight pieces about its own centre."""
    pieces = [piece for prism in part.prisms for piece in getattr(prism.outline, "pieces", ())]
    values = [getattr(piece, f"{axis}{end}_mm") for piece in pieces for end in (0, 1)]
    return min(values), max(values)


def section_at(part, x_mm):
    """Area that a part drawn along y leaves across the strand at ``x_mm`` along it, mm2."""
    area = 0.0
    for prism in part.prisms:
        cut = polygon(prism.outline).intersection(shapely.LineString([(-99.0, x_mm), (99.0, x_mm)]))
        area += cut.length * (prism.z1_mm - prism.z0_mm)
    return area


def test_the_stud_is_an_m5_of_the_standards():
    # Stress area 14.2 mm2 (ISO 898-1, table).
    assert capacity("turnbuckle_stud") == pytest.approx(14.18 * STEEL, rel=2e-3)
    # VDI 2230-1: M5 bears 0.85 (150 / 5 + 45) = 63.75 MPa for 2e6 cycles, twenty times fewer 20^(1/3) = 2.714 as much.
    assert chain.stud_fatigue_n(5.0, 2e6) == pytest.approx(2.0 * 63.75 * 14.18, rel=2e-3)
    assert chain.stud_fatigue_n(5.0, 1e8) == chain.stud_fatigue_n(5.0, 2e6)
    assert chain.stud_fatigue_n(5.0, 10.0) == chain.stud_fatigue_n(5.0, 1e4)
    assert MAP.settings.parts.duty.jumps == 1e5
    assert capacity("turnbuckle_fatigue") == pytest.approx(2.0 * 63.75 * 2.7144 * 14.18, rel=2e-3)


def test_a_tapped_thread_shears_along_the_screw_s_outer_diameter():
    """Numerically: along a helix on 5 mm, the share of the pitch that the nut's profile fills."""
    x = np.linspace(0.0, 0.8, 80001)
    # The female profile's flanks are 30 degrees steep; at D2 = 4.48 mm half of the pitch is metal.
    depth = 0.5 * (5.0 - 4.4804)
    filled = np.abs(x - 0.4) < 0.2 + depth * np.tan(np.pi / 6.0)
    area = np.pi * 5.0 * 6.5 * filled.mean()
    assert capacity("turnbuckle_thread") == pytest.approx(area * HARD / np.sqrt(3.0), rel=1e-3)


def test_the_bar_yields_where_its_drawn_section_is_least():
    bar = CHAIN["turnbuckle_bar"]
    _, end = extent(bar, "y")
    beside_thread = section_at(bar, end - 1.0) + 3.97**2 - 0.25 * np.pi * 5.0**2  # drawn with the flank diameter's bore
    assert section_at(bar, 0.0) == pytest.approx(24.0)
    assert capacity("turnbuckle_bar") == pytest.approx(HARD * min(section_at(bar, 0.0), beside_thread), rel=1e-6)


def test_the_fork_yields_where_its_drawn_parts_are_weakest():
    fork = CHAIN["turnbuckle_end_hip"]
    low, pin, high, root, _ = fork.prisms
    cheek = high.z1_mm - high.z0_mm
    slot = high.z0_mm - low.z1_mm
    width = polygon(high.outline).bounds[2] - polygon(high.outline).bounds[0]
    d = 2.0 * pin.outline.radius_mm
    thick = polygon(root.outline).bounds[3] - polygon(root.outline).bounds[1]
    bending = STEEL * width * thick**2 / 6.0 / ((slot + cheek) / 8.0)
    others = (2.0 * cheek * (width - d), 2.0 * cheek * d, 2.0 * 0.25 * np.pi * d**2 / np.sqrt(3.0))
    # The slot is drawn 0.2 mm wider than the link.
    assert capacity("turnbuckle_fork") == pytest.approx(min(bending, *(STEEL * area for area in others)), rel=0.03)
    assert chain.fork_n(4.0, 1.6, 4.09, 8.8, 3.5, 490.0) == pytest.approx(
        min(490 * 3.2 * 3.91, 490 * 3.2 * 4.09, 490 * 2 * 13.138 / 3**0.5, 490 * 8 * 3.5**2 / 6 * 8 / 10.4), rel=1e-3
    )


@pytest.mark.parametrize("weak", ["beside", "under", "pin", "root"])
def test_each_part_of_a_fork_can_be_the_weakest(weak):
    """Thirty times as strong in all but one: that one counts."""
    strong = {"half_mm": 90.0, "cheek_mm": 48.0, "pin_mm": 60.0, "slot_mm": 8.8, "root_mm": 105.0, "yield_mpa": 100.0}
    change = {
        "beside": ({"half_mm": 30.1}, 2 * 48.0 * 0.2 * 100.0),
        "under": ({"pin_mm": 60.0, "cheek_mm": 0.5}, 2 * 0.5 * 60.0 * 100.0),
        "pin": ({"pin_mm": 0.5}, 2 * 0.25 * np.pi * 0.25 * 100.0 / 3**0.5),
        "root": ({"root_mm": 0.5}, 8.0 / 56.8 * 180.0 * 0.25 / 6.0 * 100.0),
    }[weak]
    assert chain.fork_n(**(strong | change[0])) == pytest.approx(change[1])


def test_the_axle_s_dowels_turn_both_plates_of_the_shank():
    """Moments of the dowels' places in the parts, each with what its shallowest hole bears."""
    dowels = [part for part in SHANK.values() if part.role is Role.PIN]
    assert len(dowels) == 2
    torque = 0.0
    for pin in dowels:
        low, high = pin.prisms[0].z0_mm, pin.prisms[0].z1_mm
        d = 2.0 * pin.prisms[0].outline.radius_mm
        in_plate, in_axle = 3.0, high - low - 3.0
        assert max(abs(low), abs(high)) == pytest.approx(0.5 * D.shank_gap_mm + 3.0)
        shear = 0.25 * np.pi * d**2 * 0.75 * 1300.0 / np.sqrt(3.0)
        torque += 1e-3 * pin.count * pin.pitch_radius_mm * min(d * in_plate * YIELD, d * in_axle * HARD, shear)
    assert capacity("knee_axle_dowels") == pytest.approx(torque / (1e-3 * D.chain.pitch_radius_mm))
    assert knee.dowels_n_m(2.0, 10.0, 4.0, ((50.0, 400.0),), 1000.0) == pytest.approx(
        0.02 * 0.75 * 4.0 * np.pi * 1000.0 / 3**0.5
    )


def test_the_knee_s_bearings_balance_chain_and_stop():
    """Forces as vectors in the thigh's frame: the strand pulls to the hip, the bumper pushes on the striker's face."""
    static, lever, cosine = capacity("knee_bearing_static")
    assert (static, lever) == (2470.0, 51.0)  # 6804
    pull, torque, knee_force = 3000.0, 160.0, 900.0
    # In extension the bumper stands in front of the knee: it pushes the shank backwards, and down by its tilt.
    seat = THIGH["knee_seat_extension"].places_mm[0]
    bumper = THIGH["knee_bumper_extension"].places_mm[0]
    away = np.array([seat[0] - bumper[0], seat[1] - bumper[1]])
    push = -1e3 * torque / lever * away / np.linalg.norm(away)
    together = np.linalg.norm(np.array([0.0, pull]) + push)
    found = knee.bearing_safety(static, lever, cosine, pull, torque, knee_force)
    assert found == pytest.approx(2.0 * 2470.0 / (knee_force + together))
    assert ROWS["knee_bearing_static"].factor(static, lever, cosine, pull, torque, knee_force) == found


def straddling(name):
    """Of a seat or striker on the thigh: length of its face, and the area of its foot, from the drawn prisms."""
    foot, *wings = THIGH[name].prisms
    edges = [np.hypot(p.x1_mm - p.x0_mm, p.y1_mm - p.y0_mm) for p in wings[0].outline.pieces]
    return max(edges), polygon(foot.outline).area


@pytest.mark.parametrize(
    ("side", "name", "stop"), [("hip", "hip_striker_front", hip_stop(D)), ("knee", "knee_seat_extension", knee_stop(D))]
)
def test_seats_and_strikers_on_the_thigh_s_edges(side, name, stop):
    face, area = straddling(name)
    edge = 2.0 * D.plate_mm * face * YIELD
    assert capacity(f"{side}_stop_edges") == pytest.approx(1e-3 * stop.lever_mm * edge)
    width = area / 10.0 - 4.2  # 10 mm deep, less the hole of the bolt
    bending = YIELD * width * 10.0**2 / 6.0 * 8.0 / D.gap_mm
    assert capacity(f"{side}_stop_foot") == pytest.approx(1e-3 * stop.lever_mm * bending)


def test_the_heel_s_arm_reaches_from_the_bumper_to_the_knee_s_round_end():
    """Between the squeezed line and the nearest metal of the plate's edge, which the drawn outline gives."""
    arm = stops.heel_arm_mm(D)
    seat = THIGH["knee_seat_extension"].places_mm[0]
    bumper = THIGH["knee_bumper_extension"].places_mm[0]
    plate = polygon(THIGH["thigh_plate_outer"].prisms[0].outline)
    inward = np.array([seat[0] - bumper[0], seat[1] - bumper[1]])
    inward /= np.linalg.norm(inward)
    along = np.array([inward[1], -inward[0]])  # towards the knee's axis
    along *= np.sign(along @ (np.array([0.0, -400.0]) - np.array(seat[:2])))
    start = np.array(seat[:2]) + 1.5 * inward  # 1 mm in front of the edge
    steps = np.arange(0.0, 51.0, 0.01)
    points = start + steps[:, None] * along
    first = steps[shapely.contains_xy(plate, points[:, 0], points[:, 1])][0]
    assert first == pytest.approx(arm + 3.0, abs=0.4)  # the fillet of 5 mm has risen 1 mm after 3 mm
    force = YIELD * 2.0 * D.plate_mm * 22.0**2 / 6.0 / arm
    assert capacity("knee_heel") == pytest.approx(0.051 * force)


def test_the_knee_s_striker_and_its_bolt():
    head = SHANK["knee_striker"].prisms[0]
    (hole,) = head.holes
    width = polygon(head.outline).area / 11.0 - 2.0 * hole.radius_mm
    span = D.shank_gap_mm
    assert capacity("knee_striker") == pytest.approx(0.051 * YIELD * width * 11.0**2 / 6.0 * 8.0 / span)
    plates = 2.0 * D.shank_plate_mm
    assert capacity("knee_striker_bolt") == pytest.approx(0.051 * 2.0 * hole.radius_mm * plates * YIELD)


def test_the_base_s_rods_under_the_hip_s_stop():
    rod = BASE["base_rod"].prisms[0]
    outer, inner = rod.outline.radius_mm, rod.holes[0].radius_mm
    # Second moment of the tube by rings.
    r = np.linspace(inner, outer, 200001)
    modulus = np.trapezoid(np.pi * r**3, r) / outer
    near = -rod.z0_mm
    one = YIELD * modulus / near
    assert stops.rod_n(outer, inner, near, YIELD) == pytest.approx(one, rel=1e-6)
    # The two rods as hinges: each half of the force, and the couple's force across the line that joins them.
    seat, bumper = BASE["hip_seat_front"], BASE["hip_bumper_front"]
    stop = hip_stop(D)
    line = np.array(bumper.places_mm[0][:2])
    middle = 0.5 * (np.array(D.lower_rod_mm) + np.array(D.upper_rod_mm))
    distance = np.linalg.norm(np.array(D.lower_rod_mm) - np.array(D.upper_rod_mm))
    # The force's line passes the hip's axis at the lever, through the bumper's axis.
    candidates = [np.array([np.cos(a), np.sin(a)]) for a in np.linspace(0.0, np.pi, 2000001)[::10]]
    crossing = np.array([abs(line[0] * c[1] - line[1] * c[0]) for c in candidates])
    best = [candidates[k] for k in np.argsort(np.abs(crossing - stop.lever_mm))[:4]]
    arms = [abs((line - middle) @ np.array([-c[1], c[0]])) for c in best]
    torques = [1e-3 * stop.lever_mm * one / (0.5 + arm / distance) for arm in arms]
    assert any(capacity("hip_stop_rods") == pytest.approx(torque, rel=1e-3) for torque in torques)
    assert seat.role is Role.BRACKET


def test_the_chain_wears_by_pressure_times_path():
    """Bend by bend: 31 MPa for 15,000 h at 0.1 m/s over two sprockets of 19 teeth; one joint of ours, jump by jump."""
    drive = D.chain
    pin_m = 0.5e-3 * drive.pin_diameter_mm
    seconds = 15000.0 * 3600.0
    loops = seconds * 0.1 / (100 * 0.0127)
    rated = 31e6 * loops * 4.0 * (2.0 * np.pi / 19.0) * pin_m
    jumps = MAP.settings.parts.duty.jumps
    path = sum(2.0 * np.pi / 14.0 * pin_m for _ in range(2)) * jumps
    pull = ROWS["chain_wear"].capacity(S)
    pressure = pull / (drive.pin_diameter_mm * 1e-3 * drive.inner_link_mm * 1e-3)
    assert pressure * path == pytest.approx(rated, rel=1e-9)
    assert chain.wear_n(drive, 2.0 * jumps) == pytest.approx(0.5 * pull)


def test_the_chain_s_pressure_is_below_that_of_the_power_that_its_standard_rates():
    """ASME B29.1 at low speed: 0.004 N^1.08 n^0.9 P^(3 - 0.07 P) hp for chain 40, whose joints have 3.98 x 11.17 mm."""
    speed_m_per_s, teeth, pitch_in = 0.1, 19, 0.5
    turns_per_min = 60.0 * speed_m_per_s / (teeth * 0.0254 * pitch_in)
    rated_w = 745.7 * 0.004 * teeth**1.08 * turns_per_min**0.9 * pitch_in ** (3.0 - 0.07 * pitch_in)
    rated_mpa = rated_w / speed_m_per_s / (3.98 * 11.17)
    assert rated_mpa == pytest.approx(37.2, abs=0.2)
    assert chain._PRESSURE_MPA / rated_mpa == pytest.approx(1.0 - 0.17, abs=0.005)


def test_the_knee_s_bearings_live_for_the_jumps_of_the_duty():
    """ISO 281 turn by turn: the bearings carry the sum of forces on two rows, in every swing there and back."""
    row, stop = ROWS["knee_bearing_life"], knee_stop(D)
    pull, torque, knee = 3000.0, 160.0, 900.0
    numbers = row.capacity(S)
    found = row.factor(*numbers, pull, torque, knee)
    static = ROWS["knee_bearing_static"]
    total = 2.0 * 2470.0 / static.factor(*static.capacity(S), pull, torque, knee)
    life = (rated_bearing(20.0).dynamic_rating_n / (0.5 * total)) ** 3 * 1e6
    swings = 2.0 * MAP.settings.parts.duty.jumps * np.degrees(stop.upper_rad - stop.lower_rad) / 360.0
    assert found == pytest.approx(life / swings)


def test_the_hip_s_stop_screws_hold_against_the_drag_of_rubber():
    """One screw M4 of class 8.8, tightened least and settled; the striker drags with 0.8 of the stop's force."""
    torque = ROWS["hip_stop_screws"].capacity(S)
    push = 1e3 * torque / hip_stop(D).lever_mm
    screw = BASE["hip_seat_screw"]
    left = least_preload_n(screw.fastening, D.cheek_mm, steel_mpa=206000.0, clamped_mpa=70000.0)
    assert 0.8 * push == pytest.approx(left)
    assert screw.count * len(screw.places_mm) == 2  # one for each seat

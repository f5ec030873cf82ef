"""Plates of the links: sections of the drawn plates, buckling loads as eigenvalues, necks slice by slice."""

import numpy as np
import pytest
import shapely

from pareto_monoped.strength import plates
from tests.strength.drawn import ROWS, SHANK, THIGH, D, S, cut_at, region

YIELD = 250.0  # MPa: EN AW-6082 T6


@pytest.mark.parametrize(
    ("name", "unit", "bolts"), [("thigh_plate_outer", THIGH, "thigh_bolt"), ("shank_plate_far", SHANK, "shank_bolt")]
)
def test_net_sections_are_those_of_the_drawn_plates(name, unit, bolts):
    plate = unit[name]
    (prism,) = plate.prisms
    thick = prism.z1_mm - prism.z0_mm
    heights = sorted({float(y) for x, y, _ in unit[bolts].places_mm if abs(x) == 12.0}, reverse=True)
    for y in heights[1:2] if unit is THIGH else heights[:1]:
        pieces = cut_at(plate, y)
        assert len(pieces) == 3
        # The shank's front is 1 mm wider, below its ear: what counts is its rear, twice.
        rear = [(max(-b, 0.0), -a) for a, b in pieces if a < 0.0]
        half = max(b for _, b in rear)
        second = 2.0 * thick * sum((b**3 - a**3) / 3.0 for a, b in rear)
        area = 2.0 * thick * sum(b - a for a, b in rear)
        modulus, net = plates.net_section(half, thick, 12.0, 4.2)
        assert (modulus, net) == (pytest.approx(second / half, rel=2e-3), pytest.approx(area, rel=2e-3))
    # The head's cone: 3.36 mm in the face, at 45 degrees to the hole of 2.1 mm.
    z = (np.arange(100000) + 0.5) / 100000 * thick
    wide = np.mean(2.0 * np.maximum(3.36 - z, 2.1))
    assert plates.sunk_width_mm(plates.M3, thick) == pytest.approx(wide, rel=1e-6)


def test_the_thigh_s_bridges_carry_moment_and_pull():
    row = ROWS["thigh_bridge_outer"]
    gear, stop, pull, knee = 40.0, 150.0, 3000.0, 200.0
    modulus, area = plates.net_section(24.0, 2.5, 12.0, plates.sunk_width_mm(plates.M3, 2.5))
    stress = 75e3 / modulus + 1600.0 / area  # half of the stop's torque is more than the gearbox's
    assert row.factor(*row.capacity(S), gear, stop, pull, knee) == pytest.approx(YIELD / stress)


def test_the_shank_s_upper_bridge_is_as_wide_as_it_is_drawn():
    row = ROWS["shank_bridge"]
    knee = 600.0
    places = SHANK["shank_bolt"].places_mm
    y = max(y for _, y, _ in places)
    half = -min(a for a, _ in cut_at(SHANK["shank_plate_far"], y))  # its front is 1 mm wider
    modulus, area = plates.net_section(half, 3.0, 12.0, plates.sunk_width_mm(plates.M3, 3.0))
    stress = 0.5e3 * knee * (0.4 + 1e-3 * y) / modulus + 0.5 * knee / area
    assert row.factor(*row.capacity(S), knee, 0.4) == pytest.approx(YIELD / stress, rel=0.01)


def strip_modes(n, length, stiffness_n_mm2, bed_mpa=0.0):
    """Least buckling load of a strip clamped at both ends on a bed, by finite differences; N and mm."""
    h = length / (n + 1)
    bend = np.diag(np.full(n, 6.0)) + sum(
        np.diag(np.full(n - k, v), j * k) for k, v in ((1, -4.0), (2, 1.0)) for j in (-1, 1)
    )
    bend[0, 0] = bend[-1, -1] = 7.0  # the mirror point of a clamped end
    slope = np.diag(np.full(n, 2.0)) - np.diag(np.ones(n - 1), 1) - np.diag(np.ones(n - 1), -1)
    left = stiffness_n_mm2 * bend / h**4 + bed_mpa * np.eye(n)
    values = np.linalg.eigvals(np.linalg.solve(slope / h**2, left))
    return float(np.min(values.real))


def test_a_free_strip_and_a_bedded_one_buckle_at_their_eigenvalues():
    thick, side, modulus = 3.0, 13.5, 70000.0
    stiffness = modulus * side * thick**3 / 12.0
    free = strip_modes(300, 81.0, stiffness) / (side * thick)
    assert plates.clamped_mpa(81.0, thick, modulus) == pytest.approx(free, rel=2e-3)
    bed = 2000.0 * 3.5 / 12.0
    bedded = strip_modes(400, 400.0, stiffness, bed) / (side * thick)
    assert plates.bedded_mpa(side, thick, 3.5, 12.0, modulus) == pytest.approx(bedded, rel=0.02)


def test_a_short_column_yields_and_a_long_one_buckles():
    limit = 250.0
    assert plates.column_mpa(1e9, limit) == pytest.approx(limit)
    assert plates.column_mpa(60.0, limit) == 60.0
    ends = plates.column_mpa(np.array([124.999, 125.001]), limit)
    assert ends == pytest.approx([125.0, 125.0], abs=0.01)  # both curves meet at half the yield stress
    euler = np.linspace(126.0, 2000.0, 50)
    slender = np.pi * np.sqrt(70000.0 / euler)
    transition = np.pi * np.sqrt(2.0 * 70000.0 / limit)
    johnson = limit * (1.0 - 0.5 * (slender / transition) ** 2)
    assert plates.column_mpa(euler, limit) == pytest.approx(johnson)


def test_the_sides_of_fork_and_thigh_are_pressed_by_moment_and_pull():
    """A couple of forces on the sides' axes, and half of the axial force on either."""
    axial, moment, half, window, thick = 800.0, 60.0, 24.0, 15.0, 2.5
    arm = half + window
    force = 1e3 * moment / arm + 0.5 * axial
    assert plates.pressed_mpa(moment, axial, half, window, thick) == pytest.approx(force / (9.0 * thick))
    side, fork = ROWS["thigh_side_inner"], ROWS["shank_fork_side"]
    limit, half, window, thick = side.capacity(S)
    assert (half, thick) == (24.0, 2.5)
    found = side.factor(limit, half, window, thick, 40.0, 150.0, 3000.0, 200.0)
    assert found == pytest.approx(limit / plates.pressed_mpa(75.0, 1600.0, half, window, thick))
    numbers = fork.capacity(S)
    windows = THIGH["thigh_plate_outer"], SHANK["shank_plate_far"]
    assert windows[1].prisms[0].z1_mm - windows[1].prisms[0].z0_mm == numbers[3]
    fork_found = fork.factor(*numbers, 50.0, 600.0, 0.4)
    assert fork_found == pytest.approx(numbers[0] / plates.pressed_mpa(120.0, 300.0, *numbers[1:]))


@pytest.mark.parametrize(("plate", "capacity"), [("inner", plates.inner_hub), ("outer", plates.outer_hub)])
def test_around_the_hip_what_is_left_between_holes_carries_the_torque(plate, capacity):
    """Circles around the axis through the drawn plate, and the necks between its lightening holes."""
    (prism,) = THIGH[f"thigh_plate_{plate}"].prisms
    whole, torques = region(prism), []
    patterns = [hole for hole in prism.holes if hasattr(hole, "pitch_radius_mm") and not float(hole.y_mm)]
    for radius in sorted({float(hole.pitch_radius_mm) for hole in patterns}):
        circle = shapely.Point(0, 0).buffer(radius, 2000).exterior
        net = circle.length - sum(
            2.0 * float(h.radius_mm) * float(h.count) for h in patterns if np.isclose(float(h.pitch_radius_mm), radius)
        )
        # Along the arc a hole takes a little more than its diameter.
        assert circle.intersection(whole).length <= net * (1.0 + 1e-6)
        torques.append(1e-3 * YIELD / np.sqrt(3.0) * net * D.plate_mm * radius)
    relief = patterns[-1]
    r, pitch, n = float(relief.radius_mm), float(relief.pitch_radius_mm), float(relief.count)
    neck = 2.0 * pitch * np.sin(np.pi / n) - 2.0 * r
    two = shapely.Point(*relief.centres_mm()[0]), shapely.Point(*relief.centres_mm()[1])
    assert two[0].distance(two[1]) - 2.0 * r == pytest.approx(neck)
    torques.append(1e-3 * n * pitch * plates.spoke_force_n(r, neck, D.plate_mm))
    assert capacity(S) == pytest.approx(min(torques), rel=1e-3)


def test_a_neck_between_two_holes_is_bent_off_its_middle():
    """Stress at every place of the neck, from the drawn metal between two circles."""
    r, neck, thick = 11.0, 7.0, 2.5
    apart = neck + 2.0 * r
    metal = shapely.box(0.0, -10.9, apart, 10.9).difference(
        shapely.union_all([shapely.Point(x, 0.0).buffer(r, 2000) for x in (0.0, apart)])
    )
    worst = 0.0
    for s in np.linspace(0.0, 10.5, 400):
        width = metal.intersection(shapely.LineString([(-1.0, s), (apart + 1.0, s)])).length
        worst = max(worst, np.sqrt((6.0 * s / (thick * width**2)) ** 2 + 3.0 / (thick * width) ** 2))
    assert plates.spoke_force_n(r, neck, thick) == pytest.approx(YIELD / worst, rel=2e-3)

"""Plates of the links: sections measured on the parts' own outlines, and the frame by the stiffness method."""

import numpy as np
import pytest
import shapely

from pareto_monoped.actuator.search import map_for
from pareto_monoped.geometry.roles import Role
from pareto_monoped.leg.dimensions import leg_dimensions
from pareto_monoped.leg.shank import shank_parts
from pareto_monoped.leg.thigh import thigh_parts
from pareto_monoped.strength.factors import TABLE
from pareto_monoped.strength.links import rung_stress_mpa, side_stress_mpa
from tests.leg.polygons import polygon
from tests.strength.support import structure

MAP = map_for("VT8020")
D = leg_dimensions(MAP)
ROWS = {joint.name: joint for joint in TABLE}


def metal(part):
    """A plate's sheet with its windows, as a polygon."""
    windows = [hole for hole in part.prisms[0].holes if hasattr(hole, "pieces")]
    return polygon(part.prisms[0].outline).difference(shapely.union_all([polygon(hole) for hole in windows]))


def windows_of(part):
    """Low and high end and half width of each window, from the top down."""
    boxes = [polygon(hole).bounds for hole in part.prisms[0].holes if hasattr(hole, "pieces")]
    return sorted(((y0, y1, x1) for _, y0, x1, y1 in boxes), reverse=True)


def section(part, y_mm):
    """Area and section modulus of a plate at a height, from strips of 0.01 mm."""
    x = np.arange(-60.0, 60.0, 0.01) + 0.005
    inside = x[shapely.contains_xy(metal(part), x, np.full(len(x), y_mm))]
    thick = part.prisms[0].z1_mm - part.prisms[0].z0_mm
    return thick * 0.01 * len(inside), thick * 0.01 * float(np.sum(inside**2)) / float(np.abs(inside).max())


def frame(force_n, height_mm, side_mm, thick_mm, pieces=200):
    """Largest moment in a side that is clamped above and guided below, by the stiffness method with beam elements."""
    step, inertia = height_mm / pieces, thick_mm * side_mm**3 / 12.0
    stiff = np.zeros((2 * pieces + 2, 2 * pieces + 2))
    one = (70000.0 * inertia / step**3) * np.array(
        [
            [12.0, 6.0 * step, -12.0, 6.0 * step],
            [6.0 * step, 4.0 * step**2, -6.0 * step, 2.0 * step**2],
            [-12.0, -6.0 * step, 12.0, -6.0 * step],
            [6.0 * step, 2.0 * step**2, -6.0 * step, 4.0 * step**2],
        ]
    )
    for k in range(pieces):
        stiff[2 * k : 2 * k + 4, 2 * k : 2 * k + 4] += one
    free = [i for i in range(2 * pieces + 2) if i not in (0, 1, 2 * pieces + 1)]
    load = np.zeros(2 * pieces + 2)
    load[2 * pieces] = force_n
    moved = np.zeros_like(load)
    moved[free] = np.linalg.solve(stiff[np.ix_(free, free)], load[free])
    return float(np.abs((stiff @ moved)[1]))


def stress_by_hand(part, y_mm, moment_n_m, axial_n, across_n, window):
    """At a section of the part beside a window, with its height and the width of its side as drawn."""
    area, modulus = section(part, y_mm)
    low, high, _ = window
    thick = part.prisms[0].z1_mm - part.prisms[0].z0_mm
    side = area / (2.0 * thick)
    bent = frame(0.5 * across_n, high - low, side, thick) / (thick * side**2 / 6.0)
    return 1e3 * moment_n_m / modulus + axial_n / area + bent


@pytest.mark.parametrize("length_m", [0.3, 0.42, 0.5])
@pytest.mark.parametrize(("which", "side"), [(0, "inner"), (1, "outer")])
def test_thigh_plates_by_hand(length_m, which, side):
    plate = [part for part in thigh_parts(length_m, D) if part.role is Role.PLATE][which]
    gear, stop, chain, knee = 60.0, 150.0, 3000.0, 200.0
    row = ROWS[f"thigh_plate_{side}"]
    capacity = row.capacity(structure(MAP, 6.0))
    found = float(row.factor(*capacity, gear, stop, chain, knee, length_m))
    tallest = max(windows_of(plate)[1:-1], key=lambda window: window[1] - window[0])
    middle = 0.5 * (tallest[0] + tallest[1])
    moment = max(gear, 0.5 * stop)
    stress = stress_by_hand(plate, middle, moment, 0.5 * (chain + knee), 0.5 * knee, tallest)
    assert found == pytest.approx(plate.grade.yield_mpa / stress, rel=2e-3)
    # With more torque in the gearbox than half of the stop's, that counts.
    assert float(row.factor(*capacity, 150.0, stop, chain, knee, length_m)) < 0.8 * found


@pytest.mark.parametrize("length_m", [0.42, *(pytest.param(one, marks=pytest.mark.long) for one in (0.3, 0.5))])
def test_shank_plates_are_nowhere_stressed_more_than_said(length_m):
    plate = next(part for part in shank_parts(length_m, D) if part.role is Role.PLATE)
    gear, knee = 60.0, 200.0
    fork, below = windows_of(plate)
    s = structure(MAP, 6.0)
    for name, window, loads, moment_at in (
        ("shank_plate_fork", fork, (gear, knee, length_m), lambda _: 0.5 * max(gear, knee * length_m)),
        ("shank_plate_sides", below, (knee, length_m), lambda y: 0.5 * knee * (length_m + 1e-3 * y)),
    ):
        said = plate.grade.yield_mpa / float(ROWS[name].factor(*ROWS[name].capacity(s), *loads))
        corner = 7.0  # sections at the ends of a window, where its round corners end
        worst = max(
            stress_by_hand(plate, y, moment_at(y), 0.5 * knee, 0.5 * knee, window)
            for y in np.linspace(window[0] + corner, window[1] - corner, 5)
        )
        assert worst <= said * 1.001, name
        assert worst >= 0.6 * said, name


def test_a_rung_takes_what_both_sides_bring():
    """Two windows of equal height: at the rung's axis, the sides above and below each bring V / 2 p / 2."""
    half, window, thick, pitch, force = 24.0, 13.0, 2.5, 80.0, 100.0
    at_axis = 2.0 * frame(0.5 * force, pitch, half - window, thick)
    arm = 0.5 * (half + window)
    # The moment falls evenly to zero in the middle of the rung.
    stress = at_axis * window / arm / (thick * 11.0**2 / 6.0)
    assert rung_stress_mpa(force, pitch, (half, window, thick)) == pytest.approx(stress, rel=1e-6)


def test_without_a_force_across_a_side_is_a_beam():
    """M / Z of a rectangle less a rectangle, and N / A."""
    stress = side_stress_mpa(10.0, 500.0, 0.0, 80.0, (20.0, 10.0, 3.0))
    inertia = 3.0 * (40.0**3 - 20.0**3) / 12.0
    assert stress == pytest.approx(10e3 * 20.0 / inertia + 500.0 / 60.0, rel=1e-12)


def test_each_thigh_plate_bears_the_gear_torque_of_the_actuator_beside_it():
    """Of the hip's output, which turns the plate nearest to it, and of the knee's housing, which is bolted on."""
    plates = {part.name: part.prisms[0] for part in thigh_parts(0.42, D) if part.role is Role.PLATE}
    middles = {name: 0.5 * (prism.z0_mm + prism.z1_mm) for name, prism in plates.items()}
    for joint, face_mm in (("hip", D.hip_mount_mm), ("knee", D.knee_mount_mm)):
        near = min(middles, key=lambda name: abs(middles[name] - face_mm))
        assert [name for name in ROWS[near].loads if "gear_torque" in name] == [f"peak_gear_torque_{joint}_n_m"]

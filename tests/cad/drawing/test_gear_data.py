"""The measures on a gear's drawing, against formulas written on their own and against the flanks that are built."""

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from pareto_monoped.actuator.search import map_for
from pareto_monoped.cad.drawing.data_tables import base_tangent_mm, between_pins_mm, gear_rows, measure, spanned_teeth
from pareto_monoped.cad.drawing.part_sheet import round_part, round_tables
from pareto_monoped.cad.shape.outlines import Contour, Spline, contours, polygon
from pareto_monoped.geometry.gears import ExternalGear, InternalGear
from pareto_monoped.geometry.roles import Group, Role
from tests.geometry.cutting import string_flank

EXTERNAL = [
    (18, 0.5, 0.0, 0.0),
    (22, 0.6, 0.04, 0.0),
    (30, 0.5, 0.04, 0.0),
    (44, 0.6, 0.02, 0.0),
    (65, 0.8, 0.05, 0.0),
    (19, 0.7, 0.04, 0.4),
    (20, 0.6, 0.04, 0.5),
    (38, 0.7, 0.04, -0.4),
]
INTERNAL = [
    (90, 0.5, 0.04, 0.0),
    (110, 0.6, 0.04, 0.0),
    (95, 0.8, 0.0, 0.0),
    (95, 0.7, 0.04, -0.4),
    (100, 0.6, 0.04, 0.8),
]


def flank_points(gear):
    """Points every few micrometres along the flanks that the kernel builds: splines through the outline's points."""
    (contour,) = contours(gear)
    rows = []
    for piece in contour.pieces:
        if isinstance(piece, Spline):
            known = np.linspace(0.0, 1.0, len(piece.points_mm))
            rows.append(CubicSpline(known, piece.points_mm)(np.linspace(0.0, 1.0, 200)))
        else:
            rows.append(polygon(Contour(pieces=(piece,)), 1e-5))
    return np.concatenate(rows)


@pytest.mark.parametrize(("teeth", "module", "thinning", "shift"), EXTERNAL)
def test_base_tangent_is_pitches_and_a_tooth_along_the_base_circle(teeth, module, thinning, shift):
    """K - 1 base pitches and the tooth's thickness on the base circle (Shigley, ch. 13): s_b = cos a (s + d inv a)."""
    gear = ExternalGear(teeth=teeth, module_mm=module, backlash_mm=thinning, shift=shift)
    count = spanned_teeth(teeth, np.radians(20.0), shift)
    involute = 0.014904383867336446  # tan 20 - 20 pi / 180
    thickness = 0.5 * np.pi * module + 2.0 * shift * module * np.tan(np.radians(20.0)) - thinning
    on_base = np.cos(np.radians(20.0)) * (thickness + teeth * module * involute)
    expected = (count - 1) * np.pi * module * np.cos(np.radians(20.0)) + on_base
    assert base_tangent_mm(gear, count, allowance_mm=-thinning) == pytest.approx(expected, abs=1e-9)


def test_a_base_tangent_length_of_a_textbook():
    """Module 1, 20 degrees, 30 teeth over 4: 10.753 mm, as tables of base tangent lengths have it."""
    gear = ExternalGear(teeth=30, module_mm=1.0)
    assert spanned_teeth(30, np.radians(20.0)) == 4
    assert base_tangent_mm(gear, 4, allowance_mm=0.0) == pytest.approx(10.7526, abs=1e-4)


@pytest.mark.parametrize(("teeth", "module", "thinning", "shift"), EXTERNAL)
def test_callipers_over_the_built_flanks_read_the_greatest_base_tangent_length(teeth, module, thinning, shift):
    """Two parallel jaws across k teeth touch the outline where the drawing says, to a micrometre."""
    gear = ExternalGear(teeth=teeth, module_mm=module, backlash_mm=thinning, shift=shift)
    span = measure(gear)
    points = flank_points(gear)
    # The middle of the k teeth lies on the x axis: on a tooth for odd k, on a space for even k.
    turn = 0.0 if span.count % 2 else np.pi / teeth
    cos, sin = np.cos(turn), np.sin(turn)
    points = points @ np.array([[cos, sin], [-sin, cos]])
    half = np.pi * span.count / teeth
    angle, radius = np.arctan2(points[:, 1], points[:, 0]), np.hypot(*points.T)
    # Jaws reach a module below and above where they touch.
    touch = np.hypot(float(gear.base_radius_mm), 0.5 * span.greatest_mm)
    across = points[(np.abs(angle) < half) & (np.abs(radius - touch) < 0.6 * module), 1]
    assert across.max() - across.min() == pytest.approx(span.greatest_mm, abs=1e-3)


@pytest.mark.parametrize(("teeth", "module", "widening", "shift"), INTERNAL)
def test_pins_in_the_built_spaces_stand_as_far_apart_as_the_least_measure(teeth, module, widening, shift):
    """A pin that is pushed outwards in a space touches both flanks where the formula has it, to a micrometre."""
    gear = InternalGear(teeth=teeth, module_mm=module, backlash_mm=widening, shift=shift)
    span = measure(gear)
    points = flank_points(gear)
    angle = np.arctan2(points[:, 1], points[:, 0])
    space = points[np.abs(angle) < np.pi / teeth]
    radius = 0.5 * span.pin_mm

    def fits(x):
        return np.hypot(space[:, 0] - x, space[:, 1]).min() >= radius

    low, high = float(gear.tip_radius_mm), float(gear.root_radius_mm)
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if fits(middle) else (low, middle)
    apart = 2.0 * low * (np.cos(0.5 * np.pi / teeth) if teeth % 2 else 1.0) - span.pin_mm
    assert apart == pytest.approx(span.least_mm, abs=2e-3)


def test_limits_leave_at_least_the_drawn_backlash():
    outer, inner = measure(ExternalGear(teeth=30, module_mm=0.5)), measure(InternalGear(teeth=90, module_mm=0.5))
    assert outer.greatest_mm == pytest.approx(
        base_tangent_mm(ExternalGear(teeth=30, module_mm=0.5), 4, allowance_mm=0.0)
    )
    assert outer.greatest_mm - outer.least_mm == pytest.approx(0.020 * np.cos(np.radians(20.0)))
    assert inner.least_mm == pytest.approx(
        between_pins_mm(InternalGear(teeth=90, module_mm=0.5), 0.84, allowance_mm=0.0)
    )
    assert inner.greatest_mm > inner.least_mm


def test_a_gear_beyond_the_table_of_tolerances_is_refused():
    with pytest.raises(ValueError, match="at most 280 mm"):
        measure(InternalGear(teeth=300, module_mm=1.0))


def test_rated_gears_have_the_finer_series_and_splines_the_other():
    gear = ExternalGear(teeth=30, module_mm=0.5, backlash_mm=0.015)
    for accuracy_class, series, tolerance in ((6, 23, 0.012), (None, 24, 0.020)):
        rows = dict(gear_rows(gear, accuracy_class=accuracy_class))
        assert rows["Tooth thickness tolerance"] == f"DIN 3967, series {series}"
        least, greatest = map(float, rows["Base tangent length W over 4 teeth"].split(" to "))
        assert greatest - least == pytest.approx(tolerance * np.cos(np.radians(20.0)), abs=1.1e-3)


def test_a_splined_hole_is_toleranced_as_a_hole_and_clears_the_shaft_on_both_circles():
    """Its circles are wider than the drawing, never narrower, so that only the flanks fit: no ``h`` stands there."""
    shaft = ExternalGear(teeth=18, module_mm=0.5, backlash_mm=0.0)
    rows = dict(gear_rows(shaft, accuracy_class=None, hole=True))
    assert rows["Outer diameter, clear of the shaft's tips"] == "10 H9 (+0.036 / 0)"
    assert rows["Inner diameter, clear of the shaft's roots"] == "7.75 H9 (+0.036 / 0)"
    assert rows["Fit and gap of the adhesive"] == "on the flanks"
    assert not any(name.startswith(("Tip diameter", "Root diameter")) for name in rows)
    assert dict(gear_rows(shaft, accuracy_class=None))["Tip diameter"] == "10 h9 (0 / -0.036)"


def test_the_table_names_what_a_gear_cutter_needs():
    rows = dict(gear_rows(ExternalGear(teeth=30, module_mm=0.5, backlash_mm=0.04), accuracy_class=6))
    assert rows["Teeth, external"] == "30"
    assert rows["Module"] == "0.5"
    assert rows["Pressure angle"] == "20°"
    assert rows["Accuracy of the teeth"] == "ISO 1328-1 class 6"
    assert rows["Backlash of the pair, at least"] == "0.08"
    assert rows["Base tangent length W over 4 teeth"] == "5.327 to 5.339"
    assert rows["Basic rack"] == "ISO 53, h 1.25 m, fillet 0.38 m"
    assert rows["Tip diameter"] == "16 h9 (0 / -0.043)"
    assert rows["Root diameter"] == "13.64"  # 15 - 2.5 * 0.5, with the rack 0.055 mm farther in for thinner teeth


FORM = "Form diameter, involute from there"


@pytest.mark.parametrize(("teeth", "module", "thinning", "shift"), [row for row in EXTERNAL if row[0] > 19])
def test_the_form_diameter_is_that_of_iso_21771(teeth, module, thinning, shift):
    """Without undercut: d_Ff^2 = d_b^2 + (d sin a - 2 h / sin a)^2, where the rack's straight flank ends h deep."""
    sine, reference = np.sin(np.radians(20.0)), teeth * module
    straight = (1.25 - 0.38 * (1.0 - sine) - shift) * module + 0.5 * thinning / np.tan(np.radians(20.0))
    assert reference * sine > 2.0 * straight / sine
    gear = ExternalGear(teeth=teeth, module_mm=module, backlash_mm=thinning, shift=shift)
    expected = np.hypot(reference * np.cos(np.radians(20.0)), reference * sine - 2.0 * straight / sine)
    assert float(dict(gear_rows(gear, accuracy_class=6))[FORM]) == pytest.approx(expected, abs=6e-4)


@pytest.mark.parametrize(("teeth", "module", "widening", "shift"), INTERNAL)
def test_the_form_diameter_of_a_ring_is_where_a_disc_in_the_corner_touches_the_flank(teeth, module, widening, shift):
    gear = InternalGear(teeth=teeth, module_mm=module, backlash_mm=widening, shift=shift)
    rows = dict(gear_rows(gear, accuracy_class=6))
    reference = 0.5 * teeth * module
    base, root = reference * np.cos(np.radians(20.0)), reference + (1.25 + shift) * module
    radius, angle = string_flank(base, base, root + module, 20001)
    flank = np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=1)
    # The space is on the side of greater angles.
    low, high = angle[-1] - 0.01, angle[-1] + 0.1
    for _ in range(50):
        middle = 0.5 * (low + high)
        off = np.hypot(*(flank - (root - 0.38 * module) * np.array([np.cos(middle), np.sin(middle)])).T)
        low, high = (middle, high) if off.min() < 0.38 * module else (low, middle)
    assert float(rows[FORM]) == pytest.approx(2.0 * radius[off.argmin()], abs=2e-3)
    assert rows["Roots"] == f"wire-cut along the drawing, R {round(0.38 * module, 3):g}"
    assert "Basic rack" not in rows


def test_only_planets_are_crowned():
    found = map_for("VT8020", "iso6336").lookup(6.0)
    crowned = {}
    for part in found.parts:
        if part.role is Role.GEAR and part.group in (Group.ROTOR, Group.PLANET, Group.HOUSING):
            texts = [label.text for paper in round_tables(part, round_part(part)) for label in paper.labels]
            name = "Crowning of the flanks"
            crowned[part.name] = texts[texts.index(name) + 1] if name in texts else None
    assert crowned == {"sun": "none", "planet": "5 µm", "ring": "none"}


def touching_mm(own, mate, own_at, mate_at):
    """Diameter of a gear's flank at which the mate's tip comes: where its circle meets the line of action.

    That line runs through the pitch point, which divides the axes' distance by the numbers of teeth, and touches the
    gear's base circle.
    """
    inside = isinstance(own, InternalGear) or isinstance(mate, InternalGear)
    share = own.teeth / (own.teeth - mate.teeth if inside else own.teeth + mate.teeth)
    pitch = own_at + share * (mate_at - own_at)
    out = (pitch - own_at) / np.linalg.norm(pitch - own_at)
    base = 0.5 * own.module_mm * own.teeth * np.cos(own.pressure_angle_rad)
    turn = np.arcsin(base / np.linalg.norm(pitch - own_at))
    found = []
    for angle in (turn, -turn):
        way = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]) @ out
        to = pitch - mate_at
        steps = np.roots([1.0, 2.0 * way @ to, to @ to - float(mate.tip_radius_mm) ** 2])
        step = float(min(steps, key=abs))
        found.append(2.0 * float(np.linalg.norm(pitch + step * way - own_at)))
    assert found[0] == pytest.approx(found[1])
    return found[0]


@pytest.mark.parametrize("ratio", [4.0, 6.0, 8.4])
def test_active_diameters_are_where_the_mates_tips_come(ratio):
    actuator = map_for("VT8020", "iso6336").lookup(ratio)
    gears = actuator.gears
    axis, beside = np.zeros(2), np.array([float(gears.carrier_radius_mm), 0.0])
    sun, planet, ring = gears.sun(), gears.planet(), gears.ring()
    expected = {
        "sun": touching_mm(sun, planet, axis, beside),
        "planet": min(touching_mm(planet, sun, beside, axis), touching_mm(planet, ring, beside, axis)),
        "ring": touching_mm(ring, planet, axis, beside),
    }
    for part in actuator.parts:
        if part.name in expected:
            (making, *_) = part.teeth
            shape = {"sun": sun, "planet": planet, "ring": ring}[part.name]
            ends = sorted((2.0 * float(shape.tip_radius_mm), expected[part.name]))
            assert making.active_mm == pytest.approx(ends, abs=1e-9)
            # The involute reaches as far as it is used.
            used = ends[1] if part.name == "ring" else ends[0]
            beyond = 2.0 * float(shape.form_radius_mm) - used
            assert beyond >= 0.0 if part.name == "ring" else beyond <= 0.0

"""Each rule of making on a part made to break it, on the same part mended, and on what the searches find."""

from dataclasses import replace

import numpy as np
import pytest

from pareto_monoped.actuator.actuator import build_actuator
from pareto_monoped.actuator.motors import load_motor, motor_names
from pareto_monoped.actuator.search import map_of
from pareto_monoped.cad.check import making
from pareto_monoped.cad.product import ListedPart
from pareto_monoped.geometry.features import Cone, Hole, Mouth, tap_run_out_mm
from pareto_monoped.geometry.making import Fit
from pareto_monoped.geometry.parts import disc, layer, machined_part
from pareto_monoped.geometry.roles import Role
from pareto_monoped.geometry.screws import M3, M4, tapped
from pareto_monoped.geometry.shapes import Circle, Pattern, polygon, rectangle

MOTORS = motor_names()


def failures(*parts):
    """The findings on some parts, by rule."""
    listed = [ListedPart(name=part.name, part=part, count=1, units=("unit",)) for part in parts]
    found = making.check(listed)
    assert [check.name for check in found] == [limit.name for limit in making.RULES]
    assert all(check.measured == len(check.failures) and check.limit == 0.0 for check in found)
    return {check.name: list(check.failures) for check in found if not check.passed}


def part(*prisms, name="block", **fields):
    return machined_part(name=name, role=Role.HOUSING, prisms=prisms, **fields)


def bore(radius):
    return Circle(radius_mm=radius)


def cup(gap, depth, *, outwards=False):
    """A plate of 5 mm with two tubes around each other, or with two flanges around a hub."""
    if outwards:
        return part(disc(20.0, 0.0, 5.0), disc(20.0 - depth, 5.0, 5.0 + gap), disc(20.0, 5.0 + gap, 10.0 + gap))
    return part(
        disc(20.0, 0.0, 5.0, bore(5.0)),
        disc(10.0, 5.0, 5.0 + depth, bore(5.0)),
        disc(20.0, 5.0, 5.0 + depth, bore(10.0 + gap)),
    )


@pytest.mark.parametrize("outwards", [False, True])
@pytest.mark.parametrize(("gap", "depth", "holds"), [(2.2, 10.9, True), (2.2, 11.1, False), (3.0, 11.1, True)])
def test_a_slot_is_at_most_five_times_as_deep_as_wide(outwards, gap, depth, holds):
    found = failures(cup(gap, depth, outwards=outwards))
    assert list(found) == ([] if holds else ["slots can be cut"])
    if not holds:
        assert found["slots can be cut"] == [
            f"block: slot {gap:.2f} mm wide, depth = {depth:.2f} mm: must be at most {5.0 * gap:.2f}; fill it or take "
            "one of its walls away"
        ]


def test_a_slot_through_several_layers_counts_whole():
    """As in the ring housing of a knee, which had one of 1.12 x 14.85 mm beside its seat."""
    low = cup(1.12, 4.0)
    more = [replace(prism, z0_mm=9.0, z1_mm=19.85) for prism in low.prisms[1:]]
    found = failures(replace(low, prisms=(*low.prisms, *more)))
    assert "depth = 14.85 mm: must be at most 5.60" in found["slots can be cut"][0]
    assert len(found["slots can be cut"]) == 1


def window(radius):
    """A window of 10 x 6 mm whose corners have a radius, as 8 points per corner."""
    angles = np.linspace(0.0, 0.5 * np.pi, 8)
    corners = [(5.0 - radius, 3.0 - radius), (-5.0 + radius, 3.0 - radius)]
    corners += [(-x, -y) for x, y in corners]
    return polygon(
        [
            (float(x + radius * np.cos(a + 0.5 * k * np.pi)), float(y + radius * np.sin(a + 0.5 * k * np.pi)))
            for k, (x, y) in enumerate(corners)
            for a in angles
        ]
    )


@pytest.mark.parametrize(("radius", "holds"), [(0.01, False), (0.4, False), (1.0, True), (2.5, True)])
def test_windows_have_corners_of_a_millimetre(radius, holds):
    plate = part(layer(rectangle(width_mm=30.0, height_mm=30.0), 0.0, 5.0, window(radius)))
    found = failures(plate)
    assert list(found) == ([] if holds else ["windows can be milled"])
    assert holds or len(found["windows can be milled"]) == 4
    assert failures(replace(plate, process="laser cut")) == {}


def test_a_gap_narrower_than_the_tool_is_found_though_it_is_shallow():
    assert "windows can be milled" in failures(cup(1.9, 2.0))
    assert failures(cup(2.1, 2.0)) == {}


@pytest.mark.parametrize(("x", "holds"), [(4.4, True), (4.6, False)])
def test_holes_keep_half_a_millimetre_from_edges_and_from_each_other(x, holds):
    """Holes of 2 mm at x; the edge is at 5.9, and the other hole at 1.9."""
    beside = part(layer(rectangle(width_mm=11.8, height_mm=20.0), 0.0, 4.0, Circle(radius_mm=1.0, x_mm=x)))
    assert list(failures(beside)) == ([] if holds else ["walls can be made"])
    pair = (Circle(radius_mm=1.0, x_mm=8.9 - x), Circle(radius_mm=1.0, x_mm=2.0))
    between = part(layer(rectangle(width_mm=30.0, height_mm=20.0), 0.0, 4.0, *pair))
    assert list(failures(between)) == ([] if holds else ["walls can be made"])


@pytest.mark.parametrize(("thick", "holds"), [(0.7, False), (0.8, True)])
def test_lips_and_tubes_are_three_quarters_of_a_millimetre_thick(thick, holds):
    expected = [] if holds else ["walls can be made"]
    lip = part(disc(10.0, 0.0, thick, bore(6.0)), disc(10.0, thick, 8.0, bore(8.0)))
    assert list(failures(lip)) == expected
    assert list(failures(part(disc(10.0, 0.0, 5.0), disc(5.0 + thick, 5.0, 9.0, bore(5.0))))) == expected
    # A step that is no higher than it is thick is no lip.
    assert failures(part(disc(10.0, 0.0, 5.0), disc(5.0 + thick, 5.0, 5.0 + 0.5 * thick, bore(5.0)))) == {}


def with_thread(depth, usable, floor, screw=M3, beyond=()):
    """A disc with a blind tapped hole beside its axis."""
    hole = Pattern(radius_mm=screw.core, pitch_radius_mm=10.0, count=3)
    return part(
        disc(20.0, -depth, 0.0, hole),
        *(() if floor is None else (disc(20.0, -depth - floor, -depth),)),
        *beyond,
        features=(tapped(screw, (hole,), -depth, 0.0, enters="high", usable_mm=usable),),
    )


@pytest.mark.parametrize(("screw", "run_out"), [(M3, 1.8), (M4, 2.4)])
def test_taps_run_out_as_din_76_asks(screw, run_out):
    """Table of DIN 76-1, e2: 1.8 mm for M3, 2.4 mm for M4."""
    assert failures(with_thread(6.0 + run_out, 6.0, 5.0, screw)) == {}
    found = failures(with_thread(5.9 + run_out, 6.0, 5.0, screw))
    (text,) = found["taps run out over whole floors"]
    assert f"run-out = {run_out - 0.1:.2f} mm: must be at least {run_out:g}; drill deeper" in text
    # A thread over all of its hole, as of the carrier before.
    assert list(failures(with_thread(6.0, None, 5.0, screw))) == ["taps run out over whole floors"]
    assert failures(with_thread(6.0, None, None, screw)) == {}


def test_the_table_of_run_outs_goes_on_by_the_next_pitch():
    """DIN 76-1 has 1.6 for 0.45, 2.7 for 0.8, 3.2 for 1, and 3.9 for 1.25 mm."""
    assert [tap_run_out_mm(pitch) for pitch in (0.45, 0.8, 0.9, 1.0, 1.25)] == [1.6, 2.7, 3.2, 3.2, 3.9]
    assert tap_run_out_mm(2.0) == 8.0


@pytest.mark.parametrize(("floor", "holds"), [(1.0, False), (1.2, False), (1.3, True)])
def test_a_floor_outlasts_the_drill_s_point(floor, holds):
    """A drill of 2.5 mm and 118 degrees stands out by 0.75 mm, and 0.5 mm must be left."""
    pins = Pattern(radius_mm=3.0, pitch_radius_mm=10.0, count=3)
    beyond = (disc(20.0, -13.0 - floor, -8.0 - floor, pins), disc(20.0, -14.0 - floor, -13.0 - floor))
    found = failures(with_thread(8.0, 6.0, floor, beyond=beyond))
    assert list(found) == ([] if holds else ["taps run out over whole floors"])
    assert holds or f"floor = {floor:.2f} mm: must be at least 1.25; drill less deep" in str(found)


@pytest.mark.parametrize(("wall", "holds"), [(10.2, False), (9.3, True)])
def test_a_thread_that_ends_half_in_a_wall_has_no_run_out(wall, holds):
    """Threads of a flange at 10 mm, and a tube from there on; 9.3 mm cover 18 percent of the holes."""
    half = with_thread(5.0, None, None, beyond=(disc(wall, -30.0, -5.0, bore(5.0)),))
    assert list(failures(half)) == ([] if holds else ["taps run out over whole floors"])
    # What begins a run-out away does not matter, nor does a wall that is turned thinner over this length.
    assert failures(with_thread(5.0, None, None, beyond=(disc(wall, -30.0, -6.8, bore(5.0)),))).keys() <= {"x"}
    relieved = (disc(8.7, -6.8, -5.0, bore(5.0)), disc(wall, -30.0, -6.8, bore(5.0)))
    assert failures(with_thread(5.0, None, None, beyond=relieved)) == {}


@pytest.mark.parametrize("outside", [True, False])
@pytest.mark.parametrize(("collar", "holds"), [(0.9, False), (1.1, True)])
def test_collars_are_half_as_thick_as_their_groove_is_deep(outside, collar, holds):
    """A groove 2 mm deep and 2 mm wide in a shaft, or in a bore, of 40 mm."""
    around = () if outside else (bore(20.0),)
    radius = 20.0 if outside else 30.0
    low = disc(radius, 0.0, 10.0, *around)
    groove = disc(18.0, 10.0, 12.0) if outside else disc(30.0, 10.0, 12.0, bore(22.0))
    high = disc(radius, 12.0, 12.0 + collar, *around)
    fit = Fit(diameter_mm=36.0 if outside else 44.0, zone="h12" if outside else "H12")
    found = failures(part(low, groove, high, fits=(fit,)))
    assert list(found) == ([] if holds else ["grooves of retaining rings have collars"])
    assert holds or f"= {collar:.2f} mm: must be at least 1.00" in str(found)


@pytest.mark.parametrize(("diameter", "holds"), [(81.249, False), (81.25, False), (81.3, True), (82.0, True)])
def test_fits_have_gauges(diameter, holds):
    found = failures(part(disc(0.5 * diameter, 0.0, 5.0), fits=(Fit(diameter_mm=diameter, zone="h6"),)))
    assert list(found) == ([] if holds else ["fits can be gauged"])


def shaft(*, centres=2, relief=True, rear=True, raceway=True):
    """A hard shaft of 12 and 20 mm, ground on 12 mm at both ends."""
    small = Mouth.of_centre(1.06, 0.5)
    holes = [
        Hole(shapes=(bore(0.5),), low_mm=0.0, high_mm=2.0, low=small),
        Hole(shapes=(bore(0.5),), low_mm=28.0, high_mm=30.0, high=small),
    ]
    thin = 5.9 if relief else 6.0
    return part(
        disc(6.0, 0.0, 2.0, bore(0.5)),
        disc(6.0, 2.0, 9.0),
        disc(thin, 9.0, 10.0),
        disc(10.0, 10.0, 20.0),
        disc(thin if rear else 5.0, 20.0, 21.0),
        disc(6.0 if rear else 5.0, 21.0, 28.0),
        disc(6.0 if rear else 5.0, 28.0, 30.0, bore(0.5)),
        fits=(Fit(diameter_mm=12.0, zone="h6", seat=True, raceway=raceway),),
        features=tuple(holes[:centres]),
    )


def test_ground_shafts_have_centres_reliefs_and_a_datum():
    assert failures(shaft()) == {}
    (text,) = failures(shaft(centres=1))["ground shafts have centres and reliefs"]
    assert text == "block: end at 30.00 mm: must have a centre hole; add one of DIN 332"
    found = failures(shaft(relief=False))["ground shafts have centres and reliefs"]
    assert [text[:34] for text in found] == ["block: seat 12 h6 at 10.00 mm, rel", "block: seat 12 h6 at 20.00 mm, rel"]
    assert failures(shaft(rear=False)) == {
        "ground shafts have a datum axis": [
            "block: length between the ends of its seats = 9.00 mm: must be at least 15.00; add a seat"
        ]
    }
    # What is turned in one clamping needs none of it.
    assert failures(shaft(centres=0, relief=False, rear=False, raceway=False)) == {}


def test_a_chamfer_is_no_centre():
    blunt = Mouth.at_90_degrees(1.06, 0.5)
    features = tuple(replace(hole, low=hole.low and blunt, high=hole.high and blunt) for hole in shaft().features)
    assert len(failures(replace(shaft(), features=features))["ground shafts have centres and reliefs"]) == 2
    assert Mouth.of_centre(1.5, 0.5).kind is Cone.CENTRE
    assert float(Mouth.of_centre(1.5, 0.5).depth_mm) == pytest.approx(np.tan(np.radians(60.0)))


def test_an_export_says_which_part_breaks_a_rule(product, examine):
    def deeper(hole):
        return replace(hole, thread_mm=4.0 + hole.thread_mm) if isinstance(hole, Hole) and hole.thread_mm else hole

    unique = tuple(
        replace(one, part=replace(one.part, features=tuple(map(deeper, one.part.features))))
        if "carrier" in one.name
        else one
        for one in product.unique
    )
    assert unique != product.unique
    checks = making.check(unique)
    (failed,) = (check for check in checks if not check.passed)
    assert failed.name == "taps run out over whole floors"
    assert "carrier" in failed.failures[0]
    assert {check.name for check in checks} <= set(examine())


def winners(name, rules, most):
    """Gearboxes of the map, evenly spread over its families, from one of the first to one of the last."""
    found = map_of(load_motor(name), rules)
    best = [(family, result.best) for entry in found.entries for family, result in entry.families.items()]
    best = sorted(((family, one) for family, one in best if one is not None), key=lambda pair: pair[0])
    for k in np.unique(np.linspace(0, len(best) - 1, most).astype(int)):
        family, one = best[k]
        yield build_actuator(load_motor(name), family, one.gears, found.settings, one.face_width_mm)


def check_winners(name, rules, most):
    seen = set()
    for actuator in winners(name, rules, most):
        seen.add(actuator.family)
        assert failures(*actuator.parts) == {}, actuator
    assert seen == {family for entry in map_of(load_motor(name), rules).entries for family in entry.families}


@pytest.mark.parametrize("name", ["VT8020", "U8"])
def test_winners_can_be_made(name):
    check_winners(name, "iso6336", 4)


@pytest.mark.long
@pytest.mark.parametrize("rules", ["iso6336", "paper"])
@pytest.mark.parametrize("name", MOTORS)
def test_all_winners_of_every_motor_can_be_made(name, rules):
    check_winners(name, rules, 1000)

"""Threads and seats of all screws: alloys of the drawn holes, areas of helix and ring."""

from dataclasses import replace

import numpy as np
import pytest
import shapely

from pareto_monoped.geometry.roles import SCREWS
from pareto_monoped.geometry.screws import M4, M5
from pareto_monoped.materials import ALLOYS
from pareto_monoped.strength import threads
from tests.strength.drawn import BASE, BOTH, ROWS, SHANK, THIGH, D, S, region

YIELD, HARD = 250.0, 460.0  # MPa: EN AW-6082 T6, EN AW-7075 T6


WHERE = {
    "knee_cup_screw_near": (THIGH, YIELD),
    "knee_cup_screw_far": (THIGH, YIELD),
    "thigh_standoff_screw": (THIGH, YIELD),
    "hip_seat_screw": (BASE, YIELD),
    "base_lower_rod_screw_near": (BASE, YIELD),
    "base_upper_rod_screw_far": (BASE, YIELD),
    "hip_mount_screw": (BASE, None),  # in the actuator
}


@pytest.mark.parametrize("name", WHERE)
def test_a_screw_finds_the_part_that_has_its_thread(name):
    unit, limit = WHERE[name]
    assert threads.threaded_mpa(unit[name], tuple(unit.values())) == limit


def test_a_thread_of_weaker_metal_or_half_as_deep_counts():
    soft = replace(ALLOYS["aw_6082_t6"], yield_mpa=50.0)
    parts = [replace(part, grade=soft) if part.name == "base_rod" else part for part in BASE.values()]
    before, after = (threads.least_tightened(unit, 1e6) for unit in (tuple(BASE.values()), parts))
    # Female threads of M4: 14 / 16 of the pitch on 4 mm; of the upper screws, M4 x 16, 8 mm are left below the grip.
    thread = 0.897 * 50.0 / np.sqrt(3.0) * np.pi * 4.0 * 0.875 * 8.0
    assert after == pytest.approx(thread / BASE["base_lower_rod_screw_near"].fastening.preload_n, rel=1e-6)
    assert before > after
    screw = BASE["hip_seat_screw"]
    whole = threads.tightened(screw, YIELD, YIELD)
    thinnest = min(screw.prisms, key=lambda prism: prism.outline.radius_mm)
    half = replace(thinnest, z1_mm=0.5 * (thinnest.z0_mm + thinnest.z1_mm))
    cut = replace(screw, prisms=tuple(half if prism is thinnest else prism for prism in screw.prisms))
    assert threads.tightened(cut, YIELD, YIELD) == pytest.approx(0.5 * whole)


def test_the_least_seat_of_the_leg_is_that_of_the_knee_s_nuts():
    """ISO 4032, M4: a ring of 5.8 to 4.3 mm at one and a half times the yield stress."""
    bolt = SHANK["knee_bolt"].fastening
    ring = 0.25 * np.pi * ((0.83 * 7.0) ** 2 - 4.3**2)
    assert ROWS["leg_threads"].capacity(S) == pytest.approx(1.5 * YIELD * ring / bolt.preload_n)


@pytest.mark.parametrize("family", BOTH)
def test_every_screw_of_an_actuator_is_held_by_its_thread_and_seat(family):
    """Threads by the area of a helix on the screw's outer diameter; seats by the ring under the head."""
    s = BOTH[family]
    least = np.inf
    for part in (p for p in s.actuator.parts if p.role in SCREWS):
        found = part.fastening
        d = found.thread.diameter_mm
        thinnest = min(part.prisms, key=lambda prism: prism.outline.moments().area)
        engaged = thinnest.z1_mm - thinnest.z0_mm
        if part.name == "planet_pin_screw":
            continue  # in hardened steel
        weak = HARD if part.name == "web_screw" or (part.name, family) == ("coupling_screw", "ISSPG") else YIELD
        least = min(least, 0.897 * weak / np.sqrt(3.0) * np.pi * d * 0.875 * engaged / found.preload_n)
        if found.head != "countersunk":
            ring = 0.25 * np.pi * (found.bearing_mm**2 - found.hole_mm**2)
            least = min(least, 1.5 * YIELD * ring / found.preload_n)
    assert ROWS["knee_actuator_threads"].capacity(s) == pytest.approx(least, rel=1e-6)


@pytest.mark.parametrize(("family", "engaged_mm"), [("ISSPG", 6.0), ("ESSPG", 5.0)])
def test_the_journal_s_screws_hold_in_the_motor(family, engaged_mm):
    """In the backplate of an ISSPG, and through that of an ESSPG in its motor, 250 MPa; on the journal's flange."""
    s = BOTH[family]
    size, diameters = D.knee.back_screw_mm, M4 if D.knee.back_screw_mm == 4.0 else M5
    found = diameters.fastening("cap", "8.8")
    thread = 0.897 * YIELD / np.sqrt(3.0) * np.pi * size * 0.875 * engaged_mm
    ring = 0.25 * np.pi * (found.bearing_mm**2 - found.hole_mm**2)
    expected = min(thread, 1.5 * YIELD * ring) / found.preload_n
    assert ROWS["knee_journal_threads"].capacity(s) == pytest.approx(expected)


def test_the_journal_s_screws_hold_in_a_pad_that_is_thin_beside_them():
    """C1 of VDI 2230-1 (5.5.5) for narrow nuts, by the pad's width in each direction from the thread; 0.5 mm least.

    It is used below its 1.4 diameters, where it falls faster than thin nuts do.
    """
    plate, pad = next(part for part in BOTH["ISSPG"].actuator.parts if part.name == "backplate").prisms[:2]
    size, depth, thin = D.knee.back_screw_mm, plate.z1_mm - plate.z0_mm, pad.z1_mm - pad.z0_mm
    at = shapely.Point(D.knee.back_pitch_radius_mm, 0.0)
    metal = region(pad).union(at.buffer(0.5 * size))
    ways = np.exp(1j * np.linspace(0.0, 2.0 * np.pi, 720, endpoint=False))
    rays = (shapely.LineString([(at.x, 0.0), (at.x + 30.0 * way.real, 30.0 * way.imag)]) for way in ways)
    widths = np.array([2.0 * shapely.intersection(ray, metal.boundary).distance(at) for ray in rays]) / size
    assert (depth + thin, widths.min() * size) == pytest.approx((6.0, size + 1.0), abs=0.03)
    c1 = np.where(widths < 1.9, 3.8 * widths - widths**2 - 2.61, 1.0)
    stripped_n = 0.897 * YIELD / np.sqrt(3.0) * np.pi * size * 0.875 * (depth + c1.mean() * thin)
    assert stripped_n / M5.fastening("cap", "8.8").preload_n == pytest.approx(1.31, abs=0.02)


def test_what_no_part_has_tapped_is_in_the_motor(monkeypatch):
    """The ESSPG's screws into the motor's base and turning face, 5 mm deep, in metal as soft as lead."""
    s = BOTH["ESSPG"]
    motor = [part for part in s.actuator.parts if part.name in ("stator_screw", "coupling_screw")]
    assert [threads.threaded_mpa(part, s.actuator.parts) for part in motor] == [None, None]
    monkeypatch.setattr(threads, "MOTOR_FACE_MPA", 12.0)
    least = np.inf
    for part in motor:
        thinnest = min(part.prisms, key=lambda prism: prism.outline.moments().area)
        engaged, size = thinnest.z1_mm - thinnest.z0_mm, part.fastening.thread.diameter_mm
        force = 0.897 * 12.0 / np.sqrt(3.0) * np.pi * size * 0.875 * engaged
        least = min(least, force / part.fastening.preload_n)
    assert ROWS["hip_actuator_threads"].capacity(s) == pytest.approx(least, rel=1e-6)

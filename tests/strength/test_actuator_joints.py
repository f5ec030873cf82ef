"""Joints of the actuators: capacities by hand from the dimensions of the data, and what all motors must hold."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from pareto_monoped.actuator.motors import motor_names
from pareto_monoped.actuator.search import map_for
from pareto_monoped.leg.dimensions import leg_dimensions
from pareto_monoped.strength import drive, mounts
from pareto_monoped.strength.connections import SHAPE_SAFETY
from pareto_monoped.strength.factors import TABLE
from pareto_monoped.strength.joint import Structure

BASE = np.cos(np.radians(20.0))


def structures(motor, rules="iso6336"):
    found = map_for(motor, rules=rules)
    leg = leg_dimensions(found)
    return [
        Structure(actuator=entry.actuator, leg=leg, settings=found.settings)
        for entry in found.entries
        if entry.actuator is not None
    ]


@pytest.fixture(scope="module")
def vt8020():
    """One actuator of either family."""
    found = structures("VT8020")
    return {family: next(s for s in found if s.actuator.family == family) for family in ("ISSPG", "ESSPG")}


def test_spline_and_shaft_by_hand(vt8020):
    """Module 0.5: 24 teeth in the ISSPG on a shaft of 9.8 mm, 18 in the ESSPG on 8 mm; coupling of 3 mm, 460 MPa."""
    for family, teeth, shaft_mm in (("ISSPG", 24, 4.9), ("ESSPG", 18, 4.0)):
        s = vt8020[family]
        pitch = 0.25 * teeth
        base, tip = pitch * BASE, pitch + 0.5
        torque = 0.75 * teeth * (tip - base) * 3.0 * 0.5 * (tip + base) * 460.0 * 1e-3
        assert drive.spline(s) == pytest.approx(torque * s.actuator.ratio)
        thinnest = min(shaft_mm, pitch - 0.625, float(s.actuator.gears.sun().root_radius_mm))
        if family == "ESSPG":
            # The hob runs out into the shaft of 8 mm, down to the spline's roots of 7.75 mm.
            assert thinnest == 3.875
        yielding = s.settings.gear_steels.sun.yield_mpa / np.sqrt(3.0)
        assert drive.shaft(s) == pytest.approx(1e-3 * yielding * np.pi * thinnest**3 / 2.0 * s.actuator.ratio)


def test_coupling_dowels_by_hand(vt8020):
    """Dowels of 2.5 mm: four on 24 mm through the bell, 2 mm; six on 71.5 mm into the motor's face, 3 mm."""
    s = vt8020["ISSPG"]
    assert drive.coupling_dowels(s) == pytest.approx(4 * 2.5 * 2.0 * 250.0 * 0.012 * s.actuator.ratio)
    s = vt8020["ESSPG"]
    assert drive.coupling_dowels(s) == pytest.approx(6 * 2.5 * 3.0 * 250.0 * 0.03575 * s.actuator.ratio)


def test_ring_and_its_housing_by_hand(vt8020):
    for s in vt8020.values():
        radius, share = float(drive.layout_of(s).r_ring), 1.0 - 1.0 / s.actuator.ratio
        bond = 5.0 * 2.0 * np.pi * radius**2 * s.actuator.face_width_mm * 1e-3
        assert drive.ring(s) == pytest.approx(bond / share)
    # Three dowels of 2.5 mm in 3 mm of either flange.
    pin = drive.one(vt8020["ISSPG"], drive.Role.PIN, drive.Group.HOUSING)
    given = 3 * 2.5 * 3.0 * 250.0 * 1e-3 * float(pin.pitch_radius_mm)
    assert drive.ring_housing(vt8020["ISSPG"]) == pytest.approx(given)
    assert drive.ring_housing(vt8020["ESSPG"]) == np.inf


def test_collars_of_retaining_rings_by_hand(vt8020):
    """Shaft of 40 with a groove of 37.5: 1.25 deep, collar 0.75, 460 MPa. Bore of 72 in the knee: 75, 1.5, 250 MPa."""
    bends = 460.0 * np.pi * 37.5 * 0.75**2 / (3.0 * 1.25)
    assert drive.retaining_rings(vt8020["ISSPG"]) == pytest.approx(bends) == pytest.approx(8129.0, abs=1.0)
    knee = next(s for s in structures("VT8020") if float(drive.layout_of(s).bore_ring.size_mm) == 72.0)
    assert drive.retaining_rings(knee) == pytest.approx(250.0 * np.pi * 75.0 * 0.75**2 / (3.0 * 1.5))
    # 1 mm deep, a collar of 6 mm shears less easily than the groove's wall yields.
    stout = SimpleNamespace(size_mm=40.0, groove_diameter_mm=38.0, collar_mm=6.0)
    assert drive.collar_force_n(stout, 100.0) == pytest.approx(100.0 * 0.25 * np.pi * (40.0**2 - 38.0**2))
    flat = SimpleNamespace(size_mm=40.0, groove_diameter_mm=39.8, collar_mm=0.1)
    assert drive.collar_force_n(flat, 100.0) == pytest.approx(100.0 * np.pi * 39.8 * 0.1**2 / 0.3)
    deep = SimpleNamespace(size_mm=40.0, groove_diameter_mm=36.0, collar_mm=4.0)
    assert drive.collar_force_n(deep, 100.0) == pytest.approx(100.0 * 0.25 * np.pi * (40.0**2 - 36.0**2))


def test_a_collar_yields_as_a_strip_that_is_clamped_at_its_root(vt8020):
    """A strip of the collar 1 mm wide, clamped at the groove's bottom, under an even pressure over its height."""
    ring = drive.layout_of(vt8020["ISSPG"]).shaft_ring
    depth, thick, around = 1.25, 0.75, np.pi * 37.5
    heights = np.linspace(0.0, depth, 2001)
    force = drive.collar_force_n(ring, 460.0) / around
    moment = np.trapezoid(force / depth * heights, heights)
    assert moment * 0.5 * thick / (thick**3 / 12.0) == pytest.approx(460.0, rel=1e-6)


def test_the_floor_and_the_chain_push_the_rings_by_their_shares():
    rows = {joint.name: joint for joint in TABLE if joint.name.endswith("retaining_rings")}
    assert {name: row.loads for name, row in rows.items()} == {
        "hip_retaining_rings": ("peak_foot_force_n",),
        "knee_retaining_rings": ("peak_chain_tension_n",),
    }
    s = structures("VT8020")[0]
    for row, factor in ((rows["hip_retaining_rings"], 4.0), (rows["knee_retaining_rings"], 80.0)):
        force = row.capacity(s)
        assert force == drive.retaining_rings(s)
        assert row.factor(force, 0.25 * force) == pytest.approx(factor)


def test_a_dowel_shears_where_the_holes_are_stronger(vt8020):
    pin = drive.one(vt8020["ISSPG"], drive.Role.PIN, drive.Group.ROTOR)
    sheared = 4 * np.pi * 1.25**2 * 0.75 * 1300.0 / np.sqrt(3.0)
    assert drive.dowel_force_n(pin, (50.0, 460.0)) == pytest.approx(sheared)
    assert drive.dowel_force_n(pin, (1.0, 250.0), (50.0, 460.0)) == pytest.approx(4 * 2.5 * 250.0)


def test_dowels_of_the_outputs_by_hand(vt8020):
    """Three of 4 mm on 24 mm. Hip: 2.5 mm of plate, 250 MPa. Knee: the sprocket, or 460 MPa in the flange."""
    s = vt8020["ISSPG"]
    torque, force = mounts.hip_output(s)
    assert force == pytest.approx(3 * 4.0 * 2.5 * 250.0)
    assert torque == pytest.approx(0.012 * force)
    torque, force = mounts.knee_output(s)
    width = s.leg.chain.sprocket_width_mm
    # A pin of 20 mm in the middle of 4.5 mm of flange, 12.2 mm of coupling and the sprocket's width.
    spare = s.leg.knee.output_thread_mm + s.leg.knee_mount_mm + 0.5 * width - 20.0
    engaged = min(s.leg.knee.output_thread_mm, width) - 0.5 * spare
    assert 0.0 <= spare < 2.0
    assert force == pytest.approx(min(3 * 4.0 * engaged * 460.0, 9.0 * np.pi * 1300.0 / np.sqrt(3.0)))
    assert torque == pytest.approx(0.012 * force)
    # Three of 3 mm in the hip's housing, six in the outer plate.
    assert mounts.hip_mount(s)[1] == pytest.approx(3 * 3.0 * 4.5 * 250.0)
    torque, force = mounts.knee_mount(s)
    assert force == pytest.approx(6 * 3.0 * s.leg.plate_mm * 250.0)
    assert torque == pytest.approx(1e-3 * s.leg.knee.mount_pitch_radius_mm * force)


def test_torque_and_force_add_up():
    """Of three dowels, the one where both point the same way carries T / (3 r) + F / 3."""
    pull, torque, radius = 900.0, 30.0, 0.012
    angles = 2.0 * np.pi / 3.0 * np.arange(3)
    turning = torque / (3 * radius) * np.stack([-np.sin(angles), np.cos(angles)])
    worst = max(
        np.linalg.norm(turning + pull / 3.0 * np.array([[np.cos(a)], [np.sin(a)]]), axis=0).max()
        for a in np.linspace(0.0, 2.0 * np.pi, 721)
    )
    factor = mounts.dowels_under(3 * radius * 5000.0, 3 * 5000.0, torque, pull)
    assert factor == pytest.approx(5000.0 / worst, rel=1e-4)


@pytest.mark.parametrize("motor", motor_names())
def test_every_motor_s_drive_holds_two_and_a_half_times_its_peak(motor):
    """The sun's drive once failed at a third of the peak torque. Screws and fits stay elastic."""
    for s in structures(motor):
        peak = s.actuator.peak_torque_n_m
        least = min(drive.spline(s), drive.shaft(s), drive.coupling_dowels(s))
        assert least >= SHAPE_SAFETY * 2.5 * peak
        assert drive.ring(s) >= drive.BOND_SAFETY * 2.5 * peak
        assert drive.ring_housing(s) >= SHAPE_SAFETY * 1.5 * peak
        assert min(drive.planet_pins(s)) >= SHAPE_SAFETY * 2.5 * peak
        assert drive.housing_screws(s) >= drive.SLIP_SAFETY * peak
    assert mounts.screws_tightened(s) >= 1.0
    assert mounts.dowels_pressed(s) >= 1.0


def test_a_pin_is_engaged_where_both_it_and_its_hole_are(vt8020):
    """The bell's holes are 2 mm long: a pin that ends in them counts with what is inside."""
    s = vt8020["ISSPG"]
    pin, bell = drive.one(s, drive.Role.PIN, drive.Group.ROTOR), drive.one(s, drive.Role.MOTOR_ROTOR, drive.Group.ROTOR)
    assert drive.engaged_mm(pin, bell) == pytest.approx(2.0)
    (body,) = pin.prisms
    short = replace(pin, prisms=(replace(body, z1_mm=body.z0_mm + 4.2),))
    assert drive.engaged_mm(short, bell) == pytest.approx(1.2)
    assert drive.engaged_mm(replace(pin, phase_rad=0.0), bell) == 0.0

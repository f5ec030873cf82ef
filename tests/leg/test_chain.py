"""The chain has whole links at any length, its turnbuckles reach what is left, and the notes say so."""

import dataclasses

import numpy as np
import pytest

from pareto_monoped.leg.chain import TURNBUCKLE, chain_parts, links_of
from pareto_monoped.leg.chain_drives import CHAIN_DRIVES
from pareto_monoped.leg.stops import knee_stop

LENGTHS = np.arange(3000, 5001) / 10.0  # mm, all that are made between 0.3 and 0.5 m


def test_pieces_have_whole_odd_links_and_the_turnbuckles_close_the_loop(leg_of_each_chain):
    d = leg_of_each_chain
    for length in LENGTHS:
        at_hip, at_knee, pins = links_of(float(length), d)
        assert at_hip % 2 == at_knee % 2 == 1  # an inner link at both ends
        assert abs(at_hip - at_knee) <= 2
        around = 2.0 * length + d.chain.teeth * d.chain.pitch_mm
        assert (at_hip + at_knee) * d.chain.pitch_mm + 2.0 * pins == pytest.approx(around)
        assert abs(pins - TURNBUCKLE) <= 0.5 * d.chain.pitch_mm + 1e-6


def test_travel_and_thread_of_the_turnbuckles(leg):
    """Half a pitch and 1 mm to either side, with 1.25 diameters of thread left at the long end."""
    parts = {part.name: part for part in chain_parts(400.0, dataclasses.replace(leg, chain=CHAIN_DRIVES[-1]))}
    low, high = np.min([p.z0_mm for p in parts["turnbuckle_barrel"].prisms]), 0.5 * CHAIN_DRIVES[-1].pitch_mm + 1.0
    assert low == -3.5
    xs = [piece.x0_mm for prism in parts["turnbuckle_end"].prisms for piece in getattr(prism.outline, "pieces", ())]
    inside = 0.5 * TURNBUCKLE + min(xs)  # of the stud's end from the barrel's middle
    deep = 14.0 - inside
    assert deep - 0.5 * high >= 1.25 * 4.0
    # At the short end the studs do not meet, and the forks do not meet the barrel.
    assert inside - 0.5 * high > 0.0
    root = -sorted(set(xs))[1]
    assert 0.5 * TURNBUCKLE - root - 0.5 * high > 14.0 - 1e-9


def test_no_turnbuckle_reaches_a_sprocket(leg_of_each_chain):
    d = leg_of_each_chain
    radius = 0.5 * d.chain.pitch_mm / np.sin(np.pi / d.chain.teeth)
    stop = knee_stop(d)
    moved = (stop.upper_rad + stop.travel_rad) * radius
    # Half a turnbuckle with its fork, and the 6 mm that it may stand beside the strand's middle.
    free = 0.5 * LENGTHS[0] - 0.5 * TURNBUCKLE - 0.5 * d.chain.plate_mm - 6.0 - moved
    assert free > 2.0 * d.chain.pitch_mm


def test_whole_links_weigh_what_the_smooth_description_does(leg_of_each_chain):
    d = leg_of_each_chain
    for length in LENGTHS[::7]:
        at_hip, at_knee, _ = links_of(float(length), d)
        parts = [part for part in chain_parts(float(length), d) if part.name.startswith("chain_")]
        described = sum(part.mass_kg() for part in parts)
        real = 1e-3 * (at_hip + at_knee) * d.chain.pitch_mm * d.chain.kg_per_m
        assert abs(real - described) <= 1e-3 * d.chain.pitch_mm * d.chain.kg_per_m + 1e-9
        assert abs(real / described - 1.0) < 0.015


def test_the_parts_list_gives_whole_links_and_the_setting(leg):
    notes = {part.name: part.note for part in chain_parts(347.3, leg)}
    assert notes["chain_hip"] == "05B-1 (ISO 606), 47 links of 8 mm, an inner link at both ends"
    assert notes["chain_knee"].startswith("05B-1 (ISO 606), 47 links of 8 mm")
    assert "set to 51.3 mm between pins, travel 43 to 53 mm" in notes["turnbuckle_barrel"]


def test_pins_of_the_turnbuckles_stand_in_the_chain_s_last_links(leg):
    parts = {part.name: part for part in chain_parts(400.0, leg)}
    holes = {
        (round(float(hole.x_mm), 6), round(float(hole.y_mm), 6))
        for name in ("chain_hip", "chain_knee")
        for prism in parts[name].prisms
        for hole in prism.holes
    }
    end = parts["turnbuckle_end"]
    pins = {
        (round(x, 6), round(y + side * end.pitch_radius_mm, 6)) for x, y, _ in end.places_mm for side in (-1.0, 1.0)
    }
    assert holes == pins
    assert end.phase_rad == pytest.approx(0.5 * np.pi)

"""The chain's pieces have whole links, its turnbuckles take up the rest at any length, and the notes say so."""

import numpy as np
import pytest

from pareto_monoped.leg.chain import TRAVEL, chain_parts, links_of, reach_mm
from pareto_monoped.leg.stops import knee_stop

LENGTHS = np.arange(2500, 5501) / 10.0  # mm, all that are made between 0.25 and 0.55 m


def parts_of(length_mm, d):
    return {part.name: part for part in chain_parts(length_mm, d)}


def pins_mm(parts):
    """Between the pins of a turnbuckle."""
    return parts["turnbuckle_end_hip"].places_mm[0][1] - parts["turnbuckle_end_knee"].places_mm[0][1]


def test_a_piece_has_an_odd_number_of_links_that_covers_half_its_sprocket_and_both_straights(leg_of_each_chain):
    d = leg_of_each_chain
    assert links_of(d) % 2 == 1  # an inner link at both ends
    half_round = 0.5 * d.chain.teeth * d.chain.pitch_mm
    assert links_of(d) * d.chain.pitch_mm == pytest.approx(half_round + 2.0 * reach_mm(d))


def test_the_loop_closes_at_any_length(leg):
    """Two pieces and two turnbuckles make the way around both sprockets, polygons of 14 pitches."""
    for length in LENGTHS[::100]:
        pins = pins_mm(parts_of(float(length), leg))
        around = 2.0 * length + leg.chain.teeth * leg.chain.pitch_mm
        assert 2.0 * links_of(leg) * leg.chain.pitch_mm + 2.0 * pins == pytest.approx(around)


def test_no_turnbuckle_reaches_a_sprocket_over_the_whole_range_of_the_stops(leg_of_each_chain):
    d = leg_of_each_chain
    stop = knee_stop(d)
    radius = 0.5 * d.chain.pitch_mm / np.sin(np.pi / d.chain.teeth)
    moved = 0.5 * (stop.upper_rad - stop.lower_rad + 2.0 * stop.travel_rad) * radius
    # The last pin stays on the straight, and so does the whole link before it as far as its pins are apart.
    assert reach_mm(d) - moved > 0.9 * d.chain.pitch_mm


@pytest.mark.parametrize("length", [250.0, 347.3, 550.0])
@pytest.mark.parametrize("side", ["hip", "knee"])
def test_travel_and_thread_of_the_turnbuckles(leg_of_each_chain, length, side):
    """4 mm of either end to either side, with at least 1.25 diameters of thread left and no end that meets anything."""
    parts = parts_of(length, leg_of_each_chain)

    def along(name):
        """Least and greatest distance of a part's material from the middle of its strand."""
        part = parts[f"turnbuckle_{name}"]
        pieces = [piece for prism in part.prisms for piece in getattr(prism.outline, "pieces", ())]
        ends = [abs(0.5 * length + part.places_mm[0][1] + y) for piece in pieces for y in (piece.y0_mm, piece.y1_mm)]
        return min(ends), max(ends)

    outer = along("bar")[1]
    stud = along(f"end_{side}")[0]
    tapped = 16.0
    assert outer > tapped  # both threads fit into the bar
    assert outer - stud - TRAVEL >= 1.25 * 5.0
    assert stud - TRAVEL > outer - tapped  # the stud ends before its thread does
    nut_in, nut_out = along(f"nut_{side}")
    assert nut_in == pytest.approx(outer)
    assert nut_out - nut_in == pytest.approx(2.7)  # ISO 4035, M5
    root = 0.5 * pins_mm(parts) - 10.0
    assert root - nut_out - TRAVEL > 0.0


def test_the_parts_list_gives_whole_links_and_the_bar_s_length(leg):
    notes = {name: part.described for name, part in parts_of(347.3, leg).items()}
    assert notes["chain_hip"].startswith("roller chain ISO 606 - 084 - 15 links of 12.7 mm, an inner link at both ends")
    assert notes["chain_knee"] == notes["chain_hip"]
    # 347.3 mm less both reaches of 50.8 mm and both ends of 17 mm.
    assert "8 mm square, 211.7 mm long, milled to 3 mm" in notes["turnbuckle_bar"]
    assert notes["turnbuckle_nut_hip"].startswith("thin nut ISO 4035 - M5 - 05")
    assert notes["turnbuckle_nut_knee"].startswith("thin nut ISO 4035 - M5-LH - 05")


def test_threads_and_pins_of_the_turnbuckles_are_said_in_full(leg):
    """Hand, class and length of each; the chain's pin is riveted into reamed holes and is no part of the fork."""
    parts = parts_of(400.0, leg)
    notes = {name: part.note for name, part in parts.items()}
    stud = "17.5 mm long without undercut, run-out before the fork 1 mm at most"  # 10 + 7.5 mm, as drawn
    assert f"right-hand stud M5x0.8 - 6g, {stud}" in notes["turnbuckle_end_hip"]
    assert f"left-hand stud M5x0.8 LH - 6g, {stud}" in notes["turnbuckle_end_knee"]
    assert "tapped M5x0.8 - 6H at one end and M5x0.8 LH - 6H at the other" in notes["turnbuckle_bar"]
    assert "14.5 mm deep at least with a bottoming tap, drill 4.2 mm, 16 mm deep" in notes["turnbuckle_bar"]
    for end in ("hip", "knee"):
        assert "the pin, drawn as a boss, is no part of it: it is the chain's own" in notes[f"turnbuckle_end_{end}"]
        assert f"holes {leg.chain.pin_diameter_mm:g} H7 that are reamed" in notes[f"turnbuckle_end_{end}"]
        heights = [
            y
            for prism in parts[f"turnbuckle_end_{end}"].prisms[-1:]
            for line in prism.outline.pieces
            for y in (line.y0_mm, line.y1_mm)
        ]
        assert max(heights) - min(heights) == pytest.approx(17.5)


def test_only_the_bars_grow_with_the_thigh(leg):
    short, long = parts_of(300.0, leg), parts_of(500.0, leg)
    for name, part in short.items():
        grown = float(long[name].mass_kg() - part.mass_kg())
        if name == "turnbuckle_bar":
            assert grown == pytest.approx(2.0 * 200.0 * 8.0 * 3.0 * 2710e-9)
        else:
            assert grown == pytest.approx(0.0, abs=1e-15)


def test_a_piece_weighs_what_its_links_do(leg_of_each_chain):
    d = leg_of_each_chain
    for name in ("chain_hip", "chain_knee"):
        assert float(parts_of(400.0, d)[name].mass_kg()) == pytest.approx(15 * 12.7e-3 * d.chain.kg_per_m)


def test_pins_of_the_turnbuckles_stand_in_the_chain_s_last_links(leg):
    parts = parts_of(400.0, leg)
    holes = {
        (round(float(hole.x_mm), 6), round(float(hole.y_mm), 6))
        for name in ("chain_hip", "chain_knee")
        for prism in parts[name].prisms
        for hole in prism.holes
    }
    ends = [parts[f"turnbuckle_end_{side}"] for side in ("hip", "knee")]
    pins = {(round(x, 6), round(y, 6)) for end in ends for x, y, _ in end.places_mm}
    assert holes == pins
    assert len(pins) == 4


def test_every_stud_has_its_nut(leg):
    parts = parts_of(400.0, leg)
    for side in ("hip", "knee"):
        end, nut = parts[f"turnbuckle_end_{side}"], parts[f"turnbuckle_nut_{side}"]
        assert [place[0] for place in end.places_mm] == [place[0] for place in nut.places_mm]
        assert nut.joint.partner == end.name

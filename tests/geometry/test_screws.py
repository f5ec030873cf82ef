"""Screws: catalogue lengths, masses against tables, and prisms that stand where they are asked to."""

import numpy as np
import pytest

from pareto_monoped.errors import DesignError
from pareto_monoped.geometry.features import CountersunkHead
from pareto_monoped.geometry.screws import LENGTHS_MM, M3, M4, M5, M25, screw_for, screw_length_mm, screw_part
from pareto_monoped.materials import Material
from tests.leg.polygons import polygon

STEEL = Material(name="steel", density_kg_per_m3=7850.0, colour=(0.5, 0.5, 0.5))


def made(screw=M3, **changes):
    asked = {"head": "cap", "seat_mm": 0.0, "grip_mm": 2.0, "room_mm": 4.5, "direction": 1.0, "material": STEEL}
    return screw_part("a_screw", screw, **(asked | changes))


@pytest.mark.parametrize(
    ("grip", "room", "length"),
    # The last ones are the shortest and the longest of the catalogue.
    [
        *((2.0, 4.5, 6.0), (2.0, 4.0, 6.0), (2.0, 3.9, 5.0), (11.5, 4.5, 16.0), (6.0, 4.5, 10.0)),
        *((2.0, 1.0, 3.0), (50.0, 10.0, 60.0)),
    ],
)
def test_length_is_the_longest_of_the_catalogue_with_room_for_its_thread(grip, room, length):
    assert screw_length_mm(grip, room) == length
    assert screw_length_mm(np.array([grip, 3.0]), np.array([room, 3.0])).tolist() == [length, 6.0]


def test_what_the_catalogue_does_not_have_is_refused():
    with pytest.raises(DesignError, match=r"room for 2\.9 mm"):
        screw_length_mm(np.array([2.0, 2.0]), np.array([4.0, 0.9]))
    for grip, room in ((62.0, 5.0), (6.0, 0.5)):
        with pytest.raises(DesignError, match="a_screw: grip of 6"):
            made(grip_mm=grip, room_mm=room)


def test_lengths_are_those_of_iso_4762():
    assert {5, 6, 8, 10, 12, 16, 20, 25, 30} <= set(LENGTHS_MM)
    assert not {7, 14, 18, 22} & set(LENGTHS_MM)


@pytest.mark.parametrize(
    ("screw", "length", "head", "socket", "pitch_diameter"),
    # ISO 4762: head dk x k, hexagon socket s x t; ISO 724: pitch diameter of the thread.
    [
        (M3, 10.0, (5.5, 3.0), (2.5, 1.3), 2.675),
        (M4, 16.0, (7.0, 4.0), (3.0, 2.0), 3.545),
        (M5, 12.0, (8.5, 5.0), (4.0, 2.5), 4.480),
    ],
)
def test_cap_screws_weigh_what_the_standard_s_dimensions_give(screw, length, head, socket, pitch_diameter):
    """Drawn without the socket, with a plain shank in the grip and the core in the thread: a little heavier."""
    part = made(screw, grip_mm=length - 4.0, room_mm=4.0)
    volume = np.pi / 4.0 * (head[0] ** 2 * head[1] + pitch_diameter**2 * length)
    volume -= np.sqrt(3.0) / 2.0 * socket[0] ** 2 * socket[1]
    assert 1.0 <= part.mass_kg() / (volume * 7850e-9) < 1.15


def test_heads_and_shanks_stand_on_their_seats():
    for direction in (1.0, -1.0):
        head, shank, thread = made(direction=direction, seat_mm=7.0).prisms
        ends = sorted([(p.z0_mm, p.z1_mm) for p in (head, shank, thread)], reverse=direction < 0.0)
        assert ends[0] == tuple(sorted((7.0 - 3.0 * direction, 7.0)))
        assert ends[1] == tuple(sorted((7.0, 7.0 + 2.0 * direction)))
        assert ends[2] == tuple(sorted((7.0 + 2.0 * direction, 7.0 + 6.0 * direction)))
        assert (head.outline.radius_mm, shank.outline.radius_mm, thread.outline.radius_mm) == (2.75, 1.5, 1.25)


def test_countersunk_screws_are_flush_and_say_so():
    part = made(head="countersunk", seat_mm=3.0)
    assert len(part.prisms) == 2
    assert min(p.z0_mm for p in part.prisms) == 3.0
    assert part.features == (CountersunkHead(shank_mm=1.5, radius_mm=3.36, face_mm=3.0, inwards=1.0),)
    assert made().features == ()


def test_a_plate_thinner_than_a_countersunk_head_is_refused():
    with pytest.raises(DesignError, match=r"a_screw: grip of 1\.5 mm must be 1\.86 mm or more"):
        made(head="countersunk", grip_mm=1.5)
    just = made(head="countersunk", grip_mm=M3.countersunk - M3.shank)
    assert just.prisms[0].z1_mm == pytest.approx(1.86)


def test_orders_name_size_standard_and_grade():
    assert made(note="into x").described == "cap screw ISO 4762 - M3 x 6 - 8.8; into x"
    assert made(head="countersunk").described == "countersunk screw ISO 14581 - M3 x 6 - 8.8"
    assert (
        made(head="countersunk", room_mm=6.0, grade="10.9").described == "countersunk screw ISO 10642 - M3 x 8 - 10.9"
    )
    assert made(M25, head="countersunk", room_mm=6.0).described == "countersunk screw ISO 14581 - M2.5 x 8 - 8.8"
    (order,) = made(head="hexagon").purchases
    assert order.designation == "hexagon screw ISO 4017 - M3 x 6 - 8.8"
    assert (order.standard, order.alternatives) == ("ISO 4017", ("DIN 933 - M3 x 6 - 8.8",))


def test_a_hexagon_head_is_one_over_flats_and_corners():
    """ISO 4017, M3: 5.5 mm across flats, two of which lie across the x axis, along which circles of screws stand."""
    head = made(head="hexagon").prisms[0]
    corners = polygon(head.outline)
    x_low, y_low, x_high, y_high = corners.bounds
    assert x_high - x_low == pytest.approx(5.5)
    assert y_high - y_low == pytest.approx(5.5 * 2.0 / np.sqrt(3.0))
    assert len(corners.exterior.coords) == 7
    assert corners.area == pytest.approx(head.outline.moments().area)
    assert head.z1_mm - head.z0_mm == 2.0


@pytest.mark.parametrize(("screw", "flats", "bearing"), [(M3, 5.5, 4.57), (M4, 7.0, 5.88), (M5, 8.0, 6.88)])
def test_a_hexagon_bears_on_the_ring_of_its_standard(screw, flats, bearing):
    """Width across flats, and least diameter dw of the bearing face within 5 percent (ISO 4017, product grade A)."""
    assert screw.fastening("hexagon", "8.8").head_mm == flats
    assert screw.fastening("hexagon", "8.8").bearing_mm == pytest.approx(bearing, rel=0.05)
    assert screw.fastening("hexagon", "8.8").bearing_mm < screw.fastening("cap", "8.8").bearing_mm


def test_an_odd_size_is_no_smaller_than_the_standard_s_proportions():
    for screw in (M25, M3, M4, M5):
        assert screw_for(2.0 * screw.shank, screw.core) == screw
    odd = screw_for(4.5, 1.9)
    assert odd.core == 1.9
    assert odd.hole > odd.shank
    assert M4.head < odd.head < M5.head

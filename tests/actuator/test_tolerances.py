"""Dimension chains against gearboxes that are put together from parts off their dimensions (``assembling``)."""

from dataclasses import replace
from functools import lru_cache
from itertools import product

import numpy as np
import pytest

from pareto_monoped.actuator.actuator import build_actuator
from pareto_monoped.actuator.bearings import axial_play_mm, clearance_mm, rated_bearing, width_less_mm
from pareto_monoped.actuator.motors import load_motor, motor_names
from pareto_monoped.actuator.search import map_of
from pareto_monoped.actuator.settings import ActuatorSettings
from pareto_monoped.actuator.tolerances import gearbox_chains
from tests.actuator import assembling

SAMPLES = 3000
FAR = 12.0
NO_TOLERANCE = ("axial play", "radial clearance")  # of bearings as they are bought: half of it is play on purpose


@lru_cache(maxsize=4)
def winners(name, rules="iso6336", every=1):
    motor = load_motor(name)
    settings = ActuatorSettings(rules=rules)
    won = [(family, one.best) for entry in map_of(motor, rules).entries for family, one in entry.families.items()]
    return [
        build_actuator(motor, family, best.gears, settings, best.face_width_mm)
        for family, best in [one for one in won if one[1] is not None][::every]
    ]


def some_winners(name, rules, count):
    """As many, from the first interval on, or a few more."""
    won = [one.best for entry in map_of(load_motor(name), rules).entries for one in entry.families.values() if one.best]
    return winners(name, rules, max(1, len(won) // count))


def key(link):
    """What deviates: the same in every chain that it is part of."""
    return link.part, link.name, link.which


def assembled_share(chains, off):
    """The share of n gearboxes in which no chain is below its least gap; ``off`` has all deviations by key, (n,)."""
    return float(np.all([gap_mm(chain, off) >= chain.least_mm for chain in chains], axis=0).mean())


def widened(chains, factor):
    """All limits farther apart about their middle."""

    def wide(one):
        if one.name in NO_TOLERANCE:
            return one
        middle, half = 0.5 * (one.lower_mm + one.upper_mm), 0.5 * (one.upper_mm - one.lower_mm)
        return replace(one, lower_mm=middle - factor * half, upper_mm=middle + factor * half)

    return tuple(replace(chain, links=tuple(wide(one) for one in chain.links)) for chain in chains)


def fit(actuator, off):
    """Whether each of n gearboxes goes together and turns, by putting it together."""
    fits = assembling.put_together(actuator, off) & assembling.pins_fit(actuator, off)
    fits &= assembling.meshes(actuator, off) & assembling.bearings_run(off)
    fits &= assembling.rings_in_grooves(actuator, off) & assembling.tips_run(actuator, off)
    return fits & (off["sun", "neck, set when bonded", 0] + 0.2 >= assembling.TURNING_MM)


def shares(actuator, chains, seed):
    """The share that assembles, by the chains and by putting the same gearboxes together."""
    limits = {key(one): (one.lower_mm, one.upper_mm) for chain in chains for one in chain.links}
    keys = sorted(limits)
    places = np.random.default_rng(seed).random((SAMPLES, len(keys)))
    off = {key: limits[key][0] + (limits[key][1] - limits[key][0]) * places[:, k] for k, key in enumerate(keys)}
    return assembled_share(chains, off), float(fit(actuator, off).mean())


def gap_mm(chain, off):
    return sum(one.sign * (one.nominal_mm + off[key(one)]) for one in chain.links)


def at_the_limit(chains, chain, over_mm):
    """Deviations with which one chain is ``over_mm`` above its least gap; all others lie in the middle of their limits.

    Each length goes the same share of its way from the middle to its worse end, past it if need be. None where that
    takes lengths far off, or leaves another chain below its own least gap.
    """
    middle = {key(one): 0.5 * (one.lower_mm + one.upper_mm) for each in chains for one in each.links}
    half = {key(one): 0.5 * (one.upper_mm - one.lower_mm) for one in chain.links if one.name not in NO_TOLERANCE}
    worse = {key(one): -np.sign(one.sign) * half[key(one)] for one in chain.links if key(one) in half}
    lost = gap_mm(chain, middle) - gap_mm(chain, {key: middle[key] + worse.get(key, 0.0) for key in middle})
    share = (gap_mm(chain, middle) - chain.least_mm - over_mm) / lost
    off = {key: middle[key] + share * worse.get(key, 0.0) for key in middle}
    others = (each for each in chains if each is not chain)
    return None if share > FAR or any(gap_mm(each, off) < each.least_mm for each in others) else off


@pytest.mark.parametrize(
    ("name", "rules"),
    [
        ("VT8020", "iso6336"),
        ("MAD_M6C12", "iso6336"),
        ("VT8020", "paper"),
        *(
            pytest.param(name, rules, marks=pytest.mark.long)
            for name, rules in [("U12", "paper"), *product(motor_names(), ["iso6336"])]
            if name not in ("VT8020", "MAD_M6C12")
        ),
    ],
)
def test_no_winner_jams_at_the_worst_of_its_limits(name, rules):
    assert [chain.text for one in winners(name, rules) for chain in gearbox_chains(one) if chain.jams] == []


@pytest.mark.parametrize(
    ("name", "rules", "count"),
    [
        ("VT8020", "iso6336", 3),
        pytest.param("MN8014", "iso6336", 2, marks=pytest.mark.long),
        ("U10", "paper", 2),
        *(pytest.param(name, "iso6336", 34, marks=pytest.mark.long) for name in motor_names()),
    ],
)
def test_the_share_that_assembles_is_that_of_gearboxes_put_together(name, rules, count):
    some_jam = 0
    for k, actuator in enumerate(some_winners(name, rules, count)):
        chains = gearbox_chains(actuator)
        assert shares(actuator, chains, k) == (1.0, 1.0)
        for factor in (1.6, 2.4):
            predicted, put_together = shares(actuator, widened(chains, factor), 100 + k)
            assert predicted == pytest.approx(put_together, abs=0.02)
            some_jam += 0.5 <= put_together <= 0.95
    assert some_jam >= count - 1


@pytest.mark.parametrize(
    ("rules", "every"),
    [("iso6336", 18), *(pytest.param(rules, 6, marks=pytest.mark.long) for rules in ("paper", "iso6336"))],
)
def test_every_chain_ends_where_parts_meet(rules, every):
    """A little above its least gap a gearbox turns, a little below it jams: no length is missing or counted twice.

    Backlash is not quite linear in the distance of the axes. Widths of tips are so little linear that they are looked
    at within their limits only (``test_tip_limits``).
    """
    seen, tried = set(), set()
    for actuator in (one for name in ("VT8020", "U12") for one in winners(name, rules, every)):
        chains = gearbox_chains(actuator)
        ending = [chain for chain in chains if not chain.name.startswith("width of the")]
        tried |= {(actuator.family, chain.name) for chain in ending}
        for chain in ending:
            little_mm = {"backlash": 0.003, "running": 0.0005}.get(chain.name.split()[0], 0.01)
            above, below = (at_the_limit(chains, chain, over_mm) for over_mm in (little_mm, -little_mm))
            if above is not None and below is not None:
                turns = fit(actuator, {key: np.array([above[key], below[key]]) for key in above})
                assert turns.tolist() == [True, False], chain.text
                seen.add((actuator.family, chain.name))
    # Of these, other parts meet first; under iso6336, flanks meet before tips do.
    missing = {one for one in tried - seen if rules == "paper" or not one[1].startswith("clearance of the")}
    assert missing <= {("ISSPG", "second carrier to coupling and dowels")}


def test_every_length_with_limits_ends_at_faces_and_is_part_of_a_chain():
    used, limited = set(), set()
    for actuator in (*winners("VT8020", every=9), *winners("U10", "paper", every=9)):
        used |= {(one.part, one.name) for chain in gearbox_chains(actuator) for one in chain.links}
        for part in actuator.parts:
            ends = {round(float(z), 6) for prism in part.prisms for z in (prism.z0_mm, prism.z1_mm)}
            limited |= {(part.name, one.name) for one in part.lengths}
            assert len({one.name for one in part.lengths}) == len(part.lengths)
            for one in part.lengths:
                assert {round(float(one.z0_mm), 6), round(float(one.z1_mm), 6)} <= ends, (part.name, one.name)
                assert float(one.lower_mm) < float(one.upper_mm)
    # The sun's end is set when it is bonded.
    assert limited - used == {("end_bearing", "width")}


def test_bearings_are_as_the_standards_and_a_maker_have_them():
    """ISO 492, normal class; ISO 5753-1, C3. NSK, Rolling Bearings: 6808 C3 moves by about 0.14 mm along its axis."""
    assert width_less_mm(np.array([6.0, 40.0, 50.0, 55.0, 100.0, 150.0])) == pytest.approx(
        [0.12, 0.12, 0.12, 0.15, 0.2, 0.25]
    )
    assert clearance_mm(6.0) == pytest.approx((0.008, 0.023))
    assert clearance_mm(40.0) == pytest.approx((0.015, 0.033))
    assert clearance_mm(65.0) == pytest.approx((0.023, 0.043))
    # Three points of a ball between two grooves, laid out: A - Gr/2 off along the radius, A apart.
    bearing = rated_bearing(40.0)
    apart = 2.0 * 0.52 * bearing.ball_diameter_mm - bearing.ball_diameter_mm
    across = apart - 0.5 * 0.033
    assert axial_play_mm(bearing) == pytest.approx(2.0 * np.sqrt(apart**2 - across**2), rel=1e-9)

"""Clearance and width of tips at the limits of the drawings, on teeth cut as in a workshop, without the chains."""

from dataclasses import replace
from functools import lru_cache

import numpy as np
import pytest
import shapely
from shapely import affinity

from pareto_monoped.actuator.gearset import GearSet
from pareto_monoped.actuator.tolerances import gearbox_chains
from tests.actuator.test_tolerances import key, winners
from tests.geometry.cutting import cut_gear, cut_ring

CLEARANCES = {
    "clearance of the sun's tips in the planets' roots": ("sun", "planet"),
    "clearance of the planets' tips in the sun's roots": ("planet", "sun"),
    "clearance of the planets' tips in the ring's roots": ("planet", "ring"),
    "clearance of the ring's tips in the planets' roots": ("ring", "planet"),
}
WIDTHS = {f"width of the {whose} tips": part for whose, part in (("sun's", "sun"), ("planets'", "planet"))}
WIDTHS["width of the ring's tips"] = "ring"


def chains_of(actuator):
    return {chain.name: chain for chain in gearbox_chains(actuator) if chain.name in {*CLEARANCES, *WIDTHS}}


def deviations(chain, end):
    """How far every length is off where the gap is the least (-1) or the greatest (1), or as drawn (0)."""
    return {
        key(one)[:2]: 0.0 if not end else one.upper_mm if one.sign * end > 0.0 else one.lower_mm for one in chain.links
    }


@lru_cache(maxsize=64)
def cut(part, gears, thinner_mm, tip_off_mm):
    """Metal around a space of a gear, around the y axis."""
    shape = getattr(gears, part)()
    make = cut_ring if part == "ring" else cut_gear
    thinning, tip = float(shape.backlash_mm) + thinner_mm, float(shape.tip_radius_mm) + tip_off_mm
    return make(int(shape.teeth), float(shape.module_mm), float(shape.shift), thinning, tip)


def placed(part, gears, off, *, tooth, up, at_mm):
    """The metal with its space, or a tooth, on the line of centres, which is the y axis."""
    tip_off = 0.5 * off.get((part, "tip diameter"), 0.0)
    metal = cut(part, gears, off.get((part, "thinning of teeth"), 0.0), tip_off)
    if tooth:  # beside its middle, where the metal ends, and more so in a ring's sector
        share = 0.85 if part == "ring" else 0.98
        metal = affinity.rotate(metal, share * np.pi / int(getattr(gears, part)().teeth), (0, 0), use_radians=True)
    return affinity.translate(metal if up else affinity.scale(metal, 1.0, -1.0, origin=(0, 0)), 0.0, at_mm)


def clearance(gears, tip, root, off):
    """Air on the line of centres: the sun below, the planet above it, the ring's far side above both."""
    lower, upper = ("planet", "ring") if "ring" in (tip, root) else ("sun", "planet")
    pin = float(gears.carrier_radius_mm) + off["carrier", "place of the pin"] + off["planet", "play on its pin"]
    axis = {
        "sun": -off.get(("carrier", "place of the end bearing"), 0.0),
        "planet": pin,
        "ring": off.get(("ring", "place, set when bonded"), 0.0),
    }
    metals = []
    for part in (lower, upper):
        runs_out = off[part, "eccentricity of tips" if part == tip else "eccentricity"]
        at_mm = axis[part] + (-runs_out if part == "sun" else runs_out)
        up = part == lower or part == "ring"
        metals.append(placed(part, gears, off, tooth=part == tip, up=up, at_mm=at_mm))
    ray = shapely.LineString([(0.0, -500.0), (0.0, 500.0)])
    below, above = (metal.intersection(ray).bounds for metal in metals)
    return above[1] - below[3]


def width(gears, part, off):
    """Metal on the tip circle, where that stands farthest out of the teeth or least."""
    out = -1.0 if part == "ring" else 1.0
    stands_out = out * (off[part, "eccentricity"] - off[part, "eccentricity of tips"])
    tip_off = 0.5 * off[part, "tip diameter"] + stands_out
    metal = cut(part, gears, off[part, "thinning of teeth"], tip_off)
    shape = getattr(gears, part)()
    radius = float(shape.tip_radius_mm) + tip_off - 1e-5 * out
    beside = np.linspace(0.0, (0.9 if part == "ring" else 0.999) * np.pi / int(shape.teeth), 20001)
    solid = shapely.contains_xy(metal, radius * np.sin(beside), radius * np.cos(beside))
    assert not solid[0]
    assert solid[-1]
    return 2.0 * radius * (np.pi / int(shape.teeth) - beside[np.argmax(solid)])


@pytest.mark.parametrize(
    ("motor", "rules", "every"),
    [
        ("VT8020", "iso6336", 30),
        pytest.param("U8", "paper", 40, marks=pytest.mark.long),
        pytest.param("U8", "iso6336", 8, marks=pytest.mark.long),
        pytest.param("U12", "paper", 8, marks=pytest.mark.long),
    ],
)
def test_tips_are_as_wide_and_as_far_from_roots_as_on_teeth_cut_at_the_limits(motor, rules, every):
    for actuator in winners(motor, rules, every // 2)[1::2]:
        chains = chains_of(actuator)
        assert len(chains) == 7
        for end in (-1, 0, 1):
            for name, chain in chains.items():
                off, gap = deviations(chain, end), (chain.nominal_mm if not end else chain.worst_mm[end > 0])
                if name in WIDTHS:
                    found = width(actuator.gears, WIDTHS[name], off)
                else:
                    found = clearance(actuator.gears, *CLEARANCES[name], off)
                # The greatest width is far along the secant of the chain.
                within_mm = 3e-3 if end > 0 else 1e-3
                assert found == pytest.approx(gap, abs=within_mm), (actuator.gears, name, end)


@pytest.mark.parametrize(
    ("part", "change", "jams"),
    [
        ("sun", {"tip_shortening": -0.16}, {"clearance of the sun's tips in the planets' roots"}),
        ("planet", {"tip_shortening": -0.16}, {name for name in CLEARANCES if "the planets' tips" in name}),
        ("ring", {"tip_shortening": -0.16}, {"clearance of the ring's tips in the planets' roots"}),
        ("sun", {"backlash_mm": 0.2}, {"width of the sun's tips"}),
        ("planet", {"backlash_mm": 0.3}, {"width of the planets' tips"}),
        ("ring", {"backlash_mm": 0.4}, {"width of the ring's tips"}),
    ],
)
def test_a_gear_that_breaks_a_chain_is_told(monkeypatch, part, change, jams):
    """Longer tips than the set's, and thinner teeth."""
    actuator, made = winners("VT8020", "paper")[0], getattr(GearSet, part)

    def other(gears):
        gear = made(gears)
        return replace(gear, **{name: getattr(gear, name) + more for name, more in change.items()})

    assert not any(chain.jams for chain in gearbox_chains(actuator))
    monkeypatch.setattr(GearSet, part, other)
    found = {chain.name: chain for chain in gearbox_chains(actuator) if chain.jams}
    assert set(found) == jams
    assert all(chain.text.startswith(f"{name} = ") for name, chain in found.items())

"""The sprocket against ISO 606 and against the rollers of its chain."""

import dataclasses

import numpy as np
import pytest
import shapely

from pareto_monoped.leg.dimensions import CHAIN_DRIVES
from pareto_monoped.leg.sprocket import sprocket_outline, sprocket_prisms, support_parts
from tests.leg.polygons import polygon

LIGHT, _, HEAVY = CHAIN_DRIVES


def test_sprocket_keeps_the_limits_of_iso_606():
    # 14 teeth: d = 57.07 mm, tip between d + p (1 - 1.6/z) - d1 = 60.57 and d + 1.25 p - d1 = 65.20.
    assert 2.0 * LIGHT.pitch_radius_mm == pytest.approx(57.07, abs=0.005)
    points = np.array(polygon(sprocket_outline(LIGHT)).exterior.coords)
    radius = np.hypot(points[:, 0], points[:, 1])
    assert 60.57 <= 2.0 * radius.max() <= 65.20
    # Root diameter d - 2 ri with ri = 0.505 d1.
    assert 2.0 * radius.min() == pytest.approx(57.07 - 2.0 * 0.505 * 7.75, abs=0.01)


def test_rollers_lie_in_the_sprockets_gaps_without_cutting_into_it():
    drawn = polygon(sprocket_outline(LIGHT))
    radius = LIGHT.pitch_radius_mm
    for tooth in range(14):
        angle = 2.0 * np.pi * tooth / 14
        roller = shapely.Point(radius * np.cos(angle), radius * np.sin(angle)).buffer(3.875, quad_segs=64)
        assert drawn.intersection(roller).area < 1e-3


def test_heads_are_sunk_in_a_wide_sprocket_only(leg):
    light, heavy = (sprocket_prisms(dataclasses.replace(leg, chain=drive), 2.85) for drive in (LIGHT, HEAVY))
    (whole,) = light
    assert (whole.z0_mm, whole.z1_mm) == (-1.5, 1.5)
    counterbored, rest = heavy
    assert (counterbored.z0_mm, rest.z1_mm) == (-2.2, 2.2)
    assert counterbored.z1_mm == rest.z0_mm == pytest.approx(-2.2 + 0.4)
    # A cap head of M3 is 5.5 mm wide (ISO 4762).
    assert 2.0 * counterbored.holes[1].radius_mm > 5.5 > 2.0 * rest.holes[1].radius_mm > 3.0


def test_the_shaft_says_how_the_dowels_of_its_soft_flange_fit(leg):
    shaft, _ = support_parts(leg, 15.0, (leg.drive_dowel,))
    assert "the flange, whose holes are reamed, stays soft" in shaft.note
    (hole,) = (fit for fit in shaft.toleranced if fit.together)
    assert (hole.zone, hole.diameter_mm) == ("H7", 2.0 * leg.drive_dowel.radius_mm)

"""Webs and their screws: von Mises by search, a clamped beam by its deflection, sections of the drawn carrier."""

import numpy as np
import pytest
import shapely

from pareto_monoped.actuator.search import map_for
from tests.leg.polygons import polygon
from tests.strength.drawn import BOTH, ROWS, second_moment_mm4
from tests.strength.support import structure

HARD = 460.0  # MPa: EN AW-7075 T6


@pytest.mark.parametrize("family", BOTH)
def test_web_screws_carry_half_of_the_torque_by_what_their_preload_leaves(family):
    s = BOTH[family]
    (screw,) = (part for part in s.actuator.parts if part.name == "web_screw")
    fastening = screw.fastening
    tension = fastening.preload_n / fastening.thread.stress_area_mm2
    shears = np.linspace(0.0, 640.0, 640001)
    stress = shears[np.sqrt(tension**2 + 3.0 * shears**2) <= 640.0].max()
    core = 0.25 * np.pi * (3.0 - 1.226869 * 0.5) ** 2
    each = stress * core
    assert 0.5 * ROWS["hip_web_screws"].capacity(s) == pytest.approx(
        1e-3 * screw.count * each * screw.pitch_radius_mm, rel=1e-4
    )
    assert screw.count == s.actuator.gears.planets


@pytest.mark.parametrize("family", BOTH)
def test_webs_bend_as_beams_between_two_carriers(family):
    """Section from the drawn carrier; a beam clamped at both ends, solved by its deflection, has F L / 2 at either."""
    s = BOTH[family]
    (carrier,) = (part for part in s.actuator.parts if part.name == "carrier")
    layers = [p for p in carrier.prisms if hasattr(p.outline, "path")]
    assert layers
    path = polygon(layers[0].outline.path)
    (screw,) = (part for part in s.actuator.parts if part.name == "web_screw")
    hole = shapely.Point(screw.pitch_radius_mm, 0.0).buffer(1.25, 128)
    modulus = second_moment_mm4(path.difference(hole)) / path.bounds[3]
    length = max(p.z1_mm for p in layers) - min(p.z0_mm for p in layers)
    # u'''' = 0 with u(0) = u'(0) = u'(L) = 0 and a unit force at L: u = a z^2 + b z^3.
    a, b = np.linalg.solve([[2.0 * length, 3.0 * length**2], [0.0, -6.0]], [0.0, 1.0])
    moment = abs(2.0 * a)
    assert moment == pytest.approx(abs(2.0 * a + 6.0 * b * length)) == pytest.approx(0.5 * length)
    torque = 2.0e-3 * screw.count * screw.pitch_radius_mm * HARD * modulus / moment
    assert ROWS["hip_webs"].capacity(s) == pytest.approx(torque, rel=5e-3)


def test_rules_without_webs_have_no_web_rows_to_fail():
    s = structure(map_for("VT8020", rules="paper"), 6.0)
    assert [ROWS[name].capacity(s) for name in ("knee_web_screws", "knee_webs")] == [np.inf, np.inf]

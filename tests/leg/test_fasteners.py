"""Bolts of the links: what their nuts, their seats and the printed core bear when they are tightened."""

from itertools import combinations

import numpy as np
import pytest
from shapely import affinity

from pareto_monoped.actuator.search import map_for
from pareto_monoped.geometry.roles import Role
from pareto_monoped.leg.dimensions import leg_dimensions
from pareto_monoped.leg.shank import shank_parts
from pareto_monoped.leg.thigh import thigh_parts
from pareto_monoped.materials import ALLOYS
from tests.leg.polygons import polygon

D = leg_dimensions(map_for("VT8020"))
BOLTS = {part.name: part for part in (*thigh_parts(0.4, D), *shank_parts(0.4, D)) if part.role is Role.BOLT}
CORED = {"thigh_bolt": 2.5, "shank_bolt": 3.0}  # on a printed core, with the thickness of the plates


def test_all_bolts_are_looked_at():
    assert set(BOLTS) == {*CORED, "foot_bolt", "knee_striker_bolt", "knee_bolt"}


@pytest.mark.parametrize("name", sorted(set(BOLTS) - {"knee_bolt"}))
def test_a_sleeve_bolt_is_tightened_to_what_sleeve_and_core_bear(name):
    """Sleeve: walls of 0.5 mm at 0.7 of 240 MPa. Core: 15 MPa around its hole, as wide as a plate spreads a head."""
    bolt = BOLTS[name]
    outer, inner = (2.0 * float(prism.outline.radius_mm) for prism in bolt.prisms)
    assert outer - inner == 1.0
    sleeve = 0.25 * np.pi * (outer**2 - inner**2) * 0.7 * 240.0
    hole = outer + 0.2
    bevel = bolt.bevels[0]
    spread = 0.5 * (2.0 * float(bevel.edge_mm) + hole) + 2.0 * 0.6 * CORED.get(name, np.inf)
    core = 0.25 * np.pi * (spread**2 - hole**2) * 15.0
    assert bolt.fastening.preload_n == pytest.approx(min(sleeve, core))
    assert (core < sleeve) == (name in CORED)
    assert ("sleeve" in bolt.fastening.lock) == (name in CORED)
    # The screw alone would take more: it never yields.
    assert bolt.fastening.preload_n < 0.75 * 640.0 * bolt.fastening.thread.stress_area_mm2


def test_the_knee_s_nuts_and_heads_stand_on_the_plates_which_bear_them():
    bolt = BOLTS["knee_bolt"]
    head, shank, nut, end = bolt.prisms
    plates = sorted((p.z0_mm, p.z1_mm) for part in shank_parts(0.4, D) if part.role is Role.PLATE for p in part.prisms)
    assert (head.z1_mm, nut.z0_mm) == (plates[0][0], plates[1][1]) == (shank.z0_mm, shank.z1_mm)
    assert polygon(nut.outline).area == pytest.approx(7.0**2 * np.sqrt(3.0) / 2.0)  # ISO 4032: 7 mm across flats
    assert nut.z1_mm - nut.z0_mm == pytest.approx(3.2)
    assert end.z1_mm - nut.z1_mm >= 0.7
    # ISO 4032: the nut bears on a ring of 5.9 mm at least. 1.5 times the yield stress is what the metal around allows.
    ring = 0.25 * np.pi * (5.9**2 - 4.3**2)
    assert bolt.fastening.preload_n / ring < 1.5 * ALLOYS["aw_6082_t6"].yield_mpa
    # Drawn with sharp corners, 8.08 mm over them, nuts clear each other as they are turned.
    drawn = polygon(nut.outline)
    turned = [
        affinity.rotate(affinity.translate(drawn, float(bolt.pitch_radius_mm), 0.0), 90.0 * k, origin=(0.0, 0.0))
        for k in range(4)
    ]
    assert min(one.distance(other) for one, other in combinations(turned, 2)) > 0.2
    # Nuts of neighbouring bolts clear each other however they are turned.
    apart = 2.0 * float(bolt.pitch_radius_mm) * np.sin(np.pi / float(bolt.count))
    assert apart > 7.66  # over the corners, ISO 4032

"""Preload and torque of screws against the tables of VDI 2230, and against the stress that they are for."""

import re

import numpy as np
import pytest

from pareto_monoped.errors import DesignError
from pareto_monoped.geometry.screws import M3, M4, M5, Screw
from pareto_monoped.geometry.tightening import FRICTION, YIELD_MPA, thread_size

M6 = Screw(shank=3.0, hole=3.2, core=2.5, head=5.0, head_height=6.0, countersunk=6.7)
M8 = Screw(shank=4.0, hole=4.2, core=3.4, head=6.5, head_height=8.0, countersunk=9.0)

# VDI 2230-1:2003, table A1, cap screws, friction 0.12 in thread and under the head: preload in kN, torque in N m.
TABLE = {
    (4.0, "8.8"): (4.4, 3.0),
    (5.0, "8.8"): (7.2, 5.9),
    (6.0, "8.8"): (10.2, 10.1),
    (6.0, "10.9"): (14.9, 14.9),
    (6.0, "12.9"): (17.5, 17.4),
    (8.0, "8.8"): (18.6, 24.6),
    (8.0, "10.9"): (27.3, 36.1),
    (8.0, "12.9"): (32.0, 42.2),
}
SCREWS = {3.0: M3, 4.0: M4, 5.0: M5, 6.0: M6, 8.0: M8}
STRESS_AREAS_MM2 = {2.0: 2.07, 2.5: 3.39, 3.0: 5.03, 4.0: 8.78, 5.0: 14.2, 6.0: 20.1, 8.0: 36.6}  # ISO 898-1, table 4


@pytest.mark.parametrize(("size", "printed"), TABLE.items())
def test_preload_and_torque_are_those_of_the_guideline_s_table(size, printed):
    diameter, grade = size
    found = SCREWS[diameter].fastening("cap", grade)
    assert 1e-3 * found.preload_n == pytest.approx(printed[0], rel=0.01)
    assert found.torque_n_m == pytest.approx(printed[1], rel=0.03)


@pytest.mark.parametrize(("diameter", "area"), STRESS_AREAS_MM2.items())
def test_stress_areas_are_those_of_the_standard(diameter, area):
    assert thread_size(diameter).stress_area_mm2 == pytest.approx(area, rel=4e-3)


@pytest.mark.parametrize("grade", YIELD_MPA)
@pytest.mark.parametrize("screw", [M3, M4, M5])
def test_tightened_screws_reach_nine_tenths_of_their_proof_stress(screw, grade):
    """Tension, and torsion of the part of the torque that goes through the thread, on the stress circle (von Mises).

    Fully plastic torsion: tau = 12 M / (pi d^3). The thread's torque by statics of an inclined plane.
    """
    found = screw.fastening("cap", grade)
    thread, force = found.thread, found.preload_n
    slope = np.arctan(thread.pitch_mm / (np.pi * thread.flank_diameter_mm))
    rubbing = np.arctan(FRICTION / np.cos(np.pi / 6.0))
    moment = force * np.tan(slope + rubbing) * 0.5 * thread.flank_diameter_mm
    tau = 12.0 * moment / (np.pi * thread.stress_diameter_mm**3)
    sigma = force / thread.stress_area_mm2
    assert np.sqrt(sigma**2 + 3.0 * tau**2) == pytest.approx(0.9 * YIELD_MPA[grade], rel=0.01)


def test_countersunk_heads_are_tightened_less():
    cap, sunk = (M3.fastening(head, "10.9") for head in ("cap", "countersunk"))
    assert sunk.preload_n == pytest.approx(cap.preload_n * 0.75 / 0.9)
    # ISO 10642: 80 percent of the breaking load, of 1040 MPa (ISO 898-1).
    assert sunk.preload_n < 0.8 * 1040.0 * sunk.thread.stress_area_mm2


def test_a_screw_without_a_size_is_refused():
    message = "screw of 12 mm: must be M2 to M8; choose another diameter"
    with pytest.raises(DesignError, match="^" + re.escape(message)):
        thread_size(12.0)


@pytest.mark.parametrize("screw", [M3, M4, M5])
def test_a_countersunk_head_rubs_on_its_cone(screw):
    """An even pressure on a cone of 90 degrees, summed up over its rings: it carries the preload along the axis."""
    found = screw.fastening("countersunk", "10.9")
    thread = found.thread
    edges = np.linspace(0.5 * found.hole_mm, 0.5 * found.bearing_mm, 1001)
    radius = 0.5 * (edges[1:] + edges[:-1])
    slanted = np.hypot(np.diff(edges), np.diff(edges))  # as deep as it is wide
    area = 2.0 * np.pi * radius * slanted
    pressure = found.preload_n / np.sum(area * np.diff(edges) / slanted)
    head = 1e-3 * np.sum(FRICTION * pressure * area * radius)
    slope = np.arctan(thread.pitch_mm / (np.pi * thread.flank_diameter_mm))
    turned = np.tan(slope + np.arctan(FRICTION / np.cos(np.pi / 6.0))) * 0.5e-3 * thread.flank_diameter_mm
    assert found.torque_n_m == pytest.approx(found.preload_n * turned + head, rel=0.03)

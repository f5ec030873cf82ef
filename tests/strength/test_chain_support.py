"""The knee's drive between its supports: statics of the drawn parts, sections by slices."""

import numpy as np
import pytest
import shapely

from pareto_monoped.materials import ALLOYS
from pareto_monoped.strength.connections import least_preload_n
from tests.strength.drawn import BOTH, DRIVE, ROWS, D, S, region, second_moment_mm4

YIELD = 250.0  # MPa: EN AW-6082 T6


def main_bearing_z_mm(s):
    """Middle of the knee's main bearing in the leg's frame: its actuator is turned over."""
    (bearing,) = (part for part in s.actuator.parts if part.name == "main_bearing")
    (ring,) = bearing.prisms
    return D.knee_mount_mm - 0.5 * (ring.z0_mm + ring.z1_mm)


def moment_mm(s, z):
    """Bending at z under 1 N at 0, from the equilibrium of forces and moments of what lies in front of z."""
    needles = DRIVE["drive_bearing"].prisms[0]
    front = 0.5 * (needles.z0_mm + needles.z1_mm)
    (one, other) = np.linalg.solve([[1.0, 1.0], [front, main_bearing_z_mm(s)]], [1.0, 0.0])
    assert one + other == pytest.approx(1.0)
    return abs(one * (z - front) - max(z, 0.0))


@pytest.mark.parametrize("family", BOTH)
def test_the_drive_s_shaft_bends_between_its_needles_and_the_sprocket(family):
    """Weakest in the relief of 11.8 mm beside the sprocket, of all its layers outside it."""
    s, face = BOTH[family], -0.5 * D.chain.sprocket_width_mm
    yielding = ALLOYS["case_18crnimo7_6"].yield_mpa
    stub = [prism for prism in DRIVE["drive_shaft"].prisms if prism.z1_mm <= face]
    assert sorted((prism.z1_mm, 2.0 * prism.outline.radius_mm) for prism in stub) == [(face - 1.0, 12.0), (face, 11.8)]
    pulls = [
        yielding * second_moment_mm4(region(prism)) / prism.outline.radius_mm / moment_mm(s, prism.z1_mm)
        for prism in stub
    ]
    assert ROWS["knee_drive_shaft"].capacity(s) == pytest.approx(min(pulls), rel=2e-3)


@pytest.mark.parametrize("family", BOTH)
def test_the_drive_s_coupling_is_bent_and_twisted_in_the_ring_that_no_hole_cuts(family):
    s = BOTH[family]
    (prism,) = DRIVE["drive_coupling"].prisms
    whole = region(prism)
    inner = 6.75
    cut = [r for r in np.arange(7.0, 15.0, 0.005) if not whole.contains(shapely.Point(0, 0).buffer(r).exterior)]
    outer = min(cut)
    ring = shapely.Point(0, 0).buffer(outer, 256).difference(shapely.Point(0, 0).buffer(inner, 256))
    modulus = second_moment_mm4(ring) / outer
    row = ROWS["knee_drive_coupling"]
    pull, torque = 2500.0, 70.0
    bent, sheared = pull * moment_mm(s, prism.z0_mm) / modulus, 1e3 * torque / (2.0 * modulus)
    stress = np.sqrt(bent**2 + 3.0 * sheared**2)
    assert row.factor(*row.capacity(s), pull, torque) == pytest.approx(YIELD / stress, rel=5e-3)
    assert row.loads == ("peak_chain_tension_n", "peak_gear_torque_knee_n_m")


def test_the_drive_s_joint_gapes_when_no_pressure_is_left_at_its_edge():
    """Pressure of six M3 of class 10.9, tightened least, less that of the moment, is zero at the rim."""
    pull = ROWS["knee_drive_opening"].capacity(S)
    (prism,) = DRIVE["drive_coupling"].prisms
    screw = DRIVE["drive_screw"]
    grip = screw.prisms[1].z1_mm - screw.prisms[1].z0_mm
    left = least_preload_n(screw.fastening, grip, steel_mpa=206000.0, clamped_mpa=70000.0)
    face = shapely.Point(0, 0).buffer(15.0, 256).difference(shapely.Point(0, 0).buffer(6.75, 256))
    rim = 15.0 * pull * moment_mm(S, prism.z0_mm) / second_moment_mm4(face)
    assert 6.0 * left / face.area == pytest.approx(rim, rel=2e-3)
    assert screw.count == 6.0

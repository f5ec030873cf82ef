"""Root stress by ISO 6336-3 against finite elements, on teeth cut as in a workshop.

The table gives the finite elements' greatest stress in the tensile root over the package's F_t / (b m) Y_F Y_S. Both
are loaded at the outer point of single pair contact. The rims are 4 modules thick, so that Y_B is 1, and all teeth are
thinned by 0.03 modules.

    tooth                         FE / ISO   without axial force   at ISO's tangent   place of the greatest stress
    sun      18, shift  0.0        0.982           1.08             0.98 at 30 deg          34 deg
    planet   32, shift -0.4        1.000           1.08             1.00 at 30 deg          33 deg
    sun      20, shift +0.4        0.914           1.05             0.89 at 30 deg          38 deg
    sun      14, shift +0.5        0.884           1.04             0.87 at 30 deg          36 deg
    ring     82, shift  0.0        0.911           1.02             0.85 at 60 deg          45 deg
    ring     82, shift +0.4        0.895           1.00             0.84 at 60 deg          46 deg

"Place" is the angle between the root's tangent and the middle of the tooth.

The standard's stress is within 2 percent for the first two teeth. It is on the safe side by 9 to 12 percent for teeth
of positive shift and in rings. The cause is the component of the force along the tooth, which compresses the tensile
root and which the standard's nominal stress leaves out. That component over the critical section, divided by the
nominal bending stress, is 0.10 and 0.08 for the first two teeth, but 0.15 to 0.16 for the other four: their loads lean
more, by up to 26 degrees, or their teeth are shorter against their thickness. By finite elements it lowers the greatest
stress by 9 and 8 percent of the first two, by 13 and 15 percent of the shifted suns and by 11 percent of the rings. If
an equal force pulls at the middle of the tip, which leaves the bending as it is, finite elements give 1.00 to 1.08 of
the standard's stress. Y_S thus makes up for the compression of an unshifted external tooth, and for too little in
the others.

Three other causes were looked at. The tangent: at 30 degrees the stress in external teeth is at most 2 percent below
the greatest, but at 60 degrees in rings it is 6 percent below, so that there the standard is safe in spite of the place
that it takes. Plane strain: with a Poisson's ratio of 0 instead of 0.3 the stress is at most 0.8 percent higher. The
rim: 3.5 to 8 modules, and up to five more teeth on each side, change the stress by at most 0.6 percent.
"""

from dataclasses import dataclass
from functools import cache

import numpy as np
import pytest

from pareto_monoped.actuator.rating.geometry import tooth_form
from pareto_monoped.geometry.gears import ExternalGear, InternalGear, half_angle
from tests.actuator.rating.finite_elements import (
    POISSON,
    YOUNG_MPA,
    displaced_mm,
    edge_forces,
    edge_stress_mpa,
    mesh_of,
    root_stress,
)
from tests.geometry.cutting import ANGLE, cut_gear, cut_ring

THINNING = 0.03  # modules


def line(*points):
    return np.array(points, dtype=float)


# The solver


def test_a_plate_that_is_strained_evenly_strains_evenly_inside():
    """The patch test: displacements that are linear on the outline are linear in every inner node."""
    turned = np.linspace(0.0, 2.0 * np.pi, 60)
    blob = np.stack([(2.0 + 0.3 * np.cos(3 * turned)) * np.cos(turned), 1.5 * np.sin(turned)], axis=1)
    blob[-1] = blob[0]
    mesh = mesh_of([blob[:30], blob[29:]], lambda points: 0.1 + 0.1 * np.abs(points[:, 0]))
    wanted = mesh.nodes_mm @ line([1e-3, 4e-4], [-2e-4, 7e-4])
    held = np.unique(np.concatenate([edges.ravel() for edges in mesh.edges]))
    moved = displaced_mm(mesh, np.zeros((*wanted.shape, 1)), held, wanted[held])[:, :, 0]
    assert len(held) < 0.5 * len(wanted)
    assert moved == pytest.approx(wanted, abs=1e-9 * np.abs(wanted).max())


def kirsch_mm(points):
    """Displacements around a hole of radius 1 in a large plate that is pulled with 1 MPa along x, plane strain.

    Kirsch's solution, e.g. Timoshenko and Goodier, Theory of Elasticity, art. 35.
    """
    r, t, kappa = np.hypot(*points.T), np.arctan2(points[:, 1], points[:, 0]), 3.0 - 4.0 * POISSON
    across = np.stack([np.cos(t) * (kappa + 1.0), np.sin(t) * (kappa - 3.0)]) * r
    near = np.stack([(1.0 + kappa) * np.cos(t) + np.cos(3 * t), (1.0 - kappa) * np.sin(t) + np.sin(3 * t)]) * 2.0 / r
    far = np.stack([np.cos(3 * t), np.sin(3 * t)]) * 2.0 / r**3
    return ((1.0 + POISSON) / (4.0 * YOUNG_MPA) * (across + near - far)).T


def test_stress_around_a_hole_converges_to_kirschs():
    """At a hole's edge the stress is 1 - 2 cos(2 t) times that far away, 3 at most."""
    turned, errors = np.linspace(0.5 * np.pi, 0.0, 400), []
    hole = np.stack([np.cos(turned), np.sin(turned)], axis=1)
    rest = line([1, 0], [4, 0], [4, 4], [0, 4], [0, 1])
    for size in (0.2, 0.1, 0.05):
        pieces = [hole, *(rest[i : i + 2] for i in range(4))]
        mesh = mesh_of(pieces, lambda points, size=size: size * np.maximum(np.hypot(*points.T), 1.0))
        held = np.unique(np.concatenate([edges.ravel() for edges in mesh.edges[1:]]))
        moved = displaced_mm(mesh, np.zeros((*mesh.nodes_mm.shape, 1)), held, kirsch_mm(mesh.nodes_mm[held]))
        places, _, stress = edge_stress_mpa(mesh, moved, 0)
        exact = 1.0 - 2.0 * np.cos(2.0 * np.arctan2(places[:, 1], places[:, 0]))
        errors.append(np.abs(stress[:, 0] - exact).max())
    assert errors[1] < 0.5 * errors[0]
    assert errors[2] < 0.5 * errors[1]
    assert errors[2] < 0.005


def stepped_bar_mpa(wide, radius, per_radius):
    """Greatest stress at the shoulder of a bar that is clamped where it is wide and bent where it is 1 mm high."""
    long, step, turned = 1.5 * wide, 0.5 * wide, np.linspace(0.0, 0.5 * np.pi, 400)
    top = np.stack([radius - radius * np.sin(turned), 0.5 + radius - radius * np.cos(turned)], axis=1)
    half = [line([long, 0.5], [radius, 0.5]), top, line(top[-1], [0, step]), line([0, step], [-long, step])]
    mirrored = [piece[::-1] * [1.0, -1.0] for piece in half[::-1]]
    pieces = [line([long, -0.5], [long, 0.5]), *half, line([-long, step], [-long, -step]), *mirrored]

    def size_mm(points):
        off = np.hypot(points[:, 0] - radius, np.abs(points[:, 1]) - 0.5 - radius) - radius
        return np.minimum(radius / per_radius + 0.3 * np.maximum(off, 0.0), 0.125)

    mesh = mesh_of(pieces, size_mm)
    forces = edge_forces(mesh, 0, lambda points: np.stack([2.0 * points[:, 1], 0.0 * points[:, 1]], axis=1))
    return edge_stress_mpa(mesh, displaced_mm(mesh, forces, np.unique(mesh.edges[5])), 2)[2].max()


@pytest.mark.parametrize(
    ("wide", "radius"), [(2.0, 0.1), *(pytest.param(2.0, radius, marks=pytest.mark.long) for radius in (0.15, 0.2))]
)
def test_a_shoulders_notch_factor_is_petersons(wide, radius):
    """Pilkey, Peterson's Stress Concentration Factors, 2nd ed., chart 3.8: bending of a stepped flat bar, t / r > 2.

    Its curve for t / r < 2 was found to be up to 5 percent lower than finite elements, 8 percent near t / r = 1.7.
    """
    t, root = 0.5 * (wide - 1.0) / radius, np.sqrt(0.5 * (wide - 1.0) / radius)
    c = (
        1.058 + 1.002 * root - 0.038 * t,
        -3.652 + 1.639 * root - 0.436 * t,
        6.170 - 5.687 * root + 1.175 * t,
        -2.558 + 3.046 * root - 0.701 * t,
    )
    published = np.polyval(c[::-1], 2.0 * t * radius / wide)
    found = stepped_bar_mpa(wide, radius, 16)
    assert found == pytest.approx(published, rel=0.03)
    assert found == pytest.approx(stepped_bar_mpa(wide, radius, 32), rel=0.005)


# Teeth


@dataclass(frozen=True, kw_only=True)
class Tooth:
    """A tooth, and the gear that it meshes with; their shifts leave the centre distance as it is."""

    teeth: int
    mate: int
    module: float
    shift: float
    internal: bool = False

    @property
    def base_mm(self):
        return 0.5 * self.module * self.teeth * np.cos(ANGLE)

    @property
    def tip_mm(self):
        return self.module * (0.5 * self.teeth + self.shift + (-1.0 if self.internal else 1.0))

    def loaded(self):
        """Return the outer point of single pair contact's radius and the contact ratio, by the line of action.

        An external tooth begins contact at its foot, with the mate's tip, and is alone one base pitch later. A ring's
        tooth leaves contact at its foot, with the planet's tip, and is alone until one base pitch before.
        """
        pitch, low = np.pi * self.module * np.cos(ANGLE), 0.5 * self.mate * self.module * np.cos(ANGLE)
        outwards = self.shift if self.internal else -self.shift
        mates = np.sqrt((self.module * (0.5 * self.mate + 1.0 + outwards)) ** 2 - low**2)
        own = np.sqrt(self.tip_mm**2 - self.base_mm**2)
        if self.internal:
            foot = (self.base_mm - low) * np.tan(ANGLE) + mates
            return np.hypot(self.base_mm, foot - pitch), (foot - own) / pitch
        foot = (self.base_mm + low) * np.tan(ANGLE) - mates
        return np.hypot(self.base_mm, foot + pitch), (own - foot) / pitch

    def gear(self):
        """Return the package's gear."""
        kind = InternalGear if self.internal else ExternalGear
        return kind(teeth=self.teeth, module_mm=self.module, shift=self.shift, backlash_mm=THINNING * self.module)

    def iso_mpa(self):
        """Nominal root stress by the package, of a force of 1 N/mm normal to the flank."""
        form = tooth_form(self.gear(), self.loaded()[1])
        return float(np.cos(ANGLE) / self.module * form.form_factor * form.stress_correction)

    def stress(self, space, **fineness):
        """Root stress by finite elements, of a force of 1 N/mm normal to the flank."""
        return root_stress(
            space,
            teeth=self.teeth,
            module_mm=self.module,
            base_mm=self.base_mm,
            load_mm=self.loaded()[0],
            internal=self.internal,
            **fineness,
        )

    def cut_space(self):
        """Edge of a space around the y axis, from left to right, as the workshop cuts it."""
        cut = cut_ring if self.internal else cut_gear
        metal = cut(self.teeth, self.module, self.shift, THINNING * self.module, self.tip_mm)
        points = np.array(metal.exterior.coords)[:-1]
        radii = np.hypot(*points.T)
        low, high = (self.tip_mm, self.tip_mm + 3.0 * self.module) if self.internal else (0.0, self.tip_mm)
        inside = (radii > low + 1e-6) & (radii < high - 1e-6)
        if self.internal:
            inside &= radii < 0.5 * self.module * (self.teeth + 3.5) + self.shift * self.module
        (start,) = np.flatnonzero(inside & ~np.roll(inside, 1))
        points = np.roll(points, -start, axis=0)[: inside.sum()]
        return points if points[0, 0] < 0.0 else points[::-1]

    def drawn_space(self):
        """The same as the package draws it, of an external gear."""
        gear = self.gear()
        radii = np.linspace(float(gear.form_radius_mm), self.tip_mm, 500)[1:]
        beside = np.pi / self.teeth - half_angle(gear, radii)
        flank = np.stack([radii * np.sin(beside), radii * np.cos(beside)], axis=1)
        right = np.concatenate([gear.root_curve_mm(2000)[:, ::-1], flank])
        return np.concatenate([right[::-1] * [-1.0, 1.0], right])


SUN = Tooth(teeth=18, mate=32, module=0.7, shift=0.0)
PLANET = Tooth(teeth=32, mate=20, module=0.55, shift=-0.4)
SHIFTED = Tooth(teeth=20, mate=32, module=0.55, shift=0.4)
SMALL = Tooth(teeth=14, mate=30, module=0.5, shift=0.5)
RING = Tooth(teeth=82, mate=32, module=0.7, shift=0.0, internal=True)
SHIFTED_RING = Tooth(teeth=82, mate=32, module=0.55, shift=0.4, internal=True)


@cache
def cut_stress(tooth):
    return tooth.stress(tooth.cut_space())


@pytest.mark.parametrize(
    ("tooth", "ratio", "bent", "tangent_deg"),
    [
        (SUN, 0.982, 1.081, 34.0),
        pytest.param(PLANET, 1.000, 1.084, 33.0, marks=pytest.mark.long),
        pytest.param(SHIFTED, 0.914, 1.050, 38.0, marks=pytest.mark.long),
        (SMALL, 0.884, 1.036, 36.0),
        (RING, 0.911, 1.021, 45.0),
        pytest.param(SHIFTED_RING, 0.895, 1.004, 46.0, marks=pytest.mark.long),
    ],
)
def test_root_stress_by_iso_is_within_what_its_neglect_of_compression_explains(tooth, ratio, bent, tangent_deg):
    """See the text at the top: ratios over 5 percent from 1 come from the force's component along the tooth."""
    found, iso = cut_stress(tooth), tooth.iso_mpa()
    assert found.greatest_mpa / iso == pytest.approx(ratio, rel=0.008)
    assert found.bent_mpa / iso == pytest.approx(bent, rel=0.008)
    assert found.tangent_deg == pytest.approx(tangent_deg, abs=5.0)


@pytest.mark.parametrize("tooth", [SUN, pytest.param(SMALL, marks=pytest.mark.long)])
def test_the_drawn_root_is_stressed_like_the_cut_one_and_finer_triangles_change_little(tooth):
    """The cut outline has small facets, which triangles as small would see as notches: hence 12 to a fillet there."""
    coarse, fine, finest = (tooth.stress(tooth.drawn_space(), per_fillet=count).greatest_mpa for count in (12, 24, 48))
    assert coarse == pytest.approx(finest, rel=0.004)
    assert fine == pytest.approx(finest, rel=0.002)
    assert cut_stress(tooth).greatest_mpa == pytest.approx(finest, rel=0.006)


@pytest.mark.parametrize("tooth", [SUN, pytest.param(RING, marks=pytest.mark.long)])
def test_what_holds_the_rim_is_far_enough_away(tooth):
    further = tooth.stress(tooth.cut_space(), rim=5.5, beside=2)
    assert cut_stress(tooth).greatest_mpa == pytest.approx(further.greatest_mpa, rel=0.008)

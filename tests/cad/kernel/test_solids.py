"""Solids and meshes of every part against the records that gave the masses."""

import numpy as np
import pytest
import trimesh

from pareto_monoped.cad.shape.meshes import flaws, mesh_of
from pareto_monoped.cad.shape.outlines import regrouped
from pareto_monoped.geometry.parts import Part, Prism
from pareto_monoped.geometry.roles import Role
from pareto_monoped.geometry.shapes import Circle, rectangle
from pareto_monoped.leg.dimensions import leg_dimensions
from pareto_monoped.leg.shank import foot_part
from pareto_monoped.materials import Material
from tests.lazily import Lazily

bd = Lazily("build123d")
kernel = Lazily("pareto_monoped.cad.kernel.solids")

STEEL = Material(name="steel", density_kg_per_m3=7850.0, colour=(0.5, 0.5, 0.5))


@pytest.mark.parametrize("every", [12, pytest.param(1, marks=pytest.mark.long)])
def test_every_part_is_one_valid_solid_of_its_record_s_volume(product, every):
    """Every twelfth, or every one, also as build123d asks the kernel, in its own way."""
    for k, (kind, facts) in enumerate(zip(product.unique, product.solids.result(), strict=True)):
        assert facts.valid, kind.name
        # Exact but for the closed form of gear fillets.
        assert facts.volume_mm3 == pytest.approx(float(kind.part.volume_mm3()), rel=2e-3), kind.name
        if k % every:
            continue
        solid = bd.Shape.cast(kernel.solid_of(kind.part))
        assert solid.is_valid, kind.name
        assert len(solid.solids()) == 1, kind.name
        assert facts.volume_mm3 == pytest.approx(solid.volume, rel=1e-9), kind.name
        centre = solid.center(bd.CenterOf.MASS)
        assert facts.centre_mm == pytest.approx([centre.X, centre.Y, centre.Z], abs=1e-6), kind.name


@pytest.mark.parametrize("every", [10, pytest.param(1, marks=pytest.mark.long)])
def test_meshes_are_closed_and_lie_within_their_tolerance(product, every):
    for kind in product.unique[::every]:
        mesh = trimesh.Trimesh(kind.mesh.points_mm, kind.mesh.triangles, process=False)
        assert flaws(kind.mesh.points_mm[kind.mesh.triangles]) == "", kind.name
        assert mesh.is_watertight, kind.name
        assert mesh.is_winding_consistent, kind.name
        solid = bd.Shape.cast(kernel.solid_of(kind.part))
        assert mesh.volume == pytest.approx(solid.volume, rel=5e-3), kind.name
        if kind.part.balls:
            continue  # the kernel's box of a cut sphere is that of the whole
        box = solid.bounding_box()
        assert mesh.bounds[0] == pytest.approx([box.min.X, box.min.Y, box.min.Z], abs=0.03), kind.name
        assert mesh.bounds[1] == pytest.approx([box.max.X, box.max.Y, box.max.Z], abs=0.03), kind.name


def test_a_mesh_with_a_hole_or_a_turned_triangle_is_not_closed(product):
    mesh = product.unique[0].mesh
    assert flaws(mesh.points_mm[mesh.triangles[1:]])
    turned = mesh.triangles.copy()
    turned[0] = turned[0, ::-1]
    assert flaws(mesh.points_mm[turned])


def test_regrouping_keeps_the_body():
    disc = Circle(radius_mm=10.0)
    slices = (
        Prism(outline=disc, z0_mm=0.0, z1_mm=2.0, holes=(Circle(radius_mm=8.0),)),
        Prism(outline=disc, z0_mm=2.0, z1_mm=5.0, holes=(Circle(radius_mm=3.0),)),
        Prism(outline=disc, z0_mm=5.0, z1_mm=7.0, holes=(Circle(radius_mm=8.0),)),
        Prism(outline=rectangle(width_mm=30.0, height_mm=30.0), z0_mm=7.0, z1_mm=8.0),
    )
    new = regrouped(slices)
    assert len(new) == 3

    def integrals(prisms):
        return np.sum([np.array(prism.integrals(), dtype=float) for prism in prisms], axis=0)

    assert integrals(new) == pytest.approx(integrals(slices))


def test_separate_bodies_become_a_compound():
    part = Part(
        name="pair",
        role=Role.PIN,
        material=STEEL,
        process="bought",
        prisms=tuple(Prism(outline=Circle(radius_mm=2.0, x_mm=x), z0_mm=0.0, z1_mm=3.0) for x in (-5.0, 5.0)),
    )
    assert len(kernel.solids_in(kernel.solid_of(part))) == 2
    assert len(mesh_of(part).body.decompose()) == 2


def test_the_foot_is_a_cut_ball_with_a_pocket(actuator_map):
    foot = foot_part(0.3, leg_dimensions(actuator_map))
    solid = bd.Shape.cast(kernel.solid_of(foot))
    assert solid.volume == pytest.approx(float(foot.volume_mm3()), rel=1e-6)
    centre = solid.center()
    assert pytest.approx(1e3 * foot.mass_properties().com_m, abs=1e-3) == (centre.X, centre.Y, centre.Z)

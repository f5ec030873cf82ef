"""Countersinks, chamfers, lead-ins and heads as solids, meshes and STEP files, against their closed forms."""

import dataclasses

import numpy as np
import pytest

from pareto_monoped.cad.shape.meshes import beveled, flaws, mesh_of
from pareto_monoped.geometry.features import Cone, Hole, Mouth, ShaftEnd
from pareto_monoped.geometry.parts import Part, Prism
from pareto_monoped.geometry.roles import Role
from pareto_monoped.geometry.screws import M3, clearance, screw_part, tapped
from pareto_monoped.geometry.shapes import Circle, Pattern
from pareto_monoped.materials import Material
from tests.lazily import Lazily

bd = Lazily("build123d")
process = Lazily("pareto_monoped.cad.kernel.process")
solids = Lazily("pareto_monoped.cad.kernel.solids")
step = Lazily("pareto_monoped.cad.kernel.step")

STEEL = Material(name="steel", density_kg_per_m3=7850.0, colour=(0.5, 0.5, 0.5))
RIM, BORE = Circle(radius_mm=20.0), Circle(radius_mm=8.0)
SUNK = Pattern(radius_mm=1.6, pitch_radius_mm=13.0, count=6)
THREADS = Pattern(radius_mm=1.25, pitch_radius_mm=13.0, count=6, phase_rad=np.pi / 6)
FLANGE = Part(
    name="flange",
    role=Role.PLATE,
    material=STEEL,
    process="machined",
    prisms=(
        Prism(outline=RIM, z0_mm=0.0, z1_mm=3.0, holes=(SUNK, THREADS, BORE)),
        Prism(outline=Circle(radius_mm=10.0), z0_mm=3.0, z1_mm=9.0, holes=(BORE,)),
    ),
    features=(
        clearance(M3, (SUNK,), 0.0, 3.0, countersunk="low"),
        tapped(M3, (THREADS,), 0.0, 3.0, enters="both"),
        Hole(
            shapes=(BORE,),
            low_mm=0.0,
            high_mm=9.0,
            low=Mouth(radius_mm=8.2, depth_mm=1.0, kind=Cone.LEAD_IN),
            high=Mouth.at_90_degrees(8.3, 8.0),
        ),
        ShaftEnd(at=RIM, face_mm=0.0, inwards=1.0, width_mm=0.5, depth_mm=0.5),
        ShaftEnd(at=RIM, face_mm=3.0, inwards=-1.0, width_mm=0.3, depth_mm=0.3),
        ShaftEnd(at=Circle(radius_mm=10.0), face_mm=9.0, inwards=-1.0, width_mm=0.2, depth_mm=0.8),
    ),
)
SCREW = screw_part(
    "screw",
    M3,
    head="countersunk",
    seat_mm=3.0,
    grip_mm=3.0,
    room_mm=7.0,
    direction=-1.0,
    material=STEEL,
)
PARTS = pytest.mark.parametrize("part", [FLANGE, SCREW], ids=["flange", "screw"])


@PARTS
def test_a_solid_has_the_integrals_of_its_record(part):
    (facts,) = process.solid_facts([part])
    properties = part.mass_properties()
    assert facts.valid
    assert facts.bodies == 1
    assert facts.volume_mm3 == pytest.approx(float(part.volume_mm3()), rel=1e-12)
    assert facts.centre_mm == pytest.approx(1e3 * properties.com_m, abs=1e-9)
    assert facts.inertia_mm5 * 7.85e-12 == pytest.approx(properties.inertia_kg_m2, rel=1e-9, abs=1e-16)


def test_each_cone_takes_what_its_closed_form_says():
    (plain,) = process.solid_facts([dataclasses.replace(FLANGE, features=())])
    for feature in FLANGE.features:
        (cut,) = process.solid_facts([dataclasses.replace(FLANGE, features=(feature,))])
        expected = sum(float(bevel.integrals()[0]) for bevel in feature.bevels)
        assert expected < 0.0
        assert cut.volume_mm3 - plain.volume_mm3 == pytest.approx(expected, rel=1e-8), feature


@PARTS
def test_solids_have_cones_as_read_back_from_step(part, tmp_path):
    path = tmp_path / "part.step"
    path.write_bytes(step.part_step(solids.solid_of(part), part.name, step.Substance.of(part)))
    read = bd.import_step(path)
    assert read.is_valid
    assert read.volume == pytest.approx(float(part.volume_mm3()), rel=1e-9)
    cones = [face for face in read.faces() if face.geom_type == bd.GeomType.CONE]
    assert len(cones) == sum(len(bevel.centres_mm()) for bevel in part.bevels)


@PARTS
@pytest.mark.parametrize("tolerance_mm", [0.01, 0.05])
def test_a_mesh_is_closed_and_encloses_its_cones(part, tolerance_mm):
    mesh = mesh_of(part, tolerance_mm)
    assert flaws(mesh.points_mm[mesh.triangles]) == ""
    assert mesh.volume_mm3 == pytest.approx(float(part.volume_mm3()), rel=5e-3)
    for bevel in part.bevels:
        x, y = bevel.centres_mm()[0]
        away = mesh.points_mm - (x, y, 0.0)
        radii = np.hypot(away[:, 0], away[:, 1])
        for height, radius in ((bevel.face_mm, bevel.edge_mm), (bevel.end_mm, bevel.at.radius_mm)):
            there = (np.abs(mesh.points_mm[:, 2] - height) < 1e-6) & (np.abs(radii - radius) < 1e-6)
            assert there.sum() >= 40


def test_a_cone_on_no_edge_is_refused():
    lost = ShaftEnd(at=Circle(radius_mm=15.0), face_mm=0.0, inwards=1.0, width_mm=0.5, depth_mm=0.5)
    deep = ShaftEnd(at=RIM, face_mm=0.0, inwards=1.0, width_mm=0.5, depth_mm=3.0)
    with pytest.raises(ValueError, match="radius 15 mm"):
        mesh_of(dataclasses.replace(FLANGE, features=(lost,)))
    with pytest.raises(ValueError, match="radius 15 mm"):
        solids.solid_of(dataclasses.replace(FLANGE, features=(lost,)))
    with pytest.raises(ValueError, match="3 mm deep"):
        mesh_of(dataclasses.replace(FLANGE, features=(deep,)))


def test_cones_that_meet_are_refused():
    close = dataclasses.replace(SUNK, pitch_radius_mm=17.0)
    part = dataclasses.replace(
        FLANGE,
        prisms=(Prism(outline=RIM, z0_mm=0.0, z1_mm=3.0, holes=(close,)),),
        features=(clearance(M3, (close,), 0.0, 3.0, countersunk="low"),),
    )
    with pytest.raises(ValueError, match="does not fit"):
        solids.solid_of(part)


def test_a_mesh_without_cones_stays_as_it_is():
    mesh = mesh_of(dataclasses.replace(FLANGE, features=()))
    points, triangles = beveled(mesh.points_mm, mesh.triangles, ())
    assert points is mesh.points_mm
    assert triangles is mesh.triangles

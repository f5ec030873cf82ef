"""Files are read back by other programs' readers: build123d, ezdxf, trimesh, lib3mf, the XML and PNG standards."""

import csv
import io
import json
import re

import ezdxf
import ezdxf.units
import lib3mf
import numpy as np
import pytest
import trimesh
from ezdxf import edgeminer, edgesmith
from ezdxf.path import make_path
from PIL import Image

from pareto_monoped.cad.kernel import client as kernel
from pareto_monoped.cad.picture.drawing import png
from pareto_monoped.cad.picture.scenes import section_scene
from pareto_monoped.cad.product import build_product, step_assembly
from pareto_monoped.cad.shape.meshes import placed
from pareto_monoped.cad.shape.outlines import contours
from pareto_monoped.cad.write import files
from pareto_monoped.cad.write.dxf import LAYER, NOTES, dxf, is_flat
from pareto_monoped.cad.write.folder import FILES
from pareto_monoped.cad.write.meshes import glb, stl, threemf
from pareto_monoped.cad.write.tables import parts_list
from pareto_monoped.geometry.features import Cone
from tests.cad.check.faults import bare
from tests.lazily import Lazily

bd = Lazily("build123d")

UNITS = ["base_frame", "hip_actuator", "thigh", "knee_actuator", "journal", "shank", "foot"]


@pytest.fixture(scope="module")
def leg(product, tmp_path_factory):
    """The folder of a robot without its actuators, which take longest: its STEP assembly and its parts list."""
    folder = tmp_path_factory.mktemp("leg")
    small = build_product(bare(product.robot), product.pose)
    (folder / "assembly.step").write_bytes(kernel.step_files(step_assembly(small, "monoped")).result()[0])
    (folder / "bom.csv").write_text(parts_list(small))
    return folder


@pytest.mark.parametrize("which", ["leg", pytest.param("exported", marks=pytest.mark.long)])
def test_assembly_step_gives_back_solids_names_colours_and_volumes(which, request):
    made = request.getfixturevalue(which)
    folder = made if which == "leg" else made.folder
    shape = bd.import_step(folder / "assembly.step")
    assert [unit.label for unit in shape.children] == [
        name for name in UNITS if which == "exported" or not name.endswith("_actuator")
    ]
    with (folder / "bom.csv").open() as stream:
        rows = {row["part"]: row for row in csv.DictReader(stream)}
    for name, row in rows.items():
        units = [unit.label for unit in shape.children if name in {leaf.label for leaf in unit.children}]
        assert row["used_in"].split() == units
    leaves = [leaf for unit in shape.children for leaf in unit.children]
    assert len(shape.solids()) == len(leaves) == sum(int(row["count"]) for row in rows.values())
    names = [leaf.label for leaf in leaves]
    assert {name: names.count(name) for name in rows} == {name: int(row["count"]) for name, row in rows.items()}
    densities = {"aluminium": 2710.0, "printed plastic": 1430.0, "steel": 7850.0, "gear steel": 7850.0}
    for leaf in leaves:
        row = rows[leaf.label]
        assert leaf.color is not None
        if row["made_or_bought"] == "made" and row["material"] in densities:
            mass_g = leaf.volume * 1e-6 * densities[row["material"]]
            assert mass_g == pytest.approx(float(row["mass_g"]), rel=2e-3, abs=0.006), leaf.label


def test_laser_drawings_hold_outline_and_holes_on_one_layer(product):
    flat = [kind for kind in product.unique if is_flat(kind.part)]
    plates = {"thigh_plate_inner", "thigh_plate_outer", "shank_plate_near", "shank_plate_far"}
    assert {kind.name for kind in flat} == {"base_near_cheek", "hip_driver_plate", "knee_driver_plate", *plates}
    for kind in flat:
        document = ezdxf.read(io.StringIO(dxf(kind.part)))
        assert document.audit().errors == []
        entities = [entity for entity in document.modelspace() if entity.dxf.layer == LAYER]
        assert {entity.dxf.layer for entity in document.modelspace()} <= {LAYER, NOTES}
        assert {entity.dxftype() for entity in entities} <= {"CIRCLE", "ARC", "LINE"}
        circles = [entity for entity in entities if entity.dxftype() == "CIRCLE"]
        holes = [contour for hole in kind.part.prisms[0].holes for contour in contours(hole)]
        assert len(circles) == sum(contour.circle is not None for contour in holes)
        # The area that the drawing encloses, by chaining its lines and arcs, is the plate's.
        edges = list(edgesmith.edges_from_entities_2d(entity for entity in entities if entity.dxftype() != "CIRCLE"))
        closed = edgeminer.find_all_simple_chains(edgeminer.Deposit(edges, gap_tol=1e-4))
        areas = sorted((abs(_area(chain)) for chain in closed), reverse=True)
        enclosed = areas[0] - sum(areas[1:]) - sum(np.pi * circle.dxf.radius**2 for circle in circles)
        prism = kind.part.prisms[0]
        assert enclosed == pytest.approx(float(prism.moments().area), rel=2e-3)


def test_laser_drawings_say_beside_each_hole_what_follows_cutting(product):
    """Every countersink, thread and fit of a flat part, as many as its record has, at a hole of that kind."""
    for kind in product.unique:
        if not is_flat(kind.part):
            continue
        document = ezdxf.read(io.StringIO(dxf(kind.part)))
        texts = [entity for entity in document.modelspace() if entity.dxf.layer == NOTES]
        assert {entity.dxftype() for entity in texts} <= {"TEXT"}
        said = [re.fullmatch(r"(?:(\d+) x )?(.*)", text.plain_text()) for text in texts]
        (prism,) = kind.part.prisms
        expected = {"countersink": 0, "-": 0, " H": 0}
        for feature in kind.part.features:
            count = sum(len(contours(shape)) for shape in feature.shapes)
            sunk = any(mouth is not None and mouth.kind is Cone.COUNTERSINK for mouth in (feature.low, feature.high))
            expected["countersink"] += count * sunk
            expected["-"] += count * (feature.thread is not None)
        for fit in kind.part.fits:
            round_holes = [c.circle for hole in prism.holes for c in contours(hole) if c.circle is not None]
            expected[" H"] += sum(fit.holds(2.0 * float(circle.radius_mm)) for circle in round_holes)
        for word, count in expected.items():
            assert sum(int(m[1] or 1) for m in said if word in m[2]) == count, (kind.name, word)
        for text in texts:
            near = [c for h in prism.holes for c in contours(h) if c.circle is not None]
            away = [
                np.hypot(text.dxf.insert.x - float(c.circle.x_mm), text.dxf.insert.y - float(c.circle.y_mm))
                - float(c.circle.radius_mm)
                for c in near
            ]
            assert min(away) < 2.5, kind.name


def _area(chain):
    polyline = edgesmith.lwpolyline_from_chain(chain)
    points = np.array([tuple(p)[:2] for p in make_path(polyline).flattening(0.01)])
    x, y = points.T
    return 0.5 * np.sum(x * np.roll(y, -1) - y * np.roll(x, -1))


def test_a_part_that_is_not_flat_has_no_drawing(product):
    axle = next(kind.part for kind in product.unique if kind.name == "knee_axle")
    with pytest.raises(ValueError, match="knee_axle: not a flat part"):
        dxf(axle)


def test_stl_in_millimetres_and_metres(product):
    kind = next(kind for kind in product.unique if kind.name == "thigh_core")
    for scale in (1.0, 1e-3):
        mesh = trimesh.load(io.BytesIO(stl(kind.mesh, scale=scale)), file_type="stl")
        assert mesh.is_watertight
        assert mesh.volume == pytest.approx(float(kind.part.volume_mm3()) * scale**3, rel=1e-3)


def test_3mf_is_read_by_its_consortium_s_library(product, tmp_path):
    kind = next(kind for kind in product.unique if kind.name == "shank_core")
    path = tmp_path / "core.3mf"
    path.write_bytes(threemf(kind.mesh, kind.name))
    model = lib3mf.Wrapper().CreateModel()
    reader = model.QueryReader("3mf")
    reader.SetStrictModeActive(True)
    reader.ReadFromFile(str(path))
    assert reader.GetWarningCount() == 0
    found = model.GetMeshObjects()
    assert found.MoveNext()
    body = found.GetCurrentMeshObject()
    assert body.GetName() == "shank_core"
    assert body.IsManifoldAndOriented()
    assert body.GetTriangleCount() == len(kind.mesh.triangles)
    assert min(v.Coordinates[2] for v in body.GetVertices()) == pytest.approx(0.0, abs=1e-6)


def test_glb_shares_geometry_and_stands_upright_in_metres(product):
    scene = trimesh.load_scene(io.BytesIO(glb(product)), file_type="glb")
    assert len(scene.geometry) == len(product.unique)
    assert len(scene.graph.nodes_geometry) == len(product.instances)
    bodies = [placed(unique.mesh.body, i.world).bounding_box() for i, unique in product.placed()]
    low, high = np.min([b[:3] for b in bodies], axis=0), np.max([b[3:] for b in bodies], axis=0)
    # glTF: x to the left, y up, z to the front.
    assert scene.bounds[0] == pytest.approx(1e-3 * low[[1, 2, 0]], abs=1e-5)
    assert scene.bounds[1] == pytest.approx(1e-3 * high[[1, 2, 0]], abs=1e-5)


def test_pictures_show_something_on_white(exported):
    for name, _ in FILES["png"]:
        with Image.open(exported.folder / name) as image:
            image.load()
            pixels = np.asarray(image)
        assert image.mode == "RGB"
        assert min(image.size) > 600
        drawn = np.any(pixels < 250, axis=2)
        assert 0.05 < drawn.mean() < 0.8
        assert pixels[0, 0].tolist() == [255, 255, 255]


def test_design_record_and_readme_tell_the_same(exported, actuator_map):
    record = json.loads((exported.folder / "design.json").read_text())
    text = (exported.folder / "README.md").read_text()
    assert record["searched"]["thigh_length_m"] == 0.490037
    assert record["as_built"]["thigh_length_m"] == 0.49
    assert record["as_built"]["knee_ratio"] == 6.0
    assert record["source"] == {"case": "C"}
    for name in record["files"]:
        assert (exported.folder / name).is_file()
    for height in (record["jumps"][kind]["height_m"] for kind in ("searched", "as_built")):
        assert f"{height:.4g}" in text
    gears = actuator_map.lookup(6.07).gears
    assert f"teeth {gears.sun_teeth}/{gears.planet_teeth}/{gears.ring_teeth}" in text


def test_parts_list_sizes_and_costs_are_those_of_the_files(exported):
    with (exported.folder / "bom.csv").open() as stream:
        rows = list(csv.DictReader(stream))
    for row in rows:
        mesh = trimesh.load(exported.folder / "parts" / "stl" / f"{row['part']}.stl")
        assert [float(size) for size in row["size_mm"].split(" x ")] == pytest.approx(mesh.extents, abs=0.051)
        assert row["used_in"].split() == [name for name in UNITS if name in row["used_in"].split()]
        assert row["made_or_bought"] == ("bought" if row["process"] == "bought" else "made")
        assert float(row["total_g"]) == pytest.approx(int(row["count"]) * float(row["mass_g"]), abs=0.01 * 50)
        price, hours, cost = (float(row[name]) for name in ("material_eur", "machine_h", "cost_eur"))
        assert cost >= price > 0.0
        assert (hours > 0.0) == (cost > price) == (row["made_or_bought"] == "made")
    # All together they are the record's cost, and what the page says; each is rounded to a cent.
    total_eur = json.loads((exported.folder / "design.json").read_text())["cost_eur"]
    assert sum(float(row["cost_eur"]) for row in rows) == pytest.approx(total_eur, abs=0.005 * len(rows))
    made = sum(int(row["count"]) for row in rows if row["made_or_bought"] == "made")
    page = (exported.folder / "README.md").read_text()
    assert f"about {total_eur:.0f} EUR as a one-off: " in page
    assert f"{made} pieces made and {sum(int(row['count']) for row in rows) - made} bought" in page
    # M3 of 10.9: 1.9 N m (VDI 2230); every screw has a torque and a lock, what is no fastener has neither.
    (screw,) = (row for row in rows if row["part"] == "hip_mount_screw")
    assert (screw["torque_n_m"], screw["lock"]) == ("1.9", "medium-strength thread locker")
    for row in rows:
        if "_screw" in row["part"]:
            assert row["torque_n_m"]
            assert row["lock"]
        elif "bolt" not in row["part"] and "turnbuckle" not in row["part"]:
            assert row["torque_n_m"] == row["lock"] == ""


def test_step_files_have_the_colour_of_each_part_s_material(exported, product):
    colours = {unique.part.material.name: unique.part.material.colour for unique in product.unique}
    assert len(set(colours.values())) > 2
    assert any(len(set(colour)) == 3 for colour in colours.values())
    with (exported.folder / "bom.csv").open() as stream:
        materials = {row["part"]: row["material"] for row in csv.DictReader(stream)}
    number = re.compile(r"COLOUR_RGB\('',([^,]*),([^,]*),([^)]*)\)")
    for name, material in materials.items():
        text = (exported.folder / "parts" / "step" / f"{name}.step").read_text()
        assert [tuple(map(float, found)) for found in number.findall(text)] == [colours[material]], name
        assert "'2025-01-01T00:00:00'" in text
    text = (exported.folder / "assembly.step").read_text()
    with (exported.folder / "bom.csv").open() as stream:
        pieces = sum(int(row["count"]) for row in csv.DictReader(stream))
    # Every piece is used once in its unit, and every unit once in the robot.
    assert text.count("NEXT_ASSEMBLY_USAGE_OCCURRENCE(") == pieces + len(UNITS)
    assert {tuple(map(float, found)) for found in number.findall(text)} == {colours[m] for m in materials.values()}


def test_laser_drawings_say_that_they_are_in_millimetres(exported):
    for path in (exported.folder / "laser").iterdir():
        assert ezdxf.readfile(path).units == ezdxf.units.MM


def test_the_section_shows_the_knee_actuator(product, monkeypatch):
    """The kernel's process is asked for one picture only."""
    asked = {}
    monkeypatch.setattr(kernel, "do", lambda draw, scene: (draw, scene))
    for name, (draw, scene) in files.pictures(product).items():
        asked[name] = draw, scene
    monkeypatch.undo()
    knee, hip = (section_scene(product, f"{joint}_actuator") for joint in ("knee", "hip"))
    draw, scene = asked["knee_actuator_section.png"]
    assert kernel.do(draw, scene).result() == png(knee.picture())
    assert knee.legend != hip.legend
    assert f"planet ({product.robot.knee.gears.planets})" in {row.text for row in knee.legend}

"""Meshes are judged by the bytes of their files, as another reader judges them."""

import io
import json
import re
import zipfile

import numpy as np
import pytest
import trimesh

from pareto_monoped.cad.check import watertight
from pareto_monoped.cad.check.result import MESH_VOLUME
from pareto_monoped.cad.check.watertight import meshes_of, read_stl
from pareto_monoped.cad.shape.meshes import flaws, volume
from pareto_monoped.cad.write.meshes import stl
from tests.cad.check.faults import shifted

HEADER, ROW = 84, 50


def without_triangle(content):
    """An STL file that lacks its last triangle."""
    count = (len(content) - HEADER) // ROW
    return content[:80] + np.uint32(count - 1).tobytes() + content[HEADER:-ROW]


def with_turned_triangle(content):
    """An STL file whose last triangle faces the other way."""
    row = content[-ROW:]
    return content[:-ROW] + row[:12] + row[24:36] + row[12:24] + row[36:]


def scaled(kind, factor):
    points = kind.mesh.points_mm
    return stl(kind.mesh.__class__(points_mm=factor * points, triangles=kind.mesh.triangles, body=kind.mesh.body))


def kind_of(product, name):
    return next(kind for kind in product.unique if kind.name == name)


@pytest.mark.parametrize("spoil", [without_triangle, with_turned_triangle])
def test_an_open_mesh_in_a_part_s_file_is_named(part_files, examine, failing, spoil):
    # A gear has many small triangles: one of them hardly changes its volume.
    broken = part_files | {"knee_actuator_ring": spoil(part_files["knee_actuator_ring"])}
    assert failing(part_files=broken) == ["meshes are watertight"]
    check = examine(part_files=broken)["meshes are watertight"]
    assert check.failures == ("knee_actuator_ring: its mesh is not closed, 3 edges do not border two triangles",)
    assert check.measured == 1.0


def test_an_open_mesh_in_any_other_file_is_named(other_files, failing, examine):
    name = next(path for path in other_files if path.startswith("model/meshes/shank_aluminium"))
    broken = other_files | {name: without_triangle(other_files[name])}
    assert failing(other_files=broken) == ["meshes are watertight"]
    (text,) = examine(other_files=broken)["meshes are watertight"].failures
    assert text.startswith(f"{name}: its mesh is not closed")


def test_an_open_mesh_in_the_assembly_is_named(product, part_files, other_files):
    """The first triangle of a mesh has its third corner where its second one is."""
    content = bytearray(other_files["assembly.glb"])
    sound = meshes_of("assembly.glb", bytes(content))
    name, at, index = own_indices(content)
    content[at + 2 * index : at + 3 * index] = content[at + index : at + 2 * index]
    broken = meshes_of("assembly.glb", bytes(content))
    assert {key for key in sound if not np.array_equal(sound[key], broken[key])} == {name}
    closed, volumes = watertight.check(product, part_files, {"assembly.glb": bytes(content)})
    assert closed.failures == (f"assembly.glb {name}: its mesh is not closed, 1 triangles have no area",)
    assert volumes.passed


def own_indices(content):
    """A mesh of a GLB file that shares its indices with no other, where they begin, and how many bytes one has.

    Cylinders of any size have the same indices, which the writer stores once.
    """
    length = int(np.frombuffer(content, "<u4", 1, 12)[0])
    scene = json.loads(bytes(content[20 : 20 + length]))
    views = {
        mesh["name"]: scene["accessors"][mesh["primitives"][0]["indices"]]["bufferView"] for mesh in scene["meshes"]
    }
    used = list(views.values())
    name = next(name for name, view in views.items() if used.count(view) == 1)
    return name, 20 + length + 8 + scene["bufferViews"][views[name]].get("byteOffset", 0), 4


def test_an_open_mesh_in_a_file_to_print_is_named(product, part_files, other_files):
    path = next(path for path in other_files if path.endswith(".3mf"))
    sound, spoilt = io.BytesIO(other_files[path]), io.BytesIO()
    with zipfile.ZipFile(sound) as before, zipfile.ZipFile(spoilt, "w") as after:
        for entry in before.namelist():
            after.writestr(entry, re.sub(rb"<triangle [^>]*/>", b"", before.read(entry), count=1))
    closed, _ = watertight.check(product, part_files, {path: spoilt.getvalue()})
    assert closed.failures == (f"{path}: its mesh is not closed, 3 edges do not border two triangles",)


def test_a_file_has_as_many_triangles_as_its_header_says(part_files):
    """Other programs read no further."""
    content = part_files["foot"]
    count = (len(content) - HEADER) // ROW
    fewer = content[:80] + np.uint32(count - 1).tobytes() + content[HEADER:]
    assert flaws(read_stl(content)) == ""
    assert flaws(read_stl(fewer)) == "3 edges do not border two triangles"


@pytest.mark.long
def test_a_mesh_of_another_size_than_its_part_is_named(product, part_files, examine, failing):
    kind = kind_of(product, "foot")
    broken = part_files | {"foot": scaled(kind, 1.01)}
    assert failing(part_files=broken) == ["meshes have the volumes of their parts"]
    check = examine(part_files=broken)["meshes have the volumes of their parts"]
    assert check.measured == pytest.approx(3.0, abs=0.3)
    assert check.failures[0].startswith("foot: its mesh has ")
    assert failing(part_files=part_files | {"foot": scaled(kind, 1.002)}) == []
    assert failing(part_files=part_files | {"foot": scaled(kind, 0.99)}) == ["meshes have the volumes of their parts"]
    assert MESH_VOLUME.value == 1.0


@pytest.mark.parametrize("every", [6, pytest.param(1, marks=pytest.mark.long)])
def test_every_file_is_read_as_trimesh_reads_it(part_files, other_files, every):
    """Every sixth file of a part, or every one, and all other files."""
    files = {f"{name}.stl": part_files[name] for name in list(part_files)[::every]} | other_files
    seen = 0
    for path, content in files.items():
        loaded = trimesh.load_scene(io.BytesIO(content), file_type=path.rsplit(".", 1)[1]) if is_glb(path) else None
        for name, corners in meshes_of(path, content).items():
            if path.endswith(".3mf"):
                mesh = trimesh.Trimesh(corners.reshape(-1, 3), np.arange(3 * len(corners)).reshape(-1, 3))
            elif loaded is not None:
                mesh = loaded.geometry[name]
                mesh.merge_vertices(merge_norm=True, merge_tex=True)
            else:
                mesh = trimesh.load(io.BytesIO(content), file_type="stl")
            assert len(mesh.faces) == len(corners), path
            assert mesh.is_volume, (path, name)
            assert not flaws(corners), (path, name)
            assert volume(corners) == pytest.approx(mesh.volume, rel=1e-5), (path, name)
            seen += 1
    assert seen > len(part_files) + len(list(part_files)[::every])


def is_glb(path):
    return path.endswith(".glb")


@pytest.mark.parametrize("seed", range(20))
def test_a_damaged_file_is_judged_as_trimesh_judges_it(part_files, seed):
    """Triangles lost, doubled, turned, or with a corner moved by a lot or by less than single precision."""
    rng = np.random.default_rng(seed)
    content = part_files["knee_bearing_cup"]
    rows = np.frombuffer(content, np.uint8, offset=HEADER).reshape(-1, ROW).copy()
    k = int(rng.integers(len(rows)))
    kind = seed % 5
    if kind == 0:
        rows = np.delete(rows, k, axis=0)
    elif kind == 1:
        rows = np.concatenate([rows, rows[k : k + 1]])
    elif kind == 2:
        rows[k, 12:36] = np.concatenate([rows[k, 24:36], rows[k, 12:24]])
    else:
        corner = rows[k, 12:24].copy().view("<f4")
        corner[int(rng.integers(3))] += 1e-3 if kind == 3 else 1e-12
        rows[k, 12:24] = corner.view(np.uint8)
    spoilt = content[:80] + np.uint32(len(rows)).tobytes() + rows.tobytes()
    mesh = trimesh.load(io.BytesIO(spoilt), file_type="stl")
    assert mesh.is_volume == (kind == 4)
    assert (not flaws(read_stl(spoilt))) == mesh.is_volume


def test_points_that_merge_in_single_precision_are_found():
    """A mesh that is closed in memory had triangles without area in its file."""
    corners = tetrahedra(shifted())
    assert flaws(corners) == ""
    close = corners.copy()
    # A fifth point 3e-9 mm from the fourth, with two slim triangles to it.
    far, near = close[1, 1], close[1, 1] + np.array([0.0, 0.0, 3e-9])
    slim = np.concatenate([close, [[far, near, close[0, 0]], [near, far, close[0, 0]]]])
    assert "no area" in flaws(slim)


def test_touching_bodies_are_found():
    """Two closed bodies with an edge in common: four triangles border it."""
    one, other = tetrahedra(shifted()), tetrahedra(shifted(z=-1.0))
    assert flaws(np.concatenate([one, other + np.array([5.0, 0.0, 0.0])])) == ""
    mirrored = one[:, ::-1] * [1.0, 1.0, -1.0]  # on the same triangle, below it
    assert "do not border two triangles" in flaws(np.concatenate([one, mirrored]))
    assert volume(one) == pytest.approx(1.0 / 6.0)
    assert volume(mirrored) == pytest.approx(1.0 / 6.0)


def tetrahedra(matrix):
    """The corners of one tetrahedron of volume 1/6, moved."""
    points = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]) + matrix[:3, 3]
    return points[[[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]]


def test_a_file_of_another_kind_is_refused():
    with pytest.raises(ValueError, match=r"robot\.obj: not a mesh file; give \.stl, \.3mf or \.glb"):
        meshes_of("robot.obj", b"")

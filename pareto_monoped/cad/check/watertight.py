"""Every mesh is closed when it is read back from the bytes of its file, and encloses the volume of its part."""

import io
import json
import xml.etree.ElementTree as ET
import zipfile
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.cad.check.result import MESH_VOLUME, WATERTIGHT, Check, Finding, count_of, worst_of
from pareto_monoped.cad.product import Product
from pareto_monoped.cad.shape.meshes import flaws, volume

Corners = NDArray[np.floating]

_STL = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("extra", "<u2")])
_STL_HEADER = 84  # 80 bytes without meaning, then the number of triangles
_GLB_HEADER = 12  # magic, version, length of the file; then chunks, each with its length and kind before it
_CORE = "{http://schemas.microsoft.com/3dmanufacturing/core/2015/02}"


def meshes_of(name: str, content: bytes) -> Mapping[str, Corners]:
    """Return the triangles' corners of every mesh in a file, in its unit, shape (n, 3, 3), by the mesh's name."""
    if name.endswith(".stl"):
        return {"": read_stl(content)}
    if name.endswith(".3mf"):
        return {"": read_3mf(content)}
    if name.endswith(".glb"):
        return read_glb(content)
    raise ValueError(f"{name}: not a mesh file; give .stl, .3mf or .glb")


def read_stl(content: bytes) -> Corners:
    """Read binary STL."""
    count = int(np.frombuffer(content, "<u4", 1, _STL_HEADER - 4)[0])
    return np.frombuffer(content, _STL, count, _STL_HEADER)["corners"]


def read_3mf(content: bytes) -> Corners:
    """Read a 3MF file with one object."""
    with zipfile.ZipFile(io.BytesIO(content)) as archive:
        root = ET.fromstring(archive.read("3D/3dmodel.model"))
    points = np.array([[float(v.attrib[axis]) for axis in "xyz"] for v in root.iter(f"{_CORE}vertex")])
    triangles = np.array([[int(t.attrib[k]) for k in ("v1", "v2", "v3")] for t in root.iter(f"{_CORE}triangle")])
    return np.asarray(points[triangles])


def read_glb(content: bytes) -> dict[str, Corners]:
    """Read binary glTF 2.0 whose meshes have one primitive of triangles each."""
    length = int(np.frombuffer(content, "<u4", 1, _GLB_HEADER)[0])
    start = _GLB_HEADER + 8
    scene, data = json.loads(content[start : start + length]), memoryview(content)[start + length + 8 :]

    def values(accessor: int, kind: type[np.generic]) -> NDArray[np.generic]:
        entry = scene["accessors"][accessor]
        view = scene["bufferViews"][entry["bufferView"]]
        wide = {"SCALAR": 1, "VEC3": 3}[entry["type"]]
        at = view.get("byteOffset", 0) + entry.get("byteOffset", 0)
        return np.frombuffer(data, np.dtype(kind).newbyteorder("<"), wide * entry["count"], at).reshape(-1, wide)

    found: dict[str, Corners] = {}
    for mesh in scene["meshes"]:
        (primitive,) = mesh["primitives"]
        points = values(primitive["attributes"]["POSITION"], np.float32)
        found[mesh["name"]] = points[values(primitive["indices"], np.uint32).reshape(-1, 3)]
    return found


def check(product: Product, part_files: Mapping[str, bytes], other_files: Mapping[str, bytes]) -> tuple[Check, Check]:
    """Look at the meshes in the files of an export."""
    corners = {kind.name: read_stl(part_files[kind.name]) for kind in product.unique}
    volumes = []
    for kind in product.unique:
        percent = 100.0 * abs(volume(corners[kind.name]) / float(kind.part.volume_mm3()) - 1.0)
        text = f"{kind.name}: its mesh has {percent:.2f}% more or less volume than its record"
        volumes.append(Finding(value=percent, text=text))
    for path, content in other_files.items():
        corners |= {f"{path} {name}".strip(): triangles for name, triangles in meshes_of(path, content).items()}
    parts = f"{len(product.unique)} parts"
    return (
        count_of(WATERTIGHT, f"{parts} and {len(other_files)} other files, as read back", _open_meshes(corners)),
        worst_of(MESH_VOLUME, f"{parts}, as read back", volumes),
    )


def _open_meshes(corners: Mapping[str, Corners]) -> list[str]:
    """Return a sentence for every mesh that is not closed."""
    # An assembly has the triangles of the parts' own files, which need only one look.
    known: dict[bytes, str] = {}
    found = []
    for name, triangles in corners.items():
        content = triangles.tobytes()
        if content not in known:
            known[content] = flaws(triangles)
        if known[content]:
            found.append(f"{name}: its mesh is not closed, {known[content]}")
    return found

"""STL, 3MF and GLB from the meshes."""

import io
import json
import struct
import zipfile
from typing import Any

import numpy as np

from pareto_monoped.cad.meshes import Mesh
from pareto_monoped.cad.product import Product

_EARLIEST = (1980, 1, 1, 0, 0, 0)  # the zip format's first date: a real one would make each export differ
_VERTICES, _TRIANGLES, _FLOAT, _UNSIGNED = 34962, 34963, 5126, 5125  # glTF's numbers for targets and types
_CONTENT_TYPES = (
    '<?xml version="1.0" encoding="UTF-8"?>\n'
    '<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types">'
    '<Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/>'
    '<Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/></Types>'
)
_RELATIONS = (
    '<?xml version="1.0" encoding="UTF-8"?>\n'
    '<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships">'
    '<Relationship Target="/3D/3dmodel.model" Id="rel0" '
    'Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>'
)


def stl(mesh: Mesh, *, scale: float = 1.0) -> bytes:
    """A binary STL file; in millimetres, or in metres with ``scale`` 0.001."""
    corners = (mesh.points_mm * scale)[mesh.triangles].astype("<f4")
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    length = np.linalg.norm(normal, axis=1, keepdims=True)
    rows = np.zeros(len(corners), dtype=[("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("extra", "<u2")])
    rows["normal"] = normal / np.where(length > 0.0, length, 1.0)
    rows["corners"] = corners
    return b"\0" * 80 + np.uint32(len(rows)).tobytes() + rows.tobytes()


def threemf(mesh: Mesh, name: str) -> bytes:
    """A 3MF file (3MF core specification 1.3) of one object, in millimetres, lying on the plate."""
    points = mesh.points_mm - np.array([0.0, 0.0, mesh.points_mm[:, 2].min()])
    vertices = "".join(f'<vertex x="{x:.6g}" y="{y:.6g}" z="{z:.6g}"/>' for x, y, z in points.tolist())
    triangles = "".join(f'<triangle v1="{a}" v2="{b}" v3="{c}"/>' for a, b, c in mesh.triangles.tolist())
    model = (
        '<?xml version="1.0" encoding="UTF-8"?>\n<model unit="millimeter" xml:lang="en-US" '
        'xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02"><resources>'
        f'<object id="1" type="model" name="{name}"><mesh><vertices>{vertices}</vertices>'
        f"<triangles>{triangles}</triangles></mesh></object></resources>"
        '<build><item objectid="1"/></build></model>'
    )
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as archive:
        for path, text in (
            ("[Content_Types].xml", _CONTENT_TYPES),
            ("_rels/.rels", _RELATIONS),
            ("3D/3dmodel.model", model),
        ):
            entry = zipfile.ZipInfo(path, _EARLIEST)
            entry.compress_type = zipfile.ZIP_DEFLATED
            archive.writestr(entry, text)
    return stream.getvalue()


def glb(product: Product) -> bytes:
    """The assembly as binary glTF 2.0: metres, y up, the front towards +z, each unique part's triangles stored once."""
    metres = np.diag([1e-3, 1e-3, 1e-3, 1.0])
    upright = np.array([[0.0, 1, 0, 0], [0, 0, 1, 0], [1, 0, 0, 0], [0, 0, 0, 1]])  # x forward, y left, z up to that
    materials = list(dict.fromkeys(kind.part.material for kind in product.unique))
    data = bytearray()
    views: list[dict[str, int]] = []
    accessors: list[dict[str, Any]] = []
    for kind in product.unique:
        points, corners = kind.mesh.points_mm.astype("<f4"), kind.mesh.triangles.astype("<u4")
        for content, target in ((points, _VERTICES), (corners, _TRIANGLES)):
            views.append({"buffer": 0, "byteOffset": len(data), "byteLength": content.nbytes, "target": target})
            data += content.tobytes()
        view = len(views) - 2
        extent = {"min": points.min(axis=0).tolist(), "max": points.max(axis=0).tolist()}
        accessors += [
            {"bufferView": view, "componentType": _FLOAT, "count": len(points), "type": "VEC3", **extent},
            {"bufferView": view + 1, "componentType": _UNSIGNED, "count": corners.size, "type": "SCALAR"},
        ]
    nodes = [
        {
            "name": instance.name,
            "mesh": kind,
            "matrix": (upright @ metres @ instance.world).T.ravel().tolist(),  # by columns
        }
        for instance, kind in zip(product.instances, product.kinds, strict=True)
    ]
    document = {
        "asset": {"version": "2.0", "generator": "pareto-monoped"},
        "scene": 0,
        "scenes": [{"nodes": list(range(len(nodes)))}],
        "nodes": nodes,
        "meshes": [
            {
                "name": kind.name,
                "primitives": [
                    {
                        "attributes": {"POSITION": 2 * k},
                        "indices": 2 * k + 1,
                        "material": materials.index(kind.part.material),
                    }
                ],
            }
            for k, kind in enumerate(product.unique)
        ],
        "materials": [
            {
                "name": material.name,
                "pbrMetallicRoughness": {
                    "baseColorFactor": [*material.colour, 1.0],
                    "metallicFactor": 0.2,
                    "roughnessFactor": 0.6,
                },
            }
            for material in materials
        ],
        "accessors": accessors,
        "bufferViews": views,
        "buffers": [{"byteLength": len(data)}],
    }
    text = json.dumps(document, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    length = 12 + 8 + len(text) + 8 + len(data)
    return b"".join(
        (
            struct.pack("<4sII", b"glTF", 2, length),
            struct.pack("<I4s", len(text), b"JSON"),
            text,
            struct.pack("<I4s", len(data), b"BIN\0"),
            data,
        )
    )

"""The assembly as binary glTF 2.0 (ISO/IEC 12113), written here: a library for it would take longer to import."""

import json
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.cad.product import Product
from pareto_monoped.materials import Material

_MAGIC, _VERSION = b"glTF", 2
_JSON, _BINARY = 0x4E4F534A, 0x004E4942  # kinds of chunks
_UNSIGNED_INT, _FLOAT = 5125, 5126
_TRIANGLES = 4
_METRES = np.diag([1e-3, 1e-3, 1e-3, 1.0])
_UPRIGHT = np.array([[0.0, 1, 0, 0], [0, 0, 1, 0], [1, 0, 0, 0], [0, 0, 0, 1]])
"""From x forward, y left, z up to glTF's axes: y up, the front towards +z."""


def glb(product: Product) -> bytes:
    """A GLB file in metres; each unique part's triangles are stored once."""
    data = _Data()
    materials: dict[Material, int] = {}
    meshes = []
    for kind in product.unique:
        # The order of the two is free; the accessors are numbered as they are made.
        indices = data.accessor(kind.mesh.triangles.astype("<u4").reshape(-1, 1), "SCALAR", _UNSIGNED_INT)
        corners = data.accessor(kind.mesh.points_mm.astype("<f4"), "VEC3", _FLOAT)
        number = materials.setdefault(kind.part.material, len(materials))
        primitive = {"attributes": {"POSITION": corners}, "indices": indices, "mode": _TRIANGLES, "material": number}
        meshes.append({"name": kind.name, "extras": {}, "primitives": [primitive]})
    to_scene = _UPRIGHT @ _METRES
    nodes = [
        {"name": instance.name, "mesh": kind, "matrix": (to_scene @ instance.world).T.ravel().tolist()}
        for instance, kind in zip(product.instances, product.kinds, strict=True)
    ]
    tree = {
        "scene": 0,
        "scenes": [{"nodes": list(range(len(nodes)))}],
        "asset": {"version": "2.0", "generator": "pareto-monoped"},
        "accessors": data.accessors,
        "meshes": meshes,
        "materials": [_material(material) for material in materials],
        "nodes": nodes,
        "buffers": [{"byteLength": data.length}],
        "bufferViews": data.views,
    }
    text = json.dumps(tree, separators=(",", ":")).encode()
    return _file(text + b" " * (-len(text) % 4), b"".join(data.blocks))


class _Data:
    """The numbers of a file; equal ones are stored once.

    Attributes:
        blocks: one after the other they are the buffer.
        length: of the buffer in bytes.
        accessors, views: entries of the file's tables.
    """

    def __init__(self) -> None:
        self.blocks: list[bytes] = []
        self.length = 0
        self.accessors: list[dict[str, Any]] = []
        self.views: list[dict[str, int]] = []
        self._known: dict[tuple[str, bytes], int] = {}

    def accessor(self, rows: NDArray[Any], kind: str, component: int) -> int:
        """The number of the accessor of an array of numbers of four bytes, shape (n, 1) or (n, 3)."""
        block = rows.tobytes()
        if (kind, block) in self._known:
            return self._known[kind, block]
        number = self._known[kind, block] = len(self.accessors)
        place = {} if kind == "SCALAR" else {"byteOffset": 0}
        self.accessors.append(
            {
                "componentType": component,
                "type": kind,
                **place,
                "bufferView": number,
                "count": len(rows),
                "max": rows.max(axis=0).tolist(),
                "min": rows.min(axis=0).tolist(),
            }
        )
        self.views.append({"buffer": 0, "byteOffset": self.length, "byteLength": len(block)})
        self.blocks.append(block)
        self.length += len(block)
        return number


def _material(material: Material) -> dict[str, Any]:
    return {
        "pbrMetallicRoughness": {
            "baseColorFactor": [*(round(255 * share) / 255 for share in material.colour), 1.0],
            "roughnessFactor": 0.6,
            "metallicFactor": 0.2,
        },
        "name": material.name,
        "doubleSided": False,
    }


def _file(text: bytes, data: bytes) -> bytes:
    """Both chunks, whose lengths are multiples of four, with their headers and that of the file."""
    chunks = b"".join(_numbers(len(chunk), kind) + chunk for chunk, kind in ((text, _JSON), (data, _BINARY)))
    return _MAGIC + _numbers(_VERSION, 12 + len(chunks)) + chunks


def _numbers(*values: int) -> bytes:
    return np.array(values, dtype="<u4").tobytes()

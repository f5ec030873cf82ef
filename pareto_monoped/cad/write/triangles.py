"""STL, 3MF and GLB from the meshes, as bytes: an export checks them (``check.watertight``) before it writes them."""

import io
import zipfile

import numpy as np

from pareto_monoped.cad.product import Product
from pareto_monoped.cad.shape.meshes import Mesh

_EARLIEST = (1980, 1, 1, 0, 0, 0)  # the zip format's first date: a real one would make each export differ
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
    import trimesh  # here, because it takes longer to import than all other files to write

    scene = trimesh.Scene(base_frame="world")
    metres = np.diag([1e-3, 1e-3, 1e-3, 1.0])
    upright = np.array([[0.0, 1, 0, 0], [0, 0, 1, 0], [1, 0, 0, 0], [0, 0, 0, 1]])  # x forward, y left, z up to that
    for kind in product.unique:
        mesh = trimesh.Trimesh(kind.mesh.points_mm.astype(np.float32), kind.mesh.triangles, process=False)
        material = trimesh.visual.material.PBRMaterial(
            name=kind.part.material.name,
            baseColorFactor=[*(round(255 * c) for c in kind.part.material.colour), 255],
            metallicFactor=0.2,
            roughnessFactor=0.6,
        )
        mesh.visual = trimesh.visual.TextureVisuals(material=material)
        scene.geometry[kind.name] = mesh
    for instance, kind in product.placed():
        scene.graph.update(
            frame_from="world",
            frame_to=instance.name,
            matrix=upright @ metres @ instance.world,
            geometry=kind.name,
        )
    data = scene.export(file_type="glb")
    assert isinstance(data, bytes)
    return data

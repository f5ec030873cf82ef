"""STL, 3MF and GLB from the meshes, as bytes, and what MJCF and URDF show of a robot and what collides.

An export checks the files (``check.watertight``) before it writes them.
"""

import io
import zipfile
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.actuator.actuator import Actuator
from pareto_monoped.cad.assembly import unit_frame
from pareto_monoped.cad.product import Product
from pareto_monoped.cad.shape.meshes import Mesh, joined, mesh_of, placed
from pareto_monoped.geometry.roles import Role, Visibility

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
_STL = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("extra", "<u2")])
Floats = NDArray[np.float64]
VISUAL_TOLERANCE_MM = 0.1
METRES = 1e-3  #: From the meshes' millimetres to the models' unit.
_MARGIN_M = 1e-3


def stl(mesh: Mesh, *, scale: float = 1.0) -> bytes:
    """Return a binary STL file; in millimetres, or in metres with ``scale`` 0.001."""
    corners = (mesh.points_mm * scale)[mesh.triangles].astype("<f4")
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    length = np.linalg.norm(normal, axis=1, keepdims=True)
    rows = np.zeros(len(corners), dtype=_STL)
    rows["normal"] = normal / np.where(length > 0.0, length, 1.0)
    rows["corners"] = corners
    return b"\0" * 80 + np.uint32(len(rows)).tobytes() + rows.tobytes()


def threemf(mesh: Mesh, name: str) -> bytes:
    """Return a 3MF file (3MF core specification 1.3) of one object, in millimetres, lying on the plate."""
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
    files = {"[Content_Types].xml": _CONTENT_TYPES, "_rels/.rels": _RELATIONS, "3D/3dmodel.model": model}
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as archive:
        for path, text in files.items():
            entry = zipfile.ZipInfo(path, _EARLIEST)
            entry.compress_type = zipfile.ZIP_DEFLATED
            archive.writestr(entry, text)
    return stream.getvalue()


def glb(product: Product) -> bytes:
    """Return the assembly as binary glTF 2.0: metres, y up, front towards +z, each part's triangles stored once."""
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
        matrix = upright @ metres @ instance.world
        scene.graph.update(frame_from="world", frame_to=instance.name, matrix=matrix, geometry=kind.name)
    data = scene.export(file_type="glb")
    assert isinstance(data, bytes)
    return data


@dataclass(frozen=True, slots=True, kw_only=True)
class Visual:
    """What a body shows of one material: a mesh in the body frame, in millimetres."""

    name: str
    body: str
    mesh: Mesh
    colour: tuple[float, float, float]


@dataclass(frozen=True, slots=True, kw_only=True)
class Collider:
    """A primitive in a body frame, in metres."""

    name: str  #: unique in the robot
    body: str  #: the body that it moves with
    shape: Literal["box", "cylinder"]  #: a box, or a cylinder along y
    size: tuple[float, ...]  #: half sizes of the box along x, y and z; radius and half length of the cylinder
    position: tuple[float, float, float]  #: of its centre


def visuals(product: Product) -> tuple[Visual, ...]:
    """Return coarse meshes of what can be seen, one per body and material, at zero joint angles."""
    shown: dict[tuple[str, str], list[tuple[Mesh, Floats]]] = {}
    colours: dict[tuple[str, str], tuple[float, float, float]] = {}
    for instance, unique in product.placed():
        if instance.part.visibility is not Visibility.OUTSIDE:
            continue
        key = (instance.body, unique.part.material.name.replace(" ", "_"))
        shown.setdefault(key, []).append((mesh_of(unique.part, VISUAL_TOLERANCE_MM), instance.in_body))
        colours.setdefault(key, unique.part.material.colour)
    return tuple(
        Visual(name=f"{body}_{material}", body=body, mesh=joined(members, METRES), colour=colours[body, material])
        for (body, material), members in shown.items()
    )


def colliders(product: Product) -> tuple[Collider, ...]:
    """Return boxes and cylinders around frame, actuators and links; the foot's sphere is the simulation's own."""
    robot = product.robot
    # Rods, with the screws that stand out of the cheeks, bound the frame; cores bound the links.
    return (
        _around_actuator(product, "hip_actuator", robot.hip),
        _around_actuator(product, "knee_actuator", robot.knee),
        _around_parts(product, "frame", unit="base_frame", roles=(Role.ROD, Role.SCREW)),
        _around_parts(product, "thigh", unit="thigh", roles=(Role.CORE,)),
        _around_parts(product, "shank", unit="shank", roles=(Role.CORE,)),
    )


def _around_actuator(product: Product, name: str, actuator: Actuator) -> Collider:
    unit = next(unit for unit in product.robot.units if unit.name == name)
    middle = unit_frame(unit) @ np.array([0.0, 0.0, -0.5 * actuator.length_mm, 1.0])
    return Collider(
        name=name,
        body=unit.body,
        shape="cylinder",
        size=(1e-3 * actuator.mount.housing_radius_mm, 0.5e-3 * actuator.length_mm),
        position=(0.0, float(1e-3 * middle[1]), 0.0),
    )


def _around_parts(product: Product, name: str, *, unit: str, roles: tuple[Role, ...]) -> Collider:
    """Return a box with a margin around those parts of a unit that can be seen and have one of the roles."""
    bodies = set()
    low, high = np.full(3, np.inf), np.full(3, -np.inf)
    for instance, unique in product.placed():
        part = instance.part
        if instance.unit == unit and part.role in roles and part.visibility is Visibility.OUTSIDE:
            bodies.add(instance.body)
            box = np.asarray(placed(unique.mesh.body, instance.in_body).bounding_box())
            low, high = np.minimum(low, box[:3]), np.maximum(high, box[3:])
    (body,) = bodies
    half, centre = (tuple(float(v) for v in row) for row in (0.5e-3 * (high - low) + _MARGIN_M, 0.5e-3 * (high + low)))
    return Collider(name=name, body=body, shape="box", size=half, position=(centre[0], centre[1], centre[2]))


def numbers(*values: float) -> str:
    """Return values as an XML attribute, each with all its digits."""
    return " ".join(repr(float(value)) for value in values)

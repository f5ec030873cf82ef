"""A small solver for plane strain with six-node triangles, and the root stress of a tooth that it finds.

An outline is a closed chain of pieces. Each piece is an array of points in mm and starts where the one before it ends.
The ends of pieces become nodes. Between them, nodes lie on the outline as densely as a size function asks; so do the
middle nodes of curved edges. Inner nodes start at the centres of a quadtree's cells and are then smoothed.
Forces are per unit of face width, in N/mm.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely

from tests.lazily import Lazily

sparse, linalg, spatial = Lazily("scipy.sparse"), Lazily("scipy.sparse.linalg"), Lazily("scipy.spatial")

YOUNG_MPA, POISSON = 206000.0, 0.3

Array = np.ndarray[Any, np.dtype[Any]]
_SMOOTHINGS = 8
_NEAR_EDGE = 0.7
"""Inner nodes start at least this many sizes away from the nodes of the outline."""
_AT = np.array([[1.0, 1.0], [4.0, 1.0], [1.0, 4.0]]) / 6.0
"""Gauss points of a triangle; their weights are equal."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Mesh:
    """A plate divided into triangles."""

    nodes_mm: Array  # shape (n, 2)
    elements: Array  # shape (e, 6): corners, then the middles of sides 01, 12, 20
    edges: tuple[Array, ...]  # of each piece of the outline, shape (k, 3): start, middle, end


def _placed(piece_mm: Array, size_mm: Callable[[Array], Array]) -> Array:
    """Return corner and middle nodes alternately along a piece, whose distances follow the size."""
    along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(piece_mm, axis=0).T))])
    fine = np.linspace(0.0, along[-1], 2001)
    points = np.stack([np.interp(fine, along, x) for x in piece_mm.T], axis=1)
    density = 1.0 / size_mm(points)
    counted = np.concatenate([[0.0], np.cumsum(0.5 * (density[1:] + density[:-1]) * np.diff(fine))])
    wanted = np.linspace(0.0, counted[-1], 2 * max(int(np.ceil(counted[-1])), 1) + 1)
    return np.stack([np.interp(wanted, counted, x) for x in points.T], axis=1)


def _scattered(polygon: shapely.Polygon, size_mm: Callable[[Array], Array]) -> Array:
    """Return the centres of a quadtree's cells inside a polygon, cells as large as the size asks."""
    low_x, low_y, high_x, high_y = polygon.bounds
    side = max(high_x - low_x, high_y - low_y)
    # An odd proportion keeps cells off the lines of symmetry, where outlines like to lie.
    cells, found = np.array([[low_x + 0.487 * side, low_y + 0.491 * side]]), []
    side *= 1.07
    while len(cells):
        large = side > size_mm(cells)
        found.append(cells[~large])
        side *= 0.5
        steps = 0.5 * side * np.array([[-1, -1], [1, -1], [-1, 1], [1, 1]])
        cells = (cells[large][:, None] + steps).reshape(-1, 2)
    points = np.concatenate(found)
    return points[shapely.contains_xy(polygon, points)]


def _triangles(polygon: shapely.Polygon, points: Array) -> Array:
    """Return Delaunay's triangles inside a polygon, counterclockwise."""
    corners = spatial.Delaunay(points).simplices
    a, b, c = (points[corners[:, i]] for i in range(3))
    area = 0.5 * ((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0])
    corners[area < 0.0] = corners[area < 0.0][:, ::-1]
    longest = np.maximum.reduce([np.sum((p - q) ** 2, axis=1) for p, q in ((a, b), (b, c), (c, a))])
    kept = (np.abs(area) > 1e-3 * longest) & shapely.contains_xy(polygon, (a + b + c) / 3.0)
    return corners[kept]


def mesh_of(pieces_mm: Sequence[Array], size_mm: Callable[[Array], Array]) -> Mesh:
    """Divide the inside of a closed outline; ``size_mm`` gives the sides of triangles at points of shape (n, 2)."""
    placed = [_placed(np.asarray(piece, dtype=float), size_mm) for piece in pieces_mm]
    outline = np.concatenate([piece[:-1:2] for piece in placed])
    count, polygon = len(outline), shapely.Polygon(outline)
    inner = _scattered(polygon, size_mm)
    inner = inner[spatial.cKDTree(outline).query(inner)[0] > _NEAR_EDGE * size_mm(inner)]
    points = np.concatenate([outline, inner])
    for _ in range(_SMOOTHINGS):
        corners = _triangles(polygon, points)
        ends = np.concatenate([corners[:, [0, 1]], corners[:, [1, 2]], corners[:, [2, 0]]])
        total, degree = np.zeros_like(points), np.bincount(ends[:, 0], minlength=len(points))
        np.add.at(total, ends[:, 0], points[ends[:, 1]])
        points[count:] = total[count:] / degree[count:, None]
    corners = _triangles(polygon, points)
    ends = np.sort(np.concatenate([corners[:, [0, 1]], corners[:, [1, 2]], corners[:, [2, 0]]]), axis=1)
    sides, which = np.unique(ends, axis=0, return_inverse=True)
    middles = points[sides].mean(axis=1)
    elements = np.concatenate([corners, len(points) + which.reshape(3, -1).T], axis=1)
    number = {tuple(side): len(points) + i for i, side in enumerate(sides.tolist())}
    edges, start = [], 0
    for piece in placed:
        ring = (start + np.arange(len(piece) // 2 + 1)) % count
        middle = np.array(
            [number[min(a, b), max(a, b)] for a, b in zip(ring[:-1].tolist(), ring[1:].tolist(), strict=True)]
        )
        middles[middle - len(points)] = piece[1::2]
        edges.append(np.stack([ring[:-1], middle, ring[1:]], axis=1))
        start += len(piece) // 2
    return Mesh(nodes_mm=np.concatenate([points, middles]), elements=elements, edges=tuple(edges))


def _slopes(xi: float, eta: float) -> Array:
    """Return the derivatives of the six shape functions by the triangle's own coordinates, shape (2, 6)."""
    zeta = 1.0 - xi - eta
    return np.array(
        [
            [1 - 4 * zeta, 4 * xi - 1, 0.0, 4 * (zeta - xi), 4 * eta, -4 * eta],
            [1 - 4 * zeta, 0.0, 4 * eta - 1, -4 * xi, 4 * xi, 4 * (zeta - eta)],
        ]
    )


def _stiffness(mesh: Mesh) -> Any:
    """Assemble the plate's stiffness in N/mm per mm of width; the displacements of node n are 2n and 2n + 1."""
    scale = YOUNG_MPA / ((1.0 + POISSON) * (1.0 - 2.0 * POISSON))
    law = scale * np.array([[1.0 - POISSON, POISSON, 0.0], [POISSON, 1.0 - POISSON, 0.0], [0.0, 0.0, 0.5 - POISSON]])
    count = len(mesh.elements)
    stiffness = np.zeros((count, 12, 12))
    for xi, eta in _AT:
        jacobian = _slopes(xi, eta) @ mesh.nodes_mm[mesh.elements]
        determinant = np.linalg.det(jacobian)
        assert determinant.min() > 0.0, "a triangle is turned inside out"
        slopes = np.linalg.solve(jacobian, np.broadcast_to(_slopes(xi, eta), (count, 2, 6)))
        strain = np.zeros((count, 3, 12))
        strain[:, 0, 0::2] = strain[:, 2, 1::2] = slopes[:, 0]
        strain[:, 1, 1::2] = strain[:, 2, 0::2] = slopes[:, 1]
        stiffness += (determinant / 6.0)[:, None, None] * (strain.transpose(0, 2, 1) @ law @ strain)
    places = np.stack([2 * mesh.elements, 2 * mesh.elements + 1], axis=2).reshape(count, 12)
    rows, columns = np.repeat(places, 12, axis=1), np.tile(places, (1, 12))
    size = 2 * len(mesh.nodes_mm)
    return sparse.csc_matrix((stiffness.ravel(), (rows.ravel(), columns.ravel())), shape=(size, size))


def displaced_mm(mesh: Mesh, forces: Array, held: Array, held_mm: Array | float = 0.0) -> Array:
    """Return the displacements of all nodes under forces on nodes, both of shape (n, 2, cases).

    Nodes ``held`` are displaced by ``held_mm``: one number, or an array of shape (nodes held, 2).
    """
    stiffness = _stiffness(mesh)
    moved = np.zeros((2 * len(mesh.nodes_mm), forces.shape[2]))
    fixed = np.stack([2 * held, 2 * held + 1], axis=1).ravel()
    moved[fixed] = np.broadcast_to(held_mm, (len(held), 2)).reshape(-1, 1)
    free = np.setdiff1d(np.arange(len(moved)), fixed)
    load = forces.reshape(moved.shape) - stiffness @ moved
    reduced = stiffness[free][:, free]
    factors = linalg.splu(reduced, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
    moved[free] = factors.solve(load[free])
    return moved.reshape(forces.shape)


def edge_forces(mesh: Mesh, piece: int, traction_mpa: Callable[[Array], Array]) -> Array:
    """Return the nodal forces, shape (n, 2, 1), of a traction that is linear along a straight piece of the outline."""
    forces = np.zeros((*mesh.nodes_mm.shape, 1))
    start, middle, end = (mesh.nodes_mm[mesh.edges[piece][:, i]] for i in range(3))
    length = np.hypot(*(end - start).T)[:, None]
    for node, at, share in ((0, start, 1.0), (1, middle, 4.0), (2, end, 1.0)):
        np.add.at(forces[:, :, 0], mesh.edges[piece][:, node], share / 6.0 * length * traction_mpa(at))
    return forces


def edge_stress_mpa(mesh: Mesh, moved_mm: Array, piece: int) -> tuple[Array, Array, Array]:
    """Return places and tangents, shape (k, 2), and the stress, shape (k, cases), along a piece that carries no load.

    That stress is the principal one, and follows from the strain along the edge alone. It is taken at the two Gauss
    points of each edge, where the derivative of a quadratic is most exact.
    """
    nodes = mesh.edges[piece]
    found: list[tuple[Array, ...]] = []
    for xi in (-np.sqrt(1.0 / 3.0), np.sqrt(1.0 / 3.0)):
        shapes = np.array([0.5 * xi * (xi - 1.0), 1.0 - xi**2, 0.5 * xi * (xi + 1.0)])
        slopes = np.array([xi - 0.5, -2.0 * xi, xi + 0.5])
        along = np.einsum("i,kij->kj", slopes, mesh.nodes_mm[nodes])
        strain = np.einsum("i,kijc,kj->kc", slopes, moved_mm[nodes], along) / np.sum(along**2, axis=1)[:, None]
        places = np.einsum("i,kij->kj", shapes, mesh.nodes_mm[nodes])
        found.append((places, along / np.hypot(*along.T)[:, None], YOUNG_MPA / (1.0 - POISSON**2) * strain))
    places, tangents, stress = (np.stack(x, axis=1).reshape(-1, x[0].shape[1]) for x in zip(*found, strict=True))
    return places, tangents, stress


def _turned(points: Array, angle: float) -> Array:
    """Turn points clockwise about the origin."""
    cos, sin = np.cos(angle), np.sin(angle)
    return points @ np.array([[cos, -sin], [sin, cos]])


def _outline(
    space: Array, pitch: float, *, rim_mm: float, load_mm: float, beside: int
) -> tuple[list[Array], int, range]:
    """Return the pieces of an outline, the number of the loaded root, and the numbers of the clamped pieces.

    The tooth stands on the y axis, with ``beside`` more on each side. The loaded root begins at the loaded point, on
    the right flank.
    """
    low = np.flatnonzero(space[:, 0] < 0.0)[-1] + 1
    part = space[low - 1, 0] / (space[low - 1, 0] - space[low, 0])
    bottom = (1.0 - part) * space[low - 1] + part * space[low]
    left, right = np.vstack([space[:low], bottom]), np.vstack([bottom, space[low:]])
    radii = np.hypot(*left.T)
    at = np.flatnonzero((radii[:-1] - load_mm) * (radii[1:] - load_mm) <= 0.0)[0]
    part = (load_mm - radii[at]) / (radii[at + 1] - radii[at])
    point = (1.0 - part) * left[at] + part * left[at + 1]
    halves = [np.vstack([left[: at + 1], point]), np.vstack([point, left[at + 1 :]])]
    pieces, root = [], 0
    for number in range(-beside - 1, beside + 1):
        new = [*(halves if number == 0 else [left]), right]
        new = new[1:] if number == -beside - 1 else new[:-1] if number == beside else new
        new = [_turned(piece, (number + 0.5) * pitch) for piece in new]
        pieces += [np.stack([pieces[-1][-1], new[0][0]])] if pieces else []
        root = len(pieces) + 1 if number == 0 else root
        pieces += new
    ends = np.linspace(1.0, -1.0, 400) * (beside + 0.5) * pitch
    rim = rim_mm * np.stack([np.sin(ends), np.cos(ends)], axis=1)
    held = range(len(pieces), len(pieces) + 3)
    pieces += [np.stack([pieces[-1][-1], rim[0]]), rim, np.stack([rim[-1], pieces[0][0]])]
    return pieces, root, held


@dataclass(frozen=True, slots=True)
class RootStress:
    """Stress in the tensile root of a tooth under 1 N/mm."""

    greatest_mpa: float
    bent_mpa: float  # without the force's component along the tooth
    tangent_deg: float  # of the place of the greatest, from the middle of the tooth


def root_stress(
    space: Array,
    *,
    teeth: int,
    module_mm: float,
    base_mm: float,
    load_mm: float,
    internal: bool,
    per_fillet: int = 12,
    rim: float = 4.0,
    beside: int = 1,
) -> RootStress:
    """Return the root stress of a tooth on whose flank a force of 1 N/mm acts along a tangent to the base circle.

    ``space`` is the edge of the space around the y axis from left to right, from tip to tip, shape (n, 2). The rim is
    ``rim`` modules thick and clamped at its back and at its ends. Triangles have sides of 0.38 modules over
    ``per_fillet`` in the loaded root and grow with the distance from there.
    """
    sign = 1.0 if internal else -1.0
    radii = np.hypot(*space.T)
    root_mm = radii.max() if internal else radii.min()
    pieces, root, held = _outline(
        space, 2.0 * np.pi / teeth, rim_mm=root_mm + sign * rim * module_mm, load_mm=load_mm, beside=beside
    )
    near = spatial.cKDTree(pieces[root][np.abs(np.hypot(*pieces[root].T) - root_mm) < 0.9 * module_mm])
    mesh = mesh_of(
        pieces,
        lambda points: np.minimum(0.38 * module_mm / per_fillet + 0.3 * near.query(points)[0], 0.3 * module_mm),
    )
    node, top = mesh.edges[root][0, 0], mesh.edges[root - 2]
    middle = top.ravel()[np.abs(mesh.nodes_mm[top.ravel(), 0]).argmin()]
    assert abs(mesh.nodes_mm[middle, 0]) < 1e-6 * module_mm
    # The force pushes to the left, along a line that touches the base circle: an external tooth down, a ring's up.
    radial = mesh.nodes_mm[node] / load_mm
    touch = base_mm / load_mm
    force = touch * np.array([-radial[1], radial[0]]) + sign * np.sqrt(1.0 - touch**2) * radial
    forces = np.zeros((*mesh.nodes_mm.shape, 2))
    forces[node] = force[:, None]
    forces[middle, 1, 1] -= force[1]
    clamped = np.unique(np.concatenate([mesh.edges[piece].ravel() for piece in held]))
    _, tangents, stress = edge_stress_mpa(mesh, displaced_mm(mesh, forces, clamped), root)
    place = tangents[stress[:, 0].argmax()]
    return RootStress(*stress.max(axis=0).tolist(), float(np.degrees(np.arctan2(*np.abs(place)))))

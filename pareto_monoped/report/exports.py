"""Exported designs -> triangles for the page's 3D view, coarse enough to travel in it."""

import base64
import re
from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.errors import OutputError
from pareto_monoped.report.records import Model3D
from pareto_monoped.study.reader import StudyData

MOST_TRIANGLES = 45_000
"""Of all models on a page together: about 1.3 MB."""
_STEP_MM = 0.25  # corners are rounded to this; it grows until few enough triangles are left
_GREY = (170, 176, 184)
_FOLDER = re.compile(r"^trial_(\d+)$")


def read_models(folder: Path, data: StudyData) -> Mapping[int, Model3D]:
    """The exported designs of a study: folders ``trial_N`` with a GLB file, for trials that the study has.

    Raises:
        OutputError: the folder does not exist.
    """
    if not folder.is_dir():
        raise OutputError(f"exports folder {str(folder)!r}: does not exist; give the folder that holds trial_N folders")
    known = set(data.trials["trial"].astype(int))
    found = {}
    for path in sorted(folder.iterdir()):
        match = _FOLDER.match(path.name)
        files = sorted(path.glob("*.glb")) if match else []
        if match and files and int(match[1]) in known:
            found[int(match[1])] = files[0]
    share = MOST_TRIANGLES // max(len(found), 1)
    return {trial: read_glb(path, share) for trial, path in found.items()}


def read_glb(path: Path, most: int = MOST_TRIANGLES) -> Model3D:
    """Triangles of a GLB file with their colours, at most ``most`` of them."""
    import trimesh

    scene = trimesh.load_scene(path)
    corners, colours = [], []
    for name in scene.graph.nodes_geometry:
        transform, geometry = scene.graph[name]
        mesh = scene.geometry[geometry]
        if not isinstance(mesh, trimesh.Trimesh) or len(mesh.faces) == 0:
            continue
        points = mesh.vertices @ transform[:3, :3].T + transform[:3, 3]
        corners.append(points[mesh.faces])
        colours.append(np.tile(_colour(mesh), (len(mesh.faces), 1)))
    if not corners:
        return _model(np.zeros((0, 3, 3), dtype=np.int64), np.zeros((0, 3), dtype=np.uint8), _STEP_MM, simplified=False)
    # GLB has y up and metres; the page's world has z up.
    triangles = 1000.0 * np.concatenate(corners)[..., [2, 0, 1]]
    return simplified(triangles, np.concatenate(colours), most)


def simplified(triangles_mm: NDArray[np.float64], colours: NDArray[np.uint8], most: int) -> Model3D:
    """Corners rounded to a grid, flat triangles dropped; the grid doubles until at most ``most`` are left.

    Clustering of vertices (Rossignac and Borrel 1993): crude, but it keeps shape and size to within the grid.

    Args:
        triangles_mm: shape (n, 3, 3).
        colours: of each triangle, shape (n, 3), 0 to 255.
        most: triangles that may be left.
    """
    step = _STEP_MM
    while True:
        grid = np.round(triangles_mm / step).astype(np.int64)
        a, b, c = grid[:, 0], grid[:, 1], grid[:, 2]
        solid = (a != b).any(axis=1) & (b != c).any(axis=1) & (c != a).any(axis=1)
        order = np.sort(grid[solid] @ np.array([1, 1 << 20, 1 << 40]), axis=1)
        _, first = np.unique(order, axis=0, return_index=True)
        first.sort()
        small = np.abs(grid).max(initial=0) < 2**15
        if len(first) <= most and small:
            return _model(grid[solid][first], colours[solid][first], step, simplified=len(first) < len(triangles_mm))
        step *= 1.5


def _model(grid: NDArray[np.int64], colours: NDArray[np.uint8], step: float, *, simplified: bool) -> Model3D:
    return Model3D(
        step_mm=step,
        triangles=len(grid),
        positions=base64.b64encode(grid.astype("<i2").tobytes()).decode("ascii"),
        colours=base64.b64encode(colours.astype(np.uint8).tobytes()).decode("ascii"),
        simplified=simplified,
        note=f"Rounded to {step:.2g} mm for this page; the exported files are exact." if simplified else "",
    )


def _colour(mesh: object) -> tuple[int, int, int]:
    material = getattr(getattr(mesh, "visual", None), "material", None)
    base = getattr(material, "baseColorFactor", None)
    if base is None:
        return _GREY
    values = np.asarray(base, dtype=np.float64)[:3]
    if values.max(initial=0.0) <= 1.0:
        values = 255.0 * values
    red, green, blue = values.round().astype(int).tolist()
    return red, green, blue

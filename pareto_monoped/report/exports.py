"""Exported designs -> triangles for the page's 3D view, few enough for the page to carry."""

import base64
import re
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.cad.jobs import trial_job
from pareto_monoped.cad.records import is_made
from pareto_monoped.cad.write.folder import RECORD
from pareto_monoped.errors import OutputError
from pareto_monoped.report.schema import Model3D
from pareto_monoped.storage.reader import StudyData

Floats = NDArray[np.float64]

MOST_TRIANGLES = 60_000  #: Triangles of all models of a study together; they take about 1.7 MB of the page.
_LEAST = 24  # triangles that even the smallest body keeps
_FINEST_MM = 0.1
_GREY = (170, 176, 184)
_MODEL = "assembly.glb"
_FOLDER = re.compile(r"^trial_(\d+)$")


def read_models(
    folder: Path, studies: Sequence[StudyData], *, note: Callable[[str], None] = lambda _: None
) -> list[Mapping[int, Model3D]]:
    """Return the exported designs of some studies, from folders ``trial_N``: per study, models by trial.

    A folder counts for a study if it is an up-to-date export of its trial N, in any pose, or has a GLB file but no
    record. ``note`` is called with a line of text for each export that is left out.

    Raises:
        OutputError: the folder does not exist.
    """
    if not folder.is_dir():
        raise OutputError(f"exports folder {str(folder)!r}: does not exist; give the folder that holds trial_N folders")
    exported = {
        int(match[1]): path
        for path in sorted(folder.iterdir())
        if (match := _FOLDER.match(path.name)) and (path / _MODEL).is_file()
    }
    found = [[trial for trial, path in exported.items() if _is_export(path, data, trial)] for data in studies]
    for trial in sorted(exported.keys() - {trial for trials in found for trial in trials}):
        note(
            f"{str(exported[trial])!r} is left out: it is not an up-to-date export of trial {trial} of this study; "
            "export it again with --force"
        )
    shares = [MOST_TRIANGLES // len(trials) if trials else 0 for trials in found]
    return [{k: read_glb(exported[k] / _MODEL, share) for k in one} for one, share in zip(found, shares, strict=True)]


def _is_export(folder: Path, data: StudyData, trial: int) -> bool:
    """Return whether a folder holds an up-to-date export of a trial; a GLB file without a record is taken for one."""
    if not (data.trials["trial"] == trial).any():
        return False
    if not (folder / RECORD).exists():
        return True
    return is_made(trial_job(data, trial, folder=folder, formats=["glb"]), any_pose=True)


def read_glb(path: Path, most: int = MOST_TRIANGLES) -> Model3D:
    """Return the triangles of a GLB file with their colours, at most about ``most``."""
    import trimesh

    scene = trimesh.load_scene(path)
    bodies = []
    for name in scene.graph.nodes_geometry:
        transform, geometry = scene.graph[name]
        mesh = scene.geometry[geometry]
        if isinstance(mesh, trimesh.Trimesh) and len(mesh.faces):
            points = mesh.vertices @ transform[:3, :3].T + transform[:3, 3]
            # GLB files are in metres with y up; the page has millimetres and z up.
            bodies.append((1000.0 * points[mesh.faces][..., [2, 0, 1]], _colour(mesh)))
    return model_of(bodies, most)


def model_of(bodies: Sequence[tuple[Floats, tuple[int, int, int]]], most: int) -> Model3D:
    """Return a model of bodies (corners in mm, shape (n, 3, 3), colour), each coarse enough for its share of ``most``.

    Large bodies get larger shares; there are more triangles if so many bodies have only their least number.
    """
    sizes = [float(np.linalg.norm(np.ptp(corners.reshape(-1, 3), axis=0))) for corners, _ in bodies]
    most_of = [max(int(most * size / sum(sizes)), _LEAST) for size in sizes]
    reduced = [coarser(corners, share) for (corners, _), share in zip(bodies, most_of, strict=True)]
    before = sum(len(corners) for corners, _ in bodies)
    triangles = np.concatenate([np.zeros((0, 3, 3)), *reduced])
    colours = [np.tile(colour, (len(left), 1)) for left, (_, colour) in zip(reduced, bodies, strict=True)]
    step = max(float(np.abs(triangles).max(initial=0.0)) / 32000.0, 1e-3)
    smaller = len(triangles) < before
    return Model3D(
        step_mm=step,
        triangles=len(triangles),
        positions=_base64(np.round(triangles / step).astype("<i2")),
        colours=_base64(np.concatenate([np.zeros((0, 3)), *colours]).astype(np.uint8)),
        simplified=smaller,
        note="Small parts are coarser here than in the exported files." if smaller else "",
    )


def coarser(triangles_mm: Floats, most: int) -> Floats:
    """Return at most ``most`` triangles of about the same shape; the corners in mm have the shape (n, 3, 3).

    Corners are rounded to a grid, and triangles that become flat or equal are dropped; the grid is widened until few
    enough are left. This is vertex clustering (Rossignac and Borrel 1993): crude, but off by no more than the grid.
    """
    if len(triangles_mm) <= most:
        return triangles_mm
    middle = triangles_mm.reshape(-1, 3).mean(axis=0)
    step = _FINEST_MM
    while True:
        grid = np.round((triangles_mm - middle) / step).astype(np.int64)
        # Each corner as one number; the sorted three identify a triangle.
        corners = np.sort(grid @ np.array([1, 1 << 20, 1 << 40]), axis=1)
        solid = np.flatnonzero((corners[:, 0] != corners[:, 1]) & (corners[:, 1] != corners[:, 2]))
        order = solid[np.lexsort(corners[solid].T)]
        new = np.ones(len(order), dtype=bool)
        new[1:] = (corners[order[1:]] != corners[order[:-1]]).any(axis=1)
        kept = np.sort(order[new])
        if len(kept) <= most:
            return np.asarray(grid[kept] * step + middle)
        step *= 1.25


def _base64(values: NDArray[Any]) -> str:
    return base64.b64encode(values.tobytes()).decode("ascii")


def _colour(mesh: object) -> tuple[int, int, int]:
    """Return the base colour of a mesh, grey if it has none."""
    material = getattr(getattr(mesh, "visual", None), "material", None)
    base = getattr(material, "baseColorFactor", None)
    if base is None:
        return _GREY
    values = np.asarray(base, dtype=np.float64)[:3]
    if values.max(initial=0.0) <= 1.0:
        values = 255.0 * values
    red, green, blue = values.round().astype(int).tolist()
    return red, green, blue

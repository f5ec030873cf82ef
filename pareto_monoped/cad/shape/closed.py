"""Is a mesh closed for the program that reads its file?

An STL file has no shared points. Its reader merges the corners of triangles that stand at the same place, after they
were rounded to single precision. A mesh that is closed in memory may therefore be open in its file: close points merge
and leave triangles without area, and parts that touch get edges that border four triangles.
"""

import numpy as np
from numpy.typing import NDArray

MERGED = 1e-8
"""Corners are merged when their coordinates are equal after rounding to this, in the file's unit (as in trimesh)."""
# Odd numbers without pattern (digits of pi, e and the golden section), for sums modulo 2^64 that tell places apart: two
# of a million places get the same number with a probability of 3e-8.
_PLACE = np.array([0x243F6A8885A308D3, 0xB7E151628AED2A6B, 0x9E3779B97F4A7C15], dtype=np.uint64)
_START, _END = np.uint64(0x13198A2E03707345), np.uint64(0xBF7158809CF4F3C7)

Numbers = NDArray[np.uint64]


def place_numbers(points: NDArray[np.floating]) -> Numbers:
    """A number for each point, equal for the points that a reader merges.

    Args:
        points: in the file's unit, shape (..., 3).
    """
    rounded = np.rint(points.astype(np.float32).astype(np.float64) / MERGED).astype(np.int64).view(np.uint64)
    x, y, z = np.moveaxis(rounded, -1, 0)
    numbers: Numbers = x * _PLACE[0] + y * _PLACE[1] + z * _PLACE[2]
    return numbers


def edge_numbers(start: Numbers, end: Numbers) -> Numbers:
    """A number for each directed edge, from the numbers of its ends."""
    numbers: Numbers = start * _START + end * _END
    return numbers


def flaws(corners: NDArray[np.floating]) -> str:
    """What keeps triangles from enclosing a volume, in words; empty if nothing does.

    Every edge must border two triangles, which run along it in opposite directions.

    Args:
        corners: of the triangles, as they are in the file, shape (n, 3, 3).
    """
    here = place_numbers(corners)
    following = here[:, [1, 2, 0]]
    flat = int(np.any(here == following, axis=1).sum())
    if flat:
        return f"{flat} triangles have no area"
    there, back = edge_numbers(here, following).ravel(), edge_numbers(following, here).ravel()
    there.sort()
    back.sort()
    if np.all(there[1:] != there[:-1]) and np.array_equal(there, back):
        return ""
    edges, counts = np.unique(there, return_counts=True)
    opposite, counts_opposite = np.unique(back, return_counts=True)
    sound = np.intersect1d(edges[counts == 1], opposite[counts_opposite == 1], assume_unique=True)
    return f"{len(edges) - len(sound)} edges do not border two triangles"


def volume(corners: NDArray[np.floating]) -> float:
    """Volume that closed triangles enclose, in the cube of the file's unit."""
    a, b, c = np.moveaxis(corners.astype(np.float64), 1, 0)
    return float(np.sum(a * np.cross(b, c)) / 6.0)

"""Every mesh is closed when it is read back from its file, and encloses the volume of its part."""

from collections.abc import Mapping

from pareto_monoped.cad.check.limits import MESH_VOLUME, WATERTIGHT
from pareto_monoped.cad.check.read_back import Corners, meshes_of, read_stl
from pareto_monoped.cad.check.result import Check, Finding, count_of, worst_of
from pareto_monoped.cad.product import Product
from pareto_monoped.cad.shape.closed import flaws, volume


def check(product: Product, part_files: Mapping[str, bytes], other_files: Mapping[str, bytes]) -> tuple[Check, Check]:
    """Look at the meshes in the files of an export.

    Args:
        product: the parts.
        part_files: the STL file of every unique part, whether it is to be written or not, by the part's name.
        other_files: further STL, 3MF and GLB files by their paths.
    """
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
    """A sentence for every mesh that is not closed."""
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

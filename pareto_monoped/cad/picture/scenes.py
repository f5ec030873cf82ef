"""The pictures of an export: the assembly, and an actuator cut along its axis with a legend."""

import colorsys
from collections.abc import Sequence
from dataclasses import dataclass

import manifold3d as m3
import numpy as np
from numpy.typing import NDArray

from pareto_monoped.cad.assembly import unit_frame
from pareto_monoped.cad.picture.drawing import Body, View, draw
from pareto_monoped.cad.product import Product
from pareto_monoped.cad.shape.meshes import mesh_from, placed
from pareto_monoped.geometry.roles import Visibility

Image = NDArray[np.uint8]

_FROM_THE_RIGHT = View(towards=(-0.55, 1.0, -0.32))
"""From the side of the knee actuator, from in front and above."""
_ALONG_X = View(towards=(-0.35, 1.0, -0.22), up=(0.0, 0.0, 1.0))


@dataclass(frozen=True, slots=True, kw_only=True)
class Scene:
    """All that a picture is drawn from; it refers to nothing of the product, so another thread can draw it.

    Attributes:
        bodies: what to draw.
        view: the direction of view.
        width, height: of the picture, in pixels, without the legend.
        legend: name, count and colour, one row per part.
    """

    bodies: tuple[Body, ...]
    view: View
    width: int
    height: int
    legend: tuple[tuple[str, int, tuple[float, float, float]], ...] = ()

    def picture(self) -> Image:
        """Draw it."""
        image = draw(self.bodies, self.view, width=self.width, height=self.height)
        return np.concatenate([image, _legend(self.legend, 300, self.height)], axis=1) if self.legend else image


def assembly_scene(product: Product, *, width: int = 900, height: int = 1080) -> Scene:
    """The robot in its pose."""
    bodies = []
    for instance, unique in product.placed():
        if instance.part.visibility is Visibility.INSIDE:
            continue
        points = unique.mesh.points_mm @ instance.world[:3, :3].T + instance.world[:3, 3]
        bodies.append(Body(points_mm=points, triangles=unique.mesh.triangles, colour=unique.part.material.colour))
    return Scene(bodies=tuple(bodies), view=_FROM_THE_RIGHT, width=width, height=height)


def section_scene(product: Product, unit_name: str, *, width: int = 1000, height: int = 820) -> Scene:
    """An actuator with a quarter cut away, its output to the left, each part in its own colour."""
    unit = next(unit for unit in product.robot.units if unit.name == unit_name)
    upright = _to_section_frame() @ np.linalg.inv(unit_frame(unit))
    parts: dict[str, list[m3.Manifold]] = {}
    for instance, unique in product.placed():
        if instance.unit == unit_name:
            parts.setdefault(instance.part.name, []).append(placed(unique.mesh.body, upright @ instance.in_body))
    bodies, legend = [], []
    for k, (name, members) in enumerate(parts.items()):
        colour = _colour(k, len(parts))
        legend.append((name, len(members), colour))
        for member in members:
            kept = _without_quarter(member)
            if kept.is_empty():
                continue
            mesh = mesh_from(kept)
            bodies.append(Body(points_mm=mesh.points_mm, triangles=mesh.triangles, colour=colour))
    return Scene(bodies=tuple(bodies), view=_ALONG_X, width=width, height=height, legend=tuple(legend))


def _to_section_frame() -> NDArray[np.float64]:
    """The actuator's axis along -x of the picture's scene, output to the left; the first planet on top."""
    matrix = np.zeros((4, 4))
    matrix[0, 2], matrix[1, 1], matrix[2, 0], matrix[3, 3] = -1.0, 1.0, 1.0, 1.0
    return matrix


def _without_quarter(body: m3.Manifold) -> m3.Manifold:
    """The body without the quarter that lies towards the viewer and above the axis."""
    far = body.trim_by_plane((0.0, 1.0, 0.0), 0.0)
    near_low = body.trim_by_plane((0.0, -1.0, 0.0), 0.0).trim_by_plane((0.0, 0.0, -1.0), 0.0)
    return m3.Manifold.compose([far, near_low])


def _colour(k: int, count: int) -> tuple[float, float, float]:
    """The k-th of ``count`` colours; neighbours in the list differ clearly."""
    hue = (k * 0.381966) % 1.0  # golden section
    return colorsys.hsv_to_rgb(hue, 0.34 if k % 2 else 0.52, 0.95 if k % 3 else 0.80)


def _legend(rows: Sequence[tuple[str, int, tuple[float, float, float]]], width: int, height: int) -> Image:
    from PIL import Image as Pillow
    from PIL import ImageDraw, ImageFont

    canvas = Pillow.new("RGB", (width, height), "white")
    pen = ImageDraw.Draw(canvas)
    step = min(34, (height - 40) // max(len(rows), 1))
    font = ImageFont.load_default(size=0.5 * step + 3)
    for k, (name, count, colour) in enumerate(rows):
        top = 20 + k * step
        pen.rectangle(
            (10, top + 4, 10 + step - 10, top + step - 6), fill=tuple(round(255 * c) for c in colour), outline="black"
        )
        label = name.replace("_", " ") + (f" ({count})" if count > 1 else "")
        pen.text((step + 12, top + 0.12 * step), label, fill="black", font=font)
    return np.asarray(canvas, dtype=np.uint8)

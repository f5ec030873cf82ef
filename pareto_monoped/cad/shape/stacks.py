"""Other prisms for the same part, chosen so that uniting them is cheap."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from pareto_monoped.geometry.features import Bevel
from pareto_monoped.geometry.gears import ExternalGear, InternalGear
from pareto_monoped.geometry.parts import Prism
from pareto_monoped.geometry.shapes import Circle, Pattern, Shape

_TOUCH_MM = 1e-9
_LEAST_WALL_MM = 1.0
"""Of a ring that fills a hole. Our own choice: three times the chamfers of 0.3 mm on the edges of bores."""


def regrouped(prisms: Sequence[Prism]) -> list[Prism]:
    """Return the same body from other prisms: slices of one outline that stand on each other become one tall prism.

    Slices of a gear would have to be united along all their flanks. Where each slice has one central hole, the tall
    prism gets the widest of these holes, and rings fill it where the hole is narrower. Slices whose holes are nearly
    equal stay as they are: a chamfer does not fit on a ring that is thinner than itself.
    """
    result = []
    for stack in _stacks(prisms):
        bores = [prism.holes[0] for prism in stack if len(prism.holes) == 1 and isinstance(prism.holes[0], Circle)]
        if len(stack) == 1 or len(bores) < len(stack):
            result += stack
            continue
        widest = max(bores, key=lambda bore: float(bore.radius_mm))
        walls = [float(widest.radius_mm) - float(bore.radius_mm) for bore in bores]
        if any(0.0 < wall < _LEAST_WALL_MM for wall in walls):
            result += stack
            continue
        result.append(Prism(outline=stack[0].outline, z0_mm=stack[0].z0_mm, z1_mm=stack[-1].z1_mm, holes=(widest,)))
        result += [
            Prism(outline=widest, z0_mm=prism.z0_mm, z1_mm=prism.z1_mm, holes=(bore,))
            for prism, bore in zip(stack, bores, strict=True)
            if float(bore.radius_mm) < float(widest.radius_mm)
        ]
    return result


def stands_on(bevel: Bevel, prism: Prism) -> bool:
    """Return whether the edge of a bevel that takes away is one of this prism's, which is high enough for it."""
    takes = bevel.hole or float(bevel.edge_mm) <= float(bevel.at.radius_mm)
    return takes and is_on(bevel, prism)


def is_on(bevel: Bevel, prism: Prism) -> bool:
    """Return the same of any bevel: that of a countersunk head adds to its shank."""
    face, end = float(bevel.face_mm), float(bevel.end_mm)
    low, high = float(prism.z0_mm), float(prism.z1_mm)
    shapes = prism.holes if bevel.hole else (prism.outline,)
    at_face = abs(face - (low if end > face else high)) < _TOUCH_MM
    return bevel.at in shapes and at_face and abs(end - face) < high - low - _TOUCH_MM


def without_teeth(prism: Prism, bevels: Sequence[Bevel]) -> tuple[Prism, ...]:
    """Return a prism with teeth and bevels as two, one around the other, of which one has the teeth and no bevel.

    The kernel needs seconds for a cone on a face that has hundreds of edges. Other prisms come back as they are.
    """
    own = [bevel for bevel in bevels if stands_on(bevel, prism)]
    teeth = [shape for shape in (prism.outline, *prism.holes) if isinstance(shape, ExternalGear | InternalGear)]
    if not own or len(teeth) != 1:
        return (prism,)
    others: list[Shape] = [hole for hole in prism.holes if hole is not teeth[0]]
    around: list[Shape] = [
        Circle(radius_mm=bevel.edge_mm, x_mm=x, y_mm=y) for bevel in own if bevel.hole for x, y in bevel.centres_mm()
    ]
    reaches = [_reach(shape) for shape in (*others, *around)]
    if teeth[0] is prism.outline:
        low, high = max(far for _, far in reaches), _reach(teeth[0])[0]
    else:
        low, high = _reach(teeth[0])[1], min(near for near, _ in reaches) if reaches else 0.0
    if low >= high:
        return (prism,)
    split = Circle(radius_mm=0.5 * (low + high))
    if teeth[0] is prism.outline:
        return replace(prism, holes=(split,)), replace(prism, outline=split, holes=tuple(others))
    return replace(prism, holes=(split, *others)), replace(prism, outline=split, holes=(teeth[0],))


def _reach(shape: Shape) -> tuple[float, float]:
    """Return the least and the greatest distance of a boundary from the origin; 0 and infinity for unknown kinds."""
    if isinstance(shape, ExternalGear | InternalGear):
        radii = float(shape.root_radius_mm), float(shape.tip_radius_mm)
        return min(radii), max(radii)
    if isinstance(shape, Circle | Pattern):
        ring = float(shape.pitch_radius_mm) if isinstance(shape, Pattern) else 0.0
        away = float(np.hypot(shape.x_mm, shape.y_mm))
        radius = float(shape.radius_mm)
        return abs(abs(ring - away) - radius) if ring + away > radius else 0.0, ring + away + radius
    return 0.0, np.inf


def _stacks(prisms: Sequence[Prism]) -> list[list[Prism]]:
    """Return prisms of one outline that stand on each other without a gap, from below; all others alone."""
    stacks: list[list[Prism]] = []
    for prism in sorted(prisms, key=lambda p: float(p.z0_mm)):
        for stack in stacks:
            if stack[-1].outline == prism.outline and abs(float(stack[-1].z1_mm) - float(prism.z0_mm)) < _TOUCH_MM:
                stack.append(prism)
                break
        else:
            stacks.append([prism])
    return stacks

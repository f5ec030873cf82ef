"""Other prisms for the same part, chosen so that uniting them is cheap."""

from collections.abc import Sequence

from pareto_monoped.geometry.parts import Prism
from pareto_monoped.geometry.shapes import Circle

_TOUCH_MM = 1e-9


def regrouped(prisms: Sequence[Prism]) -> list[Prism]:
    """The same body from other prisms: slices of one outline that stand on each other become one tall prism.

    Slices of a gear would have to be united along all their flanks. Where each slice has one central hole, the tall
    prism gets the widest of these holes, and rings fill it where the hole is narrower.
    """
    result = []
    for stack in _stacks(prisms):
        bores = [prism.holes[0] for prism in stack if len(prism.holes) == 1 and isinstance(prism.holes[0], Circle)]
        if len(stack) == 1 or len(bores) < len(stack):
            result += stack
            continue
        widest = max(bores, key=lambda bore: float(bore.radius_mm))
        result.append(Prism(outline=stack[0].outline, z0_mm=stack[0].z0_mm, z1_mm=stack[-1].z1_mm, holes=(widest,)))
        result += [
            Prism(outline=widest, z0_mm=prism.z0_mm, z1_mm=prism.z1_mm, holes=(bore,))
            for prism, bore in zip(stack, bores, strict=True)
            if float(bore.radius_mm) < float(widest.radius_mm)
        ]
    return result


def _stacks(prisms: Sequence[Prism]) -> list[list[Prism]]:
    """Prisms of one outline that stand on each other without a gap, from below; all others alone."""
    stacks: list[list[Prism]] = []
    for prism in sorted(prisms, key=lambda p: float(p.z0_mm)):
        for stack in stacks:
            if stack[-1].outline == prism.outline and abs(float(stack[-1].z1_mm) - float(prism.z0_mm)) < _TOUCH_MM:
                stack.append(prism)
                break
        else:
            stacks.append([prism])
    return stacks

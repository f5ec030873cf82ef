"""Outlines with round corners, drawn like a belt around pulleys."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from pareto_monoped.geometry.shapes import Arc, Line, Numbers, Path

_ROUNDING = 1e-9  # rad
_WHOLE_ARC = 3.0  # rad; a longer arc is drawn as two


@dataclass(frozen=True, slots=True, kw_only=True)
class Pulley:
    """A round corner of an outline.

    Attributes:
        x_mm, y_mm: its centre.
        radius_mm: above zero.
        inside: whether the corner bulges outward, its centre inside the outline; otherwise it is a fillet.
    """

    x_mm: Numbers
    y_mm: Numbers
    radius_mm: float
    inside: bool = True

    @property
    def signed_mm(self) -> float:
        """Radius, negative for a fillet."""
        return self.radius_mm if self.inside else -self.radius_mm

    @property
    def mirrored(self) -> "Pulley":
        """Its image on the other side of the y axis."""
        return Pulley(x_mm=-self.x_mm, y_mm=self.y_mm, radius_mm=self.radius_mm, inside=self.inside)


def belt(pulleys: Sequence[Pulley]) -> Path:
    """The outline that runs anticlockwise around pulleys on straight common tangents.

    With the outward normal n of a tangent, the belt leaves a pulley of centre c and signed radius s at c + s n. Both
    ends of a tangent lie on it: n (c2 - c1) = s1 - s2.

    Args:
        pulleys: in the order in which the belt meets them; one may be met twice.
    """
    normals = [_normal_rad(one, other) for one, other in pairwise((*pulleys, pulleys[0]))]
    pieces: list[Line | Arc] = []
    for k, pulley in enumerate(pulleys):
        pieces += _corner(pulley, normals[k - 1], normals[k])
        following = pulleys[(k + 1) % len(pulleys)]
        pieces.append(Line(*_touch(pulley, normals[k]), *_touch(following, normals[k])))
    return Path(tuple(pieces))


def mirrored(pulleys: Sequence[Pulley]) -> tuple[Pulley, ...]:
    """The pulleys of the outline's image on the other side of the y axis."""
    return tuple(pulley.mirrored for pulley in reversed(pulleys))


def _normal_rad(one: Pulley, other: Pulley) -> Numbers:
    """Angle of the outward normal of the tangent from one pulley to the next."""
    across, along = other.x_mm - one.x_mm, other.y_mm - one.y_mm
    share = (one.signed_mm - other.signed_mm) / np.hypot(across, along)
    return np.arctan2(along, across) - np.arccos(share)


def _touch(pulley: Pulley, normal_rad: Numbers) -> tuple[Numbers, Numbers]:
    return (
        pulley.x_mm + pulley.signed_mm * np.cos(normal_rad),
        pulley.y_mm + pulley.signed_mm * np.sin(normal_rad),
    )


def _corner(pulley: Pulley, before_rad: Numbers, after_rad: Numbers) -> list[Line | Arc]:
    """The belt's arc on a pulley, between the normals of the tangents before and after it."""
    if pulley.inside:
        start, turn = before_rad, _turn(after_rad - before_rad)
    else:
        start, turn = before_rad + np.pi, -_turn(before_rad - after_rad)
    count = 2 if np.max(np.abs(turn)) > _WHOLE_ARC else 1
    ends = [start + turn * (k / count) for k in range(count + 1)]
    return [Arc(pulley.x_mm, pulley.y_mm, pulley.radius_mm, one, other) for one, other in pairwise(ends)]


def _turn(angle_rad: Numbers) -> Numbers:
    """An angle from 0 to a full turn; one that rounding has left just below 0 is no full turn."""
    return np.mod(angle_rad + _ROUNDING, 2.0 * np.pi) - _ROUNDING

"""Cones on cylinders: what a countersink or chamfer takes away, and what a countersunk head adds, with exact integrals.

Millimetres. Every number may be an array of shape (n,), as in ``shapes``.
"""

from dataclasses import dataclass

import numpy as np

from pareto_monoped.geometry.shapes import Circle, Moments, Numbers, Pattern


@dataclass(frozen=True, slots=True, kw_only=True)
class Bevel:
    """A ring of triangular section between a cylinder and a cone on one axis along z.

    The cone meets the cylinder at ``end_mm`` and has the radius ``edge_mm`` in the face. On a hole, the wider cone
    takes the ring away: a countersink or chamfer. On a shaft, a narrower cone takes the ring away: a chamfer. A wider
    one adds it: a countersunk head. With ``edge_mm`` equal to the cylinder's radius there is no ring.

    Attributes:
        at: the cylinder, or the pattern of them; its radius is that of the hole or shaft.
        edge_mm: radius of the cone in the face.
        face_mm: height z of the face.
        end_mm: height z at which the cone meets the cylinder, on either side of the face.
        hole: whether the cylinder is a hole, with material outside, or a shaft, with material inside.
    """

    at: Circle | Pattern
    edge_mm: Numbers
    face_mm: Numbers
    end_mm: Numbers
    hole: bool

    def integrals(self) -> tuple[Numbers, ...]:
        """What the ring adds to the integrals of ``Prism``, in the same order; negative where it takes away.

        With R the radius that goes linearly from a in the face to b at the end, the disc between has the area pi R^2
        and the second moment pi R^4 / 4 about either diameter. Its integrals along z are polynomials in a and b:

            int R^2 = (a^2 + ab + b^2) / 3            int t R^2   = (a^2 + 2ab + 3b^2) / 12
            int R^4 = (a^4 + a^3 b + ... + b^4) / 5    int t^2 R^2 = (a^2 + 3ab + 6b^2) / 30

        for t from 0 to 1. The cylinder's, with R = b, are subtracted.
        """
        a, b = np.asarray(self.edge_mm, dtype=np.float64), np.asarray(self.at.radius_mm, dtype=np.float64)
        face, along = np.asarray(self.face_mm, dtype=np.float64), np.asarray(self.end_mm - self.face_mm)
        # Each difference to the cylinder is written with the factor a - b, so that thin rings lose no digits.
        size = (-1.0 if self.hole else 1.0) * np.pi * np.abs(along) * (a - b)
        ring = size * (a + 2.0 * b) / 3.0
        ring_t = size * (a + 3.0 * b) / 12.0
        ring_tt = size * (a + 4.0 * b) / 30.0
        across = 0.25 * size * (a**3 + 2.0 * a**2 * b + 3.0 * a * b**2 + 4.0 * b**3) / 5.0
        height = face * ring + along * ring_t
        return _spread(self.at, ring, across, height, face**2 * ring + 2.0 * face * along * ring_t + along**2 * ring_tt)

    def volume_mm3(self) -> Numbers:
        """The first of ``integrals``, for searches that weigh thousands of parts."""
        a, b = np.asarray(self.edge_mm, dtype=np.float64), np.asarray(self.at.radius_mm, dtype=np.float64)
        size = (-1.0 if self.hole else 1.0) * np.pi * np.abs(self.end_mm - self.face_mm) * (a - b)
        count = self.at.count if isinstance(self.at, Pattern) else 1.0
        return count * (size * (a + 2.0 * b) / 3.0)

    def centres_mm(self) -> list[tuple[float, float]]:
        """Where the axes are, for a bevel of plain numbers."""
        if isinstance(self.at, Pattern):
            return self.at.centres_mm()
        return [(float(self.at.x_mm), float(self.at.y_mm))]


def _spread(
    at: Circle | Pattern, volume: Numbers, across: Numbers, height: Numbers, heights: Numbers
) -> tuple[Numbers, ...]:
    """The integrals over a ring on each axis, from those of one about its own.

    Args:
        at: the axes.
        volume: integral of 1.
        across: of xx, which is that of yy.
        height: of z.
        heights: of zz.
    """
    flat = Moments(volume, 0.0, 0.0, across, across, 0.0)
    if isinstance(at, Pattern):
        # As in ``Pattern.moments``, the two second moments are taken as equal.
        spread = across + 0.5 * volume * np.square(at.pitch_radius_mm)
        flat = Moments(volume, 0.0, 0.0, spread, spread, 0.0).scaled(at.count)
        height, heights = height * at.count, heights * at.count
    flat = flat.moved(at.x_mm, at.y_mm)
    return (
        flat.area,
        flat.x,
        flat.y,
        height,
        flat.xx,
        flat.yy,
        heights,
        flat.xy,
        height * at.x_mm,
        height * at.y_mm,
    )

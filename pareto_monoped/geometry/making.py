"""What a workshop must know of a part besides its shape: fits, and the accuracy of its teeth."""

from dataclasses import dataclass

import numpy as np

from pareto_monoped.geometry.shapes import Numbers


@dataclass(frozen=True, slots=True, kw_only=True)
class Fit:
    """The tolerance of all round faces of one diameter of a part.

    Attributes:
        diameter_mm: nominal.
        zone: tolerance class after ISO 286-1, such as ``H7`` for a hole or ``h6`` for a shaft.
        seat: whether the face carries a bearing or a gear, so that its place and finish matter too.
    """

    diameter_mm: Numbers
    zone: str
    seat: bool = False

    @property
    def text(self) -> str:
        """Such as ``40 h6``; '' for arrays."""
        return "" if np.ndim(self.diameter_mm) else f"{float(self.diameter_mm):g} {self.zone}"

    def holds(self, diameter_mm: float) -> bool:
        """Whether a face of this diameter has the tolerance."""
        return bool(np.isclose(float(self.diameter_mm), diameter_mm, rtol=0.0, atol=1e-6))

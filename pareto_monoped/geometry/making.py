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
        raceway: whether rolling elements run on the face itself, which is then hard and ground.
    """

    diameter_mm: Numbers
    zone: str
    seat: bool = False
    raceway: bool = False

    @property
    def text(self) -> str:
        """Such as ``40 h6``; '' for arrays."""
        return "" if np.ndim(self.diameter_mm) else f"{float(self.diameter_mm):g} {self.zone}"

    def holds(self, diameter_mm: float) -> bool:
        """Whether a face of this diameter has the tolerance."""
        return bool(np.isclose(float(self.diameter_mm), diameter_mm, rtol=0.0, atol=1e-6))


RACEWAY_RA_UM = 0.2
"""Greatest Ra of raceways (SKF, Raceways on shafts and in housings; Schaeffler has the same up to 80 mm)."""
_RACEWAY_ROUND, _RACEWAY_CYLINDRICAL = 0.25, 0.5
"""Deviations from round and cylindrical form over the diameter's tolerance, at most (SKF, the same page)."""


def raceway_note(tolerance_mm: float) -> str:
    """Form of a raceway in words.

    Args:
        tolerance_mm: width of its diameter's tolerance.
    """
    round_mm, cylindrical_mm = (share * tolerance_mm for share in (_RACEWAY_ROUND, _RACEWAY_CYLINDRICAL))
    return (
        f"raceway of the needles: ground, Ra {RACEWAY_RA_UM:g} um, round within {round_mm:.3f} mm, cylindrical within "
        f"{cylindrical_mm:.3f} mm"
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class ToothMaking:
    """How the teeth of one outline of a part are made, with what their rating takes for granted.

    Attributes:
        teeth, module_mm: of the outline.
        accuracy_class: ISO 1328-1.
        making: the steps in their order.
        mates_mm: reference diameters of the gears that mesh with them.
        play_mm: least backlash of the pair along the pitch circle, where the outlines are drawn without it; None: as
            they are drawn.
        quality: of material and treatment (ISO 6336-5), such as ``MQ``; '' for teeth that are not rated.
        core_hardness: with its scale.
        layer: which depth of hardening is meant; '' without one.
        layer_mm: its limits, in the finished tooth.
        flank_rz_um, root_rz_um: greatest Rz of flanks and fillets.
        runout_mm: greatest radial runout of the teeth to the datum axis.
    """

    teeth: int
    module_mm: float
    accuracy_class: int
    making: str
    mates_mm: tuple[float, ...]
    play_mm: float | None = None
    quality: str = ""
    core_hardness: str = ""
    layer: str = ""
    layer_mm: tuple[float, float] = (0.0, 0.0)
    flank_rz_um: float = 0.0
    root_rz_um: float = 0.0
    runout_mm: float = 0.0

    @property
    def layer_text(self) -> str:
        """Limits of the layer, such as ``0.09 to 0.24``."""
        return f"{self.layer_mm[0]:.2f} to {self.layer_mm[1]:.2f}"

    @property
    def text(self) -> str:
        """The facts of rated teeth in one line; '' for others."""
        layer = f", {self.layer} {self.layer_text} mm" if self.layer else ""
        return self.quality and f"teeth {self.making}, {self.quality}{layer}, core {self.core_hardness}"

"""How the teeth of gears and splines are made: what their rating takes for granted, for drawings and parts list."""

import numpy as np

from pareto_monoped.actuator.rating.load import runout_um
from pareto_monoped.actuator.settings import ActuatorSettings
from pareto_monoped.geometry.gears import ExternalGear, InternalGear
from pareto_monoped.geometry.making import ToothMaking
from pareto_monoped.materials import GearGrade

SPLINE_CLASS = 8
"""ISO 1328-1 class of splines; our own choice: they are bonded and do not roll."""


def rated_teeth(
    gear: ExternalGear | InternalGear, steel: GearGrade, settings: ActuatorSettings, *mates: ExternalGear | InternalGear
) -> ToothMaking | None:
    """How a rated gear is made, and its mates; None under the rules of the paper, which rate none, and for arrays."""
    if settings.rules == "paper" or np.ndim(gear.teeth):
        return None
    data, module = settings.parts.rating, float(gear.module_mm)
    low, high = steel.layer_modules or (0.0, 0.0)
    runout = runout_um(2.0 * float(gear.pitch_radius_mm), module, data.accuracy_class)
    return ToothMaking(
        teeth=int(gear.teeth),
        module_mm=module,
        accuracy_class=data.accuracy_class,
        making=steel.making,
        mates_mm=tuple(2.0 * float(mate.pitch_radius_mm) for mate in mates),
        quality=steel.quality,
        core_hardness=steel.core_hardness,
        layer=steel.layer,
        layer_mm=(
            float(np.ceil(100.0 * low * module - 1e-9)) / 100.0,
            float(np.floor(100.0 * high * module + 1e-9)) / 100.0,
        ),
        flank_rz_um=data.flank_roughness_um,
        root_rz_um=data.root_roughness_um,
        runout_mm=1e-3 * float(np.floor(runout)),
    )


def spline_teeth(spline: ExternalGear, settings: ActuatorSettings) -> ToothMaking:
    """How a spline is made, on the shaft and in the hub."""
    return ToothMaking(
        teeth=int(spline.teeth),
        module_mm=float(spline.module_mm),
        accuracy_class=SPLINE_CLASS,
        making="hobbed; hub wire-cut to fit",
        mates_mm=(2.0 * float(spline.pitch_radius_mm),),
        play_mm=settings.parts.spline.play_mm,
    )


def made(*teeth: ToothMaking | None) -> tuple[ToothMaking, ...]:
    """Those that are known."""
    return tuple(one for one in teeth if one is not None)

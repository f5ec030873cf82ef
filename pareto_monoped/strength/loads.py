"""What the parts of a robot have to carry: the loads of its jump, and the lengths that turn forces into moments."""

from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class Loads:
    """Loads of n jumps, each of shape (n,); NaN where a jump failed or a stored study did not measure the load.

    All but the two lengths are measures of the jump, with what they mean in ``measures.MEASURES``.

    Attributes:
        peak_torque_hip_n_m, peak_torque_knee_n_m: of the motors, at the joints, before losses.
        peak_gear_torque_hip_n_m, peak_gear_torque_knee_n_m: through the gearboxes, at their outputs; the end stops and
            the foot's impact are in it. A housing reacts to no more than that.
        peak_chain_tension_n: pull of the chain.
        peak_stop_torque_hip_n_m, peak_stop_torque_knee_n_m: of the joints' end stops.
        stop_compression_hip, stop_compression_knee: of the bumpers, as shares of their travel.
        stop_energy_j: into all end stops.
        peak_foot_force_n: of the floor on the foot.
        peak_knee_force_n: between thigh and shank, by bearings, chain and end stop together.
        thigh_length_m, shank_length_m: of the links.
    """

    peak_torque_hip_n_m: Floats
    peak_torque_knee_n_m: Floats
    peak_gear_torque_hip_n_m: Floats
    peak_gear_torque_knee_n_m: Floats
    peak_chain_tension_n: Floats
    peak_stop_torque_hip_n_m: Floats
    peak_stop_torque_knee_n_m: Floats
    stop_compression_hip: Floats
    stop_compression_knee: Floats
    stop_energy_j: Floats
    peak_foot_force_n: Floats
    peak_knee_force_n: Floats
    thigh_length_m: Floats
    shank_length_m: Floats

    def __len__(self) -> int:
        return len(self.thigh_length_m)


LOAD_NAMES: tuple[str, ...] = tuple(field.name for field in fields(Loads))
"""Names that a row of the table may read."""


def loads_of(columns: Mapping[str, Any]) -> Loads:
    """Loads from the columns of stored trials or of evaluations.

    Args:
        columns: name -> values of shape (n,), such as a data frame of trials; others than ``LOAD_NAMES`` are ignored,
            and measures that a study of an earlier version lacks are unknown.
    """
    n = len(columns["thigh_length_m"])
    unknown = np.full(n, np.nan)
    return Loads(**{name: np.asarray(columns.get(name, unknown), dtype=np.float64) for name in LOAD_NAMES})

"""The factors of one design, joint by joint, as an export lists them; computed by the functions for populations."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from pareto_monoped.actuator.ratiomap import ActuatorMap
from pareto_monoped.design import Design
from pareto_monoped.strength.factors import strength_factors
from pareto_monoped.strength.joint import ActuatorJoint, LegJoint
from pareto_monoped.strength.loads import Loads
from pareto_monoped.strength.table import TABLE


@dataclass(frozen=True, slots=True, kw_only=True)
class JointFactor:
    """A joint of one design under the loads of its jump.

    Attributes:
        joint: the row of the table.
        factor: its safety factor.
        loads: the loads that it comes from, by their names.
    """

    joint: ActuatorJoint | LegJoint
    factor: float
    loads: Mapping[str, float]

    @property
    def share(self) -> float:
        """Factor over required factor; the joint holds from 1 up."""
        return self.factor / self.joint.required


def joint_factors(design: Design, actuator_map: ActuatorMap, loads: Loads) -> tuple[JointFactor, ...]:
    """The factors of one design in the order of the table; none if its jump failed, because loads are unknown then.

    Args:
        design: whose gearboxes are looked up.
        actuator_map: the gearboxes.
        loads: of its jump, one row.
    """
    factors = strength_factors(design.as_array(), actuator_map, loads)[0]
    if np.isnan(factors).any():
        return ()
    return tuple(
        JointFactor(
            joint=joint, factor=float(factor), loads={name: float(getattr(loads, name)[0]) for name in joint.loads}
        )
        for joint, factor in zip(TABLE, factors, strict=True)
    )

"""The factors of one design, joint by joint, as an export lists them; computed by the functions for populations."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from pareto_monoped.actuator.joint_maps import Maps, joint_maps
from pareto_monoped.design import Design
from pareto_monoped.leg.dimensions import leg_dimensions
from pareto_monoped.strength.factors import strength_factors
from pareto_monoped.strength.gears import MOST_JUMPS, strike_life_jumps
from pareto_monoped.strength.joint import SIDES, ActuatorJoint, LegJoint, Structure
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


def joint_factors(design: Design, maps: Maps, loads: Loads) -> tuple[JointFactor, ...]:
    """The factors of one design in the order of the table; none if its jump failed, because loads are unknown then.

    Rows that only inform are left out where the rules know no such limit.

    Args:
        design: whose gearboxes are looked up.
        maps: the gearboxes of both joints, or of hip and knee.
        loads: of its jump, one row.
    """
    factors = strength_factors(design.as_array(), maps, loads)[0]
    known = ~np.isnan(factors)
    if not all(known[k] or joint.informs for k, joint in enumerate(TABLE)):
        return ()
    return tuple(
        JointFactor(
            joint=joint, factor=float(factor), loads={name: float(getattr(loads, name)[0]) for name in joint.loads}
        )
        for joint, factor, is_known in zip(TABLE, factors, known, strict=True)
        if is_known
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class GearLife:
    """How long gears last that are struck in every jump as in the one simulated.

    Attributes:
        jumps: for which the weaker gearbox has the safety of its duty; 0 if for none, at most ``MOST_JUMPS``.
        duty_jumps: what the gears are made for.
    """

    jumps: float
    duty_jumps: float

    @property
    def text(self) -> str:
        """The number in words."""
        digits = max(0, int(np.log10(max(self.jumps, 1.0))) - 1)  # two that count
        return f"{MOST_JUMPS:.0e} or more" if self.jumps >= MOST_JUMPS else f"{round(self.jumps, -digits):.0f}"

    @property
    def advice(self) -> str:
        """One line where the gears do not last as long as they should; '' otherwise."""
        if self.jumps >= self.duty_jumps:
            return ""
        return (
            f"struck like this in every jump, the gears keep the safety of their duty for {self.text} of "
            f"{self.duty_jumps:.0f} jumps; choose heavier gearboxes, release the knee before its stop "
            "(knee_release_rad), or constrain gear_strike_safety to at least 1"
        )


def gear_life(design: Design, maps: Maps, loads: Loads) -> GearLife | None:
    """The life of a design's gears under strikes; None if its jump failed, and under rules that know no fatigue.

    Args:
        design: whose gearboxes are looked up.
        maps: the gearboxes of both joints, or of hip and knee.
        loads: of its jump, one row.
    """
    both = joint_maps(maps)
    leg, settings = leg_dimensions(both), both.hip.settings
    torques = {side: float(getattr(loads, f"peak_gear_torque_{side}_n_m")[0]) for side in SIDES}
    if settings.rules == "paper" or np.isnan(list(torques.values())).any():
        return None
    jumps = min(
        strike_life_jumps(
            Structure(actuator=both.of(side).lookup(getattr(design, f"{side}_ratio")), leg=leg, settings=settings),
            torque,
        )
        for side, torque in torques.items()
    )
    return GearLife(jumps=jumps, duty_jumps=settings.parts.duty.jumps)

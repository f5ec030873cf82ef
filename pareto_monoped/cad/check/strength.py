"""Every joint has its required safety factor under the loads of the jump; rows that only inform are left out."""

from collections.abc import Sequence

from pareto_monoped.cad.check.limits import STRENGTH
from pareto_monoped.cad.check.result import Check, Finding, worst_of
from pareto_monoped.strength.single import JointFactor


def check(factors: Sequence[JointFactor]) -> Check:
    """Compare every factor with the one required.

    Args:
        factors: of all joints; none if the design does not jump, so that there are no loads.
    """
    factors = [one for one in factors if not one.joint.informs]
    looked_at = f"{len(factors)} joints under the loads of the jump" if factors else "no joints, as it does not jump"
    return worst_of(STRENGTH, looked_at, [Finding(value=one.share, text=_sentence(one)) for one in factors])


def _sentence(one: JointFactor) -> str:
    joint = one.joint
    return f"{joint.name}: safety factor = {one.factor:.3g}: must be at least {joint.required:g}; {joint.cure}"

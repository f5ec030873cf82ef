"""The bumpers of the end stops: how far a jump squeezes them."""

from pareto_monoped.strength.joint import SIDES, LegJoint

JOINTS = tuple(
    LegJoint(
        name=f"{side}_bumper",
        group="stops",
        formula="travel / compression",
        source="leg.stops.MOST_COMPRESSION: half the diameter, up to which Lindley's law was measured",
        required=1.0,
        required_source="the travel is itself a limit of the design: the metal is clear of itself up to it",
        loads=(f"stop_compression_{side}",),
        capacity=lambda s: 1.0,
        parts=(f"{side}_bumper_{one}", f"{side}_bumper_{other}"),
        cure=f"release the {side}'s torque before its stop, or jump lower",
    )
    for side, (one, other) in zip(SIDES, (("front", "rear"), ("extension", "flexion")), strict=True)
)

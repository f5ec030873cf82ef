"""The chain: its breaking load against the largest pull of a jump."""

from pareto_monoped.strength.joint import LegJoint

JOINTS = (
    LegJoint(
        name="chain_breaking",
        group="chain",
        formula="breaking load / pull",
        source="ISO 606, least tensile strength",
        required=5.0,
        required_source="makers' catalogues and DIN 8150: static safety of 5 to 7 under shocks, for chains up to 3 m/s",
        loads=("peak_chain_tension_n",),
        capacity=lambda s: s.leg.chain.breaking_n,
        parts=("chain_hip", "chain_knee"),
        cure="release the knee's torque before its stop, a lower knee_ratio, or a motor of less torque",
    ),
)

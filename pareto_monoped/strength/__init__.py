"""What holds: loads of a jump -> safety factor of every joint of a robot, for whole populations.

``joint.Joint`` is one row: what may fail, by which formula, and the least factor allowed. ``table.TABLE`` holds all
rows. ``factors.strength_factors`` evaluates them for n designs, shape (n, rows). ``factors.safeties`` takes the least
of factor over required factor in each group, which is a measure of the jump, such as ``gear_safety``. The evaluator of
jumps, studies and every export call the same functions.

To add joints, write a module with pure formulas and a tuple of rows, and name the tuple in ``table``::

    JOINTS = (
        *(
            ActuatorJoint(
                name=f"{side}_output_screws",
                group="joints",
                side=side,
                formula="T = n mu F_V r",
                source="VDI 2230-1, R8",
                required=1.5,
                required_source="our own choice: ...",
                loads=(f"peak_gear_torque_{side}_n_m",),
                capacity=lambda s: slip_torque_n_m(s.actuator.output...),
                parts=("carrier", "hip_coupling"),
                cure="more or larger screws",
            )
            for side in SIDES
        ),
    )

A row's ``capacity`` gets one ``Structure`` (an actuator, its leg, the settings) and is called once per gearbox of a
map. Its ``factor`` then gets arrays. It must be elementwise, because a design's result may not depend on the batch.
A ``LegJoint`` has no ``side``; its capacity is computed once per map. Screw sizes, circles, depths and materials come
from the records that also build the parts.
"""

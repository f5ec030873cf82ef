"""What holds: loads of a jump -> safety factor of every joint of a robot, for whole populations.

``joint.Joint`` is one row: what may fail, by which formula, and the least factor allowed. ``factors.TABLE`` holds all
rows. ``factors.strength_factors`` evaluates them for n designs, shape (n, rows). ``factors.safeties`` takes the least
of factor over required factor in each group, which is a measure of the jump, such as ``gear_safety``. The evaluator of
jumps, studies and every export call the same functions.

To add joints, write a module with pure formulas and a tuple of rows, such as ``strength.chain``, and name the tuple in
``TABLE``. A row's ``capacity`` gets one ``Structure`` (an actuator, its leg, the settings) and is called once per
gearbox of a map; that of a ``LegJoint``, which has no ``side``, once per map. Its ``factor`` then gets arrays. It must
be elementwise, because a design's result may not depend on the batch. Screw sizes, circles, depths and materials come
from the records that also build the parts.

Order of imports, lowest first: connections, groups; joint; chain, drive, gears, links, plates; knee, stops, threads;
mounts; factors.
"""

__all__ = ["factors", "groups", "joint"]

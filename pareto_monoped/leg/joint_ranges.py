"""How far hip and knee turn: the one definition of the joints' end stops.

The ranges are what the links leave free, with the bumpers fully compressed. Whatever needs them reads them here: every
export sweeps the leg through them and checks for overlaps, the robot models have them as joint limits, and fork and
turnbuckles are sized for them.

The rubber bumpers in front of the ends are part of a calibration (``[joints.hip_stop]`` and ``[joints.knee_stop]``, see
``jump.calibration.EndStop``), as a simulation may be made without them. Those of the calibrations ``reference`` and
``ideal`` are met 10 degrees before the ends. Their knee bends one way only: its lower bumper ends 5 degrees before the
straight leg, although the links are free to 150 degrees on that side too.
"""

HIP_RANGE_RAD = (-1.92, 1.92)
"""110 degrees to either side of hanging straight down, our own choice; the base's rods stand beyond it."""
KNEE_RANGE_RAD = (-2.62, 2.62)
"""150 degrees of flexion to either side, our own choice: ``LegDimensions.fork_mm`` is as deep as this needs."""

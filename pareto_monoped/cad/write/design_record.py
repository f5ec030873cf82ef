"""``design.json``: the design, what it was made with, and what came out; an export can be made again from it."""

from collections.abc import Mapping, Sequence
from typing import Any

from pareto_monoped import __version__
from pareto_monoped.actuator.actuator import Actuator
from pareto_monoped.actuator.motors import motor_values
from pareto_monoped.actuator.ratiomap import JointMaps
from pareto_monoped.cad.as_built import Built
from pareto_monoped.definition.provenance import digest
from pareto_monoped.design import Design
from pareto_monoped.jump.calibration import Calibration, calibration_values

_DIGITS = 12  # of a design's hash: two of a million designs share one with a probability of 0.2 percent
MADE_BY = f"pareto-monoped {__version__}"  #: Program and version, as written into every record.


def design_record(
    *,
    searched: Design,
    built: Built,
    maps: JointMaps,
    calibration: Calibration,
    source: Mapping[str, Any] | None,
    formats: Sequence[str],
    strength: bool,
) -> dict[str, Any]:
    """Return the content of ``design.json`` before its jumps are simulated, apart from the list of files."""
    rules, values = maps.rules, [motor_values(motor) for motor in maps.motors]
    # Records with one motor hold it alone, as they did before there could be two.
    motor_data = values[0] if len(values) == 1 else dict(zip(("hip", "knee"), values, strict=True))
    return {
        "made_by": MADE_BY,
        "motor": maps.label,
        "calibration": calibration.label,
        # Records made before there were other rules do not name them.
        **({} if rules == "paper" else {"rules": rules}),
        "source": dict(source or {}),
        "searched": searched.as_dict(),
        "design_hash": digest({"searched": searched.as_dict(), "rules": rules, "motor": motor_data})[:_DIGITS],
        "as_built": built.design.as_dict(),
        "jumps": {},
        "mass_kg": built.robot.mass_kg,
        "cost_eur": float(built.robot.cost.total_eur),
        "strength": strength,
        "pose": {"hip_rad": built.pose.hip_rad, "knee_rad": built.pose.knee_rad},
        "actuators": {
            name: _actuator(actuator) | ({"stand_in": note} if (note := maps.of(name).stand_in(ratio)) else {})
            for name, actuator, ratio in (
                ("hip", built.robot.hip, searched.hip_ratio),
                ("knee", built.robot.knee, searched.knee_ratio),
            )
        },
        "formats": list(formats),
        "motor_data": motor_data,
        "calibration_data": calibration_values(calibration),
    }


def _actuator(actuator: Actuator) -> dict[str, Any]:
    """Return gears and figures of an actuator; profile shifts (over the module) and rating only where it has them."""
    gears, rating = actuator.gears, actuator.rating
    shifts = {
        "sun_shift": float(gears.sun_shift),
        "planet_shift": float(gears.planet_shift),
        "ring_shift": float(gears.ring_shift),
        "centre_distance_mm": float(gears.carrier_radius_mm),
    }
    return {
        "family": actuator.family,
        "sun_teeth": int(gears.sun_teeth),
        "planet_teeth": int(gears.planet_teeth),
        "ring_teeth": int(gears.ring_teeth),
        "module_mm": float(gears.module_mm),
        "planets": int(gears.planets),
        **(shifts if gears.is_shifted else {}),
        "face_width_mm": actuator.face_width_mm,
        "ratio": actuator.ratio,
        "mass_kg": actuator.mass_kg,
        "peak_torque_n_m": actuator.peak_torque_n_m,
        "length_mm": actuator.length_mm,
        **({} if rating is None else {"rating": rating.as_dict()}),
    }

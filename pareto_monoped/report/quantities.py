"""What each column is called on the page, and in which unit: one table for page and figures."""

from pareto_monoped.report.records import Quantity


def _quantity(name: str, label: str, unit: str, decimals: int, scale: float = 1.0) -> Quantity:
    return Quantity(name=name, label=label, unit=unit, decimals=decimals, scale=scale)


QUANTITIES: tuple[Quantity, ...] = (
    _quantity("height_m", "height", "m", 3),
    _quantity("energy_j", "energy", "J", 2),
    _quantity("thigh_length_m", "thigh length", "mm", 1, 1000.0),
    _quantity("shank_length_m", "shank length", "mm", 1, 1000.0),
    _quantity("knee_ratio", "knee ratio", ": 1", 2),
    _quantity("hip_ratio", "hip ratio", ": 1", 2),
    _quantity("stiffness_n_per_m", "stiffness", "N/m", 1),
    _quantity("damping_n_s_per_m", "damping", "N s/m", 2),
    _quantity("torsional_stiffness_n_m_per_rad", "torsional stiffness", "N m/rad", 2),
    _quantity("mass_kg", "mass", "kg", 3),
    _quantity("efficiency", "efficiency, m g (H - 0.5 m) / E", "%", 1, 100.0),
    _quantity("energy_hip_j", "energy of the hip", "J", 2),
    _quantity("energy_knee_j", "energy of the knee", "J", 2),
    _quantity("absorbed_j", "work absorbed by the motors", "J", 2),
    _quantity("drive_loss_j", "lost in gears and chain", "J", 2),
    _quantity("joule_heat_j", "heat in the windings", "J", 2),
    _quantity("foot_clearance_m", "foot clearance at the apex", "mm", 0, 1000.0),
    _quantity("lift_off_s", "lift-off", "s", 3),
    _quantity("apex_s", "apex", "s", 3),
    _quantity("peak_torque_hip_n_m", "peak torque, hip", "N m", 1),
    _quantity("peak_torque_knee_n_m", "peak torque, knee", "N m", 1),
    _quantity("peak_speed_hip_rad_per_s", "peak speed, hip", "rad/s", 1),
    _quantity("peak_speed_knee_rad_per_s", "peak speed, knee", "rad/s", 1),
    _quantity("peak_power_hip_w", "peak power, hip", "W", 0),
    _quantity("peak_power_knee_w", "peak power, knee", "W", 0),
    _quantity("saturation_hip", "time at the torque limit, hip", "%", 1, 100.0),
    _quantity("saturation_knee", "time at the torque limit, knee", "%", 1, 100.0),
    _quantity("energy_balance_error", "energy balance open by", "%", 2, 100.0),
    _quantity("spread_height_m", "height, links moved by 1e-6 (90th percentile)", "mm", 2, 1000.0),
    _quantity("spread_energy", "energy, links moved by 1e-6 (90th percentile)", "%", 2, 100.0),
    _quantity("half_step_height_m", "height, step halved", "mm", 2, 1000.0),
    _quantity("half_step_energy", "energy, step halved", "%", 2, 100.0),
)

AUDIT = tuple(q.name for q in QUANTITIES[-5:])
"""What is shown of an audit."""

EVERY_TRIAL: tuple[str, ...] = ("mass_kg", "foot_clearance_m", "joule_heat_j")
"""Measures that the page has of every trial; of the front it has all of them."""

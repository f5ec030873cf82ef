"""Load on the planets' bearings, and the face width that they need; for one gear set or for arrays of them."""

from functools import reduce

import numpy as np

from pareto_monoped.actuator.gearset import GearSet
from pareto_monoped.actuator.motors import Motor
from pareto_monoped.actuator.needles import LIFE_EXPONENT, choices_mm, needle_rows
from pareto_monoped.actuator.service.duty import life_turns, output_turns_per_hour
from pareto_monoped.actuator.settings import ActuatorSettings
from pareto_monoped.actuator.sharing import load_sharing
from pareto_monoped.geometry.shapes import Numbers


def planet_force_n(gears: GearSet, output_torque_n_m: Numbers, settings: ActuatorSettings) -> Numbers:
    """Force of the most loaded planet on its pin: n F = K_gamma T / r, with the carrier's radius r."""
    sharing = load_sharing(gears.planets, settings)
    return 1e3 * sharing * output_torque_n_m / (gears.planets * gears.carrier_radius_mm)


def planet_turns(gears: GearSet) -> Numbers:
    """Turns of a planet against the carrier over the output's (Willis, ring fixed)."""
    return gears.ring_teeth / gears.planet_teeth


def needle_life_h(gears: GearSet, force_n: Numbers, dynamic_rating_n: Numbers, settings: ActuatorSettings) -> Numbers:
    """L10 of a planet's needles under the duty; ``force_n`` is that at the peak torque."""
    return _life_h(planet_turns(gears), force_n, dynamic_rating_n, settings)


def _life_h(turns: Numbers, force_n: Numbers, dynamic_rating_n: Numbers, settings: ActuatorSettings) -> Numbers:
    duty = settings.parts.duty
    life = life_turns([share * force_n for share in duty.torque_shares], dynamic_rating_n, LIFE_EXPONENT, duty)
    return life / (output_turns_per_hour(duty, settings.service) * turns)


def planet_margin(gears: GearSet, width_mm: Numbers, motor: Motor, settings: ActuatorSettings) -> Numbers:
    """Least of life, static safeties or pv over what the settings ask for, less 1; negative where one is too little."""
    if settings.planet_bearing == "needles":
        force = planet_force_n(gears, gears.ratio * motor.peak_torque_n_m, settings)
        return _needle_margin(planet_turns(gears), force, width_mm, settings)
    return bush_pv_limit(settings) / bush_pv(gears, width_mm, motor, settings) - 1.0


def _needle_margin(turns: Numbers, force_n: Numbers, width_mm: Numbers, settings: ActuatorSettings) -> Numbers:
    """``planet_margin`` of needles."""
    rows, service, overload = needle_rows(width_mm, settings), settings.service, settings.parts.rating.overload_factor
    shares = (
        _life_h(turns, force_n, rows.dynamic_rating_n, settings) / service.bearing_life_min_h,
        rows.static_rating_n / (service.static_safety_min * force_n),
        rows.static_rating_n / (service.overload_static_safety_min * overload * force_n),
    )
    return np.nan_to_num(reduce(np.minimum, shares), nan=0.0) - 1.0


def bush_pv(gears: GearSet, width_mm: Numbers, motor: Motor, settings: ActuatorSettings) -> Numbers:
    """Pressure times sliding speed of the bushes in MPa m/s, at the duty's mean torque and mean speed."""
    pin = settings.parts.carrier.pin_diameter_mm
    torque = settings.parts.duty.mean_share * gears.ratio * motor.peak_torque_n_m
    pressure = planet_force_n(gears, torque, settings) / (pin * width_mm)
    return pressure * 0.5e-3 * pin * planet_turns(gears) * settings.service.mean_speed_rad_per_s


def bush_pv_limit(settings: ActuatorSettings) -> float:
    """What the bushes' material bears without end."""
    return settings.materials.bush_bronze.pv_limit_mpa_m_per_s


def planet_width_mm(gears: GearSet, motor: Motor, settings: ActuatorSettings) -> Numbers:
    """Least face width at which the planets' bearings hold; 0 where none is wide enough, which a rule then says."""
    if "planet_bearing" in settings.constraints_off:
        return np.zeros(np.shape(gears.sun_teeth))[()]
    if settings.planet_bearing == "bushes":
        return bush_pv(gears, 1.0, motor, settings) / bush_pv_limit(settings)
    turns = np.atleast_1d(planet_turns(gears))
    force = np.atleast_1d(planet_force_n(gears, gears.ratio * motor.peak_torque_n_m, settings))
    needed, left = np.zeros(turns.shape), np.arange(len(turns))
    for width in choices_mm(settings):
        holds = np.asarray(_needle_margin(turns[left], force[left], width, settings)) >= 0.0
        needed[left[holds]] = width
        left = left[~holds]
        if not len(left):
            break
    return needed.reshape(np.shape(gears.sun_teeth))[()]

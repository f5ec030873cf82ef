"""The rules ``output_bearing`` and ``planet_bearing`` once more, plainly, for one gear set: an oracle for the search.

Written from ISO 281, ISO 76 and ISO/TS 16281: f_c is read from the standard's table, contacts follow from Hertz with
complete elliptic integrals, and the row's balance is found by bisection, ball by ball.
"""

from functools import lru_cache
from math import cos, pi, sin

import numpy as np
from scipy.optimize import brentq
from scipy.special import ellipe, ellipk

from pareto_monoped.actuator.bearings import rated_bearing
from pareto_monoped.actuator.needles import roller_bearing

# ISO 281, table 7: f_c of radial roller bearings by the needle's over the pitch diameter.
F_C = {0.10: 84.2, 0.12: 86.4, 0.14: 87.7, 0.16: 88.5, 0.18: 88.8, 0.20: 88.7, 0.22: 88.2, 0.24: 87.5, 0.26: 86.4}


def hours(loads, rating, exponent, duty, service, speed=1.0):
    """L10 of the duty's levels in hours; each level uses up its turns' share of the life that it alone would leave."""
    used = 0.0
    for load, angle in zip(loads, duty.output_angles_rad, strict=True):
        turns_per_hour = 60.0 * service.jumps_per_minute * speed * angle / (2.0 * pi)
        used += turns_per_hour / (1e6 * (rating / load) ** exponent)
    return 1.0 / used


def needles_hold(motor, gears, width, settings):
    """Life and both static safeties of the needles that a planet of this width has room for."""
    data, duty, service = settings.parts.needles, settings.parts.duty, settings.service
    pin, needle = settings.parts.carrier.pin_diameter_mm, data.diameter_mm
    pitch, count = pin + needle, 3
    while (count + 1) * needle <= pi * pitch * (needle / pitch) / np.arcsin(needle / pitch):
        count += 1
    fitting = [(rows * one, rows, one) for rows in (1, 2) for one in data.lengths_mm if rows * one <= width + 1e-9]
    if not fitting:
        return False
    _, rows, one = max(fitting)
    carries = rows * (one - 2.0 * data.end_mm)
    f_c = float(np.interp(needle / pitch, list(F_C), list(F_C.values())))
    dynamic = 1.1 * f_c * carries ** (7.0 / 9.0) * count**0.75 * needle ** (29.0 / 27.0)
    static = 44.0 * (1.0 - needle / pitch) * count * carries * needle
    ratio = 1.0 + gears.ring_teeth / gears.sun_teeth
    radius = gears.module_mm * ((gears.sun_teeth + gears.planet_teeth) / 2.0 + gears.centre_shift)
    sharing = settings.parts.rating.load_sharing_fixed[gears.planets - 2]
    force = 1e3 * sharing * ratio * motor.peak_torque_n_m / gears.planets / radius
    loads = [share * force for share in duty.torque_shares]
    spin = gears.ring_teeth / gears.planet_teeth
    return (
        hours(loads, dynamic, 10.0 / 3.0, duty, service, spin) >= service.bearing_life_min_h
        and static / force >= service.static_safety_min
        and static / (settings.parts.rating.overload_factor * force) >= service.overload_static_safety_min
    )


@lru_cache(maxsize=32)
def spring(bore):
    """Force of a ball between both rings over the approach to the power 1.5, N/mm^1.5; curvatures in 1/mm."""
    bearing = rated_bearing(bore)
    ball, gamma = bearing.ball_diameter_mm, bearing.ball_diameter_mm / bearing.pitch_diameter_mm
    modulus, soft = 207e3 / (1.0 - 0.3**2), 0.0
    for ring in (2.0 / ball / (1.0 / gamma - 1.0), -2.0 / ball / (1.0 / gamma + 1.0)):
        across, along = 2.0 / ball - 1.0 / (0.52 * ball), 2.0 / ball + ring
        total = across + along
        wanted = (along - across) / total

        def miss(k, wanted=wanted):
            m = 1.0 - 1.0 / k**2
            first, second = ellipk(m), ellipe(m)
            return ((k**2 + 1.0) * second - 2.0 * first) / ((k**2 - 1.0) * second) - wanted

        k = brentq(miss, 1.01, 200.0)
        m = 1.0 - 1.0 / k**2
        first, second = ellipk(m), ellipe(m)
        # Hertz: approach of two bodies, both of modulus E / (1 - nu^2).
        unit = 2.0 / modulus  # compliance of both bodies
        axis = (3.0 * k**2 * second * unit / (pi * total)) ** (1.0 / 3.0)  # times Q^(1/3), half the long axis
        soft += 3.0 * first * unit / (2.0 * pi * axis)  # times Q^(2/3), approach
    return soft**-1.5


def row(bore, force, clearance):
    """Equivalent load, force on the worst ball and shift of a row under a radial force."""
    bearing, stiff = rated_bearing(bore), spring(bore)
    angles = [2.0 * pi * (j + 0.5) / bearing.balls for j in range(bearing.balls)]

    def balls(shift):
        return [stiff * max(shift * cos(a) - clearance / 2.0, 0.0) ** 1.5 for a in angles]

    shift = brentq(lambda s: sum(q * cos(a) for q, a in zip(balls(s), angles, strict=True)) - force, 1e-9, 2.0)
    loads = np.array(balls(shift))
    gamma = bearing.ball_diameter_mm / bearing.pitch_diameter_mm
    bracket = (1.044 * ((1.0 - gamma) / (1.0 + gamma)) ** 1.72) ** (10.0 / 3.0)
    inner = bearing.dynamic_rating_n / (0.407 * bearing.balls) * (1.0 + bracket) ** 0.3
    outer = bearing.dynamic_rating_n / (0.389 * bearing.balls) * (1.0 + 1.0 / bracket) ** 0.3
    lives = (inner / np.mean(loads**3) ** (1 / 3)) ** (-10 / 3) + (outer / np.mean(loads ** (10 / 3)) ** 0.3) ** (
        -10 / 3
    )
    return bearing.dynamic_rating_n * lives**0.3, float(loads.max()), shift


def output_holds(motor, gears, main, settings):
    """Life, static safeties and tilt of both bearings of the knee's output; ``main`` is bore, outer diameter, width."""
    service, duty, overload = settings.service, settings.parts.duty, settings.parts.rating.overload_factor
    torque = (1.0 + gears.ring_teeth / gears.sun_teeth) * motor.peak_torque_n_m
    pull = 1e3 * torque / service.chain_radius_mm
    # From the chain back to the middle of the main bearing: flange 3, groove's wall 0.75, retaining ring (DIN 471).
    ring = next(
        s for last, s in ((26, 1.2), (35, 1.5), (48, 1.75), (63, 2.0), (82, 2.5), (100, 3.0)) if main[0] <= last
    )
    back, front = service.chain_offset_mm + 3.0 + 0.75 + ring + main[2] / 2.0, service.drive_support_mm
    near, far = pull * front / (back + front), pull * back / (back + front)
    bearing, support = rated_bearing(float(main[0])), roller_bearing(service.drive_support_bearing)
    ball_limit = 5.0 * bearing.static_rating_n / bearing.balls

    def at(force):
        return row(float(main[0]), force, service.bearing_clearance_mm)

    loads = [at(share * near)[0] for share in duty.torque_shares]
    shift = max(at(near)[2], service.drive_support_clearance_mm / 2.0)
    rollers = [share * far for share in duty.torque_shares]
    return (
        hours(loads, bearing.dynamic_rating_n, 3.0, duty, service) >= service.bearing_life_min_h
        and ball_limit / at(near)[1] >= service.static_safety_min
        and ball_limit / at(overload * near)[1] >= service.overload_static_safety_min
        and hours(rollers, support.dynamic_rating_n, 10.0 / 3.0, duty, service) >= service.bearing_life_min_h
        and support.static_rating_n / far >= service.static_safety_min
        and support.static_rating_n / (overload * far) >= service.overload_static_safety_min
        and sin(shift / (back + front)) <= service.bearing_tilt_limit_rad
    )

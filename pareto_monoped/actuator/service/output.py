"""The output of a knee actuator between its two supports: forces, tilt, and what the rules ask of the bearings.

The chain pulls at the sprocket. The main bearing lies behind it in the actuator, the far bearing in front of it in the
hip coupling. All functions take one actuator or arrays of them.
"""

from collections.abc import Callable
from functools import lru_cache, reduce

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.actuator.bearings import RatedBearing, rated_bearing
from pareto_monoped.actuator.layout import Layout
from pareto_monoped.actuator.needles import LIFE_EXPONENT
from pareto_monoped.actuator.roller_bearings import roller_bearing
from pareto_monoped.actuator.service.ball_row import row_load
from pareto_monoped.actuator.service.data import ServiceData
from pareto_monoped.actuator.service.duty import life_turns, output_turns_per_hour
from pareto_monoped.actuator.settings import ActuatorSettings
from pareto_monoped.geometry.shapes import Numbers

Floats = NDArray[np.float64]

_FORCES_N = np.geomspace(1.0, 1e6, 400)
"""Radial forces at which a row is tabulated; 3.5 percent apart, so that interpolation in logarithms errs by 1e-5."""


def main_bearing_depth_mm(at: Layout) -> Numbers:
    """How far the middle of the main bearing lies behind the output face."""
    return -0.5 * (at.z_bearing_front + at.z_bearing_back)


def chain_pull_n(output_torque_n_m: Numbers, service: ServiceData) -> Numbers:
    """Pull of the chain at a torque of the knee's output."""
    return output_torque_n_m / (1e-3 * service.chain_radius_mm)


def knee_forces_n(output_torque_n_m: Numbers, at: Layout, service: ServiceData) -> tuple[Numbers, Numbers]:
    """Radial forces on main and far bearing; the chain pulls between them, and both are pivots."""
    pull = chain_pull_n(output_torque_n_m, service)
    near, far = service.chain_offset_mm + main_bearing_depth_mm(at), service.drive_support_mm
    return pull * far / (near + far), pull * near / (near + far)


def line_tilt_rad(output_torque_n_m: Numbers, at: Layout, service: ServiceData) -> Numbers:
    """Greatest angle between the output's axis and that of its bearings.

    Each support gives way by half its clearance and, the main bearing, by the compression of its balls. The chain pulls
    both the same way; the greater shift over their distance is the largest angle that any wear of the other leaves.
    """
    force, _ = knee_forces_n(output_torque_n_m, at, service)
    span = service.chain_offset_mm + main_bearing_depth_mm(at) + service.drive_support_mm
    shift = _tabulated(at, force, service, 2)
    return np.maximum(shift, 0.5 * service.drive_support_clearance_mm) / span


def output_margins(
    output_torque_n_m: Numbers, at: Layout, settings: ActuatorSettings
) -> dict[str, tuple[Numbers, float]]:
    """Life, static safeties and tilt of the output's bearings at the knee, each with what the settings ask for.

    The hip is left out: its main bearing carries foot force and weight, a tenth of the chain's pull.
    """
    service, duty = settings.service, settings.parts.duty
    overload = settings.parts.rating.overload_factor
    main, far = knee_forces_n(output_torque_n_m, at, service)
    support = roller_bearing(service.drive_support_bearing)
    per_hour = output_turns_per_hour(duty, service)
    levels = [_tabulated(at, share * main, service, 0) for share in duty.torque_shares]
    rollers = life_turns([share * far for share in duty.torque_shares], support.dynamic_rating_n, LIFE_EXPONENT, duty)
    return {
        "main life": (life_turns(levels, _ratings_n(at), 3.0, duty) / per_hour, service.bearing_life_min_h),
        "main s0": (_tabulated(at, main, service, 1), service.static_safety_min),
        "main overload s0": (_tabulated(at, overload * main, service, 1), service.overload_static_safety_min),
        "far life": (rollers / per_hour, service.bearing_life_min_h),
        "far s0": (support.static_rating_n / far, service.static_safety_min),
        "far overload s0": (support.static_rating_n / (overload * far), service.overload_static_safety_min),
        "tilt": (1.0 / line_tilt_rad(output_torque_n_m, at, service), 1.0 / service.bearing_tilt_limit_rad),
    }


def output_margin(output_torque_n_m: Numbers, at: Layout, settings: ActuatorSettings) -> Numbers:
    """The least of ``output_margins`` over what is asked for, less 1; -1 where the catalogue has no main bearing."""
    shares = [value / least for value, least in output_margins(output_torque_n_m, at, settings).values()]
    return np.nan_to_num(reduce(np.minimum, shares), nan=0.0) - 1.0


def _ratings_n(at: Layout) -> Numbers:
    """C of the main bearing."""
    return _by_bearing(at, lambda bearing, _: np.asarray(bearing.dynamic_rating_n), np.zeros(()))


def _tabulated(at: Layout, force_n: Numbers, service: ServiceData, column: int) -> Numbers:
    """Equivalent load, static safety or shift of the main bearing under a radial force, from its table."""

    def read(bearing: RatedBearing, force: Floats) -> Floats:
        table = _table(bearing, service.bearing_clearance_mm)[column]
        return np.exp(np.interp(np.log(force), np.log(_FORCES_N), np.log(table)))

    return _by_bearing(at, read, np.asarray(force_n, dtype=np.float64))


def _by_bearing(at: Layout, read: Callable[[RatedBearing, Floats], Floats], force: Floats) -> Numbers:
    """A function of bearing and force for every row of ``at``; NaN where there is no bearing."""
    bore = np.asarray(at.bearing.inner_diameter_mm, dtype=np.float64)
    shape = np.broadcast_shapes(bore.shape, force.shape)
    bores, forces = (np.broadcast_to(values, shape) for values in (bore, force))
    found = np.full(shape, np.nan)
    for one in np.unique(bores[np.isfinite(bores)]):
        rows = bores == one
        found[rows] = read(rated_bearing(float(one)), forces[rows])
    return found[()]


@lru_cache(maxsize=64)
def _table(bearing: RatedBearing, clearance_mm: float) -> tuple[Floats, Floats, Floats]:
    """Equivalent load, static safety and shift of a row at ``_FORCES_N``."""
    row = row_load(bearing, _FORCES_N, 0.0 * _FORCES_N, clearance_mm)
    return row.equivalent_n, row.static_safety, row.shift_mm

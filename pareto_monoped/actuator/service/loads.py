"""Loads on the bearings of output and planets, and what the rules ask of them, for one actuator or arrays of them.

The chain pulls at the knee's sprocket. The main bearing lies behind it in the actuator, the far bearing in front of it
in the hip coupling. The main bearing is a row of balls under a radial force and a tilting moment, by the static model
of ISO/TS 16281 (Harris, Rolling Bearing Analysis, ch. 7): rigid rings, each ball a Hertzian spring between the centres
of its two grooves. The inner ring moves by ``shift`` along the force and turns by ``tilt`` about the axis across it, so
that balls on opposite sides are pressed against opposite flanks. Lengths in mm, forces in N.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache, reduce

import numpy as np

from pareto_monoped.actuator.assumptions import ServiceData, life_turns, output_turns_per_hour
from pareto_monoped.actuator.bearings import RatedBearing, rated_bearing
from pareto_monoped.actuator.gearset import GearSet, load_sharing
from pareto_monoped.actuator.layout import Layout
from pareto_monoped.actuator.motor import Motor
from pareto_monoped.actuator.needles import LIFE_EXPONENT, choices_mm, needle_rows, roller_bearing
from pareto_monoped.actuator.settings import ActuatorSettings
from pareto_monoped.errors import SimulationError, complaint
from pareto_monoped.geometry.shapes import Floats, Numbers

GROOVE = 0.52
"""Groove radius over ball diameter, as ISO 281 and ISO 76 assume for deep groove ball bearings."""
_YOUNGS_MODULUS_MPA, _POISSON_RATIO = 207_000.0, 0.3  # bearing steel, as in ISO/TS 16281 and ISO 76
_STEPS, _TOLERANCE = 60, 1e-8  # Newton's; the tolerance is relative to the load
_TRACE = 1e-9  # of the stiffness of a ball pressed by the free distance of the grooves
_STRIBECK = 5.0  # ISO 76: the most loaded ball carries 5 / Z of a radial force


@dataclass(frozen=True, slots=True, kw_only=True)
class RowLoad:
    """How a row carries its loads; shape (n,) for n loads."""

    shift_mm: Floats  #: of the inner ring
    tilt_rad: Floats  #: likewise
    largest_n: Floats  #: force on the most loaded ball
    equivalent_n: Floats  #: radial force that would give the same rating life (dynamic equivalent load P)
    static_safety: Floats  #: static rating over the load, judged by the most loaded ball (s0)


def row_load(bearing: RatedBearing, force_n: Floats, moment_n_m: Floats, clearance_mm: float) -> RowLoad:
    """Return a single row under radial forces and moments in the same plane.

    ``force_n``: radial force, not negative, shape (n,); ``moment_n_m``: tilting moment, likewise; force and moment are
    not both zero.

    Raises:
        SimulationError: no balance was found.
    """
    force, moment = np.asarray(force_n, dtype=np.float64), 1e3 * np.asarray(moment_n_m, dtype=np.float64)
    row = _Row(bearing, clearance_mm)
    shift, tilt = row.balance(force, moment)
    balls = row.forces(shift, tilt)[0]
    largest = balls.max(axis=-1)
    return RowLoad(
        shift_mm=shift,
        tilt_rad=tilt,
        largest_n=largest,
        equivalent_n=_equivalent_n(bearing, balls),
        static_safety=_STRIBECK * bearing.static_rating_n / bearing.balls / largest,
    )


class _Row:
    """Geometry and stiffness of one row."""

    def __init__(self, bearing: RatedBearing, clearance_mm: float) -> None:
        ball = bearing.ball_diameter_mm
        self.balls = bearing.balls
        # The middle of a space lies on the force's line, so that neighbours share the load.
        self.cosine = np.cos(2.0 * np.pi * (np.arange(bearing.balls) + 0.5) / bearing.balls)
        self.free_mm = (2.0 * GROOVE - 1.0) * ball  # distance of the groove centres at which a ball just touches both
        self.radial_mm = self.free_mm - 0.5 * clearance_mm
        self.arm_mm = 0.5 * bearing.pitch_diameter_mm + (GROOVE - 0.5) * ball  # of the inner groove's centre
        self.stiffness = contact_stiffness(bearing)

    def forces(self, shift: Floats, tilt: Floats) -> tuple[Floats, Floats, Floats, Floats]:
        """Return force, its radial and axial share, and distance of groove centres of each ball, shape (n, balls)."""
        radial = self.radial_mm + shift[:, None] * self.cosine
        axial = self.arm_mm * tilt[:, None] * self.cosine
        distance = np.hypot(radial, axial)
        force = self.stiffness * np.maximum(distance - self.free_mm, 0.0) ** 1.5
        return force, radial / distance, axial / distance, distance

    def balance(self, force: Floats, moment: Floats) -> tuple[Floats, Floats]:
        """Return the shift and tilt at which the balls carry the loads.

        Newton's method on the elastic energy less the work of the loads, which is convex. Steps are halved until the
        energy falls.
        """
        load = force + moment / self.arm_mm
        press = (_STRIBECK * load / (self.balls * self.stiffness)) ** (2.0 / 3.0)
        share = force / load
        shift = share * (press + self.free_mm - self.radial_mm) / self.cosine.max()
        tilt = (1.0 - share) * np.sqrt((self.free_mm + press) ** 2 - self.radial_mm**2) / self.arm_mm
        for _ in range(_STEPS):
            ball, along, across, distance = self.forces(shift, tilt)
            pull = force - (ball * along * self.cosine).sum(-1)
            turn = moment - self.arm_mm * (ball * across * self.cosine).sum(-1)
            if np.max((np.abs(pull) + np.abs(turn) / self.arm_mm) / load) < _TOLERANCE:
                return shift, tilt
            # Second derivatives of a ball's energy: along its line of contact, and across it.
            with np.errstate(divide="ignore", invalid="ignore"):
                stiff = np.where(ball > 0.0, 1.5 * ball / (distance - self.free_mm), 0.0)
            sway = ball / distance
            square = self.cosine**2
            a = ((stiff * along**2 + sway * across**2) * square).sum(-1)
            b = self.arm_mm * (((stiff - sway) * along * across) * square).sum(-1)
            c = self.arm_mm**2 * ((stiff * across**2 + sway * along**2) * square).sum(-1)
            # Without a ball in contact the energy is linear; a trace of stiffness then leads back to one.
            trace = _TRACE * self.stiffness * np.sqrt(self.free_mm)
            a, c = a + trace, c + trace * self.arm_mm**2
            determinant = a * c - b * b
            step_shift, step_tilt = (c * pull - b * turn) / determinant, (a * turn - b * pull) / determinant
            shift, tilt = self._shortened(shift, tilt, step_shift, step_tilt, force, moment)
        raise SimulationError(
            complaint("force, moment on a row", (force.tolist(), moment.tolist()), "finite and bearable", "lower them")
        )

    def _shortened(
        self, shift: Floats, tilt: Floats, step_shift: Floats, step_tilt: Floats, force: Floats, moment: Floats
    ) -> tuple[Floats, Floats]:
        start, part = self._energy(shift, tilt, force, moment), np.ones_like(shift)
        for _ in range(_STEPS):
            energy = self._energy(shift + part * step_shift, tilt + part * step_tilt, force, moment)
            higher = energy > start + 1e-12 * np.abs(start)
            if not higher.any():
                break
            part = np.where(higher, 0.5 * part, part)
        return shift + part * step_shift, tilt + part * step_tilt

    def _energy(self, shift: Floats, tilt: Floats, force: Floats, moment: Floats) -> Floats:
        distance = self.forces(shift, tilt)[3]
        pressed = np.maximum(distance - self.free_mm, 0.0)
        stored: Floats = 0.4 * self.stiffness * (pressed**2.5).sum(-1)
        return stored - force * shift - moment * tilt


def contact_stiffness(bearing: RatedBearing) -> float:
    """Return the force of one ball between both rings over the approach of the grooves to the power 1.5, in N/mm^1.5.

    Hertz with the closed approximations of the elliptic integrals by Hamrock and Dowson (Ball Bearing Lubrication,
    1981, ch. 3); they hold to 3 percent.
    """
    ball = bearing.ball_diameter_mm
    gamma = ball / bearing.pitch_diameter_mm
    modulus = _YOUNGS_MODULUS_MPA / (1.0 - _POISSON_RATIO**2)  # E' of two bodies of the same steel
    across = 1.0 / (2.0 / ball - 1.0 / (GROOVE * ball))
    softness = 0.0
    for along in (0.5 * ball * (1.0 - gamma), 0.5 * ball * (1.0 + gamma)):  # inner ring, outer ring
        radius = 1.0 / (1.0 / along + 1.0 / across)
        ratio = across / along
        ellipticity = ratio ** (2.0 / np.pi)
        second = 1.0 + (0.5 * np.pi - 1.0) / ratio
        first = 0.5 * np.pi + (0.5 * np.pi - 1.0) * np.log(ratio)
        stiffness = np.pi * ellipticity * modulus * np.sqrt(second * radius / (4.5 * first**3))
        softness += stiffness ** (-2.0 / 3.0)
    return float(softness**-1.5)


def _equivalent_n(bearing: RatedBearing, balls: Floats) -> Floats:
    """Return the equivalent load by the rating life of both rings (ISO/TS 16281, clause 4: the inner turns)."""
    gamma = bearing.ball_diameter_mm / bearing.pitch_diameter_mm
    # Both grooves have the same radius, so that their ratio in the standard's bracket is 1.
    bracket = (1.044 * ((1.0 - gamma) / (1.0 + gamma)) ** 1.72) ** (10.0 / 3.0)
    count, rating = bearing.balls, bearing.dynamic_rating_n
    inner_rating = rating / (0.407 * count) * (1.0 + bracket) ** 0.3
    outer_rating = rating / (0.389 * count) * (1.0 + 1.0 / bracket) ** 0.3
    inner = np.mean(balls**3, axis=-1) ** (1.0 / 3.0)
    outer = np.mean(balls ** (10.0 / 3.0), axis=-1) ** 0.3
    life = ((inner_rating / inner) ** (-10.0 / 3.0) + (outer_rating / outer) ** (-10.0 / 3.0)) ** -0.9
    equivalent: Floats = rating / life ** (1.0 / 3.0)
    return equivalent


_FORCES_N = np.geomspace(1.0, 1e6, 400)
"""Radial forces at which a row is tabulated; 3.5 percent apart, so that interpolation in logarithms errs by 1e-5."""


def main_bearing_depth_mm(at: Layout) -> Numbers:
    """Return how far the middle of the main bearing lies behind the output face."""
    return -0.5 * (at.z_bearing_front + at.z_bearing_back)


def knee_forces_n(output_torque_n_m: Numbers, at: Layout, service: ServiceData) -> tuple[Numbers, Numbers]:
    """Return the radial forces on main and far bearing; the chain pulls between them, and both are pivots."""
    pull = output_torque_n_m / (1e-3 * service.chain_radius_mm)
    near, far = service.chain_offset_mm + main_bearing_depth_mm(at), service.drive_support_mm
    return pull * far / (near + far), pull * near / (near + far)


def line_tilt_rad(output_torque_n_m: Numbers, at: Layout, service: ServiceData) -> Numbers:
    """Return the greatest angle between the output's axis and that of its bearings.

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
    """Return the life, static safeties and tilt of the output's bearings at the knee, each with what the settings ask
    for.

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
        "main life": (
            life_turns(
                levels,
                _by_bearing(at, lambda bearing, _: np.asarray(bearing.dynamic_rating_n), np.zeros(())),
                3.0,
                duty,
            )
            / per_hour,
            service.bearing_life_min_h,
        ),
        "main s0": (_tabulated(at, main, service, 1), service.static_safety_min),
        "main overload s0": (_tabulated(at, overload * main, service, 1), service.overload_static_safety_min),
        "far life": (rollers / per_hour, service.bearing_life_min_h),
        "far s0": (support.static_rating_n / far, service.static_safety_min),
        "far overload s0": (support.static_rating_n / (overload * far), service.overload_static_safety_min),
        "tilt": (1.0 / line_tilt_rad(output_torque_n_m, at, service), 1.0 / service.bearing_tilt_limit_rad),
    }


def output_margin(output_torque_n_m: Numbers, at: Layout, settings: ActuatorSettings) -> Numbers:
    """Return the least of ``output_margins`` over what is asked for, less 1; -1 without main bearing."""
    shares = [value / least for value, least in output_margins(output_torque_n_m, at, settings).values()]
    return np.nan_to_num(reduce(np.minimum, shares), nan=0.0) - 1.0


def _tabulated(at: Layout, force_n: Numbers, service: ServiceData, column: int) -> Numbers:
    """Return the equivalent load, static safety or shift of the main bearing under a radial force, from its table."""

    def read(bearing: RatedBearing, force: Floats) -> Floats:
        table = _table(bearing, service.bearing_clearance_mm)[column]
        return np.exp(np.interp(np.log(force), np.log(_FORCES_N), np.log(table)))

    return _by_bearing(at, read, np.asarray(force_n, dtype=np.float64))


def _by_bearing(at: Layout, read: Callable[[RatedBearing, Floats], Floats], force: Floats) -> Numbers:
    """Return a function of bearing and force for every row of ``at``; NaN where there is no bearing."""
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
    """Return the equivalent load, static safety and shift of a row at ``_FORCES_N``."""
    row = row_load(bearing, _FORCES_N, 0.0 * _FORCES_N, clearance_mm)
    return row.equivalent_n, row.static_safety, row.shift_mm


def planet_force_n(gears: GearSet, output_torque_n_m: Numbers, settings: ActuatorSettings) -> Numbers:
    """Return the force of the most loaded planet on its pin: n F = K_gamma T / r, with the carrier's radius r."""
    sharing = load_sharing(gears.planets, settings)
    return 1e3 * sharing * output_torque_n_m / (gears.planets * gears.carrier_radius_mm)


def planet_turns(gears: GearSet) -> Numbers:
    """Return the turns of a planet against the carrier over the output's (Willis, ring fixed)."""
    return gears.ring_teeth / gears.planet_teeth


def _life_h(turns: Numbers, force_n: Numbers, dynamic_rating_n: Numbers, settings: ActuatorSettings) -> Numbers:
    duty = settings.parts.duty
    life = life_turns([share * force_n for share in duty.torque_shares], dynamic_rating_n, LIFE_EXPONENT, duty)
    return life / (output_turns_per_hour(duty, settings.service) * turns)


def planet_margin(gears: GearSet, width_mm: Numbers, motor: Motor, settings: ActuatorSettings) -> Numbers:
    """Return the least of life, static safeties or pv over what the settings ask for, less 1."""
    if settings.planet_bearing == "needles":
        force = planet_force_n(gears, gears.ratio * motor.peak_torque_n_m, settings)
        return _needle_margin(planet_turns(gears), force, width_mm, settings)
    return bush_pv_limit(settings) / bush_pv(gears, width_mm, motor, settings) - 1.0


def _needle_margin(turns: Numbers, force_n: Numbers, width_mm: Numbers, settings: ActuatorSettings) -> Numbers:
    rows, service, overload = needle_rows(width_mm, settings), settings.service, settings.parts.rating.overload_factor
    shares = (
        _life_h(turns, force_n, rows.dynamic_rating_n, settings) / service.bearing_life_min_h,
        rows.static_rating_n / (service.static_safety_min * force_n),
        rows.static_rating_n / (service.overload_static_safety_min * overload * force_n),
    )
    return np.nan_to_num(reduce(np.minimum, shares), nan=0.0) - 1.0


def bush_pv(gears: GearSet, width_mm: Numbers, motor: Motor, settings: ActuatorSettings) -> Numbers:
    """Return the pressure times sliding speed of the bushes in MPa m/s, at the duty's mean torque and mean speed."""
    pin = settings.parts.carrier.pin_diameter_mm
    torque = settings.parts.duty.mean_share * gears.ratio * motor.peak_torque_n_m
    pressure = planet_force_n(gears, torque, settings) / (pin * width_mm)
    return pressure * 0.5e-3 * pin * planet_turns(gears) * settings.service.mean_speed_rad_per_s


def bush_pv_limit(settings: ActuatorSettings) -> float:
    """Return what the bushes' material bears without end."""
    return settings.materials.bush_bronze.pv_limit_mpa_m_per_s


def planet_width_mm(gears: GearSet, motor: Motor, settings: ActuatorSettings) -> Numbers:
    """Return the least face width at which the planets' bearings hold; 0 where none does, which a rule says."""
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

"""A row of balls under a radial force and a tilting moment: how they share the load, and the life that is left.

The static model of ISO/TS 16281 (Harris, Rolling Bearing Analysis, ch. 7): rigid rings, each ball a Hertzian spring
between the centres of its two grooves. The inner ring moves by ``shift`` along the force and turns by ``tilt`` about
the axis across it, so that balls on opposite sides are pressed against opposite flanks. Lengths in mm, forces in N.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.actuator.bearings import RatedBearing
from pareto_monoped.errors import SimulationError, complaint

Floats = NDArray[np.float64]

GROOVE = 0.52
"""Groove radius over ball diameter, as ISO 281 and ISO 76 assume for deep groove ball bearings."""
_YOUNGS_MODULUS_MPA, _POISSON_RATIO = 207_000.0, 0.3  # bearing steel, as in ISO/TS 16281 and ISO 76
_STEPS, _TOLERANCE = 60, 1e-8  # Newton's; the tolerance is relative to the load
_TRACE = 1e-9  # of the stiffness of a ball pressed by the free distance of the grooves
_STRIBECK = 5.0  # ISO 76: the most loaded ball carries 5 / Z of a radial force


@dataclass(frozen=True, slots=True, kw_only=True)
class RowLoad:
    """How a row carries its loads; shape (n,) for n loads.

    Attributes:
        shift_mm, tilt_rad: of the inner ring.
        largest_n: force on the most loaded ball.
        equivalent_n: radial force that would give the same rating life (dynamic equivalent load P).
        static_safety: static rating over the load, judged by the most loaded ball (s0).
    """

    shift_mm: Floats
    tilt_rad: Floats
    largest_n: Floats
    equivalent_n: Floats
    static_safety: Floats


def row_load(bearing: RatedBearing, force_n: Floats, moment_n_m: Floats, clearance_mm: float) -> RowLoad:
    """A single row under radial forces and moments in the same plane.

    Args:
        bearing: the bearing.
        force_n: radial force, not negative, shape (n,).
        moment_n_m: tilting moment, likewise; force and moment are not both zero.
        clearance_mm: radial internal clearance when fitted.

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
        """Force, force's radial and axial share, and distance of the groove centres of each ball, shape (n, balls)."""
        radial = self.radial_mm + shift[:, None] * self.cosine
        axial = self.arm_mm * tilt[:, None] * self.cosine
        distance = np.hypot(radial, axial)
        force = self.stiffness * np.maximum(distance - self.free_mm, 0.0) ** 1.5
        return force, radial / distance, axial / distance, distance

    def balance(self, force: Floats, moment: Floats) -> tuple[Floats, Floats]:
        """Shift and tilt at which the balls carry the loads.

        Newton's method on the elastic energy less the work of the loads, which is convex. Steps are halved until the
        energy falls.

        Raises:
            SimulationError: no balance was found.
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
    """Force of one ball between both rings over the approach of the grooves to the power 1.5, in N/mm^1.5.

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
    """Dynamic equivalent load by the rating life of both rings (ISO/TS 16281, clause 4: the inner ring turns)."""
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

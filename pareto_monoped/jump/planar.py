"""The engine ``compiled``: the planar leg's equations of motion and constraints written out, compiled by numba.

It makes the steps of MuJoCo's semi-implicit Euler integrator with the controller's own function and record, so that
both engines give the same jump but for rounding; docs/model.md, "The compiled engine", derives the equations. Only
what MuJoCo computes for the engine ``mujoco`` is written here: mass matrix, bias, springs, dampers, contact, friction.
Coordinates have the order of ``model.coordinates``.
"""

import zlib
from collections.abc import Callable
from functools import lru_cache
from typing import Any

import numpy as np

from pareto_monoped.compute.compiled import compiled, inlined, inner
from pareto_monoped.design import GRAVITY_M_PER_S2, Floats
from pareto_monoped.jump.controller import DIVERGED, FLYING, control, places, turned
from pareto_monoped.jump.controller_record import HIP, KNEE, origin
from pareto_monoped.jump.model import LEAST_IMPEDANCE

FLOOR = ("stiffness_n_per_m", "damping_n_s_per_m", "width_m", "impedance", "friction", "slip_ratio")
GROUND = np.dtype(
    [
        *((name, np.float64) for name in FLOOR),
        ("joint_friction_n_m", (np.float64, (2,))),
    ],
    align=True,
)
"""What the engine needs to know of a jump besides its ``RECORD``: the floor, and Coulomb friction of both joints."""

_ROOM = np.dtype(
    [
        *((name, np.float64, (6,)) for name in ("a", "force", "right")),
        ("arms", np.float64, (4, 2)),
        *((name, np.float64, (4, 4)) for name in ("matrix", "whole")),
        ("inverse", np.float64, (4,)),
        ("creeping", np.float64, (3,)),
        ("mode", np.int64, (4,)),
    ],
    align=True,
)
"""What a step computes. Numba counts references to arrays, which took a fifth of a jump's time, but none to the fields
of a record."""

_FRICTION_SHARE, _FRICTION_TIME_S = 9.0, 0.0095
"""Of MuJoCo's friction loss by its default parameters: d / (1 - d) with d = 0.9, and 0.95 times 0.02 s over 2."""
_TRIALS = 12  # of modes that follow from each other, before all are tried
_OFF, _STICKS, _SLIDES_UP, _SLIDES_DOWN = 0, 1, 2, 3
_MOST_ACCELERATION = 1e10  # beyond which MuJoCo gives a simulation up (mjMAXVAL)


@inlined
def _pose(thigh: tuple[float, float], shank: tuple[float, float], jump: Any, arms: Floats) -> None:
    """Fill ``arms``, shape (4, 2): hip to knee and to the thigh's centre, knee to the shank's centre and to the foot.

    ``thigh`` and ``shank``: sine and cosine of both links' angles.
    """
    arms[0, 0], arms[0, 1] = turned((0.0, -jump.thigh_length_m), thigh)
    arms[1, 0], arms[1, 1] = turned(jump.thigh_com_m, thigh)
    arms[2, 0], arms[2, 1] = turned(jump.shank_com_m, shank)
    arms[3, 0], arms[3, 1] = turned((0.0, -jump.shank_length_m), shank)


@inlined
def _inertia(arms: Floats, guided: bool, elastic: bool, jump: Any, matrix: Floats) -> None:
    """Fill the mass matrix of x, z, hip and knee, shape (4, 4), without the motors of elastic drives."""
    base_kg, thigh_kg, shank_kg = jump.body_mass_kg[0] + jump.stand_mass_kg, jump.body_mass_kg[1], jump.body_mass_kg[2]
    thigh_x, thigh_z, shank_x, shank_z = arms[1, 0], arms[1, 1], arms[2, 0], arms[2, 1]
    reach_x, reach_z = arms[0, 0] + shank_x, arms[0, 1] + shank_z
    mass = base_kg + thigh_kg + shank_kg
    matrix[0, 0] = matrix[1, 1] = mass
    matrix[1, 0] = 0.0
    matrix[2, 0] = 0.0 if guided else thigh_kg * thigh_z + shank_kg * reach_z
    matrix[3, 0] = 0.0 if guided else shank_kg * shank_z
    matrix[2, 1] = -thigh_kg * thigh_x - shank_kg * reach_x
    matrix[3, 1] = -shank_kg * shank_x
    below = jump.link_inertia_kg_m2[1]
    matrix[3, 3] = below + shank_kg * (shank_x * shank_x + shank_z * shank_z)
    matrix[3, 2] = below + shank_kg * (reach_x * shank_x + reach_z * shank_z)
    whole = jump.link_inertia_kg_m2[0] + thigh_kg * (thigh_x * thigh_x + thigh_z * thigh_z)
    matrix[2, 2] = whole + below + shank_kg * (reach_x * reach_x + reach_z * reach_z)
    if not elastic:  # what turns with the motors: 1/2 (C w^2 + 2 B w_hip w), as ``robot.tables`` has it
        matrix[2, 2] += jump.armature_kg_m2[HIP]
        matrix[3, 3] += jump.armature_kg_m2[KNEE]
        matrix[3, 2] += jump.coupling_kg_m2
    for i in range(4):
        for j in range(i):
            matrix[j, i] = matrix[i, j]


@inlined
def _forces(q: Floats, v: Floats, ctrl: Floats, arms: Floats, jump: Any, force: Floats) -> None:
    """Fill the forces of weight, motion, drives, dampers and stops on x, z, hip, knee, motor of hip and of knee."""
    z, hip, knee, hip_motor, knee_motor = places(len(q))
    thigh_kg, shank_kg = jump.body_mass_kg[1], jump.body_mass_kg[2]
    mass = jump.body_mass_kg[0] + jump.stand_mass_kg + thigh_kg + shank_kg
    turning, below = v[hip] * v[hip], (v[hip] + v[knee]) * (v[hip] + v[knee])
    # Centripetal accelerations of both centres; gravity is one of the frame upwards.
    thigh_x, thigh_z = -turning * arms[1, 0], -turning * arms[1, 1] + GRAVITY_M_PER_S2
    shank_x, shank_z = -turning * arms[0, 0] - below * arms[2, 0], -turning * arms[0, 1] - below * arms[2, 1]
    shank_z += GRAVITY_M_PER_S2
    base_kg = mass - thigh_kg - shank_kg
    force[0] = 0.0 if z == 0 else -thigh_kg * thigh_x - shank_kg * shank_x
    force[1] = -thigh_kg * thigh_z - shank_kg * shank_z - base_kg * GRAVITY_M_PER_S2
    force[3] = shank_kg * (arms[2, 0] * shank_z - arms[2, 1] * shank_x)
    force[2] = force[3] + thigh_kg * (arms[1, 0] * thigh_z - arms[1, 1] * thigh_x)
    force[2] += shank_kg * (arms[0, 0] * shank_z - arms[0, 1] * shank_x)
    for joint in range(2):
        motor = hip_motor if joint == HIP else knee_motor
        drive = ctrl[joint] - jump.joint_damping_n_m_s_per_rad[joint] * v[motor]
        if len(ctrl) > 2:
            force[2 + joint] += ctrl[2 + joint]
        if hip_motor == hip:
            force[2 + joint] += drive
        else:
            wound, play = q[motor] - q[hip + joint], 0.5 * jump.backlash_rad
            taut = wound - min(max(wound, -play), play)
            torque = jump.drive_n_m_per_rad[joint] * taut
            torque += jump.drive_n_m_s_per_rad[joint] * (v[motor] - v[hip + joint])
            force[2 + joint] += torque
            force[4 + joint] = drive - torque


@inlined
def _solve(matrix: Floats, right: Floats, a: Floats) -> None:
    """Solve with the lower triangle of a symmetric positive definite matrix, shape (4, 4), by L D L^T."""
    d0 = matrix[0, 0]
    inverse = 1.0 / d0
    l10, l20, l30 = matrix[1, 0] * inverse, matrix[2, 0] * inverse, matrix[3, 0] * inverse
    d1 = matrix[1, 1] - l10 * l10 * d0
    inverse = 1.0 / d1
    l21, l31 = (matrix[2, 1] - l20 * l10 * d0) * inverse, (matrix[3, 1] - l30 * l10 * d0) * inverse
    d2 = matrix[2, 2] - l20 * l20 * d0 - l21 * l21 * d1
    l32 = (matrix[3, 2] - l30 * l20 * d0 - l31 * l21 * d1) * (1.0 / d2)
    d3 = matrix[3, 3] - l30 * l30 * d0 - l31 * l31 * d1 - l32 * l32 * d2
    y0 = right[0]
    y1 = right[1] - l10 * y0
    y2 = right[2] - l20 * y0 - l21 * y1
    a3 = (right[3] - l30 * y0 - l31 * y1 - l32 * y2) / d3
    a2 = y2 / d2 - l32 * a3
    a1 = y1 / d1 - l21 * a2 - l31 * a3
    a[0], a[1], a[2], a[3] = y0 / d0 - l10 * a1 - l20 * a2 - l30 * a3, a1, a2, a3


@inlined
def _solve_all(matrix: Floats, right: Floats, added: tuple[float, float], elastic: bool, jump: Any, a: Floats) -> None:
    """Solve for all six accelerations, with inertias ``added`` to what both motors move.

    The motor of an elastic hip is coupled to nothing, and that of the knee to the hip, by B; both are eliminated first.
    """
    if not elastic:
        matrix[2, 2] += added[HIP]
        matrix[3, 3] += added[KNEE]
        _solve(matrix, right, a)
        a[4], a[5] = a[2], a[3]
        return
    coupling = jump.coupling_kg_m2
    hip_kg_m2, knee_kg_m2 = jump.armature_kg_m2[HIP] + added[HIP], jump.armature_kg_m2[KNEE] + added[KNEE]
    matrix[2, 2] -= coupling * coupling / knee_kg_m2
    right[2] -= coupling * right[5] / knee_kg_m2
    _solve(matrix, right, a)
    a[4], a[5] = right[4] / hip_kg_m2, (right[5] - coupling * a[2]) / knee_kg_m2


@inlined
def _add(matrix: Floats, right: Floats, row: Any, weight: float, wanted: float) -> None:
    """Add a constraint ``weight`` (``wanted`` - J a) along J = ``row`` to the equations; its lower triangle will do."""
    for i in range(4):
        for j in range(i + 1):
            matrix[i, j] += weight * row[i] * row[j]
        right[i] += weight * wanted * row[i]


@inlined
def _dot(row: Any, values: Floats) -> float:
    total: float = row[0] * values[0] + row[1] * values[1] + row[2] * values[2] + row[3] * values[3]
    return total


@inner
def _inverse_masses(guided: bool, elastic: bool, jump: Any, work: Any, inverse: Floats) -> None:
    """Fill A of z, of what the motors of hip and knee move, and of the foot, at the zero pose (docs/model.md)."""
    arms, matrix, whole, right, a = work
    _pose((0.0, 1.0), (0.0, 1.0), jump, arms)
    _inertia(arms, guided, elastic, jump, matrix)
    for k in range(3):
        whole[:] = matrix
        right[:] = 0.0
        place = 1 if k == 0 else (3 + k if elastic else 1 + k)
        right[place] = 1.0
        _solve_all(whole, right, (0.0, 0.0), elastic, jump, a)
        inverse[k] = a[place]
    x, z = arms[2, 0], arms[2, 1]
    rows = (
        (0.0 if guided else 1.0, 0.0, arms[0, 1] + z, z),
        (0.0, 1.0, -arms[0, 0] - x, -x),
    )
    inverse[3] = 0.0
    for row in rows:
        whole[:] = matrix
        right[:] = 0.0
        for i in range(4):
            right[i] = row[i]
        _solve_all(whole, right, (0.0, 0.0), elastic, jump, a)
        inverse[3] += _dot(row, a) / 3.0


@inlined
def _accelerate(q: Floats, v: Floats, ground: Any, jump: Any, inverse: Floats, mode: Any, work: Any, a: Floats) -> bool:
    """Fill the accelerations under all constraints, and return whether there are any.

    Every constraint's force is linear in the accelerations in one of its modes: floor off, sticking or sliding to
    either side; friction of rails, hip and knee below its limit or at either end of it. The solution is unique, so
    modes that lead to themselves are right. ``mode``, those of the last step, nearly always are.
    """
    arms, matrix, whole, force, right, creeping = work
    z, hip, knee, hip_motor, knee_motor = places(len(q))
    guided, elastic = z == 0, hip_motor != hip
    depth = jump.foot_radius_m - (q[z] + arms[0, 1] + arms[3, 1])
    stick = wanted_n = wanted_t = 0.0
    x, down = arms[3, 0], arms[3, 1] + 0.5 * depth - jump.foot_radius_m
    along = (0.0 if guided else 1.0, 0.0, arms[0, 1] + down, down)
    up = (0.0, 1.0, -arms[0, 0] - x, -x)
    if depth > 0.0:
        full = ground.impedance
        d = LEAST_IMPEDANCE + (full - LEAST_IMPEDANCE) * min(depth / ground.width_m, 1.0)
        stick = d / ((1.0 - d) * inverse[3])
        stiffness = ground.stiffness_n_per_m * inverse[3] * (1.0 - full) * d / (full * full)
        damping = ground.damping_n_s_per_m * inverse[3] * (1.0 - full) / full
        wanted_n = stiffness * depth - damping * (v[z] + up[2] * v[hip] + up[3] * v[knee])
        wanted_t = -damping * (along[0] * v[0] + along[2] * v[hip] + along[3] * v[knee])
    mu, slip = ground.friction, ground.slip_ratio
    slide = stick / (1.0 + mu * mu / slip)
    # Row k of the frictions acts on this entry of the forces, which has this speed, up to this limit.
    entries = (1, 4 if elastic else 2, 5 if elastic else 3)
    speeds = (v[z], v[hip_motor], v[knee_motor])
    limits = (jump.rail_friction_n, ground.joint_friction_n_m[HIP], ground.joint_friction_n_m[KNEE])

    for trial in range(_TRIALS + 4 * 27):
        if trial >= _TRIALS:
            code = trial - _TRIALS
            mode[0] = code % 4
            for k in range(3):
                mode[1 + k] = code // (4 * 3**k) % 3 - 1
        for i in range(4):
            for j in range(i + 1):
                whole[i, j] = matrix[i, j]
        for i in range(6):
            right[i] = force[i]
        if depth > 0.0:
            if mode[0] == _STICKS:
                _add(whole, right, up, stick, wanted_n)
                _add(whole, right, along, slip * stick, wanted_t)
            elif mode[0] != _OFF:
                signed = mu if mode[0] == _SLIDES_UP else -mu
                both = (signed * along[0], 1.0, up[2] + signed * along[2], up[3] + signed * along[3])
                _add(whole, right, both, slide, wanted_n + signed * wanted_t)
        creeping[:] = 0.0
        for k in range(3):
            if limits[k] > 0.0:
                if mode[1 + k] == 0:
                    creeping[k] = _FRICTION_SHARE / inverse[k]
                    right[entries[k]] -= creeping[k] * speeds[k] / _FRICTION_TIME_S
                else:
                    right[entries[k]] += mode[1 + k] * limits[k]
        whole[1, 1] += creeping[0]
        _solve_all(whole, right, (creeping[1], creeping[2]), elastic, jump, a)
        found = _OFF
        if depth > 0.0:
            pull_n, pull_t = wanted_n - _dot(up, a), wanted_t - _dot(along, a)
            if slip * abs(pull_t) <= mu * pull_n:
                found = _STICKS
            elif pull_n + mu * abs(pull_t) > 0.0:
                found = _SLIDES_UP if pull_t > 0.0 else _SLIDES_DOWN
        same = found == mode[0]
        mode[0] = found
        for k in range(3):
            if limits[k] > 0.0:
                pull = -_FRICTION_SHARE / inverse[k] * (a[entries[k]] + speeds[k] / _FRICTION_TIME_S)
                side = 1 if pull > limits[k] else (-1 if pull < -limits[k] else 0)
                same = same and side == mode[1 + k]
                mode[1 + k] = side
        if same:
            return True
    return False


@inlined
def _step(q: Floats, v: Floats, elastic: bool, jump: Any, work: Any, a: Floats) -> bool:
    """Make a step with accelerations ``a``; MuJoCo takes the dampers of joints at its end: (M + h D) a' = M a."""
    _, matrix, _, _, right, _ = work
    step, coupling = jump.timestep_s, jump.coupling_kg_m2
    for i in range(4):
        right[i] = matrix[i, 0] * a[0] + matrix[i, 1] * a[1] + matrix[i, 2] * a[2] + matrix[i, 3] * a[3]
    if elastic:
        right[2] += coupling * a[5]
        right[4] = jump.armature_kg_m2[HIP] * a[4]
        right[5] = jump.armature_kg_m2[KNEE] * a[5] + coupling * a[2]
    damping = jump.joint_damping_n_m_s_per_rad
    _solve_all(matrix, right, (step * damping[HIP], step * damping[KNEE]), elastic, jump, a)
    fine = True
    z, _, _, hip_motor, knee_motor = places(len(q))
    if z == 1:
        v[0] += step * a[0]
    for k in range(3):
        v[z + k] += step * a[1 + k]
    if elastic:
        v[hip_motor] += step * a[4]
        v[knee_motor] += step * a[5]
    for k in range(len(q)):
        q[k] += step * v[k]
    for k in range(6):
        fine = fine and abs(a[k]) < _MOST_ACCELERATION
    return fine


@lru_cache(maxsize=1)
def stepper() -> Callable[[Any, Any, Floats, int, Floats], None]:
    """Return the compiled function that makes jumps; it closes over ``origin``.

    A jump starts with the speeds in its record. The arguments are records, grounds, start positions (n, nv), the number
    of torques, and room for what is observed of each step, ``controller_record.OBSERVED``, shape (n, steps, 16); steps
    beyond the room are not kept.
    """
    return _stepper(zlib.crc32(f"{origin()}{GROUND.descr}{LEAST_IMPEDANCE}".encode()))


def _stepper(sources: int) -> Callable[[Any, Any, Floats, int, Floats], None]:
    @compiled
    def jumps(records: Any, grounds: Any, start: Floats, controls: int, seen: Floats) -> None:
        _ = sources
        n = start.shape[1]
        q, v, ctrl = np.zeros(n), np.zeros(n), np.zeros(controls)
        room = np.zeros(1, _ROOM)
        z, hip, _, hip_motor, knee_motor = places(n)
        guided, elastic = z == 0, hip_motor != hip
        for i in range(len(records)):
            jump, ground, own = records[i], grounds[i], room[0]
            arms, matrix, whole, force, right = own.arms, own.matrix, own.whole, own.force, own.right
            a, inverse, mode = own.a, own.inverse, own.mode
            work = (arms, matrix, whole, force, right, own.creeping)
            q[:] = start[i]
            v[0] = jump.velocity[0]
            for k in range(3):
                v[z + k] = jump.velocity[1 + k]
            if elastic:
                v[hip_motor], v[knee_motor] = jump.motor_rad_per_s[HIP], jump.motor_rad_per_s[KNEE]
            ctrl[:] = 0.0
            mode[:] = 0
            force[:] = 0.0
            _inverse_masses(guided, elastic, jump, (arms, matrix, whole, right, a), inverse)
            while True:
                control(q, v, ctrl, jump)
                step = int(jump.steps) - 1
                if step < seen.shape[1]:
                    for k in range(4):
                        seen[i, step, k] = jump.position[k]
                        seen[i, step, 4 + k] = jump.velocity[k]
                        seen[i, step, 8 + k] = jump.directions[k]
                    for k in range(2):
                        seen[i, step, 12 + k] = jump.motor_torque_n_m[k]
                        seen[i, step, 14 + k] = jump.motor_rad[k]
                if jump.status > FLYING:
                    break
                angles = jump.directions
                _pose((angles[0], angles[1]), (angles[2], angles[3]), jump, arms)
                _inertia(arms, guided, elastic, jump, matrix)
                _forces(q, v, ctrl, arms, jump, force)
                found = _accelerate(q, v, ground, jump, inverse, mode, work, a)
                if not (found and _step(q, v, elastic, jump, work, a)):
                    jump.status = DIVERGED
                    break

    return jumps

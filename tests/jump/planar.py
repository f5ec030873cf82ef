"""A simulator of the jump without MuJoCo, written from docs/model.md alone.

Rigid bodies in the plane, integrated by Runge and Kutta's method of fourth order.

Coordinates are x and z of the base, hip and knee, and with elastic drives the motors of both as angles of their joints;
SI units. ``tests/jump/test_independent_simulator.py`` holds the package's simulation against it.
"""

from collections import namedtuple

import numba
import numpy as np

GRAVITY = 9.81
SUBSTEPS = 20
"""Steps per control period of 1 ms."""
LEAST = 1e-4
CREEP = 1e-3
"""Speed in m/s beyond which the friction of the rails is whole."""

Machine = namedtuple(
    "Machine",
    "thigh shank radius mass centres inertia reflected coupling lower upper stop peak no_load corner loss heat gains"
    " rest release damping friction loss_speed foot mu slip fade inverse start delay guided stand rails"
    " spring damper play bumper bus rotor ratio sprocket",
    defaults=(np.zeros(2), np.zeros(2), 0.0, np.zeros((2, 3)), False, np.zeros(2), 1.0, 1.0),
)
"""One robot with its drives, stops, contact and controller.

mass (3,): of base, thigh and shank. centres: x and z of those of thigh and shank. inertia (2,): of thigh and shank.
reflected (2,): C of hip and knee. coupling: B of the knee. lower, upper, peak, no_load, corner, loss, heat (2,): of hip
and knee. stop: K, C, w and D of hip and knee. foot: K, C, w and D. gains: K, C and T. inverse (3,): A of hip, knee and
foot, filled in by ``with_inverse_masses``. delay: in control periods. guided: whether the base moves in z only. stand,
rails: what it lifts besides the robot in kg, and the Coulomb friction of its rails in N. damping, friction (2,).

spring, damper (2,): of elastic drives; 0 means rigid ones. play: of both, in rad. bumper (2, 3): E d l on its lever,
compression over diameter per angle and chi per joint speed; 0 leaves the stops to ``stop``. bus: whether one motor
takes what the other gives. rotor (2,): inertia at the motor times the ratio squared. ratio: of the knee. sprocket:
radius.
"""
LOADS = "hip gear, knee gear, chain, stop, foot"
"""Peaks that ``jump`` returns besides, in N m, and in N for chain and foot."""


@numba.njit(cache=True)
def turned(angle, x, z):
    """A vector turned about +y."""
    return np.cos(angle) * x + np.sin(angle) * z, np.cos(angle) * z - np.sin(angle) * x


@numba.njit(cache=True)
def jacobian(upper, lower):
    """Both rows of that of the point hip + upper + lower: ``upper`` turns with the thigh, ``lower`` with the shank."""
    x, z = upper[0] + lower[0], upper[1] + lower[1]
    return np.array([1.0, 0.0, z, lower[1], 0.0, 0.0]), np.array([0.0, 1.0, -x, -lower[0], 0.0, 0.0])


@numba.njit(cache=True)
def dot(one, other):
    found = 0.0
    for i in range(len(other)):
        found += one[i] * other[i]
    return found


@numba.njit(cache=True)
def add_square(matrix, factor, row):
    """Add a row's outer product with itself."""
    for i in range(4):
        for j in range(4):
            matrix[i, j] += factor * row[i] * row[j]


@numba.njit(cache=True)
def bodies(q, m):
    """Mass matrix, Jacobians of both centres, and the vectors hip to thigh's centre, hip to knee, knee to shank's."""
    knee = turned(q[2], 0.0, -m.thigh)
    first, second = turned(q[2], *m.centres[0]), turned(q[2] + q[3], *m.centres[1])
    thigh, shank = jacobian(first, (0.0, 0.0)), jacobian(knee, second)
    n = len(q)
    matrix = np.zeros((n, n))
    for k in range(2):
        add_square(matrix, m.mass[1], thigh[k])
        add_square(matrix, m.mass[2], shank[k])
        matrix[k, k] += m.mass[0] + m.stand
        matrix[n - 2 + k, n - 2 + k] += m.reflected[k]
    matrix[2, 2] += m.inertia[0] + m.inertia[1]
    matrix[2, 3] += m.inertia[1]
    matrix[3, 2] += m.inertia[1]
    matrix[3, 3] += m.inertia[1]
    matrix[2, n - 1] += m.coupling
    matrix[n - 1, 2] += m.coupling
    return matrix, thigh, shank, first, knee, second


@numba.njit(cache=True)
def law(r, values, inverse):
    """Virtual mass m, stiffness k' and damping b' at the violation r."""
    stiffness, damping, width, full = values
    d = LEAST + (full - LEAST) * min(r / width, 1.0)
    return d / (1 - d) / inverse, stiffness * inverse * (1 - full) * d / full**2, damping * inverse * (1 - full) / full


@numba.njit(cache=True)
def solved(left, right):
    """Solution of equations with a symmetric, positive definite matrix by elimination; both arguments are lost."""
    for i in range(len(right)):
        for j in range(i + 1, len(right)):
            factor = left[j, i] / left[i, i]
            for k in range(i + 1, len(right)):
                left[j, k] -= factor * left[i, k]
            right[j] -= factor * right[i]
    for i in range(len(right) - 1, -1, -1):
        for j in range(i + 1, len(right)):
            right[i] -= left[i, j] * right[j]
        right[i] /= left[i, i]
    return right


@numba.njit(cache=True)
def spring_torque(j, q, v, m):
    """On joint ``j``, from its motor."""
    wound, play = q[4 + j] - q[2 + j], 0.5 * m.play
    taut = wound - min(max(wound, -play), play)
    return m.spring[j] * taut + m.damper[j] * (v[4 + j] - v[2 + j])


@numba.njit(cache=True)
def acceleration(q, v, motor, m, mode, loads):
    """Of the coordinates; the present ``LOADS`` but those of gears are written.

    Every force is linear in the accelerations as long as the contact sticks or slides in one direction, friction is
    below its limit or at one end of it, and a stop pushes or not. ``mode`` holds that of the last call: floor (0 off, 1
    sticks, 2 and 3 slides), friction of hip and knee (-1, 0, 1), stops of hip and knee. If it does not lead to itself,
    all are tried; the solution is unique.
    """
    matrix, thigh, shank, first, knee, second = bodies(q, m)
    w1, w2, n = v[2] ** 2, (v[2] + v[3]) ** 2, len(q)
    force, beyond, side, virtual, push = np.zeros(n), np.zeros(2), np.zeros(2), np.zeros(2), np.zeros(2)
    for i in range(4):
        force[i] += m.mass[1] * (thigh[0][i] * first[0] * w1 + thigh[1][i] * (first[1] * w1 - GRAVITY))
        force[i] += m.mass[2] * shank[0][i] * (knee[0] * w1 + second[0] * w2)
        force[i] += m.mass[2] * shank[1][i] * (knee[1] * w1 + second[1] * w2 - GRAVITY)
    force[1] -= (m.mass[0] + m.stand) * GRAVITY + m.rails * np.tanh(v[1] / CREEP)
    for j in range(2):
        i = n - 2 + j
        torque = motor[j] - m.loss[j] * abs(motor[j]) * np.tanh(v[i] / m.loss_speed)
        force[i] += min(max(torque, -m.peak[j]), m.peak[j]) - m.damping[j] * v[i]
        if n == 6:
            pull = spring_torque(j, q, v, m)
            force[2 + j] += pull
            force[4 + j] -= pull
            loads[2] = abs(pull) / m.sprocket
        beyond[j] = max(m.lower[j] - q[2 + j], q[2 + j] - m.upper[j])
        side[j] = 1.0 if q[2 + j] < m.lower[j] else -1.0
        if beyond[j] > 0 and m.bumper[j, 0] > 0:
            c = beyond[j] * m.bumper[j, 1]
            law_n_m = m.bumper[j, 0] * (1.25 * c**1.5 + 50 * c**6) * (1 - m.bumper[j, 2] * side[j] * v[2 + j])
            force[2 + j] += side[j] * max(law_n_m, 0.0)
            loads[3] = max(law_n_m, 0.0)
        elif beyond[j] > 0:
            virtual[j], k, b = law(beyond[j], m.stop[j], m.inverse[j])
            push[j] = k * beyond[j] - b * side[j] * v[2 + j]
    foot = turned(q[2] + q[3], 0.0, -m.shank)
    depth = m.radius - (q[1] + knee[1] + foot[1])
    along, up = jacobian(knee, (foot[0], foot[1] + 0.5 * depth - m.radius))
    stick = pull_n = pull_t = 0.0
    if depth > 0:
        stick, k, b = law(depth, m.foot, m.inverse[2])
        pull_n, pull_t = k * depth - b * dot(up, v), -b * dot(along, v)
    slide = stick / (1 + m.mu**2 / m.slip)

    found, both = np.zeros(5, np.int64), np.zeros(6)
    for attempt in range(154):
        if attempt >= 10:
            c = attempt - 10
            mode[0], mode[1], mode[2], mode[3], mode[4] = c % 4, c // 4 % 3 - 1, c // 12 % 3 - 1, c // 36 % 2, c // 72
        left, right = matrix.copy(), force.copy()
        if mode[0] == 1:
            add_square(left, stick, up)
            add_square(left, stick * m.slip, along)
            for i in range(4):
                right[i] += stick * (pull_n * up[i] + m.slip * pull_t * along[i])
        elif mode[0] > 1:
            signed = m.mu * (5 - 2 * mode[0])
            for i in range(4):
                both[i] = up[i] + signed * along[i]
                right[i] += slide * (pull_n + signed * pull_t) * both[i]
            add_square(left, slide, both)
        for j in range(2):
            i, creep = n - 2 + j, 9 / m.inverse[j]
            if mode[1 + j] == 0:
                left[i, i] += creep
                right[i] -= creep * v[i] / 9.5e-3
            right[i] += mode[1 + j] * m.friction[j]
            if mode[3 + j] == 1:
                left[2 + j, 2 + j] += virtual[j]
                right[2 + j] += virtual[j] * push[j] * side[j]
        if m.guided:
            for i in range(n):
                left[0, i] = left[i, 0] = 0.0
            left[0, 0], right[0] = 1.0, 0.0
        a = solved(left, right)
        normal, t = pull_n - dot(up, a), pull_t - dot(along, a)
        found[0] = 0
        if depth > 0 and m.slip * abs(t) <= m.mu * normal:
            found[0] = 1
        elif depth > 0 and normal + m.mu * abs(t) > 0:
            found[0] = 2 if t > 0 else 3
        for j in range(2):
            i = n - 2 + j
            wanted = 9 / m.inverse[j] * (-a[i] - v[i] / 9.5e-3)
            found[1 + j] = int(wanted > m.friction[j]) - int(wanted < -m.friction[j])
            found[3 + j] = int(virtual[j] > 0 and push[j] - side[j] * a[2 + j] > 0)
        same = True
        for k in range(5):
            same &= found[k] == mode[k]
            mode[k] = found[k]
        if same:
            if mode[0] == 1:
                loads[4] = stick * np.hypot(normal, m.slip * t)
            elif mode[0] > 1:
                loads[4] = slide * (normal + m.mu * abs(t)) * np.hypot(1.0, m.mu)
            return a
    raise ValueError("no consistent set of forces")


@numba.njit(cache=True)
def wanted(q, v, m):
    """The torques of section II-B, from angles and speeds of both motors, the last two coordinates."""
    hip, hip_speed, knee_speed = q[len(q) - 2], v[len(q) - 2], v[len(q) - 1]
    knee, foot = turned(hip, 0.0, -m.thigh), turned(hip + q[len(q) - 1], 0.0, -m.shank)
    x, z = knee[0] + foot[0], knee[1] + foot[1]
    along, up = jacobian(knee, foot)
    length = np.hypot(x, z)
    sine, cosine = -x / length, -z / length
    speed = x * (along[2] * hip_speed + along[3] * knee_speed) + z * (up[2] * hip_speed + up[3] * knee_speed)
    axial = m.gains[0] * (m.rest - length) - m.gains[1] * speed / length
    twist = -m.gains[2] * np.arctan2(sine, cosine) / length
    weight = (m.mass[0] + m.mass[1] + m.mass[2]) * GRAVITY
    push_x, push_z = -axial * sine - twist * cosine, -axial * cosine + twist * sine - weight
    return along[2] * push_x + up[2] * push_z, along[3] * push_x + up[3] * push_z


@numba.njit(cache=True)
def limited(torque, v, m, j):
    """Within a motor's peak torque, and within its voltage where it drives."""
    most = m.peak[j]
    speed = v[len(v) - 2 + j]
    if torque * speed > 0:
        most *= min(max((m.no_load[j] - abs(speed)) / (m.no_load[j] - m.corner[j]), 0.0), 1.0)
    return min(max(torque, -most), most)


@numba.njit(cache=True)
def moved(state, h, rate):
    """The state after a time at a rate."""
    found = np.empty(len(state))
    for i in range(len(state)):
        found[i] = state[i] + h * rate[i]
    return found


@numba.njit(cache=True)
def step(q, v, motor, m, mode, loads, h):
    """Make a step of Runge and Kutta in place; returns the acceleration at its start, whose ``LOADS`` are written."""
    later = np.zeros(5)
    a1 = acceleration(q, v, motor, m, mode, loads)
    v2 = moved(v, 0.5 * h, a1)
    a2 = acceleration(moved(q, 0.5 * h, v), v2, motor, m, mode, later)
    v3 = moved(v, 0.5 * h, a2)
    a3 = acceleration(moved(q, 0.5 * h, v2), v3, motor, m, mode, later)
    v4 = moved(v, h, a3)
    a4 = acceleration(moved(q, h, v3), v4, motor, m, mode, later)
    for i in range(len(q)):
        q[i] += h * (v[i] + 2 * v2[i] + 2 * v3[i] + v4[i]) / 6
        v[i] += h * (a1[i] + 2 * a2[i] + 2 * a3[i] + a4[i]) / 6
    return a1


@numba.njit(cache=True)
def jump(m, q):
    """Height in m, mechanical energy and energy at the battery in J; then the peaks of ``LOADS``."""
    n = len(q)
    q, v, motor, mode = q.copy(), np.zeros(n), np.zeros(2), np.zeros(5, np.int64)
    stood = off = False
    height, energy, battery, h = q[1], 0.0, 0.0, 1e-3 / SUBSTEPS
    torques, shares, peaks, loads = np.zeros((3000, 2)), np.zeros((3000, 2)), np.zeros(5), np.zeros(5)
    for period in range(3000):
        clearance = q[1] - m.thigh * np.cos(q[2]) - m.shank * np.cos(q[2] + q[3]) - m.radius
        stood |= clearance <= 0
        # What the controller knows of the leg it reads from the motors.
        hip, knee = q[n - 2], q[n - 1]
        read = q[1] - m.thigh * np.cos(hip) - m.shank * np.cos(hip + knee) - m.radius
        off |= stood and read >= m.fade
        if off and v[1] <= 0:
            return height, energy, battery, peaks
        u = min(max(read / m.fade, 0.0), 1.0)
        torques[period, 0], torques[period, 1] = wanted(q, v, m)
        shares[period, 0] = shares[period, 1] = 0.0 if off else 1 - 3 * u**2 + 2 * u**3
        if m.release > 0:
            shares[period, 1] *= min(max((knee - m.lower[1]) / m.release, 0.0), 1.0)
        due = period - m.delay
        for j in range(2):
            motor[j] = shares[due, j] * limited(torques[due, j], v, m, j) if due >= 0 else 0.0
        for _ in range(SUBSTEPS):
            loads[:] = 0.0
            before = v.copy()
            a1 = step(q, v, motor, m, mode, loads, h)
            loads[0] = abs(motor[0] - m.rotor[0] * a1[n - 2])
            loads[1] = abs(motor[1] - m.rotor[1] * a1[n - 1] - m.rotor[1] / m.ratio * a1[2])
            for i in range(5):
                peaks[i] = max(peaks[i], loads[i])
            drawn = 0.0
            for j in range(2):
                i = n - 2 + j
                power = motor[j] * 0.5 * (before[i] + v[i])
                energy += max(power, 0.0) * h
                drawn += power + m.heat[j] * motor[j] ** 2
                if j == 1 or not m.bus:
                    battery += max(drawn, 0.0) * h
                    drawn = 0.0
            height = max(height, q[1])
    return np.nan, np.nan, np.nan, peaks


Plan = namedtuple("Plan", "carried catch crouch stiffness damping catch_s lower_s posture held")
"""A landing: the force that carries the robot in the crouch, depths of the foot below the hip, the leg's spring and its
dampers forward and down, times, the posture of hip and knee in flight, and spring and damper that hold it."""


def plan_of(m, apex_z, reach=0.9, stroke=0.7, ratio=0.4, lower_s=0.2):
    """The landing of docs/landing.md."""
    stand = standing(m)
    crouch = m.thigh * np.cos(stand[2]) + m.shank * np.cos(stand[2] + stand[3])
    catch = max(reach * (m.thigh + m.shank), crouch)
    bend = np.pi - np.arccos((m.thigh**2 + m.shank**2 - catch**2) / (2 * m.thigh * m.shank))
    posture = np.array([-np.arcsin(m.shank * np.sin(bend) / catch), bend])
    folded = abs(m.thigh + m.shank * np.exp(1j * m.upper[1]))
    speed = np.sqrt(2 * GRAVITY * max(apex_z - catch - m.radius, 0.05))
    # The greatest depth of m x'' + 2 ratio omega x' + omega^2 x = 0 from x' = 1 for omega = 1, and when it is reached.
    t = np.arange(0.0, 3.0, 1e-5)
    swing = np.sqrt(1 - ratio**2)
    depth = np.exp(-ratio * t) * np.sin(swing * t) / swing
    omega = depth.max() * speed / (stroke * (catch - max(folded, 0.15 - m.radius)))
    moved = m.mass.sum() + m.stand
    held = (stand[5] - stand[3]) * m.spring[1]  # without play
    straight = bodies(np.zeros(4), m)[0][2, 2]
    swing = min(25.0, min(m.reflected) / (1e-3 * (1 + m.delay) * straight))
    return Plan(
        carried=-held / (m.shank * np.sin(stand[2] + stand[3])),
        catch=catch,
        crouch=crouch,
        stiffness=moved * omega**2,
        damping=np.array([2 * min(ratio, 0.3) * moved * omega, 2 * ratio * moved * omega]),
        catch_s=t[depth.argmax()] / omega,
        lower_s=lower_s,
        posture=posture,
        held=np.array([swing**2, 1.2 * swing]) * straight,
    )


@numba.njit(cache=True)
def land(m, q, v, plan):
    """Time from touchdown to rest, work given and taken by the motors and their heat, and the peaks of ``LOADS``."""
    n = len(q)
    q, v, motor, mode = q.copy(), v.copy(), np.zeros(2), np.zeros(5, np.int64)
    touched, still, h = -1.0, 0.0, 1e-3 / SUBSTEPS
    given, taken, heat = 0.0, 0.0, 0.0
    torques, peaks, loads = np.zeros((3000, 2)), np.zeros(5), np.zeros(5)
    for period in range(3000):
        since = period * 1e-3 - touched
        if touched >= 0 and still >= 0.05:
            return period * 1e-3 - touched, given, taken, heat, peaks
        hip, knee = q[n - 2], q[n - 1]
        for j in range(2):
            torques[period, j] = plan.held[0] * (plan.posture[j] - q[n - 2 + j]) - plan.held[1] * v[n - 2 + j]
        if touched >= 0:
            flown = max(1 - since / 0.003, 0.0)
            u = min(max((since - plan.catch_s) / plan.lower_s, 0.0), 1.0)
            place = plan.catch - (plan.catch - plan.crouch) * (3 * u**2 - 2 * u**3)
            along, up = jacobian(turned(hip, 0.0, -m.thigh), turned(hip + knee, 0.0, -m.shank))
            x, down = -up[2], -along[2]
            forward = along[2] * v[n - 2] + along[3] * v[n - 1]
            sinking = -(up[2] * v[n - 2] + up[3] * v[n - 1])
            push_x = -plan.stiffness * x - plan.damping[0] * forward
            push_down = plan.carried + plan.stiffness * (place - down) - plan.damping[1] * sinking
            for j in range(2):
                torques[period, j] *= flown
                torques[period, j] += (1 - flown) * (along[2 + j] * push_x - up[2 + j] * push_down)
        due = period - m.delay
        for j in range(2):
            motor[j] = limited(torques[due, j], v, m, j) if due >= 0 else 0.0
        for sub in range(SUBSTEPS):
            if touched < 0 and q[1] - m.thigh * np.cos(q[2]) - m.shank * np.cos(q[2] + q[3]) <= m.radius:
                touched = period * 1e-3 + sub * h
            loads[:] = 0.0
            before = v.copy()
            a1 = step(q, v, motor, m, mode, loads, h)
            loads[0] = abs(motor[0] - m.rotor[0] * a1[n - 2])
            loads[1] = abs(motor[1] - m.rotor[1] * a1[n - 1] - m.rotor[1] / m.ratio * a1[2])
            for i in range(5):
                peaks[i] = max(peaks[i], loads[i])
            for j in range(2):
                power = motor[j] * 0.5 * (before[n - 2 + j] + v[n - 2 + j])
                given += max(power, 0.0) * h
                taken += max(-power, 0.0) * h
                heat += m.heat[j] * motor[j] ** 2 * h
            calm = abs(v[1]) < 0.01 and abs(v[2]) < 0.05 and abs(v[3]) < 0.05
            lowered = touched >= 0 and period * 1e-3 + sub * h - touched >= plan.catch_s + plan.lower_s
            still = still + h if calm and lowered else 0.0
    return np.nan, given, taken, heat, peaks


def with_inverse_masses(m):
    """With A of hip, knee and foot; with elastic drives, of the motors and the foot."""
    # Arrays of one layout: for others, all would be compiled again.
    m = Machine(*(np.array(value, order="C") if isinstance(value, np.ndarray) else value for value in m))
    n = 6 if m.spring.any() else 4
    matrix, _, shank, *_ = bodies(np.zeros(n), m)
    shank = np.stack(shank)[:, :n]
    inverse, free = np.zeros((n, n)), slice(int(m.guided), n)
    inverse[free, free] = np.linalg.inv(matrix[free, free])
    foot = np.trace(shank @ inverse @ shank.T) / 3
    return m._replace(inverse=np.array([inverse[n - 2, n - 2], inverse[n - 1, n - 1], foot]))


def lifted(m, hip, knee):
    """Potential energy with the foot on one spot."""
    upper, lower = m.centres
    thigh, shank = turned(hip, 0.0, -m.thigh)[1], turned(hip + knee, 0.0, -m.shank)[1]
    first, second = turned(hip, *upper)[1], turned(hip + knee, *lower)[1]
    base = -(thigh + shank)
    heights = np.array([base, base + first, base + thigh + second])
    return GRAVITY * (m.mass @ heights + m.stand * base)


def standing(m):
    """Coordinates at the start: the foot below the base, compressed by the weight, the knee bent forwards.

    Elastic drives are wound by the torques that hold it, which are the slopes of its potential energy.
    """
    low, high = 0.0, m.foot[2]
    for _ in range(60):
        depth = 0.5 * (low + high)
        mass, k, _ = law(depth, m.foot, m.inverse[2])
        low, high = (depth, high) if mass * k * depth < (m.mass.sum() + m.stand) * GRAVITY else (low, depth)
    reach = m.start - m.radius + depth
    knee = np.arccos((reach**2 - m.thigh**2 - m.shank**2) / (2 * m.thigh * m.shank))
    hip = -np.arctan2(m.shank * np.sin(knee), m.thigh + m.shank * np.cos(knee))
    q = np.array([0.0, m.start, hip, knee])
    if not m.spring.any():
        return q
    d = 1e-6
    slopes = np.array(
        [lifted(m, hip + d, knee) - lifted(m, hip - d, knee), lifted(m, hip, knee + d) - lifted(m, hip, knee - d)]
    )
    torque = slopes / (2 * d)
    return np.append(q, q[2:] + torque / m.spring + np.copysign(0.5 * m.play, torque))

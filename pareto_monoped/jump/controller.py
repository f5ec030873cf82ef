"""The controller and the bookkeeping of one jump, compiled by numba, which importing this module imports.

``control`` is called at the start of every step. Everything it knows about a jump besides positions and speeds is in
one ``controller_record.RECORD``, which ``callback`` keeps in the user data of the simulation. Whatever calls it
closes over ``controller_record.origin``, because numba recompiles a function only if its own file changes.
"""

import math
from typing import Any

from pareto_monoped.compute.compiled import inner
from pareto_monoped.design import GRAVITY_M_PER_S2, Floats
from pareto_monoped.jump.controller_record import HIP, KNEE, TOUCH_M
from pareto_monoped.jump.torques import delivered, eased, held_pose, limited, lower, release, since_touch_s, torques

RUNNING, FLYING, APEX, NO_LIFT_OFF, SANK, DIVERGED, TIMEOUT, LANDED = range(8)
"""``status``; a jump goes on through ``FLYING``. A landing ends as ``LANDED``, or in failure."""

SANK_M = 0.1  #: A base this low has fallen: half its actuators' diameter is 0.05 m.
STILL_M_PER_S, STILL_RAD_PER_S, STILL_S = 0.01, 0.05, 0.05
"""Speeds of base and joints below which a robot stands still, and for how long it must; our own choice."""
SPEED_LIMIT = 1e4  #: Speed of a joint or slide (rad/s, m/s) beyond which the simulation has failed.


@inner
def control(q: Floats, v: Floats, ctrl: Floats, jump: Any) -> None:
    """Book the last step of a jump, end the jump if it is over, and set the torques of its next step.

    ``q`` and ``v``, shape (nv,), are positions and speeds at the start of the step, in the order of ``places``.
    Written are ``ctrl``, the torques of both motors and, under a law of our own, of both end stops, and the ``RECORD``.
    """
    if jump.stages > 1.0:
        # A Runge-Kutta integrator calls once per stage; the motors' torque of the first stage is held.
        stage = jump.stage
        jump.stage = stage + 1.0 if stage + 1.0 < jump.stages else 0.0
        if stage > 0.0:
            _stop(q, v, ctrl, jump)
            return
    if jump.status == RUNNING:
        _run(q, v, ctrl, jump)
    elif jump.status == FLYING:
        _fly(q, v, jump)
    if jump.status != RUNNING:
        ctrl[HIP] = ctrl[KNEE] = 0.0
    if jump.status <= FLYING:
        _stop(q, v, ctrl, jump)


@inner
def places(nv: int) -> tuple[int, int, int, int, int]:
    """Return where z, hip, knee and the motors of hip and knee stand among ``nv`` coordinates.

    First comes x, if the base slides, then z, hip, knee. With an elastic drive the motors of knee and hip follow, as
    angles of their joints; without one they are hip and knee themselves.
    """
    z = 1 - nv % 2
    return (z, z + 1, z + 2, nv - 1, nv - 2) if nv > 4 else (z, z + 1, z + 2, z + 1, z + 2)


@inner
def _stop(q: Floats, v: Floats, ctrl: Floats, jump: Any) -> None:
    """Set the torques of the bumpers: the part's slow torque times 1 + chi speed, as Hunt and Crossley have it."""
    if ctrl.shape[0] == 2:
        return
    hip = places(v.shape[0])[1]
    for joint in range(2):
        below, above = jump.lower_stop_rad[joint] - q[hip + joint], q[hip + joint] - jump.upper_stop_rad[joint]
        torque = 0.0
        if below > 0.0 or above > 0.0:
            side = 1.0 if below > 0.0 else -1.0
            share = max(below, above) * jump.bumper_per_rad[joint]
            slow = jump.bumper_n_m[joint] * (1.25 * share * math.sqrt(share) + 50.0 * share**6)
            # The speed at the time of the positions: half a step on, with the acceleration of the last step.
            speed = v[hip + joint] + jump.read_back_s * jump.spin_up_rad_per_s2[joint]
            torque = side * slow * max(0.0, 1.0 - side * jump.bumper_s_per_rad[joint] * speed)
        ctrl[2 + joint] = jump.stop_torque_n_m[joint] = torque


@inner
def _fine(q: Floats, v: Floats) -> bool:
    """Return whether a state is finite and slower than ``SPEED_LIMIT``."""
    fine = True
    for k in range(v.shape[0]):
        fine = fine and math.isfinite(q[k]) and abs(v[k]) < SPEED_LIMIT
    return fine


@inner
def _end(q: Floats, v: Floats, jump: Any) -> None:
    """End a jump at the apex (the foot is off the floor and the base no longer rises) or in failure."""
    z = places(v.shape[0])[0]
    if jump.landing > 0.0:
        _end_landing(q, v, jump)
    elif jump.off_floor > 0.0 and v[z] <= 0.0:
        jump.status = APEX
    elif q[z] < (SANK_M if jump.until_m == 0.0 else jump.foot_radius_m):
        jump.status = SANK
    elif jump.steps > jump.step_limit:
        jump.status = TIMEOUT if jump.off_floor > 0.0 else NO_LIFT_OFF


@inner
def _end_landing(q: Floats, v: Floats, jump: Any) -> None:
    """End a landing at rest in the crouch, or in failure: base or knee has met the floor, or nothing comes to rest."""
    z, hip, knee, _, _ = places(v.shape[0])
    still = abs(v[z]) < STILL_M_PER_S and max(abs(v[hip]), abs(v[knee])) < STILL_RAD_PER_S
    lowered = jump.stood > 0.0 and since_touch_s(jump) >= jump.catch_s + jump.lower_s
    jump.still_steps = jump.still_steps + 1.0 if still and lowered else 0.0
    if jump.still_steps * jump.timestep_s >= STILL_S:
        jump.status = LANDED
    elif q[z] < SANK_M or q[z] - jump.thigh_length_m * math.cos(q[hip]) < jump.foot_radius_m:
        jump.status = SANK
    elif jump.steps > jump.step_limit:
        jump.status = TIMEOUT


@inner
def _fly(q: Floats, v: Floats, jump: Any) -> None:
    """A step after the torque has been switched off for good."""
    if not _fine(q, v):
        jump.status = DIVERGED
        return
    z, hip, knee, hip_motor, knee_motor = places(v.shape[0])
    _loads(v, jump)
    thigh_turned, shank_turned = _direction(q[hip]), _direction(q[hip] + q[knee])
    _note_state(q, v, thigh_turned, shank_turned, jump)
    jump.steps += 1.0
    jump.height_m = max(jump.height_m, q[z])
    jump.peak_speed_rad_per_s[HIP] = max(jump.peak_speed_rad_per_s[HIP], abs(v[hip_motor]))
    jump.peak_speed_rad_per_s[KNEE] = max(jump.peak_speed_rad_per_s[KNEE], abs(v[knee_motor]))
    _end(q, v, jump)
    if jump.status != FLYING:
        rz = -jump.thigh_length_m * thigh_turned[1] - jump.shank_length_m * shank_turned[1]
        jump.clearance_m = q[z] + rz - jump.foot_radius_m


@inner
def _run(q: Floats, v: Floats, ctrl: Floats, jump: Any) -> None:
    """A step under the controller."""
    if not _fine(q, v):
        jump.status = DIVERGED
        return
    at_z, at_hip, at_knee, hip_motor, knee_motor = places(v.shape[0])
    z, hip, knee = q[at_z], q[hip_motor], q[knee_motor]  # the encoders sit on the motors
    speed = (v[hip_motor], v[knee_motor])
    thigh_turned, shank_turned = _direction(q[at_hip]), _direction(q[at_hip] + q[at_knee])
    foot, shank = _foot(thigh_turned, shank_turned, jump)
    clearance = z + foot[1] - jump.foot_radius_m

    tick = jump.steps % jump.period_steps == 0.0
    read_clearance = clearance
    if tick and (jump.read_back_s > 0.0 or hip_motor != at_hip):
        read_z = z
        if jump.read_back_s > 0.0:
            read_z, hip, knee = _read_back(q, v, jump)
        foot, shank = _foot(_direction(hip), _direction(hip + knee), jump)
        read_clearance = read_z + foot[1] - jump.foot_radius_m

    if jump.steps > 0:
        _loads(v, jump)
        _book(jump, speed)
    _note_state(q, v, thigh_turned, shank_turned, jump)
    jump.steps += 1
    jump.height_m = max(jump.height_m, z)
    jump.clearance_m = clearance
    touching = clearance <= TOUCH_M
    if touching:
        if jump.stood == 0.0:
            jump.touched_s = (jump.steps - 1.0) * jump.timestep_s
        jump.stood = 1.0
        jump.lift_off_step = jump.steps
    if jump.steps <= jump.lift_off_step + 1:
        after = 0 if touching else 1
        for k in range(4):
            jump.lift_off_positions[after, k] = jump.position[k]
    gate = _gate(read_clearance, touching, jump) if tick else 0.0
    if tick and jump.until_m > 0.0 and (jump.pushed_s > 0.0 or -foot[1] >= jump.until_m):
        jump.pushed_s = jump.pushed_s or (jump.steps - 1.0) * jump.timestep_s
        gate = 0.0
    _end(q, v, jump)
    if jump.status != RUNNING:
        return
    if tick:
        if jump.latch > 0.0 and jump.off_floor > 0.0:
            if jump.quiet_periods >= jump.delay_periods:
                jump.status = FLYING
                for joint in range(2):
                    jump.motor_torque_n_m[joint] = jump.joint_torque_n_m[joint] = 0.0
                return
            # The driver still works off the commands that are under way.
            jump.quiet_periods += 1
        wanted, share = (0.0, 0.0), (gate, gate)
        if gate > 0.0:
            if jump.landing > 0.0:
                lower(jump)
            wanted = torques((hip, knee), foot, shank, speed, jump)
            if jump.landing > 0.0:
                wanted = eased(held_pose((hip, knee), speed, jump), wanted, jump)
            share = (gate, gate * release(knee, jump))
        elif jump.flight_stiffness_n_m_per_rad > 0.0:
            wanted, share = held_pose((hip, knee), speed, jump), (1.0, 1.0)
        _command(wanted, share, speed, jump)
    for joint in range(2):
        jump.speed_rad_per_s[joint] = speed[joint]
        torque = delivered(jump.motor_torque_n_m[joint], speed[joint], jump, joint)
        ctrl[joint] = jump.joint_torque_n_m[joint] = torque


@inner
def _direction(angle: float) -> tuple[float, float]:
    return math.sin(angle), math.cos(angle)


@inner
def _read_back(q: Floats, v: Floats, jump: Any) -> tuple[float, float, float]:
    """Positions z, hip, knee at the time of the speeds, half a step back, with the acceleration of the last step."""
    z, _, _, hip, knee = places(v.shape[0])
    back = jump.read_back_s
    return (
        q[z] - back * (1.25 * v[z] - 0.25 * jump.velocity[1]),
        q[hip] - back * (1.25 * v[hip] - 0.25 * jump.motor_rad_per_s[HIP]),
        q[knee] - back * (1.25 * v[knee] - 0.25 * jump.motor_rad_per_s[KNEE]),
    )


@inner
def _foot(
    thigh: tuple[float, float], shank: tuple[float, float], jump: Any
) -> tuple[tuple[float, float], tuple[float, float]]:
    """Return vectors (x, z) from hip to foot and from knee to foot; the links have these sines and cosines."""
    x, z = -jump.shank_length_m * shank[0], -jump.shank_length_m * shank[1]
    return (-jump.thigh_length_m * thigh[0] + x, -jump.thigh_length_m * thigh[1] + z), (x, z)


@inner
def _note_state(q: Floats, v: Floats, thigh: tuple[float, float], shank: tuple[float, float], jump: Any) -> None:
    """Keep the state at the start of a step, with sine and cosine of the links' angles."""
    z, _, _, hip, knee = places(v.shape[0])
    jump.position[0] = q[0] if z == 1 else 0.0
    jump.velocity[0] = v[0] if z == 1 else 0.0
    for k in range(3):
        jump.position[1 + k] = q[z + k]
        jump.velocity[1 + k] = v[z + k]
    jump.motor_rad[HIP], jump.motor_rad[KNEE] = q[hip], q[knee]
    jump.motor_rad_per_s[HIP], jump.motor_rad_per_s[KNEE] = v[hip], v[knee]
    jump.directions[0], jump.directions[1] = thigh
    jump.directions[2], jump.directions[3] = shank
    jump.drift_m = abs(jump.position[0])


@inner
def _gate(clearance: float, touching: bool, jump: Any) -> float:
    """Return the share of the torque that passes at a foot clearance; notes lift-off.

    From the first touch of a landing on, all of it does: its spring holds the leg through a bounce as well.
    """
    if jump.landing > 0.0:
        stands: float = jump.stood
        return stands
    length = jump.fade_length_m
    if length > 0.0:
        u: float = min(max(clearance / length, 0.0), 1.0)
        gate = 1.0 - u * u * (3.0 - 2.0 * u)
        in_air = clearance >= length
    else:
        # After a step MuJoCo's contact list still describes the state before it; a literal program reads that list.
        listed = touching if jump.lags == 0.0 or jump.steps == 1 else jump.touched > 0.0
        jump.touched = 1.0 if touching else 0.0
        gate = 1.0 if listed else 0.0
        in_air = not listed
    if jump.quiet_periods > 0.0:
        return 0.0  # switched off for good, whatever the foot does
    jump.off_floor = 1.0 if in_air and jump.stood > 0.0 else 0.0
    return gate


@inner
def _command(wanted: tuple[float, float], share: tuple[float, float], speed: tuple[float, float], jump: Any) -> None:
    """Give the drivers the torques of this control period; they act on the command of ``delay_periods`` ago."""
    size = jump.commands.shape[0]
    late = jump.periods - jump.delay_periods
    slot = int(jump.periods) % size
    for joint in range(2):
        jump.commands[slot, joint], jump.commands[slot, 2 + joint] = wanted[joint], share[joint]
    jump.periods += 1.0
    for joint in range(2):
        jump.motor_torque_n_m[joint] = 0.0
    if late < 0.0:
        return
    slot = int(late) % size
    if jump.commands[slot, 2 + HIP] > 0.0:
        jump.active_steps += 1
        for joint in range(2):
            torque = limited(jump.commands[slot, joint], speed[joint], jump, joint)
            jump.motor_torque_n_m[joint] = jump.commands[slot, 2 + joint] * torque


@inner
def _book(jump: Any, speed: tuple[float, float]) -> None:
    """Add up the step just made: its work is torque times the mean speed of the step, or the speed at its start."""
    timestep, bus = jump.timestep_s, 0.0
    for joint in range(2):
        torque, start = jump.motor_torque_n_m[joint], jump.speed_rad_per_s[joint]
        during = 0.5 * (start + speed[joint]) if jump.mean_speed > 0.0 else start
        power = torque * during
        if power > 0.0:
            jump.energy_j[joint] += power * timestep
        else:
            jump.absorbed_j[joint] -= power * timestep
        jump.drive_loss_j[joint] += (torque - jump.joint_torque_n_m[joint]) * during * timestep
        heating = jump.heat_w_per_n2_m2[joint] * torque * torque
        jump.joule_heat_j += heating * timestep
        jump.winding_heat_j[joint] += heating * timestep
        bus += power + heating
        if jump.bus == 0.0 or joint == KNEE:
            share = 1.0 if bus > 0.0 else jump.regeneration_share
            jump.electrical_energy_j += share * bus * timestep
            bus = 0.0
        jump.peak_torque_n_m[joint] = max(jump.peak_torque_n_m[joint], abs(torque))
        jump.peak_speed_rad_per_s[joint] = max(jump.peak_speed_rad_per_s[joint], abs(speed[joint]))
        jump.peak_power_w[joint] = max(jump.peak_power_w[joint], abs(power))


@inner
def _loads(v: Floats, jump: Any) -> None:
    """Book the loads in the step just made, from its mean acceleration, by Newton's and Euler's laws of the planar leg.

    The floor's force accelerates the whole robot. An end stop takes the moment about its joint of all that hangs below
    it, less the torques of actuator, floor and viscous friction; Coulomb friction is counted with the stop. A gearbox
    transmits the motor's torque less what accelerates the rotor; the chain transmits the knee's torque less what
    accelerates everything before its sprocket. With an elastic drive, what turns belongs to the motors, a joint gets
    the torque of its spring, and that of the knee is the chain's. On a vertical guide the floor's force in x
    accelerates nothing. On a stand it is what a joint that is off its stops needs besides its actuator; without a stand
    it is left out.
    """
    timestep = jump.timestep_s
    z, hip_joint, knee_joint, hip_motor, knee_motor = places(v.shape[0])
    elastic = hip_motor != hip_joint
    hip, knee = (jump.directions[0], jump.directions[1]), (jump.directions[2], jump.directions[3])
    turn, turn_below = jump.velocity[2], jump.velocity[2] + jump.velocity[3]
    ax = (v[0] - jump.velocity[0]) / timestep if z == 1 else 0.0
    az = (v[z] - jump.velocity[1]) / timestep + GRAVITY_M_PER_S2
    spin_up, below_spin_up = (v[hip_joint] - jump.velocity[2]) / timestep, (v[knee_joint] - jump.velocity[3]) / timestep
    jump.spin_up_rad_per_s2[HIP], jump.spin_up_rad_per_s2[KNEE] = spin_up, below_spin_up
    below_spin_up += spin_up
    motor_spin_up = (
        (v[hip_motor] - jump.motor_rad_per_s[HIP]) / timestep,
        (v[knee_motor] - jump.motor_rad_per_s[KNEE]) / timestep,
    )

    thigh = turned(jump.thigh_com_m, hip)
    to_knee = turned((0.0, -jump.thigh_length_m), hip)
    shank = turned(jump.shank_com_m, knee)
    to_floor = turned((0.0, -jump.shank_length_m), knee)
    at_knee = _accelerated((ax, az), to_knee, turn, spin_up)
    at_thigh = _accelerated((ax, az), thigh, turn, spin_up)
    at_shank = _accelerated(at_knee, shank, turn_below, below_spin_up)
    mass, thigh_mass, shank_mass = jump.body_mass_kg[0] + jump.stand_mass_kg, jump.body_mass_kg[1], jump.body_mass_kg[2]
    floor = (0.0, 0.0)
    if jump.position[1] + to_knee[1] + to_floor[1] - jump.foot_radius_m <= 0.0:
        fx = mass * ax + thigh_mass * at_thigh[0] + shank_mass * at_shank[0]
        rails = math.copysign(jump.rail_friction_n, jump.velocity[1] + v[z])
        fz = mass * az + thigh_mass * at_thigh[1] + shank_mass * at_shank[1] + rails
        floor = (fx if z == 1 else 0.0, fz)

    at_sole = (to_floor[0], to_floor[1] - jump.foot_radius_m)
    below = jump.link_inertia_kg_m2[1] * below_spin_up + shank_mass * _moment(shank, at_shank) - _moment(at_sole, floor)
    whole = below + jump.link_inertia_kg_m2[0] * spin_up + thigh_mass * _moment(thigh, at_thigh)
    pull = (shank_mass * at_shank[0] - floor[0], shank_mass * at_shank[1] - floor[1])
    whole += _moment(to_knee, pull) + jump.coupling_kg_m2 * motor_spin_up[KNEE]
    turning = jump.armature_kg_m2[KNEE] * motor_spin_up[KNEE] + jump.coupling_kg_m2 * spin_up
    if elastic:
        needed, driven = (whole, below), (_spring(HIP, jump), _spring(KNEE, jump))
        damped, chain = (0.0, 0.0), driven[KNEE]
    else:
        needed = (whole + jump.armature_kg_m2[HIP] * spin_up, below + turning)
        driven = (jump.joint_torque_n_m[HIP], jump.joint_torque_n_m[KNEE])
        damping = jump.joint_damping_n_m_s_per_rad
        damped, chain = (damping[HIP] * v[hip_joint], damping[KNEE] * v[knee_joint]), driven[KNEE] - turning
    jump.peak_chain_tension_n = max(jump.peak_chain_tension_n, abs(chain) / jump.sprocket_radius_m)
    if jump.stand_mass_kg > 0.0 and floor[1] != 0.0:
        free = HIP if jump.lower_stop_rad[HIP] <= jump.position[2] <= jump.upper_stop_rad[HIP] else KNEE
        arms = (at_sole[1] + to_knee[1], at_sole[1])
        fx = (needed[free] - driven[free] + damped[free]) / arms[free]
        floor, pull = (fx, floor[1]), (pull[0] - fx, pull[1])
        needed = (needed[HIP] - arms[HIP] * fx, needed[KNEE] - arms[KNEE] * fx)
    jump.peak_foot_force_n = max(jump.peak_foot_force_n, math.sqrt(floor[0] * floor[0] + floor[1] * floor[1]))
    jump.peak_knee_force_n = max(jump.peak_knee_force_n, math.sqrt(pull[0] * pull[0] + pull[1] * pull[1]))

    riding = spin_up if jump.coupling_kg_m2 > 0.0 else 0.0
    for joint in range(2):
        rotor_spin_up = jump.ratio[joint] * motor_spin_up[joint] + (riding if joint == KNEE else 0.0)
        gear = abs(jump.motor_torque_n_m[joint] - jump.rotor_kg_m2[joint] * rotor_spin_up)
        jump.peak_gear_torque_n_m[joint] = max(jump.peak_gear_torque_n_m[joint], gear)
        angle, after = jump.position[2 + joint], v[hip_joint + joint]
        if angle < jump.lower_stop_rad[joint] or angle > jump.upper_stop_rad[joint]:
            stop = needed[joint] - driven[joint] + damped[joint]
            if jump.bumper_n_m[joint] > 0.0:
                stop = jump.stop_torque_n_m[joint]
            jump.peak_stop_torque_n_m[joint] = max(jump.peak_stop_torque_n_m[joint], abs(stop))
            beyond = max(jump.lower_stop_rad[joint] - angle, angle - jump.upper_stop_rad[joint])
            jump.peak_beyond_stop_rad[joint] = max(jump.peak_beyond_stop_rad[joint], beyond)
            jump.stop_energy_j -= stop * 0.5 * (jump.velocity[2 + joint] + after) * timestep


@inner
def _spring(joint: int, jump: Any) -> float:
    """Return the torque on a joint of its elastic drive at the start of the last step, as MuJoCo's tendon pulls."""
    wound = jump.motor_rad[joint] - jump.position[2 + joint]
    play = 0.5 * jump.backlash_rad
    slack = min(max(wound, -play), play)
    rate = jump.motor_rad_per_s[joint] - jump.velocity[2 + joint]
    torque: float = jump.drive_n_m_per_rad[joint] * (wound - slack) + jump.drive_n_m_s_per_rad[joint] * rate
    return torque


@inner
def turned(vector: Any, direction: tuple[float, float]) -> tuple[float, float]:
    """Return a vector (x, z) of a body frame in the world: turned about +y by the angle with this sine and cosine."""
    sin, cos = direction
    return cos * vector[0] + sin * vector[1], cos * vector[1] - sin * vector[0]


@inner
def _accelerated(
    origin: tuple[float, float], arm: tuple[float, float], speed: float, acceleration: float
) -> tuple[float, float]:
    """Return the acceleration of the end of ``arm`` on a body that turns about +y, from that of its origin."""
    centripetal = speed * speed
    return (
        origin[0] + acceleration * arm[1] - centripetal * arm[0],
        origin[1] - acceleration * arm[0] - centripetal * arm[1],
    )


@inner
def _moment(arm: tuple[float, float], force: tuple[float, float]) -> float:
    """Return the moment about +y of a force at the end of ``arm``."""
    return arm[1] * force[0] - arm[0] * force[1]

"""A second, independent implementation of the jump: a plain loop over ``mj_step`` on the exported MJCF.

It is written from the equations and calls none of the package's code. Kinematics and the Jacobian are MuJoCo's, torque
limits are read from the model.
"""

from dataclasses import dataclass

import mujoco
import numpy as np

from pareto_monoped.jump.calibration import Calibration
from pareto_monoped.robot.population import RobotArrays

REST_LENGTH = 10.0


@dataclass
class Motor:
    """Properties of one joint's drive that the MJCF does not contain, in SI units at the joint."""

    no_load_speed: float = np.inf
    corner_speed: float = np.inf
    loss: float = 0.0


@dataclass
class Jump:
    height: float
    energy: float
    hip_energy: float
    lift_off: float
    apex: float
    clearance: float
    ended: bool
    torques: list[np.ndarray]


def jump(
    xml: str,
    stiffness: float,
    damping: float,
    torsion: float,
    motors: list[Motor],
    *,
    fade: float | None = None,
    lags: bool = False,
    loss_speed: float = 0.5,
    time_limit: float = 3.0,
    mean_speed: bool = True,
    gravity: float = 1.0,
    read_back: bool = False,
    weight_of: str = "robot",
    flight: tuple[float, float] | None = None,
) -> Jump:
    """Paper, section II-B, on the MJCF's robot.

    Args:
        xml: the model.
        stiffness: K.
        damping: C.
        torsion: T.
        motors: of hip and knee.
        fade: clearance over which torque fades to zero for good; None: torque whenever the foot touches.
        lags: with ``fade`` None, whether the contact is that of the state before.
        loss_speed: of the smooth sign in the drive's losses.
        time_limit: in s.
        mean_speed: whether a step's work is booked with the mean of the speeds at its ends, or that at its start.
        gravity: factor on m g in F_z.
        read_back: whether the controller reads the positions of half a step ago, extrapolated with the last change of
            speed.
        weight_of: whose mass m is: the whole ``robot``'s, or that of one body.
        flight: spring and damper at both joints that pull the leg back to its start pose while the foot is off the
            floor; None: no torque there.
    """
    model = mujoco.MjModel.from_xml_string(xml)
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.keyframe("start").id)
    base, foot = model.body("base").id, model.site("foot").id
    radius = model.geom("foot").size[0]
    hinges = [model.joint(name).dofadr[0] for name in ("hip", "knee")]
    limits = model.actuator_ctrlrange[[model.actuator(name).id for name in ("hip", "knee")], 1]
    mass = model.body_mass.sum() if weight_of == "robot" else model.body(weight_of).mass[0]
    weight = gravity * mass * 9.81
    start = data.qpos[hinges].copy()
    lift = model.joint("slide_z").dofadr[0]
    step = model.opt.timestep
    energy, height, lift_off = np.zeros(2), 0.0, 0.0
    off, stood, touched = False, False, None
    torques: list[np.ndarray] = []
    seen, earlier = mujoco.MjData(model), np.zeros(model.nv)
    for k in range(round(time_limit / step) + 1):
        mujoco.mj_kinematics(model, data)
        mujoco.mj_comPos(model, data)
        height = max(height, data.xpos[base, 2])
        r = data.site_xpos[foot] - data.xpos[base]
        clearance = data.site_xpos[foot, 2] - radius
        if clearance <= 1e-9:
            stood, lift_off = True, k * step
        read = data
        if read_back:
            # Through q and the speeds at both of its neighbours: q - h/2 (v + (v - v_before) / 4).
            seen.qpos[:] = data.qpos - 0.5 * step * (data.qvel + 0.25 * (data.qvel - earlier))
            mujoco.mj_kinematics(model, seen)
            mujoco.mj_comPos(model, seen)
            read, earlier = seen, data.qvel.copy()
            r = seen.site_xpos[foot] - seen.xpos[base]
        if fade is not None:
            clearance_read = read.site_xpos[foot, 2] - radius
            off = off or (stood and clearance_read >= fade)
            u = np.clip(clearance_read / fade, 0.0, 1.0)
            share = 0.0 if off else 1.0 - (3.0 * u**2 - 2.0 * u**3)
        else:
            touches = clearance <= 1e-9
            listed = touched if lags and touched is not None else touches
            touched = touches
            off, share = stood and not listed, float(listed)
        if off and data.qvel[lift] <= 0.0:
            return Jump(height, energy.sum(), energy[0], lift_off, k * step, clearance, True, torques)

        speeds = data.qvel[hinges].copy()
        torque = np.zeros(2)
        if share > 0.0:
            position = np.zeros((3, model.nv))
            mujoco.mj_jacSite(model, read, position, None, foot)
            jacobian = position[[0, 2]][:, hinges]
            rx, rz = r[0], r[2]
            length = np.hypot(rx, rz)
            alpha = np.arcsin(-rx / length)
            dr = jacobian @ speeds
            axial = stiffness * (REST_LENGTH - length) - damping * (rx * dr[0] + rz * dr[1]) / length
            twist = torsion * (0.0 - alpha)
            fz = -axial * np.cos(alpha) + twist / length * np.sin(alpha) - weight
            fx = -axial * np.sin(alpha) - twist / length * np.cos(alpha)
            torque = jacobian.T @ [fx, fz]
            for j, motor in enumerate(motors):
                up = down = 1.0
                if np.isfinite(motor.no_load_speed):
                    span = motor.no_load_speed - motor.corner_speed
                    up = np.clip((motor.no_load_speed - speeds[j]) / span, 0.0, 1.0)
                    down = np.clip((motor.no_load_speed + speeds[j]) / span, 0.0, 1.0)
                torque[j] = share * np.clip(torque[j], -limits[j] * down, limits[j] * up)
        elif flight is not None:
            torque = np.clip(flight[0] * (start - data.qpos[hinges]) - flight[1] * speeds, -limits, limits)
        for j, motor in enumerate(motors):
            lost = motor.loss * abs(torque[j]) * np.tanh(speeds[j] / loss_speed)
            data.ctrl[j] = np.clip(torque[j] - lost, -limits[j], limits[j])
        torques.append(data.ctrl.copy())
        mujoco.mj_step(model, data)
        booked = 0.5 * (speeds + data.qvel[hinges]) if mean_speed else speeds
        energy += np.maximum(torque * booked, 0.0) * step
    return Jump(height, energy.sum(), energy[0], lift_off, np.nan, np.nan, False, torques)


def motors_of(robots: RobotArrays, i: int, calibration: Calibration) -> list[Motor]:
    """The drives of robot ``i``, from its motor's data sheet."""
    drive, motors = calibration.drive, []
    gears = robots.efficiency_total if drive.efficiency == "total" else robots.efficiency
    for j, transmission in enumerate((1.0, drive.chain_efficiency)):
        motor = Motor(loss=1.0 - (gears[i, j] if drive.mesh_losses else 1.0) * transmission)
        if drive.voltage_limit:
            constant = robots.ratio[i, j] * robots.torque_constant_n_m_per_a[i, j]
            peak = drive.peak_torque_scale * robots.peak_torque_n_m[i, j]
            motor.no_load_speed = robots.no_load_speed_rad_per_s[i, j]
            motor.corner_speed = motor.no_load_speed - robots.winding_resistance_ohm[i, j] * peak / constant**2
        motors.append(motor)
    return motors

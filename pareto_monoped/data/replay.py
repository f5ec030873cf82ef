"""Makes a jump of this folder again, with MuJoCo and NumPy alone. Run: python replay.py, or python replay.py stand.

Reads ``monoped.xml`` (the robot) and ``jump.json`` (everything else), or both with ``_stand``: the jump on a stand.
Prints height and energy, and if they are the export's. Units are SI; pairs are hip, knee. Equations: docs/model.md.
"""

import json
import sys
from pathlib import Path

import mujoco
import numpy as np


def foot(jump: dict, hip: float, knee: float) -> tuple[float, float, float, float]:
    """The place (x, z) of the foot from the hip, then from the knee."""
    thigh, shank = jump["thigh_length_m"], jump["shank_length_m"]
    shank_x, shank_z = -shank * np.sin(hip + knee), -shank * np.cos(hip + knee)
    return -thigh * np.sin(hip) + shank_x, -thigh * np.cos(hip) + shank_z, shank_x, shank_z


def virtual_leg(jump: dict, hip: float, knee: float, speed: np.ndarray) -> tuple[np.ndarray, float]:
    """Torques of the virtual spring, damper and torsional spring, and the height of the foot's centre below the hip."""
    rx, rz, shank_x, shank_z = foot(jump, hip, knee)
    length = np.sqrt(rx * rx + rz * rz)
    sin, cos = -rx / length, -rz / length
    alpha = np.arctan2(-rx, -rz)
    jacobian = np.array([[rz, shank_z], [-rx, -shank_x]])
    rate = np.array([rx, rz]) @ jacobian @ speed / length
    axial = jump["stiffness_n_per_m"] * (jump["rest_length_m"] - length) - jump["damping_n_s_per_m"] * rate
    across = -jump["torsional_stiffness_n_m_per_rad"] * alpha / length
    force = np.array([-axial * sin - across * cos, -axial * cos + across * sin - jump["weight_n"]])
    return jacobian.T @ force, rz


def profile(jump: dict, time: float, below: tuple[float, float]) -> np.ndarray:
    """Torques of a profile: knots over time or over the leg's length, with straight lines or cubics between them."""
    place = time if jump["law"] == "torque_over_time" else np.hypot(*below)
    count = jump["knots"]
    along = np.clip((place - jump["first_knot"]) * jump["per_profile"], 0.0, 1.0) * (count - 1)
    k = min(int(along), count - 2)
    u = along - k
    knots = np.array([jump["hip_knots"], jump["knee_knots"]]) * np.array(jump["torque_limit_n_m"])[:, None]
    start, end = knots[:, k], knots[:, k + 1]
    if not jump["cubic"]:
        return start + u * (end - start)
    before = knots[:, k - 1] if k > 0 else 2.0 * start - end
    after = knots[:, k + 2] if k + 2 < count else 2.0 * end - start
    out, into = 0.5 * (end - before), 0.5 * (after - start)
    return start + u * (out + u * (3.0 * (end - start) - 2.0 * out - into + u * (out + into - 2.0 * (end - start))))


def limited(jump: dict, torque: np.ndarray, speed: np.ndarray) -> np.ndarray:
    """Within the motors' peak torque and, where they drive, within their voltage-speed line."""
    limit, share, against = np.array(jump["torque_limit_n_m"]), np.ones(2), np.ones(2)
    if jump["voltage_limit"]:
        no_load, corner = np.array(jump["no_load_speed_rad_per_s"]), np.array(jump["corner_speed_rad_per_s"])
        share = np.clip((no_load - speed) / (no_load - corner), 0.0, 1.0)
        against = np.clip((no_load + speed) / (no_load - corner), 0.0, 1.0)
    return np.clip(torque, -limit * against, limit * share)


def delivered(jump: dict, torque: np.ndarray, speed: np.ndarray) -> np.ndarray:
    """What reaches the joints: load-dependent friction of gears and chain opposes the motion."""
    limit, loss = np.array(jump["torque_limit_n_m"]), np.array(jump["loss"])
    after = torque - loss * np.abs(torque) * np.tanh(speed / jump["loss_speed_rad_per_s"])
    return np.where((loss == 0.0) | (torque == 0.0), torque, np.clip(after, -limit, limit))


def bumpers(jump: dict, angle: np.ndarray, speed: np.ndarray) -> np.ndarray:
    """Torques of the end stops after Hunt and Crossley: the bumper's slow torque times 1 + chi speed, never a pull."""
    lower, upper = np.array(jump["lower_stop_rad"]), np.array(jump["upper_stop_rad"])
    side = np.where(angle < lower, 1.0, -1.0)
    share = np.maximum(np.maximum(lower - angle, angle - upper), 0.0) * jump["bumper_per_rad"]
    slow = np.array(jump["bumper_n_m"]) * (1.25 * share * np.sqrt(share) + 50.0 * share**6)
    return side * slow * np.maximum(0.0, 1.0 - side * jump["bumper_s_per_rad"] * speed)


def replay(folder: Path, place: str = "") -> tuple[float, float, float]:
    """Height in m, mechanical energy and energy from the battery in J of the jump in ``folder``; place: "_stand"."""
    jump = json.loads((folder / f"jump{place}.json").read_text())
    model = mujoco.MjModel.from_xml_path(str(folder / f"monoped{place}.xml"))
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.keyframe("start").id)
    at = {model.joint(k).name: int(model.joint(k).qposadr[0]) for k in range(model.njnt)}
    z, hip, knee = (at[name] for name in ("slide_z", "hip", "knee"))
    # Elastic drives turn against their joints.
    motors = [at.get("hip_motor", hip), at.get("knee_motor", knee)]
    heat_per_torque2 = np.array(jump["heat_w_per_n2_m2"])
    height, work, electrical = data.qpos[z], np.zeros(2), 0.0
    stood = touched = latched = off = False
    commands: list[tuple[np.ndarray, np.ndarray]] = []
    motor, quiet, step, before = np.zeros(2), 0, 0, np.zeros(model.nv)
    while step <= jump["step_limit"]:
        speed = data.qvel[motors].copy()
        below = virtual_leg(jump, data.qpos[hip], data.qpos[knee], speed)[1]
        height = max(height, data.qpos[z])
        touching = data.qpos[z] + below - jump["foot_radius_m"] <= jump["touch_m"]
        stood = stood or touching
        # What the controller reads: positions at the time of the speeds, half a step back.
        q = data.qpos - jump["read_back_s"] * (1.25 * data.qvel - 0.25 * before)
        ahead = data.qvel + jump["read_back_s"] * (data.qvel - before) / jump["timestep_s"]
        before = data.qvel.copy()
        wanted, below = virtual_leg(jump, q[motors[0]], q[motors[1]], speed)
        if "law" in jump:
            wanted = profile(jump, step * jump["timestep_s"], foot(jump, *q[motors])[:2])
            if jump["law"] == "tracking":
                damper = {"stiffness_n_per_m": 0.0, "torsional_stiffness_n_m_per_rad": 0.0, "weight_n": 0.0}
                wanted = wanted + virtual_leg(jump | damper, q[motors[0]], q[motors[1]], speed)[0]
        clearance = q[z] + below - jump["foot_radius_m"]
        tick = step % jump["period_steps"] == 0 and not latched
        if tick:
            if jump["fade_length_m"]:
                u = np.clip(clearance / jump["fade_length_m"], 0.0, 1.0)
                gate, in_air = 1.0 - u * u * (3.0 - 2.0 * u), clearance >= jump["fade_length_m"]
            else:  # the contact list that MuJoCo leaves after a step describes the state before it
                listed = touched if jump["lags"] and step else touching
                gate, in_air, touched = float(listed), not listed, touching
            off = quiet > 0 or (in_air and stood)
            gate = 0.0 if quiet else gate
        if off and data.qvel[z] <= 0.0:
            break
        if tick and off and jump["latch"]:
            latched = quiet >= jump["delay_periods"]
            quiet += 1
        if latched:
            motor = np.zeros(2)
        elif tick:
            shares = np.full(2, gate)
            if jump["knee_release_rad"]:
                shares[1] *= np.clip((q[motors[1]] - jump["lower_stop_rad"][1]) / jump["knee_release_rad"], 0.0, 1.0)
            stiffness, damping = jump["flight_stiffness_n_m_per_rad"], jump["flight_damping_n_m_s_per_rad"]
            if not gate and stiffness:  # pull the leg back to its start pose
                shares, wanted = np.ones(2), stiffness * (jump["start_rad"] - q[motors]) - damping * speed
            commands.append((shares, wanted))
            motor = np.zeros(2)
            if len(commands) > jump["delay_periods"]:
                shares, torque = commands[-1 - int(jump["delay_periods"])]
                motor = shares * limited(jump, torque, speed)
        data.ctrl[:2] = delivered(jump, motor, speed)
        if model.nu > 2:
            data.ctrl[2:] = bumpers(jump, data.qpos[[hip, knee]], ahead[[hip, knee]])
        mujoco.mj_step(model, data)
        step += 1
        during = 0.5 * (speed + data.qvel[motors]) if jump["mean_speed"] else speed
        power = motor * during
        work += np.maximum(power, 0.0) * jump["timestep_s"]
        at_battery = power + heat_per_torque2 * motor**2
        at_battery = at_battery.sum(keepdims=True) if jump["bus"] else at_battery
        share_back = np.where(at_battery > 0.0, 1.0, jump["regeneration_share"])
        electrical += float(np.sum(share_back * at_battery)) * jump["timestep_s"]
    return float(height), float(work.sum()), electrical + jump["standby_power_w"] * step * jump["timestep_s"]


if __name__ == "__main__":
    here, place = Path(__file__).resolve().parent, "_stand" if sys.argv[1:] == ["stand"] else ""
    found = replay(here, place)
    expected = json.loads((here / f"jump{place}.json").read_text())["expected"]
    same = True
    for name, value in zip(("height_m", "energy_j", "electrical_energy_j"), found, strict=True):
        same = same and abs(value - expected[name]) <= 1e-9 * max(1.0, abs(expected[name]))
        print(f"{name:20} {value:.9f}   export {expected[name]:.9f}")
    sys.exit(0 if same else "not the jump of this export: another version of MuJoCo or a changed file?")

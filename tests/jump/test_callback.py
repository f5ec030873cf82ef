"""The controller acts in the batches of this package, on any thread, and nowhere else."""

import ctypes
from concurrent.futures import ThreadPoolExecutor
from contextlib import nullcontext
from dataclasses import replace

import mujoco
import numba
import numpy as np
import pytest

from pareto_monoped.errors import SimulationError
from pareto_monoped.jump import callback, controller_record, planar, single
from pareto_monoped.jump.calibration import load_calibration
from pareto_monoped.jump.callback import controlled, untimed
from pareto_monoped.jump.evaluate import evaluate_robots
from tests.jump.robots import plausible_robots, random_designs

PENDULUM = """<mujoco><size nuserdata="{user}"/><worldbody><body><joint name="j" axis="0 1 0"/>
<geom type="capsule" size="0.02" fromto="0 0 0 0.3 0 -0.1"/></body></worldbody>
<actuator><motor joint="j"/></actuator></mujoco>"""


def swing(user):
    """Angle and control of another user's pendulum after 50 steps under a torque."""
    model = mujoco.MjModel.from_xml_string(PENDULUM.format(user=user))
    data = mujoco.MjData(model)
    data.ctrl[0] = 0.05
    data.userdata[:] = 7.0
    for _ in range(50):
        mujoco.mj_step(model, data)
    assert np.all(data.userdata == 7.0)
    return data.qpos[0], data.ctrl[0]


@pytest.mark.parametrize("user", [0, 3])
def test_other_simulations_of_the_process_are_left_alone(user):
    alone = swing(user)
    with controlled():
        assert swing(user) == alone


def test_a_callback_of_the_user_comes_back():
    seen = []

    @ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_void_p)
    def own(model, data):
        seen.append(1)

    try:
        mujoco.set_mjcb_control(own)
        designs = random_designs(3, seed=2)
        evaluate_robots(plausible_robots(designs), designs[:, 4:], load_calibration().by("mujoco"))
        seen.clear()
        swing(0)
        assert len(seen) >= 50
    finally:
        mujoco.set_mjcb_control(None)


def test_nothing_stays_installed():
    with controlled(), controlled():
        assert mujoco.get_mjcb_control() is not None
    assert mujoco.get_mjcb_control() is None
    with pytest.raises(ZeroDivisionError), controlled():
        raise ZeroDivisionError
    assert mujoco.get_mjcb_control() is None


def test_mujoco_reads_no_clock_meanwhile_and_does_again_later():
    def timed_s():
        model = mujoco.MjModel.from_xml_string(PENDULUM.format(user=0))
        data = mujoco.MjData(model)
        for _ in range(50):
            mujoco.mj_step(model, data)
        return data.timer[int(mujoco.mjtTimer.mjTIMER_STEP)].duration

    assert timed_s() > 0.0
    with untimed(), untimed():
        assert timed_s() == 0.0
    assert timed_s() > 0.0


def test_calibrations_on_several_threads_do_not_meet():
    designs = random_designs(8, seed=4)
    robots = plausible_robots(designs)

    reference, paper = load_calibration("reference-3"), load_calibration("paper")
    calibrations = {
        "reference": load_calibration(),
        "by MuJoCo": load_calibration().by("mujoco"),
        "rigid": reference,
        "paper": paper,
        "by Runge-Kutta": replace(
            reference, simulation=replace(reference.simulation, integrator="RK4", positions_read="state")
        ),
        "literal gate": replace(reference, gate=paper.gate),
    }

    def jump(name):
        return evaluate_robots(robots, designs[:, 4:], calibrations[name]).as_columns()

    names = list(calibrations) * 2
    alone = {name: jump(name) for name in set(names)}
    with ThreadPoolExecutor(3) as pool:
        for name, columns in zip(names, pool.map(jump, names), strict=True):
            for column, values in columns.items():
                np.testing.assert_array_equal(values, alone[name][column], err_msg=f"{name} {column}")


def test_a_callback_on_disk_is_told_from_one_of_another_controller(tmp_path, monkeypatch):
    """The cache on disk depends on the callback's file and closure, not on the controller that the callback calls."""
    for name in ("controller.py", "torques.py", "planar.py"):
        (tmp_path / name).write_text("axial = 1.0")
    monkeypatch.setattr(controller_record, "__file__", str(tmp_path / "controller_record.py"))
    origins = [controller_record.origin()]
    for name in ("controller.py", "torques.py", "planar.py"):
        (tmp_path / name).write_text("axial = 2.0")
        origins += [controller_record.origin(), controller_record.origin()]
    assert origins[1::2] == origins[2::2]
    assert len(set(origins)) == 4
    for make in (callback._controller, planar._stepper, single._controller):
        closure = getattr(make(origins[0]), "py_func", make(origins[0])).__closure__
        assert origins[0] in [cell.cell_contents for cell in closure]
        # One of these is another one in each process, and what closes over it would be compiled in each.
        assert not any(isinstance(cell.cell_contents, numba.core.dispatcher.Dispatcher) for cell in closure)


def test_jumps_that_the_controller_is_kept_from_end_in_an_error_and_not_never(monkeypatch):
    designs = random_designs(3, seed=2)
    monkeypatch.setattr(callback, "controlled", nullcontext)
    with pytest.raises(SimulationError, match="mjcb_control"):
        evaluate_robots(plausible_robots(designs), designs[:, 4:], load_calibration().by("mujoco"))


def test_a_mujoco_without_its_library_is_said(monkeypatch, tmp_path):
    monkeypatch.setattr(callback.mujoco, "__file__", str(tmp_path / "__init__.py"))
    with pytest.raises(SimulationError, match="libmujoco"):
        callback._library()

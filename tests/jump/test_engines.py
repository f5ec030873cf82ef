"""The compiled engine against MuJoCo: every number of the record, inverse masses, failures, variations, threads."""

from dataclasses import replace

import numba
import numpy as np
import pytest

from pareto_monoped.actuator.search import map_for
from pareto_monoped.design import CONTROL, LOWER, NAMES, PAPER_CASES, UPPER, VARIABLES, columns, complete
from pareto_monoped.errors import CalibrationError
from pareto_monoped.jump import planar
from pareto_monoped.jump.audit import SAME, Jumps, audit, judge
from pareto_monoped.jump.calibration import calibration_of, calibration_values, load_calibration, on_stand
from pareto_monoped.jump.controller_record import RECORD
from pareto_monoped.jump.engines import population_of
from pareto_monoped.jump.evaluate import Evaluator
from pareto_monoped.jump.model import start_pose
from pareto_monoped.jump.population import prepare
from pareto_monoped.jump.variations import take
from pareto_monoped.measures import MEASURE_NAMES
from pareto_monoped.robot.population import robot_arrays
from pareto_monoped.uncertainty.samples import sobol_samples, variations
from pareto_monoped.uncertainty.settings import load_uncertainty

ELASTIC = load_calibration("reference")
_RIGID = replace(ELASTIC, drive=replace(ELASTIC.drive, elastic=False))
CALIBRATIONS = {
    "elastic": ELASTIC,
    "elastic on the stand": on_stand(ELASTIC),
    "elastic with play": replace(ELASTIC, drive=replace(ELASTIC.drive, backlash_rad=0.004)),
    "late": replace(ELASTIC, simulation=replace(ELASTIC.simulation, delay_s=2e-3)),
    "rigid, 1 ms": replace(_RIGID, simulation=replace(_RIGID.simulation, timestep_s=1e-3)),
    "rotors as armature": replace(_RIGID, joints=replace(_RIGID.joints, rotors="armature")),
    "no stops, slippery": replace(
        _RIGID,
        joints=replace(_RIGID.joints, stops="given", stop_law="constraint"),
        contact=replace(_RIGID.contact, friction=0.3),
    ),
}
MOTORS = ("VT8020", "U8", "U10", "U12", "MN8014", "MAD_M6C12")


def wild_designs(count, seed):
    """Over the whole space of all variables, optional ones included; many of them fail to jump."""
    lower, upper = ([getattr(each, end) for each in VARIABLES] for end in ("lower", "upper"))
    designs = complete(np.random.default_rng(seed).uniform(lower, upper, (count, len(VARIABLES))))
    designs[::3, NAMES.index("stiffness_n_per_m")] *= 0.02  # too weak to lift the robot
    return designs


def both(designs, motor, calibration):
    """Records of both engines for the designs that can stand."""
    robots = robot_arrays(designs, map_for(motor), calibration.mass)
    pose = start_pose(robots, calibration)
    rows = np.flatnonzero([not one and not other for one, other in zip(robots.reason, pose.reason, strict=True)])
    robots, pose, control = take(robots, rows), take(pose, rows), columns(designs[rows], CONTROL)
    found = population_of(robots, control, pose, calibration.by("compiled"), 1, None)
    judge = prepare(robots, control, pose, calibration.by("mujoco"))
    found.run()
    judge.run()
    return found.records, judge.records, judge


def the_same(designs, motor, calibration, share=5e-8):
    compiled, mujoco, judge = both(designs, motor, calibration)
    np.testing.assert_array_equal(compiled["status"], mujoco["status"])
    # Of a robot that rocks to the end of its time only the status is compared: rounding has grown for seconds.
    over = np.array([not text for text in judge.complaints()]) & (mujoco["steps"] < mujoco["step_limit"])
    for name in RECORD.names:
        if name == "spin_up_rad_per_s2":  # a difference of two speeds over the step
            continue
        scale = np.maximum(np.abs(mujoco[name][over]).max(initial=0.0), 1e-9)
        np.testing.assert_allclose(compiled[name][over], mujoco[name][over], rtol=0.0, atol=share * scale, err_msg=name)
    return compiled


@pytest.mark.parametrize("which", CALIBRATIONS)
def test_every_number_of_the_record_is_mujocos(which):
    """Measured on 200 designs: 2e-11 of the greatest value, 1e-8 where drives have play."""
    compiled = the_same(
        complete(np.random.default_rng(5).uniform(LOWER, UPPER, (25, len(LOWER)))), "VT8020", CALIBRATIONS[which]
    )
    assert (compiled["status"] == 2.0).sum() >= 15


@pytest.mark.parametrize("motor", [MOTORS[0], *(pytest.param(name, marks=pytest.mark.long) for name in MOTORS[3::3])])
def test_so_it_is_with_other_motors_and_all_variables_whatever_becomes_of_the_jump(motor):
    compiled = the_same(wild_designs(30, seed=6), motor, ELASTIC)
    assert len(np.unique(compiled["status"])) >= 2


@pytest.mark.long
@pytest.mark.parametrize("which", CALIBRATIONS)
@pytest.mark.parametrize("motor", MOTORS)
def test_so_it_is_on_thousands_of_designs(motor, which):
    """Rounding grows while a weak robot rocks, and most where gears with play hammer meanwhile."""
    share = 0.05 if which == "elastic with play" else 3e-6
    the_same(wild_designs(200, seed=7), motor, CALIBRATIONS[which], share)


def test_inverse_masses_are_mujocos(monkeypatch):
    """As Python: compiled for themselves they would take seconds, and jumps of both engines compare them compiled."""
    for name, value in vars(planar).items():
        if isinstance(value, numba.core.dispatcher.Dispatcher):
            monkeypatch.setattr(planar, name, value.py_func)
    from pareto_monoped.jump.population import first_records

    for calibration in (ELASTIC, on_stand(ELASTIC), _RIGID):
        robots = robot_arrays(complete(np.array([PAPER_CASES["C"].design.as_array()])), map_for("U12"))
        batch = prepare(
            robots, np.zeros((1, len(CONTROL))), start_pose(robots, calibration), calibration.by("mujoco")
        ).batch
        elastic, guided = calibration.drive.elastic, not calibration.simulation.base_slides
        z = 0 if guided else 1
        dofs = [z, z + 4, z + 3] if elastic else [z, z + 1, z + 2]
        joints = np.asarray(batch.expand("dof_invweight0"))[0, dofs]
        foot = np.asarray(batch.expand("body_invweight0"))[0, 3, 0]
        record = first_records(robots, np.zeros((1, len(CONTROL))), calibration).view(np.recarray)[0]
        inverse, work = np.zeros(4), (np.zeros((4, 2)), np.zeros((4, 4)), np.zeros((4, 4)), np.zeros(6), np.zeros(6))
        planar._inverse_masses(guided, elastic, record, work, inverse)
        np.testing.assert_allclose(inverse, [*joints, foot], rtol=1e-9)


def test_no_result_depends_on_threads_or_on_the_rest_of_the_batch():
    designs = complete(np.random.default_rng(8).uniform(LOWER, UPPER, (9, len(LOWER))))
    together = Evaluator(map_for("VT8020"), ELASTIC, workers=3)(designs)
    for i in (0, 4, 8):
        alone = Evaluator(map_for("VT8020"), ELASTIC)(designs[i])
        for name in MEASURE_NAMES:
            np.testing.assert_array_equal(together.of(name)[i : i + 1], alone.of(name))


def test_robots_as_built_jump_the_same_by_both():
    designs = np.repeat(complete(np.array([PAPER_CASES["A"].design.as_array()])), 16, axis=0)
    stand = on_stand(ELASTIC)
    varied = variations(sobol_samples(load_uncertainty().where(stand=True), 16), 1, stand)
    compiled = Evaluator(map_for("VT8020"), stand)(designs, variations=varied)
    mujoco = Evaluator(map_for("VT8020"), stand.by("mujoco"))(designs, variations=varied)
    for name in MEASURE_NAMES:
        np.testing.assert_allclose(compiled.of(name), mujoco.of(name), rtol=1e-7, err_msg=name)
    assert np.ptp(compiled.height_m) > 0.01


def test_a_floor_that_throws_a_robot_off_ends_the_jump_and_no_other():
    """Each jump ends as it would alone, whatever overflows beside it."""
    hard = replace(
        ELASTIC,
        contact=replace(ELASTIC.contact, stiffness_n_per_m=1e15, damping_n_s_per_m=1e9),
        simulation=replace(ELASTIC.simulation, timestep_s=0.02, control_period_s=None, positions_read="state"),
    )
    found = Evaluator(map_for("VT8020"), hard)(
        complete(np.random.default_rng(8).uniform(LOWER, UPPER, (6, len(LOWER))))
    )
    assert "diverged" in found.status
    assert np.isnan(found.height_m[found.status == "diverged"]).all()


@pytest.mark.parametrize(
    ("table", "changes", "said"),
    [
        ("simulation", {"integrator": "RK4", "positions_read": "state"}, "needs simulation.integrator 'Euler'"),
        ("joints", {"stop_law": "constraint"}, "needs joints.stop_law 'hunt_crossley'"),
    ],
)
def test_what_the_engine_cannot_do_is_said_in_one_line(table, changes, said):
    values = calibration_values(ELASTIC)
    values[table] = values[table] | changes
    with pytest.raises(CalibrationError, match=said) as caught:
        calibration_of(values, source="my.toml")
    assert "\n" not in str(caught.value)


def test_mujoco_judges_a_jump_and_tells_another_one():
    designs = complete(np.array([case.design.as_array() for case in PAPER_CASES.values()]))
    found = Evaluator(map_for("VT8020"), ELASTIC)(designs)
    known = Jumps(status=found.status, height_m=found.height_m.copy(), energy_j=found.energy_j.copy())
    judged = judge(designs, map_for("VT8020"), ELASTIC, known)
    assert judged.clear(known).all()
    assert judged.apart(known) == ("",) * 4
    assert (judged.mujoco_height_m != found.height_m).any()  # two engines, and not one that is asked twice
    known.height_m[1] += 2.0 * SAME
    known.energy_j[2] *= 1.0 + 2.0 * SAME
    assert judged.clear(known).tolist() == [True, False, False, True]
    audited = audit(designs, map_for("VT8020"), ELASTIC, known=known, judged=judged, brief=True)
    assert audited.well_conditioned.tolist() == [True, False, False, True]
    assert (
        audited.reason[1]
        == f"by MuJoCo {judged.mujoco_height_m[1]:.7g} m on {judged.mujoco_energy_j[1]:.7g} J, not the same jump"
    )

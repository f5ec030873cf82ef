"""An export lists the safety factors of its joints and refuses a design that does not hold."""

import csv
import io
import json
from dataclasses import replace

import numpy as np
import pytest

from pareto_monoped.cad import export
from pareto_monoped.cad.as_built import as_built
from pareto_monoped.cad.check import run as strength
from pareto_monoped.cad.check.result import STRENGTH
from pareto_monoped.cad.export import export_design
from pareto_monoped.cad.jobs import Job, case_job, trial_job
from pareto_monoped.cad.records import is_made, record_job
from pareto_monoped.cad.write.tables import strength_table
from pareto_monoped.definition.study import study_from_dict
from pareto_monoped.design import NAMES, PAPER_CASES, Design
from pareto_monoped.errors import CheckError
from pareto_monoped.jump.evaluate import Evaluator
from pareto_monoped.robot.build import build_robot
from pareto_monoped.storage.reader import read_study
from pareto_monoped.strength.factors import TABLE, JointFactor, joint_factors, strength_factors
from pareto_monoped.strength.joint import LOAD_NAMES, loads_of
from pareto_monoped.study.run import run

# A low jump, whose knee lets go before its stop and whose motors do not begin with their peak torque, at which elastic
# drives would swing to nearly twice of it; and one that breaks something.
GENTLE = Design(
    thigh_length_m=0.374,
    shank_length_m=0.469,
    knee_ratio=8.4,
    hip_ratio=8.183,
    stiffness_n_per_m=6.0,
    damping_n_s_per_m=5.0,
    torsional_stiffness_n_m_per_rad=46.8,
    knee_release_rad=0.78,
)
WILD = PAPER_CASES["nominal"].design.replace({"knee_ratio": 8.4, "stiffness_n_per_m": 200.0})


@pytest.fixture(scope="module")
def gentle(actuator_map, calibration, tmp_path_factory):
    folder = tmp_path_factory.mktemp("gentle") / "robot"
    return export_design(GENTLE, actuator_map, calibration, folder, formats=("dxf",), strength=True)


def rows_of(folder):
    return list(csv.DictReader(io.StringIO((folder / "strength.csv").read_text())))


def array_factors(designs, actuator_map, calibration):
    """The factors of designs as a population has them."""
    designs = np.asarray(designs)
    result = Evaluator(actuator_map, calibration)(designs)
    columns = dict(zip(NAMES, designs.T, strict=True)) | result.as_columns()
    return strength_factors(designs, actuator_map, loads_of({name: columns[name] for name in LOAD_NAMES}))


def test_an_export_lists_every_joint_with_the_factor_of_the_arrays(gentle, actuator_map, calibration):
    built = as_built(GENTLE, actuator_map)
    others = np.random.default_rng(2).permuted(np.tile(built.as_array(), (5, 1)), axis=0)
    (expected, *_) = array_factors(np.vstack((built.as_array(), others)), actuator_map, calibration)
    rows = rows_of(gentle.folder)
    assert [row["joint"] for row in rows] == [joint.name for joint in TABLE]
    assert [float(row["factor"]) for row in rows] == pytest.approx(expected.tolist(), rel=1e-9)
    assert [row["asked"] for row in rows] == ["informs" if joint.informs else "required" for joint in TABLE]
    assert all(float(row["factor_over_required"]) >= STRENGTH.value for row in rows if row["asked"] == "required")
    assert all(row["formula"] and row["source"] and row["cure"] and row["parts"] for row in rows)
    assert [bool(row["loads"]) for row in rows] == [bool(joint.loads) for joint in TABLE]


def test_a_design_that_holds_passes_the_check_and_says_so(gentle):
    (found,) = [check for check in gentle.checks if check.name == STRENGTH.name]
    assert found.passed
    asked = [float(row["factor_over_required"]) for row in rows_of(gentle.folder) if row["asked"] == "required"]
    assert found.looked_at == f"{len(asked)} joints under the loads of the jump"
    assert len(asked) == len(TABLE) - 2
    assert found.measured == pytest.approx(min(asked))
    assert gentle.record["strength"] is True
    page = (gentle.folder / "README.md").read_text()
    assert "not asked for" not in page
    assert all(f"| {joint.name} |" in page for joint in TABLE)
    assert page.count(" | informs |") == 2
    assert f"safety of their duty for {gentle.gear_life.text} jumps." in page
    assert "every one of 100000 jumps" in page
    assert gentle.record["jumps"]["as_built"]["gear_strike_safety"] >= 1.0
    assert gentle.gear_life.jumps >= 1e5
    assert not gentle.gear_life.advice
    (stored,) = [c for c in json.loads((gentle.folder / "checks.json").read_text()) if c["check"] == STRENGTH.name]
    assert stored["passed"]


def test_parts_have_the_factors_of_their_joints(gentle, actuator_map):
    parts = {row["part"]: row for row in csv.DictReader(io.StringIO((gentle.folder / "bom.csv").read_text()))}
    listed = "\n".join(row["safety_factors"] for row in parts.values())
    units = build_robot(as_built(GENTLE, actuator_map), actuator_map).units
    for joint in TABLE:
        other = {"hip": "knee_actuator", "knee": "hip_actuator"}.get(getattr(joint, "side", ""))
        drawn = {part.name for unit in units if unit.name != other for part in unit.parts}
        # A gearbox of the other family has joints that this actuator has not.
        assert (f"{joint.name} " in listed) or not drawn & set(joint.parts), joint.name
    assert parts["chain_hip"]["safety_factors"].startswith("chain_breaking ")
    suns = [row["safety_factors"] for name, row in parts.items() if name.endswith("actuator_sun")]
    assert suns
    assert all("_gear_root " in text for text in suns)


def test_the_record_makes_the_same_job_again(gentle, tmp_path):
    job = record_job(gentle.folder / "design.json", folder=gentle.folder)
    assert job.strength
    assert is_made(job)
    assert not is_made(replace(job, strength=False))
    without = dict(gentle.record)
    del without["strength"]
    (tmp_path / "design.json").write_text(json.dumps(without | {"made_by": "pareto-monoped 0.2.0"}))
    assert not record_job(tmp_path / "design.json", folder=tmp_path / "x").strength


@pytest.fixture
def strength_alone(unchecked, monkeypatch):
    """Exports of this process check nothing but strength, and that where they are asked to."""
    monkeypatch.setattr(
        export, "run_checks", lambda *_, factors, **__: () if factors is None else (strength.check_strength(factors),)
    )


@pytest.mark.usefixtures("strength_alone")
def test_a_design_that_breaks_is_refused_in_one_line(actuator_map, calibration, tmp_path):
    with pytest.raises(CheckError) as caught:
        export_design(WILD, actuator_map, calibration, tmp_path / "robot", formats=(), strength=True)
    message = str(caught.value)
    assert "\n" not in message
    assert "safety factor = " in message
    assert "must be at least" in message
    assert any(joint.name in message and joint.cure in message for joint in TABLE)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.usefixtures("strength_alone")
def test_nobody_asked_and_every_file_says_so(actuator_map, calibration, tmp_path):
    made = export_design(WILD, actuator_map, calibration, tmp_path / "robot", formats=())
    assert made.record["strength"] is False
    assert "Strength was not asked for: this design may not hold." in (made.folder / "README.md").read_text()
    assert STRENGTH.name not in {check.name for check in made.checks}
    assert min(float(row["factor_over_required"]) for row in rows_of(made.folder)) < 1.0


@pytest.mark.usefixtures("unchecked")
def test_gears_that_are_struck_too_hard_in_every_jump_are_told_of_and_not_refused(actuator_map, calibration, tmp_path):
    """The paper's Case C: its gears hold each jump, and not all jumps of their duty."""
    made = export_design(
        PAPER_CASES["C"].design, actuator_map, calibration, tmp_path / "robot", formats=(), strength=True
    )
    assert made.record["jumps"]["as_built"]["gear_strike_safety"] < 1.0
    assert made.gear_life.jumps < 1e5
    page = (made.folder / "README.md").read_text()
    assert made.gear_life.advice[1:] in page
    assert "It informs, and nothing is refused for it." in page
    (row,) = [row for row in rows_of(made.folder) if row["joint"] == "knee_gear_strikes"]
    assert float(row["factor"]) == pytest.approx(made.record["jumps"]["as_built"]["gear_strike_safety"], rel=1e-9)


def test_the_check_compares_every_factor_with_the_one_required():
    factors = [JointFactor(joint=joint, factor=1.5 * joint.required, loads={}) for joint in TABLE]
    assert strength.check_strength(factors).passed
    # Rounded to 0.1 mm, a design that just holds may lose two percent.
    assert strength.check_strength([replace(one, factor=0.9801 * one.joint.required) for one in factors]).passed
    for k, joint in enumerate(TABLE):
        if joint.informs:
            assert strength.check_strength([*factors[:k], replace(factors[k], factor=0.1), *factors[k + 1 :]]).passed
            continue
        short = [*factors[:k], replace(factors[k], factor=0.9799 * joint.required), *factors[k + 1 :]]
        (failure,) = strength.check_strength(short).failures
        assert failure == (
            f"{joint.name}: safety factor = {0.9799 * joint.required:.3g}: must be at least {joint.required:g}; "
            f"{joint.cure}"
        )


def design_factors(design, actuator_map, calibration):
    """The factors of one design under the loads of its own jump."""
    results = Evaluator(actuator_map, calibration)(design.as_array()[None])
    columns = {name: getattr(results, name) for name in LOAD_NAMES if not hasattr(design, name)}
    lengths = {name: np.array([getattr(design, name)]) for name in LOAD_NAMES if hasattr(design, name)}
    return joint_factors(design, actuator_map, loads_of(columns | lengths))


def test_a_design_that_does_not_jump_has_no_factors(actuator_map, calibration):
    lame = GENTLE.replace({"thigh_length_m": 0.1, "shank_length_m": 0.1})
    assert design_factors(lame, actuator_map, calibration) == ()
    assert strength_table(()).count("\n") == 1
    assert strength.check_strength(()).passed


def test_jobs_ask_as_their_study_did(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for asked in (True, False):
        values = {"name": "s", "evaluations": 40, "strength": asked, "audit": False}
        run(study_from_dict(values, source="test"), tmp_path / f"{asked}.db")
        data = read_study(tmp_path / f"{asked}.db")
        assert trial_job(data, 3, folder=tmp_path).strength is asked
        assert not trial_job(data, 3, folder=tmp_path, strength=False).strength
    assert not case_job("A", folder=tmp_path, strength=False).strength
    assert isinstance(case_job("A", folder=tmp_path), Job)


def test_no_design_of_a_front_under_strength_is_refused(tmp_path, monkeypatch, calibration):
    """Designs over the front, as built: rounding their lengths moves no factor by more than the check allows."""
    monkeypatch.chdir(tmp_path)
    values = {
        "name": "front",
        "evaluations": 200,
        "strength": True,
        "audit": False,
        "variables": {
            "knee_ratio": {"lower": 4.0, "upper": 5.0},
            "knee_release_rad": {"lower": 0.3, "upper": 1.0},
            "damping_n_s_per_m": {"lower": 0.0, "upper": 60.0},
        },
    }
    run(study_from_dict(values, source="test"), tmp_path / "front.db")
    data = read_study(tmp_path / "front.db")
    front = data.front()
    assert len(front) >= 10
    spread = front.iloc[np.unique(np.linspace(0, len(front) - 1, 12).round().astype(int))]
    designs = [Design.from_array(row) for row in spread[list(NAMES)].to_numpy()]
    stored = array_factors([d.as_array() for d in designs], data.case_kit, calibration)
    required = np.array([joint.required for joint in TABLE])
    asked = [not joint.informs for joint in TABLE]
    assert np.all(stored[:, asked] >= required[asked])
    for design, row in zip(designs, stored, strict=True):
        searched = design_factors(design, data.case_kit, calibration)
        assert [one.factor for one in searched] == pytest.approx(row[~np.isnan(row)].tolist(), rel=1e-9)
        built = design_factors(as_built(design, data.case_kit), data.case_kit, calibration)
        assert strength.check_strength(built).passed

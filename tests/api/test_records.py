"""What functions return is compared without errors of pandas and NumPy, and shown in one short line."""

import dataclasses

import numpy as np
import pandas as pd
import pytest

import pareto_monoped as pm

STUDY = {"name": "light", "evaluations": 40, "algorithm": "random", "audit": False, "strength": False}
C = pm.PAPER_CASES["C"].design


@pytest.fixture(scope="module")
def db(tmp_path_factory):
    path = tmp_path_factory.mktemp("records") / "light.db"
    pm.run(pm.Study.define(**STUDY), path)
    return path


def scores():
    one = np.zeros(2)
    values = np.array([[0.8, 15.0], [0.9, 20.0]])
    objectives = pm.Study.define(**STUDY).objectives
    return pm.Scores(objectives=objectives, values=values, violation=np.array([0.0, 1.0]), constraints=one[:, None])


MADE = {
    "StoredStudy": (
        pm.load_study,
        lambda one: f"StoredStudy('light', {str(one.path)!r}, 40 trials, finished, objectives height_m, energy_j)",
    ),
    "its data": (lambda db: pm.load_study(db).data, lambda one: f"StudyData('light', {str(one.db)!r}, 40 trials)"),
    "Picked": (
        lambda db: pm.load_study(db).pick("knee"),
        lambda one: f"Picked(trial={one.trial}, why={one.why!r})",
    ),
    "ActuatorMap": (
        lambda _: dataclasses.replace(pm.actuator_map("U8")),
        lambda one: (
            f"ActuatorMap('U8', rules 'iso6336', {np.isfinite(one.masses_kg()).sum()} of 110 intervals have a gearbox, "
            f"{np.nanmin(one.masses_kg()):.3f} to {np.nanmax(one.masses_kg()):.3f} kg)"
        ),
    ),
    "MapEntry": (
        lambda _: dataclasses.replace(pm.actuator_map("U8").entry(6.0)),
        lambda one: f"MapEntry([6.0, 6.1), {one.actuator!r})",
    ),
    "MapEntry without a gearbox": (
        lambda _: dataclasses.replace(pm.actuator_map("U8").entries[-1]),
        lambda _: "MapEntry([14.9, 15.0), no gearbox)",
    ),
    "Actuator": (
        lambda _: dataclasses.replace(pm.actuator_map("U8").lookup(6.0)),
        lambda one: (
            f"Actuator('U8', {one.family} {one.gears}, {one.ratio:.4f}:1, {one.mass_kg:.3f} kg, "
            f"peak {one.peak_torque_n_m:.1f} N m)"
        ),
    ),
    "Robot": (
        lambda _: pm.build_robot(C),
        lambda one: (
            f"Robot(hip 'VT8020' 4.0909:1, knee 'VT8020' 6.0000:1, thigh 0.49 m, shank 0.36 m, {one.mass_kg:.3f} kg)"
        ),
    ),
    "Unit": (
        lambda _: pm.build_robot(C).units[0],
        lambda one: f"Unit('base_frame', on 'base', {len(one.parts)} parts)",
    ),
    "Space": (
        lambda _: pm.MonopedProblem(pm.Study.define(**STUDY)).jump.space,
        lambda one: f"Space(7 variables: {', '.join(one.names)}; for height_m, energy_j)",
    ),
    "Scores": (lambda _: scores(), lambda _: "Scores(2 designs, 1 feasible, height_m, energy_j)"),
    "MassProperties": (lambda _: pm.build_robot(C).units[0].mass_properties(), None),
}


SHOWN = {name: pair for name, pair in MADE.items() if pair[1]}


BY_IDENTITY = {name: make for name, (make, _) in MADE.items() if not name.startswith(("MapEntry", "Actuator"))}
"""Without gearboxes, which are compared by value, and with the map that they are in."""
BY_IDENTITY["ActuatorMap"] = MADE["ActuatorMap"][0]


@pytest.mark.parametrize("make", BY_IDENTITY.values(), ids=BY_IDENTITY.keys())
def test_records_that_hold_arrays_or_tables_are_compared_by_identity(make, db):
    one, other = make(db), make(db)
    assert one == one
    assert one != other
    assert len({one, other, one}) == 2
    assert one in [other, one]


@pytest.mark.parametrize(("make", "line"), SHOWN.values(), ids=SHOWN.keys())
def test_records_that_hold_arrays_or_tables_are_shown_in_one_line(make, line, db):
    one = make(db)
    assert repr(one) == line(one)
    assert len(repr(one).replace(str(db), "")) < 250
    assert "\n" not in repr(one)


def test_no_public_record_floods_a_notebook(db):
    """Every public class of which the functions make something, and what they return."""
    stored = pm.load_study(db)
    made = [make(db) for make, _ in MADE.values()]
    made += [stored.study, stored.design(0), pm.load_motor("U8"), pm.load_calibration(), pm.PAPER_CASES["C"]]
    made += [pm.MonopedProblem(stored.study), pm.OptunaObjective(stored.study), *stored.alternatives(0)]
    made += [pm.VARIABLES[0], pm.MEASURES[0], pm.verify(db), pm.Export("leg", {"mass_kg": 4.7, "files": ["a"] * 1000})]
    study, again = pm.Study.define(**STUDY), db.with_name("again.db")
    made.append(pm.run(study, again, callback=lambda now: made.append(now), second_seed=True).second)
    public = {value for name in pm.__all__ if isinstance(value := getattr(pm, name), type)}
    errors = {one for one in public if issubclass(one, pm.ParetoMonopedError)}
    assert public - {type(one) for one in made} == errors | {pm.OwnLaw}  # which are base classes
    assert [type(one).__name__ for one in made if len(repr(one)) > 1500] == []


def test_notebooks_show_a_short_table(db):
    """What is shown is what the objects say, and a name that is HTML is text."""
    stored = pm.load_study(db)
    picked = stored.pick("knee")
    shown = stored._repr_html_()
    assert f"{stored.hypervolume:.4f}" in shown
    assert f"<td style='text-align:left'>{len(stored.front())} designs</td>" in shown
    assert f"{1000.0 * picked.design.thigh_length_m:.1f} mm" in picked._repr_html_()
    assert f"{picked.row.height_m:.3f} m" in picked._repr_html_()
    jump = {"height_m": 0.9, "energy_j": 26.5}
    made = pm.Export("<b>leg", {"mass_kg": 4.7, "files": ["design.json"], "jumps": {"as_built": jump}})
    assert "0.9000 m, 26.500 J" in made._repr_html_()
    assert "&lt;b&gt;leg" in made._repr_html_()


def test_stored_studies_and_picks_may_be_keys_and_list_items(db):
    one, other = pm.load_study(db), pm.load_study(db)
    picks = {one: one.pick("knee"), other: other.pick("knee")}
    pd.testing.assert_series_equal(picks[one].row, picks[other].row)
    assert picks[one] not in [picks[other]]

"""What the library returns is as it was: tables, designs that are picked, figures, what films are made of, and errors.

As in tests/cli/test_signatures.py a change is seen, and nothing is proved. After a change that is wanted, look at it,
and make the files again: ``PARETO_MONOPED_SIGN=1 python -m pytest tests/api/test_signatures.py``.
"""

import warnings
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import pareto_monoped as pm
from pareto_monoped.cad import film as films
from pareto_monoped.errors import ParetoMonopedError
from tests.records import compare, of_text
from tests.signed_studies import go_to_studies, numbered_limit

FOLDER = Path(__file__).parent / "signatures"
A, C = (pm.PAPER_CASES[name].design for name in "AC")
MOTORS = {"hip_motor": "U8", "knee_motor": "VT8020"}


@pytest.fixture
def here(tmp_path, made_once, monkeypatch):
    """A folder with the studies, to which commands and paths refer."""
    go_to_studies(made_once, tmp_path, monkeypatch)
    return tmp_path


def told(value):
    """All that a value says, as text."""
    if isinstance(value, pd.DataFrame | pd.Series):
        return value.to_csv()
    if isinstance(value, np.ndarray):
        return str(value.tolist())
    html = value._repr_html_() if hasattr(value, "_repr_html_") else ""
    return f"{value!r} {html}"


def signed(calls, digits=6):
    """The signature of what each call returns, of the error that it raises instead, and of what it warns of."""
    found = {}
    for name, call in calls.items():
        with warnings.catch_warnings(record=True) as warned:
            warnings.simplefilter("always")
            try:
                text = told(call())
            except ParetoMonopedError as error:
                text = f"{type(error).__name__}: {error}"
        notes = [str(one.message) for one in warned if one.category is UserWarning]
        found[name] = of_text(f"{text}\n{notes}", digits)
    return found


def test_tables_and_shipped_data_are_as_they_were():
    own = pm.Study.define(
        name="own", motor=["U8", "VT8020"], evaluations=40, objectives=["mass_kg", "height_m"],
        constraints={"mass_kg": {"max": 4.0}}, variables={"rest_length_m": {"lower": 1.0, "upper": 3.0}},
    )  # fmt: skip
    calls = {
        "measures": lambda: list(pm.MEASURES),
        "variables": lambda: pm.VARIABLES[:],
        "cases": lambda: dict(pm.PAPER_CASES),
        "design": lambda: [C.as_dict(), A.as_array().tolist(), C.replace({"knee_ratio": 5.0})],
        "motor": lambda: pm.load_motor("mn8014"),
        "no motor": lambda: pm.load_motor("none"),
        "calibration": lambda: pm.load_calibration("stand"),
        "no calibration": lambda: pm.load_calibration("none"),
        "map": lambda: pm.actuator_map("U8"),
        "a gearbox": lambda: pm.actuator_map("VT8020").lookup(6.0),
        "robot": lambda: pm.build_robot(C),
        "parts": lambda: dict(pm.build_robot(A, **MOTORS, rules="paper").body_mass_properties()),
        "cost": lambda: pm.build_robot(A, **MOTORS).cost,
        "study": lambda: own,
        "study's keys": own.as_dict,
        "no study": lambda: pm.Study.define(name="own", evaluations=0),
        "table": lambda: pm.Study.define(name="own", objectives=["height_m"]),
    }
    compare(signed(calls), FOLDER / "tables.json")


def test_jumps_return_what_they_did():
    rows = pd.DataFrame([C.as_dict(), A.as_dict()])
    torques = {"kind": "torque_over_time", "knots": 3}
    profile = C.as_dict() | {f"{joint}_knot_{k}": -0.3 * k for joint in ("hip", "knee") for k in (1, 2, 3)}
    calls = {
        "several": lambda: pm.simulate(rows, landing=True),
        "two motors": lambda: pm.simulate([A, C], **MOTORS, workers=1),
        "calibration": lambda: pm.simulate(C, calibration="printed", motor="U8"),
        "rules": lambda: pm.simulate(A.as_array()[None, :7], rules="paper"),
        "profile": lambda: pm.simulate(profile, controller=torques),
        "cannot stand": lambda: pm.simulate(C.replace({"knee_ratio": 99.0})),
        "an array of another shape": lambda: pm.simulate(np.zeros((2, 3))),
        "other motors": lambda: pm.simulate(rows.assign(motor="U8")),
    }
    compare(signed(calls), FOLDER / "jumps.json")


def test_traces_return_what_they_did():
    calls = {
        "trace": lambda: pm.trace(C, calibration="stand").iloc[::50],
        "trace of two motors": lambda: pm.trace(A, **MOTORS).iloc[::50],
        "no trace": lambda: pm.trace(pd.DataFrame([C.as_dict(), A.as_dict()])),
    }
    compare(signed(calls), FOLDER / "traces.json")


def test_table_1_is_as_it_was():
    """To three digits: the calibration paper doubles the last digits of a jump."""
    compare(signed({"table 1": pm.table1}, digits=3), FOLDER / "table_1.json")


def test_stored_studies_return_what_they_did(here):
    other, signed_one, pair = (pm.load_study(f"{name}.db") for name in ("other", "signed", "pair"))
    front = other.front()
    calls = {
        "other": lambda: other,
        "signed": lambda: signed_one,
        "pair": lambda: pair,
        "trials": lambda: other.trials,
        "volumes": lambda: [one.hypervolume for one in (other, signed_one, pair)],
        "front": lambda: front,
        "front of others": lambda: other.front(["drift_m", "height_m"], include_ill_conditioned=True),
        "conditions": lambda: other.front(
            min_height_m=0.8, max_energy_j=90.0, at_least={"knee_ratio": 5.0}, at_most={"mass_kg": 4.4}
        ),
        "no front": lambda: pair.front(),
        "unknown": lambda: other.front(["height_m", "beauty"]),
        "knee": lambda: other.pick("knee"),
        "tradeoff": lambda: signed_one.pick("tradeoff", min_height_m=0.8),
        "weights": lambda: other.pick(weights=[1.0, 2.0, 3.0], at_most={"mass_kg": 5.0}),
        "compromise": lambda: other.pick(compromise=[1, 0, 2], at_least={"height_m": 0.8}),
        "nearest": lambda: signed_one.pick(nearest={"height_m": 0.8, "energy_j": 30.0}),
        "least": lambda: other.pick(least="shank_length_m", objectives=["height_m", "electrical_energy_j"]),
        "most": lambda: signed_one.pick(most="height_m", max_energy_j=60.0).row,
        "trial": lambda: other.pick(trial=3),
        "two ways": lambda: other.pick("knee", least="mass_kg"),
        "no way": lambda: other.pick(),
        "none fits": lambda: other.pick(min_height_m=3.0),
        "design": lambda: other.design(15),
        "no design": lambda: other.design(90),
        "motors": lambda: [other.motors(trial) for trial in (0, 1, 3)] + [pair.motors(trial) for trial in range(4)],
        "alternatives": lambda: other.alternatives(15, count=3, tolerance=0.4),
        "again": lambda: other.simulate([other.pick("knee"), other.pick(most="height_m")]),
        "with a trial's motors": lambda: other.simulate(C, trial=51),
        "other motors": lambda: other.simulate(front.assign(motor="U10")),
        "status": lambda: {key: one for key, one in pm.status("other.db").items() if key not in TIMES},
        "verify": lambda: pm.verify(other, simulate=3, workers=1),
        "another": lambda: pm.verify("other.db", expect="0" * 16),
    }
    compare(signed(calls), FOLDER / "studies.json")


TIMES = {"wall_time_s", "evaluations_per_second"}
STANDING = ["study", "database", "state", "evaluations", "budget", "hypervolume", "hypervolume_unit", "front", "reason"]


def test_what_built_robots_do_is_as_it_was(here):
    one = {"workers": 1}
    calls = {
        "robust": lambda: pm.robust("other.db", [51, 4], seed=3, **one),
        "of the front": lambda: pm.robust("signed.db", uncertainty="mine.toml", samples=32, **one).iloc[:3],
        "robust pick": lambda: pm.load_study("signed.db").pick("knee", robust=True),
        "sensitivity": lambda: pm.sensitivity("other.db", 15, samples=32, within=0.05, seed=3, **one),
        "limit of a trial": lambda: pm.limit("signed.db", 80, jumps=20, **one),
        "no samples": lambda: pm.robust("other.db", 4, samples=33),
        "none jumped": lambda: pm.robust("other.db", 900),
    }
    compare(signed(calls), FOLDER / "as_built.json")


def test_a_limit_has_each_number_in_its_column(monkeypatch, here):
    """Few jumps find one that is both the highest and of the least energy."""
    monkeypatch.setattr("pareto_monoped.analysis.limit.limits", lambda *_, **__: [numbered_limit()[0]])
    compare(signed({"limit": lambda: pm.limit("signed.db", 80)}), FOLDER / "limit.json")


def test_runs_return_what_they_did(here):
    def heard(**changes):
        seen = []
        made = pm.run("small.toml", f"{len(changes)}.db", callback=lambda now: seen.append(now.evaluations), **changes)
        return f"{seen} {made!r} {made.study.as_dict()} {told(made.front())}"

    problem = pm.MonopedProblem(pm.Study.from_toml("small.toml"))
    calls = {
        "run": lambda: heard(seed=3),
        "other goals": lambda: heard(objectives=["height_m", "drift_m"], evaluations=14),
        "limits": lambda: heard(constraints={"mass_kg": {"max": 1.0}}, seed=4, workers=1),
        "calibration": lambda: heard(
            calibration="printed", algorithm={"name": "nsga2", "population": 4}, seed=2, evaluations=8
        ),
        "resume": lambda: pm.resume("1.db", evaluations=15, workers=1),
        "fewer": lambda: pm.resume("1.db", evaluations=2),
        "campaign": lambda: pm.run_campaign("grid.toml", folder="studies", csv="table.csv", workers=1)[STANDING],
        "its status": lambda: pm.run_campaign("grid.toml", folder="none", status=True),
        "pymoo": lambda: problem.evaluate(np.linspace(problem.xl, problem.xu, 4)[1:3]),
    }
    compare(signed(calls), FOLDER / "runs.json")


def by_plotly(figure):
    """What a figure shows, as text."""
    series = [
        (one.name, one.mode, one.opacity, one.line.color, one.marker.size, one.hovertemplate, one.showlegend)
        for one in figure.data
    ]
    columns = [
        [
            None if one is None else np.asarray(one).tolist()
            for one in (each.x, each.y, each.customdata, each.marker.color)
        ]
        for each in figure.data
    ]
    layout = [axis.title.text for axis in figure.select_xaxes()]
    layout += [axis.title.text for axis in figure.select_yaxes()]
    bars = [one.marker.colorbar.title.text for one in figure.data]
    return f"{series} {columns} {layout} {bars} {figure.layout.height}"


def by_matplotlib(figure):
    """The same of the other library."""
    shown = []
    for axes in figure.axes:
        shown += [axes.get_xlabel(), axes.get_ylabel()]
        for line in axes.lines:
            style = (line.get_label(), line.get_marker(), line.get_linestyle(), line.get_color(), line.get_alpha())
            shown += [*style, np.asarray(line.get_xydata()).tolist()]
        shown += [np.asarray(dots.get_offsets()).tolist() for dots in axes.collections]
        shown += [text.get_text() for text in axes.get_legend().get_texts()] if axes.get_legend() else []
    return str(shown)


def test_figures_show_what_they_did(here):
    other, signed_one, pair = (pm.load_study(f"{name}.db") for name in ("other", "signed", "pair"))
    steps = pm.trace(A, **MOTORS).iloc[::20]
    maps = [pm.actuator_map(name) for name in ("VT8020", "U8")]
    figures = {
        "front of three": lambda **by: pm.plot_front(other, **by),
        "two studies": lambda **by: pm.plot_front([signed_one, other], x="mass_kg", color="knee_ratio", **by),
        "without trials": lambda **by: pm.plot_front(signed_one, y="drift_m", trials=False, **by),
        "motors of joints": lambda **by: pm.plot_front(pair, color="hip_ratio", **by),
        "gearboxes": lambda **by: pm.plot_actuators(*maps, **by),
        "jump": lambda **by: pm.plot_jump(steps, **by),
    }
    calls = {}
    for name, draw in figures.items():
        calls[f"{name} by plotly"] = lambda draw=draw: by_plotly(draw())
        calls[f"{name} by matplotlib"] = lambda draw=draw: by_matplotlib(draw(backend="matplotlib"))
    calls["by another"] = lambda: pm.plot_jump(steps, backend="gnuplot")
    calls["of none"] = lambda: pm.plot_front([])
    compare(signed(calls), FOLDER / "figures.json")


def test_films_and_exports_are_of_what_was_asked_for(tmp_path, monkeypatch):
    def drawn(robot, steps, *, slower):
        asked.append(f"{robot!r} {slower} {[column[::50].tolist() for column in steps.values()]}")
        return [np.zeros((480, 720, 3), np.uint8)]

    def filmed(name, design, **given):
        pm.film(design, tmp_path / name, **given)
        return asked.pop()

    asked = []
    monkeypatch.setattr(films, "film", drawn)
    record = {
        "mass_kg": 4.768,
        "files": ["a.step", "design.json"],
        "jumps": {"as_built": {"height_m": 1.0, "energy_j": 9.0}},
    }
    calls = {
        "film": lambda: filmed("a.gif", A, **MOTORS, slower=2.5),
        "of a calibration": lambda: filmed("c.gif", C, calibration="paper", motor="U8"),
        "too fast": lambda: filmed("d.gif", C, slower=0.5),
        "of another kind": lambda: filmed("d.avi", C),
        "export": lambda: pm.Export("folder", record),
        "its files": lambda: pm.Export("folder", record).files,
    }
    compare(signed(calls), FOLDER / "films.json")

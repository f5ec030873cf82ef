"""Every argument of every public function, given values of a dozen wrong types: the answer is an error of ours."""

import inspect
import shutil

import numpy as np
import pandas as pd
import pytest

import pareto_monoped as pm
from pareto_monoped.errors import ParetoMonopedError

WRONG = {
    "object": object(),
    "complex": 3j,
    "bytes": b"x",
    "none": None,
    "nan": float("nan"),
    "negative": -1,
    "words": "no such thing",
    "surrogate": "\udcff",
    "zero byte": "a\0b",
    "list": [object()],
    "table": {3j: 3j},
    "array": np.array([1.5, np.nan]),
    "frame": pd.DataFrame({"a": ["b"]}),
    "function": lambda: None,
    "class": dict,
}
RIGHT = {
    ("export", "folder", "words"),
    ("export_trial", "folder", "words"),
    ("limit", "jumps", "none"),
    ("run", "callback", "function"),
    ("run", "callback", "class"),
}
"""What is taken: what would take long (an export in a new folder, as many jumps as by default), and what can be called,
whose errors are its own."""
SLOW = {"export_trial", "limit", "sensitivity", "write_report"}
HEAVY = {"export", "export_trial", "film"}
"""Their target is a folder with something else in it, so that no value makes them export."""


@pytest.fixture(scope="module")
def made(few_samples, tmp_path_factory):
    """Arguments that each function takes, and the folder of what they name."""
    folder = tmp_path_factory.mktemp("right")
    tiny = {"name": "tiny", "evaluations": 4, "algorithm": "random", "audit": False}
    study, design = pm.Study.define(**tiny), pm.PAPER_CASES["C"].design
    pm.run(study, folder / "tiny.db")
    for trials in (0, None):
        pm.robust(folder / "tiny.db", trials)  # by default: what is stored is not simulated again
    (folder / "full").mkdir()
    (folder / "full" / "other.txt").touch()
    (folder / "grid.toml").write_text(
        'name = "grid"\n[study]\nevaluations = 4\nalgorithm = "random"\n[axes]\nseeds = [1, 2]\n', encoding="utf-8"
    )
    stored = pm.load_study(folder / "tiny.db")
    right = {
        "actuator_map": {},
        "build_robot": {"design": design},
        "export": {"design": design, "folder": "full"},
        "export_trial": {"study": "tiny.db", "trial": 0, "folder": "full"},
        "film": {"design": design, "out": "full"},
        "limit": {"study": "tiny.db", "trials": 0, "jumps": 20},
        "load_calibration": {"name_or_path": "reference"},
        "load_motor": {"name_or_path": "U8"},
        "load_study": {"path": "tiny.db"},
        "plot_actuators": {"maps": [pm.actuator_map()]},
        "plot_front": {"studies": stored, "backend": "matplotlib"},
        "plot_jump": {"trace": pm.trace(design), "backend": "matplotlib"},
        "resume": {"db": "tiny.db"},
        "robust": {"study": "tiny.db", "trials": 0, "samples": 2},
        "run": {"study": study, "db": "new.db"},
        "run_campaign": {"file": folder / "grid.toml", "status": True},
        "sensitivity": {"study": "tiny.db", "trial": 0, "samples": 2},
        "simulate": {"designs": design},
        "status": {"study": "tiny.db"},
        "table1": {},
        "trace": {"design": design},
        "verify": {"study": "tiny.db"},
        "write_report": {"studies": "tiny.db", "out": "report.html"},
        "Study.define": tiny,
        "StoredStudy.pick": {"by": "knee"},
    }
    return right, folder, stored


def test_every_public_function_is_tried(made):
    functions = {name for name in pm.__all__ if inspect.isfunction(getattr(pm, name))}
    assert functions == {name for name in made[0] if "." not in name}


@pytest.mark.parametrize(
    "name",
    [
        # Their right values take long.
        pytest.param(name, marks=pytest.mark.long if name in SLOW else ())
        for name in (
            *(name for name in pm.__all__ if inspect.isfunction(getattr(pm, name))),
            *("Study.define", "StoredStudy.pick"),
        )
    ],
)
def test_a_value_of_a_wrong_type_is_refused_in_our_words(name, made, tmp_path, monkeypatch):
    right, folder, stored = made
    given = right[name]
    home, _, method = name.rpartition(".")
    function = getattr(stored if home == "StoredStudy" else getattr(pm, home) if home else pm, method)
    parameters = inspect.signature(function).parameters.values()
    names = [one.name for one in parameters if one.kind not in (one.VAR_KEYWORD, one.VAR_POSITIONAL)]
    if name == "Study.define":
        names += ["motor", "seed", "variables", "constraints", "settings", "objectives", "calibration"]
    findings = []
    monkeypatch.chdir(tmp_path)
    shutil.copytree(folder / "full", "full")
    for argument in names:
        for kind, value in WRONG.items():
            if (name, argument, kind) in RIGHT:
                continue
            shutil.copy(folder / "tiny.db", "tiny.db")
            (tmp_path / "new.db").unlink(missing_ok=True)
            try:
                words = given | {argument: value}
                function(*words.pop("maps", ()), **words)
            except ParetoMonopedError as error:
                if "\n" in str(error):
                    findings.append(f"{argument} = {kind}: several lines: {error}")
            except Exception as error:
                findings.append(f"{argument} = {kind}: {type(error).__name__}: {error}")
            else:
                if name in HEAVY:
                    findings.append(f"{argument} = {kind}: exported")
    assert findings == []


@pytest.mark.parametrize("kind", WRONG)
def test_what_is_no_map_is_refused_in_our_words(kind):
    with pytest.raises(ParetoMonopedError):
        pm.plot_actuators(WRONG[kind])

"""Studies that are run from scripts: the trials of the command line, other goals, and a callback that stops."""

import json

import numpy as np
import pandas as pd
import pytest

import pareto_monoped as pm
from pareto_monoped.cli import _run as cli

FILE = 'name = "small"\nevaluations = 80\nseed = 5\naudit = false\n[algorithm]\nname = "nsga2"\npopulation = 20\n'


@pytest.fixture
def file(tmp_path):
    path = tmp_path / "small.toml"
    path.write_text(FILE)
    return path


def trials(path):
    return pm.load_study(path).trials


def same(one, other):
    pd.testing.assert_frame_equal(trials(one), trials(other), check_exact=True)


def test_a_run_makes_the_trials_of_the_command_line(file, tmp_path):
    stored = pm.run(str(file))
    assert stored.path == file.with_suffix(".db")
    assert cli(["run", str(file), "--db", str(tmp_path / "other.db")]) == 0
    same(stored.path, tmp_path / "other.db")


def test_a_study_from_python_is_that_of_its_file(file):
    algorithm = {"name": "nsga2", "population": 20}
    study = pm.Study.define(name="small", evaluations=80, seed=5, audit=False, algorithm=algorithm)
    assert study == pm.Study.from_toml(file) == pm.Study.from_toml(str(file), seed=5)
    assert pm.Study.from_toml(file, algorithm="random").algorithm.name == "random"


def test_an_opened_run_is_that_of_the_command_line_and_goes_on_without_the_option(file, tmp_path):
    """Named there as in Python; a study of Python's own is opened as its file is."""
    line = ["run", str(file), "--opened", "--db", str(tmp_path / "line.db"), "--evaluations"]
    assert cli([*line, "40"]) == 0
    assert cli(["resume", str(tmp_path / "line.db"), "--evaluations", "60"]) == 0
    assert cli([*line, "80"]) == 0
    for name, study in (("file", file), ("own", pm.Study.from_toml(file))):
        stored = pm.run(study, tmp_path / f"{name}.db", opened=True)
        assert len(stored.trials) == 80
        assert stored.trials["rest_length_m"].nunique() > 1
        same(stored.path, tmp_path / "line.db")


def test_a_callback_that_returns_true_stops_the_run_and_resume_ends_it(file, tmp_path):
    seen = []

    def first_two(progress):
        seen.append(progress.evaluations)
        return len(seen) == 2

    stopped = pm.run(file, tmp_path / "stopped.db", callback=first_two)
    assert seen[:2] == [20, 40]
    assert len(stopped.trials) < 80
    assert not stopped.finished
    assert pm.resume(stopped.path, callback=seen.append).finished
    pm.run(file)
    same(stopped.path, file.with_suffix(".db"))


@pytest.mark.parametrize("yes", [True, np.True_, np.float64(3.0) > 2.0])
def test_a_callback_that_returns_the_true_of_numpy_stops_the_run_after_the_generation_under_way(yes, file, tmp_path):
    seen = []

    def second(progress):
        seen.append(progress.evaluations)
        return yes if len(seen) == 2 else None

    stopped = pm.run(file, tmp_path / "stopped.db", callback=second)
    assert seen == [20, 40, 60]
    assert (len(stopped.trials), stopped.finished) == (60, False)


@pytest.mark.parametrize("other", [1, "yes", np.array([True, False]), pd.DataFrame(), np.False_])
def test_a_callback_that_returns_something_else_does_not_stop_the_run(other, file):
    assert pm.run(file, callback=lambda _: other).finished


def test_goals_of_a_call_replace_those_of_the_study(file, tmp_path):
    stored = pm.run(
        file,
        tmp_path / "goals.db",
        algorithm="random",
        objectives=["height_m", "electrical_energy_j"],
        constraints={"mass_kg": {"max": 5.0}, "min_height_m": 0.6},
        evaluations=60,
        seed=9,
    )
    study = stored.study
    assert (study.algorithm.name, study.seed, len(stored.trials)) == ("random", 9, 60)
    assert study.objectives.names == ("height_m", "electrical_energy_j")
    limits = study.constraints.as_dict()
    assert (limits["max_mass_kg"], limits["min_height_m"], limits["min_gear_safety"]) == (5.0, 0.6, 1.0)
    feasible = stored.trials[stored.trials["state"] == "feasible"]
    assert (feasible["mass_kg"] <= 5.0).all()
    assert (feasible["height_m"] >= 0.6).all()


@pytest.mark.parametrize("limits", [{}, {"most": 5.0}, {"max": 5.0, "at_most": 4.0}])
def test_limits_without_a_bound_or_of_another_name_are_refused(file, limits):
    with pytest.raises(pm.StudyError, match=r"limits of mass_kg = .*'min', 'max' or both"):
        pm.run(file, constraints={"mass_kg": limits})


def test_a_database_with_other_goals_is_refused(file):
    pm.run(file, evaluations=40)
    with pytest.raises(pm.ParetoMonopedError, match="began with other settings"):
        pm.run(file, constraints={"mass_kg": {"max": 5.0}})


SMALL = {"name": "s", "algorithm": "random", "audit": False, "strength": False}


def test_a_study_without_a_feasible_design_warns_with_the_note_of_the_command_line(tmp_path, capsys):
    study = pm.Study.define(**SMALL, evaluations=40, constraints={"mass_kg": {"max": 0.5}})
    with pytest.warns(UserWarning, match=r"of \d+ miss mass_kg <= 0.5; the least is 4\.\d+ kg$") as caught:
        stored = pm.run(study, tmp_path / "s.db")
    assert caught[0].filename == __file__
    assert cli(["resume", str(stored.path)]) == 0
    _, _, note = str(caught[0].message).partition(".db: ")
    assert f"note: {note}\n" in capsys.readouterr().err
    with pytest.warns(UserWarning, match="no design is feasible") as again:
        pm.resume(stored.path, evaluations=50)
    assert (len(again), again[0].filename) == (1, __file__)


def test_fewer_trials_than_are_stored_are_refused(tmp_path):
    study = pm.Study.define(**SMALL, evaluations=60)
    stored = pm.run(study, tmp_path / "s.db")
    before = stored.path.read_bytes()
    for call in (lambda: pm.resume(stored.path, evaluations=40), lambda: pm.run(study, stored.path, evaluations=40)):
        with pytest.raises(pm.ParetoMonopedError, match=r"evaluations: 60 -> 40 \(only more is allowed\)"):
            call()
    assert stored.path.read_bytes() == before
    assert len(pm.resume(stored.path, evaluations=60).trials) == 60


def test_one_function_alone_is_a_list_of_one(tmp_path):
    def light(jumps):
        return jumps["mass_kg"] - 5.0

    study = pm.Study.define(**SMALL, evaluations=40)
    one = pm.run(study, tmp_path / "one.db", constraints=light, evaluations=30)
    pm.run(study, tmp_path / "list.db", constraints=[light])
    pm.resume(one.path, evaluations=40, functions=light)
    same(one.path, tmp_path / "list.db")
    assert one.study.own_names == ("own_light",)


def test_messages_show_no_address(tmp_path):
    study = pm.Study.define(**SMALL, evaluations=40)
    with pytest.raises(pm.ParetoMonopedError, match=r"^objectives = <function \S*<lambda>>: must be a list"):
        pm.run(study, tmp_path / "s.db", objectives=lambda jumps: jumps["mass_kg"])


def test_a_bar_is_shown_where_it_is_wanted(file, tmp_path, capsys):
    pm.run(file, tmp_path / "silent.db", evaluations=40)
    assert capsys.readouterr().err == ""
    seen = []
    pm.run(file, tmp_path / "shown.db", evaluations=40, progress=True, callback=seen.append)
    assert "40/40" in capsys.readouterr().err
    assert [one.evaluations for one in seen] == [20, 40]
    same(tmp_path / "silent.db", tmp_path / "shown.db")


def test_a_callback_stops_a_run_with_a_bar_too(file, tmp_path):
    assert not pm.run(file, tmp_path / "s.db", progress=True, callback=lambda _: True).finished


_NOTEBOOK = """
import pareto_monoped as pm
pm.run(pm.Study.define(name="n", evaluations=40, algorithm="random", audit=False), "n.db")
"""


@pytest.mark.long
def test_a_notebook_shows_a_bar_by_itself(tmp_path):
    nbformat, nbclient = pytest.importorskip("nbformat"), pytest.importorskip("nbclient")
    book = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(_NOTEBOOK)])
    done = nbclient.NotebookClient(book, resources={"metadata": {"path": str(tmp_path)}}).execute()
    shown = [one.data.get("text/html", "") for one in done.cells[0].outputs if "data" in one]
    assert any("<progress value='40' max='40'>" in html for html in shown)
    assert any("<b>study n</b>" in html for html in shown)


def test_a_second_seed_is_that_of_the_command_line(file, tmp_path, capsys):
    stored = pm.run(file, tmp_path / "own.db", second_seed=True)
    assert stored.study.seed + 1 == pm.load_study(tmp_path / f"own_seed_{stored.study.seed + 1}.db").study.seed
    assert cli(["run", str(file), "--second-seed", "--json"]) == 0
    told = json.loads(capsys.readouterr().out.splitlines()[-1])
    assert (list(stored.second.alone), stored.second.text()) == (told["alone"], told["text"])
    assert pm.load_study(stored.path).second is None


class Anywhere:
    """Designs from all over the space."""

    def __init__(self, space, seed):
        self.space, self.generator = space, np.random.default_rng(seed)

    def ask(self):
        return self.generator.uniform(self.space.lower, self.space.upper, (10, len(self.space.lower)))

    def tell(self, scores):
        pass


def test_an_own_algorithm_is_made_anew_for_a_second_seed(tmp_path):
    study = pm.Study.define(name="own", evaluations=20, audit=False, strength=False)
    stored = pm.run(study, tmp_path / "own.db", algorithm=Anywhere, second_seed=7)
    assert not np.isin(pm.load_study(tmp_path / "own_seed_7.db").trials.energy_j, stored.trials.energy_j).all()
    assert stored.second is not None
    made = Anywhere(None, 1)
    with pytest.raises(pm.StudyError, match=r"algorithm = .*: must be a class or function that makes one"):
        pm.run(study, tmp_path / "new.db", algorithm=made, second_seed=7)
    with pytest.raises(pm.InputError, match="second_seed = 'next': must be a whole number"):
        pm.run(study, tmp_path / "new.db", second_seed="next")
    assert not (tmp_path / "new.db").exists()


def test_a_run_that_its_callback_stops_is_not_searched_again(file, tmp_path):
    stored = pm.run(file, tmp_path / "own.db", second_seed=7, callback=lambda _: True)
    assert (stored.finished, stored.second) == (False, None)
    assert not (tmp_path / "own_seed_7.db").exists()

"""``init``, and ``pareto`` in an empty folder."""

import tomllib
from pathlib import Path

import pytest

from pareto_monoped.cli import _run as cli
from pareto_monoped.definition import study_file
from pareto_monoped.definition.study import load_study

STUDIES = Path(__file__).parents[2] / "studies"


@pytest.mark.parametrize("name", [path.stem for path in sorted(STUDIES.glob("*.toml"))])
def test_every_shipped_study_can_be_had_and_read(name, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert cli(["init", name]) == 0
    assert (tmp_path / f"{name}.toml").read_text() == (STUDIES / f"{name}.toml").read_text()
    assert load_study(tmp_path / f"{name}.toml").name
    assert f"pareto-monoped run {name}.toml" in capsys.readouterr().err


def test_both_libraries_and_the_papers_search_have_a_study():
    shipped = {load_study(path).algorithm.name for path in STUDIES.glob("*.toml")}
    assert {"surrogate", "nsga2", "optuna_tpe", "weighted_cmaes"} <= shipped


def test_without_a_name_it_is_case_c_and_changes_of_the_user_stay(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert cli(["init"]) == 0
    (tmp_path / "case_c.toml").write_text("mine")
    assert cli(["init"]) == 2
    said = capsys.readouterr().err.splitlines()
    assert "'case_c.toml': exists" in said[-1]
    assert (tmp_path / "case_c.toml").read_text() == "mine"
    assert cli(["init", "-o", "other.toml"]) == 0
    assert cli(["init", "--force"]) == 0
    assert tomllib.loads((tmp_path / "case_c.toml").read_text())["case"] == "C"


def test_the_list_fits_a_terminal(capsys):
    assert cli(["init", "--list"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert max(map(len, lines)) <= 80
    assert {path.stem for path in STUDIES.glob("*.toml")} <= {line.split()[0] for line in lines if line[0] != " "}


def test_an_unknown_study_is_refused_with_the_names_of_all(capsys):
    assert cli(["init", "case_d"]) == 2
    said = capsys.readouterr().err
    assert "one of any_motor, case_a, case_b, case_c" in said
    assert len(said.splitlines()) == 1


def test_a_wheel_has_the_studies_among_its_data(tmp_path, monkeypatch):
    """As ``setup.py`` puts them there; without them, and without a checkout, there are none and no traceback."""
    data = tmp_path / "data" / "studies"
    data.mkdir(parents=True)
    (data / "only.toml").write_text('name = "only"\nevaluations = 10\n')
    monkeypatch.setattr(study_file.resources, "files", lambda _: tmp_path)
    assert list(study_file.shipped_studies()) == ["only"]
    assert study_file.shipped_study("only").startswith("name")


def test_pareto_in_an_empty_folder_begins_with_case_c(tmp_path, monkeypatch, capsys):
    """It needed a checkout. Only the beginning is tried here: a budget that is refused ends it."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "case_c.txt").write_text("")
    assert cli(["pareto", "-o", "case_c.txt/reports"]) == 2
    assert (tmp_path / "studies" / "case_c.toml").read_text() == (STUDIES / "case_c.toml").read_text()
    assert "wrote studies/case_c.toml" in capsys.readouterr().err


def test_who_runs_a_shipped_study_by_its_name_is_told_to_copy_it(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    for name in ("quick", "quick.toml"):
        assert cli(["run", name]) == 2
        said = capsys.readouterr().err
        assert said == (
            f"error: study file {name!r}: no such file; 'pareto-monoped init quick' copies the one that comes with the "
            "package\n"
        )
    assert cli(["run", "quickest.toml"]) == 2
    assert "no such file; check the path" in capsys.readouterr().err

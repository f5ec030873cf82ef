"""The main job on a small budget, from the actuator map to the CAD, and again."""

import contextlib
import csv
import io
import os
import re
import shutil
import signal
import subprocess
import sys
from contextlib import redirect_stderr, redirect_stdout, suppress
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from pareto_monoped.actuator.search import map_for
from pareto_monoped.analysis import choices
from pareto_monoped.analysis.choices import HEIGHTS_M, default_pick, two_fronts
from pareto_monoped.cli import _run as cli
from pareto_monoped.cli.pareto import _Ahead, _code_of, _newer, _search, _searches, _Steps
from pareto_monoped.definition.algorithms import WeightedSettings
from pareto_monoped.definition.study import load_study
from pareto_monoped.definition.variables import OPENED
from pareto_monoped.design import PAPER_CASES
from pareto_monoped.errors import DatabaseError, StudyError
from pareto_monoped.jump.calibration import load_calibration
from pareto_monoped.jump.gravity import standing_height_m
from pareto_monoped.pareto.pick import pick
from pareto_monoped.pareto.selectors import Knee
from pareto_monoped.report.exports import read_models
from pareto_monoped.robot.population import robot_arrays
from pareto_monoped.storage.reader import read_study
from tests.compute.dask_here import until

ROOT = Path(__file__).parents[2]
WORDS = [sys.executable, "-m", "pareto_monoped", "pareto", "studies/quick.toml", "--evaluations", "100"]


def pareto(folder: Path) -> subprocess.CompletedProcess:
    """The main job in this process, whose kernel has made most parts before; of CAD it makes what is looked at."""
    out, err = io.StringIO(), io.StringIO()
    with pytest.MonkeyPatch.context() as patch, redirect_stdout(out), redirect_stderr(err):
        patch.chdir(folder)
        patch.setenv("COLUMNS", "80")
        patch.setattr("pareto_monoped.cad.write.folder.FORMATS", ("step", "glb"))
        code = cli(WORDS[3:])
    return subprocess.CompletedProcess(WORDS, code, out.getvalue(), err.getvalue())


@pytest.fixture(scope="module")
def job(tmp_path_factory, unchecked_module):
    """The folder in which the main job ran, and what it printed."""
    folder = tmp_path_factory.mktemp("job")
    (folder / "studies").mkdir()
    shutil.copy(ROOT / "studies" / "quick.toml", folder / "studies")
    done = pareto(folder)
    assert done.returncode == 0, done.stderr
    return folder, done


@pytest.mark.cad
class TestMainJob:
    def test_it_names_the_files_and_they_exist(self, job):
        folder, done = job
        named = [line.split()[0] for line in done.stdout.split("Made\n")[1].splitlines()[:6]]
        assert named[3] == "studies/quick_opened.db"
        for name in named:
            assert (folder / name).exists(), name
        assert not list(folder.rglob("*.tmp"))

    def test_it_ends_with_the_paper_beside_the_front(self, job):
        _, done = job
        assert "as published" in done.stdout
        assert "0.800" in done.stdout
        assert "15.36" in done.stdout
        (case,) = (line.split()[-4:] for line in done.stdout.splitlines() if "simulated here" in line)
        height, _, stands, rise = map(float, case)
        robot = robot_arrays(PAPER_CASES["C"].design.as_array(), map_for("VT8020"))
        assert stands == pytest.approx(standing_height_m(robot, load_calibration())[0], abs=6e-4)
        assert 0.2 < rise < height - 0.7
        assert all(len(line) <= 80 for line in done.stdout.splitlines())
        assert "Traceback" not in done.stderr

    def test_the_second_front_is_the_same_study_by_the_energy_at_the_battery(self, job):
        folder, _ = job
        first, second = (read_study(folder / "studies" / f"quick{word}.db") for word in ("", "_battery"))
        assert second.study.objectives.names == ("height_m", "electrical_energy_j")
        assert two_fronts([first, second]) is not None
        assert len(second.trials) == 100

    def test_the_third_front_is_the_first_study_with_more_variables_free_on_half_the_jumps(self, job):
        folder, _ = job
        first, third = (read_study(folder / "studies" / f"quick{word}.db") for word in ("", "_opened"))
        assert set(third.study.free) - set(first.study.free) == {"knee_release_rad", "rest_length_m"}
        assert (third.trials["start_height_m"] == 0.5).all()
        assert third.study.objectives == first.study.objectives
        assert third.study.seed == first.study.seed
        assert len(third.trials) == 50

    def test_the_last_table_is_what_opening_saves_and_what_it_takes_from_the_battery(self, job):
        folder, done = job
        fronts = [read_study(folder / "studies" / f"quick{word}.db").front() for word in ("", "_opened")]
        table = done.stdout.split("more free     saved")[1].splitlines()[2 : 2 + len(HEIGHTS_M)]
        for height, line in zip(HEIGHTS_M, table, strict=True):
            able = [rows[rows["height_m"] >= height] for rows in fronts]
            best = [rows.loc[rows["energy_j"].idxmin()] if len(rows) else None for rows in able]
            sides = [
                ["not reached" if row is None else f"{row[name]:.2f}" for row in best]
                for name in ("energy_j", "electrical_energy_j")
            ]
            least = [np.nan if row is None else float(row["energy_j"]) for row in best]
            share = "-" if np.isnan(sum(least)) else f"{100 * (least[0] - least[1]) / least[0]:.1f} %"
            assert line.split() == f"{height:.1f} m {' '.join(sides[0])} {share} {' '.join(sides[1])}".split()
        said = " ".join(done.stdout.split())
        assert "knee_release_rad 0 to 1, rest_length_m 1 to 20; start_height_m stays 0.5; 50 jumps." in said

    def test_the_design_is_dear_or_not_beside_the_designs_of_both_studies(self, job, monkeypatch):
        folder, _ = job
        beside = []

        def picked(data, studies):
            beside.append([one.study.objectives.names[1] for one in studies])
            return default_pick(data, studies)

        monkeypatch.setattr(choices, "default_pick", picked)
        assert pareto(folder).returncode == 0
        assert beside
        assert all(names == ["energy_j", "electrical_energy_j", "energy_j"] for names in beside)

    def test_the_closing_table_is_what_both_fronts_offer(self, job):
        folder, done = job
        first, second = (read_study(folder / "studies" / f"quick{word}.db") for word in ("", "_battery"))
        lines = [line.split() for line in done.stdout.splitlines()]
        rows = [line[2:] for line in lines if len(line) > 2 and line[1] == "m" and line[0][:2] in ("0.", "1.")]
        rows = rows[: len(HEIGHTS_M)]  # the table of what the third front saves follows
        assert len(rows) == len(HEIGHTS_M)
        for height, cells in zip(HEIGHTS_M, rows, strict=True):
            fronts = ((first, "energy_j"), (second, "electrical_energy_j"))
            expected, battery = [], []
            for data, energy in fronts:
                front = data.front()
                able = front[front["height_m"] >= height]
                if len(able) == 0:
                    expected += ["not", "reached"]
                    continue
                best = able.loc[able[energy].idxmin()]
                battery.append(best["electrical_energy_j"])
                gears = [data.case_kit.of(side).lookup(best[f"{side}_ratio"]).ratio for side in ("hip", "knee")]
                expected += [f"{best[name]:.2f}" for name in ("energy_j", "electrical_energy_j")]
                expected += [f"{ratio:.2f}" for ratio in gears]
            expected += [f"{100 * (battery[0] / battery[1] - 1):+.1f}", "%"] if len(battery) == 2 else ["-"]
            assert cells == expected

    def test_the_report_shows_both_fronts_and_the_same_table(self, job):
        folder, done = job
        text = (folder / "reports" / "quick" / "report.html").read_text(encoding="utf-8")
        for words in (
            "quick by mechanical energy",
            "quick by battery energy",
            "quick with more variables free by mechanical energy",
            "The two energies",
        ):
            assert words in text
        table = text.split('id="energies"')[1].split("</table>")[0]
        shares = re.findall(r"[+-][0-9.]+ %", done.stdout.split("their battery energy")[0])
        assert shares
        assert re.findall(r"[+-][0-9.]+ %", table) == shares

    def test_the_page_made_beside_the_export_is_that_of_the_command_and_shows_the_exported_design(self, job, tmp_path):
        folder, _ = job
        made = folder / "reports" / "quick" / "report.html"
        dbs = [f"studies/quick{word}.db" for word in ("", "_battery", "_opened")]
        with contextlib.chdir(folder):
            assert cli(["report", *dbs, "-o", str(tmp_path / "r.html"), "--exports", "reports/quick/cad"]) == 0
        assert made.read_bytes() == (tmp_path / "r.html").read_bytes()
        (design,) = (folder / "reports" / "quick" / "cad").iterdir()
        (models,) = read_models(design.parent, [read_study(folder / "studies" / "quick.db")])
        assert [f"trial_{trial}" for trial in models] == [design.name]

    def test_the_map_is_complete(self, job):
        folder, _ = job
        with (folder / "reports" / "quick" / "actuators.csv").open() as stream:
            ratios = [float(row["ratio_low"]) for row in csv.DictReader(stream)]
        assert ratios[0] == 4.0
        assert ratios[-1] == 9.6

    def test_the_study_is_whole_and_the_exported_design_is_the_knee_that_is_not_dear_at_the_battery(self, job):
        """By hand: dear is what takes more than 1.5 times the least from the battery that reaches its height."""
        folder, _ = job
        data = read_study(folder / "studies" / "quick.db")
        assert len(data.trials) == 100
        front, trials = data.front(), data.sound
        least = [trials.loc[trials["height_m"] >= h, "electrical_energy_j"].min() for h in front["height_m"]]
        thrifty = front[front["electrical_energy_j"].to_numpy() <= 1.5 * np.array(least)]
        assert len(thrifty) > 0
        knee = pick(front, Knee()).trial
        if knee not in thrifty["trial"].to_numpy():
            knee = pick(thrifty, Knee()).trial
        assert [path.name for path in (folder / "reports" / "quick" / "cad").iterdir()] == [f"trial_{knee}"]

    def test_the_step_file_holds_every_part_of_the_parts_list(self, job):
        """By its text; tests/cad/write/test_files.py has another program count the solids of such a file."""
        folder, _ = job
        (design,) = (folder / "reports" / "quick" / "cad").iterdir()
        with (design / "bom.csv").open() as stream:
            count = sum(int(row["count"]) for row in csv.DictReader(stream))
        units = 7
        text = (design / "assembly.step").read_text(encoding="ascii")
        assert text.count("NEXT_ASSEMBLY_USAGE_OCCURRENCE(") == units + count

    def test_a_second_time_nothing_is_made_again(self, job):
        folder, first = job
        before = {path: path.stat().st_mtime_ns for path in (folder / "reports" / "quick").rglob("*.*")}
        again = pareto(folder)
        assert again.returncode == 0, again.stderr
        assert again.stderr.count("(up to date)") == 2
        assert again.stdout == first.stdout
        after = {path: path.stat().st_mtime_ns for path in before}
        changed = {path.name for path in before if before[path] != after[path]}
        counts = [len(read_study(folder / "studies" / f"quick_{word}.db").trials) for word in ("battery", "opened")]
        assert counts == [100, 50]
        assert changed <= {"actuators.csv"}

    @pytest.mark.long
    def test_a_stale_export_of_the_knee_is_begun_again(self, job):
        """And stopped there: it is left as it was."""
        folder, _ = job
        (design,) = (folder / "reports" / "quick" / "cad").iterdir()
        text = (design / "design.json").read_text()
        stale = text.replace('"kv_rpm_per_v": ', '"kv_rpm_per_v": 1')
        (design / "design.json").write_text(stale)
        with subprocess.Popen(WORDS, cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True) as again:
            step = next(line for line in again.stderr if line.startswith("[5/6]"))
            next(line for line in again.stderr if line.startswith("building"))
            again.send_signal(signal.SIGINT)
            assert "interrupted" in again.stderr.read()
        assert step.endswith(" --force\n")
        assert again.returncode == 130
        assert (design / "design.json").read_text() == stale
        (design / "design.json").write_text(text)

    @pytest.mark.long
    def test_a_stale_export_of_the_knee_is_made_again(self, job):
        folder, _ = job
        (design,) = (folder / "reports" / "quick" / "cad").iterdir()
        text = (design / "design.json").read_text()
        (design / "design.json").write_text(text.replace('"kv_rpm_per_v": ', '"kv_rpm_per_v": 1'))
        again = pareto(folder)
        assert again.returncode == 0, again.stderr
        (step,) = [line for line in again.stderr.splitlines() if line.startswith("[5/6]")]
        assert step.endswith(" --force")
        assert (design / "design.json").read_text() == text


@pytest.mark.long
def test_a_study_of_other_objectives_goes_from_one_front_to_its_cad(tmp_path):
    (tmp_path / "studies").mkdir()
    (tmp_path / "studies" / "quick.toml").write_text(
        'name = "quick"\nevaluations = 40\naudit = false\nobjectives = ["height_m", "mass_kg"]\n'
    )
    with subprocess.Popen(WORDS, cwd=tmp_path, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True) as job:
        assert any(line.startswith("[3/4] pareto-monoped export studies/quick.db") for line in job.stderr)
        job.send_signal(signal.SIGINT)
        job.stderr.read()
    assert [path.name for path in (tmp_path / "studies").glob("*.db")] == ["quick.db"]


@pytest.mark.long
def test_a_study_of_other_objectives_has_one_front(tmp_path):
    (tmp_path / "studies").mkdir()
    (tmp_path / "studies" / "quick.toml").write_text(
        'name = "quick"\nevaluations = 40\naudit = false\nobjectives = ["height_m", "mass_kg"]\n'
    )
    done = pareto(tmp_path)
    assert done.returncode == 0, done.stderr
    assert "[4/4]" in done.stderr
    assert [path.name for path in (tmp_path / "studies").glob("*.db")] == ["quick.db"]
    assert "note: one front only" in done.stderr
    assert "saved" not in done.stdout
    assert "costs" not in done.stdout
    assert max(len(line) for line in done.stdout.splitlines()) <= 80


def searched(study, **more):
    """The commands of the main job's searches by the names of their databases."""
    path = Path("studies/quick.toml")
    given = {"evaluations": None, "options": ["--workers=2", "--seed=7", "--no-strength"]} | more
    return {db.name: [str(word) for word in run] for db, run in _searches(path, study, Path("a/b.db"), **given).items()}


@pytest.mark.parametrize(
    ("evaluations", "changes", "jumps"),
    [
        (None, {"evaluations": 4000}, 2000),
        (100, {}, 50),
        (1, {}, 1),
        (100, {"algorithm": WeightedSettings(name="weighted_cmaes")}, 100),
    ],
)
def test_the_third_search_has_half_of_the_jumps_and_all_options(monkeypatch, evaluations, changes, jumps):
    """But for a sweep of weights, which would not come to its last ones."""
    monkeypatch.chdir(ROOT)
    study = replace(load_study(ROOT / "studies" / "quick.toml"), **changes)
    runs = searched(study, evaluations=evaluations)
    assert list(runs) == ["b.db", "b_battery.db", "b_opened.db"]
    limit = [f"--evaluations={evaluations}"] if evaluations else []
    options = ["--workers=2", "--seed=7", "--no-strength"]
    assert runs["b.db"] == ["run", "studies/quick.toml", "--db", "a/b.db", *limit, *options]
    words = ["run", "studies/quick.toml", "--opened", "--db", "a/b_opened.db", f"--evaluations={jumps}", *options]
    assert runs["b_opened.db"] == words


def test_a_study_that_leaves_nothing_to_open_has_two_fronts(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    Path("studies").mkdir()
    text = "\n".join(f"{name} = 8.0" for name in OPENED if name != "knee_release_rad")
    Path("studies/quick.toml").write_text(
        f'name = "quick"\nevaluations = 40\n[variables]\nknee_release_rad = 0\n{text}\n'
    )
    assert list(searched(load_study(Path("studies/quick.toml")))) == ["b.db", "b_battery.db"]
    said = " ".join(capsys.readouterr().err.split())
    assert said.startswith("note: no third front: study file 'studies/quick.toml': variables left to open = none")


def test_a_missing_study_is_one_line(tmp_path):
    done = pareto(tmp_path)
    assert done.returncode == 2
    assert len(done.stderr.strip().splitlines()) == 1
    assert "studies/quick.toml" in done.stderr


@pytest.mark.parametrize("code", [2, 130])
def test_the_job_ends_with_the_code_of_the_step_that_failed(tmp_path, monkeypatch, code):
    """Such as 130, with which a study ends that was interrupted and is stored."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("pareto_monoped.cli.pareto._code_of", lambda words: code)
    assert cli(["pareto", str(ROOT / "studies" / "quick.toml"), "-o", "out"]) == code


def stored(db):
    """How many trials a database has, which may not be made yet."""
    try:
        return len(read_study(db).trials)
    except DatabaseError:
        return 0


@pytest.mark.parametrize("side_by_side", [True, False])
def test_searches_run_side_by_side_and_come_to_their_ends_in_turn(monkeypatch, side_by_side):
    events = []

    class Begun(contextlib.nullcontext):
        def __init__(self, _, run):
            super().__init__(self)
            self.run = run
            events.append(f"begin {run[0]}")

        def result(self):
            events.append(f"end {self.run[0]}")

    monkeypatch.setattr("pareto_monoped.cli.pareto._Ahead", Begun)
    monkeypatch.setattr("pareto_monoped.cli.pareto._code_of", lambda words: events.append(f"do {words[0]}"))
    _search([("a",), ("b",), ("c",)], _Steps(total=3), side_by_side=side_by_side)
    ahead = ["begin b", "begin c", "do a", "end b", "end c"]
    assert events == (ahead if side_by_side else ["do a", "do b", "do c"])


class TestAhead:
    """A command that runs in a process of its own until its turn comes."""

    def test_its_messages_wait_for_its_turn(self, tmp_path, monkeypatch, capfd):
        monkeypatch.chdir(tmp_path)
        with _Ahead(_code_of, ["init", "quick"]) as ahead:
            until(lambda: ahead._heard.endswith("\n"))
            assert capfd.readouterr() == ("", "")
            assert not ahead.result()
        assert capfd.readouterr() == ("", "wrote quick.toml; run it with: pareto-monoped run quick.toml\n")
        assert (tmp_path / "quick.toml").exists()

    def test_its_error_is_that_of_the_command(self, tmp_path, monkeypatch):
        monkeypatch.chdir(tmp_path)
        with _Ahead(_code_of, ["run", "none.toml"]) as ahead, pytest.raises(StudyError, match=r"none\.toml"):
            ahead.result()

    @pytest.mark.long
    def test_a_study_cut_short_goes_on_where_it_stopped(self, tmp_path):
        """By the same trials as those of a study that nobody stopped."""
        run = ["run", str(ROOT / "studies" / "quick.toml"), "--evaluations", "400", "--workers", "1", "--db"]
        cut, whole = tmp_path / "cut.db", tmp_path / "whole.db"
        with suppress(KeyboardInterrupt), _Ahead(_code_of, [*run, str(cut)]):
            until(lambda: stored(cut) > 0)
            raise KeyboardInterrupt
        assert not read_study(cut).meta.finished
        assert 0 < len(read_study(cut).trials) < 400
        for path in (cut, whole):
            assert cli([*run, str(path)]) == 0
        names = [name for name in read_study(cut).trials if name != "generation"]
        pd.testing.assert_frame_equal(read_study(cut).trials[names], read_study(whole).trials[names])


def test_a_page_is_made_again_if_one_of_its_sources_is_younger(tmp_path):
    page, old, young = (tmp_path / name for name in ("page", "old", "young"))
    for path, seconds in ((old, 100), (page, 200), (young, 300)):
        path.touch()
        os.utime(path, (seconds, seconds))
    assert _newer(page, old)
    assert not _newer(page, old, young)
    assert not _newer(tmp_path / "none", old)

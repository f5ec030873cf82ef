"""The command ``campaign``: what it prints on a terminal, in a pipe and as JSON, its table and its exit codes."""

import csv
import io
import json
import os
import subprocess
import sys
from contextlib import redirect_stderr, redirect_stdout
from pathlib import Path

import pytest
from click.testing import CliRunner
from rich.console import Console

from pareto_monoped.campaign.coordinator import standings_of
from pareto_monoped.campaign.folder import places_of
from pareto_monoped.campaign.grid import load_campaign
from pareto_monoped.cli import _run as run
from pareto_monoped.cli import cli
from pareto_monoped.cli.campaign import _rows, clock, reports, shortened
from pareto_monoped.storage.reader import read_study
from tests.campaign.test_coordinator import SMALL
from tests.campaign.test_grid import written

ROOT = Path(__file__).parents[2]
AXES = 'motors = ["VT8020", "Nope.toml"]\nseeds = [1, 2]'


def command(folder, *words):
    """The command in this process; its studies run in one of their own."""
    out, err = io.StringIO(), io.StringIO()
    with pytest.MonkeyPatch.context() as patch, redirect_stdout(out), redirect_stderr(err):
        patch.chdir(folder)
        patch.setenv("COLUMNS", "80")
        code = run(["campaign", "grid.toml", *words])
    return subprocess.CompletedProcess(words, code, out.getvalue(), err.getvalue())


@pytest.fixture(scope="module")
def done(tmp_path_factory):
    """A campaign of two studies that can be run and two that cannot, and what it printed in a pipe."""
    folder = tmp_path_factory.mktemp("campaign")
    written(folder, AXES, SMALL.replace("evaluations = 40", "evaluations = 20\nstrength = false"))
    return folder, command(folder, "--workers", "1", "--csv", "table.csv", "--report", "page.html")


def test_a_failing_study_is_told_in_one_line_and_by_the_exit_code(done):
    folder, ran = done
    assert ran.returncode == 1
    lines = ran.stderr.splitlines()
    assert [line for line in lines if line.startswith("error: ")] == [
        f"error: Nope_seed{seed}: motor file '{folder}/Nope.toml': no such file; check the path" for seed in (1, 2)
    ]
    assert any(line.startswith("VT8020_seed1: 20 jumps, hypervolume") for line in lines)
    assert "grid.toml: 4 studies, 2 finished, 2 failed" in lines
    assert lines[-1].startswith("error: ")  # after the files that it wrote


def test_a_motor_file_is_named_in_quotes_also_where_a_key_of_it_is_wrong(tmp_path, capsys):
    (tmp_path / "bad.toml").write_text('name = "bad"\n')
    (tmp_path / "other.db").touch()
    written(tmp_path, 'motors = ["bad.toml"]', SMALL)
    assert run(["campaign", str(tmp_path / "grid.toml"), "--folder", str(tmp_path)]) == 1
    *before, line = capsys.readouterr().err.splitlines()
    assert line.startswith(f"error: grid: motor file '{tmp_path}/bad.toml': ")
    assert any(other.startswith("note: no study of this grid has a database") for other in before)


def test_the_table_is_on_stdout_and_fits_into_80_columns(done):
    _, ran = done
    rows = [line.split() for line in ran.stdout.splitlines() if "seed" in line]
    assert [(row[0], row[1], row[-1]) for row in rows] == [
        ("VT8020_seed1", "20/20", "finished"), ("VT8020_seed2", "20/20", "finished"),
        ("Nope_seed1", "0/20", "failed"), ("Nope_seed2", "0/20", "failed"),
    ]  # fmt: skip
    assert max(map(len, ran.stdout.splitlines())) <= 80


def test_the_csv_has_a_row_per_study_with_the_numbers_of_its_database(done):
    folder, _ = done
    rows = list(csv.DictReader(io.StringIO((folder / "table.csv").read_text())))
    assert [(row["study"], row["motors"], row["seeds"]) for row in rows][1] == ("VT8020_seed2", "VT8020", "seed2")
    data = read_study(folder / "grid" / "VT8020_seed2.db")
    front = data.front()
    assert float(rows[1]["hypervolume"]) == pytest.approx(data.history["hypervolume"].iloc[-1], rel=1e-12)
    assert int(rows[1]["front"]) == len(front)
    assert float(rows[1]["best_height_m"]) == front["height_m"].max()
    reached = front[front["height_m"] >= 0.8]["energy_j"]
    assert rows[1]["energy_j_at_0_8_m"] == (str(reached.min()) if len(reached) else "")
    assert float(rows[1]["knee_energy_j"]) in set(front["energy_j"])
    assert (rows[2]["state"], rows[2]["hypervolume"], rows[2]["evaluations"]) == ("failed", "", "0")
    assert "Nope.toml': no such file" in rows[2]["reason"]


def test_the_page_is_written_and_a_study_is_never_replaced(done):
    folder, ran = done
    text = (folder / "page.html").read_text()
    assert "2 of 4 studies are finished" in text
    assert "Nope_seed1 failed: motor file &#x27;" in text
    assert "wrote page.html" in ran.stderr
    (folder / "study.html").symlink_to(folder / "grid" / "VT8020_seed1.db")
    refused = CliRunner().invoke(cli, ["campaign", str(folder / "grid.toml"), "--report", str(folder / "study.html")])
    assert "is a database, which no output replaces" in str(refused.exception)


def test_status_runs_nothing_and_says_the_same_of_what_is_stored(done):
    folder, _ = done
    before = {path: path.stat().st_mtime_ns for path in (folder / "grid").iterdir()}
    result = CliRunner().invoke(cli, ["campaign", str(folder / "grid.toml"), "--status", "--json"])
    assert result.exit_code == 0
    (line,) = result.stdout.splitlines()
    studies = json.loads(line)["studies"]
    assert [one["state"] for one in studies] == ["finished", "finished", "waiting", "waiting"]
    assert {path: path.stat().st_mtime_ns for path in (folder / "grid").iterdir()} == before


def test_the_table_at_the_end_says_the_time_that_is_stored(done):
    folder, ran = done
    later = CliRunner().invoke(cli, ["campaign", str(folder / "grid.toml"), "--status"])
    times = [[line.split()[-3] for line in out.splitlines() if "VT8020" in line] for out in (ran.stdout, later.stdout)]
    assert times[0] == times[1]
    assert len(times[0]) == 2


def test_as_json_a_generation_and_an_end_are_lines_of_their_own(many, capsys):
    with reports(many, as_json=True) as (changed, notify):
        for state, evaluations in (("running", 10), ("finished", 20), ("failed", 0)):
            many[0].state, many[0].evaluations = state, evaluations
            changed(many[0])
        notify("a line")
    said = capsys.readouterr()
    events = [json.loads(line) for line in said.out.splitlines()]
    assert [event["event"] for event in events] == ["generation", "study", "study"]
    assert [event["evaluations"] for event in events] == [10, 20, 0]
    assert {event["study"] for event in events} == {many[0].name}
    assert said.err == "a line\n"


@pytest.mark.long
def test_json_is_a_line_per_generation_and_per_study(tmp_path, capsys):
    written(tmp_path, "seeds = [1]", SMALL.replace("40", "20"))
    assert run(["campaign", str(tmp_path / "grid.toml"), "--json", "--folder", str(tmp_path / "other")]) == 0
    events = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    of_one = [event for event in events if "study" in event]
    stored = [event["evaluations"] for event in of_one if event["event"] == "generation" and event["per_second"]]
    assert stored == [10, 20]
    assert (of_one[-1]["event"], of_one[-1]["state"], of_one[-1]["evaluations"]) == ("study", "finished", 20)
    assert events[-1]["event"] == "end"


@pytest.mark.long
def test_a_working_directory_that_was_deleted_is_named_rather_than_an_output(tmp_path):
    """Starting a process asks for it; what the system said read as if the table could not be written."""
    file = written(tmp_path, "seeds = [1]", SMALL.replace("40", "20"))
    gone = tmp_path / "gone"
    gone.mkdir()
    line = [sys.executable, "-m", "pareto_monoped", "campaign", str(file), "--csv", "out"]
    ran = subprocess.run(
        ["sh", "-c", 'rmdir ../gone && exec "$@"', "sh", *line],
        cwd=gone,
        env=os.environ | {"PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert (ran.returncode, ran.stdout) == (2, "")
    assert ran.stderr == "error: working directory: has been deleted; change to a folder that exists\n"
    assert not list(tmp_path.rglob("*.db"))


@pytest.mark.parametrize("option", ["--csv", "--report"])
def test_an_output_that_cannot_be_written_is_refused_before_any_study_runs(tmp_path, option):
    """It was refused after the whole campaign."""
    file = written(tmp_path, "seeds = [1]", SMALL.replace("40", "20"))
    (tmp_path / "place").write_text("a file")
    ending = option.removeprefix("--").replace("report", "html")
    result = CliRunner().invoke(cli, ["campaign", str(file), option, str(tmp_path / "place" / f"out.{ending}")])
    assert "cannot be written" in str(result.exception)
    assert not list(tmp_path.rglob("*.db"))
    assert sorted(path.name for path in tmp_path.iterdir()) == ["grid.toml", "place"]


def shown(standings, height):
    console = Console(width=80, height=height, file=io.StringIO())
    for part in _rows(standings, height):
        console.print(part)
    return console.file.getvalue().splitlines()


@pytest.fixture
def many(tmp_path):
    campaign = load_campaign(written(tmp_path, f"seeds = {list(range(90))}"))
    return standings_of(places_of(campaign, campaign.folder))


def test_the_live_table_shows_who_is_at_work_and_counts_the_others(many):
    for k, state in {0: "finished", 1: "failed", 40: "running", 80: "running"}.items():
        many[k].state = state
    lines = shown(many, 24)
    assert len(lines) <= 23
    named = [line.split()[0] for line in lines if "seed" in line]
    assert {"seed1", "seed40", "seed80"} < set(named)
    assert "seed0" not in named
    assert named == sorted(named, key=lambda name: int(name[4:]))
    assert f"and {90 - len(named)} more: 1 finished, {89 - len(named)} waiting" in lines


def test_eighteen_studies_fit_into_a_terminal_of_24_lines(many):
    lines = shown(many[:18], 24)
    assert len([line for line in lines if "seed" in line]) == 18
    assert len(lines) <= 23
    assert max(map(len, lines)) <= 80


def test_long_names_lose_their_middle_and_times_are_clocks():
    assert shortened("electrical_energy_j_VT8020_seed12", 16) == "electri…0_seed12"
    assert [clock(seconds) for seconds in (5.4, 75.0, 3725.0)] == ["0:05", "1:15", "1:02:05"]

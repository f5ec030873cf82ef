"""Options that say where the work is done: they lead there, exclude each other, and tell what befalls the workers."""

import json
import os
import signal
from importlib.metadata import version

import pytest

from pareto_monoped import cli
from pareto_monoped.cli.options import Where, executor_at, where
from pareto_monoped.compute.crew import Crew, Limits
from pareto_monoped.compute.processes import LocalProcesses
from tests.cli.support import STORED
from tests.compute import tasks
from tests.compute.dask_here import ROOT, DaskHere

STUDY = 'name = "s"\nevaluations = 20\naudit = false\nalgorithm = { name = "nsga2", population = 10 }\n'


def test_each_option_says_one_place():
    assert where(None, None, None) == where(None, None, 3) == Where()
    assert where(2, None, None) == Where(processes=2)
    assert where(None, "tcp://x:1", None) == Where(scheduler="tcp://x:1")


@pytest.mark.parametrize(
    "command", ["run s.toml", "resume s.db", "robust s.db", "sensitivity s.db --trial 1", "verify s.db --simulate 1"]
)
@pytest.mark.parametrize(
    ("options", "words"),
    [
        ("--processes 2 --scheduler tcp://x:1", "--processes and --scheduler exclude each other; drop one"),
        ("--workers 2 --processes 2", "--processes and --workers exclude each other; drop one"),
        ("--workers 2 --scheduler tcp://x:1", "--scheduler and --workers exclude each other; drop one"),
    ],
)
def test_two_places_are_refused(tmp_path, monkeypatch, capsys, command, options, words):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "s.toml").write_text(STUDY)
    assert cli._run([*command.split(), *options.split()]) == 2
    assert capsys.readouterr().err == f"error: {words} (see 'pareto-monoped {command.split()[0]} --help')\n"
    assert [path.name for path in tmp_path.iterdir()] == ["s.toml"]


@pytest.mark.parametrize("place", [["--processes", "2"], ["--scheduler", "tcp://x:1"]])
def test_verify_takes_a_place_only_where_it_simulates(capsys, place):
    assert cli._run(["verify", str(STORED), *place]) == 2
    assert "--processes and --scheduler go with --simulate only" in capsys.readouterr().err


def test_without_an_option_threads_do_the_work():
    with executor_at(Where()) as executor:
        assert executor is None


@pytest.mark.long
def test_processes_are_as_many_as_asked_for_and_losses_are_told_on_standard_error(capsys):
    limits = Limits(absent_s=7.0)
    with executor_at(Where(processes=1), limits=limits) as crew:
        first = crew.submit(tasks.short, 1).result(timeout=120)[1]
        assert len(crew._staff.present()) == 1
        assert crew._limits is limits
        os.kill(first, signal.SIGKILL)
        assert crew.submit(tasks.short, 2).result(timeout=120)[1] != first
    captured = capsys.readouterr()
    assert captured.out == ""
    assert captured.err.startswith("process 1 ")
    with pytest.raises(RuntimeError):
        crew.submit(tasks.short, 3)


@pytest.mark.long
def test_a_worker_with_another_cad_package_makes_no_exports(tmp_path, capsys):
    """It was given them: what it made differed from the others', or failed."""
    pytest.importorskip("distributed")
    pytest.importorskip("OCP")
    other = tmp_path / "other" / "manifold3d-0.0.1.dist-info"
    other.mkdir(parents=True)
    (other / "METADATA").write_text("Metadata-Version: 2.1\nName: manifold3d\nVersion: 0.0.1\n")
    with DaskHere(tmp_path) as dask:
        dask.workers += [dask.add(package=f"{other.parent}{os.pathsep}{ROOT}")]
        words = ["export", str(STORED), "--front", "--every", "1000", "-o", str(tmp_path / "out")]
        assert cli._run([*words, "--scheduler", dask.address]) == 1
    lines = capsys.readouterr().err.splitlines()
    assert any(line.endswith(f"is refused: manifold3d 0.0.1, here {version('manifold3d')}") for line in lines)
    assert "none of its 1 workers may be used (manifold3d 0.0.1" in lines[-1]
    assert not (tmp_path / "out").exists()


def test_run_resume_robust_sensitivity_and_verify_have_their_jumps_made_there(
    few_samples, tmp_path, monkeypatch, capsys
):
    """The results are the same wherever they are made, so the tasks are counted. One process serves all commands."""
    given, asked = [], []

    class Kept(LocalProcesses):
        def close(self):
            pass

    class Counting(Crew):
        def submit(self, function, /, *arguments, **named):
            given.append(function)
            return super().submit(function, *arguments, **named)

    kept = Kept(1, 1)
    monkeypatch.setattr("pareto_monoped.jump.peers.LocalProcesses", lambda *counts: asked.append(counts) or kept)
    monkeypatch.setattr("pareto_monoped.jump.peers.Crew", Counting)
    file, db = tmp_path / "s.toml", str(tmp_path / "s.db")
    file.write_text(STUDY)
    for words in (
        ["run", str(file), "--db", db, "--json"],
        ["resume", db, "--evaluations", "30", "--json"],
        ["robust", db, "--trial", "{trial}"],
        ["sensitivity", db, "--trial", "{trial}", "--samples", "32"],
        ["verify", db, "--simulate", "3"],
    ):
        before = len(given)
        if "{trial}" in words:
            capsys.readouterr()
            assert cli._run(["front", db, "--json"]) == 0
            words[3] = str(json.loads(capsys.readouterr().out)[0]["trial"])
        assert cli._run([*words, "--processes", "1"]) == 0, capsys.readouterr().err
        assert len(given) > before, words
    assert [count for count, _ in asked] == [1] * 5
    LocalProcesses.close(kept)

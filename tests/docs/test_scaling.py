"""What docs/scaling.md shows: commands that work, figures that agree with each other and with the code."""

import os
import re
import runpy
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from tests.compute.dask_here import free_port

ROOT = Path(__file__).parents[2]
TEXT = (ROOT / "docs" / "scaling.md").read_text(encoding="utf-8")
MILLION = TEXT.split("## What a million evaluations cost")[1].split("\n## ")[0]
BENCHMARKS = sorted({" ".join(found.split()) for found in re.findall(r"`python (benchmarks/[^`]*)`", TEXT)})


def rows(title):
    """The cells of the table below a heading of the section on a million evaluations, without its head."""
    lines = [line for line in MILLION.split(f"### {title}")[1].split("\n### ")[0].splitlines() if line.startswith("|")]
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in lines[2:]]


@pytest.mark.parametrize("command", BENCHMARKS)
def test_measurements_name_commands_that_exist(command, monkeypatch, capsys):
    script, *words = shlex.split(command)
    monkeypatch.setattr(sys, "argv", [script, "--help"])
    monkeypatch.syspath_prepend(ROOT / "benchmarks")
    with pytest.raises(SystemExit) as ended:
        runpy.run_path(str(ROOT / script), run_name="__main__")
    said = capsys.readouterr().out
    assert ended.value.code == 0
    for option in (word for word in words if word.startswith("--")):
        assert f"{option} " in said
    parts = [word for word, before in zip(words, [script, *words], strict=False) if before == script]
    assert all(part in said for part in parts)


def test_the_section_on_a_million_evaluations_names_its_commands():
    assert len([command for command in BENCHMARKS if command in " ".join(MILLION.split())]) >= 4


def test_shares_of_an_evaluation_add_up():
    shares = rows("Shares of an evaluation")
    assert len(shares) == 7
    for name, algorithm, storage, rest, together, jump, at_cores in shares:
        assert float(algorithm) + float(storage) + float(rest) == pytest.approx(float(together), abs=0.0016), name
        assert round(float(jump) / float(together), 1) == pytest.approx(float(at_cores), abs=0.5), name


@pytest.mark.long
def test_scheduler_and_workers_on_one_machine(tmp_path):
    pytest.importorskip("distributed")
    section = TEXT.split("## A scheduler and workers on one machine")[1].split("\n## ")[0]
    (block,) = re.findall(r"^```sh\n(.*?)^```", section, re.S | re.M)
    port = str(free_port())
    scheduler, workers, study = block.replace("8786", port).strip().splitlines()
    shutil.copytree(ROOT / "studies", tmp_path / "studies", ignore=shutil.ignore_patterns("*.db*"))
    environment = os.environ | {"PATH": f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"}
    started = []
    try:
        for command in (f"{scheduler} --port {port} --no-dashboard", f"{workers} --no-dashboard"):
            with (tmp_path / "log").open("a") as log:
                started.append(
                    subprocess.Popen(shlex.split(command), cwd=tmp_path, env=environment, stdout=log, stderr=log)
                )
        done = subprocess.run(
            shlex.split(study), cwd=tmp_path, env=environment, capture_output=True, text=True, check=False, timeout=500
        )
    finally:
        for process in reversed(started):
            process.terminate()
            process.wait()
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith("front: ")
    assert "300 evaluations" in done.stderr
    assert "Traceback" not in done.stderr

"""Without an extra: one line and how to install it, before anything else is done; all else works."""

import os
import subprocess
import sys
import textwrap
import tomllib
from pathlib import Path

import pytest

from pareto_monoped import errors
from pareto_monoped.cad.film import require_video
from pareto_monoped.compute.cluster import DaskWorkers
from pareto_monoped.errors import EXTRAS, InputError

ROOT = Path(__file__).parents[1]
BLOCKED = textwrap.dedent(
    """
    import sys
    from importlib.abc import MetaPathFinder

    class Missing(MetaPathFinder):
        def find_spec(self, name, path=None, target=None):
            if name.partition(".")[0] in MODULES:
                raise ModuleNotFoundError(f"No module named {name!r}", name=name)

    sys.meta_path.insert(0, Missing())
    import importlib.util
    kept = importlib.util.find_spec
    importlib.util.find_spec = lambda name: None if name in MODULES else kept(name)
    """
)


def without_extras(code: str, folder: Path, lacks=tuple(EXTRAS)) -> "subprocess.CompletedProcess[str]":
    """Run code in a process that has no modules of these extras, and no programs."""
    modules = {module for extra in lacks for module in EXTRAS[extra]}
    program = f"MODULES = {modules!r}\n{BLOCKED}\n{textwrap.dedent(code)}"
    environment = os.environ | {"PATH": str(folder)}
    return subprocess.run(
        [sys.executable, "-c", program], cwd=folder, env=environment, capture_output=True, text=True, timeout=300
    )


@pytest.mark.parametrize("extra", EXTRAS)
def test_an_extra_names_these_packages(extra):
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    names = {line.partition(">")[0] for line in project["optional-dependencies"][extra]}
    assert names == set(EXTRAS[extra].values())
    assert not names & {line.partition(">")[0] for line in project["dependencies"]}


NEEDS = [
    (["export", "--case", "C", "-o", "out"], "cad"),
    (["pareto", "nothing.toml", "-o", "out"], "cad"),
    (["simulate", "--gif", "jump.gif"], "cad"),
    (["trials", "nothing.db", "--parquet", "t.parquet"], "parquet"),
]
"""Commands, and the extra that each needs."""


def test_a_command_says_what_to_install(tmp_path):
    code = f"from pareto_monoped.cli import _run; print([_run(words) for words, _ in {NEEDS!r}])"
    run = without_extras(code, tmp_path)
    assert run.stdout.strip() == str([2] * len(NEEDS)), run.stderr
    for said, (_, extra) in zip(run.stderr.splitlines(), NEEDS, strict=True):
        assert f"not installed; install the extra: pip install 'pareto-monoped[{extra}]'" in said
    assert list(tmp_path.iterdir()) == []


def test_a_video_without_an_encoder_says_what_to_install(monkeypatch):
    monkeypatch.setenv("PATH", "")
    monkeypatch.setattr(errors, "find_spec", lambda module: None)
    with pytest.raises(InputError) as caught:
        require_video(Path("jump.mp4"))
    said = str(caught.value)
    assert said.startswith("--video: needs imageio-ffmpeg, which is not installed")
    assert said.endswith("pip install 'pareto-monoped[video]', or install the program ffmpeg, or use --gif")


def test_a_scheduler_without_dask_says_what_to_install(monkeypatch):
    monkeypatch.setattr(errors, "find_spec", lambda module: None)
    with pytest.raises(InputError, match=r"scheduler tcp://x:1: needs distributed, .*'pareto-monoped\[cluster\]'"):
        DaskWorkers("tcp://x:1")


def test_all_packages_that_are_missing_are_named(monkeypatch):
    monkeypatch.setattr(errors, "find_spec", lambda module: None)
    with pytest.raises(InputError, match="needs cadquery-ocp-novtk and manifold3d and shapely, which are not"):
        errors.require_extra("cad", "CAD")
    monkeypatch.setattr(errors, "find_spec", lambda module: True)
    errors.require_extra("cad", "CAD")


@pytest.mark.parametrize("figures", [[], pytest.param(["--figures", "figures"], marks=pytest.mark.long)], ids=len)
def test_searching_choosing_and_reporting_need_no_cad(tmp_path, figures):
    code = f"""
    import pareto_monoped as pm
    from pareto_monoped.analysis import robustness
    from pareto_monoped.cli import _run
    robustness.LEAST_SAMPLES = 16  # the others need as little
    stored = pm.run(pm.Study.define(name="s", evaluations=20, algorithm="random"), "s.db")
    knee = stored.pick("knee").trial
    pm.plot_front(stored)
    assert _run(["report", "s.db", "-o", "s.html", *{figures}]) == 0
    assert _run(["simulate", "--case", "C", "--model", "c.xml"]) == 0
    assert _run(["robust", "s.db", "--trial", str(knee), "--samples", "16"]) == 0
    """
    run = without_extras(code, tmp_path)
    assert run.returncode == 0, run.stderr
    assert (tmp_path / "s.html").stat().st_size > 0

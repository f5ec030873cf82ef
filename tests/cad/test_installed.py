"""Without the extra ``cad``: one line and how to install it, before anything else is done; all else works."""

import subprocess
import sys
import textwrap
import tomllib
from pathlib import Path

import pytest

from pareto_monoped.cad.installed import LIBRARIES

ROOT = Path(__file__).parents[2]
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


def without_cad(code: str, folder: Path) -> "subprocess.CompletedProcess[str]":
    """Run code in a process that has none of the extra's libraries."""
    program = f"MODULES = {set(LIBRARIES)!r}\n{BLOCKED}\n{textwrap.dedent(code)}"
    return subprocess.run([sys.executable, "-c", program], cwd=folder, capture_output=True, text=True, timeout=300)


def test_the_extra_names_these_libraries():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    names = {line.partition(">")[0] for line in project["optional-dependencies"]["cad"]}
    assert names == set(LIBRARIES.values())
    assert not names & {line.partition(">")[0] for line in project["dependencies"]}


@pytest.mark.parametrize(
    "words", [["export", "--case", "C", "-o", "out"], ["pareto", "nothing.toml", "-o", "out"]], ids=lambda w: w[0]
)
def test_an_export_says_what_to_install(words, tmp_path):
    run = without_cad(f"from pareto_monoped.cli import main; main({words!r})", tmp_path)
    assert run.returncode == 2
    assert "pip install 'pareto-monoped[cad]'" in run.stderr
    assert len(run.stderr.splitlines()) == 1
    assert list(tmp_path.iterdir()) == []


def test_searching_choosing_and_reporting_need_no_cad(tmp_path):
    code = """
    import pareto_monoped as pm
    from pareto_monoped.cli import _run
    stored = pm.run(pm.Study.define(name="s", evaluations=40, algorithm="random"), "s.db")
    stored.pick("knee")
    pm.plot_front(stored)
    assert _run(["report", "s.db", "-o", "s.html", "--figures", "figures"]) == 0
    assert _run(["simulate", "--case", "C", "--audit", "--model", "c.xml"]) == 0
    assert _run(["robust", "s.db", "--samples", "256"]) == 0
    """
    run = without_cad(code, tmp_path)
    assert run.returncode == 0, run.stderr
    assert (tmp_path / "s.html").stat().st_size > 0

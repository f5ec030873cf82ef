"""The table "Where to find" of docs/architecture.md: every file and every name in it exists."""

import ast
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "architecture.md").read_text(encoding="utf-8")


def rows() -> list[tuple[str, Path, str]]:
    """What is looked for, the file and one name in it, for each name of each row."""
    text = PAGE.split("## Where to find")[1].split("## Development")[0]
    found = []
    _heading, _rule, *lines = (line for line in text.splitlines() if line.startswith("|"))
    for line in lines:
        what, files, names = (cell.strip() for cell in line.strip("|").split("|"))
        (file,) = re.findall(r"`([^`]+)`", files)
        found += [(what, ROOT / file, name) for name in re.findall(r"`([^`]+)`", names)]
    return found


def defined(module: Path) -> set[str]:
    """Names that a module defines at its top level, and the members of its classes as ``Class.member``."""
    names = set()

    def add(nodes: list[ast.stmt], prefix: str) -> None:
        for node in nodes:
            if isinstance(node, ast.FunctionDef | ast.ClassDef):
                names.add(prefix + node.name)
            if isinstance(node, ast.ClassDef):
                add(node.body, f"{prefix}{node.name}.")
            targets = node.targets if isinstance(node, ast.Assign) else [getattr(node, "target", None)]
            names.update(prefix + target.id for target in targets if isinstance(target, ast.Name))

    add(ast.parse(module.read_text(encoding="utf-8")).body, "")
    return names


@pytest.mark.parametrize(("what", "file", "name"), rows(), ids=lambda value: str(value).split("/")[-1])
def test_the_file_and_the_name_exist(what, file, name):
    assert file.is_file(), what
    known = defined(file) if file.suffix == ".py" else file.read_text(encoding="utf-8")
    assert name in known, what


def test_the_table_answers_what_newcomers_look_for():
    questions = " ".join(what for what, _, _ in rows())
    for words in (
        "density",
        "end stop",
        "well-conditioned",
        "columns of a trial",
        "measure",
        "variables",
        "motor",
        "limits",
    ):
        assert words in questions


def test_the_tree_names_every_package_and_no_other():
    tree = PAGE.split("# Architecture")[1].split("A module imports")[0]
    named = set(re.findall(r"^ {8}(\w+(?:/|\.py)) ", tree, re.M))
    there = {
        path.name + ("/" if path.is_dir() else "")
        for path in (ROOT / "pareto_monoped").iterdir()
        if path.suffix == ".py" or (path / "__init__.py").is_file()
    }
    assert named == there - {"__init__.py", "__main__.py"}
    rooms = {path.parent.name + "/" for path in (ROOT / "pareto_monoped" / "cad").glob("*/__init__.py")}
    assert set(re.findall(r"^ {12}(\w+/) ", tree, re.M)) == rooms


@pytest.mark.parametrize("page", sorted((ROOT / "docs").glob("*.md")), ids=lambda page: page.name)
def test_modules_that_a_page_names_exist(page):
    """As a path from the root or from the package; exports have folders of their own names."""
    rooms = {path.parent.name for path in (ROOT / "pareto_monoped").rglob("__init__.py")} - {"cad"}
    named = re.findall(r"`([\w/]+/\w+\.py)`", page.read_text(encoding="utf-8"))
    there = [name for name in named if (ROOT / name).exists() or (ROOT / "pareto_monoped" / name).exists()]
    assert [name for name in named if name not in there and name.split("/")[0] in rooms | {"tests", "benchmarks"}] == []

"""The house's rule: imports go one way only, and heavy libraries are imported in their own room."""

import ast
import subprocess
import sys
from pathlib import Path

import pytest

PACKAGE = Path(__file__).parent.parent / "pareto_monoped"
# data/ holds what is read or copied, such as the replay of a jump; nothing imports it.
SOURCES = sorted(path for path in PACKAGE.rglob("*.py") if path.relative_to(PACKAGE).parts[0] != "data")

# From the top of the house to the ground; a module may import from its own level's room and from lower levels.
LEVELS = [
    {"__main__"},
    {"cli"},
    {"api"},
    {"campaign"},
    {"report", "cad"},
    {"analysis"},
    {"study"},
    {"storage"},
    {"search"},
    {"definition"},
    {"uncertainty"},
    {"pareto", "jump"},
    {"strength"},
    {"robot"},
    {"leg"},
    {"actuator"},
    {"geometry"},
    {"materials"},
    {"measures"},
    {"design", "config"},
    {"compute"},
    {"files"},
    {"errors", "__init__"},
]
# Rooms that may import from another room of their level.
BESIDE = {("report", "cad"), ("design", "config")}
HEAVY = {
    "mujoco": ["jump"],
    "OCP": ["cad/kernel"],
    "optuna": ["search", "storage"],
    "pymoo": ["search", "study/pymoo_problem.py"],
    "cma": ["search"],
    "plotly": ["report"],
}

ANYWHERE = {"OCP"}
"""Libraries that no other folder may import even inside a function: the CAD kernel has a process of its own."""


def level(room: str) -> int:
    return next(index for index, rooms in enumerate(LEVELS) if room in rooms)


def room_of(path: Path) -> str:
    return path.relative_to(PACKAGE).parts[0].removesuffix(".py")


def imports(path: Path) -> list[tuple[str, bool]]:
    """Every imported module with whether the import stands at the top of the file."""
    tree = ast.parse(path.read_text())
    found = []
    for node in ast.walk(tree):
        names = []
        if isinstance(node, ast.ImportFrom) and node.module:
            names = [node.module]
            if node.module == "pareto_monoped":
                names = [f"pareto_monoped.{alias.name}" for alias in node.names]
        elif isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        found += [(name, node in tree.body) for name in names]
    return found


# The front door imports from every room, when a name is used; tests/api holds that it imports nothing before.
INSIDE = [path for path in SOURCES if path != PACKAGE / "__init__.py"]


@pytest.mark.parametrize("path", INSIDE, ids=lambda p: str(p.relative_to(PACKAGE)))
def test_imports_go_down_only(path):
    here = room_of(path)
    for name, _ in imports(path):
        parts = name.split(".")
        if parts[0] != "pareto_monoped" or len(parts) == 1:
            continue
        there = parts[1]
        if there in (here, "__version__"):
            continue
        down = level(there) > level(here) or (here, there) in BESIDE
        assert down, f"{here} imports {name}, which is not below it"


@pytest.mark.parametrize("path", SOURCES, ids=lambda p: str(p.relative_to(PACKAGE)))
def test_heavy_libraries_stay_in_their_room(path):
    for name, at_top in imports(path):
        library = name.split(".")[0]
        homes = HEAVY.get(library)
        if homes is None:
            continue
        # Other rooms may need a version number or a model file, and import the library inside a function.
        at_home = any(path.is_relative_to(PACKAGE / home) for home in homes)
        assert at_home or not (at_top or library in ANYWHERE), f"{library} belongs into {' or '.join(homes)}"


SLOW = sorted([*HEAVY, "pandas", "numba", "matplotlib", "scipy", "rich", "pydantic", "sqlalchemy", "trimesh"])
"""What an answer that should come at once must not wait for."""


def test_help_and_version_import_nothing_heavy():
    """That of every command: all in one process, where the first that imports something is named."""
    code = f"""
import sys
from click.testing import CliRunner
from pareto_monoped.cli import _COMMANDS, cli
for words in [["--help"], ["--version"], *([name, "--help"] for name in _COMMANDS)]:
    result = CliRunner().invoke(cli, words)
    assert result.exit_code == 0, result.output
    found = [name for name in {SLOW} if name in sys.modules]
    if found:
        sys.exit(f"{{words}}: {{found}}")
"""
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert run.stderr == ""
    assert run.returncode == 0


def test_an_export_of_a_case_imports_no_tables():
    """Only an export from a study's database needs pandas, which is slow to import."""
    modules = ("cli.exports", "pareto.pick", "cad.jobs", "cad.records", "cad.batch")
    code = "import sys\n" + "".join(f"import pareto_monoped.{name}\n" for name in modules)
    run = subprocess.run(
        [sys.executable, "-c", f"{code}print('pandas' in sys.modules)"], capture_output=True, text=True
    )
    assert run.stdout.strip() == "False", run.stderr


def module_of(path: Path) -> str:
    return ".".join(path.relative_to(PACKAGE.parent).with_suffix("").parts).removesuffix(".__init__")


def imported_modules(path: Path, modules: set[str]) -> set[str]:
    """Modules of the package that a module imports anywhere, inside functions and for type checking too."""
    found = set()
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.ImportFrom) and node.module:
            # A name that is imported from a package may be a module itself.
            names = [f"{node.module}.{alias.name}" for alias in node.names]
            found |= {name if name in modules else node.module for name in names}
        elif isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
    return (found & modules) - {"pareto_monoped"}


def circles(graph: dict[str, set[str]]) -> set[frozenset[str]]:
    """Groups of modules that reach each other."""
    reach = {module: set(targets) for module, targets in graph.items()}
    for middle in graph:
        for module in graph:
            if middle in reach[module]:
                reach[module] |= reach[middle]
    return {
        frozenset(other for other in graph if other in reach[module] and module in reach[other])
        for module in graph
        if module in reach[module]
    }


def test_no_modules_import_each_other_in_a_circle():
    modules = {module_of(path) for path in INSIDE}
    graph = {module_of(path): imported_modules(path, modules) for path in INSIDE}
    assert circles(graph) == set()


def test_a_circle_through_three_modules_is_found():
    assert circles({"a": {"b"}, "b": {"c"}, "c": {"a"}, "d": {"a"}}) == {frozenset("abc")}


SPELLING = {"startswith", "endswith", "removeprefix", "removesuffix", "search", "match", "fullmatch", "find", "get"}


def is_name_of_part(node: ast.AST) -> bool:
    """``part.name``, ``instance.part.name``, ``kind.name`` and the like."""
    if not (isinstance(node, ast.Attribute) and node.attr == "name"):
        return False
    owner = node.value.attr if isinstance(node.value, ast.Attribute) else getattr(node.value, "id", "")
    return owner in ("part", "kind") or owner.endswith("_part")


def decisions_by_part_name(tree: ast.AST) -> list[str]:
    """Expressions that ask how a part's name is spelt; to look a joint's partner up by its name is allowed."""
    found = []
    for node in ast.walk(tree):
        asked = False
        if isinstance(node, ast.Compare):
            sides = [node.left, *node.comparators]
            asked = any(map(is_name_of_part, sides)) and not any(
                isinstance(side, ast.Attribute) and side.attr == "partner" for side in sides
            )
        elif isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute) and node.func.attr in SPELLING:
            asked = any(map(is_name_of_part, [node.func.value, *node.args]))
        elif isinstance(node, ast.Match):
            asked = is_name_of_part(node.subject)
        if asked:
            found.append(ast.unparse(node))
    return found


@pytest.mark.parametrize("path", SOURCES, ids=lambda p: str(p.relative_to(PACKAGE)))
def test_nothing_is_decided_by_the_name_of_a_part(path):
    assert decisions_by_part_name(ast.parse(path.read_text())) == []


@pytest.mark.parametrize(
    "code",
    [
        "part.name == 'motor_rotor'",
        "instance.part.name in HIDDEN",
        "'core' in instance.part.name",
        "part.name.endswith('_screw')",
        "FASTENER.search(part.name)",
        "COLOURS.get(kind.name)",
    ],
)
def test_a_decision_by_the_name_of_a_part_is_found(code):
    assert len(decisions_by_part_name(ast.parse(code))) == 1

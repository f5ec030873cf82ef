"""The house's rules: imports go one way, rooms are entered by their doors, heavy libraries stay in their own room."""

import ast
import re
import subprocess
import sys
from functools import cache
from pathlib import Path

import pytest

PACKAGE = Path(__file__).parent.parent / "pareto_monoped"
# data/ holds what is read or copied, such as the replay of a jump; nothing imports it.
SOURCES = sorted(path for path in PACKAGE.rglob("*.py") if path.relative_to(PACKAGE).parts[0] != "data")
# The front door imports from every room, when a name is used; tests/api holds that it imports nothing before.
INSIDE = [path for path in SOURCES if path != PACKAGE / "__init__.py"]
ROOMS = [path.parent for path in SOURCES if path.name == "__init__.py" and path.parent.parent == PACKAGE]

# From the top of the house to the ground; a module may import from its own room and from lower levels.
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
INSPECTORS = {("strength", "actuator"), ("strength", "leg")}
"""The strength check rates the dimensions that parts are drawn with, so it may look at every module of these rooms."""
MOST_AT_A_DOOR = 23
"""Modules that a room may show to others: about ten, and as many as the largest room shows today."""
MOST_MODULES, MOST_IN_A_ROOM, MOST_LINES = 320, 40, 450
"""Of the package, of a folder, of a module: what one engineer can hold in the head."""
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


@cache
def parsed(path: Path) -> ast.Module:
    return ast.parse(path.read_text(encoding="utf-8"))


@cache
def nodes(tree: ast.Module) -> list[ast.AST]:
    """All of a tree, looked through once for all rules."""
    return list(ast.walk(tree))


def module_of(path: Path) -> str:
    return ".".join(path.relative_to(PACKAGE.parent).with_suffix("").parts).removesuffix(".__init__")


MODULES = {module_of(path) for path in INSIDE}


@cache
def imported(tree: ast.Module) -> set[str]:
    """What is imported anywhere, also inside functions and for type checking; modules of the package in full."""
    found = set()
    for node in nodes(tree):
        if isinstance(node, ast.ImportFrom) and node.module:
            # A name that is imported from a package may be a module itself.
            names = [f"{node.module}.{alias.name}" for alias in node.names]
            found |= {name if name in MODULES else node.module for name in names}
        elif isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
    return found


def of_package(tree: ast.Module) -> list[str]:
    return sorted(name for name in imported(tree) if name.startswith("pareto_monoped."))


def level(room: str) -> int:
    return next(index for index, rooms in enumerate(LEVELS) if room in rooms)


def upwards(here: str, tree: ast.Module) -> list[str]:
    """Imports of rooms that are not below the room ``here``."""
    rooms = {name: name.split(".")[1] for name in of_package(tree)}
    return [
        name
        for name, there in rooms.items()
        if there != here and (here, there) not in BESIDE and level(there) <= level(here)
    ]


@cache
def door(package: Path) -> list[str]:
    """Modules and rooms of a package that other rooms may import: its ``__all__``."""
    for node in parsed(package / "__init__.py").body:
        if isinstance(node, ast.Assign) and ast.unparse(node.targets[0]) == "__all__":
            return list(ast.literal_eval(node.value))
    return []


def past_doors(here: str, tree: ast.Module) -> list[str]:
    """Imports from other rooms that are not at the door of the room, nor at that of a room inside it."""
    found = []
    for name in of_package(tree):
        package, steps = PACKAGE / name.split(".")[1], name.split(".")[2:]
        if not package.is_dir() or package.name == here or (here, package.name) in INSPECTORS:
            continue
        for step in steps:
            if step not in door(package):
                found.append(name)
                break
            package /= step
    return found


def room_of(path: Path) -> str:
    return path.relative_to(PACKAGE).parts[0].removesuffix(".py")


def in_all_modules(rule) -> dict[str, list[str]]:
    """The modules that break a rule, each with what breaks it."""
    found = {module_of(path): rule(room_of(path), parsed(path)) for path in INSIDE}
    return {module: broken for module, broken in found.items() if broken}


def test_imports_go_down_only():
    assert in_all_modules(upwards) == {}


def test_rooms_are_entered_by_their_door():
    assert in_all_modules(past_doors) == {}, "name it in __all__ of its room, or use what is there"


def test_doors_are_narrow_and_lead_somewhere():
    assert {room.name: len(door(room)) for room in ROOMS if len(door(room)) > MOST_AT_A_DOOR} == {}
    used = {name for path in INSIDE for name in of_package(parsed(path)) if name.split(".")[1] != room_of(path)}
    for room in ROOMS:
        prefixes = {f"pareto_monoped.{room.name}.{name}" for name in door(room)}
        assert {one for one in prefixes if not any(f"{name}.".startswith(f"{one}.") for name in used)} == set()


@pytest.mark.parametrize(
    ("here", "line", "rule", "broken"),
    [
        ("leg", "from pareto_monoped.cad.export import export_design", upwards, ["pareto_monoped.cad.export"]),
        ("leg", "from pareto_monoped.geometry import parts", upwards, []),
        ("cli", "from pareto_monoped.leg.knee import knee_parts", past_doors, ["pareto_monoped.leg.knee"]),
        (
            "cli",
            "from pareto_monoped.actuator.rating.stage import x",
            past_doors,
            ["pareto_monoped.actuator.rating.stage"],
        ),
        ("cli", "def f():\n    from pareto_monoped.leg import knee", past_doors, ["pareto_monoped.leg.knee"]),
        ("strength", "from pareto_monoped.leg.knee import knee_parts", past_doors, []),
        ("cli", "from pareto_monoped.leg.dimensions import leg_dimensions", past_doors, []),
    ],
)
def test_an_import_that_breaks_a_rule_is_found(here, line, rule, broken):
    assert rule(here, ast.parse(line)) == broken


def order_of(room: Path) -> list[list[str]]:
    """The modules of a room as its docstring orders them, lowest first; those of one group do not need each other."""
    words = re.search(
        r"Order of imports, lowest first: (.+?)\.\s*(\n\n|$)",
        ast.get_docstring(parsed(room / "__init__.py")) or "",
        re.S,
    )
    return (
        [[name.strip() for name in group.split(",")] for group in " ".join(words[1].split()).split(";")]
        if words
        else []
    )


def out_of_order(order: list[list[str]], imports: dict[str, set[str]]) -> list[str]:
    """Imports that do not go to an earlier group, and modules that the order does not name once."""
    place = {name: k for k, group in enumerate(order) for name in group}
    named = sorted(name for group in order for name in group)
    wrong = [f"order: {name}" for name in sorted(set(named) ^ set(imports))] + [
        f"twice: {name}" for name in named if named.count(name) > 1
    ]
    return wrong or [
        f"{module} -> {other}"
        for module, others in imports.items()
        for other in others
        if place[other] >= place[module]
    ]


@pytest.mark.parametrize("room", ROOMS, ids=lambda room: room.name)
def test_imports_inside_a_room_keep_its_order(room):
    start = f"pareto_monoped.{room.name}."
    modules = {module_of(path): path for path in room.rglob("*.py") if path.name != "__init__.py"}
    imports = {
        name.removeprefix(start): {other.removeprefix(start) for other in of_package(parsed(path)) if other in modules}
        for name, path in modules.items()
    }
    assert out_of_order(order_of(room), imports) == []


def test_a_break_of_the_order_is_found():
    order = [["a", "b"], ["c"]]
    assert out_of_order(order, {"a": set(), "b": set(), "c": {"a"}}) == []
    assert out_of_order(order, {"a": {"b"}, "b": set(), "c": set()}) == ["a -> b"]
    assert out_of_order(order, {"a": set(), "b": {"c"}, "c": {"a"}}) == ["b -> c"]
    assert out_of_order(order, {"a": set(), "b": set(), "c": set(), "d": set()}) == ["order: d"]


def test_the_house_stays_small():
    assert len(SOURCES) <= MOST_MODULES
    folders = {path.parent for path in SOURCES}
    assert [folder.name for folder in folders if len(list(folder.glob("*.py"))) > MOST_IN_A_ROOM] == []
    assert [path.name for path in SOURCES if len(path.read_text().splitlines()) > MOST_LINES] == []


def heavy_outside(path: Path, tree: ast.Module) -> list[str]:
    """Heavy libraries that a module imports although they belong to another room.

    Other rooms may need a version number or a model file, and import the library inside a function.
    """
    found = []
    for node in nodes(tree):
        names = [node.module or ""] if isinstance(node, ast.ImportFrom) else []
        names += [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
        for library in {name.split(".")[0] for name in names} & set(HEAVY):
            at_home = any(path.is_relative_to(PACKAGE / home) for home in HEAVY[library])
            if not at_home and (node in tree.body or library in ANYWHERE):
                found.append(library)
    return found


def test_heavy_libraries_stay_in_their_room():
    found = {module_of(path): heavy_outside(path, parsed(path)) for path in SOURCES}
    assert {module: libraries for module, libraries in found.items() if libraries} == {}


@pytest.mark.parametrize(
    ("line", "found"),
    [
        ("import mujoco", ["mujoco"]),
        ("def f():\n    import mujoco", []),
        ("def f():\n    from OCP.gp import gp_Pnt", ["OCP"]),
    ],
)
def test_a_heavy_library_in_another_room_is_found(line, found):
    assert heavy_outside(PACKAGE / "leg" / "knee.py", ast.parse(line)) == found


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
    graph = {module_of(path): set(of_package(parsed(path))) & MODULES for path in INSIDE}
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
    for node in nodes(tree):
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


def test_nothing_is_decided_by_the_name_of_a_part():
    found = {module_of(path): decisions_by_part_name(parsed(path)) for path in SOURCES}
    assert {module: decisions for module, decisions in found.items() if decisions} == {}


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


FILLED = {
    "bodies.Blocking",
    "coordinator.Standing",
    "coordinator._Coordinator",
    "coordinator._Job",
    "crew.Task",
    "crew._Given",
    "crew._Post",
    "engines.PlanarPopulation",
    "paper.Paper",
    "pareto._Steps",
    "population.Population",
    "quiet.Setting",
    "reader._Check",
    "single.Moment",
    "tables.Item",
}
"""Records that are filled while they are used: of a run, of a drawing, of workers."""


def dataclasses_of(code):
    """Class -> the keywords of its decorator."""
    for node in ast.walk(ast.parse(code)):
        for call in getattr(node, "decorator_list", ()):
            if isinstance(call, ast.Call) and ast.unparse(call.func) == "dataclass":
                yield node.name, {keyword.arg: ast.unparse(keyword.value) for keyword in call.keywords}


def loose(code):
    """Dataclasses that can be changed, or that say that they may be."""
    return {
        name
        for name, given in dataclasses_of(code)
        if "frozen" not in given or "False" in (given[key] for key in given if key != "eq")
    }


def test_records_are_frozen_but_for_those_that_are_filled_while_they_are_used():
    found = {f"{path.stem}.{name}" for path in SOURCES for name in loose(path.read_text(encoding="utf-8"))}
    assert found == FILLED


@pytest.mark.parametrize(
    "kind", ["slots=True", "frozen=False", "frozen=True, slots=False", "frozen=True, kw_only=False"]
)
def test_a_record_that_is_not_frozen_is_found(kind):
    assert loose(f"@dataclass({kind})\nclass Record:\n    name: str") == {"Record"}
    assert loose("@dataclass(frozen=True, eq=False)\nclass Record:\n    name: str") == set()

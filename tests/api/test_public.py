"""What ``import pareto_monoped`` offers: every name, its documentation and its example; and that the import is free."""

import ast
import doctest
import importlib
import inspect
import pydoc
import subprocess
import sys
from pathlib import Path

import pytest

import pareto_monoped as pm
from pareto_monoped.errors import ParetoMonopedError

ROOT = Path(__file__).parents[2]
FUNCTIONS = [name for name in pm.__all__ if callable(getattr(pm, name))]
RETURNED = {
    "Actuator", "ActuatorMap", "Alternative", "Measure", "PaperCase", "Progress", "Robot", "SecondSearch", "Variable",
    "Verification",
}  # fmt: skip
"""Classes that are public for annotations: nobody makes their objects but the functions that return them."""


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A folder with a small study, which the examples read."""
    folder = tmp_path_factory.mktemp("examples")
    pm.run(pm.Study.define(name="light", evaluations=200, motor="U8", audit=False), folder / "light.db")
    return folder


def test_one_jump_loads_no_storage_and_no_search():
    """The number of cores came from the module that runs studies, and 49 modules and sqlite3 with it."""
    code = (
        "import sys, pareto_monoped as pm; pm.simulate(pm.PAPER_CASES['C'].design)\n"
        "names = ('sqlite3', 'optuna', 'pymoo', 'pareto_monoped.study.run', 'pareto_monoped.storage.store')\n"
        "print([name for name in names if name in sys.modules])\n"
        "print(sum(name.partition('.')[0] == 'pareto_monoped' for name in sys.modules))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    heavy, ours = done.stdout.splitlines()
    assert heavy == "[]"
    assert int(ours) <= 120


def test_importing_the_package_imports_nothing_else():
    code = (
        "import sys; before = set(sys.modules); import pareto_monoped; dir(pareto_monoped)\n"
        "new = {m.partition('.')[0] for m in set(sys.modules) - before}\n"
        "print(sorted(new - {'pareto_monoped', *sys.stdlib_module_names}))"
    )
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert run.stdout.strip() == "[]"


@pytest.mark.parametrize("name", pm.__all__)
def test_every_public_name_is_there(name):
    assert getattr(pm, name) is getattr(pm, name)
    assert name in dir(pm)


def test_names_for_type_checkers_are_those_that_are_imported():
    """An editor sees the names under TYPE_CHECKING, a program those of ``_HOMES``."""
    tree = ast.parse((Path(pm.__file__)).read_text(encoding="utf-8"))
    block = next(node for node in tree.body if isinstance(node, ast.If))
    seen = {
        (node.module, alias.name) for node in block.body if isinstance(node, ast.ImportFrom) for alias in node.names
    }
    assert seen == {(f"pareto_monoped.{home}", name) for home, names in pm._HOMES.items() for name in names}
    assert {name for _, name in seen} | {"__version__"} == set(pm.__all__)


def test_an_unknown_name_is_an_attribute_error():
    with pytest.raises(AttributeError, match="has no attribute 'simulat'"):
        _ = pm.simulat


@pytest.mark.parametrize("name", FUNCTIONS)
def test_every_function_says_what_it_takes_gives_and_raises(name):
    thing = getattr(pm, name)
    text = inspect.getdoc(thing)
    assert text
    if inspect.isfunction(thing):
        assert "Raises:" in text
        described = text.partition("Args:")[2].partition("Raises:")[0]
        for parameter in inspect.signature(thing).parameters:
            assert parameter in described or len(inspect.signature(thing).parameters) == 1, parameter
    error = isinstance(thing, type) and issubclass(thing, Exception)
    assert "Example:" in text or name in RETURNED or error


@pytest.mark.parametrize("name", [name for name in pm.__all__ if not callable(getattr(pm, name)) and name.isupper()])
def test_every_table_is_described_where_help_looks_and_has_an_example(name):
    """``help`` of a tuple tells of tuples; it tells of the tables for the package and for the module of each."""
    for module in (pm, importlib.import_module(f"pareto_monoped.{pm._HOME[name]}")):
        description, _, example = pydoc.render_doc(module, renderer=pydoc.plaintext).partition("Example:")
        assert f"``{name}``" in description
        assert name in example.partition("DATA")[0]


@pytest.mark.usefixtures("few_samples")
@pytest.mark.parametrize("home", ["", *pm._HOMES])
def test_the_examples_do_what_they_show(home, folder, tmp_path, monkeypatch):
    (tmp_path / "studies").symlink_to(ROOT / "studies")
    (tmp_path / "light.db").write_bytes((folder / "light.db").read_bytes())
    monkeypatch.chdir(tmp_path)
    module = importlib.import_module(f"pareto_monoped.{home}".rstrip("."))
    failed, _ = doctest.testmod(module)
    assert failed == 0


WRONG = {
    "a motor that is a number": lambda: pm.load_motor(80),
    "an unknown motor": lambda: pm.actuator_map("VT8021"),
    "a calibration that is a list": lambda: pm.load_calibration(["reference"]),
    "a design that is a string": lambda: pm.build_robot("C"),
    "designs that are words": lambda: pm.simulate("Case C"),
    "designs that are nothing": lambda: pm.simulate(None),
    "designs without ratios": lambda: pm.simulate({"thigh_length_m": 0.4}),
    "a variable that is none": lambda: pm.simulate(pm.PAPER_CASES["C"].design.as_dict() | {"shin_m": 0.4}),
    "designs of another width": lambda: pm.simulate([[0.4, 0.4, 6.0]]),
    "a block of designs": lambda: pm.simulate([[[0.4] * 7]]),
    "no designs": lambda: pm.simulate([]),
    "two designs to trace": lambda: pm.trace([pm.PAPER_CASES["C"].design] * 2),
    "a design that cannot stand": lambda: pm.trace(pm.PAPER_CASES["C"].design.replace({"thigh_length_m": 0.1})),
    "rules that the calibration refuses": lambda: pm.simulate(
        pm.PAPER_CASES["C"].design, calibration="paper", rules="iso6336"
    ),
    "a missing database": lambda: pm.load_study("nowhere.db"),
    "a database that is a number": lambda: pm.load_study(5),
    "a study without a budget": lambda: pm.Study.define(name="mine"),
    "an unknown key": lambda: pm.Study.define(name="mine", evaluations=10, moter="U8"),
    "an algorithm that is a number": lambda: pm.Study.define(name="mine", evaluations=10, algorithm=5),
    "a study file that is a number": lambda: pm.run(5),
    "a study without a database": lambda: pm.run(pm.Study.define(name="mine", evaluations=10)),
    "constraints that are a list": lambda: pm.run(
        pm.Study.define(name="mine", evaluations=10), "x.db", constraints=["mass_kg"]
    ),
    "a design to export that is a trial": lambda: pm.export(5, "out"),
    "a report of nothing": lambda: pm.write_report([], "out.html"),
    "a front of nothing": lambda: pm.plot_front([]),
    "no map": pm.plot_actuators,
    "an unknown backend": lambda: pm.plot_actuators(pm.actuator_map(), backend="bokeh"),
}


@pytest.mark.parametrize("call", WRONG.values(), ids=WRONG.keys())
def test_what_is_wrong_is_said_in_one_line_of_ours(call, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(ParetoMonopedError) as caught:
        call()
    assert "\n" not in str(caught.value)
    assert list(tmp_path.iterdir()) == []

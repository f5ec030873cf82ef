import ast
from pathlib import Path

import numpy as np
import pytest

from pareto_monoped import errors


@pytest.mark.parametrize(
    "name",
    ["DesignError", "MotorError", "CalibrationError", "StudyError", "DatabaseError", "SelectionError", "OutputError"],
)
def test_wrong_input_ends_with_code_2(name):
    assert issubclass(getattr(errors, name), errors.InputError)
    assert getattr(errors, name).exit_code == 2


@pytest.mark.parametrize("name", ["ParetoMonopedError", "SimulationError", "CheckError"])
def test_a_failure_while_running_ends_with_code_1(name):
    assert getattr(errors, name).exit_code == 1


PACKAGE = Path(errors.__file__).parent
OURS = {name for name in dir(errors) if name.endswith("Error")} | {"UsageError", "BadParameter"}
CURED_BY = {"complaint", "complaint_of", "unknown_name", "_unmet", "_unmet_together", "other_designs"}
"""Functions whose messages end with their cure."""


def raised(path):
    """The errors of ours that a file makes with a message of its own."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Call) and node.args:
            name = node.func.attr if isinstance(node.func, ast.Attribute) else getattr(node.func, "id", "")
            # sqlite3.DatabaseError and its like are told by our own errors.
            foreign = isinstance(node.func, ast.Attribute) and getattr(node.func.value, "id", "") == "sqlite3"
            if name in OURS and not foreign:
                yield node


def has_cure(node):
    """Whether something follows the semicolon, or the message is made elsewhere."""
    if isinstance(node.args[0], ast.Name | ast.Attribute):
        return True
    calls = [one.func for one in ast.walk(node) if isinstance(one, ast.Call)]
    called = {getattr(one, "id", getattr(one, "attr", "")) for one in calls}
    parts = [one.value for one in ast.walk(node) if isinstance(one, ast.Constant) and isinstance(one.value, str)]
    literals = [one for one in ast.walk(node) if isinstance(one, ast.FormattedValue)]
    only_names = not "".join(parts).strip(" :;") and bool(literals)
    return bool(called & CURED_BY) or any("; " in part for part in parts) or only_names


def test_every_error_has_a_cure():
    """Each message in the package says, after a semicolon, what to do about it."""
    found = {path: list(raised(path)) for path in PACKAGE.rglob("*.py")}
    assert sum(map(len, found.values())) > 150
    without = [
        f"{path.relative_to(PACKAGE)}:{node.lineno}: {ast.unparse(node)}"
        for path, nodes in found.items()
        for node in nodes
        if not has_cure(node)
    ]
    assert without == []


@pytest.mark.parametrize(
    ("given", "cure"),
    [("hip_ration", "did you mean 'hip_ratio'?"), ("HIP_RATIO", "did you mean 'hip_ratio'?"), (7, "correct the name")],
)
def test_a_misspelt_name_is_told_the_right_one(given, cure):
    said = errors.unknown_name("variable", given, ("hip_ratio", "mass_kg"), ", or none")
    assert said == f"variable = {given!r}: must be one of hip_ratio, mass_kg, or none; {cure}"


class Large:
    def __repr__(self):
        return "word " * 100


@pytest.mark.parametrize(
    ("value", "seen"),
    [
        ("word", "'word'"),
        ((5, 7), "(5, 7)"),
        (Large, "<class 'tests.test_errors.Large'>"),
        (Large(), "Large"),
        (np.ones((30, 3)), "ndarray"),
        (object(), "<object object>"),
        ("a" * 500, "'" + "a" * 399 + "..."),
    ],
)
def test_a_value_is_shown_in_a_few_words_without_an_address(value, seen):
    assert errors.shown(value) == seen

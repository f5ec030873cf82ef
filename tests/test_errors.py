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

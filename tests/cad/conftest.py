import pytest

from pareto_monoped.actuator.search import map_for
from pareto_monoped.cad.assembly import Pose
from pareto_monoped.cad.export import export_design
from pareto_monoped.cad.product import build_product
from pareto_monoped.design import PAPER_CASES
from pareto_monoped.jump.calibration import load_calibration
from pareto_monoped.robot.build import build_robot
from tests.conftest import without_checks


@pytest.fixture(scope="session")
def actuator_map():
    return map_for("VT8020")


@pytest.fixture(scope="session")
def calibration():
    return load_calibration("reference")


@pytest.fixture(scope="session")
def product(actuator_map):
    """Case A: the five-planet ISSPG at the hip, an ESSPG at the knee."""
    return build_product(build_robot(PAPER_CASES["A"].design, actuator_map), Pose(hip_rad=-0.7, knee_rad=1.5))


@pytest.fixture(scope="session")
def exported(actuator_map, calibration, made_once):
    """Case C with every format, its lengths off the grid of 0.1 mm and its ratios inside their intervals.

    Without the checks: the exports of ``test_strength.py`` have passed them.
    """
    design = PAPER_CASES["C"].design.replace(
        {"thigh_length_m": 0.490037, "shank_length_m": 0.359962, "knee_ratio": 6.07, "hip_ratio": 4.031}
    )

    def make(place):
        with without_checks():
            return export_design(design, actuator_map, calibration, place / "case_c", source={"case": "C"})

    return made_once("export", make)


def pytest_collection_modifyitems(items):
    for item in items:
        if "tests/cad/" in item.path.as_posix():
            item.add_marker(pytest.mark.cad)

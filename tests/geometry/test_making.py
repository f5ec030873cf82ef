"""What parts tell the workshop besides their shape agrees with their shape."""

import re

import numpy as np
import pytest

from pareto_monoped.actuator.actuator import build_actuator
from pareto_monoped.actuator.search import map_for
from pareto_monoped.design import PAPER_CASES, RULE_SETS
from pareto_monoped.geometry.making import Fit, raceway_note
from pareto_monoped.geometry.roles import FASTENERS
from pareto_monoped.geometry.shapes import Circle, Pattern
from pareto_monoped.materials import ALLOYS
from pareto_monoped.robot.build import build_robot

METALS = ("aluminium", "steel")


@pytest.fixture(params=RULE_SETS, scope="module")
def parts(request):
    robots = [build_robot(PAPER_CASES[case].design, map_for("VT8020", request.param)) for case in ("A", "C")]
    return [part for robot in robots for unit in robot.units for part in unit.parts]


def diameters(part):
    shapes = [shape for prism in part.prisms for shape in (prism.outline, *prism.holes)]
    return [2.0 * float(shape.radius_mm) for shape in shapes if isinstance(shape, Circle | Pattern)]


def test_every_fit_is_of_a_face_that_the_part_has(parts):
    fitted = [part for part in parts if part.fits]
    assert len(fitted) > 10
    for part in fitted:
        for fit in part.fits:
            assert any(fit.holds(diameter) for diameter in diameters(part)), (part.name, fit.text)


@pytest.mark.parametrize("family", ["ISSPG", "ESSPG"])
def test_fits_of_both_families_are_of_faces_that_the_part_has(family):
    """The paper's cases have but one of the two at some joints."""
    found = map_for("VT8020", "iso6336")
    best = next(
        one.best for entry in found.entries for name, one in entry.families.items() if name == family and one.best
    )
    actuator = build_actuator(found.motor, family, best.gears, found.settings, best.face_width_mm)
    fitted = [(part, fit) for part in actuator.parts for fit in part.fits]
    assert len(fitted) > 10
    for part, fit in fitted:
        assert any(fit.holds(diameter) for diameter in diameters(part)), (part.name, fit.text)


def test_every_made_metal_part_names_its_alloy(parts):
    made = [part for part in parts if part.process in ("machined", "laser cut") and part.material.name in METALS]
    assert len(made) > 20
    assert [part.name for part in made if part.grade is None] == []


def test_every_screw_says_how_tight_and_what_locks_it(parts):
    screws = [part for part in parts if part.role in FASTENERS]
    assert len(screws) > 20
    for part in screws:
        fastening = part.fastening
        (order, *_) = part.purchases
        assert order.kind == "screw"
        assert f" - M{fastening.thread.diameter_mm:g} x " in order.designation
        assert order.designation.endswith(f" - {fastening.property_class}")
        assert 0.2 < fastening.torque_n_m < 10.0
        assert fastening.lock
    assert all(part.fastening is None or part.role in FASTENERS for part in parts)


def test_alloys_are_those_of_their_standards():
    """EN 755-2: 250 MPa for EN AW-6082 T6 in bars, at least 460 MPa for EN AW-7075 T6 (EN 485-2, to 12.5 mm)."""
    assert ALLOYS["aw_6082_t6"].yield_mpa == 250.0
    assert ALLOYS["aw_7075_t6"].yield_mpa == 460.0
    assert all(re.search(r"\d (HBW|HV|HRC)\b", alloy.hardness) for alloy in ALLOYS.values())


def test_a_fit_prints_its_number_only_for_a_single_part():
    assert Fit(diameter_mm=40.0, zone="h6").text == "40 h6"
    assert Fit(diameter_mm=np.array([40.0, 50.0]), zone="h6").text == ""


def test_a_raceway_is_round_within_a_quarter_of_its_tolerance():
    """SKF asks for a quarter round and half cylindrical: 0.025 and 0.05 of 0.1 mm."""
    assert "round within 0.025 mm, cylindrical within 0.050 mm" in raceway_note(0.1)

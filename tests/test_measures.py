"""One table of measures, which the results of a jump, of an audit and the report's labels follow."""

from dataclasses import fields
from typing import get_args, get_type_hints

import numpy as np
import pytest
from numpy.typing import NDArray

from pareto_monoped.jump.audit import Audits
from pareto_monoped.jump.evaluate import Evaluations
from pareto_monoped.jump.screen import Screened
from pareto_monoped.measures import (
    AUDIT_MEASURES,
    ENERGIES,
    MEASURE_NAMES,
    MEASURES,
    ROBUST_MEASURES,
    SCREEN_MEASURES,
    measure,
)
from pareto_monoped.report.quantities import QUANTITIES, label_of

UNITS = {
    "_m": "m",
    "_n_m": "N m",
    "_n": "N",
    "_j": "J",
    "_s": "s",
    "_kg": "kg",
    "_eur": "EUR",
    "_rad_per_s": "rad/s",
    "_m_per_s": "m/s",
    "_w": "W",
    "_per_minute": "1/min",
}


OF_THE_JUMP = {"status", "reason", "height_m", "energy_j"}


@pytest.mark.parametrize(
    ("results", "table"), [(Evaluations, MEASURES), (Audits, AUDIT_MEASURES), (Screened, SCREEN_MEASURES)]
)
def test_no_field_of_results_lacks_its_description(results, table):
    names = [f.name for f in fields(results)]
    assert [name for name in names if name not in OF_THE_JUMP] == [m.name for m in table if m.name not in OF_THE_JUMP]


@pytest.mark.parametrize("table", [MEASURES, (*AUDIT_MEASURES, *SCREEN_MEASURES)])
def test_no_two_measures_have_one_place_on_the_page(table):
    places = [entry.place for entry in table if entry.place is not None]
    assert len(set(places)) == len(places) > 0


def test_a_statistic_is_no_choice_of_the_page_by_itself():
    """Of a measure under uncertainty, the page shows what a study asks for."""
    for entry in ROBUST_MEASURES:
        assert entry.place is None, entry.name
        assert not any((entry.leading, entry.full, entry.axis, entry.work_share)), entry.name


def test_the_energies_of_a_jump_are_work_of_the_motors_or_of_the_battery():
    assert ENERGIES == ("energy_j", "electrical_energy_j")
    assert set(ENERGIES) <= {entry.name for entry in MEASURES if entry.unit == "J" and entry.direction == "minimise"}


def test_editors_know_the_fields():
    """Each is an array to whoever reads the class, with its description beside it."""
    hints = get_type_hints(Evaluations, include_extras=True)
    for entry in MEASURES:
        kind, about = get_args(hints[entry.name])
        assert kind == NDArray[np.float64]
        assert about.meaning == entry.meaning


@pytest.mark.parametrize("entry", [*MEASURES, *AUDIT_MEASURES, *SCREEN_MEASURES], ids=lambda entry: entry.name)
def test_a_name_ends_in_its_unit(entry):
    suffix = max((end for end in UNITS if entry.name.endswith(end)), key=len, default=None)
    assert entry.unit == (UNITS[suffix] if suffix else "1")
    assert (entry.shown_unit, entry.scale) in {(entry.unit, 1.0), ("mm", 1000.0), ("%", 100.0)}
    assert entry.meaning
    assert entry.label


def test_directions():
    """The paper's objectives, and what the search's optional limits ask for."""
    better = {entry.name: entry.direction for entry in MEASURES}
    assert [name for name in better if better[name] == "maximise"] == [
        "height_m",
        "foot_clearance_m",
        "efficiency",
        "sustained_jumps_per_minute",
        "gear_safety",
        "chain_safety",
        "stop_safety",
        "joint_safety",
        "link_safety",
        "gear_strike_safety",
        "agility_m_per_s",
        "rise_m",
        "above_standing_m",
    ]
    assert [name for name in better if better[name] is None] == ["lift_off_s", "apex_s"]


def test_the_report_calls_measures_by_their_labels():
    shown = {quantity.name: quantity for quantity in QUANTITIES}
    for entry in MEASURES:
        quantity = shown[entry.name]
        assert (quantity.label, quantity.unit, quantity.decimals, quantity.scale) == (
            label_of(entry.name),
            entry.shown_unit,
            entry.decimals,
            entry.scale,
        )
    # On the page, the energy and the efficiency say that they are the mechanical ones.
    assert {name for name in shown if name in MEASURE_NAMES and label_of(name) != measure(name).label} == {
        "energy_j",
        "efficiency",
    }
    for entry in (*AUDIT_MEASURES, *SCREEN_MEASURES):
        if entry.name in shown:
            assert (shown[entry.name].label, shown[entry.name].unit) == (entry.label, entry.shown_unit)


def test_text_is_in_the_shown_unit():
    assert measure("foot_clearance_m").text(0.1234) == "123 mm"
    assert measure("efficiency").text(0.5678) == "56.8 %"
    assert measure("energy_j").text(31.444) == "31.44 J"


def test_an_unknown_measure_is_a_key_error():
    with pytest.raises(KeyError, match="nonsense"):
        measure("nonsense")

"""One table of measures, which the results of a jump, of an audit and the report's labels follow."""

from dataclasses import fields

import pytest

from pareto_monoped.jump.audit import Audits
from pareto_monoped.jump.evaluate import Evaluations
from pareto_monoped.jump.screen import Screened
from pareto_monoped.measures import AUDIT_MEASURES, MEASURE_NAMES, MEASURES, SCREEN_MEASURES, measure
from pareto_monoped.report.quantities import QUANTITIES, label_of

UNITS = {
    "_m": "m",
    "_n_m": "N m",
    "_n": "N",
    "_j": "J",
    "_s": "s",
    "_kg": "kg",
    "_rad_per_s": "rad/s",
    "_m_per_s": "m/s",
    "_w": "W",
    "_per_minute": "1/min",
}


def test_evaluations_have_one_field_per_measure():
    assert [f.name for f in fields(Evaluations)] == ["status", "reason", *MEASURE_NAMES]


def test_audits_have_one_field_per_measure():
    names = [entry.name for entry in AUDIT_MEASURES]
    assert [f.name for f in fields(Audits)] == ["status", "height_m", "energy_j", *names, "reason"]


def test_screens_have_one_field_per_measure():
    assert [f.name for f in fields(Screened)] == [entry.name for entry in SCREEN_MEASURES]


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

from pareto_monoped.design import NAMES
from pareto_monoped.measures import AUDIT_MEASURES, MEASURES, SCREEN_MEASURES, measure
from pareto_monoped.report.quantities import AUDIT, EVERY_TRIAL, QUANTITIES, label_of


def test_every_variable_and_measure_is_shown_once():
    names = [q.name for q in QUANTITIES]
    assert sorted(names) == sorted((*NAMES, *(m.name for m in MEASURES), *AUDIT))
    assert set(AUDIT) <= {m.name for m in (*AUDIT_MEASURES, *SCREEN_MEASURES)}
    assert set(EVERY_TRIAL) <= {m.name for m in MEASURES}


def test_labels_and_units_of_measures_are_those_of_the_table():
    for q in QUANTITIES:
        if q.name not in NAMES:
            m = measure(q.name)
            assert (q.label, q.unit, q.decimals, q.scale) == (label_of(m.name), m.shown_unit, m.decimals, m.scale)


def test_labels_say_which_energy_is_meant_and_are_else_those_of_the_table():
    assert label_of("energy_j") == "mechanical energy"
    assert label_of("efficiency") == f"mechanical {measure('efficiency').label}"
    others = [m for m in MEASURES if m.name not in ("energy_j", "efficiency")]
    assert all(label_of(m.name) == m.label for m in others)
    assert len({q.label for q in QUANTITIES}) == len(QUANTITIES)

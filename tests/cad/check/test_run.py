"""All checks together: what they are called, that a sound robot passes them, and what they report."""

import json

import pytest

from pareto_monoped.cad.check import result
from pareto_monoped.cad.check.result import Finding, Limit, count_of, worst_of
from pareto_monoped.cad.write.tables import checks_record

NAMES = [
    "solids are valid",
    "meshes are watertight",
    "meshes have the volumes of their parts",
    "parts weigh what was simulated",
    *(f"{body} is the body that was simulated" for body in ("base", "thigh", "shank")),
    *(f"{body} has the centre of mass that was simulated" for body in ("base", "thigh", "shank")),
    *(f"{body} has the inertia that was simulated" for body in ("base", "thigh", "shank")),
    "no two parts overlap",
    "gears mesh on their driving flanks",
    "the leg moves freely",
    "end stops meet at the ends of the ranges",
    "the shank passes the base",
    "bolt patterns coincide",
    "bolts join parts",
    "heads have countersinks and screws have threads",
    "every part is held",
    "parts assemble and turn at the worst of their limits",
    "slots can be cut",
    "windows can be milled",
    "walls can be made",
    "taps run out over whole floors",
    "grooves of retaining rings have collars",
    "fits can be gauged",
    "ground shafts have centres and reliefs",
    "ground shafts have a datum axis",
]


def test_a_sound_robot_passes_every_check(examine):
    checks = examine()
    assert list(checks) == NAMES
    assert [failure for check in checks.values() for failure in check.failures] == []
    for check in checks.values():
        assert check.measured >= check.limit if check.at_least else check.measured <= check.limit, check.name


def test_every_limit_of_the_table_is_used(examine):
    """Strength has one of its own module, which reads the jump and not the parts."""
    table = [entry for entry in vars(result).values() if isinstance(entry, Limit) and entry is not result.STRENGTH]
    checks = examine()
    for limit in table:
        for body in ("base", "thigh", "shank"):
            check = checks[limit.of(body).name]
            assert (check.limit, check.unit, check.at_least) == (limit.value, limit.unit, limit.at_least)


def test_the_record_tells_limit_measured_value_and_unit(examine):
    rows = json.loads(checks_record(tuple(examine().values())))
    assert [row["check"] for row in rows] == NAMES
    row = next(row for row in rows if row["check"] == "meshes have the volumes of their parts")
    assert row["passed"] is True
    assert (row["limit"], row["unit"]) == (1.0, "%")
    assert 0.1 < row["measured"] < 1.0
    assert row["worst"] == f"{row['measured']:.3f} % (allowed: at most 1)"


MOST = Limit(name="gap", value=0.5, unit="mm")
LEAST = Limit(name="gap", value=0.5, unit="mm", at_least=True)


@pytest.mark.parametrize(
    ("limit", "values", "measured", "failures"),
    [
        (MOST, (0.1, 0.5), 0.5, ()),
        (MOST, (0.6, 0.1, 0.7), 0.7, ("0.7", "0.6")),
        (LEAST, (0.5, 0.9), 0.5, ()),
        (LEAST, (0.4, 0.9, 0.3), 0.3, ("0.3", "0.4")),
        (MOST, (), 0.0, ()),
        (LEAST, (), 0.5, ()),
        (MOST, (float("nan"),), float("nan"), ("nan",)),
    ],
)
def test_values_beyond_a_limit_are_failures_the_worst_first(limit, values, measured, failures):
    check = worst_of(limit, "gaps", [Finding(value=value, text=str(value)) for value in values])
    assert check.measured == pytest.approx(measured, nan_ok=True)
    assert check.failures == failures
    assert check.passed == (not failures)


def test_failures_are_counted():
    check = count_of(Limit(name="whole", value=0, unit="broken parts"), "3 parts", ["a is broken", "b is broken"])
    assert (check.measured, check.passed) == (2.0, False)
    assert check.worst == "2 broken parts (allowed: at most 0)"

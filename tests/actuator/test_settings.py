import pytest

from pareto_monoped.actuator.settings import ActuatorSettings, default_parts
from pareto_monoped.errors import InputError


def test_design_is_by_iso_6336_with_three_planets_unless_asked_otherwise():
    assert ActuatorSettings().rules == "iso6336"
    assert ActuatorSettings().planets_least == 3


def test_the_rules_paper_have_the_papers_limits():
    settings = ActuatorSettings(rules="paper")
    assert (settings.planets_least, settings.planets_max, settings.teeth_min) == (2, 7, 18)
    assert (settings.planet_gap_mm, settings.diameter_clearance_mm) == (5.0, 10.0)
    assert min(settings.modules_mm) == 0.5
    assert max(settings.modules_mm) <= 1.2


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"constraints_off": frozenset({"sun_rimm"})}, "constraints_off = 'sun_rimm': must be one of .*sun_rim"),
        ({"modules_mm": ()}, "modules_mm"),
        ({"modules_mm": (0.5, -1.0)}, "modules_mm"),
        ({"planets_min": 1}, "planets_min, planets_max = 1, 7"),
        ({"planets_min": 5, "planets_max": 4}, "planets_min, planets_max = 5, 4"),
    ],
)
def test_impossible_settings_are_refused(changes, words):
    with pytest.raises(InputError, match=words):
        ActuatorSettings(**changes)


def test_part_data_is_complete_and_checked():
    parts = default_parts()
    assert parts.gears.factor_of_safety == 1.2
    assert parts.carrier.pin_diameter_mm == 6.0

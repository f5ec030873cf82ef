import math
from dataclasses import asdict

import pytest

from pareto_monoped.actuator.service.data import ServiceData, default_service
from pareto_monoped.config import checked
from pareto_monoped.errors import InputError


def test_turns_per_hour_by_hand():
    """Ten jumps per minute of 3 rad each: 1800 rad per hour."""
    assert default_service().output_turns_per_hour == pytest.approx(1800.0 / (2.0 * math.pi))


@pytest.mark.parametrize(
    ("wrong", "words"),
    [
        ({"output_angles_rad": (1.0,)}, ("2 and 1", "one per level")),
        ({"torque_shares": (1.5, 0.5)}, ("torque_shares.0 = 1.5",)),
        ({"jumps_per_minute": 0.0}, ("jumps_per_minute = 0.0",)),
        ({"overload_factor": 0.5}, ("overload_factor = 0.5",)),
        ({"chain_radius": 1.0}, ("chain_radius", "chain_radius_mm")),
    ],
)
def test_wrong_values_are_refused_in_one_line(wrong, words):
    with pytest.raises(InputError) as caught:
        checked(ServiceData, asdict(default_service()) | wrong, source="service data")
    assert "\n" not in str(caught.value)
    for word in words:
        assert word in str(caught.value)


def test_every_value_has_its_source_beside_it():
    from importlib import resources

    lines = (resources.files("pareto_monoped") / "data" / "service.toml").read_text().splitlines()
    for above, line in zip(["", *lines], lines, strict=False):
        if "=" in line and not line.startswith("#"):
            assert "#" in line or above.startswith("#"), line

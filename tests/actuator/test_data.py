from dataclasses import asdict
from importlib import resources

import pytest

from pareto_monoped.actuator.assumptions import ServiceData, default_service
from pareto_monoped.config import checked
from pareto_monoped.errors import InputError


@pytest.mark.parametrize(
    ("wrong", "words"),
    [
        ({"jumps_per_minute": 0.0}, ("jumps_per_minute = 0.0",)),
        ({"foot_force_n": -1.0}, ("foot_force_n = -1.0",)),
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
    lines = (resources.files("pareto_monoped") / "data" / "service.toml").read_text().splitlines()
    for above, line in zip(["", *lines], lines, strict=False):
        if "=" in line and not line.startswith("#"):
            assert "#" in line or above.startswith("#"), line

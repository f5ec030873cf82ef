import pytest

from tests.cad.check.faults import with_facts


# Made and bought, once and several times in the robot.
@pytest.mark.parametrize("name", ["knee_axle", "knee_bearing", "thigh_standoff"])
def test_an_invalid_solid_is_named(product, examine, failing, name):
    broken = with_facts(product, name, valid=False)
    assert failing(product=broken) == ["solids are valid"]
    check = examine(product=broken)["solids are valid"]
    assert check.failures == (f"{name}: its solid is not valid",)
    assert check.measured == 1.0

from tests.cad.check.faults import with_facts


def test_an_invalid_solid_is_named(product, examine, failing):
    broken = with_facts(product, "knee_axle", valid=False)
    assert failing(product=broken) == ["solids are valid"]
    check = examine(product=broken)["solids are valid"]
    assert check.failures == ("knee_axle: its solid is not valid",)
    assert check.measured == 1.0

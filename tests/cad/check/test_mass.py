"""Masses of parts and bodies, each beyond its limit and just within it."""

import dataclasses

import pytest

from pareto_monoped.cad.check.mass import weigh_bodies, weigh_parts
from tests.cad.check.faults import with_facts

BODIES = ("base", "thigh", "shank")


def swollen(factor):
    """A solid of the same shape and place with more volume."""
    return {"volume_mm3": lambda value: factor * value, "inertia_mm5": lambda value: factor * value}


# A standoff is so light that its body does not notice. A bearing weighs what its catalogue says whatever its envelope.
@pytest.mark.parametrize("name", ["thigh_standoff", "knee_bearing"])
def test_a_part_that_is_larger_than_its_record_is_named(product, examine, failing, name):
    broken = with_facts(product, name, **swollen(1.011))
    assert failing(product=broken) == ["parts weigh what was simulated"]
    check = examine(product=broken)["parts weigh what was simulated"]
    (text,) = check.failures
    assert text.startswith(f"{name}: CAD ")
    assert text.endswith("1.10% off")
    assert check.measured == pytest.approx(1.1, abs=0.02)
    assert failing(product=with_facts(product, name, **swollen(1.009))) == []
    assert failing(product=with_facts(product, name, **swollen(0.989))) == ["parts weigh what was simulated"]


@pytest.mark.parametrize("body", BODIES)
@pytest.mark.parametrize("factor", [1.006, 0.994])
def test_a_body_that_weighs_something_else_is_named(arrays, examine, failing, body, factor):
    broken = scaled(arrays, body, factor)
    assert failing(arrays=broken) == [f"{body} is the body that was simulated"]
    (text,) = examine(arrays=broken)[f"{body} is the body that was simulated"].failures
    assert f"simulated {broken.body_mass_kg[0, BODIES.index(body)]:.4f} kg" in text
    assert failing(arrays=scaled(arrays, body, 1.0 + 0.8 * (factor - 1.0))) == []


def scaled(arrays, body, factor):
    mass = arrays.body_mass_kg.copy()
    mass[0, BODIES.index(body)] *= factor
    return dataclasses.replace(arrays, body_mass_kg=mass)


def test_bodies_are_weighed_by_their_instances(product):
    fewer = tuple(instance.name != "foot/foot" for instance in product.instances)
    broken = dataclasses.replace(
        product,
        instances=tuple(i for i, kept in zip(product.instances, fewer, strict=True) if kept),
        kinds=tuple(k for k, kept in zip(product.kinds, fewer, strict=True) if kept),
    )
    whole, without = (weigh_bodies(found, weigh_parts(found))["shank"].mass_kg for found in (product, broken))
    foot = next(kind for kind in product.unique if kind.name == "foot")
    assert whole - without == pytest.approx(float(foot.part.unit_mass_kg()), rel=1e-4)

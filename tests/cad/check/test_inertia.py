"""Inertia tensors: each entry by itself, off the diagonal too."""

import dataclasses

import numpy as np
import pytest

from pareto_monoped.cad.check.mass import check_inertia, weigh_bodies, weigh_parts

BODIES = ("base", "thigh", "shank")
ENTRIES = [(i, j) for i in range(3) for j in range(i, 3)]


def changed(arrays, body, i, j, share):
    """One entry of a tensor changed by a share of the root of the two moments that bound it."""
    tensors = arrays.body_inertia_kg_m2.copy()
    tensor = tensors[0, BODIES.index(body)]
    step = share * np.sqrt(tensor[i, i] * tensor[j, j])
    tensor[i, j] += step
    if i != j:
        tensor[j, i] += step
    return dataclasses.replace(arrays, body_inertia_kg_m2=tensors)


@pytest.fixture(scope="module")
def weighed(product):
    return weigh_bodies(product, weigh_parts(product))


@pytest.mark.parametrize("body", BODIES)
@pytest.mark.parametrize(("i", "j"), ENTRIES)
def test_a_wrong_entry_is_named(arrays, weighed, body, i, j):
    for share in (0.045, -0.045):
        (check,) = (one for one in check_inertia(weighed, changed(arrays, body, i, j, share)) if not one.passed)
        assert check.name == f"{body} has the inertia that was simulated"
        (text,) = check.failures
        assert text.startswith(f"{body}: inertia {'xyz'[i]}{'xyz'[j]} 4.")
    assert all(check.passed for check in check_inertia(weighed, changed(arrays, body, i, j, 0.025)))


def test_a_wrong_entry_is_the_only_failure(arrays, failing):
    assert failing(arrays=changed(arrays, "shank", 0, 2, 0.045)) == ["shank has the inertia that was simulated"]


def test_the_limit_lies_well_above_what_a_sound_robot_has(examine):
    for body in BODIES:
        assert examine()[f"{body} has the inertia that was simulated"].measured < 1.1

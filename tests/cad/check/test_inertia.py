"""Inertia tensors: each entry by itself, off the diagonal too."""

import dataclasses

import numpy as np
import pytest

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


@pytest.mark.parametrize("body", BODIES)
@pytest.mark.parametrize(("i", "j"), ENTRIES)
def test_a_wrong_entry_is_named(arrays, examine, failing, body, i, j):
    name = f"{body} has the inertia that was simulated"
    for share in (0.045, -0.045):
        broken = changed(arrays, body, i, j, share)
        assert failing(arrays=broken) == [name]
        (text,) = examine(arrays=broken)[name].failures
        assert text.startswith(f"{body}: inertia {'xyz'[i]}{'xyz'[j]} 4.")
    assert failing(arrays=changed(arrays, body, i, j, 0.025)) == []


def test_the_limit_lies_well_above_what_a_sound_robot_has(examine):
    for body in BODIES:
        assert examine()[f"{body} has the inertia that was simulated"].measured < 1.1

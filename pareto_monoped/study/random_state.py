"""State of NumPy's random generators as plain JSON values."""

from typing import Any

import numpy as np


def generator_state(generator: np.random.Generator) -> dict[str, Any]:
    """State of a PCG64 generator as plain JSON values."""
    state = dict(generator.bit_generator.state)
    return {**state, "state": dict(state["state"])}


def set_generator_state(generator: np.random.Generator, state: dict[str, Any]) -> None:
    """Set a generator to a state from ``generator_state``; NumPy refuses a damaged one."""
    generator.bit_generator.state = state

"""Bushes of planets under the rules of the paper: what is bought makes up the length that is drawn."""

import re

import pytest

from pareto_monoped.actuator.search import map_for


def test_bushes_of_the_catalogue_make_the_drawn_one():
    found = [entry.actuator for entry in map_for("VT8020", rules="paper").entries if entry.actuator is not None]
    assert len(found) > 40
    for actuator in found[::4]:
        (bush,) = (part for part in actuator.parts if part.name == "planet_bush")
        (tube,) = bush.prisms
        length = float(tube.z1_mm - tube.z0_mm)
        (order,) = bush.purchases
        bought = float(re.fullmatch(r"PTFE bronze bush ISO 3547 - 6 x 8 x (\d+) mm", order.designation)[1])
        pieces, cut = order.count, float(re.fullmatch(r"cut to ([\d.]+) mm", order.remark)[1])
        assert pieces * cut == pytest.approx(length, abs=0.05 * pieces)
        assert bought in (4.0, 6.0, 8.0, 10.0)
        assert cut - 0.05 <= bought < cut + 2.05  # the next longer one
        assert (pieces - 1) * 10.0 < length  # no more pieces than needed
        (hole,) = tube.holes
        assert (2.0 * hole.radius_mm, 2.0 * tube.outline.radius_mm) == (6.0, 8.0)

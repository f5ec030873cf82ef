"""Heads without a countersink and screws without a thread are found."""

import dataclasses

import pytest

from pareto_monoped.cad.check import screws
from pareto_monoped.geometry.features import Hole
from pareto_monoped.geometry.screws import M3, M4, M25
from tests.cad.check.faults import with_instance

NAME = "heads have countersinks and screws have threads"


def changed(product, name, change):
    """The product with the holes of one instance changed or, for None, without their record."""

    def new(instance):
        holes = [change(f) if isinstance(f, Hole) else f for f in instance.part.features]
        part = dataclasses.replace(instance.part, features=tuple(hole for hole in holes if hole is not None))
        return dataclasses.replace(instance, part=part)

    return with_instance(product, name, new)


def plain(hole):
    return dataclasses.replace(hole, low=None, high=None)


def narrower(hole):
    if hole.low is None:
        return hole
    return dataclasses.replace(hole, low=dataclasses.replace(hole.low, radius_mm=hole.low.radius_mm - 0.2))


def turned_round(hole):
    return dataclasses.replace(hole, low=hole.high, high=hole.low)


@pytest.mark.parametrize("change", [plain, narrower, turned_round, lambda _: None])
def test_a_head_without_its_countersink_is_found(product, change):
    check = screws.check_seats(changed(product, "thigh/thigh_plate_inner", change))
    assert check.name == NAME
    failures = check.failures
    assert any(text.startswith("thigh/knee_cup_screw_near_1: no countersink of 5.50 mm") for text in failures)
    assert any(text.startswith("thigh/thigh_bolt_1: no countersink of 6.72 mm") for text in failures)


@pytest.mark.long
def test_a_narrow_countersink_is_the_only_failure(product, failing):
    assert failing(product=changed(product, "thigh/thigh_plate_inner", narrower)) == [NAME]


@pytest.mark.parametrize("thread", [None, M4.thread, M25.thread])
def test_a_screw_without_its_thread_is_found(product, thread):
    def retapped(hole):
        return dataclasses.replace(hole, thread=thread) if hole.thread == M3.thread else hole

    check = screws.check_seats(changed(product, "hip_actuator/carrier", retapped))
    assert not check.passed
    assert check.measured == len(check.failures)
    assert all("no thread M3 in hip_actuator/carrier" in text for text in check.failures)


def test_all_screws_of_the_robot_are_looked_at(product):
    check = screws.check_seats(product)
    assert check.passed
    fasteners = [i for i in product.instances if "screw" in i.name or "bolt" in i.name]
    assert check.looked_at == f"{len(fasteners)} screws and bolts"

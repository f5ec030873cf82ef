"""The kernel's process answers, says what went wrong, and is replaced when it dies."""

import dataclasses
import os
import signal
import time

import numpy as np
import pytest

from pareto_monoped.cad.kernel import client as kernel
from pareto_monoped.geometry.parts import Part, Prism
from pareto_monoped.geometry.roles import Role
from pareto_monoped.geometry.shapes import Circle, rectangle
from pareto_monoped.materials import Material

STEEL = Material(name="steel", density_kg_per_m3=7850.0, colour=(0.5, 0.5, 0.5))
PLATE = Part(
    name="plate",
    role=Role.PLATE,
    material=STEEL,
    process="machined",
    prisms=(
        Prism(
            outline=rectangle(width_mm=20.0, height_mm=10.0),
            z0_mm=1.0,
            z1_mm=4.0,
            holes=(Circle(radius_mm=2.0, x_mm=5.0),),
        ),
    ),
)


@pytest.fixture(scope="module", autouse=True)
def own_kernel():
    """The kernel that dies here is not the one that has made the solids of other tests."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(kernel, "_kernel", None)
        patch.setattr(kernel, "_asked", [])
        yield
        if kernel._kernel is not None:
            kernel._kernel.kill()
            kernel._kernel.shutdown()


def program():
    """The kernel's process."""
    (line,) = kernel._process()._lines
    return line.process


def test_facts_of_a_plate_with_a_hole():
    (facts,) = kernel.solid_facts([PLATE]).result()
    volume = 20.0 * 10.0 * 3.0 - np.pi * 4.0 * 3.0
    assert facts.valid
    assert facts.bodies == 1
    assert facts.volume_mm3 == pytest.approx(volume, rel=1e-9)
    assert facts.centre_mm == pytest.approx([-np.pi * 4.0 * 3.0 * 5.0 / volume, 0.0, 2.5], abs=1e-9)
    # About z: the plate's less the disc's, moved to the common centre.
    disc = np.pi * 4.0 * 3.0
    about_origin = 600.0 * (20.0**2 + 10.0**2) / 12.0 - disc * (2.0 + 25.0)
    assert facts.inertia_mm5[2, 2] == pytest.approx(about_origin - volume * facts.centre_mm[0] ** 2, rel=1e-9)


def test_what_goes_wrong_there_is_raised_here_and_the_next_question_is_answered():
    bad = dataclasses.replace(PLATE, prisms=(dataclasses.replace(PLATE.prisms[0], outline="no shape"),))
    with pytest.raises(TypeError, match="no outline for a shape of kind str"):
        kernel.solid_facts([bad]).result()
    assert kernel.solid_facts([PLATE]).result()[0].valid


def test_any_function_is_called_there_and_its_exception_raised_here():
    assert kernel.do(os.getpid).result() == program().pid
    assert kernel.do(max, 3, 7).result() == 7
    with pytest.raises(ZeroDivisionError, match="division"):
        kernel.do(divmod, 1, 0).result()
    assert kernel.solid_facts([PLATE]).result()[0].valid


def test_a_kernel_that_dies_is_replaced():
    kernel.start()
    first = program()
    first.kill()
    with pytest.raises(RuntimeError, match=r"the CAD kernel's process ended \(exit code -9\)"):
        kernel.solid_facts([PLATE]).result()
    assert kernel.solid_facts([PLATE]).result()[0].valid
    assert program() is not first


def test_what_a_busy_kernel_has_not_begun_is_done_here_from_the_last():
    assert kernel.solid_facts([PLATE]).result()[0].valid
    process = program()
    process.send_signal(signal.SIGSTOP)
    try:
        begun, owed = kernel.do(os.getpid), kernel.solid_facts([PLATE])
        while len(kernel._process()._waiting) > 1:  # until the first is asked
            time.sleep(0.01)
        others = [
            kernel.do(os.getpid),
            kernel.do(divmod, 1, 0),
            kernel.do(time.monotonic_ns),
            kernel.do(time.monotonic_ns),
        ]
        kernel.help_out()
        assert [future.done() for future in (begun, owed, *others)] == [False, False, True, True, True, True]
        assert others[0].result() == os.getpid()
        with pytest.raises(ZeroDivisionError, match="division"):
            others[1].result()
        assert others[3].result() < others[2].result()
    finally:
        process.send_signal(signal.SIGCONT)
    # What only the kernel can answer waits for it.
    assert owed.result()[0].valid
    assert begun.result() == process.pid


def test_an_idle_kernel_is_kept():
    assert kernel.solid_facts([PLATE]).result()[0].valid
    before = kernel._process()
    kernel.give_up()
    assert kernel._process() is before


def test_a_kernel_that_owes_an_answer_is_given_up_without_waiting_and_nobody_is_started_to_help():
    kernel.start()
    first = program()
    first.send_signal(signal.SIGSTOP)
    owed = kernel.solid_facts([PLATE])
    kernel.give_up()
    assert first.returncode == -signal.SIGKILL
    with pytest.raises(RuntimeError, match="process ended"):
        owed.result()
    kernel.help_out()
    assert kernel._kernel is None
    assert kernel.solid_facts([PLATE]).result()[0].valid

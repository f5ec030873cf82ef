"""Who may jump for this process: the versions, the platform and every bit of the probe designs decide."""

import os
import platform
import subprocess
import sys
import threading
from dataclasses import fields, replace
from importlib.metadata import PackageNotFoundError

import numpy as np
import pytest

from pareto_monoped.compute.chunks import cores, task_threads
from pareto_monoped.errors import InputError
from pareto_monoped.jump import peers
from pareto_monoped.jump.calibration import calibration_names
from pareto_monoped.jump.evaluate import Evaluations, Evaluator


@pytest.fixture(scope="module")
def ours():
    return peers.facts()


def test_the_same_facts_are_no_complaint_and_are_the_same_each_time(ours):
    assert peers.complaint(replace(ours)) is None
    assert peers._numbers() == ours.numbers


@pytest.mark.parametrize("package", ["pareto-monoped", "mujoco", "numpy", "numba"])
def test_another_version_is_named_with_ours(ours, package):
    theirs = replace(ours, versions=ours.versions | {package: "0.0"})
    assert peers.complaint(theirs) == f"{package} 0.0, here {ours.versions[package]}"
    without = {name: text for name, text in ours.versions.items() if name != package}
    assert peers.complaint(replace(ours, versions=without)) == f"{package} None, here {ours.versions[package]}"


@pytest.mark.parametrize("package", ["cadquery-ocp-novtk", "manifold3d", "shapely"])
@pytest.mark.parametrize("there", ["0.0", None])
def test_what_makes_exports_is_compared_where_they_are_made(ours, monkeypatch, package, there):
    """A worker without the CAD kernel took exports and failed at them."""
    pytest.importorskip("OCP")
    known = peers.version

    def other(name):
        if name != package:
            return known(name)
        if there is None:
            raise PackageNotFoundError(name)
        return there

    with monkeypatch.context() as patched:
        patched.setattr(peers, "version", other)
        theirs = peers.greeting(1, "cad")
    assert peers.complaint(theirs, "cad") == f"{package} {there or 'missing'}, here {known(package)}"
    assert peers.complaint(theirs) is None
    assert peers.complaint(peers.greeting(1, "cad"), "cad") is None


def test_everything_that_differs_is_named_and_the_digest_last(ours):
    theirs = replace(ours, system="Plan9", machine="vax", numbers="0" * 64)
    assert peers.complaint(theirs) == f"system Plan9, here {ours.system}; machine vax, here {ours.machine}"
    digest = peers.complaint(replace(ours, numbers="f" * 64))
    assert digest == f"computes other jumps of the probe designs (digest ffffffff, here {ours.numbers[:8]})"


def test_other_jumps_by_other_linear_algebra_are_told_with_their_cure(ours):
    """Workers that SSH had started on the same machine were refused, without a word about why."""
    theirs = replace(ours, numbers="f" * 64, linear_algebra="Cooperlake")
    assert peers.complaint(theirs) == (
        f"computes other jumps of the probe designs (digest ffffffff, here {ours.numbers[:8]}; linear algebra for "
        f"Cooperlake, here {ours.linear_algebra}: set OPENBLAS_CORETYPE=Haswell where each process starts)"
    )
    assert peers.complaint(replace(ours, linear_algebra="Cooperlake")) is None


@pytest.mark.skipif(platform.machine() != "x86_64", reason="names kinds of these processors")
@pytest.mark.parametrize("kind", [pytest.param("Haswell", marks=pytest.mark.long), "Nehalem"])
def test_linear_algebra_is_named_as_it_was_chosen(kind):
    program = "from pareto_monoped.jump import peers; print(peers._linear_algebra())"
    environment = os.environ | {"OPENBLAS_CORETYPE": kind}
    done = subprocess.run([sys.executable, "-c", program], env=environment, capture_output=True, text=True, check=True)
    assert done.stdout.split() == [kind]


def _slightly(name, jumps):
    """The same jumps, of which one has another last bit, or another word, in a field."""
    values = np.array(getattr(jumps, name), dtype=object if name in ("status", "reason") else None)
    if name in ("status", "reason"):
        values[-1] = f"{values[-1]}x"
    elif values.dtype == bool:
        values.flat[-1] = not values.flat[-1]
    elif values.dtype.kind == "f":
        place = int(np.flatnonzero(np.isfinite(values))[-1])
        values.flat[place] = np.nextafter(values.flat[place], np.inf)
    else:
        values.flat[-1] += 1
    return replace(jumps, **{name: values})


@pytest.fixture(scope="module")
def jumps(ours):
    """The jumps of the probe designs under each calibration."""
    kept = {}
    with pytest.MonkeyPatch.context() as patched:

        class Kept(Evaluator):
            def __call__(self, designs):
                found = super().__call__(designs)
                kept[self.calibration.name] = found
                return found

        patched.setattr(peers, "Evaluator", Kept)
        assert peers._numbers() == ours.numbers
    return kept


def _digest(jumps, monkeypatch):
    class Known:
        def __init__(self, gearboxes, calibration):
            self.name = calibration.name

        def __call__(self, designs):
            return jumps[self.name]

    monkeypatch.setattr(peers, "Evaluator", Known)
    return peers._numbers()


def test_every_measure_of_every_calibration_counts_to_the_last_bit(ours, jumps, monkeypatch):
    assert set(jumps) == set(calibration_names())
    assert _digest(jumps, monkeypatch) == ours.numbers
    one, *others = jumps
    changed = [(one, field.name) for field in fields(Evaluations)] + [(name, "height_m") for name in others]
    digests = {_digest(jumps | {name: _slightly(field, jumps[name])}, monkeypatch) for name, field in changed}
    assert len(digests | {ours.numbers}) == 1 + len(changed)


def test_any_nan_is_a_nan(jumps, monkeypatch):
    """Processors set other bits in it."""
    name = calibration_names()[0]
    digests = set()
    for bits in (0x7FF8000000000000, 0xFFF8000000000005):
        values = jumps[name].height_m.copy()
        values[0] = np.uint64(bits).view(np.float64)
        assert np.isnan(values[0])
        digests.add(_digest(jumps | {name: replace(jumps[name], height_m=values)}, monkeypatch))
    assert len(digests) == 1


@pytest.mark.long
def test_a_worker_of_one_process_uses_all_cores_and_two_share_them():
    for count in (1, 2):
        with peers.processes(count) as crew:
            assert crew.submit(task_threads).result(timeout=300) == max(cores() // count, 1)
        with pytest.raises(RuntimeError, match="shutdown"):
            crew.submit(task_threads)
    assert not [thread for thread in threading.enumerate() if thread.name == "crew"]


@pytest.mark.parametrize("count", [0, -1])
def test_no_processes_are_refused(count):
    with pytest.raises(InputError, match="processes = "), peers.processes(count):
        pass


def test_a_cluster_compares_what_the_extra_needs_as_well(monkeypatch):
    """Workers with another CAD kernel made exports: nobody had passed the extra on."""
    asked = {}
    monkeypatch.setattr(peers, "DaskWorkers", str)
    monkeypatch.setattr(peers, "crew_of", lambda workers, **given: asked.update(given))
    peers.cluster("tcp://127.0.0.1:8786", extra="cad", seat=3)
    assert (asked["extra"], asked["seat"]) == ("cad", 3)

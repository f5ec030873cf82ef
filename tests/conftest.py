"""Settings that hold for every test, and what all processes of a test run share."""

import fcntl
import gc
import os
import pickle
import shutil
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from hypothesis import settings

# The machine is shared: how long one example takes says nothing about the code.
settings.register_profile("shared_machine", deadline=None)
settings.load_profile("shared_machine")

TOGETHER = ("tests/cad/check/", "tests/report/", "tests/study/server/")
"""Folders whose fixtures take so long to make that one process has all tests of a folder."""


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config: pytest.Config, log: object) -> object:
    """With ``--dist loadfile``, keep not only files together but also the folders named above."""
    if config.getvalue("dist") != "loadfile":
        return None
    from xdist.scheduler import LoadFileScheduling

    class Folders(LoadFileScheduling):
        def _split_scope(self, nodeid: str) -> str:
            return next((folder for folder in TOGETHER if nodeid.startswith(folder)), super()._split_scope(nodeid))

    return Folders(config, log)


def pytest_configure() -> None:
    """Keep temporary files in memory where there is room: the disk is waited for a hundred times per study."""
    os.environ["MUJOCO_GL"] = "disable"  # as the command line does: nothing is drawn with MuJoCo
    memory = Path("/dev/shm")
    if memory.is_dir() and shutil.disk_usage(memory).free > 8e9:
        os.environ.setdefault("PYTEST_DEBUG_TEMPROOT", str(memory))


def pytest_collection_finish() -> None:
    """Look for unreachable objects more rarely, and never among those of imported modules: 5 percent of all time."""
    gc.collect()
    gc.freeze()
    gc.set_threshold(20_000)


@pytest.fixture(scope="session")
def made_once(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str, Callable[[Path], Any]], Any]:
    """A function that makes something in a folder of a name, once per test run; tests must leave the folder alone.

    The first process calls ``make(folder)`` and the others wait; each gets a copy of what it returned.
    """
    run = tmp_path_factory.getbasetemp()
    run = run.parent if "PYTEST_XDIST_WORKER" in os.environ else run

    def made(name: str, make: Callable[[Path], Any]) -> Any:
        folder, returned = run / f"shared_{name}", run / f"shared_{name}.pickle"
        with (run / f"shared_{name}.lock").open("w") as lock:
            fcntl.flock(lock, fcntl.LOCK_EX)
            if not returned.exists():
                shutil.rmtree(folder, ignore_errors=True)  # of a process that failed
                folder.mkdir()
                returned.write_bytes(pickle.dumps(make(folder)))
        return pickle.loads(returned.read_bytes())  # noqa: S301, from this test run

    return made


@pytest.fixture
def unchecked(monkeypatch: pytest.MonkeyPatch) -> None:
    """Exports of this process leave out the checks of the machine, which have tests of their own."""
    from pareto_monoped.cad import export

    monkeypatch.setattr(export, "run_checks", lambda *_, **__: ())


@pytest.fixture(scope="session")
def browser() -> Iterator[object]:
    """Chromium, once per process: Playwright starts no second time while it runs."""
    path = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
    if path is None:
        pytest.skip("no Chromium is installed")
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        # WebGL by SwiftShader, so that the 3D view is drawn without a graphics card; all else on the processor.
        drawing = ["--disable-gpu", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
        running = playwright.chromium.launch(executable_path=path, args=["--no-sandbox", *drawing])
        yield running
        running.close()

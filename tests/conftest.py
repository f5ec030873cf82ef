"""Settings that hold for every test, and what all processes of a test run share."""

import fcntl
import gc
import os
import pickle
import shutil
import tempfile
from collections.abc import Callable, Iterator
from concurrent.futures import Future
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest
from hypothesis import settings

# The machine is shared: how long one example takes says nothing about the code.
settings.register_profile("shared_machine", deadline=None)
settings.register_profile("every_time", deadline=None, max_examples=25)
settings.load_profile("shared_machine")

TOGETHER = {
    "tests/report/": "report",
    "tests/study/server/": "server",
    "tests/cad/": "exports",
    "tests/api/test_outputs.py": "exports",
    "tests/cli/test_exports.py": "exports",
    "tests/cli/test_pareto.py": "exports",
    "tests/docs/test_commands.py": "exports",
    "tests/study/test_optional_variables.py": "exports",
}
"""Folders and files whose products take so long to make that one process has all tests of a name."""


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config: pytest.Config, log: object) -> object:
    """With ``--dist loadfile``, keep not only files together but also what is named above."""
    if config.getvalue("dist") != "loadfile":
        return None
    from xdist.scheduler import LoadFileScheduling

    class Folders(LoadFileScheduling):
        def _split_scope(self, nodeid: str) -> str:
            return next(
                (name for place, name in TOGETHER.items() if nodeid.startswith(place)), super()._split_scope(nodeid)
            )

    return Folders(config, log)


def pytest_configure(config: pytest.Config) -> None:
    """Set what holds for all processes; temporary files are kept in memory where there is room.

    A study waits for the disk a hundred times.
    """
    if config.getoption("markexpr") == "not long":
        settings.load_profile("every_time")
    os.environ["MUJOCO_GL"] = "disable"  # as the command line does: nothing is drawn with MuJoCo
    os.environ["PYDANTIC_DISABLE_PLUGINS"] = "__all__"  # likewise; processes of the tests look for none, either
    gc.set_threshold(20_000)  # to look for unreachable objects more rarely saves 5 percent of all time
    gc.disable()  # imported modules leave none that are worth the search
    memory = Path("/dev/shm")
    if memory.is_dir() and shutil.disk_usage(memory).free > 8e9:
        os.environ.setdefault("PYTEST_DEBUG_TEMPROOT", str(memory))
    if "PYTEST_XDIST_WORKER" not in os.environ:
        # Tables that all processes of this run need are computed once, and none that an earlier run has left is read.
        config.stash[KEPT] = tempfile.TemporaryDirectory(
            prefix="pareto_monoped_", dir=os.environ.get("PYTEST_DEBUG_TEMPROOT")
        )
        os.environ["PARETO_MONOPED_CACHE"] = config.stash[KEPT].name


KEPT = pytest.StashKey[tempfile.TemporaryDirectory]()


def pytest_unconfigure(config: pytest.Config) -> None:
    """Remove what was kept."""
    if KEPT in config.stash:
        config.stash[KEPT].cleanup()


def pytest_collection_finish() -> None:
    """Never look for unreachable objects among those of imported modules."""
    gc.freeze()
    gc.enable()


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


@pytest.fixture(scope="module")
def few_samples() -> Iterator[None]:
    """From here on in a module, commands and the library let 32 robots as built jump where they would take 256."""
    with pytest.MonkeyPatch.context() as patch:
        for name in ("LEAST_SAMPLES", "DEFAULT_SAMPLES"):
            patch.setattr(f"pareto_monoped.analysis.robustness.{name}", 32)
        yield


@contextmanager
def without_checks() -> Iterator[None]:
    """Exports of this process leave out the checks of the machine, and the solids that nothing but checks looks at."""
    from pareto_monoped.cad import export, product

    unread: Future[list[Any]] = Future()
    unread.set_exception(AssertionError("no solids are made for an export without checks"))
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(export, "run_checks", lambda *_, **__: ())
        patch.setattr(product, "solid_facts", lambda _: unread)
        yield


@pytest.fixture
def unchecked() -> Iterator[None]:
    """Exports of this test are made without the checks of the machine, which have tests of their own."""
    with without_checks():
        yield


@pytest.fixture(scope="module")
def unchecked_module() -> Iterator[None]:
    """The same for the products of a module."""
    with without_checks():
        yield


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
        # The address bar's pages, which nobody sees, take as long as a page of ours in each new window.
        bare = "--disable-features=WebUIOmniboxPopup,WebUIOmniboxAimPopup"
        running = playwright.chromium.launch(executable_path=path, args=["--no-sandbox", *drawing, bare])
        yield running
        running.close()

"""Exports that an executor makes: the same bytes as here, whole folders only, and nothing outside them."""

import shutil
import threading
import time
from concurrent.futures import Executor, Future, ThreadPoolExecutor
from dataclasses import replace

import pytest

from pareto_monoped.cad import batch, jobs
from pareto_monoped.cad.records import is_made
from pareto_monoped.errors import CheckError, OutputError

FORMATS = ["dxf", "3mf"]


def contents(folder):
    return {str(p.relative_to(folder)): p.read_bytes() for p in folder.rglob("*") if p.is_file()}


pytestmark = pytest.mark.usefixtures("unchecked_module")


@pytest.fixture(scope="module")
def here(tmp_path_factory):
    job = jobs.case_job("C", folder=tmp_path_factory.mktemp("here") / "c", formats=FORMATS, strength=False)
    batch.run(job)
    return job


class Counting(ThreadPoolExecutor):
    tasks = 0

    def submit(self, *arguments):
        self.tasks += 1
        return super().submit(*arguments)


@pytest.mark.long
def test_exports_of_an_executor_are_those_made_here(here, tmp_path):
    two = [replace(here, folder=tmp_path / name) for name in ("one", "two")]
    told, whole = [], []

    def tell(progress):
        told.append(progress)
        whole.append(is_made(progress.job))

    with Counting(2) as pool:
        assert batch.run_all(two, workers=1, executor=pool, progress=tell) == 2
        assert batch.run_all(two, workers=1, executor=pool) == 0
        assert pool.tasks == 2
    for job in two:
        assert contents(job.folder) == contents(here.folder)
        assert is_made(job)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["one", "two"]
    assert {progress.job.folder for progress in told} == {job.folder for job in two}
    assert whole == [True, True]


def test_a_failure_names_the_folder_of_the_job_and_leaves_nothing(here, tmp_path, monkeypatch):
    def fail(*arguments, **named):
        raise CheckError(f"export of {arguments[3]}: fails; nothing was written")

    monkeypatch.setattr(batch, "export_design", fail)
    job = replace(here, folder=tmp_path / "mine")
    with Counting(1) as pool, pytest.raises(CheckError) as caught:
        batch.run_all([job], workers=1, executor=pool)
    assert str(caught.value) == f"export of {tmp_path / 'mine'}: fails; nothing was written"
    assert list(tmp_path.iterdir()) == []


class Answering(Executor):
    def __init__(self, answer):
        self.answer = answer

    def submit(self, *arguments):
        future = Future()
        future.set_result(self.answer)
        return future


@pytest.mark.parametrize("name", ["../outside", "/outside", "a/../../outside"])
def test_a_file_that_leads_out_of_its_folder_is_refused(here, tmp_path, name):
    job = replace(here, folder=tmp_path / "in" / "mine")
    with pytest.raises(OutputError, match="leads out of its folder"):
        batch.run_all([job], workers=1, executor=Answering({name: b"x"}))
    assert [path for path in tmp_path.rglob("*") if path.is_file()] == []


def test_a_folder_with_foreign_files_is_refused_before_any_work(here, tmp_path):
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "letter.txt").write_text("dear")
    with Counting(1) as pool, pytest.raises(OutputError, match="is not empty"):
        batch.run_all([replace(here, folder=tmp_path / "mine")], workers=1, executor=pool)
    assert pool.tasks == 0


@pytest.fixture(scope="module")
def asked(tmp_path_factory):
    """A job that nobody has done."""
    return jobs.case_job("C", folder=tmp_path_factory.mktemp("asked") / "c", formats=FORMATS, strength=False)


def test_a_worker_makes_what_the_job_asks_for(asked, tmp_path, monkeypatch):
    seen = []

    def record(design, maps, calibration, folder, **named):
        del named["progress"]
        seen.append((design, calibration, named))
        folder.mkdir()
        (folder / "a").write_bytes(b"x")

    monkeypatch.setattr(batch, "export_design", record)
    source = {"trial": 7}
    job = replace(asked, folder=tmp_path / "mine", source=source, strength=True, hip_rad=0.1, knee_rad=-0.2, force=True)
    assert batch.made_files(job, "mine") == {"a": b"x"}
    wanted = {"formats": job.formats, "force": False, "source": source, "strength": True}
    wanted |= {"hip_rad": 0.1, "knee_rad": -0.2}
    assert seen == [(job.design, job.calibration, wanted)]
    assert list(tmp_path.iterdir()) == []


def test_a_process_makes_one_export_at_a_time(asked, monkeypatch):
    """Its CAD kernel is not made for two."""
    at_work, most = [], []

    def busy(*arguments, **named):
        at_work.append(1)
        most.append(len(at_work))
        time.sleep(0.1)
        at_work.pop()
        arguments[3].mkdir()

    monkeypatch.setattr(batch, "export_design", busy)
    with ThreadPoolExecutor(4) as pool:
        assert list(pool.map(batch.made_files, [asked] * 4, ["x"] * 4)) == [{}] * 4
    assert most == [1] * 4


def test_after_a_failure_exports_that_have_not_begun_are_called_off(asked, tmp_path, monkeypatch):
    begun, told = [], threading.Event()

    def fail(*arguments, **named):
        begun.append(1)
        if len(begun) > 1:  # it may have begun before the first one's failure was heard of
            told.wait(60.0)
        raise CheckError("fails")

    monkeypatch.setattr(batch, "export_design", fail)
    many = [replace(asked, folder=tmp_path / str(number)) for number in range(6)]
    with ThreadPoolExecutor(1) as pool:
        with pytest.raises(CheckError):
            list(batch.sent(many, pool))
        told.set()
    assert len(begun) <= 2


@pytest.mark.parametrize("force", [True, False])
def test_an_earlier_export_is_replaced_only_by_force(here, tmp_path, force):
    job = replace(here, folder=tmp_path / "mine", force=force)
    shutil.copytree(here.folder, job.folder)
    other = contents(here.folder) | {"own.txt": b"new"}
    if force:
        assert list(batch.sent([job], Answering(other))) == [job]
    else:
        with pytest.raises(OutputError, match=r"is not empty; .* or --force"):
            list(batch.sent([job], Answering(other)))
    assert (job.folder / "own.txt").exists() is force

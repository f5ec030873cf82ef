"""Exports that an executor makes: the same bytes as here, whole folders only, and nothing outside them."""

from concurrent.futures import Executor, Future, ThreadPoolExecutor
from dataclasses import replace

import pytest

from pareto_monoped.cad import batch, jobs, sent
from pareto_monoped.cad.made import is_made
from pareto_monoped.errors import CheckError, OutputError

FORMATS = ["dxf", "mjcf"]


def contents(folder):
    return {str(p.relative_to(folder)): p.read_bytes() for p in folder.rglob("*") if p.is_file()}


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


def test_exports_of_an_executor_are_those_made_here(here, tmp_path):
    two = [replace(here, folder=tmp_path / name) for name in ("one", "two")]
    told = []
    with Counting(2) as pool:
        assert batch.run_all(two, workers=1, executor=pool, progress=told.append) == 2
        assert batch.run_all(two, workers=1, executor=pool) == 0
        assert pool.tasks == 2
    for job in two:
        assert contents(job.folder) == contents(here.folder)
        assert is_made(job)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["one", "two"]
    assert {progress.job.folder for progress in told} == {job.folder for job in two}


def test_a_failure_names_the_folder_of_the_job_and_leaves_nothing(here, tmp_path, monkeypatch):
    def fail(*arguments, **named):
        raise CheckError(f"export of {arguments[3]}: fails; nothing was written")

    monkeypatch.setattr(sent, "export_design", fail)
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

"""Every notebook runs from top to bottom, says nothing on stderr, and is kept without outputs."""

import os
import sys
from pathlib import Path

import pytest

from tests.lazily import Lazily

nbformat, nbclient, jupyter = Lazily("nbformat"), Lazily("nbclient"), Lazily("jupyter_client")
NOTEBOOKS = sorted((Path(__file__).parents[2] / "notebooks").glob("*.ipynb"))
SHOWS = {
    "tour": {"1.06  ": 1, "robot: 4.50 kg": 1, "feasible": 1, "the knee": 1, "own_load_factor": 1, "(400, ": 1},
    "own_motor": {"N m/A": 2, "g  ESSPG": 3, "J from the battery": 2, "the knee": 1, "Rating after ISO 6336": 1},
}
"""Notebook -> words that its outputs have, and how often at least."""
FIGURES = {"tour": 4, "own_motor": 2}


def outputs(notebook):
    return [output for cell in notebook.cells if cell.cell_type == "code" for output in cell.outputs]


def test_every_notebook_is_known_here():
    assert {path.stem for path in NOTEBOOKS} == set(SHOWS)


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_is_kept_as_it_is_read(path):
    """Outputs would go stale; the site and the reader's own kernel make them."""
    notebook = nbformat.read(path, as_version=4)
    nbformat.validate(notebook)
    code = [cell for cell in notebook.cells if cell.cell_type == "code"]
    assert all(cell.execution_count is None and not cell.outputs for cell in code)
    assert max(len(cell.source.splitlines()) for cell in code) <= 20
    assert notebook.cells[0].source.startswith("# ")


@pytest.fixture(scope="module")
def kernel(tmp_path_factory):
    """One kernel for all notebooks, which takes seconds to import everything, and the folder in which it works."""
    folder = tmp_path_factory.mktemp("notebooks")
    manager = jupyter.KernelManager(kernel_name="python3")
    manager.start_kernel(cwd=folder, env=os.environ | {"PYTHONPATH": os.pathsep.join(filter(None, sys.path))})
    yield manager, folder
    manager.shutdown_kernel(now=True)


@pytest.mark.filterwarnings("ignore")  # of the kernel's own libraries
@pytest.mark.long
@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_runs(path, kernel):
    manager, folder = kernel
    notebook = nbformat.read(path, as_version=4)
    notebook.cells.insert(0, nbformat.v4.new_code_cell("%reset -f"))  # it has no name of another notebook
    client = nbclient.NotebookClient(notebook, km=manager, timeout=600)
    client.execute()
    client.kc.stop_channels()
    made = outputs(notebook)
    assert [output.text for output in made if output.output_type == "stream" and output.name == "stderr"] == []
    text = "\n".join(output.get("text") or output.get("data", {}).get("text/plain", "") for output in made)
    for words, count in SHOWS[path.stem].items():
        assert text.count(words) >= count, words
    assert sum("image/png" in output.get("data", {}) for output in made) == FIGURES[path.stem]
    assert list(folder.iterdir()) == []

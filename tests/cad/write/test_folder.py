"""The folder of an export replaces an earlier export, and nothing else."""

import json

import pytest

from pareto_monoped.cad.write.folder import RECORD, beside, move_in, require_free
from pareto_monoped.errors import OutputError

NEW = {"README.md": "new", "parts/step/a.step": "new", RECORD: "new"}


@pytest.fixture
def out(tmp_path):
    """A folder with an export of which one part is no longer made, and with a file of the user's."""
    filled(tmp_path / "out", {"README.md": "old", "parts/step/b.step": "old", "bom.csv": "old", "mine.txt": "mine"})
    listed(tmp_path / "out", ["README.md", "parts/step/b.step", "bom.csv"])
    return tmp_path / "out"


def filled(folder, files):
    for name, text in files.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text)


def listed(folder, names):
    (folder / RECORD).write_text(json.dumps({"files": names}))


def moved(out):
    with beside(out) as folder:
        filled(folder, NEW)
        move_in(folder, out)


def contents(folder):
    return {str(path.relative_to(folder)): path.read_text() for path in folder.rglob("*") if path.is_file()}


def test_an_earlier_export_is_replaced_and_other_files_stay(out):
    require_free(out, force=True)
    moved(out)
    assert contents(out) == NEW | {"mine.txt": "mine"}


@pytest.mark.parametrize("name", ["mine.txt", "../mine.txt", "parts/step/../../mine.txt", "link.txt", "bom.csv"])
def test_a_record_deletes_nothing_that_no_export_made(out, name):
    (out.parent / "mine.txt").write_text("mine")
    (out / "link.txt").symlink_to("mine.txt")
    (out / "bom.csv").unlink()
    (out / "bom.csv").symlink_to("mine.txt")
    listed(out, ["README.md", "parts/step/b.step", name])
    moved(out)
    assert contents(out) == NEW | {"mine.txt": "mine", "link.txt": "mine", "bom.csv": "mine"}
    assert (out.parent / "mine.txt").read_text() == "mine"


@pytest.mark.parametrize(
    ("name", "early"), [("README.md", True), ("design.json", True), ("parts/step/a.step", False), ("parts", False)]
)
def test_a_foreign_file_in_the_way_is_told_and_stays(tmp_path, name, early):
    out = tmp_path / "out"
    filled(out, {name: "mine", "notes.txt": "mine"})
    before = contents(out)
    if early:
        with pytest.raises(OutputError, match="is not of an earlier export"):
            require_free(out, force=True)
    else:
        require_free(out, force=True)
        with pytest.raises(OutputError, match=f"{name}' is not of an earlier export and would be lost"):
            moved(out)
    assert contents(out) == before
    assert [path.name for path in tmp_path.iterdir()] == ["out"]


@pytest.mark.parametrize("text", ["", "[]", "{}", "null", '{"files": 3}', "[" * 100_000])
def test_what_is_no_record_of_an_export_is_foreign(tmp_path, text):
    filled(tmp_path, {RECORD: text})
    with pytest.raises(OutputError, match=r"'design.json' is not of an earlier export"):
        require_free(tmp_path, force=True)


def test_a_place_where_nothing_can_be_made_is_refused_before_the_work(tmp_path):
    """An export to a folder below a file, or of /proc, was refused only after a quarter of a minute."""
    (tmp_path / "file").write_text("mine")
    with pytest.raises(OutputError, match=r"cannot be written .*; give a writable folder"):
        require_free(tmp_path / "file" / "new" / "robot", force=False)
    require_free(tmp_path / "new" / "robot", force=False)
    assert [path.name for path in tmp_path.iterdir()] == ["file"]

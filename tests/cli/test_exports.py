"""The export command: what it refuses, and one small export."""

import json

import pytest

from pareto_monoped.cli import main


def run(capsys, *words):
    with pytest.raises(SystemExit) as end:
        main([str(word) for word in words])
    printed = capsys.readouterr()
    return end.value.code, printed.out, printed.err


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (("export", "-o", "x"), "no DB given"),
        (("export", "--case", "C", "--knee", "-o", "x"), "--case C takes no DB and no selector"),
        (("export", "study.db", "--front", "--knee", "-o", "x"), "--front takes no selector"),
        (("export", "study.db", "-o", "x"), "no selector given"),
        (("export", "missing.db", "--knee", "-o", "x"), "missing.db"),
        (("export", "--case", "C", "--formats", "step,dwg", "-o", "x"), "format 'dwg'"),
    ],
)
def test_bad_requests_are_one_line_and_write_nothing(capsys, tmp_path, monkeypatch, words, told):
    monkeypatch.chdir(tmp_path)
    code, out, err = run(capsys, *words)
    assert code == 2
    assert out == ""
    assert told in err
    assert len(err.splitlines()) == 1
    assert list(tmp_path.iterdir()) == []


def test_a_case_of_the_paper_is_exported(capsys, tmp_path):
    folder = tmp_path / "case"
    code, out, err = run(capsys, "export", "--case", "nominal", "--formats", "dxf", "-o", folder)
    assert code == 0
    assert [line.split()[0] for line in out.splitlines()] == ["searched", "as"]
    assert "checking" in err
    assert json.loads((folder / "design.json").read_text())["source"] == {"case": "nominal"}
    assert sorted(path.name for path in (folder / "laser").iterdir()) == [
        "base_near_cheek.dxf",
        "shank_plate.dxf",
        "thigh_plate_inner.dxf",
        "thigh_plate_outer.dxf",
    ]
    assert all(check["passed"] for check in json.loads((folder / "checks.json").read_text()))

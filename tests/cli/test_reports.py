from pathlib import Path

import pytest
from click.testing import CliRunner

from pareto_monoped.cli.stored import report
from tests.cli.support import STORED


def test_report_writes_one_page_and_figures(tmp_path):
    result = CliRunner().invoke(
        report, [str(STORED), "-o", str(tmp_path / "r.html"), "--figures", str(tmp_path / "figures")]
    )
    assert result.exit_code == 0, result.output
    assert result.stdout == ""
    assert (tmp_path / "r.html").read_text().startswith("<!doctype html>")
    assert (tmp_path / "figures" / "front.svg").exists()


@pytest.mark.parametrize("arguments", [[], ["x.db"]])
def test_report_without_a_database_or_an_output_is_a_usage_error(arguments):
    result = CliRunner().invoke(report, arguments)
    assert result.exit_code == 2


@pytest.mark.long
def test_figures_alone_write_no_page(tmp_path):
    result = CliRunner().invoke(report, [str(STORED), "--figures", str(tmp_path / "figures")])
    assert result.exit_code == 0, result.output
    assert "front.svg" in result.stderr
    assert list(tmp_path.glob("*.html")) == []


def test_the_folder_of_exports_is_handed_on(monkeypatch, tmp_path):
    given = {}
    monkeypatch.setattr("pareto_monoped.report.page.payload_of", lambda dbs, **more: given.update(more, dbs=dbs))
    monkeypatch.setattr("pareto_monoped.report.page.page", lambda payload: "page")
    arguments = ["a.db", "b.db", "-o", str(tmp_path / "r.html"), "--exports", str(tmp_path)]
    assert CliRunner().invoke(report, arguments).exit_code == 0
    assert (given["dbs"], given["exports"]) == ((Path("a.db"), Path("b.db")), tmp_path)

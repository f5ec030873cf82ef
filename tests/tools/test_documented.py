"""The script that makes documented figures again: numbers follow the commands, words stay."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md")), *sorted((ROOT / "benchmarks").glob("*.md"))]


def test_a_marked_table_gets_the_rows_that_its_command_prints(script):
    command = "printf '| a | b |\\n|---|---|\\n| 0 | 0 |\\n\\n| x | y |\\n|---|---|\\n| 3 | 4 |\\n| 5 | 6 |\\n'"
    page = f"Text.\n\n<!-- made by: {command} -->\n| x | y |\n|---|---:|\n| 1 | 2 |\n\nMore.\n"
    new, missed = script.with_tables(page)
    assert new == page.replace("| 1 | 2 |", "| 3 | 4 |\n| 5 | 6 |")
    assert missed == []


def test_a_table_that_the_command_does_not_print_is_named_and_kept(script):
    page = "<!-- made by: echo nothing -->\n| x | y |\n|---|---|\n| 1 | 2 |\n"
    new, (fault,) = script.with_tables(page)
    assert new == page
    assert "echo nothing" in fault
    assert "x | y" in fault


def test_a_check_passes_over_columns_of_times_alone(script):
    command = "printf '| step | speed | off |\\n|---|---|---|\\n| 1 | 1.93 | 0.5 |\\n'"
    page = f"<!-- made by: {command} -->\n| step | speed | off |\n|---|---|---|\n| 1 | 2.00 | 0.4 |\n"
    assert script.with_tables(page, timed=False)[0] == page.replace("0.4", "0.5")
    assert script.with_tables(page)[0] == page.replace("2.00", "1.93").replace("0.4", "0.5")


def test_outputs_get_the_numbers_of_today_and_keep_blanks_and_gaps(script, tmp_path):
    command = "printf 'mass 5.1 kg\\nother\\n\\nheight   1.25 m\\nend 7\\n'"
    page = f"```console\n$ {command}\nmass 4 kg\n...\n\nheight 1 m\n...\n```\n"
    new, missed = script.with_outputs(page, tmp_path)
    shown = new.split("\n", 2)[2]
    assert shown == "mass 5.1 kg\n...\n\nheight   1.25 m\n...\n```\n"
    assert missed == []


def test_a_line_whose_words_are_gone_is_named_and_kept(script, tmp_path):
    page = "```console\n$ printf 'weight 5 kg\\n'\nmass 4 kg\n```\n"
    new, (fault,) = script.with_outputs(page, tmp_path)
    assert new == page
    assert "mass 4 kg" in fault


def test_after_a_gap_the_line_with_the_closest_numbers_is_taken(script):
    new, missed = script.like(["...", "row 20", "..."], ["row 1", "row 2", "row 21", "row 300"])
    assert new == ["...", "row 21", "..."]
    assert missed == []


def test_lines_between_gaps_stay_together(script):
    new, _ = script.like(["...", "head", "row 5"], ["head", "other", "head", "row 6"])
    assert new == ["...", "head", "row 6"]


def test_a_command_that_fails_stops_the_script(script, tmp_path):
    with pytest.raises(SystemExit, match="'false' exits 1"):
        script.with_outputs("```console\n$ false\n```\n", tmp_path)


def test_every_table_that_names_its_maker_names_a_script_that_is_there():
    makers = [made for page in PAGES for made in re.findall(r"<!-- made by: python (\S+)", page.read_text("utf-8"))]
    assert makers
    assert [made for made in makers if not (ROOT / made).exists()] == []


def test_a_check_writes_nothing_and_names_what_would_change(script, tmp_path, monkeypatch, capsys):
    page = tmp_path / "page.md"
    text = "```console\n$ printf 'mass 5 kg\\n'\nmass 4 kg\n```\n"
    page.write_text(text)
    monkeypatch.setattr("sys.argv", ["documented.py", "--outputs", "--check", str(page)])
    with pytest.raises(SystemExit) as caught:
        script.main()
    assert caught.value.code == 1
    assert capsys.readouterr().out.splitlines() == ["page.md: - mass 4 kg", "page.md: + mass 5 kg"]
    assert page.read_text() == text
    page.write_text(text.replace("4", "5"))
    with pytest.raises(SystemExit) as caught:
        script.main()
    assert caught.value.code == 0


def test_how_long_something_took_stays_as_shown(script, tmp_path):
    command = "printf 'a 20/20 1.500 m J   0.8 s   finished\\nb 2 m\\n'"
    page = f"```console\n$ {command}\na 20/20 1.500 m J   7.2 s   finished\nb 1 m\n```\n"
    new, _ = script.with_outputs(page, tmp_path)
    assert new == page.replace("b 1 m", "b 2 m")
    page = page.replace("1.500 m J   7.2", "1.400 m J   7.2")
    assert "1.500 m J   0.8 s" in script.with_outputs(page, tmp_path)[0].split("\n", 2)[2]

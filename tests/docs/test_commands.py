"""Every command shown in README and docs runs, and prints what is shown there.

A block that starts with ```console holds lines ``$ command``, each followed by what it prints on stdout. The blocks of
one file are run in order in one folder that has the repository's ``studies``; ``...`` stands for lines left out.
Numbers may differ by 2 percent, as the last digits of a simulation may between machines. What a search found, and what
the chaotic literal model gives, may differ by more for the same reason: there only the words are compared.
"""

import re
import runpy
import shlex
import shutil
import subprocess
from pathlib import Path

import pytest

import pareto_monoped as pm
from pareto_monoped.actuator.search import map_for
from pareto_monoped.cli import _run as cli

ROOT = Path(__file__).parents[2]
PAGES = sorted(
    [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *(ROOT / "docs").glob("*.md"), *(ROOT / "studies").glob("*.md")]
)
NUMBER = re.compile(r"[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?")


def commands(page: Path) -> list[tuple[str, list[str]]]:
    """Command and expected lines, in the order of the page."""
    found: list[tuple[str, list[str]]] = []
    for block in re.findall(r"^```console\n(.*?)^```", page.read_text(encoding="utf-8"), re.S | re.M):
        for line in block.splitlines():
            if line.startswith("$ "):
                found.append((line[2:], []))
            else:
                found[-1][1].append(line)
    return found


def same(shown: str, printed: str, *, numbers: bool) -> bool:
    """Whether two lines agree, numbers to 2 percent if they count at all; blanks are ignored."""
    if NUMBER.sub("#", shown).split() != NUMBER.sub("#", printed).split():
        return False
    if not numbers:
        return True
    pairs = zip(NUMBER.findall(shown), NUMBER.findall(printed), strict=True)
    return all(abs(float(a) - float(b)) <= 0.02 * max(abs(float(a)), abs(float(b))) for a, b in pairs)


def missing(shown: list[str], printed: list[str], *, numbers: bool) -> str:
    """The first shown line that the output does not have in its place; empty if all are there."""
    position = 0
    free = False
    for line in (line for line in shown if line.strip()):
        if line.strip() == "...":
            free = True
            continue
        rest = [i for i in range(position, len(printed)) if printed[i].strip()]
        rest = rest if free else rest[:1]
        match = next((i for i in rest if same(line, printed[i], numbers=numbers)), None)
        if match is None:
            return line
        position, free = match + 1, False
    return ""


@pytest.fixture(scope="module")
def searches() -> dict[str, tuple[Path, str]]:
    """Commands that begin a page with a search: the folder of studies after it, and what it printed."""
    return {}


LESS = {
    "export": ("--formats", "dxf"),  # its files and its checks are those that other tests look at; here are its parts
    "run studies/quick.toml": ("--evaluations", "300"),  # of a search, only words are compared
    "robust": ("--every", "20"),  # of a front that has a quarter of the designs
    "run studies/robust.toml": ("--evaluations", "3"),
    "run studies/case_c.toml": ("--evaluations", "120"),
}
"""Beginnings of commands that are run with further words, since they take long as they are shown."""
ELSEWHERE = {"pareto-monoped simulate --case C --gif jump.gif"}
"""Commands that only long tests run here, as they mesh a robot: tests/cli/test_watching.py has them."""
IN_FULL = {"pareto-monoped limit studies/case_c.db --designs 4"}
"""Commands whose words depend on the whole study: the job "figures" of CI alone makes and compares them."""
LONG = {"studies.md"}
"""Pages whose commands take as long as those of all others: a campaign over motors, with its report."""


@pytest.mark.usefixtures("unchecked", "few_samples")
@pytest.mark.parametrize(
    "page",
    [
        pytest.param(page, id=str(page.relative_to(ROOT)), marks=pytest.mark.long if page.name in LONG else ())
        for page in PAGES
        if commands(page)
    ],
)
def test_commands_of_the_page_run_and_print_what_it_shows(
    page, tmp_path, monkeypatch, capsys, tmp_path_factory, searches, pytestconfig
):
    shutil.copytree(ROOT / "studies", tmp_path / "studies", ignore=shutil.ignore_patterns("*.db*"))
    shutil.copytree(ROOT / "examples" / "legs", tmp_path / "examples" / "legs")
    (tmp_path / "reports").mkdir()
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "80")
    for place, (command, shown) in enumerate(commands(page)):
        program, *words = shlex.split(command)
        if program == "make":
            # The targets themselves are what CI runs; here only that they exist.
            subprocess.run(["make", "-n", *words], cwd=ROOT, check=True, capture_output=True)
            continue
        assert program == "pareto-monoped"
        if command in IN_FULL:
            continue
        if command in ELSEWHERE and pytestconfig.getoption("markexpr") == "not long":
            continue
        if place == 0 and command in searches:
            folder, printed = searches[command]
            shutil.copytree(folder, "studies", dirs_exist_ok=True)
        else:
            given = " ".join(words)
            code = cli([*words, *next((more for start, more in LESS.items() if given.startswith(start)), ())])
            printed, said = capsys.readouterr()
            assert code == 0, f"{command}: {said}"
        if place == 0 and words[0] == "run":
            searches[command] = shutil.copytree("studies", tmp_path_factory.mktemp("after") / "studies"), printed
        searched = any(word in command for word in (".db", " run ", "table1", " campaign "))
        absent = missing(shown, printed.splitlines(), numbers=not searched)
        assert not absent, f"{command} no longer prints:\n{absent}\nbut:\n{printed}"


def test_the_pages_exist_and_the_readme_shows_commands():
    assert commands(ROOT / "README.md")


def test_the_motor_shown_for_copying_has_a_map(tmp_path):
    (text,) = re.findall(r"^```toml\n(.*?)^```", (ROOT / "docs" / "actuators.md").read_text("utf-8"), re.S | re.M)
    path = tmp_path / "my_motor.toml"
    path.write_text(text, encoding="utf-8")
    entries = map_for(str(path)).entries
    assert {entry.actuator.family for entry in entries if entry.actuator} == {"ESSPG"}


def block(language: str, page: str) -> str:
    """The one block of a language on a page."""
    (text,) = re.findall(rf"^```{language}\n(.*?)^```", (ROOT / "docs" / page).read_text("utf-8"), re.S | re.M)
    return text


def test_the_study_shown_finds_designs_within_its_limits(tmp_path):
    """Its limit of mass could not be met with the motor that it named."""
    (tmp_path / "my_leg.toml").write_text(block("toml", "getting_started.md"), encoding="utf-8")
    stored = pm.run(tmp_path / "my_leg.toml", evaluations=80)
    assert len(stored.front()) > 5


def test_the_program_shown_runs(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    shown = block("python", "python.md")
    assert "evaluations=200" in shown
    (tmp_path / "program.py").write_text(shown.replace("evaluations=200", "evaluations=80"), encoding="utf-8")
    runpy.run_path("program.py", run_name="__main__")
    lines = [line.split() for line in capsys.readouterr().out.splitlines()]
    assert lines[0] == ["stiffness_n_per_m", "height_m", "energy_j", "status", "reason"]
    assert lines[6] == ["trial", "height_m", "energy_j", "own_slides"]
    assert len(lines) > 8
    assert (tmp_path / "front.html").is_file()


def test_every_file_that_contributing_names_exists():
    text = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    named = [
        word
        for word in re.findall(r"`([^`\s]+/[^`\s]*)`", text)
        if not word.startswith(("out/", "leg/", "actuator/", "study/"))
    ]
    assert len(named) > 20
    for word in named:
        assert (ROOT / word).exists(), word


def shown_by(page: str, command: str) -> list[list[str]]:
    """The numbers of each line that a page shows below a command."""
    lines = dict(commands(ROOT / page))[command]
    return [NUMBER.findall(line) for line in lines]


def test_the_tables_of_the_readme_are_those_of_the_main_job_and_of_table_1():
    """CI makes what is shown below the commands to the last digit; the README repeats some of it in words."""
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    case_c, highest, exported = (
        re.search(rf"^\| {start}.*? \| ([\d.]+) \| ([\d.]+) \| ([\d.]+) \|$", text, re.M).groups()
        for start in ("the paper's best", "on the front", "exported")
    )
    published, simulated, front, knee = shown_by("docs/getting_started.md", "make pareto")[4:8]
    jump = [(height, stands, energy) for height, energy, stands, _ in (row[-4:] for row in (simulated, front, knee))]
    assert [case_c, highest, exported] == jump
    assert f"gives {published[0]} m and {published[1]} J for Case C" in " ".join(text.split())
    heights, energies = shown_by("docs/stages.md", "pareto-monoped table1")[-3:-1]
    assert f"the calibration `paper` gives {heights[1]} m and {energies[1]} J" in " ".join(text.split())
    said = " ".join((ROOT / "docs" / "getting_started.md").read_text(encoding="utf-8").split())
    height, _, stands, rise = simulated
    assert f"of Case C's {height} m, {stands} m is the base" in said
    assert f"its centre of mass rises by {rise} m" in said


def test_the_readme_repeats_what_opening_saves():
    """From the last table of the main job: least energies, and the share saved."""
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    starts = ("height, m", "the paper's seven variables", "more variables free", "saved, %")
    told = [re.search(rf"^\| {start} \|(.*)\|$", text, re.M).group(1).replace("|", " ").split() for start in starts]
    rows = [row for row in shown_by("docs/getting_started.md", "make pareto") if len(row) == 6]
    assert len(rows) == 6
    assert told == [list(column) for column in zip(*(row[:4] for row in rows), strict=True)]


def test_the_readme_repeats_what_getting_started_shows():
    first = "pareto-monoped run studies/quick.toml"
    assert (
        shown_by("README.md", first) == shown_by("docs/getting_started.md", first)[: len(shown_by("README.md", first))]
    )

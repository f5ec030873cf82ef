"""What commands print and write is as it was: every option of every command is used.

The numbers and words are those of the day when the files of signatures were made, after all other tests had passed: a
change is seen, nothing is proved. After a change that is wanted, look at what the command prints, and make them again:
``PARETO_MONOPED_SIGN=1 python -m pytest tests/cli/test_signatures.py``. Times, hashes and folders are left out.
"""

import re
from dataclasses import fields, replace
from pathlib import Path

import click
import numpy as np
import pandas as pd
import pytest

from pareto_monoped.api.jumps import trace
from pareto_monoped.cad import film
from pareto_monoped.campaign.page import campaign_page
from pareto_monoped.campaign.results import csv_text
from pareto_monoped.cli import cli, limit, robustness
from pareto_monoped.design import PAPER_CASES
from pareto_monoped.pareto.objectives import HEIGHT_AND_ENERGY
from pareto_monoped.report.card import Source
from pareto_monoped.report.page import build, payload_of
from pareto_monoped.report.resimulation import resimulate
from pareto_monoped.storage.reader import read_study
from pareto_monoped.uncertainty.statistics import Robustness, Spread
from tests.campaign.support import content_of, made_campaign
from tests.cli.support import ROOT, run
from tests.records import compare, of_text, signature
from tests.report.test_campaign_page import AXES, fronts
from tests.signed_studies import SIGNED, go_to_studies, numbered_limit

FOLDER = Path(__file__).parent
LEGS = ROOT / "examples" / "legs"
DESIGN = ["--set", "knee_ratio=8.1", "--set", "thigh_length_m=0.37", "--set", "knee_release_rad=0.2"]
COMMANDS = (
    "front {db}",
    "front {db} --json --all",
    "front {db} --objectives mass_kg,height_m --max energy_j=60",
    "front {db} --most 4 --csv {out}/front.csv",
    "pick {db} --knee --alternatives 3",
    "pick {db} --tradeoff --json",
    "pick {db} --weights 0.7,0.3 --min-height 0.5",
    "pick {db} --compromise 0.2,0.8",
    "pick {db} --nearest height_m=0.8,energy_j=30",
    "pick {db} --least mass_kg --max-energy 80",
    "pick {db} --most efficiency --json",
    "status {db}",
    "status {db} --json",
    "verify {db}",
    "trials {db} --csv {out}/trials.csv",
    "robust {db} --every 4 --json",
    "sensitivity {db} --knee --samples 64 --json",
    "simulate --case A --calibration stand --audit",
    "simulate --case B --calibration printed --landing",
    "simulate --case C --hops 2 --json",
    "simulate --case nominal --motor U12 {design} --trace {out}/trace.csv --model {out}/model.xml",
    "actuators --motor MAD_M6C12",
    "actuators --motor U12 --ratio 7.3",
    "actuators --motor U8 --ratio 4.5 --rules paper --json",
    "actuators --motor VT8020 --csv {out}/actuators.csv",
)
FILES = ("front.csv", "trials.csv", "trace.csv", "model.xml", "actuators.csv")
OPTIONS = {
    "begin": (
        "init --list",
        "init wide -o study.toml",
        "init quick -o study.toml",
        "init quick -o study.toml --force",
        "init nothing",
        "pareto none.toml",
    ),
    "gearboxes": (
        "actuators --motor U8 --rules paper --csv -",
        "actuators --motor VT8020 --bearings regression",
        "actuators --motor U12 --ratio 4 --bearings regression --json",
        "actuators --motor U8 --ratio 8.8 --without flank_strength --without bore",
        "actuators --motor MN8014 --ratio 5.2 --rules paper",
        "actuators --motor MAD_M6C12 --ratio 6.4 --json",
        "actuators --motor VT8020 --ratio 99",
        "actuators --motor VT8020 --ratio 9.4",
        "actuators --motor VT8020 --ratio -1",
        "actuators --motor VT8020 --json --csv -",
        "actuators --motor U8 --csv notes.csv",
        "actuators --motor U8 --csv notes.csv --force",
    ),
    "jumps": (
        "simulate --case nominal --hip-motor U8 --knee-motor VT8020 --rules paper --json",
        "simulate --case A --hip-motor VT8020 --knee-motor MN8014 --landing --json",
        "simulate --controller torque_over_time:3 --set knee_knot_1=-0.8 --set knee_knot_2=-0.5 --json",
        "simulate --case A --set knee_release_rad=0.3 --set torsional_stiffness_n_m_per_rad=60 --trace trace.csv",
        "simulate --case A --set knee_ratio=4 --set hip_ratio=8.6 --trace notes.csv --model model.xml --force",
        "simulate --set stiffness_n_per_m=0 --set damping_n_s_per_m=0",
        "simulate --set thigh_length_m=0.3 --set shank_length_m=0.3 --set start_height_m=0.6",
        "simulate --set stiffness_n_per_m=-3",
        "simulate --set knee_ratio=99",
        "simulate --set nothing=1",
        "simulate --controller springs",
        "simulate --case C --hip-motor U8",
        "simulate --case C --hops 0",
    ),
    "landings": (
        "simulate --case B --calibration paper --landing --json",
        "simulate --case C --calibration ideal --audit --json --hops 3",
        "simulate --case B --calibration stand --audit --landing --hops 2",
        "simulate --calibration printed --hops 1 --set start_height_m=0.45 --set rest_length_m=1.5 --json",
        "table1",
        "table1 --json",
    ),
    "studies": (
        "run small.toml --workers 1 --json",
        "run small.toml --workers 1 --evaluations 15",
        "run small.toml --workers 1 --second-seed 7",
        "run small.toml --objectives height_m,drift_m",
        "run small.toml --db opened.db --opened --evaluations 20 --workers 1",
        "run pair.toml --db new.db --objectives height_m,drift_m --evaluations 20 --seed 9 --no-strength --workers 1",
        "status new.db",
        "resume new.db --evaluations 25 --workers 1",
        "resume new.db --evaluations 26 --workers 1 --json",
        "resume new.db --evaluations 5",
        "status pair.db",
        "status other.db --json",
        "verify other.db --simulate 5 --workers 1",
        "verify other.db --expect 0123456789abcdef",
        "verify none.db",
        "repair other.db",
        "trials other.db --state failed",
        "trials other.db --state infeasible",
        "trials pair.db --csv notes.csv --state feasible",
        "trials pair.db --csv notes.csv --state feasible --force",
        "trials other.db --parquet trials.parquet",
    ),
    "campaigns": (
        "campaign grid.toml --folder new --status",
        "campaign grid.toml --folder studies --workers 1 --csv notes.csv --report notes.html",
        "campaign grid.toml --folder studies --workers 1 --csv notes.csv --report notes.html --force",
        "campaign grid.toml --folder studies --status --json",
        "campaign none.toml",
    ),
    "fronts": (
        "front other.db",
        "front signed.db --min-height 0.8 --max-energy 60",
        "front other.db --limit mass_kg=6 --min knee_ratio=4.5 --max shank_length_m=0.45 --json",
        "front other.db --all --csv notes.csv --objectives mass_kg,drift_m,height_m --most 3",
        "front other.db --all --csv notes.csv --objectives mass_kg,drift_m,height_m --most 3 --force",
        "front other.db --min-height 9",
        "front other.db --limit efficiency=much",
        "front other.db --max nothing=1",
        "front signed.db --objectives mass_kg",
        "front pair.db",
        "front pair.db --json --all",
    ),
    "picks": (
        "pick other.db --knee",
        "pick other.db --tradeoff --alternatives 2 --tolerance 30",
        "pick other.db --weights 1,2,3 --limit height_m=0.7 --json",
        "pick other.db --compromise 1,0,2 --max mass_kg=5.5",
        "pick other.db --nearest height_m=0.8,mass_kg=4.5 --alternatives 3 --tolerance 40 --json",
        "pick other.db --least shank_length_m --min height_m=0.8 --max-energy 80",
        "pick other.db --most height_m",
        "pick other.db --trial 3",
        "pick other.db --trial 90",
        "pick other.db --min-height 0.85",
        "pick signed.db --tradeoff --max-energy 60 --min-height 0.75",
        "pick signed.db --trial 2 --alternatives 1 --tolerance 0",
        "pick other.db --min-height 3",
        "pick other.db",
        "pick other.db --weights 1,2",
        "pick other.db --robust --knee",
        "pick other.db --knee --least mass_kg",
        "pick pair.db --knee",
    ),
    "as_built": (
        "robust other.db --trial 1 --trial 4 --samples 32 --seed 7 --workers 1",
        "robust other.db --every 9 --alternatives 1 --workers 1",
        "robust other.db --min-height 0.9 --max-energy 90 --limit mass_kg=6 --min knee_ratio=4.5 "
        "--max shank_length_m=0.49 --uncertainty mine.toml --json --workers 1",
        "robust other.db --trial 8 --every 2",
        "robust other.db --trial 4 --samples 33",
        "robust pair.db",
        "pick other.db --robust --least mass_kg --alternatives 2 --tolerance 50",
        "pick other.db --robust --most height_m --json",
        "sensitivity other.db --trial 15 --samples 32 --within 5 --seed 3 --workers 1 --plot notes.html",
        "sensitivity other.db --tradeoff --limit mass_kg=4.4 --samples 32 --uncertainty mine.toml --workers 1 "
        "--plot notes.html --force",
        *(f"sensitivity other.db {words} --samples 33" for words in (
            "--knee --min-height 0.8", "--weights 1,2,3 --max-energy 80", "--compromise 1,2,3 --min mass_kg=3",
            "--nearest height_m=0.8 --max mass_kg=7", "--least mass_kg", "--most height_m",
        )),
    ),
    "limits": (
        "limit signed.db --trial 80 --jumps 20 --seed 4 --workers 1",
        "limit signed.db --min-height 0.75 --max-energy 60 --limit mass_kg=7 --min knee_ratio=4.1 --max hip_ratio=8.5 "
        "--designs 2 --jumps 20 --json --workers 1",
        "limit other.db --trial 0 --max-energy 60",
        "limit other.db --trial 900",
        "pick signed.db --trial 80",
        "pick signed.db --trial 80 --json",
    ),
    "replays": (
        "replay {legs}/dfki_hopping_leg.toml --samples 16 --seed 3 --fit friction --on 1",
        "replay {legs}/odri_teststand.toml --samples 16 --uncertainty mine.toml --json",
    ),
    "logs": (
        "compare log.csv C",
        "compare log.csv A --calibration ideal --json",
    ),
    "reports": (
        "report other.db",
        "report other.db -o page.html --no-jumps --exports none",
        "report pair.db -o notes.html --no-jumps",
        "report pair.db -o notes.html --no-jumps --force",
    ),
}  # fmt: skip
"""By what the commands are about. Some end in an error on purpose: its words and exit code are signed as well."""
EVERY = "every command"
UNSIGNED = {
    (EVERY, "--scheduler"): "needs the scheduler of another machine",
    (EVERY, "--processes"): "starts Python anew; tests/cli/test_computing.py compares it with threads",
    ("dashboard", EVERY): "a server",
    ("export", EVERY): "tests/cad/test_signatures.py signs what it writes",
    ("pareto", EVERY): "an export too; the commands that it is made of are signed",
    ("simulate", "--view"): "a window",
    ("simulate", "--gif"): "signed with the film's arguments below",
    ("simulate", "--video"): "likewise",
    ("simulate", "--slower"): "likewise",
    ("actuators", "--figure"): "tests/report/test_figures.py reads what it draws",
    ("report", "--figures"): "tests/report/test_figures.py reads what they draw",
}
"""Command and option that no line uses, and why."""
READABLE = (".csv", ".toml", ".xml")  #: Endings of files that are signed, where a command has written them.
CHANGING = {"version", "seconds", "database", "provenance", "reproduce", "group"}  #: What has hashes or times.
TIME_LEFT = re.compile(r"^.*\d/s, .*\n|, \d+:\d\d left", flags=re.M)


def of_page(payload):
    """The signature of each field of the page's content, by name."""
    parts = {f.name: (payload, f.name) for f in fields(payload) if f.name != "studies"}
    for k, card in enumerate(payload.studies):
        parts |= {f"studies{k or ''}.{f.name}": (card, f.name) for f in fields(card)}
    return {f"page {name}": signature(getattr(*at)) for name, at in parts.items() if at[1] not in CHANGING}


def test_commands_print_and_write_what_they_did(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "80")
    Path("signed.toml").write_text(SIGNED)
    found = {}
    words = {"db": "signed.db", "out": ".", "design": " ".join(DESIGN)}
    for command in ("run signed.toml --workers 1", *COMMANDS):
        code, out, err = run(capsys, *command.format(**words).split())
        assert code == 0, (command, err)
        found[command] = of_text(out + "\n" + TIME_LEFT.sub("", err))
    found |= {name: of_text(Path(name).read_text()) for name in FILES}
    data = read_study(Path("signed.db"))
    found |= of_page(build([Source(data=data, resimulation=resimulate(data), models={})]))
    compare(found, FOLDER / "signatures.json")


@pytest.fixture
def here(tmp_path, made_once, monkeypatch):
    """A folder with the studies, to which commands and paths refer."""
    go_to_studies(made_once, tmp_path, monkeypatch)
    return tmp_path


def log_of_a_jump(path):
    """A log of Case C's own jump every millisecond, with a torque constant 4 percent too high."""
    steps = trace(PAPER_CASES["C"].design).iloc[::5]
    columns = {
        "time_s": steps["time_s"],
        "height_mm": 1000.0 * steps["base_z_m"],
        "hip_deg": np.degrees(steps["hip_rad"]),
    }
    columns |= {"knee_rad": steps["knee_rad"]}
    columns |= {f"{joint}_current_a": 11.0 * steps[f"{joint}_motor_torque_n_m"] for joint in ("hip", "knee")}
    pd.DataFrame(columns).to_csv(path, index=False, float_format="%.6g")


def written(path):
    """The text of a file, without a column of times."""
    text = path.read_text()
    timed = "wall_time_s" in text.partition("\n")[0]
    return pd.read_csv(path).drop(columns="wall_time_s").to_csv() if timed else text


@pytest.mark.parametrize("about", OPTIONS)
def test_every_option_prints_and_writes_what_it_did(about, here, capsys):
    if about == "logs":
        log_of_a_jump("log.csv")
    found = {}
    for command in OPTIONS[about]:
        before = {path: path.stat().st_mtime_ns for path in Path().iterdir()}
        code, out, err = run(capsys, *command.format(legs=LEGS).split())
        digits = 3 if command.startswith("table1") else 6  # its calibration paper doubles the last digits of a jump
        found[command] = of_text(f"ended with {code}\n{out}\n{TIME_LEFT.sub('', err)}", digits)
        for path in sorted(Path().iterdir()):
            if path.suffix in READABLE and before.get(path) != path.stat().st_mtime_ns:
                found[f"{path} of {command}"] = of_text(written(path))
    compare(found, FOLDER / "signatures" / f"{about}.json")


def commands():
    """Every command with its options."""
    context = click.Context(cli)
    return {name: cli.get_command(context, name).params for name in cli.list_commands(context)}


def test_every_option_is_signed_or_has_a_reason():
    lines = [line.split() for line in (*COMMANDS, *(line for about in OPTIONS.values() for line in about))]
    used = {(name, word) for name, *words in lines for word in words}
    options = {(name, word) for name, params in commands().items() for one in params for word in one.opts[:1]}
    missing = {one for one in options if one[1].startswith("-") and one not in used}
    excused = {one for one in missing if {one, (one[0], EVERY), (EVERY, one[1])} & set(UNSIGNED)}
    assert not missing - excused, "no signed command has these options; add one to OPTIONS"
    assert not {name for name in commands() if (name, EVERY) not in UNSIGNED} - {name for name, *_ in lines}
    assert not used & set(UNSIGNED), "these are signed by now; take their reasons out"


def test_options_have_the_types_and_defaults_that_they_had():
    found = {}
    for name, params in commands().items():
        for one in params:
            limits = [getattr(one.type, key, None) for key in ("choices", "min", "max", "min_open")]
            told = (one.opts, one.type.name, limits, str(one.default), one.multiple, one.required)
            found[f"{name} {one.name}"] = signature(told)
    compare(found, FOLDER / "signatures" / "options.json")


def test_films_show_the_jump_at_the_pace_that_was_asked_for(here, capsys, monkeypatch):
    """The pictures themselves take seconds; tests/cad draws them."""
    asked = []

    def drawn(robot, steps, *, slower):
        asked.append(
            of_text(f"{robot.design} {robot.mass_kg} {slower} {[column.tolist() for column in steps.values()]}")
        )
        return [np.zeros((480, 720, 3), np.uint8)]

    monkeypatch.setattr(film, "film", drawn)
    monkeypatch.setattr(film, "require_video", lambda _: None)
    monkeypatch.setattr(film, "write_video", film.write_gif)
    lines = (
        "simulate --case A --hip-motor U8 --knee-motor VT8020 --gif a.gif",
        "simulate --case B --calibration paper --slower 2.5 --gif b.gif --video b.mp4",
        "simulate --case B --gif notes.csv",
        "simulate --slower 0.5",
    )
    found = {}
    for line in lines:
        code, out, err = run(capsys, *line.split())
        found[line] = of_text(f"ended with {code}\n{out}\n{err}")
    found |= {f"film {k}": one for k, one in enumerate(asked)}
    compare(found, FOLDER / "signatures" / "films.json")


def test_a_page_of_three_studies_has_what_it_had(here, capsys):
    """Of studies with other objectives, motors and calibrations, after what commands have stored with two of them."""
    for line in (
        "robust other.db --trial 51 --trial 4 --workers 1",
        "sensitivity other.db --trial 15 --samples 32 --workers 1",
        "limit signed.db --trial 80 --jumps 20 --workers 1",
    ):
        assert run(capsys, *line.split())[0] == 0
    names = [Path(f"{name}.db") for name in ("other", "signed", "pair")]
    notes = []
    payload = payload_of(names, exports=None, most_jumps=1, note=notes.append)
    found = of_page(replace(payload, literal=()))  # jumps of the calibration paper
    compare(found | {"notes": of_text(str(notes))}, FOLDER / "signatures" / "page.json")


def test_the_page_and_the_table_of_a_campaign_say_what_they_did(tmp_path):
    """Of studies that took the same time, one of which is missing and one failed."""
    campaign, results = made_campaign(tmp_path, AXES, fronts)
    page = campaign_page(campaign, results)
    tables = re.sub(r"<(script|style)\b.*?</\1>", "", page, flags=re.S)
    found = {
        "tables": of_text(tables),
        "charts": signature(content_of(page)),
        "csv": of_text(csv_text(campaign, results)),
    }
    compare(found, FOLDER / "signatures" / "campaign_page.json")


def test_what_is_found_of_designs_is_printed_in_its_place(capsys):
    """Of numbers that all differ: shares of few robots are often all or none, and could be exchanged."""
    found, numbered = numbered_limit()
    limit._print([found, replace(found, least_held=None, greatest_held=None, controller_gap_held=None, tracking=None)])
    spreads = {name: numbered(Spread) for name in HEIGHT_AND_ENERGY.names}
    built = numbered(Robustness, "failed", "overloaded", samples=64, measures=spreads)
    robustness._print({3: built}, HEIGHT_AND_ENERGY)
    printed = {"printed": of_text(capsys.readouterr().out), "in words": of_text(found.text())}
    compare(printed, FOLDER / "signatures" / "printed.json")

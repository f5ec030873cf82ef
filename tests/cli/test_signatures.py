"""What commands print and write about one study, and about jumps and gearboxes, is as it was.

The numbers and words are those of the day when ``signatures.json`` was made, after all other tests had passed: a change
is seen, nothing is proved. After a change that is wanted, look at what the command prints, and make the file again:
``PARETO_MONOPED_SIGN=1 python -m pytest tests/cli/test_signatures.py``. Times, hashes and folders are left out.
"""

import re
from dataclasses import fields
from pathlib import Path

from pareto_monoped import __version__
from pareto_monoped.report.card import Source
from pareto_monoped.report.page import build
from pareto_monoped.report.resimulation import resimulate
from pareto_monoped.storage.reader import read_study
from tests.cli.support import run
from tests.records import compare, signature

STUDY = """
name = "signed"
case = "C"
evaluations = 160
seed = 5
strength = false
algorithm = { name = "random" }
constraints = { mass_kg = { max = 7.0 } }
variables = { knee_release_rad = { lower = 0.0, upper = 0.4 }, start_height_m = { lower = 0.4, upper = 0.6 } }
"""
"""A random search asks for the same trials on every machine, whatever the last digits of its jumps are."""
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
NUMBER = re.compile(r"(?<![\w.])-?\d+\.?\d*(?:[eE][+-]?\d+)?")
NEVER_THE_SAME = re.compile(
    rf"{re.escape(__version__)}|(?<![.\w])[0-9a-f]{{16,64}}\b|\S*/pytest-\S*|\b\d\d\d\d-\d\d-\d\d\S*|\b\d\d:\d\d\S*"
    r"|[\d.,]+ (?:s|ms|h|MB|kB|bytes|per second)\b|[\d.]+(?: designs)?/s|\"\w*(?:second|wall_time)\w*\": [\d.]+"
)


def of_text(text):
    """The signature of a text: its words, and six digits of its numbers, for the last ones are the machine's."""
    text = NEVER_THE_SAME.sub("", text)
    numbers = [float(f"{float(one):.6g}") if abs(float(one)) > 1e-9 else 0.0 for one in NUMBER.findall(text)]
    return signature(numbers, NUMBER.sub("#", text))


CHANGING = {"version", "seconds", "database", "provenance", "reproduce", "group"}  #: What has hashes or times.


def of_page(db):
    """The signature of each field of the page's content, by name."""
    data = read_study(db)
    payload = build([Source(data=data, resimulation=resimulate(data), models={})])
    (card,) = payload.studies
    parts = {f.name: (payload, f.name) for f in fields(payload) if f.name != "studies"}
    parts |= {f"studies.{f.name}": (card, f.name) for f in fields(card)}
    return {f"page {name}": signature(getattr(*at)) for name, at in parts.items() if at[1] not in CHANGING}


def test_commands_print_and_write_what_they_did(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "80")
    Path("signed.toml").write_text(STUDY)
    found = {}
    words = {"db": "signed.db", "out": ".", "design": " ".join(DESIGN)}
    for command in ("run signed.toml --workers 1", *COMMANDS):
        code, out, err = run(capsys, *command.format(**words).split())
        assert code == 0, (command, err)
        found[command] = of_text(out + "\n" + re.sub(r"^.*\d/s, .*\n", "", err, flags=re.M))
    found |= {name: of_text(Path(name).read_text()) for name in FILES}
    found |= of_page(Path("signed.db"))
    compare(found, Path(__file__).parent / "signatures.json")

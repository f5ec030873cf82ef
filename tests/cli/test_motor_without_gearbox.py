"""A motor that no gearbox fits is refused by every command, in the same words."""

import json
import shutil
import sqlite3
from pathlib import Path

import pytest

from pareto_monoped import cli
from pareto_monoped.actuator.motors import load_motor, motor_values
from pareto_monoped.actuator.search import map_for
from pareto_monoped.design import PAPER_CASES
from pareto_monoped.errors import DesignError, MotorError
from pareto_monoped.leg.thigh_outline import require_leg
from pareto_monoped.robot.build import build_robot

TINY = """
kv_rpm_per_v = 300.0
max_continuous_current_a = 10.0
rated_voltage_v = 24.0
winding_resistance_ohm = 0.2
framed = { mass_kg = 0.05, outer_diameter_mm = 35.0, length_mm = 20.0 }
"""
SAYS = (
    "no gearbox fits at any ratio from 4 to 15, in the way is framed.outer_diameter_mm = 35 ({}); "
    "choose a larger motor or correct the file\n"
)
WORDS = SAYS.format(
    "contact_ratio, gearbox_diameter, meshing, no_interference, planet_rim, ring_root, root_fillet, sun_rim, teeth_min"
)
STORED_WORDS = SAYS.format("bearing_room, gearbox_diameter, ring_root, sun_rim, teeth_min")
"""The stored study's rules are those of the paper."""
STORED = Path(__file__).parent.parent / "storage" / "data" / "plain.db"


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A motor file, a study of it, and a study database whose motor it is, as no command would store it now."""
    monkeypatch.chdir(tmp_path)
    Path("tiny.toml").write_text(TINY)
    Path("study.toml").write_text('name = "s"\nmotor = "tiny.toml"\nevaluations = 40\n')
    shutil.copy(STORED, "stored.db")
    with sqlite3.connect("stored.db") as connection:
        (text,) = connection.execute("SELECT value FROM monoped_meta WHERE key = 'contents'").fetchone()
        contents = json.loads(text) | {"motor": motor_values(load_motor("tiny.toml"))}
        connection.execute("UPDATE monoped_meta SET value = ? WHERE key = 'contents'", (json.dumps(contents),))
    connection.close()
    return tmp_path


def refused(capsys, *words):
    """The line on stderr, without the notes before it."""
    with pytest.raises(SystemExit) as caught:
        cli.main(list(words))
    assert caught.value.code == 2
    output = capsys.readouterr()
    return output.out, output.err.splitlines(keepends=True)[-1]


@pytest.mark.parametrize(
    "words",
    [
        ("actuators", "--motor", "tiny.toml"),
        ("actuators", "--motor", "tiny.toml", "--json"),
        ("actuators", "--motor", "tiny.toml", "--ratio", "6.0"),
        ("simulate", "--motor", "tiny.toml"),
        ("run", "study.toml"),
    ],
)
def test_commands_that_are_given_the_file(capsys, folder, words):
    out, line = refused(capsys, *words)
    assert out == ""
    assert line.startswith("error: motor file ")
    assert line.endswith(f"tiny.toml': {WORDS}")
    assert not Path("study.db").exists()


@pytest.mark.parametrize(
    "words",
    [
        ("resume", "stored.db", "--evaluations", "100"),
        ("export", "stored.db", "--knee", "-o", "out"),
        ("report", "stored.db", "-o", "report.html"),
    ],
)
def test_commands_that_are_given_a_stored_study(capsys, folder, words):
    _, line = refused(capsys, *words)
    assert line == f"error: motor tiny: {STORED_WORDS}"
    assert sorted(path.name for path in folder.iterdir() if not path.name.startswith("stored.db")) == [
        "study.toml",
        "tiny.toml",
    ]


NARROW = (
    "framed.outer_diameter_mm = 55.0: must be at least 65 for a leg, so that the ears of the hip's stop are joined to "
    "the thigh; choose a wider motor, or design its gearboxes alone with actuators\n"
)


@pytest.mark.parametrize(
    "words",
    [
        ("simulate", "--motor", "narrow.toml"),
        ("run", "narrow_study.toml"),
        ("export", "--case", "C", "--motor", "narrow.toml", "-o", "out"),
    ],
)
def test_a_motor_with_gearboxes_that_the_leg_is_too_wide_for(capsys, folder, words):
    """55 mm across: seven gearboxes, and a thigh whose hip would end beside the ears of its stop."""
    Path("narrow.toml").write_text(TINY.replace("35.0", "55.0"))
    Path("narrow_study.toml").write_text('name = "s"\nmotor = "narrow.toml"\nevaluations = 40\n')
    assert "ESSPG" in cli_run(capsys, "actuators", "--motor", "narrow.toml").out
    _, line = refused(capsys, *words)
    assert line.startswith("error: motor file ")
    assert line.endswith(f"narrow.toml': {NARROW}")
    assert not Path("out").exists()


@pytest.mark.parametrize(("diameter_mm", "fits"), [("64.9", False), ("65.1", True)])
def test_the_width_that_the_message_asks_for_is_enough(folder, diameter_mm, fits):
    Path("edge.toml").write_text(TINY.replace("35.0", diameter_mm).replace("mass_kg = 0.05", "mass_kg = 0.1"))
    found = map_for("edge.toml")
    if fits:
        require_leg(found)
        assert build_robot(PAPER_CASES["C"].design, found).mass_kg > 1.0
    else:
        with pytest.raises(MotorError, match="must be at least 65 for a leg"):
            require_leg(found)
        with pytest.raises(DesignError, match="the thigh's radius in mm at the hip"):
            build_robot(PAPER_CASES["C"].design, found)


def test_the_main_job(capsys, folder):
    _, line = refused(capsys, "pareto", "study.toml", "-o", "out")
    assert line.endswith(WORDS)


def test_the_csv_of_an_empty_map_has_its_header(capsys, folder):
    full = Path("full.csv")
    cli_run(capsys, "actuators", "--ratio", "6.0", "--csv", str(full))
    header = full.read_text().splitlines()[0]
    refused(capsys, "actuators", "--motor", "tiny.toml", "--csv", "empty.csv")
    assert Path("empty.csv").read_text() == header + "\n"
    out, line = refused(capsys, "actuators", "--motor", "tiny.toml", "--csv", "-")
    assert out == header + "\n"
    assert line.endswith(WORDS)


def test_csv_on_standard_output_is_the_file_and_nothing_else(capsys, folder):
    cli_run(capsys, "actuators", "--csv", "map.csv")
    assert cli_run(capsys, "actuators", "--csv", "-").out == Path("map.csv").read_text()
    assert not Path("-").exists()
    _, line = refused(capsys, "actuators", "--json", "--csv", "-")
    assert "--json and --csv - both print to standard output" in line


@pytest.mark.parametrize("ratio", ["1e300", "-1e300", "nan", "inf"])
def test_ratios_that_no_whole_number_holds(capsys, folder, ratio):
    """Warnings are errors in tests."""
    _, line = refused(capsys, "actuators", "--ratio", ratio)
    assert f"gear ratio = {float(ratio)!r}: outside the map of VT8020" in line


def cli_run(capsys, *words):
    with pytest.raises(SystemExit) as caught:
        cli.main(list(words))
    assert not caught.value.code
    return capsys.readouterr()

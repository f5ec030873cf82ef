"""The command ``actuators``: forms that others rely on, and one line for every wrong input."""

import csv
import json

import pytest

from pareto_monoped import cli

KEYS = [
    "ratio_low",
    "ratio",
    "type",
    "sun_teeth",
    "planet_teeth",
    "ring_teeth",
    "module_mm",
    "planets",
    "face_width_mm",
    "mass_kg",
    "peak_torque_n_m",
    "efficiency",
]


def run(capsys, *arguments):
    with pytest.raises(SystemExit) as caught:
        cli.main(["actuators", *arguments])
    return caught.value.code or 0, capsys.readouterr()


def test_json_has_exactly_the_agreed_keys(capsys):
    code, output = run(capsys, "--json")
    rows = json.loads(output.out)
    assert code == 0
    assert output.err == ""
    assert all(list(row) == KEYS for row in rows)
    assert [row["ratio_low"] for row in rows] == [low / 10 for low in range(40, 88)]
    nominal = rows[20]
    assert (nominal["type"], nominal["sun_teeth"], nominal["ring_teeth"], nominal["planets"]) == ("ISSPG", 18, 90, 3)


def test_table_fits_80_columns_and_explains_where_it_ends(capsys):
    code, output = run(capsys)
    lines = output.out.splitlines()
    assert code == 0
    assert max(len(line) for line in lines) <= 80
    assert any("18/36/90" in line and "6.000" in line for line in lines)
    assert "No gearbox from 8.8 to 15.0" in output.out
    assert "sun_rim" in output.out


def test_csv_holds_the_same_rows_as_json(capsys, tmp_path):
    path = tmp_path / "map.csv"
    _, output = run(capsys, "--json", "--csv", str(path))
    rows = json.loads(output.out)
    with path.open(newline="") as stream:
        written = list(csv.DictReader(stream))
    assert [list(row) for row in written] == [KEYS] * len(rows)
    assert [float(row["mass_kg"]) for row in written] == [row["mass_kg"] for row in rows]


def test_one_ratio_is_explained_part_by_part(capsys):
    code, output = run(capsys, "--ratio", "6.0")
    assert code == 0
    for words in ("18/36/90", "Runner-up", "ring_root", "planet_pin", "reflected inertia"):
        assert words in output.out
    _, output = run(capsys, "--ratio", "7.95", "--json")
    detail = json.loads(output.out)
    assert list(detail)[: len(KEYS)] == KEYS
    assert detail["ratio_low"] == 7.9
    assert sum(part["mass_kg"] for part in detail["parts"]) == pytest.approx(detail["mass_kg"])
    # A ball bearing as a ring between its diameters: 55 x 72 mm, 81 g.
    bearing = next(part for part in detail["parts"] if part["name"] == "main_bearing")
    ring = 0.081 * 0.5 * (0.0275**2 + 0.036**2)
    assert bearing["axial_inertia_kg_m2"] == pytest.approx(ring)
    assert detail["runner_up"]["mass_kg"] > detail["mass_kg"]
    assert detail["families"]["ISSPG"]["gears"] is None


def test_switching_a_constraint_off_changes_the_map(capsys):
    _, output = run(capsys, "--json", "--without", "sun_rim")
    assert json.loads(output.out)[-1]["ratio_low"] > 8.7


def test_another_motor(capsys):
    _, output = run(capsys, "--motor", "mad_m6c12", "--json")
    assert {row["type"] for row in json.loads(output.out)} == {"ESSPG"}


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("--motor", "VT"), ("motor = 'VT'", "VT8020")),
        (("--motor", "missing.toml"), ("missing.toml", "no such file")),
        (("--ratio", "9.3"), ("9.3", "sun_rim", "[4.0, 8.8)")),
        (("--ratio", "2"), ("outside the map",)),
        (("--without", "rim"), ("constraints_off = 'rim'",)),
        (("--csv", "/nonexistent/map.csv"), ("/nonexistent/map.csv", "cannot be written")),
    ],
)
def test_wrong_input_is_one_line_and_code_2(capsys, arguments, words):
    code, output = run(capsys, *arguments)
    assert code == 2
    assert output.err.count("\n") == 1
    for word in words:
        assert word in output.err

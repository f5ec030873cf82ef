"""A motor file that contradicts itself ends every command with one line: file, key, cure."""

from pathlib import Path

import pytest

from pareto_monoped import cli

GOOD = {
    "kv_rpm_per_v": "100.0",
    "max_continuous_current_a": "40.0",
    "rated_voltage_v": "48.0",
    "winding_resistance_ohm": "0.06",
    "framed": "{ mass_kg = 0.71, outer_diameter_mm = 89.0, length_mm = 50.0 }",
}
BAD = {
    "contradictory": ({"torque_constant_n_m_per_a": "0.5"}, "torque_constant_n_m_per_a = 0.5", "leave out"),
    "huge torque": (
        {"peak_torque_n_m": "300.0", "winding_resistance_ohm": "0.001"},
        "peak_torque_n_m = 300",
        "correct it",
    ),
    "2 mm long": (
        {"framed": "{ mass_kg = 0.71, outer_diameter_mm = 89.0, length_mm = 2.0 }"},
        "framed.length_mm = 2",
        "correct it",
    ),
    "huge voltage": ({"rated_voltage_v": "9999999999999999999999"}, "rated_voltage_v = 1e+22", "correct it"),
    "holes outside": (
        {"mount_holes": "{ pitch_circle_mm = 300.0, diameter_mm = 4.0, count = 4 }"},
        "mount_holes.pitch_circle_mm = 300",
        "correct one of them",
    ),
    "tiny": (
        {
            "framed": "{ mass_kg = 0.05, outer_diameter_mm = 34.0, length_mm = 20.0 }",
            "max_continuous_current_a": "5.0",
        },
        "framed.outer_diameter_mm = 34",
        "choose a larger motor",
    ),
}
COMMANDS = {
    "actuators": ("actuators", "--motor", "bad.toml"),
    "simulate": ("simulate", "--motor", "bad.toml"),
    "run": ("run", "study.toml"),
    "export": ("export", "--case", "C", "--motor", "bad.toml", "-o", "out"),
}


@pytest.mark.parametrize("command", COMMANDS)
@pytest.mark.parametrize("case", BAD)
def test_one_line_with_file_key_and_cure(capsys, monkeypatch, tmp_path, case, command):
    changes, key, cure = BAD[case]
    monkeypatch.chdir(tmp_path)
    Path("bad.toml").write_text("".join(f"{name} = {value}\n" for name, value in (GOOD | changes).items()))
    Path("study.toml").write_text('name = "s"\nmotor = "bad.toml"\nevaluations = 40\n')
    with pytest.raises(SystemExit) as caught:
        cli.main(list(COMMANDS[command]))
    assert caught.value.code == 2
    output = capsys.readouterr()
    (line,) = output.err.splitlines()
    assert output.out == ""
    assert line.startswith("error: motor file ")
    assert f"bad.toml': {key}: " in line
    assert cure in line
    assert sorted(path.name for path in tmp_path.iterdir()) == ["bad.toml", "study.toml"]

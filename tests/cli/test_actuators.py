"""The command ``actuators``: forms that others rely on, and one line for every wrong input."""

import csv
import json
import re
from dataclasses import replace

import pytest

from pareto_monoped import cli
from pareto_monoped.actuator.search import map_for
from pareto_monoped.actuator.service.sheet import service_sheet
from pareto_monoped.cli.actuator_sheets import duty_lines

KEYS = [
    "ratio_low",
    "ratio",
    "type",
    "sun_teeth",
    "planet_teeth",
    "ring_teeth",
    "module_mm",
    "planets",
    "sun_shift",
    "planet_shift",
    "ring_shift",
    "centre_distance_mm",
    "face_width_mm",
    "mass_kg",
    "peak_torque_n_m",
    "efficiency",
    "continuous_torque_n_m",
    "no_load_speed_rad_per_s",
    "length_mm",
    "reflected_inertia_kg_m2",
    "efficiency_mesh",
    "efficiency_planets",
    "efficiency_bearings",
    "efficiency_total",
    "bearing_life_h",
    "output_tilt_n_m",
    "backlash_arcmin",
    "greatest_backlash_arcmin",
    "stiffness_n_m_per_rad",
    "peak_torque_basis",
    "peak_torque_time",
    "continuous_torque_basis",
    "continuous_torque_time",
    "lasting_torque_n_m",
]


def run(capsys, *arguments):
    # The figures below are those of the rules of the paper, unless a test names others.
    rules = () if "--rules" in arguments or "--help" in arguments else ("--rules", "paper")
    with pytest.raises(SystemExit) as caught:
        cli.main(["actuators", *rules, *arguments])
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


def test_the_help_ends_with_a_paragraph_of_constraints(capsys):
    code, output = run(capsys, "--help")
    *_, before, names = output.out.strip().split("\n\n")
    assert code == 0
    assert names.split()[:3] == ["Constraints", "of", "--without:"]
    assert before.split()[0] == "Options:"


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
        (("--rules", "iso6336", "--ratio", "13"), ("13.0", "no gearbox", "would help")),
        (("--without", "rim"), ("constraints_off = 'rim'",)),
        (("--csv", "/nonexistent/map.csv"), ("/nonexistent/map.csv", "cannot be written")),
        (("--figure", "map.gif"), ("figure = 'map.gif'", "svg, png, pdf")),
        (("--figure", "/nonexistent/map.svg"), ("/nonexistent/map.svg", "cannot be written")),
    ],
)
def test_wrong_input_is_one_line_and_code_2(capsys, arguments, words):
    code, output = run(capsys, *arguments)
    assert code == 2
    assert output.err.count("\n") == 1
    for word in words:
        assert word in output.err


def test_units_and_rounding_of_the_printed_map(capsys):
    """One line against the values of JSON: mass in kg to the gram, efficiency in percent, module and face in mm."""
    row = next(row for row in json.loads(run(capsys, "--json")[1].out) if row["ratio_low"] == 6.0)
    (line,) = [line for line in run(capsys)[1].out.splitlines() if line.split()[:1] == ["6.0"]]
    assert line.split() == [
        "6.0",
        f"{row['ratio']:.3f}",
        "ISSPG",
        "18/36/90",
        f"{row['module_mm']:g}",
        "3",
        f"{row['face_width_mm']:.1f}",
        f"{row['mass_kg']:.3f}",
        f"{row['peak_torque_n_m']:.1f}",
        f"{100 * row['efficiency']:.1f}",
    ]


def test_units_and_rounding_of_the_printed_parts(capsys):
    """Masses in grams, shares of the actuator in percent, inertias in kg mm2."""
    known = json.loads(run(capsys, "--ratio", "6.0", "--json")[1].out)
    printed = run(capsys, "--ratio", "6.0")[1].out
    part = known["parts"][0]
    (line,) = [line for line in printed.splitlines() if line.split()[:1] == [part["name"]]]
    assert line.split()[-4:] == [
        f"{part['count']}",
        f"{part['mass_kg'] * 1e3:.1f}",
        f"{part['mass_kg'] / known['mass_kg'] * 100:.1f}",
        f"{part['axial_inertia_kg_m2'] * 1e6:.2f}",
    ]
    assert f"{known['peak_torque_n_m']:.2f} N m" in printed
    assert f"{known['reflected_inertia_kg_m2']:.5f} kg m2" in printed
    assert f"{known['contact_ratio_sun']:.2f} sun, {known['contact_ratio_ring']:.2f} ring" in printed
    assert f"Runner-up: {known['runner_up']['type']} {known['runner_up']['gears']}" in printed
    (other,) = (family for family in known["families"] if family != known["type"])
    assert f"Best {other}: {known['families'][other]['gears']}" in printed
    for name in known["binding"]:
        assert f"  {name}: " in printed


def test_the_sheet_of_one_ratio_prints_losses_bearings_and_stiffness_in_80_columns(capsys):
    known = json.loads(run(capsys, "--ratio", "6.0", "--json")[1].out)
    printed = run(capsys, "--ratio", "6.0")[1].out
    assert max(len(line) for line in printed.splitlines()) <= 80
    percent = [f"{100 * known[f'efficiency_{source}']:.1f}" for source in ("total", "mesh", "planets", "bearings")]
    assert "{} %: mesh {}, planets {}, bearings {} %".format(*percent) in printed
    assert f"{1e-3 * known['stiffness_n_m_per_rad']:.1f} kN m/rad at most" in printed
    least, most = known["backlash_arcmin"], known["greatest_backlash_arcmin"]
    assert f"{least:.1f} arcmin at least, {most:.1f} at most by the teeth" in printed
    assert f"pv {known['bush']['pv_mpa_m_per_s']:.1f} MPa m/s" in printed
    main = known["bearings"][0]
    (line,) = [line for line in printed.splitlines() if line.startswith(" main, knee")]
    assert line.split()[2:] == [
        "6808",
        "40x52x7",
        f"{main['force_n']:.0f}",
        f"{main['equivalent_n']:.0f}",
        f"{1e3 * main['tilt_rad']:.1f}",
        *([">", "1e6"] if main["life_h"] > 1e6 else [f"{main['life_h']:.0f}"]),
        f"{main['static_safety']:.2f}",
        f"{main['overload_safety']:.2f}",
    ]
    assert "each 1 rad at 1, 1 rad at 0.5 and 1 rad at 0.35 (reversed) of the peak torque." in " ".join(printed.split())


def warnings_of(**service):
    """What is printed about the VT8020's 6:1 gearbox under the rules of the paper, with another service."""
    found = map_for("VT8020", "paper")
    data = replace(found.settings.service, **service)
    return " ".join(duty_lines(service_sheet(found.lookup(6.0), found.settings, data), found.settings, data))


def test_a_bearing_that_the_overload_marks_is_named():
    """A foot force of 40 kN in place of the push-off's."""
    assert "Bearing main, hip: s0 = 0." in warnings_of(foot_force_n=40e3)
    assert "s0 = " not in warnings_of()


def test_a_bearing_that_tilts_too_far_is_named():
    """The chain's pull tilts the main bearing until the drive's far end meets its bearing, here 0.5 mm away."""
    found = re.search(
        r"Bearing main, knee: its rings tilt by ([\d.]+) mrad", warnings_of(drive_support_clearance_mm=0.5)
    )
    assert found
    assert 2.9 < float(found[1]) < 20.0
    assert "its rings tilt" not in warnings_of()


def test_bushes_beyond_their_pv_limit_are_named(capsys):
    words = "exceeds even the limit for short periods"
    assert words in " ".join(run(capsys, "--ratio", "4.0")[1].out.split())
    assert words not in " ".join(run(capsys, "--ratio", "6.0")[1].out.split())


@pytest.mark.parametrize(
    ("kind", "head"),
    [
        ("svg", b"<?xml"),
        *(pytest.param(*one, marks=pytest.mark.long) for one in (("png", b"\x89PNG"), ("pdf", b"%PDF"))),
    ],
)
def test_the_map_as_a_figure(capsys, tmp_path, kind, head):
    path = tmp_path / f"map.{kind}"
    code, _ = run(capsys, "--figure", str(path), "--json")
    assert code == 0
    assert path.read_bytes().startswith(head)


def test_the_figure_shows_both_sets_of_rules(capsys, tmp_path, monkeypatch):
    from pareto_monoped.report import figures

    drawn = []
    monkeypatch.setattr(figures, "write_map_figure", lambda maps, path, *, force: drawn.append(maps))
    run(capsys, "--rules", "iso6336", "--figure", str(tmp_path / "map.svg"), "--json")
    (maps,) = drawn
    assert list(maps) == ["iso6336", "paper"]
    assert {name: found.settings.rules for name, found in maps.items()} == {"iso6336": "iso6336", "paper": "paper"}


def test_rated_map_has_safety_factors_in_json_csv_and_table(capsys, tmp_path):
    path = tmp_path / "map.csv"
    code, output = run(capsys, "--rules", "iso6336", "--json", "--csv", str(path))
    rows = json.loads(output.out)
    assert code == 0
    safeties = [f"{event}{place}_safety" for event in ("", "overload_") for place in ("flank", "root")]
    assert all(list(row) == [*KEYS, *safeties] for row in rows)
    assert all(row["flank_safety"] >= 1.1 and row["root_safety"] >= 1.4 and row["planets"] >= 3 for row in rows)
    with path.open(newline="") as stream:
        written = list(csv.DictReader(stream))
    assert [float(row["root_safety"]) for row in written] == [row["root_safety"] for row in rows]
    printed = run(capsys, "--rules", "iso6336")[1].out
    assert max(map(len, printed.splitlines())) <= 80
    assert "…" not in printed
    (line,) = [line for line in printed.splitlines() if line.split()[:1] == ["6.0"]]
    (row,) = [row for row in rows if row["ratio_low"] == 6.0]
    assert line.split()[-4:] == [
        f"{row['mass_kg']:.3f}",
        f"{100 * row['efficiency']:.1f}",
        f"{row['flank_safety']:.2f}",
        f"{row['root_safety']:.2f}",
    ]
    assert "Would help: a larger sun, a harder steel" in printed


def test_rated_gear_set_prints_a_gear_calculation_sheet(capsys):
    known = json.loads(run(capsys, "--rules", "iso6336", "--ratio", "6.0", "--json")[1].out)
    printed = run(capsys, "--rules", "iso6336", "--ratio", "6.0")[1].out
    assert max(map(len, printed.splitlines())) <= 80
    assert "…" not in printed
    mesh = known["rating"]["sun_mesh"]
    ring = known["rating"]["ring_mesh"]

    def cells(first):
        (line,) = [line for line in printed.splitlines() if line.strip().startswith(first)]
        return line.split()

    gears = [mesh["pinion"], mesh["wheel"], ring["pinion"], ring["wheel"]]
    assert [gear["gear"] for gear in gears] == ["sun", "planet", "planet", "ring"]
    for first, key, form in (
        ("tangential force", "tangential_force_n", ".1f"),
        ("pitch-line speed", "pitch_speed_m_per_s", ".2f"),
        ("contact ratio epsilon", "contact_ratio", ".3f"),
        ("application", "application_factor", ".3f"),
        ("load sharing", "sharing_factor", ".3f"),
        ("dynamic", "dynamic_factor", ".3f"),
        ("face load, flank", "face_load_factor", ".3f"),
        ("face load, root", "root_face_load_factor", ".3f"),
        ("transverse load, flank", "transverse_load_factor", ".3f"),
        ("transverse load, root", "root_transverse_load_factor", ".3f"),
        ("overload, flank K_Hbeta", "overload_face_load_factor", ".3f"),
        ("overload, root K_Fbeta", "overload_root_face_load_factor", ".3f"),
        ("overload, flank K_Halpha", "overload_transverse_load_factor", ".3f"),
        ("overload, root K_Falpha", "overload_root_transverse_load_factor", ".3f"),
    ):
        assert cells(first)[-2:] == [format(one[key], form) for one in (mesh, ring)]
    for first, key, form in (
        ("single contact", "single_contact_factor", ".3f"),
        ("flank load cycles", "flank_cycles", ".2g"),
        ("life Z_NT", "flank_life_factor", ".3f"),
        ("contact stress", "contact_stress_mpa", ".0f"),
        ("limit sigma_HG", "contact_limit_mpa", ".0f"),
        ("S_H, at least 1.1", "flank_safety", ".2f"),
        ("S_H at overload, at least 1", "overload_flank_safety", ".2f"),
        ("form Y_F", "form_factor", ".3f"),
        ("stress correction", "stress_correction", ".3f"),
        ("rim Y_B", "rim_factor", ".3f"),
        ("root load cycles", "root_cycles", ".2g"),
        ("life Y_NT", "root_life_factor", ".3f"),
        ("bending stress", "bending_stress_mpa", ".0f"),
        ("limit sigma_FG", "bending_limit_mpa", ".0f"),
        ("S_F, at least 1.4", "root_safety", ".2f"),
        ("S_F at overload, at least 1.2", "overload_root_safety", ".2f"),
    ):
        assert cells(first)[-4:] == [format(gear[key], form) for gear in gears]
    for words in ("100000 jumps", "18CrNiMo7-6, case-hardened", "31CrMoV9, gas-nitrided", "class 6"):
        assert words in printed


def test_a_ratio_without_a_gearbox_shows_the_nearest_and_says_so(capsys):
    code, output = run(capsys, "--rules", "iso6336", "--ratio", "9.25", "--json")
    known = json.loads(output.out)
    assert code == 0
    assert output.err.startswith("note: ")
    assert known["stand_in"] in " ".join(output.err.split())
    assert "would help" in known["stand_in"]
    assert not 9.2 <= known["ratio"] < 9.3
    assert abs(known["ratio"] - 9.25) < 1.5
    assert "stand_in" not in json.loads(run(capsys, "--rules", "iso6336", "--ratio", "6", "--json")[1].out)


def test_one_ratio_as_csv_is_one_row(capsys, tmp_path):
    path = tmp_path / "one.csv"
    run(capsys, "--ratio", "6.0", "--csv", str(path))
    with path.open(newline="") as stream:
        (row,) = csv.DictReader(stream)
    assert (row["ratio_low"], row["sun_teeth"], row["planet_teeth"]) == ("6.0", "18", "36")


def test_bearings_by_regression_change_masses(capsys):
    listed = json.loads(run(capsys, "--json")[1].out)
    regressed = json.loads(run(capsys, "--json", "--bearings", "regression")[1].out)
    assert any(a["mass_kg"] != b["mass_kg"] for a, b in zip(listed, regressed, strict=False))

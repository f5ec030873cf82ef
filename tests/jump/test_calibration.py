from dataclasses import replace

import pytest

from pareto_monoped.errors import CalibrationError
from pareto_monoped.jump.calibration import (
    FadeGate,
    calibration_names,
    calibration_of,
    calibration_values,
    earlier_calibrations,
    load_calibration,
    on_stand,
)
from pareto_monoped.jump.calibration_defaults import rules_for, strength_for


def test_five_ship_and_the_default_is_the_well_posed_one():
    assert calibration_names() == ("reference", "ideal", "paper", "printed", "stand")
    assert load_calibration().name == "reference"
    assert isinstance(load_calibration().gate, FadeGate)


def test_printed_is_the_reference_with_the_losses_of_printed_gears():
    printed, known = calibration_values(load_calibration("printed")), calibration_values(load_calibration())
    assert printed["drive"].pop("gear_loss") == pytest.approx((1.3 * 4.0) ** 0.5, abs=0.05)
    for values in (printed, known):
        del values["name"], values["version"], values["description"]
    assert printed == known


@pytest.mark.parametrize("name", calibration_names())
def test_file_and_record_have_the_same_name(name):
    calibration = load_calibration(name)
    assert calibration.name == name
    assert calibration.label == f"{name}-{calibration.version}"


def test_paper_is_literal():
    paper = load_calibration("paper")
    assert paper.gate.rule == "contact"
    assert paper.simulation.timestep_s == 0.002
    assert not paper.drive.voltage_limit
    assert paper.controller.gravity_feed_forward == 1.0
    assert paper.mass.rotor_inertia_kg_m2 == 0.0
    assert paper.drive.chain_efficiency == paper.drive.peak_torque_scale == 1.0
    assert paper.joints.hip_stop is paper.joints.knee_stop is None


def test_ideal_is_reference_without_losses_and_with_rigid_drives():
    reference, ideal = load_calibration("reference"), load_calibration("ideal")
    without = {
        "joints": {"friction_share": 0.0, "motor_damping_share_s_per_rad": 0.0},
        "drive": {
            "mesh_losses": False, "chain_efficiency": 1.0, "winding_rise_k": 0.0,
            "elastic": False, "drive_damping_ratio": 0.0,
        },
        "simulation": {"timestep_s": 0.001},
    }  # fmt: skip
    assert ideal.joints.damping_n_m_s_per_rad == ideal.joints.friction_n_m == 0.0
    same = {table: replace(getattr(reference, table), **values) for table, values in without.items()}
    assert replace(reference, name="ideal", version=4, description=ideal.description, **same) == ideal


def test_the_default_is_elastic_and_the_version_before_rigid():
    """Version 4 differs from version 3 in what a bench shows besides, and in the step that stiff drives need."""
    now, before = load_calibration("reference"), load_calibration("reference-3")
    assert (now.label, before.label) == ("reference-4", "reference-3")
    assert (now.drive.elastic, now.drive.battery, now.simulation.engine) == (True, "bus", "compiled")
    assert (before.drive.elastic, before.drive.battery, before.simulation.engine) == (False, "each_motor", "mujoco")
    assert now.joints.stop_law == "hunt_crossley" != before.joints.stop_law
    same = replace(
        now, version=3, description=before.description, joints=before.joints, drive=before.drive,
        simulation=replace(now.simulation, engine="mujoco", timestep_s=0.001),
    )  # fmt: skip
    assert same == before


def test_stand_is_reference_on_its_rails_and_any_calibration_goes_there():
    stand, paper = load_calibration("stand"), load_calibration("paper")
    guided = on_stand(load_calibration("reference"))
    assert replace(guided, name="stand", version=stand.version, description=stand.description) == stand
    assert on_stand(stand) is stand
    assert on_stand(paper).stand == stand.stand
    assert on_stand(paper).simulation == paper.simulation


def test_a_stand_is_left_out_of_stored_values_where_there_is_none():
    """Studies stored before there was one keep their hash."""
    assert "stand" not in calibration_values(load_calibration("reference"))
    assert calibration_values(load_calibration("stand"))["stand"] == {"rail_friction_n": 1.0}
    for name in calibration_names():
        known = load_calibration(name)
        assert calibration_of(calibration_values(known), source="again") == known


def test_a_base_that_slides_away_is_on_no_stand(tmp_path):
    path = tmp_path / "away.toml"
    path.write_text(_text("stand").replace("base_slides = false", "base_slides = true"))
    with pytest.raises(CalibrationError, match="base_slides must be false with a table stand"):
        load_calibration(str(path))


def _text(name="reference"):
    import pareto_monoped

    folder = pareto_monoped.__path__[0]
    with open(f"{folder}/data/calibrations/{name}.toml", encoding="utf-8") as stream:
        return stream.read()


def test_a_users_file_is_read_by_its_path(tmp_path):
    path = tmp_path / "mine.toml"
    path.write_text(_text().replace('name = "reference"', 'name = "mine"').replace("version = 4", "version = 7"))
    assert load_calibration(str(path)).label == "mine-7"


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("timestep_s = 0.0002", "timestep_s = -0.001", "simulation.timestep_s = -0.001"),
        ("timestep_s = 0.0002", "timestep_s = nan", "simulation.timestep_s = nan"),
        ("timestep_s = 0.0002", "timestep_s = 1e-9", "must be at least 3e-06, a millionth of time_limit_s"),
        ("timestep_s = 0.0002", "timestep_s = 1e-320", "must be a whole multiple of timestep_s"),
        ('integrator = "Euler"', 'integrator = "RK4"', "RK4 needs 'state'"),
        ("[controller]", "[controller]\nrest_lenght_m = 9.0", "rest_lenght_m"),
        ('integrator = "Euler"', 'integrator = "Leapfrog"', "simulation.integrator = 'Leapfrog'"),
        ("friction = 1.0\n", "", "friction is missing"),
        ("chain_efficiency = 0.98", "chain_efficiency = 1.02", "drive.chain_efficiency = 1.02"),
        ("impedance = 0.2", "impedance = 1.0", "impedance = 1.0"),
        ('rule = "fade"', 'rule = "latch"', "latch"),
        ("lower_rad = 0.2618", "lower_rad = 3.0", "lower_rad 3.0 must be below upper_rad"),
        ("[simulation]", "[simulation", "not valid TOML"),
    ],
)
def test_a_wrong_field_is_named_in_one_line(tmp_path, old, new, said):
    path = tmp_path / "wrong.toml"
    text = next(text for text in (_text(), _text("earlier/reference-1")) if old in text)
    path.write_text(text.replace(old, new))
    with pytest.raises(CalibrationError) as caught:
        load_calibration(str(path))
    assert said in str(caught.value)
    assert "\n" not in str(caught.value)


def test_stops_are_given_or_those_of_the_parts(tmp_path):
    path = tmp_path / "both.toml"
    path.write_text(_text("earlier/reference-1").replace("[joints]", '[joints]\nstops = "parts"'))
    with pytest.raises(CalibrationError, match="goes without hip_stop and knee_stop"):
        load_calibration(str(path))


@pytest.mark.parametrize("name", calibration_names())
def test_the_present_version_is_loaded_by_its_label_too(name):
    known = load_calibration(name)
    assert load_calibration(known.label) == known
    assert rules_for(known.label) == rules_for(name)
    assert strength_for(known.label) == strength_for(name)
    with pytest.raises(CalibrationError, match=f"did you mean '{known.label}'"):
        load_calibration(f"{name}-{known.version + 1}")


@pytest.mark.parametrize("label", earlier_calibrations())
def test_an_earlier_version_is_loaded_by_its_label_and_has_its_own_hash(label):
    """The values are those that its version stored with its studies, without what came later."""
    values = calibration_values(load_calibration(label))
    assert f"{values['name']}-{values['version']}" == label
    assert ("efficiency" in values["drive"]) == (label in ("reference-3", "ideal-3", "stand-1"))
    assert not {"battery", "elastic", "winding_rise_k", "backlash_rad", "drive_damping_ratio"} & set(values["drive"])
    assert not {"stop_law", "friction_share", "motor_damping_share_s_per_rad"} & set(values["joints"])
    assert "engine" not in values["simulation"]
    if values["version"] == 1 and label != "stand-1":
        assert not {"rotors", "stops"} & set(values["joints"])
        assert not {"control_period_s", "delay_s", "positions_read"} & set(values["simulation"])


@pytest.mark.parametrize("name", ["reference", "ideal"])
def test_version_3_reads_the_whole_gearbox_and_is_version_2_otherwise(name):
    now, before = load_calibration(f"{name}-3"), load_calibration(f"{name}-2")
    assert (now.drive.efficiency, before.drive.efficiency) == ("total", "mesh")
    assert replace(now, version=2, drive=replace(now.drive, efficiency="mesh")) == before


@pytest.mark.parametrize("name", ["refrence", "missing.toml", "no/such/file"])
def test_an_unknown_name_or_file_is_an_input_error(name):
    with pytest.raises(CalibrationError, match=name):
        load_calibration(name)


def test_readings_that_came_later_are_not_stored_at_their_defaults():
    """Studies stored before these fields existed keep their hash; a calibration that sets them is read back whole."""
    later = {"drive": "knee_torque_scale", "controller": "weight"}
    stored = calibration_values(load_calibration())
    assert all(name not in stored[table] for table, name in later.items())
    assert "flight" not in stored["controller"]
    paper = load_calibration("paper")
    stored = calibration_values(paper)
    assert all(name in stored[table] for table, name in later.items())
    assert calibration_of(stored, source="test") == paper


def test_torque_in_flight_needs_a_gate_that_does_not_end_it(tmp_path):
    path = tmp_path / "wrong.toml"
    flight = "[controller.flight]\nstiffness_n_m_per_rad = 100.0\ndamping_n_m_s_per_rad = 10.0\n\n[simulation]"
    path.write_text(_text().replace("[simulation]", flight))
    with pytest.raises(CalibrationError, match=r"gate\.rule 'fade' must be 'contact'"):
        load_calibration(str(path))

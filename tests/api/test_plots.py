"""Figures show the numbers they are made from, by either library."""

import numpy as np
import pytest

import pareto_monoped as pm
from pareto_monoped.errors import InputError


@pytest.fixture(scope="module")
def stored(tmp_path_factory):
    return pm.run(pm.Study.define(name="s", evaluations=120, algorithm="random"), tmp_path_factory.mktemp("p") / "s.db")


def test_the_front_stands_at_its_objectives(stored):
    front = stored.front()
    by_plotly = pm.plot_front(stored)
    np.testing.assert_array_equal(by_plotly.data[-1].x, front["energy_j"])
    np.testing.assert_array_equal(by_plotly.data[-1].y, front["height_m"])
    assert by_plotly.layout.xaxis.title.text.endswith("(J)")
    (axes,) = pm.plot_front(stored, backend="matplotlib").axes
    np.testing.assert_array_equal(axes.lines[-1].get_xdata(), front["energy_j"])


def test_other_axes_and_several_studies(stored):
    figure = pm.plot_front([stored, stored], x="mass_kg", y="lift_off_s", trials=False)
    assert len(figure.data) == 2
    np.testing.assert_array_equal(figure.data[0].x, stored.front()["mass_kg"])
    with pytest.raises(InputError, match=r"^studies = DataFrame: must be a study as load_study returns it, or a list"):
        pm.plot_front(stored.front())
    with pytest.raises(InputError, match="axis = 'mass'"):
        pm.plot_front(stored, x="mass")


def test_gearboxes_stand_in_the_order_of_their_ratios():
    actuators = pm.actuator_map("U8")
    (trace,) = pm.plot_actuators(actuators).data
    assert (np.diff(trace.x) >= 0.0).all()
    lightest = min(entry.actuator.mass_kg for entry in actuators.entries if entry.actuator is not None)
    assert trace.y.min() == lightest


def test_a_jump_has_a_panel_for_heights_angles_and_torques():
    steps = pm.trace(pm.PAPER_CASES["C"].design)
    figure = pm.plot_jump(steps)
    np.testing.assert_array_equal(figure.data[0].y, steps["base_z_m"])
    np.testing.assert_array_equal(figure.data[5].y, steps["knee_motor_torque_n_m"])
    axes = pm.plot_jump(steps, backend="matplotlib").axes
    assert [one.get_ylabel() for one in axes] == ["height (m)", "angle (rad)", "motor torque (N m)"]
    with pytest.raises(InputError, match="lacks hip_rad"):
        pm.plot_jump(steps.drop(columns="hip_rad"))


def test_the_mouse_names_trial_variables_and_measures(stored):
    front, dots = stored.front(), pm.plot_front(stored).data[-1]
    assert dots.customdata[:, 0].tolist() == front["trial"].tolist()
    lines = dots.hovertemplate.split("<br>")
    assert lines[0] == "trial: %{customdata[0]}"
    knee = next(k for k, line in enumerate(lines) if line.startswith("knee ratio: "))
    np.testing.assert_allclose(dots.customdata[:, knee].astype(float), front["knee_ratio"], rtol=1e-4)
    assert any(line.startswith("height (m): ") for line in lines)


def test_a_colour_shows_a_measure_a_variable_or_the_third_objective(stored, tmp_path):
    dots = pm.plot_front(stored, color="thigh_length_m").data[-1]
    np.testing.assert_allclose(dots.marker.color, 1000.0 * stored.front()["thigh_length_m"])
    assert dots.marker.colorbar.title.text == "thigh length (mm)"
    coloured = pm.plot_front(stored, color="peak_foot_force_n").data[-1]
    assert any(line.startswith("peak foot force (N): ") for line in coloured.hovertemplate.split("<br>"))
    three = pm.Study.define(
        name="t", evaluations=60, algorithm="random", audit=False, objectives=["height_m", "energy_j", "mass_kg"]
    )
    other = pm.run(three, tmp_path / "t.db")
    np.testing.assert_array_equal(pm.plot_front(other).data[-1].marker.color, other.front()["mass_kg"])
    _, bar = pm.plot_front(other, backend="matplotlib").axes
    assert bar.get_ylabel() == "mass (kg)"
    with pytest.raises(InputError, match="color = 'mass'"):
        pm.plot_front(stored, color="mass")

"""Time to a winding's limit against the equations integrated step by step, and against limiting cases."""

import math
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pareto_monoped.actuator.motors import load_motor
from pareto_monoped.actuator.windings import ThermalData, resistance_growth

U8 = ThermalData(
    winding_heat_capacity_j_per_k=16.3,
    housing_heat_capacity_j_per_k=512.0,
    winding_to_housing_k_per_w=1.07,
    housing_to_ambient_k_per_w=1.94,
    winding_limit_degc=115.0,
)


def stepped_s(data, heat_w, outside_k_per_w, step_s=1e-3, end_s=4000.0):
    """Runge-Kutta of fourth order on temperatures in C, until the winding is too hot."""

    def slope(winding, housing):
        heat = heat_w * (235.0 + winding) / (235.0 + 25.0)
        across = (winding - housing) / data.winding_to_housing_k_per_w
        lost = (housing - data.ambient_degc) / outside_k_per_w
        return (
            (heat - across) / data.winding_heat_capacity_j_per_k,
            (across - lost) / data.housing_heat_capacity_j_per_k,
        )

    state, time = (data.ambient_degc, data.ambient_degc), 0.0
    while time < end_s:
        k1 = slope(*state)
        k2 = slope(*(x + 0.5 * step_s * k for x, k in zip(state, k1, strict=True)))
        k3 = slope(*(x + 0.5 * step_s * k for x, k in zip(state, k2, strict=True)))
        k4 = slope(*(x + step_s * k for x, k in zip(state, k3, strict=True)))
        after = tuple(
            x + step_s / 6.0 * (a + 2.0 * b + 2.0 * c + d) for x, a, b, c, d in zip(state, k1, k2, k3, k4, strict=True)
        )
        if after[0] >= data.winding_limit_degc:
            return time + step_s * (data.winding_limit_degc - state[0]) / (after[0] - state[0])
        state, time = after, time + step_s
    return math.inf


@pytest.mark.parametrize("heat_w", [40.0, 107.0, 222.0, 2000.0])
@pytest.mark.parametrize("ambient_degc", [25.0, -10.0])
def test_time_is_that_of_the_equations_stepped_through(heat_w, ambient_degc):
    data = replace(U8, ambient_degc=ambient_degc)
    found = data.time_to_limit_s(heat_w, continuous_heat_w=1.0)
    assert found == pytest.approx(stepped_s(data, heat_w, 1.94, step_s=1e-3 if heat_w > 100.0 else 2e-2), rel=1e-4)


def test_a_housing_that_is_not_measured_is_what_the_continuous_current_allows():
    data = replace(U8, housing_to_ambient_k_per_w=None)
    total = 90.0 / (20.0 * (235.0 + 115.0) / 260.0)
    assert data.total_k_per_w(20.0) == pytest.approx(total)
    found = data.time_to_limit_s(100.0, continuous_heat_w=20.0)
    assert found == pytest.approx(stepped_s(data, 100.0, total - 1.07), rel=1e-4)
    # The continuous current itself never gets there, a little more does.
    assert data.time_to_limit_s(20.0 * (1.0 - 1e-9), continuous_heat_w=20.0) == math.inf
    assert data.time_to_limit_s(20.2, continuous_heat_w=20.0) > 1000.0


def test_a_winding_that_conducts_too_little_for_its_continuous_current():
    with pytest.raises(ValueError, match=r"winding_to_housing_k_per_w = 1\.07: must be less than 0\.624 K/W"):
        replace(U8, housing_to_ambient_k_per_w=None).time_to_limit_s(222.0, continuous_heat_w=107.14)


def test_great_heat_stays_in_the_winding():
    """Without conduction: C dT/dt = P (235 + T) / 260."""
    alone = 16.3 * 260.0 / 1e6 * math.log((235.0 + 115.0) / (235.0 + 25.0))
    assert U8.time_to_limit_s(1e6, continuous_heat_w=1.0) == pytest.approx(alone, rel=1e-3)


@given(heat_w=st.floats(1.0, 1e5), more=st.floats(1.01, 10.0))
def test_more_heat_is_held_for_less_time(heat_w, more):
    longer, shorter = (U8.time_to_limit_s(heat, continuous_heat_w=1.0) for heat in (heat_w, more * heat_w))
    assert shorter < longer or longer == shorter == math.inf


@given(factor=st.floats(0.01, 100.0))
def test_capacities_stretch_time(factor):
    stretched = replace(
        U8,
        winding_heat_capacity_j_per_k=16.3 * factor,
        housing_heat_capacity_j_per_k=512.0 * factor,
    )
    times = [data.time_to_limit_s(150.0, continuous_heat_w=1.0) for data in (U8, stretched)]
    assert times[1] == pytest.approx(factor * times[0], rel=1e-9)


def test_copper_of_115_degrees_has_35_percent_more_resistance():
    # 0.393 percent per kelvin at 20 C (IEC 60028), from 25 to 115 C.
    assert resistance_growth(115.0) == pytest.approx((1.0 + 0.00393 * 95.0) / (1.0 + 0.00393 * 5.0), rel=1e-3)


def test_the_u8_s_times_follow_from_its_torques():
    motor = load_motor("U8")
    peak_heat = 0.186 * (motor.peak_torque_n_m * 2.0 * math.pi * 100.0 / 60.0) ** 2
    assert motor.peak_torque_time_s == pytest.approx(stepped_s(motor.thermal, peak_heat, 1.94), rel=1e-4)
    # 24 A for 0.186 ohm: continuous in the wind of a propeller, 18 s in a closed case.
    assert motor.continuous_torque_time_s == pytest.approx(stepped_s(motor.thermal, 0.186 * 24.0**2, 1.94), rel=1e-4)
    assert 6.0 < motor.peak_torque_time_s < motor.continuous_torque_time_s < 20.0
    # T-Motor rates its actuator of this size at 12 A.
    assert replace(motor, max_continuous_current_a=12.0, continuous_torque_n_m=0.0).continuous_torque_time_s > 100.0


@pytest.mark.parametrize("name", ["VT8020", "U10", "U12", "MN8014", "MAD_M6C12"])
def test_where_nothing_is_measured_nothing_is_known(name):
    motor = load_motor(name)
    assert motor.thermal is None
    assert motor.peak_torque_time_s is None
    assert motor.continuous_torque_time_s is None


def test_a_limit_below_the_ambient_temperature_is_refused():
    with pytest.raises(ValueError, match=r"winding_limit_degc = 20\.0: must exceed ambient_degc = 25\.0"):
        replace(U8, winding_limit_degc=20.0)

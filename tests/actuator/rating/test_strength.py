import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pareto_monoped.actuator.gearset import GearSet
from pareto_monoped.actuator.motors import load_motor
from pareto_monoped.actuator.rating.width import lewis_form_factor, lewis_width_mm, velocity_factor
from pareto_monoped.actuator.settings import ActuatorSettings

MOTOR = load_motor("VT8020")
SETTINGS = ActuatorSettings(rules="paper")


def gears(sun=18, planet=36, module=0.5, planets=3):
    return GearSet(sun_teeth=sun, planet_teeth=planet, ring_teeth=sun + 2 * planet, module_mm=module, planets=planets)


def test_nominal_width_by_hand():
    # 11 N m on 9 mm through three planets: 814.8 N. Pitch point against the carrier: 502.65 rad/s x 5/6 x 4.5 mm =
    # 1.885 m/s, Barth 1.309. Stress 400 / 1.2 = 333.3 MPa, Y(18) = 0.309: 20.71 mm.
    assert lewis_width_mm(gears(), MOTOR, SETTINGS) == pytest.approx(20.71, abs=0.01)


def test_form_factor_is_the_table_and_between():
    assert lewis_form_factor(18) == 0.309
    assert lewis_form_factor(23) == pytest.approx((0.331 + 0.337) / 2)
    assert lewis_form_factor(1000) == 0.472


def test_form_factor_grows_smoothly():
    """Y is nearly straight over 1 / N (Lewis: y = 0.154 - 0.912 / N): a misplaced entry stands out."""
    tabled = np.array(
        [12, 13, 14, 15, 16, 17, 18, 19, 20, 21, 22, 24, 26, 28, 30, 34, 38, 43, 50, 60, 75, 100, 150, 300]
    )
    factors = lewis_form_factor(tabled)
    for k in range(1, len(tabled) - 1):
        share = (1 / tabled[k - 1] - 1 / tabled[k]) / (1 / tabled[k - 1] - 1 / tabled[k + 1])
        straight = factors[k - 1] + share * (factors[k + 1] - factors[k - 1])
        assert factors[k] == pytest.approx(straight, abs=0.003), tabled[k]


def test_barth():
    assert velocity_factor(0.0) == 1.0
    assert velocity_factor(6.1) == 2.0


sun = st.integers(18, 60)
planet = st.integers(60, 90)
module = st.sampled_from([0.5, 0.6, 0.8, 1.0])


@given(sun=sun, planet=planet, module=module, planets=st.integers(2, 6))
def test_more_planets_never_need_wider_gears(sun, planet, module, planets):
    few = lewis_width_mm(gears(sun, planet, module, planets), MOTOR, SETTINGS)
    more = lewis_width_mm(gears(sun, planet, module, planets + 1), MOTOR, SETTINGS)
    assert more <= few
    assert more >= 6.0 * module


@given(sun=sun, planet=planet, module=module, planets=st.integers(2, 7))
def test_lewis_stress_at_that_width_is_the_allowable(sun, planet, module, planets):
    """Checked backwards: the stress of the returned width, from force, speed and form factor."""
    one = gears(sun, planet, module, planets)
    width = float(lewis_width_mm(one, MOTOR, SETTINGS))
    radius = 0.5e-3 * module * sun
    force = SETTINGS.parts.gears.service_factor * MOTOR.peak_torque_n_m / radius / planets
    carrier = MOTOR.no_load_speed_rad_per_s / one.ratio
    speed = (MOTOR.no_load_speed_rad_per_s - carrier) * radius
    stress = force * (1.0 + speed / 6.1) / (width * module * lewis_form_factor(sun))
    limit = SETTINGS.materials.gear_steel.allowable_stress_mpa / SETTINGS.parts.gears.factor_of_safety
    assert stress <= limit * (1.0 + 1e-12)
    if width > 6.0 * module * (1.0 + 1e-9):
        assert stress == pytest.approx(limit, rel=1e-9)

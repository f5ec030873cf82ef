"""Numbers in running prose that the code has as a setting, a limit, a default or a bound."""

import numpy as np
import pytest

import tests.test_architecture as house
from pareto_monoped.actuator import gearset, layout, tolerances
from pareto_monoped.actuator.search import map_for
from pareto_monoped.analysis import alternatives, at_bounds, choices, compare, limit, robustness, sensitivity
from pareto_monoped.cad.check import result
from pareto_monoped.campaign import coordinator, grid, page
from pareto_monoped.compute import chunks
from pareto_monoped.definition.algorithms import PAPER_ITERATIONS
from pareto_monoped.definition.goals import MIN_HEIGHT_M
from pareto_monoped.definition.study import Study
from pareto_monoped.design import PAPER_CASES
from pareto_monoped.jump import audit, controller, end_stops, landing, peers, screen, torques
from pareto_monoped.jump.calibration import load_calibration
from pareto_monoped.leg import stops
from pareto_monoped.pareto import growth
from pareto_monoped.report import resimulation, trials
from pareto_monoped.robot.cost import RATES
from pareto_monoped.search import archive, prediction, surrogate
from pareto_monoped.strength import factors
from pareto_monoped.study import simulator
from pareto_monoped.uncertainty import samples, settings
from tests.docs.prose import table, untold
from tests.docs.scripts import ROOT

MAP = map_for("VT8020")
RATED, DUTY = MAP.settings.parts.rating, MAP.settings.parts.duty
LIMITS = {limit.name: limit.most for limit in audit.LIMITS}
NEEDED = {row.name: row.required for row in factors.TABLE}
REFERENCE, RIGID, FIT = (load_calibration(name) for name in ("reference", "reference-3", "paper"))


def mm(metres):
    return f"{1e3 * metres:g} mm"


def percent(share):
    return f"{100.0 * share:g} percent"


def told(ranges):
    """A range in the words of docs/studies.md."""
    low, high = (round(100.0 * end) for end in (ranges.lower, ranges.upper))
    if low == -high:
        return f"{high} percent more or less"
    return f"{-low} percent less to {f'{high} percent more' if high else 'as designed'}"


SETTINGS = {
    "docs/actuators.md": [
        f"{mm(1e-3 * gearset.CENTRE_TOLERANCE_MM)} off its place ({gearset.PIN_PLACE_MM:.3f} mm for the pin's hole, "
        f"{gearset.NEEDLE_PLAY_MM:.3f} mm for the needles' play)",
        f"tips must keep {tolerances._TIP_CLEARANCE:g} modules from the roots",
        f"They must be at least {tolerances._TIP_WIDTH:g} modules wide",
        f"touches more than {1e3 * result.GEAR_MESH.value:g} um too early",
        f"stands {layout.NECK_PLAY_MM:g} +-{layout.NECK_WITHIN_MM:g} mm from its end bearing",
        f"thinner by {MAP.settings.parts.gears.backlash_modules:g} modules each",
        f"at least by {MAP.settings.parts.gears.backlash_least_mm:g} mm",
        f"may bring {RATED.overload_factor:g} times the peak torque once",
        f"safety factors, $S_H$ {RATED.flank_safety:g} and $S_F$ {RATED.root_safety:g}",
        f"stand back by {RATED.planet_crowning_um:g} um",
        f"with {DUTY.torque_shares[2]:g} of it in the other direction (flexion and swing). {DUTY.jumps:,.0f} jumps",
        f"needles lose 0.1 percent of the power, with a friction coefficient of "
        f"{MAP.settings.parts.needles.friction_coefficient:g}",
        f"The friction coefficient of {MAP.settings.materials.bush_bronze.friction_coefficient:g} is the middle",
    ],
    "docs/architecture.md": [
        f"at most {house.MOST_MODULES} modules, {house.MOST_IN_A_ROOM} in a folder, {house.MOST_LINES} lines in each"
    ],
    "docs/choosing.md": [
        f"takes more than {choices.DEAR} times the least stored for its height",
        f"`robust` jumps {samples.DEFAULT_SAMPLES} times with each design",
        f"costs {1 + Study.from_toml(ROOT / 'studies' / 'robust.toml').uncertainty.samples} jumps instead of one",
    ],
    "docs/compare.md": [
        f"From {1e3 * compare._BEFORE_END_S:g} ms before the currents end",
        f"At least {compare._FEWEST} samples must remain",
        f"with steps of {1e3 * compare._STEP_S:g} ms",
        f"{compare._STUDENT} standard deviations",
    ],
    "docs/getting_started.md": [f"less than {choices.DEAR} times the least battery energy stored"],
    "docs/landing.md": [
        f"$l_c$ is {landing.LANDING.reach:g} times the length",
        f"with $\\omega_f$ = {landing._FLIGHT_RAD_PER_S:g} rad/s",
        f"the damper then takes at most {landing._MOST_STOPPED:g} times the rotor's speed",
        f"In the first {1e3 * torques.EASE_S:g} ms, the torques go linearly",
        f"touches, at least {landing._LEAST_FALL_M:g} m. $s$ is {landing.LANDING.stroke:g} (`stroke`)",
        f"or the base is {landing._BASE_ROOM_M:g} m high",
        f"$\\zeta$ = {landing.LANDING.damping_ratio:g} (`damping_ratio`)",
        f"$c_x = 2 \\cdot {landing._FORWARD_RATIO:g}\\, m\\omega$",
        f"within {landing.LANDING.lower_s:g} s (`lower_s`)",
        f"slower than {controller.STILL_M_PER_S:g} m/s and {controller.STILL_RAD_PER_S:g} rad/s",
        f"if the base sinks below {controller.SANK_M:g} m",
        f"{len(landing.TRIED)} sets of `reach`",
        f"repeat within {percent(landing._STEADY)}",
    ],
    "docs/limit.md": [
        f"with {limit.LAW.knots} knots per joint",
        f"Each of the four searches has {limit.JUMPS:,} jumps (`--jumps N`)",
        f"searches knots (to {limit._MOST[limit.TRACKING]:g}) and C (to {limit._FIRST[limit.TRACKING][2]:g} N s/m)",
        f"and {percent(limit._REACHES)} of it with {1e3 * limit._DELAY_S:g} ms of delay",
        {8: "has an eighth of the candidates"}[limit._SHARE],
        f"{simulator._BEFORE} jumps of the same study under the virtual leg",
    ],
    "docs/model.md": [
        f"{RATES.machining.allowance_mm:g} mm of allowance",
        f"The hour is {RATES.machining.hour_eur:g} EUR",
        f"Teeth take {RATES.gears.tooth_min:g} min and {RATES.gears.tooth_min_per_mm:g} min per mm",
        f"at {RATES.gears.hour_eur:g} EUR per hour",
        f"The hip stops {np.degrees(stops._HIP_END):g} degrees to both sides",
        f"The hip's bumpers are bars of {stops._HIP_BUMPER.diameter_mm:g} mm",
        f"a free inertia of {end_stops.IMPACT_KG_M2:g} kg m2",
        f"meets the stop with {end_stops.IMPACT_M_PER_S:g} m/s",
        f"$D$ = {end_stops.IMPEDANCE:g}, and $K$ is fitted",
        f"base at {PAPER_CASES['C'].design.start_height_m:g} m (`start_height_m`)",
        f"during the period, {1e3 * REFERENCE.simulation.control_period_s:g} ms under `reference`",
        f"$\\omega_s$ = {REFERENCE.drive.loss_speed_rad_per_s:g} rad/s",
        f"chain efficiency ({REFERENCE.drive.chain_efficiency:g})",
        f"`gear_loss` (1, {load_calibration('printed').drive.gear_loss:g} under `printed`)",
        f"$K$ = {1e-3 * REFERENCE.contact.stiffness_n_per_m:g} kN/m, $C$ = {REFERENCE.contact.damping_n_s_per_m:g} "
        f"N s/m, $w$ = {mm(REFERENCE.contact.width_m)}, $D$ = {REFERENCE.contact.impedance:g}:",
        f"`slip_ratio` $p$ = {REFERENCE.contact.slip_ratio:g} times",
        f"The Coulomb torque, {RIGID.joints.friction_n_m:g} N m under `reference-3`",
        f"joint friction of {RIGID.joints.friction_n_m:g} N m and {RIGID.joints.damping_n_m_s_per_rad:g} N m s/rad",
        f"on a lever of {stops._KNEE_LEVER:g} mm at the knee",
        f"Those of the knee, {stops._KNEE_BUMPER.diameter_mm:g} mm thick",
        f"$\\zeta$ = {REFERENCE.drive.drive_damping_ratio:g}, the least",
        f"closes to {100.0 * LIMITS['energy_balance_error']:g} %, its height and energy change by at most "
        f"{mm(LIMITS['spread_height_m'])} and {100.0 * LIMITS['spread_energy']:g} % under perturbations of "
        f"{audit.PERTURBATION:.0e} ({audit.SPREAD_PERCENTILE:.0f}th percentile".replace("e-06", "e-6"),
        f"by at most {mm(LIMITS['half_step_height_m'])} and {100.0 * LIMITS['half_step_energy']:g} % with the step",
        f"differ by more than {1e6 * audit.SAME:g} um or one millionth",
        f"`rail_friction_n` per carriage, {load_calibration('stand').stand.rail_friction_n:g} N",
        f"shaft, {FIT.joints.motor_damping_n_m_s_per_rad:.4f} N m s/rad (multiplied by the ratio squared at the joint: "
        f"{36.0 * FIT.joints.motor_damping_n_m_s_per_rad:.2f} N m s/rad at 6:1), a factor on the mass of both links, "
        f"{FIT.mass.link_mass_scale:.2f}, and the mass of the foot, {FIT.mass.foot_mass_kg:.3f} kg",
        f"kept at the {FIT.mass.base_structure_mass_kg:g} kg",
        f"Breaking load over the largest pull, at least {NEEDED['chain_breaking']:g}",
        f"Travel of a bumper over its compression, at least {NEEDED['knee_bumper']:g}",
        f"against yield, at least {NEEDED['hip_stop_rods']:g} (`strength/stop_seats.py`)",
        f"The dowels between axle and shank, at least {NEEDED['knee_axle_dowels']:g}",
        f"All against yield, at least {NEEDED['hip_spline']:g}; bonds at 5 MPa, at least {NEEDED['hip_ring_bond']:g}",
        f"must not slip, at least {NEEDED['hip_motor_reaction']:g}",
        f"Stress in the plates over yield, at least {NEEDED['thigh_plate_inner']:g}",
    ],
    "docs/scaling.md": [
        f"robust evaluation ({samples.DEFAULT_SAMPLES} jumps per design)",
        f"or {robustness._SHARED} designs of `robust`, is stored when it is complete",
        {16: "Up to sixteen such groups"}[chunks.AT_ONCE],
        {0.25: "at least a quarter of a second"}[chunks.LEAST_TASK_S],
        {16: "all measures of sixteen probe designs"}[peers._DRAWN + len(PAPER_CASES)],
    ],
    "docs/studies.md": [
        f"fitted anew to {prediction._TRAINING:,} simulated designs",
        f"with more than {prediction._CUBIC_UP_TO} features it is a quadratic",
        f"its errors at the latest {prediction._CORRECTING} designs",
        f"the best in each of its {archive._POSTS} parts",
        f"in which less than {percent(surrogate._HELD)} of the model's choices",
        f"is expected to gain {growth._DOUBLING:g} of what the doubling before it gained",
        f"with at most the paper's {PAPER_ITERATIONS} each",
        f"At most {percent(settings.MOST_FAILED)} may fail",
        f"A design must reach {MIN_HEIGHT_M:g} m",
        f"perturbations of {audit.PERTURBATION:.0e}".replace("e-06", "e-6"),
        f"keep within {mm(screen.CLEAR['half_step_height_m'] * LIMITS['half_step_height_m'])}, "
        f"{100.0 * screen.CLEAR['half_step_energy'] * LIMITS['half_step_energy']:g} % and",
        f"stay below {percent(audit.CLEAR_SPREAD)} of the limits, and those with the step halved below "
        f"{percent(audit.CLEAR_HALF_STEP)}",
        f"takes more than {choices.DEAR} times the least battery energy stored for its height",
        f"bounds of variables within {percent(at_bounds._AT)} of their range, constraints of the study within "
        f"{percent(at_bounds._BINDING_AT)}",
        f"worse by at most {percent(alternatives.TOLERANCE)} (`--tolerance`)",
        f"The {samples.DEFAULT_SAMPLES} samples of a design (`--samples`, a power of two)",
        {4: "Results are stored after every four designs"}[robustness._CHUNK],
        f"fail in more than {percent(settings.MOST_FAILED)} of their jumps",
        f"by {percent(sensitivity.WITHIN)} of their ranges to either side (`--within`)",
        f"A campaign has {grid.MOST_STUDIES:,} studies at most",
        {10.0: "one that still takes longer than ten seconds"}[coordinator.WORTH_S],
        {8: "Of more than eight groups, the charts begin with the eight"}[page.MOST_CURVES],
    ],
    "reports/README.md": [
        f"A page holds at most {trials.MOST_ROWS:,} trials",
        f"up to {resimulation.MOST_FRAMES} moments",
        f"take at most {1e-6 * resimulation.JUMPS_BYTES:g} MB",
    ],
}


@pytest.mark.parametrize("page", SETTINGS)
def test_settings_are_told_as_the_code_has_them(page):
    assert untold(page, SETTINGS[page]) == []


def test_ranges_of_built_robots_are_those_of_the_shipped_file():
    shipped = settings.load_uncertainty().where(stand=True)
    rows = table("docs/studies.md", "quantity", "range").set_index("quantity")["range"]
    names = {
        "mass of base, thigh and shank, each": "masses",
        "peak torque of each motor": "peak_torque",
        "Coulomb friction of the joints": "friction",
        "viscous friction of the joints": "damping",
        "gains K, C and T, each": "gains",
        "battery voltage, which moves the no-load speed": "battery_voltage",
        "what gearboxes lose under load": "gear_loss",
        "what the chain loses": "chain_loss",
        "resistance of the warm windings": "winding_resistance",
        "inertia of what turns at the motors' speed": "rotor_inertia",
        "rebound of the bumpers": "rebound",
        "on a [test stand](model.md#on-the-test-stand): what the base lifts": "stand_mass",
        "on a test stand: friction of the rails": "rail_friction",
    }
    for row, name in names.items():
        assert rows[row] == told(getattr(shipped, name)), row
    assert rows["stiffness of the end stops, of the foot"] == f"{told(shipped.stop_stiffness)}, each"
    assert shipped.foot_stiffness.upper == shipped.stop_stiffness.upper
    assert rows["length of thigh and shank, each"] == f"{mm(shipped.link_length_m.upper)} more or less"
    late = shipped.delay_s
    assert rows["delay from measuring to acting"].startswith(f"{1e3 * late.lower:g} to {1e3 * late.upper:g} ms")

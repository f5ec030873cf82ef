"""Numbers in running prose that the code has as a setting, a limit, a default or a bound."""

import tomllib
from inspect import signature

import numpy as np
import pytest

import tests.test_architecture as house
from pareto_monoped.actuator import ratiomap
from pareto_monoped.actuator.motors import load_motor, motor_names
from pareto_monoped.actuator.search import map_for
from pareto_monoped.analysis import alternatives, at_bounds, choices, compare, limit, remarks, robustness, sensitivity
from pareto_monoped.campaign import coordinator, grid, page
from pareto_monoped.cli import campaign as campaigns
from pareto_monoped.cli import process
from pareto_monoped.compute import chunks, crew
from pareto_monoped.definition.algorithms import PAPER_ITERATIONS, SurrogateSettings
from pareto_monoped.definition.goals import LEAST_SAFETY, MIN_HEIGHT_M
from pareto_monoped.definition.study import Study, load_study
from pareto_monoped.design import BASE_START_HEIGHT_M, GRAVITY_M_PER_S2, LOWER, MOST_KNOTS, NAMES, PAPER_CASES, UPPER
from pareto_monoped.jump import audit, controller, end_stops, landing, peers, screen, table1, torques
from pareto_monoped.jump import model as jump_model
from pareto_monoped.jump.calibration import load_calibration
from pareto_monoped.jump.calibration_defaults import copies_for
from pareto_monoped.jump.rail_leg import load_leg
from pareto_monoped.leg import chain as leg_chain
from pareto_monoped.leg import stand, stops
from pareto_monoped.materials import MATERIALS
from pareto_monoped.pareto import growth
from pareto_monoped.report import resimulation, trials
from pareto_monoped.robot.cost import RATES
from pareto_monoped.search import archive, prediction, surrogate
from pareto_monoped.storage import kept_front
from pareto_monoped.strength import chain, connections, factors
from pareto_monoped.study import simulator
from pareto_monoped.uncertainty import samples, settings
from pareto_monoped.uncertainty.sensitivity import DEFAULT_BLOCKS
from tests.docs.prose import mm, percent, table, untold
from tests.docs.scripts import ROOT

MAP = map_for("VT8020")
CASE_C = load_study(ROOT / "studies" / "case_c.toml").reference_point
KNEE = stops.knee_stop(None)
LEG = load_leg(ROOT / "examples" / "legs" / "dfki_hopping_leg.toml")
SHIPPED = settings.load_uncertainty()
PYTHON = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["requires-python"].strip(">=")
IDEAL = load_calibration("ideal")
SEARCH = SurrogateSettings(name="surrogate")
LIMITS = {limit.name: limit.most for limit in audit.LIMITS}
NEEDED = {row.name: row.required for row in factors.TABLE}
REFERENCE, RIGID, FIT = (load_calibration(name) for name in ("reference", "reference-3", "paper"))


def told(ranges):
    """A range in the words of docs/studies.md."""
    low, high = (round(100.0 * end) for end in (ranges.lower, ranges.upper))
    if low == -high:
        return f"{high} percent more or less"
    return f"{-low} percent less to {f'{high} percent more' if high else 'as designed'}"


SETTINGS = {
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
    "docs/getting_started.md": [
        {6: "The package contains six motors"}[len(motor_names())],
        f"less than {choices.DEAR} times the least battery energy stored",
    ],
    "docs/landing.md": [
        f"- {2.0 * landing._FLIGHT_RATIO:g}\\,I\\omega_f",
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
    "docs/legs.md": [
        f"links of {LEG.thigh.length_m:.3f} and {LEG.shank.length_m:.3f} m, "
        f"{LEG.base.mass_kg + LEG.thigh.mass_kg + LEG.shank.mass_kg:.2f} kg, two T-Motor AK80-6 at "
        f"{LEG.hip_drive.ratio:g}:1",
        f"model of DFKI: {LEG.joints.friction_n_m:g} N m and {LEG.joints.damping_n_m_s_per_rad:g} N m s/rad",
        f"J^T F within "
        f"{' or '.join(f'{limit:g}' for limit in sorted({s.push.force_limit_n_m[0] for s in LEG.series}))} N m",
        f"{ {2: 'two'}[round(LEG.control.delay_s / LEG.control.period_s)] } samples, "
        f"{1e3 * LEG.control.delay_s:g} ms, and stay "
        f"at {LEG.hip_drive.peak_torque_n_m:g} N m",
        f"the drives' stiffness of {LEG.hip_drive.stiffness_n_m_per_rad:g} N m/rad",
    ],
    "docs/limit.md": [
        f"`--controller torque_over_time:{limit.LAW.knots}` or `tracking:{limit.TRACKING.knots}`",
        f"With {percent(limit._TORQUE)} less torque, or",
        f"Late is {1e3 * limit._DELAY_S:g} ms of delay, then come {percent(limit._TORQUE)} less and more torque",
        f"with C from {LOWER[NAMES.index('damping_n_s_per_m')]:g} to {UPPER[NAMES.index('damping_n_s_per_m')]:g} N s/m",
        f"`knots` is their number per joint, 2 to {MOST_KNOTS} (8 if it is left out)",
        f"to zero as the foot rises by {mm(REFERENCE.gate.length_m)}",
        f"the heights of {samples.DEFAULT_SAMPLES} robots within",
        f"where torques vary from {100.0 * SHIPPED.peak_torque.lower:+.0f} to "
        f"{100.0 * SHIPPED.peak_torque.upper:+.0f} "
        f"percent, delays to {1e3 * SHIPPED.delay_s.upper:g} ms",
        f"and by {100.0 * SHIPPED.gains.upper:.0f} percent of its gains",
        f"{1e3 * limit._DELAY_S:g} ms of delay and {percent(round(limit._SEARCHED[2][0] - 1.0, 9))} more or "
        f"less torque",
        f"in place of {mm(REFERENCE.gate.length_m)}, because collocation",
        f"and moves {limit._FEW} knots before it moves {limit.LAW.knots}",
        f"with {limit.LAW.knots} knots per joint",
        f"Each of the four searches has {limit.JUMPS:,} jumps (`--jumps N`)",
        f"searches knots (to {limit._MOST[limit.TRACKING]:g}) and C (to {limit._FIRST[limit.TRACKING][2]:g} N s/m)",
        f"and {percent(limit._REACHES)} of it with {1e3 * limit._DELAY_S:g} ms of delay",
        {8: "has an eighth of the candidates"}[limit._SHARE],
        f"{simulator._BEFORE} jumps of the same study under the virtual leg",
    ],
    "docs/model.md": [
        f"The best of {load_study(ROOT / 'studies' / 'quick.toml').evaluations} jumps",
        f"less `regeneration_share` ({REFERENCE.drive.regeneration_share:g}) of what flows back, plus "
        f"`standby_power_w` ({REFERENCE.drive.standby_power_w:g})",
        f"drives and a step of {1e3 * REFERENCE.simulation.timestep_s:g} ms, their peaks",
        f"perturbed by up to {audit.PERTURBATION:.0e}), all".replace("e-06", "e-6"),
        f"C, at {PAPER_CASES['C'].height_m:.3f} m, higher than B",
        f"gravity {GRAVITY_M_PER_S2:g} m/s2",
        f"$l_0 = {REFERENCE.controller.rest_length_m:g}$ m",
        f"$H_0$ = {BASE_START_HEIGHT_M:g} m, as if",
        f"allow for {chain._HOURS:,.0f} hours",
        f"bonds at {connections.BOND_MPA:g} MPa, at least {connections.BOND_SAFETY:g}",
        f"free in the shank's fork, at least {NEEDED['thigh_side_inner']:g}",
        f"The static safety of the bearings, at least {NEEDED['knee_bearing_static']:g}",
        f"{RATES.materials['aluminium'].removal_cm3_per_min:g} cm3/min in aluminium",
        f"$\\mu = {REFERENCE.contact.friction:g}$",
        f"{1e3 * REFERENCE.contact.width_m:g} mm, $D$ = {REFERENCE.contact.impedance:g}: "
        f"{1e-3 * REFERENCE.contact.stiffness_n_per_m * REFERENCE.contact.width_m:.0f} kN at "
        f"{mm(REFERENCE.contact.width_m)}",
        f"the knee at {np.degrees(KNEE.lower_rad):.0f} and {np.degrees(KNEE.upper_rad):.0f} degrees",
        f"give way over {np.degrees(KNEE.travel_rad):.1f} degrees",
        f"rebound resilience, {percent(MATERIALS.fluoroelastomer.rebound_resilience)} of its energy",
        f"battery for each motor, MuJoCo's engine and a step of {1e3 * RIGID.simulation.timestep_s:g} ms",
        f"A step longer than {jump_model._STABLE:g} times",
        f"copper has {100.0 * jump_model._COPPER_PER_K:g} percent more resistance per kelvin",
        f"${1e5 * leg_chain._RENOLD_MM_PER_N:g} \\cdot 10^{{-5}} F L / P^2$",
        f"at the {end_stops.TEST_M_PER_S:g} m/s of ISO 4662's pendulum",
        f"carriages MGN12H of {1e3 * stand.MGN12H.mass_kg:g} g (HIWIN) and their "
        f"{stand.CARRIAGES * stand.SCREWS_PER_CARRIAGE} screws",
        f"Elastic drives need {1e3 * REFERENCE.simulation.timestep_s:g} ms",
        f"The step is {1e3 * RIGID.simulation.timestep_s:g} ms for its margin",
        f"Medians over {table1.PERTURBATIONS} copies (the design itself and {table1.PERTURBATIONS - 1} copies "
        f"perturbed",
        f"with medians of {copies_for('paper')} copies as scores",
        f"| fades over {mm(REFERENCE.gate.length_m)}, then off for good | same |",
        f"| peak, at the knee times {FIT.drive.knee_torque_scale:g} |",
        f"| one for both motors, windings at {20.0 + REFERENCE.drive.winding_rise_k:g} degC | one, at 20 degC |",
        f"| {1e3 * REFERENCE.simulation.control_period_s:g} ms, positions half a step back | same | "
        f"{1e3 * FIT.simulation.timestep_s:g} ms, state as it is |",
        f"| compiled, Euler {1e3 * REFERENCE.simulation.timestep_s:g} ms | compiled, Euler "
        f"{1e3 * IDEAL.simulation.timestep_s:g} ms | MuJoCo, Euler {1e3 * FIT.simulation.timestep_s:g} ms |",
        f"in its start pose, {FIT.controller.flight.stiffness_n_m_per_rad:g} N m/rad, "
        f"{FIT.controller.flight.damping_n_m_s_per_rad:g} N m s/rad | later model |",
        f"| the knee's peak torque is {FIT.drive.knee_torque_scale:g} times ratio times "
        f"{load_motor('VT8020').peak_torque_n_m:g} N m |",
        f"| the contact's time constant is {FIT.contact.time_constant_s:g} s |",
        f"| step of {1e3 * FIT.simulation.timestep_s:g} ms |",
        {FIT.drive.knee_torque_scale: "(15 / 11 could be a chain's ratio)"}[round(15 / 11, 4)],
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
        f"shaft, {FIT.joints.motor_damping_n_m_s_per_rad:.4f} N m s/rad (multiplied by the ratio squared at "
        f"the joint: "
        f"{36.0 * FIT.joints.motor_damping_n_m_s_per_rad:.2f} N m s/rad at 6:1), a factor on the mass of both links, "
        f"{FIT.mass.link_mass_scale:.2f}, and the mass of the foot, {FIT.mass.foot_mass_kg:.3f} kg",
        f"kept at the {FIT.mass.base_structure_mass_kg:g} kg",
        f"Breaking load over the largest pull, at least {NEEDED['chain_breaking']:g}",
        f"Travel of a bumper over its compression, at least {NEEDED['knee_bumper']:g}",
        f"against yield, at least {NEEDED['hip_stop_rods']:g} (`strength/stops.py`)",
        f"The dowels between axle and shank, at least {NEEDED['knee_axle_dowels']:g}",
        f"All against yield, at least {NEEDED['hip_spline']:g}; bonds at 5 MPa, at least {NEEDED['hip_ring_bond']:g}",
        f"must not slip, at least {NEEDED['hip_motor_reaction']:g}",
        f"Stress in the plates over yield, at least {NEEDED['thigh_plate_inner']:g}",
    ],
    "docs/stages.md": [
        f"For each interval of {ratiomap.RATIO_STEP:g} in gear ratio from {ratiomap.RATIO_LOW}:1 to "
        f"{ratiomap.RATIO_HIGH}:1, this stage",
        f"if a design changes by {audit.PERTURBATION:.0e} or the time step".replace("e-06", "e-6"),
        f"it depends on its step of {1e3 * FIT.simulation.timestep_s:g} ms",
    ],
    "docs/scaling.md": [
        f"Up to sixteen such groups of {robustness._SHARED} are under way",
        f"| after {crew.Limits().task_s:g} s without an answer, {crew.Limits().first_s:g} s in its first task, "
        f"{crew.EXPORT_LIMITS.task_s:g} s in an export, or {crew.Limits().times:g} times the longest task so far",
        f"| the coordinator waits {crew.Limits().absent_s:g} s for it and for workers",
        f"| after {crew.Limits().absent_s:g} s more the command ends",
        {4: "| a task ends four workers |"}[crew._MOST_LOSSES],
        {16: "have reached a sixteenth of it"}[kept_front._SHARE],
        f"robust evaluation ({samples.DEFAULT_SAMPLES} jumps per design)",
        f"or {robustness._SHARED} designs of `robust`, is stored when it is complete",
        {16: "Up to sixteen such groups"}[chunks.AT_ONCE],
        {0.25: "at least a quarter of a second"}[chunks.LEAST_TASK_S],
        {16: "all measures of sixteen probe designs"}[peers._DRAWN + len(PAPER_CASES)],
    ],
    "docs/studies.md": [
        f"current generation (exit code {process._INTERRUPTED})",
        f"fitted anew to {prediction._TRAINING:,} simulated designs",
        f"with more than {prediction._CUBIC_UP_TO} features it is a quadratic",
        f"its errors at the latest {prediction._CORRECTING} designs",
        f"the best in each of its {archive._POSTS} parts",
        f"in which less than {percent(surrogate._HELD)} of the model's choices",
        f"is expected to gain {growth._DOUBLING:g} of what the doubling before it gained",
        f"differ by more than {percent(growth.ENOUGH)} of energy at a height, or one has more than "
        f"{percent(growth.ENOUGH)} of the hypervolume alone",
        f"with at most the paper's {PAPER_ITERATIONS} each",
        f"At most {percent(settings.MOST_FAILED)} may fail",
        f"A design must reach {MIN_HEIGHT_M:g} m",
        f"perturbations of {audit.PERTURBATION:.0e}".replace("e-06", "e-6"),
        f"changes the height by at most "
        f"{mm(screen.CLEAR['half_step_height_m'] * LIMITS['half_step_height_m'])} and the "
        f"energy by at most {100.0 * screen.CLEAR['half_step_energy'] * LIMITS['half_step_energy']:g} %, while",
        f"its energy balance closes to {100.0 * LIMITS['energy_balance_error']:g} %, the audit would find nothing",
        f"a jump of {100.0 * (MIN_HEIGHT_M - BASE_START_HEIGHT_M):.0f} cm, unless",
        f"are at least {LEAST_SAFETY:g}. Each is the least factor",
        f"bound end on it. {int(2.5 * surrogate._CLIMBS)} designs also climb",
        f"with the study: {CASE_C.values[0]:g} m and {CASE_C.values[1]:g} J by default",
        f"The upper bound {UPPER[NAMES.index('knee_ratio')]:g} includes the gearbox of the interval "
        f"[{UPPER[NAMES.index('knee_ratio')]:g}, {UPPER[NAMES.index('knee_ratio')] + ratiomap.RATIO_STEP:g})",
        f"have the real ratio of the gearbox, such as {MAP.lookup(5.15).ratio:.3f}",
        f"by the medians over {copies_for('paper')} copies that differ by up to {audit.PERTURBATION:.0e} "
        f"(`copies`)".replace("e-06", "e-6"),
        f"with {DEFAULT_BLOCKS} base samples (`--samples`)",
        f"| evolution that ranks {SEARCH.offspring} offspring for each design it simulates",
        {(10, 2): "of the ten perturbed copies of a design, two jump first"}[
            signature(audit.audit).parameters["perturbations"].default, audit.FIRST_COPIES
        ],
        {(2, 3): "begins with two generations spread over the space"}[
            SurrogateSettings(name="surrogate").drawn_generations, surrogate._ROUNDS
        ],
        f"Up to {archive._FEW_DESIGNS} designs, fewer if they have more than "
        f"{archive._FEW_VALUES // archive._FEW_DESIGNS} features, the model is a Gaussian process",
        {0.1: "A tenth of these explores"}[surrogate._EXPLORING],
        {((2, 4), 0.5): "Generations are then a quarter as large"}[surrogate._SMALLER, surrogate._SEEKING],
        {0.01: "At most a percent is tolerated"}[archive.TOLERATED],
        {0.1: "a chance of more than a tenth"}[prediction._RISK],
        {0.2: "when a fifth of its jumps failed"}[remarks._MANY_FAIL],
        {4: "how much hypervolume four times as many jumps would add"}[growth.AHEAD],
        {4: "at most four such remarks"}[remarks._MOST_LINES],
        {5.0: "a line appears every five seconds"}[campaigns._SECONDS_BETWEEN_LINES],
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
    "README.md": [f"With Python {PYTHON} or later and make"],
    "benchmarks/search_algorithms.md": [
        f"a jump must reach {MIN_HEIGHT_M:g} m",
        f"reference point of the study file, ({CASE_C.values[0]:g} m, {CASE_C.values[1]:g} J)",
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

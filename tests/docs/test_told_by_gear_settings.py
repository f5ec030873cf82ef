"""Numbers of docs/actuators.md that the code has as a setting, a limit, a default or a bound."""

import numpy as np

from pareto_monoped.actuator import (
    bearings,
    front,
    gearset,
    layout,
    motors,
    planet_bearings,
    ratiomap,
    tolerances,
)
from pareto_monoped.actuator.assumptions import default_service
from pareto_monoped.actuator.motor import MOUNT_BORE_MM, OUTPUT_BORE_MM, PEAK_TO_CONTINUOUS
from pareto_monoped.actuator.motors import load_motor
from pareto_monoped.actuator.rating import capacity, width
from pareto_monoped.actuator.search import map_for
from pareto_monoped.actuator.settings import SHIFTS
from pareto_monoped.cad.check import making as tools
from pareto_monoped.cad.check import result
from pareto_monoped.geometry import features, gears, making
from pareto_monoped.materials import ALLOYS, GEAR_GRADES
from pareto_monoped.strength import drive
from tests.docs.prose import mm, percent, untold

MAP = map_for("VT8020")
PARTS = MAP.settings.parts
RATED, DUTY = PARTS.rating, PARTS.duty
SERVICE = default_service()
CASED, NITRIDED = (GEAR_GRADES[name].layer_modules for name in (RATED.sun_grade, RATED.ring_grade))
_NEEDLE_MM, _PIN_MM = PARTS.needles.diameter_mm, PARTS.carrier.pin_diameter_mm
NEEDLES_AROUND = int(np.pi / np.arcsin(_NEEDLE_MM / (_PIN_MM + _NEEDLE_MM)))


SETTINGS = [
    f"every interval of {ratiomap.RATIO_STEP:g} between {ratiomap.RATIO_LOW}:1 and {ratiomap.RATIO_HIGH}:1 gets",
    f"A ratio less than {0.05 * 10.0**-ratiomap._EDGE_DECIMALS:.0e} below",
    f"ISO 54 from {min(MAP.settings.modules_mm):g} to {max(MAP.settings.modules_mm):g} mm",
    f"in modules: {', '.join(map(str, SHIFTS[:-1]))} and {SHIFTS[-1]}".replace(".0,", ",").replace("0.0)", "0)"),
    f"depth of case ({CASED[0]:g} to {CASED[1]:g} modules) or nitriding layer ({NITRIDED[0]:g} to {NITRIDED[1]:g})",
    f"{ALLOYS['raceway_pin'].hardness.split(' to ')[0]} HRC or more, ground to",
    f"tip rounding of {gears.FILLET:g} modules",
    f"roots are the arcs of {gears.FILLET:g} modules",
    f"meet the mate {gearset.FORM_MARGIN_MODULES:g} modules before its form circle",
    f"thinned by {PARTS.gears.backlash_mm:g} mm, which makes roots",
    f"less than {PARTS.gears.backlash_least_mm / PARTS.gears.backlash_modules:.2f} mm module are thinned by "
    f"{PARTS.gears.backlash_least_mm:g} mm each",
    f"0.4 modules as drawn, and half of the least is our own choice. They must be at least {tolerances._TIP_WIDTH:g}",
    f"as drawn, the rules ask for {RATED.tip_thickness_modules:g}",
    f"over {DUTY.output_angles_rad[0]:g} rad of the output each with the peak torque (push-off), with "
    f"{ {0.5: 'half'}[DUTY.torque_shares[1]] } of it in the same direction",
    f"$R$ = -{capacity._COMPRESSION:g} times the ratio",
    f"root behind it {capacity._COMPRESSION:g} times as much",
    f"ground to Ra {making.RACEWAY_RA_UM:g}, and in a case-hardened bore a case of "
    f"{ {0.1: 'a tenth'}[front._RACEWAY_CASE] } of the needle's diameter",
    f"two planets, {PARTS.webs.clearance_mm:g} mm from their tips",
    f"Helix deviations of class {RATED.accuracy_class} make",
    f"the width is at least {width.LEAST_WIDTH_MODULES:g} modules",
    f"with a friction coefficient of {MAP.settings.materials.gear_steel.mesh_friction_coefficient:g} (greased steel)",
    f"assumed to be {PEAK_TO_CONTINUOUS:.2f} times the continuous one",
    f"with a friction of {drive._SIDEWAYS['hip'][1]:g} at the hip, and "
    f"{percent(drive._SIDEWAYS['knee'][1])} of the chain",
    f"Below {planet_bearings._LEAST_SPACER_MM:g} mm, one spacer",
    f"tilt by more than the {1e3 * SERVICE.bearing_tilt_limit_rad:g} mrad",
    f"play of {SERVICE.drive_support_clearance_mm:g} mm, or half the main bearing's",
    f"each planet turns on {NEEDLES_AROUND} needle rollers of {PARTS.needles.diameter_mm:g} mm around a pin of "
    f"{PARTS.carrier.pin_diameter_mm:g} mm",
    f"Washers of {PARTS.needles.washer_mm:g} mm (DIN 988)",
    f"**Bearing friction** is ${SERVICE.bearing_friction_coefficient:g} P d / 2$ (SKF), "
    f"{SERVICE.needle_friction_coefficient:g} for the needle bearing",
    f"thinned by {PARTS.gears.backlash_modules:g} modules each (`paper`: by {PARTS.gears.backlash_mm:g} mm)",
    f"with pins of {PARTS.carrier.pin_diameter_mm:g} mm, the planets of a small motor",
    f"Published for motors of its class are {1e5 * load_motor('U8').rotor_inertia_kg_m2:.2f}e-5",
    f"| $S_H$ at least {RATED.flank_safety:g}, every flank |",
    f"| $S_F$ at least {RATED.root_safety:g}, every root |",
    f"| $S_H$ at least {RATED.overload_flank_safety:.1f} and $S_F$ at least {RATED.overload_root_safety:g} "
    f"against static "
    f"failure under {RATED.overload_factor:g} times the peak torque |",
    f"| face no wider than {RATED.face_over_sun_max:g} sun diameters and {RATED.face_modules_max:g} modules |",
    f"L10 at least {SERVICE.bearing_life_min_h:g} h, s0 at least {SERVICE.static_safety_min:g} at the peak "
    f"torque and "
    f"{SERVICE.overload_static_safety_min:g} under the overload, tilt at most "
    f"{1e3 * SERVICE.bearing_tilt_limit_rad:g} mrad |",
    f"at least {RATED.tip_thickness_modules:g} modules thick, so that the case leaves a tough core |",
    f"service factor {PARTS.gears.service_factor:g}, safety {PARTS.gears.factor_of_safety:g} | load sharing",
    f"least multiple of {RATED.face_step_mm:g} mm, at least {RATED.face_width_min_mm:g} mm and "
    f"{RATED.face_modules_min:g} modules, at most as above |",
    f"{PARTS.gears.ring_width_internal_mm:g} mm (ISSPG) or {PARTS.gears.ring_width_external_mm:g} mm "
    f"(ESSPG) beyond the "
    f"pitch circle, whatever the module | {PARTS.gears.ring_rim_modules:g} modules beyond the roots",
    f"| straight | planets crowned by {RATED.planet_crowning_um:g} um |",
    f"the nearest gearbox within {ratiomap.STAND_IN_WITHIN:g} stands in, and is named |",
    f"| {RATED.application_factor:g}: uniform driver",
    f"| {min(RATED.load_sharing_fixed):g} to {max(RATED.load_sharing_fixed):g} for 2 to "
    f"{len(RATED.load_sharing_fixed) + 1} planets around a fixed sun; {min(RATED.load_sharing_floating):.1f} to "
    f"{max(RATED.load_sharing_floating):g} around a floating one |",
    f"| method C: {RATED.flank_finish_factor:g}, and {RATED.ring_finish_factor:g} against the ring",
    f"| method B; Rz of {RATED.root_roughness_um:g} um; 1 |",
    f"| {RATED.reversed_bending_factor:g} for the planets",
    f"| at most {tools.SLOT_DEPTHS:g} times as deep as wide |",
    f"| corners of {tools.TOOL_RADIUS_MM:g} mm, {2.0 * tools.TOOL_RADIUS_MM:g} mm wide at least |",
    f"| {tools.WALL_MM:g} mm between holes and edges; lips, flanges and tubes {tools.LIP_MM:g} mm thick",
    f"by {features._TAP_RUN_OUTS_MM[0.5]:g} mm for M3, {features._TAP_RUN_OUTS_MM[0.7]:g} mm for M4 |",
    f"| {tools.FLOOR_MM:g} mm under a drill's point",
    f"| at least {percent(tools.OPEN_SHARE)} of the hole free over the run-out |",
    f"| { {0.5: 'half'}[tools.COLLAR_SHARE] } as thick as the groove is deep, and {bearings._LEAST_COLLAR_MM:g} mm |",
    f"| at most {motors.VOLTAGE_MOST_V:g} V |",
    f"runs at {motors.RIM_SPEED_MOST_M_PER_S:g} m/s or less without load |",
    f"| within {percent(motors.KV_TOLERANCE)} of $60 / (2 \\pi K_v)$ |",
    f"with at most {motors.SHEAR_MOST_KPA:g} kPa |",
    f"| {motors.INERTIA_OVER_MASS[0]:g} to {motors.INERTIA_OVER_MASS[1]:g} times mass and squared outer radius |",
    f"| {motors.POWER_OVER_INPUT[0]:g} to {motors.POWER_OVER_INPUT[1]:g} times rated voltage and continuous current |",
    f"| {motors.DENSITY_KG_PER_M3[0]:g} to {motors.DENSITY_KG_PER_M3[1]:g} kg/m3 over the motor's size",
    f"| at least {motors.DIAMETER_LEAST_MM:g} mm; at least {motors.LENGTH_LEAST_MM:g} mm |",
    f"| up to {motors.HOLE_MOST_MM:g} mm wide, within the outer diameter, apart from each other, and around "
    f"the rear "
    f"bearing's seat ({MOUNT_BORE_MM:g} mm) or the coupling's hub ({OUTPUT_BORE_MM:g} mm) |",
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
]


def test_settings_are_told_as_the_code_has_them():
    assert untold("docs/actuators.md", SETTINGS) == []

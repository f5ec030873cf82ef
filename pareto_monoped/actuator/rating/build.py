"""From gear sets, motor and settings to a ``Stage`` that can be rated at any face width."""

from collections.abc import Callable
from dataclasses import replace
from functools import partial, reduce

import numpy as np

from pareto_monoped.actuator.gearset import GearSet, contact_ratios, load_sharing
from pareto_monoped.actuator.layout import Family, ring_radius_mm
from pareto_monoped.actuator.motor import Motor
from pareto_monoped.actuator.rating import load
from pareto_monoped.actuator.rating.capacity import (
    FLANK_CURVES,
    ROOT_CURVES,
    equivalent_cycles,
    flank_factors,
    flank_limit_mpa,
    flank_load_n_per_mm,
    highest_share,
    mean_stress_factor,
    passes_per_rad,
    reversal_ratio,
    root_limit_mpa,
    root_load_n_per_mm,
    static_root_limit_mpa,
    work_hardening_factor,
)
from pareto_monoped.actuator.rating.geometry import (
    TOOTH_DEPTH,
    contact_ratio_factor,
    external_rim_factor,
    internal_rim_factor,
    single_contact_factors,
    tooth_form,
)
from pareto_monoped.actuator.rating.stage import Member, Mesh, Safeties, Stage, finish_factor
from pareto_monoped.actuator.service.loads import planet_width_mm
from pareto_monoped.actuator.settings import ActuatorSettings
from pareto_monoped.actuator.webs import webs_of
from pareto_monoped.geometry.gears import PRESSURE_ANGLE_RAD, ExternalGear, InternalGear
from pareto_monoped.geometry.making import RATED_SERIES, thickness_tolerance_mm
from pareto_monoped.geometry.shapes import Numbers
from pareto_monoped.materials import GearGrade


def build_stage(gears: GearSet, motor: Motor, family: Family, settings: ActuatorSettings) -> Stage:
    """Build the stage of one gear set, or of arrays of them, rated for the motor's peak torque."""
    data, steels = settings.parts.rating, settings.gear_steels
    radius_mm = 0.5 * gears.module_mm * gears.sun_teeth
    force_n = 1e3 * motor.peak_torque_n_m / (radius_mm * gears.planets)
    speed = 1e-3 * radius_mm * motor.no_load_speed_rad_per_s * (1.0 - 1.0 / gears.ratio)
    outer, inner = contact_ratios(gears)
    sun_rim, planet_rim, ring_rim = _rim_factors(gears, family, settings)
    sun_passes, planet_passes, ring_passes = passes_per_rad(gears)
    member = partial(_member, settings=settings)
    sun = partial(member, gear="sun", steel=steels.sun, rim_factor=sun_rim, passes=sun_passes)
    planet = partial(
        member, gear="planet", steel=steels.planet, rim_factor=planet_rim, passes=planet_passes, idler=True
    )
    ring = partial(member, gear="ring", steel=steels.ring, rim_factor=ring_rim, passes=ring_passes)
    sharing = load_sharing(gears.planets, settings)
    meshed = partial(_mesh, module_mm=gears.module_mm, force_n=force_n, sharing=sharing, speed=speed, settings=settings)
    # Without the limit, twice as wide is far enough to see what it keeps out.
    reach = 2.0 if "face_width" in settings.constraints_off else 1.0
    sun_mesh = meshed(
        pinion=sun,
        wheel=planet,
        steels=(steels.sun, steels.planet),
        pair=(gears.sun(), gears.planet()),
        working_angle_rad=gears.working_angle_rad,
        contact_ratio=outer,
    )
    ring_mesh = meshed(
        pinion=planet,
        wheel=ring,
        steels=(steels.planet, steels.ring),
        pair=(gears.planet(), gears.ring()),
        working_angle_rad=gears.ring_working_angle_rad,
        contact_ratio=inner,
    )
    return Stage(
        gears=gears,
        sun_mesh=sun_mesh,
        ring_mesh=ring_mesh,
        settings=settings,
        webs=webs_of(gears, settings).section,
        width_low_mm=reduce(
            np.maximum,
            (data.face_width_min_mm, data.face_modules_min * gears.module_mm, planet_width_mm(gears, motor, settings)),
        ),
        width_high_mm=reach * face_limit_mm(gears, settings),
        carried=(sun_mesh.least_carried, ring_mesh.least_carried),
    )


def face_limit_mm(gears: GearSet, settings: ActuatorSettings) -> Numbers:
    """Return the largest face width by the sun's diameter and by the module."""
    data = settings.parts.rating
    return gears.module_mm * np.minimum(data.face_over_sun_max * gears.sun_teeth, data.face_modules_max)


def _rim_factors(gears: GearSet, family: Family, settings: ActuatorSettings) -> tuple[Numbers, Numbers, Numbers]:
    """Return Y_B of sun, planet and ring. Recesses in the planet leave a rim of 1.2 tooth depths, see ``front``."""
    depth = TOOTH_DEPTH * gears.module_mm
    planet = external_rim_factor((gears.planet().root_radius_mm - 0.5 * settings.planet_bore_mm) / depth)
    wall = ring_radius_mm(gears, family, settings) - gears.ring_root_radius_mm
    ring = internal_rim_factor(wall / gears.module_mm)
    # The sun is one piece with its shaft: no rim.
    return np.ones(np.shape(planet))[()], planet, ring


def _mesh(
    *,
    pinion: Callable[..., Member],
    wheel: Callable[..., Member],
    steels: tuple[GearGrade, GearGrade],
    pair: tuple[ExternalGear, ExternalGear | InternalGear],
    working_angle_rad: Numbers,
    module_mm: Numbers,
    contact_ratio: Numbers,
    force_n: Numbers,
    sharing: Numbers,
    speed: Numbers,
    settings: ActuatorSettings,
) -> Mesh:
    internal, teeth = isinstance(pair[1], InternalGear), (pair[0].teeth, pair[1].teeth)
    single = single_contact_factors(*pair, contact_ratio, working_angle_rad)
    both = flank_factors(settings.materials.gear_steel, contact_ratio_factor(contact_ratio), working_angle_rad)
    diameter = module_mm * teeth[0]
    common = {
        "module_mm": module_mm,
        "contact_ratio": contact_ratio,
        "diameter_mm": diameter,
        "ratio": teeth[1] / teeth[0],
        "internal": internal,
    }
    worn = 0.5 * (load.pitch_running_in(steels[0]) + load.pitch_running_in(steels[1]))
    deviation = load.pitch_deviation_um(module_mm * teeth[1], module_mm, settings.parts.rating.accuracy_class)
    return Mesh(
        internal=internal,
        pinion=pinion(shape=pair[0], mate=steels[1], factors=both, single=single[0], **common),
        wheel=wheel(shape=pair[1], mate=steels[0], factors=both, single=single[1], **common),
        pinion_teeth=teeth[0],
        wheel_teeth=teeth[1],
        diameter_mm=diameter,
        contact_ratio=contact_ratio,
        working_angle_rad=working_angle_rad,
        force_n=force_n,
        sharing=sharing,
        speed_m_per_s=speed,
        pair_stiffness=load.pair_stiffness(*pair),
        pitch_deviation_um=(1.0 - worn) * np.cos(PRESSURE_ANGLE_RAD) * deviation,
    )


def _member(
    *,
    gear: str,
    steel: GearGrade,
    mate: GearGrade,
    shape: ExternalGear | InternalGear,
    module_mm: Numbers,
    contact_ratio: Numbers,
    diameter_mm: Numbers,
    ratio: Numbers,
    internal: bool,
    factors: Numbers,
    single: Numbers,
    rim_factor: Numbers,
    passes: Numbers,
    settings: ActuatorSettings,
    idler: bool = False,
) -> Member:
    """Return one gear in one mesh; ``internal`` says whether the mesh is the ring's."""
    data, duty = settings.parts.rating, settings.parts.duty
    thinnest = shape.backlash_mm + thickness_tolerance_mm(module_mm * shape.teeth, RATED_SERIES)
    form = tooth_form(replace(shape, backlash_mm=thinnest), contact_ratio)
    flank_curve, root_curve = FLANK_CURVES[steel.treatment], ROOT_CURVES[steel.treatment]
    flank_cycles = equivalent_cycles(passes, duty, flank_curve.exponent, flank=True, both_ways=idler)
    root_cycles = equivalent_cycles(passes, duty, root_curve.exponent, flank=False, both_ways=idler)
    flank_life, root_life = flank_curve.factor(flank_cycles), root_curve.factor(root_cycles)
    # Stresses are those at the peak torque. A duty that goes beyond it leaves so much less for them.
    highest = highest_share(duty)
    flank = flank_limit_mpa(steel, mate, flank_life, finish_factor(settings, internal=internal)) / np.sqrt(highest)
    bending = data.reversed_bending_factor if idler else mean_stress_factor(steel, form, reversal_ratio(duty))
    root = root_limit_mpa(steel, form, root_life, roughness_um=data.root_roughness_um, bending_factor=bending)
    root = root / highest
    over_flank = float(flank_limit_mpa(steel, mate, flank_curve.static_factor, 1.0))
    over_root = static_root_limit_mpa(steel, form, root_curve.static_factor)

    def flank_load(permissible: Numbers) -> Numbers:
        return flank_load_n_per_mm(permissible, diameter_mm, ratio, factors * single, internal=internal)

    def root_load(permissible: Numbers) -> Numbers:
        return root_load_n_per_mm(permissible, module_mm, form, rim_factor)

    return Member(
        gear=gear,
        steel=steel,
        contact_factors=factors * single,
        single_contact=single,
        form=form,
        rim_factor=rim_factor,
        flank_cycles=flank_cycles,
        root_cycles=root_cycles,
        flank_life=flank_life,
        root_life=root_life,
        bending_factor=bending,
        work_hardening=work_hardening_factor(steel, mate),
        flank_limit_mpa=flank,
        root_limit_mpa=root,
        overload_flank_limit_mpa=over_flank,
        overload_root_limit_mpa=over_root,
        carries=Safeties(flank_load(flank), root_load(root), flank_load(over_flank), root_load(over_root)),
    )

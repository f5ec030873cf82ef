"""How ``actuators --ratio`` prints a gear calculation sheet, losses, stiffness, bushes and bearings."""

import textwrap
from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING, Literal

if TYPE_CHECKING:
    from rich.console import Console
    from rich.table import Table

    from pareto_monoped.actuator.assumptions import ServiceData
    from pareto_monoped.actuator.rating.sheet import GearRating, MeshRating, Rating
    from pareto_monoped.actuator.service.sheet import ServiceSheet
    from pareto_monoped.actuator.settings import ActuatorSettings

_QUANTITY_WIDTH = 33
_VALUE_INDENT = 23 * " "


def print_gear_sheet(console: "Console", rating: "Rating", settings: "ActuatorSettings") -> None:
    """Print a rating; at most 80 columns wide."""
    data, duty = settings.parts.rating, settings.parts.duty
    levels = ", ".join(
        f"{100.0 * share:g} % over {angle:g} rad{way}"
        for levels, way in ((duty.forward_levels, ""), (duty.reversed_levels, " reversed"))
        for share, angle in levels
    )
    steels = {one.gear: one for one in rating.gears}
    console.print()
    console.print("Rating after ISO 6336 at the motor's peak torque", markup=False)
    for name, value in (
        ("duty", f"{duty.jumps:g} jumps, each {levels}"),
        ("overload", f"{rating.overload_share:g} times the peak torque, once; K_A and K_V are 1"),
        ("accuracy", f"ISO 1328-1 class {data.accuracy_class}"),
        ("highest level", f"{rating.highest_share:g} times the peak torque, to which the limits refer"),
        ("gap of the planets", f"{rating.planet_gap_mm:.3f} mm between their tips"),
        ("crowning", f"{data.planet_crowning_um:g} um, of the planets"),
        ("K_gamma", f"AGMA 6123, sun {data.sun_support}"),
        *((one.gear, f"{one.steel}, {one.quality}, {one.hardness_hv:g} HV") for one in steels.values()),
        ("equal to 1", "Z_beta, Z_X, Y_beta, Y_DT, Y_X, Y_epsilon (method B)"),
        ("Y_ST", "2"),
        ("1 at overload", "Z_L Z_v Z_R, Y_R,rel,T, Y_M"),
    ):
        line = textwrap.fill(f"  {name:20} {value}", console.width, subsequent_indent=_VALUE_INDENT)
        console.print(line, markup=False, soft_wrap=True)
    console.print(_loads(rating))
    console.print(_stresses(list(rating.gears), settings))


def _table(first: str, *others: str) -> "Table":
    from rich import box
    from rich.table import Table

    table = Table(box=box.SIMPLE_HEAD, pad_edge=False, collapse_padding=True)
    table.add_column(first, min_width=_QUANTITY_WIDTH, no_wrap=True)
    for heading in others:
        table.add_column(heading, justify="right", min_width=9)
    return table


def _loads(rating: "Rating") -> "Table":
    rows: Iterable[tuple[str, Callable[[MeshRating], float], str]] = (
        ("tangential force F_t, N", lambda mesh: mesh.tangential_force_n, ".1f"),
        ("pitch-line speed v, m/s", lambda mesh: mesh.pitch_speed_m_per_s, ".2f"),
        ("reference diameter d_1, mm", lambda mesh: mesh.pinion_diameter_mm, ".3f"),
        ("gear ratio u", lambda mesh: mesh.gear_ratio, ".4f"),
        ("contact ratio epsilon_alpha", lambda mesh: mesh.contact_ratio, ".3f"),
        ("stiffness c_gamma, N/(mm um)", lambda mesh: mesh.mesh_stiffness_n_per_mm_um, ".3f"),
        ("misalignment F_beta,y, um", lambda mesh: mesh.misalignment_um, ".3f"),
        ("pitch f_pb less running in, um", lambda mesh: mesh.pitch_deviation_um, ".3f"),
        ("application K_A", lambda mesh: mesh.application_factor, ".3f"),
        ("load sharing K_gamma", lambda mesh: mesh.sharing_factor, ".3f"),
        ("dynamic K_V", lambda mesh: mesh.dynamic_factor, ".3f"),
        ("face load, flank K_Hbeta", lambda mesh: mesh.face_load_factor, ".3f"),
        ("face load, root K_Fbeta", lambda mesh: mesh.root_face_load_factor, ".3f"),
        ("transverse load, flank K_Halpha", lambda mesh: mesh.transverse_load_factor, ".3f"),
        ("transverse load, root K_Falpha", lambda mesh: mesh.root_transverse_load_factor, ".3f"),
        ("overload, flank K_Hbeta", lambda mesh: mesh.overload_face_load_factor, ".3f"),
        ("overload, root K_Fbeta", lambda mesh: mesh.overload_root_face_load_factor, ".3f"),
        ("overload, flank K_Halpha", lambda mesh: mesh.overload_transverse_load_factor, ".3f"),
        ("overload, root K_Falpha", lambda mesh: mesh.overload_root_transverse_load_factor, ".3f"),
        ("zone Z_H", lambda mesh: mesh.zone_factor, ".4f"),
        ("elasticity Z_E, sqrt(MPa)", lambda mesh: mesh.elasticity_factor, ".2f"),
        ("contact ratio Z_epsilon", lambda mesh: mesh.contact_ratio_factor, ".4f"),
    )
    table = _table("load", "sun mesh", "ring mesh")
    for name, value, form in rows:
        table.add_row(name, format(value(rating.sun_mesh), form), format(value(rating.ring_mesh), form))
    return table


def _stresses(gears: "list[GearRating]", settings: "ActuatorSettings") -> "Table":
    data = settings.parts.rating
    rows: Iterable[tuple[str, Callable[[GearRating], float], str]] = (
        ("tip diameter d_a, mm", lambda gear: gear.tip_diameter_mm, ".3f"),
        ("form diameter d_Ff, mm", lambda gear: gear.form_diameter_mm, ".3f"),
        ("root diameter d_f, mm", lambda gear: gear.root_diameter_mm, ".3f"),
        ("tip thickness s_a, mm", lambda gear: gear.tip_thickness_mm, ".3f"),
        ("", lambda gear: 0.0, ""),
        ("single contact Z_B, Z_D", lambda gear: gear.single_contact_factor, ".3f"),
        ("flank load cycles, equivalent", lambda gear: gear.flank_cycles, ".2g"),
        ("life Z_NT", lambda gear: gear.flank_life_factor, ".3f"),
        ("strength sigma_H,lim, MPa", lambda gear: gear.contact_number_mpa, ".0f"),
        ("finish Z_L Z_v Z_R", lambda gear: gear.finish_factor, ".3f"),
        ("work hardening Z_W", lambda gear: gear.work_hardening_factor, ".3f"),
        ("contact stress sigma_H, MPa", lambda gear: gear.contact_stress_mpa, ".0f"),
        ("limit sigma_HG, MPa", lambda gear: gear.contact_limit_mpa, ".0f"),
        (f"S_H, at least {data.flank_safety:g}", lambda gear: gear.flank_safety, ".2f"),
        ("overload, life Z_NT", lambda gear: gear.static_flank_life_factor, ".3f"),
        (f"S_H at overload, at least {data.overload_flank_safety:g}", lambda gear: gear.overload_flank_safety, ".2f"),
        ("", lambda gear: 0.0, ""),
        ("form Y_F", lambda gear: gear.form_factor, ".3f"),
        ("stress correction Y_S", lambda gear: gear.stress_correction, ".3f"),
        ("rim Y_B", lambda gear: gear.rim_factor, ".3f"),
        ("root load cycles, equivalent", lambda gear: gear.root_cycles, ".2g"),
        ("life Y_NT", lambda gear: gear.root_life_factor, ".3f"),
        ("strength sigma_F,lim, MPa", lambda gear: gear.bending_number_mpa, ".0f"),
        ("notch Y_delta,rel,T", lambda gear: gear.notch_sensitivity_factor, ".3f"),
        ("roughness Y_R,rel,T", lambda gear: gear.roughness_factor, ".3f"),
        ("mean stress Y_M", lambda gear: gear.mean_stress_factor, ".3f"),
        ("bending stress sigma_F, MPa", lambda gear: gear.bending_stress_mpa, ".0f"),
        ("limit sigma_FG, MPa", lambda gear: gear.bending_limit_mpa, ".0f"),
        (f"S_F, at least {data.root_safety:g}", lambda gear: gear.root_safety, ".2f"),
        ("overload, life Y_NT", lambda gear: gear.static_root_life_factor, ".3f"),
        ("overload, notch Y_delta,rel,T", lambda gear: gear.static_notch_factor, ".3f"),
        (f"S_F at overload, at least {data.overload_root_safety:g}", lambda gear: gear.overload_root_safety, ".2f"),
    )
    table = _table("stress and safety", "sun", "planet\nwith sun", "planet\nwith ring", "ring")
    for name, value, form in rows:
        table.add_row(name, *(format(value(gear), form) if name else "" for gear in gears))
    return table


BEARING_COLUMNS: tuple[tuple[str, Literal["left", "right"]], ...] = (
    ("bearing", "left"),
    ("type", "left"),
    ("size, mm", "left"),
    ("force\nN", "right"),
    ("P\nN", "right"),
    ("tilt\nmrad", "right"),
    ("L10\nh", "right"),
    ("s0\npeak", "right"),
    ("s0\nover", "right"),
)  #: Heading and alignment of each column of ``bearing_rows``.
_LONG_H = 1e6


def service_lines(sheet: "ServiceSheet", settings: "ActuatorSettings") -> list[tuple[str, str]]:
    """Return name and value of one line each."""
    losses, stiffness = sheet.losses, sheet.stiffness
    sources = [
        f"{name} {100.0 * value:.1f}"
        for name, value in (
            ("mesh", losses.efficiency_mesh),
            ("planets", losses.efficiency_planets),
            ("bearings", losses.efficiency_bearings),
            ("churning", losses.efficiency_churning),
        )
        if name != "churning" or value < 1.0
    ]
    whole = 1.0 / stiffness.stiffness_n_m_per_rad
    shares = (
        ("teeth", stiffness.mesh),
        ("pins", stiffness.pins),
        *((("needles", stiffness.needles),) if stiffness.needles else ()),
        ("shaft", stiffness.shaft),
        ("carrier", stiffness.carrier),
    )
    return [
        ("with all losses", f"{100.0 * losses.efficiency_total:.1f} %: {', '.join(sources)} %"),
        ("stiffness at output", f"{1e-3 * stiffness.stiffness_n_m_per_rad:.1f} kN m/rad at most"),
        ("taken as rigid", "rims, spline, ring's bond, housing, bolted joints"),
        ("share in giving way", ", ".join(f"{name} {100.0 * part / whole:.0f}" for name, part in shares) + " %"),
        (
            "backlash at output",
            f"{sheet.backlash_arcmin:.1f} arcmin at least, {sheet.greatest_backlash_arcmin:.1f} at most by the teeth",
        ),
        ("", "play of bearings comes on top"),
        ("bending at output", f"{sheet.output_tilt_n_m:.1f} N m"),
        *_bush_lines(sheet, settings),
    ]


def _bush_lines(sheet: "ServiceSheet", settings: "ActuatorSettings") -> list[tuple[str, str]]:
    """Load on the planets' bushes, where there are any."""
    bush, in_duty, bronze = sheet.bush, sheet.bush_duty, settings.materials.bush_bronze
    if bush is None or in_duty is None:
        return []
    return [
        (
            "planet bushes",
            f"{bush.pressure_mpa:.1f} MPa at {bush.speed_m_per_s:.2f} m/s: pv {bush.pv_mpa_m_per_s:.1f} MPa m/s",
        ),
        (
            "",
            f"limit {bronze.pv_limit_mpa_m_per_s:g}, for short periods {bronze.pv_short_limit_mpa_m_per_s:g}; "
            f"in the duty {in_duty.pv_mpa_m_per_s:.1f}",
        ),
    ]


def bearing_rows(sheet: "ServiceSheet") -> list[tuple[str, ...]]:
    """Return one row for each bearing, under ``BEARING_COLUMNS``."""
    rows: list[tuple[str, ...]] = []
    for found in sheet.bearings:
        rated = found.bearing
        rows.append(
            (
                found.place,
                rated.designation,
                f"{rated.inner_diameter_mm:g}x{rated.outer_diameter_mm:g}x{rated.width_mm:g}",
                f"{found.force_n:.0f}",
                f"{found.equivalent_n:.0f}",
                f"{1e3 * found.tilt_rad:.1f}",
                f"{found.life_h:.0f}" if found.life_h < _LONG_H else "> 1e6",
                f"{found.static_safety:.2f}",
                f"{found.overload_safety:.2f}",
            )
        )
    return rows


def duty_lines(sheet: "ServiceSheet", settings: "ActuatorSettings", service: "ServiceData") -> list[str]:
    """Return the duty that the lives belong to, and the bearings and bushes that it asks too much of."""
    duty, overload = settings.parts.duty, settings.parts.rating.overload_factor
    turned = duty.reversed or (False,) * len(duty.torque_shares)
    *first, last = (
        f"{angle:g} rad at {share:g}{' (reversed)' if back else ''}"
        for share, angle, back in zip(duty.torque_shares, duty.output_angles_rad, turned, strict=True)
    )
    levels = f"{', '.join(first)} and {last}" if first else last
    lines = [
        f"Duty: {service.jumps_per_minute:g} jumps per minute, each {levels} of the peak torque.",
        f"Overload: {overload:g} times the peak torque, or the foot force in the push-off.",
    ]
    lines += [
        f"Bearing {found.place}: its rings tilt by {1e3 * found.tilt_rad:.1f} mrad at the peak torque; makers allow "
        f"{1e3 * service.bearing_tilt_limit_rad:.1f} at most."
        for found in sheet.bearings
        if found.tilt_rad > service.bearing_tilt_limit_rad
    ]
    lines += [
        f"Bearing {found.place}: s0 = {found.overload_safety:.2f} under the overload, less than 1: "
        "its balls or needles leave marks."
        for found in sheet.bearings
        if found.overload_safety < 1.0
    ]
    if sheet.bush is not None and sheet.bush.pv_mpa_m_per_s > settings.materials.bush_bronze.pv_short_limit_mpa_m_per_s:
        lines.append("Planet bushes: continuous torque at no-load speed exceeds even the limit for short periods.")
    return lines

"""How ``actuators --ratio`` prints losses, stiffness, bushes and bearings."""

from typing import TYPE_CHECKING, Literal

if TYPE_CHECKING:
    from pareto_monoped.actuator.service.data import ServiceData
    from pareto_monoped.actuator.service.sheet import ServiceSheet
    from pareto_monoped.actuator.settings import ActuatorSettings

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
)
"""Heading and alignment of each column of ``bearing_rows``."""
_LONG_H = 1e6


def service_lines(sheet: "ServiceSheet", settings: "ActuatorSettings") -> list[tuple[str, str]]:
    """Name and value of one line each."""
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
    """One row for each bearing, under ``BEARING_COLUMNS``."""
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
    """The duty that the lives belong to, and the bearings and bushes that it asks too much of."""
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

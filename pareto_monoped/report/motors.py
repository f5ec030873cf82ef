"""What the page shows of a motor: its stage 1 map, its gearboxes, and the leg that fits it."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.geometry.roles import Role
from pareto_monoped.geometry.shapes import Arc, Path
from pareto_monoped.leg.base import base_parts
from pareto_monoped.leg.dimensions import LegDimensions, leg_dimensions
from pareto_monoped.leg.shank import shank_parts
from pareto_monoped.leg.thigh import thigh_parts
from pareto_monoped.leg.thigh_outline import outer_hip_radius_mm
from pareto_monoped.report.packing import column
from pareto_monoped.report.schema import Gearbox, LegTable, MapPoint, MotorMap, Quantity, StudyCard

if TYPE_CHECKING:
    from pareto_monoped.actuator.actuator import Actuator
    from pareto_monoped.actuator.ratiomap import ActuatorMap

_HIGHEST_RATIO = 9.0  # intervals above this ratio are shown only if they have a gearbox: stage 2 does not search there
_LENGTHS_M = np.linspace(0.15, 0.55, 81)  # of the chart of link masses: from short links to beyond the paper's bounds


@dataclass(frozen=True, slots=True, kw_only=True)
class MotorTables:
    """The gearboxes of a motor, and its map, which refers to them by number."""

    gearboxes: list[Gearbox]
    map: MotorMap


def motor_tables(actuator_map: "ActuatorMap", first: int) -> MotorTables:
    """Return the stage 1 map of a motor, whose gearboxes are numbered from ``first``."""
    gearboxes: list[Gearbox] = []
    points = []
    for entry in actuator_map.entries:
        if entry.ratio_low > _HIGHEST_RATIO and entry.actuator is None:
            continue
        gearbox = None
        if entry.actuator is not None:
            gearbox = first + len(gearboxes)
            gearboxes.append(_gearbox(entry.actuator))
        lightest = {family: found.best.mass_kg for family, found in entry.families.items() if found.best is not None}
        point = MapPoint(
            ratio_low=entry.ratio_low,
            gearbox=gearbox,
            reason="" if entry.actuator is not None else entry.why_not(),
            family_mass_kg={family: round(mass_kg, 4) for family, mass_kg in lightest.items()},
        )
        points.append(point)
    low, following = actuator_map.ratios_low[:2]
    step, leg = round(float(following - low), 6), leg_table(leg_dimensions(actuator_map))
    found = MotorMap(motor=actuator_map.motor.name, points=points, ratio_step=step, leg=leg)
    return MotorTables(gearboxes=gearboxes, map=found)


def gearbox_numbers(actuator_map: "ActuatorMap", ratios: NDArray[np.float64], first: int) -> list[int]:
    """Return the numbers of the gearboxes that ratios get, shape (n,), as in ``motor_tables``; -1 for none."""
    has_gearbox = np.array([entry.actuator is not None for entry in actuator_map.entries])
    interval = actuator_map.interval_index(ratios)
    return list(np.where(interval >= 0, first + (np.cumsum(has_gearbox) - 1)[interval], -1).tolist())


def leg_table(d: LegDimensions) -> LegTable:
    """Return link masses over link length, and the dimensions of the page's drawing."""
    top = _upper_end(d)
    return LegTable(
        length_m=column(_LENGTHS_M),
        thigh_kg=column(sum(part.mass_kg() for part in thigh_parts(_LENGTHS_M, d))),
        shank_kg=column(sum(part.mass_kg() for part in shank_parts(_LENGTHS_M, d))),
        housing_radius_m=1e-3 * max(d.hip.housing_radius_mm, d.knee.housing_radius_mm),
        output_radius_m=1e-3 * d.knee.coupler_radius_mm,
        base_top_m=1e-3 * float(top.y_mm),
        base_top_radius_m=1e-3 * float(top.radius_mm),
        thigh_half_width_m=1e-3 * d.thigh_half_width_mm,
        thigh_hip_radius_m=1e-3 * outer_hip_radius_mm(d),
        thigh_knee_radius_m=1e-3 * d.knee_radius_mm,
        shank_knee_radius_m=1e-3 * d.shank_top_radius_mm,
        shank_foot_radius_m=1e-3 * d.shank_bottom_radius_mm,
    )


def _upper_end(d: LegDimensions) -> Arc:
    """Return the round upper end of the base's cheeks; it does not depend on the knee actuator's length."""
    cheek = next(part for part in base_parts(0.1, d) if part.role is Role.PLATE)
    outline = cheek.prisms[0].outline
    assert isinstance(outline, Path)
    return max((piece for piece in outline.pieces if isinstance(piece, Arc)), key=lambda arc: float(arc.y_mm))


def _gearbox(actuator: "Actuator") -> Gearbox:
    gears = actuator.gears
    body = actuator.motor.frameless if actuator.family == "ISSPG" else actuator.motor.framed
    return Gearbox(
        motor=actuator.motor.name,
        family=actuator.family,
        ratio=round(actuator.ratio, 4),
        sun_teeth=int(gears.sun_teeth),
        planet_teeth=int(gears.planet_teeth),
        ring_teeth=int(gears.ring_teeth),
        module_mm=float(gears.module_mm),
        planets=int(gears.planets),
        face_width_mm=round(actuator.face_width_mm, 2),
        mass_kg=round(actuator.mass_kg, 4),
        peak_torque_n_m=round(actuator.peak_torque_n_m, 2),
        no_load_speed_rad_per_s=round(actuator.no_load_speed_rad_per_s, 1),
        efficiency=round(actuator.efficiency, 4),
        motor_diameter_mm=body.outer_diameter_mm if body is not None else 0.0,
    )


_MOST_NAMED = 3  # changes that are told one by one: more are counted; our own choice


def switches(card: StudyCard, gearboxes: Sequence[Gearbox], first: Quantity) -> str:
    """Return where along a front the joints change the family of their gearbox, by its first objective."""
    if len(card.front) < 2:
        return ""
    columns = card.trials.columns
    firsts = [columns[first.name][row] for row in card.front]
    parts = []
    for joint in ("hip", "knee"):
        numbers = [columns[f"{joint}_gearbox"][row] for row in card.front]
        families = ["" if n is None or n < 0 else gearboxes[int(n)].family for n in numbers]
        at = [
            f"{first.scale * (value or 0.0):.2f} {first.unit}"
            for value, family, before in zip(firsts[1:], families[1:], families, strict=False)
            if family != before
        ]
        external = families.count("ESSPG")
        if external in (0, len(families)):
            parts.append(f"the {joint} stays with {'ESSPG' if external else 'ISSPG'}")
        elif len(at) <= _MOST_NAMED:
            parts.append(f"the {joint} changes at {', '.join(at)}")
        else:
            share = f"{external} of {len(families)} designs"
            parts.append(f"the {joint} has ESSPG in {share}, changing {len(at)} times between {at[0]} and {at[-1]}")
    return f" Along this front {'; '.join(parts)}."

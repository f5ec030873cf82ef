"""Command of stage 1: ``actuators``."""

import csv
import io
import json
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import click

from pareto_monoped.design import PAPER_MOTOR

if TYPE_CHECKING:
    from pareto_monoped.actuator.actuator import Actuator
    from pareto_monoped.actuator.ratiomap import ActuatorMap, MapEntry
    from pareto_monoped.geometry.parts import Part

_OUTPUT = click.Path(dir_okay=False, path_type=Path)


@click.command()
@click.option("--motor", metavar="NAME", default=PAPER_MOTOR, help="Name or TOML file.")
@click.option("--ratio", type=float, help="Explain the gearbox of one ratio, part by part.")
@click.option("--without", metavar="CONSTRAINT", multiple=True, help="Switch a constraint off; may be repeated.")
@click.option(
    "--bearings",
    type=click.Choice(["catalogue", "regression"]),
    default="catalogue",
    help="Mass of the main bearing: as listed, or the paper's regression over its bore.",
)
@click.option("--json", "as_json", is_flag=True, help="Print JSON.")
@click.option("--csv", "csv_file", metavar="FILE", type=_OUTPUT, help="Write the table to a file.")
def actuators(
    motor: str,
    ratio: float | None,
    without: tuple[str, ...],
    bearings: Literal["catalogue", "regression"],
    as_json: bool,
    csv_file: Path | None,
) -> None:
    """Print the lightest actuator for every gear ratio.

    Each row is a half-open interval of 0.1; the gearbox in it has the ratio printed beside it.
    """
    from pareto_monoped.actuator.motors import load_motor
    from pareto_monoped.actuator.search import build_map
    from pareto_monoped.actuator.settings import ActuatorSettings

    settings = ActuatorSettings(constraints_off=frozenset(without), bearings=bearings)
    actuator_map = build_map(load_motor(motor), settings)
    if ratio is not None:
        actuator_map.lookup(ratio)
        entry = actuator_map.entries[int(actuator_map.interval_index([ratio])[0])]
        detail = _detail(entry)
        if csv_file:
            _write_csv(csv_file, [_row(entry)])
        if as_json:
            click.echo(json.dumps(detail, indent=2))
        else:
            _print_detail(actuator_map, entry, detail)
        return
    rows = [_row(entry) for entry in actuator_map.entries if entry.actuator is not None]
    if csv_file:
        _write_csv(csv_file, rows)
    if as_json:
        click.echo(json.dumps(rows, indent=2))
    else:
        _print_map(actuator_map)


def _row(entry: "MapEntry") -> dict[str, Any]:
    actuator = entry.actuator
    assert actuator is not None
    gears = actuator.gears
    return {
        "ratio_low": entry.ratio_low,
        "ratio": actuator.ratio,
        "type": actuator.family,
        "sun_teeth": gears.sun_teeth,
        "planet_teeth": gears.planet_teeth,
        "ring_teeth": gears.ring_teeth,
        "module_mm": gears.module_mm,
        "planets": gears.planets,
        "face_width_mm": actuator.face_width_mm,
        "mass_kg": actuator.mass_kg,
        "peak_torque_n_m": actuator.peak_torque_n_m,
        "efficiency": actuator.efficiency,
    }


def _write_csv(path: Path, rows: list[dict[str, Any]]) -> None:
    from pareto_monoped.files import write_text

    text = io.StringIO()
    writer = csv.DictWriter(text, list(rows[0]) if rows else [], lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    write_text(path, text.getvalue())


def _print_map(actuator_map: "ActuatorMap") -> None:
    from rich import box
    from rich.console import Console
    from rich.table import Table

    table = Table(box=box.SIMPLE_HEAD, pad_edge=False, collapse_padding=True)
    table.add_column("from\nratio")
    table.add_column("real\nratio", justify="right")
    table.add_column("type")
    table.add_column("sun/planet/\nring teeth", justify="right", no_wrap=True)
    table.add_column("m\nmm", justify="right")
    table.add_column("n_p", justify="right")
    table.add_column("face\nmm", justify="right")
    table.add_column("mass\nkg", justify="right")
    table.add_column("peak\nN m", justify="right")
    table.add_column("eff.\n%", justify="right")
    gaps: list[list[MapEntry]] = []
    for index, entry in enumerate(actuator_map.entries):
        actuator = entry.actuator
        if actuator is None:
            if gaps and gaps[-1][-1] is actuator_map.entries[index - 1]:
                gaps[-1].append(entry)
            else:
                gaps.append([entry])
            continue
        gears = actuator.gears
        table.add_row(
            f"{entry.ratio_low:.1f}",
            f"{actuator.ratio:.3f}",
            actuator.family,
            f"{gears.sun_teeth}/{gears.planet_teeth}/{gears.ring_teeth}",
            f"{gears.module_mm:g}",
            f"{gears.planets}",
            f"{actuator.face_width_mm:.1f}",
            f"{actuator.mass_kg:.3f}",
            f"{actuator.peak_torque_n_m:.1f}",
            f"{100.0 * actuator.efficiency:.1f}",
        )
    console = Console(width=80, highlight=False)
    console.print(table)
    for gap in gaps:
        low, high = gap[0].ratio_low, gap[-1].ratio_low + 0.1
        families = {
            family: sorted({name for entry in gap for name in entry.forbidden_by.get(family, ())})
            for family in gap[0].forbidden_by
        }
        reasons = "; ".join(f"{family}: {', '.join(names) or 'no tooth set'}" for family, names in families.items())
        console.print(f"No gearbox from {low:.1f} to {high:.1f}. In the way: {reasons}.", soft_wrap=False)


def _detail(entry: "MapEntry") -> dict[str, Any]:
    """Everything known about one interval."""
    from pareto_monoped.actuator.rules import CONSTRAINTS

    actuator = entry.actuator
    assert actuator is not None
    families = {}
    for family, found in entry.families.items():
        best = found.best
        families[family] = {
            "gears": None if best is None else str(best.gears),
            "mass_kg": None if best is None else best.mass_kg,
            "constraints_in_the_way": list(found.in_the_way),
        }
    second = entry.runner_up
    return _row(entry) | {
        "continuous_torque_n_m": actuator.continuous_torque_n_m,
        "no_load_speed_rad_per_s": actuator.no_load_speed_rad_per_s,
        "reflected_inertia_kg_m2": actuator.reflected_inertia_kg_m2,
        "contact_ratio_sun": actuator.contact_ratio_sun,
        "contact_ratio_ring": actuator.contact_ratio_ring,
        "length_mm": actuator.length_mm,
        "runner_up": None
        if second is None
        else {"type": second.family, "gears": str(second.gears), "mass_kg": second.mass_kg},
        "binding": {name: CONSTRAINTS[name].says for name in entry.binding},
        "families": families,
        "parts": [
            {
                "name": part.name,
                "material": part.material.name,
                "group": part.group,
                "count": int(part.count),
                "mass_kg": float(part.mass_kg()),
                "axial_inertia_kg_m2": _axial_inertia_kg_m2(part),
            }
            for part in sorted(actuator.parts, key=lambda part: -float(part.mass_kg()))
        ],
    }


def _axial_inertia_kg_m2(part: "Part") -> float:
    """Of all instances together, about the gearbox axis."""
    second = part.mass_properties().second_kg_m2
    return float(second[0, 0] + second[1, 1])


def _print_detail(actuator_map: "ActuatorMap", entry: "MapEntry", detail: dict[str, Any]) -> None:
    from rich import box
    from rich.console import Console
    from rich.table import Table

    actuator: Actuator | None = entry.actuator
    assert actuator is not None
    console = Console(width=80, highlight=False)
    console.print(
        f"{actuator_map.motor.name}, [{entry.ratio_low:.1f}, {entry.ratio_low + 0.1:.1f}): "
        f"{actuator.family} {actuator.gears}, {actuator.ratio:.4f}:1, {actuator.mass_kg:.3f} kg",
        markup=False,
    )
    facts = (
        ("torque, peak", f"{actuator.peak_torque_n_m:.2f} N m"),
        ("torque, continuous", f"{actuator.continuous_torque_n_m:.2f} N m"),
        ("no-load speed", f"{actuator.no_load_speed_rad_per_s:.1f} rad/s"),
        ("mesh efficiency", f"{100.0 * actuator.efficiency:.1f} %"),
        ("reflected inertia", f"{actuator.reflected_inertia_kg_m2:.5f} kg m2"),
        ("contact ratios", f"{actuator.contact_ratio_sun:.2f} sun, {actuator.contact_ratio_ring:.2f} ring"),
        ("face width, length", f"{actuator.face_width_mm:.2f} mm, {actuator.length_mm:.1f} mm"),
    )
    for name, value in facts:
        console.print(f"  {name:20} {value}", markup=False)
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False, collapse_padding=True)
    table.add_column("part", no_wrap=True)
    table.add_column("material")
    table.add_column("count", justify="right")
    table.add_column("mass, g", justify="right")
    table.add_column("share, %", justify="right")
    table.add_column("inertia,\nkg mm2", justify="right")
    for part in detail["parts"]:
        table.add_row(
            part["name"],
            part["material"],
            f"{part['count']}",
            f"{1e3 * part['mass_kg']:.1f}",
            f"{100.0 * part['mass_kg'] / actuator.mass_kg:.1f}",
            f"{1e6 * part['axial_inertia_kg_m2']:.2f}",
        )
    console.print(table)
    second = detail["runner_up"]
    if second:
        console.print(f"Runner-up: {second['type']} {second['gears']}, {second['mass_kg']:.3f} kg", markup=False)
    for family, found in detail["families"].items():
        if family != actuator.family and found["mass_kg"] is not None:
            console.print(f"Best {family}: {found['gears']}, {found['mass_kg']:.3f} kg", markup=False)
        elif family != actuator.family:
            names = ", ".join(found["constraints_in_the_way"]) or "no tooth set in this interval"
            console.print(f"No {family} here: {names}", markup=False)
    if detail["binding"]:
        console.print("Each of these alone keeps out a lighter set:")
        for name, says in detail["binding"].items():
            console.print(f"  {name}: {says}", markup=False)

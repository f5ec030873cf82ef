"""Command of stage 1: ``actuators``."""

import csv
import io
import json
import math
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import click

from pareto_monoped.cli import options
from pareto_monoped.cli.options import CSV_FILE_OR_DASH, Local, force_option
from pareto_monoped.cli.terminal import echo, new_console, note
from pareto_monoped.design import DEFAULT_RULES, PAPER_MOTOR, RULE_SETS, RuleSet

if TYPE_CHECKING:
    from rich.table import Table

    from pareto_monoped.actuator.actuator import Actuator
    from pareto_monoped.actuator.gearset import GearSet
    from pareto_monoped.actuator.ratiomap import ActuatorMap, MapEntry
    from pareto_monoped.actuator.service.sheet import ServiceSheet

_OUTPUT = Local(dir_okay=False)
_STANDARD_OUTPUT = Path("-")


class _WithRules(click.Command):
    """Its help ends with the names that ``--without`` takes; they are read only then."""

    def format_epilog(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        from pareto_monoped.design import CONSTRAINT_NAMES

        formatter.write_paragraph()
        formatter.write_text(f"Constraints of --without: {', '.join(CONSTRAINT_NAMES)}.")


@click.command(cls=_WithRules)
@click.option(
    "--motor",
    metavar="NAME",
    shell_complete=options.motors,
    default=PAPER_MOTOR,
    show_default=True,
    help="Name or TOML file.",
)
@click.option("--ratio", metavar="X", type=float, help="Show the gearbox for this ratio, part by part.")
@click.option("--rules", type=click.Choice(RULE_SETS), default=DEFAULT_RULES, show_default=True, help="Set of rules.")
@click.option(
    "--without",
    metavar="NAME",
    multiple=True,
    shell_complete=options.constraints,
    help="Switch a constraint off; may be repeated.",
)
@click.option(
    "--bearings",
    type=click.Choice(["catalogue", "regression"]),
    default="catalogue",
    help="Mass of the main bearing: as listed, or by the paper's regression over the bore.",
)
@click.option("--json", "as_json", is_flag=True, help="Print JSON.")
@click.option(
    "--csv",
    "csv_file",
    metavar="FILE.csv",
    type=CSV_FILE_OR_DASH,
    help="Also write the table to a CSV file; `-` prints it as CSV instead.",
)
@click.option(
    "--figure",
    "figure_file",
    metavar="FILE",
    type=_OUTPUT,
    help="Also draw the mass over the ratio, both families and sets of rules: .svg, .png or .pdf.",
)
@force_option
def actuators(
    motor: str,
    ratio: float | None,
    rules: RuleSet,
    without: tuple[str, ...],
    bearings: Literal["catalogue", "regression"],
    as_json: bool,
    csv_file: Path | None,
    figure_file: Path | None,
    force: bool,
) -> None:
    """Print the lightest actuator for every gear ratio.

    Each row covers an interval of 0.1, without its upper end; its gearbox has the real ratio in the second column.
    """
    from pareto_monoped.actuator.explain import details, summary
    from pareto_monoped.actuator.motors import load_motor, motor_source
    from pareto_monoped.actuator.search import kept_map
    from pareto_monoped.actuator.service.sheet import service_sheet
    from pareto_monoped.actuator.settings import ActuatorSettings

    if as_json and csv_file == _STANDARD_OUTPUT:
        raise click.UsageError("--json and --csv - both print to standard output; drop one of them")
    settings = ActuatorSettings(rules=rules, constraints_off=frozenset(without), bearings=bearings)
    actuator_map = kept_map(load_motor(motor), settings)
    entries = [entry for entry in actuator_map.entries if entry.actuator is not None]
    if csv_file and not entries:
        _write_csv(csv_file, [], rules, force=force)
    actuator_map.require_gearbox(motor_source(motor))
    if ratio is not None:
        entries = [actuator_map.entry(ratio)]
    if figure_file:
        from pareto_monoped.report.figures import write_map_figure

        # The rules that were asked for come first; the others are there to compare.
        maps: dict[str, ActuatorMap] = {rules: actuator_map}
        for other in RULE_SETS:
            if other != rules:
                maps[other] = kept_map(actuator_map.motor, replace(settings, rules=other))
        write_map_figure(maps, figure_file, force=force)
    sheets = [service_sheet(entry.actuator, settings) for entry in entries if entry.actuator is not None]
    rows = [summary(entry, sheet) for entry, sheet in zip(entries, sheets, strict=True)]
    stand_in = "" if ratio is None else actuator_map.stand_in(ratio)
    if stand_in:
        note(stand_in)
    if csv_file:
        _write_csv(csv_file, rows, rules, force=force)
    if csv_file == _STANDARD_OUTPUT:
        return
    if as_json:
        label = {"stand_in": stand_in} if stand_in else {}
        echo(json.dumps(rows if ratio is None else details(entries[0], sheets[0]) | label, indent=2))
    elif ratio is None:
        _print_map(actuator_map)
    else:
        _print_details(actuator_map, entries[0], sheets[0])


def _write_csv(path: Path, rows: list[dict[str, Any]], rules: RuleSet, *, force: bool) -> None:
    from pareto_monoped.files import write_text

    text = io.StringIO()
    writer = csv.DictWriter(text, list(rows[0]) if rows else _columns(rules), lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    if path == _STANDARD_OUTPUT:
        echo(text.getvalue(), nl=False)
    else:
        write_text(path, text.getvalue(), force=force)


def _columns(rules: RuleSet) -> list[str]:
    """Return keys of a row, of which a motor without any gearbox has none: those of the default motor's map."""
    from pareto_monoped.actuator.explain import summary
    from pareto_monoped.actuator.search import map_for
    from pareto_monoped.actuator.service.sheet import service_sheet

    found = map_for(PAPER_MOTOR, rules)
    entry = next(entry for entry in found.entries if entry.actuator is not None)
    assert entry.actuator is not None
    return list(summary(entry, service_sheet(entry.actuator, found.settings)))


def _table(*columns: tuple[str, Literal["left", "right"]], no_wrap: str) -> "Table":
    """Return a table of these headings and alignments; the column ``no_wrap`` keeps its width."""
    from rich import box
    from rich.table import Table

    table = Table(box=box.SIMPLE_HEAD, pad_edge=False, collapse_padding=True)
    for heading, justify in columns:
        table.add_column(heading, justify=justify, no_wrap=heading == no_wrap)
    return table


def _print_map(actuator_map: "ActuatorMap") -> None:
    from pareto_monoped.actuator.explain import gaps, motor_facts
    from pareto_monoped.actuator.ratiomap import either

    rated = actuator_map.settings.rules != "paper"
    table = _table(
        ("from\nratio", "left"),
        ("real\nratio", "right"),
        ("type", "left"),
        ("sun/planet/\nring teeth", "right"),
        ("m\nmm", "right"),
        ("n_p", "right"),
        ("face\nmm", "right"),
        ("mass\nkg", "right"),
        *((("eff.\n%", "right"), ("S_H", "right"), ("S_F", "right")) if rated else _UNRATED),
        no_wrap="sun/planet/\nring teeth",
    )
    for entry in actuator_map.entries:
        actuator = entry.actuator
        if actuator is None:
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
            *_last_cells(actuator),
        )
    console = new_console(width=80)
    console.print(table)
    for name, value in motor_facts(actuator_map.motor):
        console.print(f"{name:20} {value}", markup=False)
    for gap in gaps(actuator_map):
        reasons = "; ".join(
            f"{family}: {', '.join(names) or 'no tooth set'}" for family, names in gap.in_the_way.items()
        )
        console.print(f"No gearbox from {gap.ratio_low:.1f} to {gap.ratio_high:.1f}. In the way: {reasons}.")
        if rated:
            console.print(f"  Would help: {either(gap.cures)}.")


def _shift_lines(gears: "GearSet") -> list[tuple[str, str]]:
    """Return profile shifts in modules, positive outwards, with what they do to the mesh; none where there are none."""
    if not gears.is_shifted:
        return []
    angle = math.degrees(float(gears.working_angle_rad))
    return [
        (
            "profile shifts",
            f"{float(gears.sun_shift):+.4f} sun, {float(gears.planet_shift):+.4f} planet, "
            f"{float(gears.ring_shift):+.4f} ring",
        ),
        ("centre distance", f"{float(gears.carrier_radius_mm):.4f} mm, working pressure angle {angle:.3f} degrees"),
    ]


_UNRATED: tuple[tuple[str, Literal["left", "right"]], ...] = (("peak\nN m", "right"), ("eff.\n%", "right"))
"""The map's last columns where gears are not rated. Safety factors take the place of the torque, ratio times motor."""


def _last_cells(actuator: "Actuator") -> tuple[str, ...]:
    rating, efficiency = actuator.rating, f"{100.0 * actuator.efficiency:.1f}"
    if rating is None:
        return f"{actuator.peak_torque_n_m:.1f}", efficiency
    return efficiency, f"{rating.flank_safety:.2f}", f"{rating.root_safety:.2f}"


def _print_details(actuator_map: "ActuatorMap", entry: "MapEntry", sheet: "ServiceSheet") -> None:
    from pareto_monoped.actuator.assumptions import default_service
    from pareto_monoped.actuator.explain import details
    from pareto_monoped.cli.actuator_sheets import (
        BEARING_COLUMNS,
        bearing_rows,
        duty_lines,
        print_gear_sheet,
        service_lines,
    )

    actuator, known = entry.actuator, details(entry, sheet)
    assert actuator is not None
    console = new_console(width=80)
    console.print(
        f"{actuator_map.motor.name}, [{entry.ratio_low:.1f}, {entry.ratio_high:.1f}): "
        f"{actuator.family} {actuator.gears}, {actuator.ratio:.4f}:1, {actuator.mass_kg:.3f} kg",
        markup=False,
    )
    for name, value in (
        *_torque_lines(actuator),
        ("no-load speed", f"{actuator.no_load_speed_rad_per_s:.1f} rad/s"),
        ("mesh efficiency", f"{100.0 * actuator.efficiency:.1f} %"),
        ("reflected inertia", f"{actuator.reflected_inertia_kg_m2:.5f} kg m2"),
        ("rotor inertia", f"{1e6 * actuator.motor.rotor_inertia_kg_m2:.2f} kg mm2, of the motor alone"),
        ("contact ratios", f"{actuator.contact_ratio_sun:.2f} sun, {actuator.contact_ratio_ring:.2f} ring"),
        *_shift_lines(actuator.gears),
        *_tip_lines(known["tips_in_roots_mm"]),
        ("face width, length", f"{actuator.face_width_mm:.2f} mm, {actuator.length_mm:.1f} mm"),
        *service_lines(sheet, actuator_map.settings),
    ):
        console.print(f"  {name:20} {value}", markup=False)
    if actuator.rating is not None:
        print_gear_sheet(console, actuator.rating, actuator_map.settings)
    bearings = _table(*BEARING_COLUMNS, no_wrap="bearing")
    for row in bearing_rows(sheet):
        bearings.add_row(*row)
    console.print("\nBearings after ISO 281 and ISO 76; forces at the peak torque")
    console.print(bearings)
    for line in duty_lines(sheet, actuator_map.settings, default_service()):
        console.print(line, markup=False)
    console.print(_parts_table(known["parts"], actuator.mass_kg))
    for line in _rivals(actuator.family, known):
        console.print(line, markup=False)


def _tip_lines(depths_mm: dict[str, float]) -> list[tuple[str, str]]:
    """Return which tips reach into roots, as those of the rules ``paper`` may: such teeth jam, or wear each other."""
    found = [f"{names} {1e3 * depth:.1f} um deep" for names, depth in depths_mm.items() if depth > 0.0]
    return [("tips in roots", f"{', '.join(found)}; rules iso6336 cut them short")] if found else []


def _torque_lines(actuator: "Actuator") -> list[tuple[str, str]]:
    """Return the torques with their basis and how long they may be held; all before losses."""
    from pareto_monoped.actuator.explain import CONTINUOUS_BASIS, how_long, peak_basis

    motor = actuator.motor
    lasting = motor.lasting_torque_n_m
    return [
        ("torque, peak", f"{actuator.peak_torque_n_m:.2f} N m before losses; {how_long(motor.peak_torque_time_s)}"),
        ("", peak_basis(motor)),
        ("torque, continuous", f"{actuator.continuous_torque_n_m:.2f} N m before losses, {CONTINUOUS_BASIS}"),
        ("", how_long(motor.continuous_torque_time_s)),
        *(
            ()
            if lasting is None
            else (("torque, lasting", f"{actuator.ratio * lasting:.2f} N m, by its thermal data"),)
        ),
    ]


def _parts_table(parts: list[dict[str, Any]], mass_kg: float) -> "Table":
    table = _table(
        ("part", "left"),
        ("material", "left"),
        ("count", "right"),
        ("mass, g", "right"),
        ("share, %", "right"),
        ("inertia,\nkg mm2", "right"),
        no_wrap="part",
    )
    for part in parts:
        table.add_row(
            part["name"],
            part["material"],
            f"{part['count']}",
            f"{1e3 * part['mass_kg']:.1f}",
            f"{100.0 * part['mass_kg'] / mass_kg:.1f}",
            f"{1e6 * part['axial_inertia_kg_m2']:.2f}",
        )
    return table


def _rivals(chosen_family: str, known: dict[str, Any]) -> list[str]:
    """Return one line each: the runner-up, the best gearbox of the other families, and what keeps lighter ones out."""
    lines = []
    second = known["runner_up"]
    if second:
        lines.append(f"Runner-up: {second['type']} {second['gears']}, {second['mass_kg']:.3f} kg")
    for family, found in known["families"].items():
        if family == chosen_family:
            continue
        if found["mass_kg"] is not None:
            lines.append(f"Best {family}: {found['gears']}, {found['mass_kg']:.3f} kg")
        else:
            names = ", ".join(found["constraints_in_the_way"]) or "no tooth set in this interval"
            lines.append(f"No {family} here: {names}")
    if known["binding"]:
        lines.append("Each of these alone keeps out a lighter set:")
        lines += [f"  {name}: {says}" for name, says in known["binding"].items()]
    return lines

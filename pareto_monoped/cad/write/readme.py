"""``README.md`` of an export: what this is, what each file is for, how each part is made, what was checked."""

from collections.abc import Mapping, Sequence
from typing import Any

from pareto_monoped.cad.check.checks import Check
from pareto_monoped.cad.product import Product, UniquePart
from pareto_monoped.cad.write.formats import FILES
from pareto_monoped.design import VARIABLES

_HOW = {
    "laser cut": "Laser-cut from sheet by `laser/`; countersink where the parts list says so; deburr.",
    "3D printed": "Print from `print/`, solid (100 percent), 0.2 mm layers; PETG, nylon or the like.",
    "machined": "Turn and mill from bar by `parts/step/`; gears are wire-cut or hobbed after hardening.",
    "moulded": "Cast polyurethane or rubber in a printed mould around the foot block's tongue.",
    "bought": "Buy by the note in the parts list; the files only show the space it takes.",
}


def readme(record: Mapping[str, Any], product: Product, checks: Sequence[Check], formats: Sequence[str]) -> str:
    """One page: what this is, what each file is for, how each part is made, what was checked."""
    lines = ["# Monoped", ""]
    lines += [f"Made by {record['made_by']} with motor {record['motor']}; {record['mass_kg']:.2f} kg.", ""]
    lines += ["| variable | searched | as built |", "|---|---|---|"]
    for variable in VARIABLES:
        searched, built = record["searched"][variable.name], record["as_built"][variable.name]
        lines.append(f"| {variable.name} | {searched:.6g} | {built:.6g} |")
    for key, label in (("height_m", "jump height, m"), ("energy_j", "mechanical energy, J")):
        values = [record["jumps"][name][key] for name in ("searched", "as_built")]
        shown = [f"{value:.4g}" if value is not None else "-" for value in values]
        lines.append(f"| {label} | {shown[0]} | {shown[1]} |")
    lines += [
        "",
        "As built means lengths rounded to 0.1 mm and the gearboxes' real ratios, simulated again with calibration "
        f"{record['calibration']}.",
        "",
    ]
    for joint, actuator in record["actuators"].items():
        teeth = f"{actuator['sun_teeth']}/{actuator['planet_teeth']}/{actuator['ring_teeth']}"
        lines.append(
            f"- {joint}: {actuator['family']}, {actuator['ratio']:.3f} to 1, teeth {teeth}, module "
            f"{actuator['module_mm']:g} mm, {actuator['planets']} planets, {actuator['peak_torque_n_m']:.1f} N m peak"
        )
    lines += ["", "## Files", "", "| file | for |", "|---|---|"]
    for name in formats:
        lines += [f"| `{path}` | {purpose} |" for path, purpose in FILES[name]]
    lines += [
        "| `bom.csv` | parts list: count, material, process, mass, size |",
        "| `design.json` | the design with its motor and jump model, to make this folder again: "
        "`pareto-monoped export --record design.json -o DIR` |",
        "| `checks.json` | what was checked, in full |",
        "",
        "Part frames have z along the joint axis; the assembly has x forward, y left, z up and its origin on the hip "
        "axis. Model frames stand at the joint axes.",
        "",
        "## Making the parts",
        "",
    ]
    for process, how in _HOW.items():
        names = [_counted(kind) for kind in product.unique if kind.part.process == process]
        if names:
            lines += [f"**{process[0].upper()}{process[1:]}.** {how}", "", ", ".join(names) + ".", ""]
    lines += ["## Checks", "", "| check | looked at | worst |", "|---|---|---|"]
    lines += [f"| {check.name} | {check.looked_at} | {check.worst} |" for check in checks]
    return "\n".join(lines) + "\n"


def _counted(kind: UniquePart) -> str:
    return f"{kind.name} ({kind.count})" if kind.count > 1 else kind.name

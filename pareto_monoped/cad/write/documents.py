"""What stands beside the geometry: parts list, design record, checks, and a page that says what each file is for."""

import csv
import io
import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from typing import Any

import numpy as np

from pareto_monoped import __version__
from pareto_monoped.actuator.motors import Motor
from pareto_monoped.cad.assembly import Pose
from pareto_monoped.cad.check.checks import Check
from pareto_monoped.cad.product import Product, UniquePart, extent_mm
from pareto_monoped.cad.write.dxf import is_flat
from pareto_monoped.design import VARIABLES, Design
from pareto_monoped.jump.calibration import Calibration
from pareto_monoped.robot.build import Robot

MADE_BY = f"pareto-monoped {__version__}"
_BOM = ("part", "count", "material", "process", "mass_g", "total_g", "made_or_bought", "size_mm", "used_in", "note")

_FILES = {
    "step": (
        ("assembly.step", "the whole robot for any CAD program: named, coloured parts, mm"),
        ("parts/step/", "each part for machining or changing"),
    ),
    "stl": (("parts/stl/", "each part as triangles, mm"),),
    "3mf": (("print/", "the 3D-printed parts for the slicer, mm, lying as they are printed"),),
    "dxf": (("laser/", "the plates for the laser cutter: true outline without kerf, one layer, mm"),),
    "glb": (("assembly.glb", "the robot to look at in a browser or viewer, m"),),
    "mjcf": (("model/monoped.xml", "MuJoCo model that makes the simulated jump, with meshes and colliders, SI units"),),
    "urdf": (("model/monoped.urdf", "the same robot for other simulators, SI units"),),
    "png": (
        ("assembly.png", "the robot in its start pose"),
        ("knee_actuator_section.png", "the knee actuator cut along its axis"),
    ),
}
FORMATS = tuple(_FILES)
"""What an export can write; all by default."""

_HOW = {
    "laser cut": "Laser-cut from sheet by `laser/`; countersink where the parts list says so; deburr.",
    "3D printed": "Print from `print/`, solid (100 percent), 0.2 mm layers; PETG, nylon or the like.",
    "machined": "Turn and mill from bar by `parts/step/`; gears are wire-cut or hobbed after hardening.",
    "moulded": "Cast polyurethane or rubber in a printed mould around the foot block's tongue.",
    "bought": "Buy by the note in the parts list; the files only show the space it takes.",
}


def bom(product: Product) -> str:
    """The parts list as CSV, a row a part."""
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(_BOM)
    for kind in product.unique:
        mass_g = 1e3 * float(kind.part.unit_mass_kg())
        writer.writerow(
            (
                kind.name,
                kind.count,
                kind.part.material.name,
                kind.part.process,
                f"{mass_g:.2f}",
                f"{mass_g * kind.count:.2f}",
                "bought" if kind.part.process == "bought" else "made",
                " x ".join(f"{size:.1f}" for size in extent_mm(kind.mesh)),
                " ".join(kind.units),
                "; ".join(filter(None, (kind.part.note, kind.part.joint.text if kind.part.joint else ""))),
            )
        )
    return stream.getvalue()


def design_record(
    *,
    searched: Design,
    built: Design,
    robot: Robot,
    pose: Pose,
    jumps: Mapping[str, Mapping[str, Any]],
    calibration: Calibration,
    source: Mapping[str, Any] | None,
    formats: Sequence[str],
) -> dict[str, Any]:
    """Everything needed to build the export again, and what came out."""
    return {
        "made_by": MADE_BY,
        "motor": robot.hip.motor.name,
        "calibration": calibration.label,
        "source": dict(source or {}),
        "searched": searched.as_dict(),
        "as_built": built.as_dict(),
        "jumps": {name: dict(jump) for name, jump in jumps.items()},
        "mass_kg": robot.mass_kg,
        "pose": {"hip_rad": pose.hip_rad, "knee_rad": pose.knee_rad},
        "actuators": {
            name: {
                "family": actuator.family,
                "sun_teeth": int(actuator.gears.sun_teeth),
                "planet_teeth": int(actuator.gears.planet_teeth),
                "ring_teeth": int(actuator.gears.ring_teeth),
                "module_mm": float(actuator.gears.module_mm),
                "planets": int(actuator.gears.planets),
                "face_width_mm": actuator.face_width_mm,
                "ratio": actuator.ratio,
                "mass_kg": actuator.mass_kg,
                "peak_torque_n_m": actuator.peak_torque_n_m,
                "length_mm": actuator.length_mm,
            }
            for name, actuator in (("hip", robot.hip), ("knee", robot.knee))
        },
        "formats": list(formats),
        "motor_data": contents(robot.hip.motor),
        "calibration_data": contents(calibration),
    }


def contents(record: Motor | Calibration) -> dict[str, Any]:
    """Every value of a record as JSON has it, so that it can be read back."""
    plain_values: dict[str, Any] = json.loads(json.dumps(asdict(record)))
    return plain_values


def checks_record(checks: Sequence[Check]) -> str:
    """The checks as JSON."""
    rows = [
        {
            "check": check.name,
            "passed": check.passed,
            "looked_at": check.looked_at,
            "worst": check.worst,
            "failures": list(check.failures),
        }
        for check in checks
    ]
    return json.dumps(rows, indent=2) + "\n"


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
        lines += [f"| `{path}` | {purpose} |" for path, purpose in _FILES[name]]
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


def flat_parts(product: Product) -> list[UniquePart]:
    """What a laser cuts."""
    return [kind for kind in product.unique if is_flat(kind.part)]


def plain(value: float) -> float | None:
    """A JSON number, or nothing where there is none."""
    return float(value) if np.isfinite(value) else None

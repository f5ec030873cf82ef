"""``README.md`` of an export: what this is, what each file is for, how each part is made, what was checked."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from pareto_monoped.cad.cables import cables
from pareto_monoped.cad.check.result import Check
from pareto_monoped.cad.product import Product, UniquePart
from pareto_monoped.cad.write.folder import FILES
from pareto_monoped.robot.cost import Cost
from pareto_monoped.strength.factors import GearLife, JointFactor

_HOW = {
    "laser cut": "Laser-cut by the layer CUT in `laser/`; countersink, tap and ream as its layer NOTES says; deburr.",
    "3D printed": "Print from `print/`, solid (100 percent), 0.2 mm layers; PETG, nylon or the like.",
    "machined": "Turn and mill from bar by `parts/step/`; gears as their notes in the parts list say.",
    "moulded": "Cast polyurethane or rubber in a printed mould around the foot block's tongue.",
    "bought": "Buy by the note in the parts list; the files only show the space it takes.",
}


def readme(
    record: Mapping[str, Any],
    product: Product,
    checks: Sequence[Check],
    formats: Sequence[str],
    factors: Sequence[JointFactor] = (),
    life: GearLife | None = None,
    landing: str = "",
) -> str:
    """Return the page as Markdown; ``factors`` is empty if the design does not jump. ``landing`` says how it lands."""
    blocks = (_design(record, product.robot.cost, landing), _actuators(record), _files(formats), _making(product))
    lines = [line for block in (*blocks, _strength(record, factors, life), _checks(checks)) for line in block]
    return "\n".join(lines) + "\n"


def _design(record: Mapping[str, Any], cost: Cost, landing: str) -> Iterator[str]:
    yield from ("# Monoped", "")
    yield from (f"Made by {record['made_by']} with motor {record['motor']}; {record['mass_kg']:.2f} kg.", "")
    yield (
        f"Its parts cost about {cost.total_eur:.0f} EUR as a one-off: {cost.hours:.0f} hours of machines, "
        f"{cost.made:.0f} pieces made and {cost.bought:.0f} bought. Rates are rough; `bom.csv` has each part's cost."
    )
    yield ""
    yield from ("| variable | searched | as built |", "|---|---|---|")
    for name, searched in record["searched"].items():
        yield f"| {name} | {searched:.6g} | {record['as_built'][name]:.6g} |"
    for key, label in (("height_m", "jump height, m"), ("energy_j", "mechanical energy, J")):
        values = [record["jumps"][name][key] for name in ("searched", "as_built")]
        shown = [f"{value:.4g}" if value is not None else "-" for value in values]
        yield f"| {label} | {shown[0]} | {shown[1]} |"
    yield ""
    yield (
        "As built means lengths rounded to 0.1 mm and the gearboxes' real ratios, simulated again with calibration "
        f"{record['calibration']}."
    )
    there = record["jumps"]["stand"]
    if there["height_m"] is not None:
        yield (
            f"On the stand of `test_stand/`, whose rails keep the base from moving along the floor and rub, and with "
            f"{there['mass_kg']:.3f} kg of arms and carriages, it jumps {there['height_m']:.4g} m with "
            f"{there['energy_j']:.4g} J."
        )
    yield from filter(None, [landing])
    yield ""


def _actuators(record: Mapping[str, Any]) -> Iterator[str]:
    for joint, actuator in record["actuators"].items():
        teeth = f"{actuator['sun_teeth']}/{actuator['planet_teeth']}/{actuator['ring_teeth']}"
        shifts = [actuator[f"{gear}_shift"] for gear in ("sun", "planet", "ring") if f"{gear}_shift" in actuator]
        shifted = f"profile shifts {'/'.join(f'{shift:+.3f}' for shift in shifts)} modules, " if shifts else ""
        yield (
            f"- {joint}: {actuator['family']}, {actuator['ratio']:.3f} to 1, teeth {teeth}, module "
            f"{actuator['module_mm']:g} mm, {shifted}{actuator['planets']} planets, "
            f"{actuator['peak_torque_n_m']:.1f} N m peak"
        )
        if "stand_in" in actuator:
            yield f"  ({actuator['stand_in']})"
    yield ""


def _files(formats: Sequence[str]) -> Iterator[str]:
    yield from ("## Files", "", "| file | for |", "|---|---|")
    for name in formats:
        yield from (f"| `{path}` | {purpose} |" for path, purpose in FILES[name])
    yield "| `bom.csv` | parts list: count, material, process, mass, size, safety factors, cost |"
    yield (
        "| `cad/model.py` | the model to change: `python cad/model.py thigh_length=330` makes all solids and the "
        "assembly anew, with build123d alone |"
    )
    yield "| `parameters.csv` | its drivers, and what follows from them: value, unit, formula, meaning |"
    yield (
        "| `monoped_equations.txt` | the same as global variables with formulas, to which SolidWorks links a model; "
        "set its angular equation units to radians |"
    )
    yield "| `strength.csv` | safety factor of every joint under the loads of the jump |"
    yield "| `tolerances.csv` | dimension chains: every gap as drawn, at worst, and within three standard deviations |"
    yield (
        "| `design.json` | the design with its motor and jump model, to make this folder again: "
        "`pareto-monoped export --record design.json -o DIR` |"
    )
    yield "| `checks.json` | what was checked, in full |"
    yield ""
    yield (
        "Part frames have z along the joint axis; the assembly has x forward, y left, z up and its origin on the hip "
        "axis. Model frames stand at the joint axes."
    )
    yield ""
    if "urdf" in formats:
        yield (
            "The URDF cannot hold the inertia of the parts that turn with a motor, nor its coupling with the thigh's "
            "rotation. Comments at its joints give both; the MJCF has them."
        )
        yield ""


def _making(product: Product) -> Iterator[str]:
    """Yield per process how it is done and the parts that it makes, then what the cables lack room for."""
    yield from ("## Making the parts", "")
    for process, how in _HOW.items():
        names = [_counted(unique) for unique in product.unique if unique.part.process == process]
        if names:
            yield from (f"**{process[0].upper()}{process[1:]}.** {how}", "", ", ".join(names) + ".", "")
    for cable in cables(product.robot):
        if cable.warning:
            yield from (f"**Note.** {cable.warning[0].upper()}{cable.warning[1:]}.", "")


def _strength(record: Mapping[str, Any], factors: Sequence[JointFactor], life: GearLife | None) -> Iterator[str]:
    yield from ("## Strength", "")
    if not record["strength"]:
        yield from ("Strength was not asked for: this design may not hold.", "")
    if not factors:
        yield from ("The design does not jump, so that the loads of its joints are unknown.", "")
        return
    yield from ("Safety factors under the loads of the jump; `strength.csv` has formulas, loads and sources.", "")
    yield from ("| joint | safety factor | required |", "|---|---:|---:|")
    for one in factors:
        required = "informs" if one.joint.informs else f"{one.joint.required:g}"
        yield f"| {one.joint.name} | {one.factor:.2f} | {required} |"
    yield ""
    if life is not None:
        flank, root = life.asked
        yield (
            "`gear_flank` and `gear_root` are how much larger a torque may be that comes once, against static "
            f"strength. `gear_strikes` compares with the torque that the gears carry in every one of "
            f"{life.duty_jumps:.0f} jumps with the safety of their duty, {flank:g} against pits and {root:g} against "
            "broken teeth; fatigue also counts finish and lubricant (Z_L Z_v Z_R), static strength does not. It "
            "informs, and nothing is refused for it."
        )
        kept = f"Struck in every jump as in this one, the gears have the safety of their duty for {life.text} jumps."
        yield from (f"{life.advice[0].upper()}{life.advice[1:]}." if life.advice else kept, "")


def _checks(checks: Sequence[Check]) -> Iterator[str]:
    yield from ("## Checks", "", "| check | looked at | worst |", "|---|---|---|")
    yield from (f"| {check.name} | {check.looked_at} | {check.worst} |" for check in checks)


def _counted(unique: UniquePart) -> str:
    return f"{unique.name} ({unique.count})" if unique.count > 1 else unique.name

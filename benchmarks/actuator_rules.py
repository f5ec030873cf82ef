"""What the rules and each of their assumptions are worth on the maps: two tables of docs/actuators.md.

python benchmarks/actuator_rules.py
"""

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.actuator.assumptions import GearSteels
from pareto_monoped.actuator.motors import load_motor, motor_names
from pareto_monoped.actuator.ratiomap import ActuatorMap
from pareto_monoped.actuator.search import build_map, map_of
from pareto_monoped.actuator.settings import ActuatorSettings
from pareto_monoped.materials import GEAR_GRADES

MOTOR = "VT8020"
"""The motor of the paper, whose map shows what each assumption is worth."""


def main() -> None:
    """Print both tables."""
    titles = "gearboxes under `paper` | under `iso6336` | of these another gear set | mass, mean change | highest ratio"
    print(f"| motor | {titles} |")
    print("|---|---:|---:|---:|---:|---:|")
    for name in motor_names():
        print(_row(name, map_of(load_motor(name), "paper"), map_of(load_motor(name), "iso6336")))
    base = map_of(load_motor(MOTOR), "iso6336")
    print("\n| change | gearboxes | mass, mean change |\n|---|---:|---:|")
    for text, settings in _changes(base.settings):
        changed = build_map(load_motor(MOTOR), settings)
        print(f"| {text} | {_gearboxes(changed)} | {_grams(changed, base)} |")


def _row(name: str, paper: ActuatorMap, iso: ActuatorMap) -> str:
    pairs = list(zip(paper.entries, iso.entries, strict=False))
    kept = sum(
        a.actuator is not None and b.actuator is not None and a.actuator.gears == b.actuator.gears for a, b in pairs
    )
    highest = max(entry.ratio_low for entry in iso.entries if entry.actuator)
    count = _gearboxes(iso)
    return f"| {name} | {_gearboxes(paper)} | {count} | {count - kept} | {_grams(iso, paper)} | {highest:.1f} |"


def _changes(s: ActuatorSettings) -> Iterator[tuple[str, ActuatorSettings]]:
    """Each assumption changed alone."""

    def parts(**changed: Any) -> ActuatorSettings:
        return replace(s, parts=replace(s.parts, **changed))

    def rating(**changed: Any) -> ActuatorSettings:
        return parts(rating=replace(s.parts.rating, **changed))

    def duty(**changed: Any) -> ActuatorSettings:
        return parts(duty=replace(s.parts.duty, **changed))

    def steel(grade: str) -> ActuatorSettings:
        return replace(s, steels=GearSteels(**dict.fromkeys(("sun", "planet", "ring"), GEAR_GRADES[grade])))

    yield "no profile shift", replace(s, shifts=((0.0, 0.0),))
    yield "carriers tied by pins alone", rating(second_carrier="pins")
    yield "floating sun", rating(sun_support="floating")
    yield "K_A 1.0", rating(application_factor=1.0)
    yield "overload of 4 times the peak torque", rating(overload_factor=4.0)
    for text, grade in (
        ("16MnCr5, case-hardened", "case_hardened_16mncr5"),
        ("31CrMoV9, nitrided", "nitrided_31crmov9"),
        ("42CrMo4, nitrided", "nitrided_42crmo4"),
        ("42CrMo4, quenched and tempered", "through_hardened_42crmo4"),
    ):
        yield f"{text}, for all gears", steel(grade)
    yield "no reversed bending of the planets", rating(reversed_bending_factor=1.0)
    yield "no reversed torque in the duty", duty(reversed=(False,) * len(s.parts.duty.torque_shares))
    for share in (1.5, 2.0, 2.5):
        loads = s.parts.duty
        struck = duty(
            torque_shares=(*loads.torque_shares, share),
            reversed=(*loads.reversed, False),
            output_angles_rad=(*loads.output_angles_rad, 0.1),
        )
        yield f"strikes of {share:g} times the peak torque in the duty, over 0.1 rad", struck
    yield "planets not crowned", rating(planet_crowning_um=0.0)
    unthinned = replace(s.parts.gears, backlash_modules=0.0, backlash_least_mm=0.0)
    yield "teeth drawn without thinning", parts(gears=unthinned)
    yield "1,000,000 jumps", duty(jumps=1e6)
    yield "10,000 jumps", duty(jumps=1e4)
    yield "accuracy class 5", rating(accuracy_class=5)
    yield "accuracy class 7", rating(accuracy_class=7)
    yield "face at most 1.2 sun diameters", rating(face_over_sun_max=1.2)
    yield "face at most 3 sun diameters and 80 modules", rating(face_over_sun_max=3.0, face_modules_max=80.0)
    yield "two planets allowed", replace(s, planets_min=2)


def _masses_kg(actuators: ActuatorMap) -> NDArray[np.float64]:
    """Mass of each interval's actuator, shape (n,); NaN where there is none."""
    return np.array(actuators.masses_kg(), float)


def _gearboxes(actuators: ActuatorMap) -> int:
    return int(np.isfinite(_masses_kg(actuators)).sum())


def _grams(changed: ActuatorMap, base: ActuatorMap) -> str:
    """Mean change of mass over the intervals where both maps have a gearbox."""
    these, those = _masses_kg(changed), _masses_kg(base)
    count = min(len(these), len(those))
    grams = 1e3 * float(np.nanmean(these[:count] - those[:count]))
    return f"{grams:+.0f} g" if round(grams) else "0 g"


if __name__ == "__main__":
    main()

"""What the lightest gearboxes of the maps are like: three tables of docs/actuators.md.

Teeth and loads of the winners under ``iso6336``, the gaps of one gearbox at the worst of their limits, and what four
gearboxes under ``paper`` are good for.

python benchmarks/actuator_winners.py
"""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from pareto_monoped.actuator.actuator import Actuator
from pareto_monoped.actuator.motors import load_motor, motor_names
from pareto_monoped.actuator.rating.build import build_stage
from pareto_monoped.actuator.rating.sheet import MeshRating, rate, tip_depths_mm
from pareto_monoped.actuator.ratiomap import ActuatorMap
from pareto_monoped.actuator.search import build_map, map_for, map_of
from pareto_monoped.actuator.service.sheet import service_sheet
from pareto_monoped.actuator.settings import ActuatorSettings
from pareto_monoped.actuator.tolerances import gearbox_chains
from pareto_monoped.design import PAPER_CASES

MOTOR = "VT8020"
RATIOS = (4.0, 6.0, 7.9, 8.7)
"""The three of the paper's gear sets, and the end of its second family."""
DEEP_MM = 1e-6
"""Less than this is rounding."""


def main() -> None:
    """Print the tables."""
    maps = [map_of(load_motor(name)) for name in motor_names()]
    print("| of the winners of six motors | figure |\n|---|---:|")
    for text, figure in _figures(maps):
        print(f"| {text} | {figure} |")
    print("\n| gap | as drawn, mm | at worst, mm | at least, mm |\n|---|---:|---:|---:|")
    for chain in gearbox_chains(map_for(MOTOR).lookup(PAPER_CASES["C"].design.knee_ratio)):
        low, high = chain.worst_mm
        print(f"| {chain.name} | {chain.nominal_mm:.3f} | {low:.3f} to {high:.3f} | {chain.least_mm:g} |")
    paper = map_for(MOTOR, "paper")
    print(f"\n| {MOTOR}, `paper` | {' | '.join(map(str, RATIOS))} |\n{'|---' * (1 + len(RATIOS))}|")
    sheets = [dict(_service(paper, paper.lookup(ratio))) for ratio in RATIOS]
    for title in sheets[0]:
        print(f"| {title} | {' | '.join(sheet[title] for sheet in sheets)} |")


def _winners(found: ActuatorMap) -> list[Actuator]:
    return [entry.actuator for entry in found.entries if entry.actuator]


def _meshes(found: ActuatorMap) -> list[tuple[MeshRating, MeshRating]]:
    """Ratings of both meshes of every winner."""
    rated = [rate(build_stage(a.gears, a.motor, a.family, found.settings), a.face_width_mm) for a in _winners(found)]
    return [(one.sun_mesh, one.ring_mesh) for one in rated]


def _crowded(maps: list[ActuatorMap]) -> str:
    """Range of K_Hbeta at the sun, and how often it is above 2."""
    found = np.array([sun.face_load_factor for one in maps for sun, _ in _meshes(one)])
    return f"{found.min():.2f} to {found.max():.2f}, above 2 in {np.count_nonzero(found > 2.0)} of {len(found)}"


def _figures(maps: list[ActuatorMap]) -> Iterator[tuple[str, str]]:
    all_of_them = [winner for found in maps for winner in _winners(found)]
    count = len(all_of_them)
    modules = [one.gears.module_mm for one in all_of_them]
    yield "module, mm", f"{min(modules):g} to {max(modules):g}"
    yield "of module 0.5 mm", f"{modules.count(0.5)} of {count}"
    own = _winners(map_for(MOTOR))
    yield f"with profile shift, of the {MOTOR}", f"{sum(one.gears.is_shifted for one in own)} of {len(own)}"
    raised = [float(np.degrees(one.gears.working_angle_rad)) for one in all_of_them if one.gears.centre_shift]
    yield "pressure angle with (0.6, 0.5), degrees", f"{min(raised):.1f} to {max(raised):.1f}"
    depths = np.array([tip_depths_mm(replace(one.gears, tips_fitted=False))["ring", "planet"] for one in all_of_them])
    deep = np.count_nonzero(depths > DEEP_MM)
    yield "ring in the planets' roots with standard tips", f"{deep} of {count}, up to {1e3 * depths.max():.0f} um"
    off = [mesh.misalignment_um for found in maps for both in _meshes(found) for mesh in both]
    yield "misalignment of a mesh, um", f"{min(off):.0f} to {max(off):.0f}"
    yield "$K_{H\\beta}$ at the sun", _crowded(maps)
    straight = [build_map(load_motor(name), _uncrowned(found)) for name, found in zip(motor_names(), maps, strict=True)]
    yield "the same with straight planets", _crowded(straight)
    grams, fewer = [], []
    for flat, found in zip(straight, maps, strict=True):
        these, those = np.array(flat.masses_kg(), float), np.array(found.masses_kg(), float)
        both = min(len(these), len(those))
        grams.append(1e3 * float(np.nanmean(these[:both] - those[:both])))
        fewer.append(len(_winners(found)) - len(_winners(flat)))
    yield "heavier with straight planets, mean of each motor, g", f"{min(grams):.0f} to {max(grams):.0f}"
    yield "gearboxes fewer with straight planets, of each motor", f"{min(fewer)} to {max(fewer)}"
    yield "least clearance and width of tips at worst, modules", _tips(all_of_them)
    paper = [winner for name in motor_names() for winner in _winners(map_of(load_motor(name), "paper"))]
    yield f"the same of the {len(paper)} winners under `paper`", _tips(paper)


def _tips(winners: list[Actuator]) -> str:
    """Least clearance and width of tips at the worst of their limits."""
    least: dict[str, float] = {"clearance of the ": np.inf, "width of the ": np.inf}
    for one in winners:
        for chain in gearbox_chains(one):
            for start in least:
                if chain.name.startswith(start):
                    least[start] = min(least[start], float(chain.worst_mm[0] / one.gears.module_mm))
    return ", ".join(f"{value:.3f}" for value in least.values())


def _uncrowned(found: ActuatorMap) -> ActuatorSettings:
    parts = found.settings.parts
    return replace(found.settings, parts=replace(parts, rating=replace(parts.rating, planet_crowning_um=0.0)))


def _service(found: ActuatorMap, one: Actuator) -> Iterator[tuple[str, str]]:
    sheet = service_sheet(one, found.settings)
    losses, bearings = sheet.losses, {each.place: each for each in sheet.bearings}
    main, far = bearings["main, knee"], bearings["far, knee"]
    size = main.bearing
    shares = (losses.efficiency_mesh, losses.efficiency_planets, losses.efficiency_bearings)
    assert sheet.bush is not None
    assert sheet.bush_duty is not None
    yield "efficiency: mesh, bushes, bearings, %", ", ".join(f"{100.0 * share:.1f}" for share in shares)
    yield "all together, %", f"{100.0 * losses.efficiency_total:.1f}"
    bushes = (sheet.bush, sheet.bush_duty)
    yield "pv of the bushes, bound and in the duty, MPa m/s", ", ".join(f"{one.pv_mpa_m_per_s:.1f}" for one in bushes)
    yield "bending moment in the output face, N m", f"{sheet.output_tilt_n_m:.1f}"
    yield "main bearing", f"{size.inner_diameter_mm:.0f}x{size.outer_diameter_mm:.0f}x{size.width_mm:.0f}"
    for text, at in (("main", main), ("far", far)):
        yield f"{text} bearing: static safety, peak and overload", f"{at.static_safety:.1f}, {at.overload_safety:.1f}"
    yield "far bearing: life, million h", f"{1e-6 * far.life_h:.1f}"
    yield "tilt of the output, mrad", f"{1e3 * main.tilt_rad:.1f}"
    yield "stiffness at the output, kN m/rad", f"{1e-3 * sheet.stiffness.stiffness_n_m_per_rad:.0f}"
    yield "backlash at the output, arcmin", f"{sheet.backlash_arcmin:.0f}"


if __name__ == "__main__":
    main()

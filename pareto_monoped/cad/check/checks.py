"""What every export must pass: solids, meshes, masses, overlaps, working range, bolts, retention."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.cad.assembly import Instance
from pareto_monoped.cad.check.overlaps import Overlap, in_gear_cycle, in_pose, in_working_range
from pareto_monoped.cad.check.retention import PLAY_MM, loose_parts
from pareto_monoped.cad.kernel.client import SolidFacts
from pareto_monoped.cad.product import Product, UniquePart
from pareto_monoped.geometry.parts import MassProperties, Prism, total
from pareto_monoped.geometry.roles import FASTENERS
from pareto_monoped.geometry.shapes import Circle, Pattern
from pareto_monoped.robot.frames import BODIES
from pareto_monoped.robot.population import RobotArrays

PART_MASS_SHARE = 0.01
BODY_MASS_SHARE = 0.005
BODY_INERTIA_SHARE = 0.03
MESH_VOLUME_SHARE = 0.01
BOLT_OFFSET_MM = 0.05


@dataclass(frozen=True, slots=True, kw_only=True)
class Check:
    """One check: what it looked at, the worst it found with its limit, and every failure in words."""

    name: str
    looked_at: str
    worst: str
    failures: tuple[str, ...]

    @property
    def passed(self) -> bool:
        """Whether nothing failed."""
        return not self.failures


def run_checks(product: Product, arrays: RobotArrays) -> tuple[Check, ...]:
    """All checks of a product against the robot that is simulated.

    Args:
        product: solids, meshes, instances.
        arrays: the same robot as the simulation carries it, one row, masses from the parts.
    """
    # First what is done here: meanwhile the kernel builds the solids.
    pose, pairs = in_pose(product)
    gears, steps = in_gear_cycle(product)
    moving, clearance = in_working_range(product)
    solids = solid_properties(product)
    return (
        _valid(product),
        _watertight(product),
        _part_masses(product, solids),
        *_bodies(product, solids, arrays),
        _overlaps("no two parts overlap", f"all {pairs} pairs in the exported pose", pose),
        _overlaps("gears mesh", f"sun, planets and ring in {steps} steps of one tooth", gears),
        _range(moving, clearance),
        _bolts(product),
        _retention(product),
    )


def _valid(product: Product) -> Check:
    bad = [
        f"{kind.name}: its solid is not valid"
        for kind, solid in zip(product.unique, product.solids.result(), strict=True)
        if not solid.valid
    ]
    return Check(
        name="solids are valid", looked_at=f"{len(product.unique)} parts", worst=f"{len(bad)} bad", failures=tuple(bad)
    )


def _watertight(product: Product) -> Check:
    failures, worst = [], 0.0
    for kind in product.unique:
        if not kind.mesh.is_closed:
            failures.append(f"{kind.name}: its mesh is not closed")
        share = abs(kind.mesh.volume_mm3 / float(kind.part.volume_mm3()) - 1.0)
        worst = max(worst, share)
        if share > MESH_VOLUME_SHARE:
            failures.append(f"{kind.name}: its mesh has {share:.2%} more or less volume than its record")
    return Check(
        name="meshes are watertight",
        looked_at=f"{len(product.unique)} parts",
        worst=f"volume {worst:.2%} off its record, allowed {MESH_VOLUME_SHARE:.0%}",
        failures=tuple(failures),
    )


def _part_masses(product: Product, solids: list[MassProperties]) -> Check:
    failures, worst = [], 0.0
    for kind, solid, facts in zip(product.unique, solids, product.solids.result(), strict=True):
        cad, record = float(solid.mass_kg), float(kind.part.unit_mass_kg())
        share = abs(cad / record - 1.0)
        if kind.part.catalogue_mass_kg is not None:
            # A bought part weighs what its catalogue says; its envelope must still be the record's.
            share = max(share, abs(facts.volume_mm3 / float(kind.part.volume_mm3()) - 1.0))
        worst = max(worst, share)
        if share > PART_MASS_SHARE:
            failures.append(f"{kind.name}: CAD {cad:.5f} kg, record {record:.5f} kg, {share:.2%} off")
    return Check(
        name="parts weigh what was simulated",
        looked_at=f"{len(product.unique)} parts",
        worst=f"{worst:.3%} off, allowed {PART_MASS_SHARE:.0%}",
        failures=tuple(failures),
    )


def _bodies(product: Product, solids: list[MassProperties], arrays: RobotArrays) -> Iterable[Check]:
    for k, body in enumerate(BODIES):
        cad = body_properties(product, solids, body)
        mass = float(arrays.body_mass_kg[0, k])
        mass_share = abs(float(cad.mass_kg) / mass - 1.0)
        tensor = arrays.body_inertia_kg_m2[0, k]
        inertia_share = float(np.abs(np.diag(cad.inertia_kg_m2) / np.diag(tensor) - 1.0).max())
        com_mm = 1e3 * float(np.linalg.norm(cad.com_m - arrays.body_com_m[0, k]))
        failures = []
        if mass_share > BODY_MASS_SHARE:
            failures.append(f"{body}: CAD {float(cad.mass_kg):.4f} kg, simulated {mass:.4f} kg ({mass_share:.2%})")
        if inertia_share > BODY_INERTIA_SHARE:
            failures.append(f"{body}: inertia {inertia_share:.2%} off what was simulated")
        yield Check(
            name=f"{body} is the body that was simulated",
            looked_at=f"{float(cad.mass_kg):.4f} kg",
            worst=f"mass {mass_share:.3%} (allowed {BODY_MASS_SHARE:.1%}), inertia {inertia_share:.2%} "
            f"(allowed {BODY_INERTIA_SHARE:.0%}), centre of mass {com_mm:.3f} mm off",
            failures=tuple(failures),
        )


def body_properties(product: Product, solids: list[MassProperties], body: str) -> MassProperties:
    """Mass properties of a body's solids, in the body frame."""
    return total(
        solids[kind].placed(instance.in_body[:3, :3], 1e-3 * instance.in_body[:3, 3])
        for instance, kind in zip(product.instances, product.kinds, strict=True)
        if instance.body == body
    )


def solid_properties(product: Product) -> list[MassProperties]:
    """Mass properties of every unique part's solid in its own frame, with catalogue masses where there are."""
    return [_solid_properties(kind, facts) for kind, facts in zip(product.unique, product.solids.result(), strict=True)]


def _solid_properties(kind: UniquePart, facts: SolidFacts) -> MassProperties:
    volume, com = facts.volume_mm3, facts.centre_mm
    central = 0.5 * np.trace(facts.inertia_mm5) * np.eye(3) - facts.inertia_mm5
    density = kind.part.material.density_kg_per_m3 * 1e-9
    if kind.part.catalogue_mass_kg is not None:
        density = float(kind.part.catalogue_mass_kg) / volume
    return MassProperties(
        mass_kg=np.asarray(volume * density),
        first_kg_m=com * volume * density * 1e-3,
        second_kg_m2=(central + volume * np.outer(com, com)) * density * 1e-6,
    )


def _overlaps(name: str, looked_at: str, found: list[Overlap]) -> Check:
    worst: dict[tuple[str, str], Overlap] = {}
    for overlap in found:
        key = (overlap.one, overlap.other)
        if key not in worst or overlap.volume_mm3 > worst[key].volume_mm3:
            worst[key] = overlap
    deepest = max((overlap.depth_mm for overlap in found), default=0.0)
    return Check(
        name=name,
        looked_at=looked_at,
        worst=f"{deepest:.3f} mm deep" if found else "none",
        failures=tuple(str(overlap) for overlap in worst.values()),
    )


def _range(moving: list[Overlap], clearance_mm: float) -> Check:
    check = _overlaps("the leg moves freely", "hip and knee through their working ranges", moving)
    failures = check.failures
    if clearance_mm <= 0.0:
        failures += (f"shank and base come {-clearance_mm:.1f} mm into each other's reach",)
    return Check(
        name=check.name,
        looked_at=check.looked_at,
        worst=f"{check.worst}; shank stays {clearance_mm:.0f} mm clear of the base",
        failures=failures,
    )


def _retention(product: Product) -> Check:
    """Every part that is pushed along or across its axis pushes on the base in the end."""
    loose, count = loose_parts(product.robot)
    return Check(
        name="every part is held",
        looked_at=f"{count} parts in 6 directions, with {PLAY_MM} mm of play",
        worst=f"{len(loose)} loose",
        failures=tuple(str(part) for part in loose),
    )


def _bolts(product: Product) -> Check:
    """Every screw and bolt stands in a hole of at least two other parts, on the holes' axis."""
    holes = _axes_of_holes(product)
    failures, worst, count = [], 0.0, 0
    for instance in product.instances:
        if instance.part.role not in FASTENERS:
            continue
        count += 1
        centre, low, high = _shaft(instance)
        joined = {
            name: offset
            for name, x, z, bottom, top in holes
            if name != instance.name
            and min(top, high) - max(bottom, low) > 0.1
            and (offset := float(np.hypot(x - centre[0], z - centre[1]))) < 1.0
        }
        if len(joined) < 2:
            failures.append(f"{instance.name}: joins {len(joined)} part(s), not two: {', '.join(joined) or 'none'}")
        for name, offset in joined.items():
            worst = max(worst, offset)
            if offset > BOLT_OFFSET_MM:
                failures.append(f"{instance.name}: {offset:.2f} mm off its hole in {name}")
    return Check(
        name="bolt patterns coincide",
        looked_at=f"{count} screws and bolts",
        worst=f"{worst:.3f} mm off a hole's axis, allowed {BOLT_OFFSET_MM} mm",
        failures=tuple(failures),
    )


def _shaft(instance: Instance) -> tuple[NDArray[np.float64], float, float]:
    """Where a fastener's axis pierces the x-z plane, and its extent along y, in the assembly's frame."""
    ends = [
        instance.world @ np.array([0.0, 0.0, float(z), 1.0]) for p in instance.part.prisms for z in (p.z0_mm, p.z1_mm)
    ]
    heights = [float(end[1]) for end in ends]
    return ends[0][[0, 2]], min(heights), max(heights)


def _axes_of_holes(product: Product) -> list[tuple[str, float, float, float, float]]:
    """Every round hole of every instance: instance, x and z of its axis, extent along y, in the assembly's frame."""
    found = []
    for instance in product.instances:
        for prism in instance.part.prisms:
            for x, y in _centres(prism):
                ends = [instance.world @ np.array([x, y, float(z), 1.0]) for z in (prism.z0_mm, prism.z1_mm)]
                low, high = sorted(float(end[1]) for end in ends)
                found.append((instance.name, float(ends[0][0]), float(ends[0][2]), low, high))
    return found


def _centres(prism: Prism) -> Iterable[tuple[float, float]]:
    for hole in prism.holes:
        if isinstance(hole, Circle):
            yield float(hole.x_mm), float(hole.y_mm)
        elif isinstance(hole, Pattern):
            yield from hole.centres_mm()

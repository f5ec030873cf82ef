"""Parts and bodies weigh what was simulated; every body has the simulated centre of mass and inertia tensor."""

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from pareto_monoped.cad.check.result import BODY_MASS, CENTRE_OF_MASS, INERTIA, PART_MASS, Check, Finding, worst_of
from pareto_monoped.cad.kernel.client import SolidFacts
from pareto_monoped.cad.product import Product, UniquePart
from pareto_monoped.geometry.parts import MassProperties, total
from pareto_monoped.robot.population import RobotArrays
from pareto_monoped.robot.units import BODIES


def check_parts(product: Product, parts: Sequence[MassProperties]) -> Check:
    """Compare every part's solid with its record.

    A bought part weighs what its catalogue says; its envelope must still have the record's volume.
    """
    findings = []
    for kind, part, facts in zip(product.unique, parts, product.solids.result(), strict=True):
        cad, record = float(part.mass_kg), float(kind.part.unit_mass_kg())
        share = abs(cad / record - 1.0)
        if kind.part.catalogue_mass_kg is not None:
            share = max(share, abs(facts.volume_mm3 / float(kind.part.volume_mm3()) - 1.0))
        text = f"{kind.name}: CAD {cad:.5f} kg, record {record:.5f} kg, {share:.2%} off"
        findings.append(Finding(value=100.0 * share, text=text))
    return worst_of(PART_MASS, f"{len(product.unique)} parts", findings)


def check_bodies(bodies: Mapping[str, MassProperties], arrays: RobotArrays) -> Iterator[Check]:
    """Compare the mass of every body with the simulated one."""
    for k, body in enumerate(BODIES):
        cad, simulated = float(bodies[body].mass_kg), float(arrays.body_mass_kg[0, k])
        percent = 100.0 * abs(cad / simulated - 1.0)
        text = f"{body}: CAD {cad:.4f} kg, simulated {simulated:.4f} kg ({percent:.2f}%)"
        yield worst_of(BODY_MASS.of(body), f"{cad:.4f} kg", [Finding(value=percent, text=text)])


def check_centre_of_mass(bodies: Mapping[str, MassProperties], arrays: RobotArrays) -> Iterator[Check]:
    """Compare the centre of mass of every body with the simulated one, by their distance."""
    for k, body in enumerate(BODIES):
        cad_mm, simulated_mm = 1e3 * bodies[body].com_m, 1e3 * arrays.body_com_m[0, k]
        distance_mm = float(np.linalg.norm(cad_mm - simulated_mm))
        text = f"{body}: centre of mass {distance_mm:.2f} mm off what was simulated"
        at = ", ".join(f"{value:.1f}" for value in cad_mm)
        yield worst_of(CENTRE_OF_MASS.of(body), f"({at}) mm", [Finding(value=distance_mm, text=text)])


def check_inertia(bodies: Mapping[str, MassProperties], arrays: RobotArrays) -> Iterator[Check]:
    """Compare every entry of the tensors about the centres of mass, axes of the body frame."""
    for k, body in enumerate(BODIES):
        cad, simulated = bodies[body].inertia_kg_m2, arrays.body_inertia_kg_m2[0, k]
        moments = np.diag(simulated)
        percent = 100.0 * np.abs(cad - simulated) / np.sqrt(np.outer(moments, moments))
        findings = [
            Finding(
                value=float(percent[i, j]),
                text=f"{body}: inertia {'xyz'[i]}{'xyz'[j]} {percent[i, j]:.2f}% off what was simulated",
            )
            for i in range(3)
            for j in range(i, 3)
        ]
        yield worst_of(INERTIA.of(body), "every entry of the tensor", findings)


def weigh_parts(product: Product) -> list[MassProperties]:
    """Return the mass properties of every unique part's solid in its own frame; bought parts have catalogue masses."""
    return [_weigh(kind, facts) for kind, facts in zip(product.unique, product.solids.result(), strict=True)]


def weigh_bodies(product: Product, parts: Sequence[MassProperties]) -> Mapping[str, MassProperties]:
    """Return the mass properties of every body, in its body frame."""
    return {
        body: total(
            parts[kind].placed(instance.in_body[:3, :3], 1e-3 * instance.in_body[:3, 3])
            for instance, kind in zip(product.instances, product.kinds, strict=True)
            if instance.body == body
        )
        for body in BODIES
    }


def _weigh(kind: UniquePart, facts: SolidFacts) -> MassProperties:
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

"""What parts and bodies weigh by their solids, for the checks of mass, centre of mass and inertia."""

from collections.abc import Mapping, Sequence

import numpy as np

from pareto_monoped.cad.kernel.client import SolidFacts
from pareto_monoped.cad.product import Product, UniquePart
from pareto_monoped.geometry.parts import MassProperties, total
from pareto_monoped.robot.frames import BODIES


def weigh_parts(product: Product) -> list[MassProperties]:
    """Mass properties of every unique part's solid in its own frame; bought parts weigh what their catalogue says."""
    return [_weigh(kind, facts) for kind, facts in zip(product.unique, product.solids.result(), strict=True)]


def weigh_bodies(product: Product, parts: Sequence[MassProperties]) -> Mapping[str, MassProperties]:
    """Mass properties of every body, in its body frame.

    Args:
        product: where the parts stand.
        parts: of every unique part.
    """
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

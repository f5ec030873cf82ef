"""Parts and bodies weigh what was simulated."""

from collections.abc import Iterator, Mapping, Sequence

from pareto_monoped.cad.check.limits import BODY_MASS, PART_MASS
from pareto_monoped.cad.check.result import Check, Finding, worst_of
from pareto_monoped.cad.product import Product
from pareto_monoped.geometry.parts import MassProperties
from pareto_monoped.robot.frames import BODIES
from pareto_monoped.robot.population import RobotArrays


def check_parts(product: Product, parts: Sequence[MassProperties]) -> Check:
    """Compare every part's solid with its record.

    A bought part weighs what its catalogue says, whatever its envelope; its envelope must still have the record's
    volume.
    """
    return worst_of(PART_MASS, f"{len(product.unique)} parts", _part_findings(product, parts))


def check_bodies(bodies: Mapping[str, MassProperties], arrays: RobotArrays) -> Iterator[Check]:
    """Compare the mass of every body with the simulated one."""
    for k, body in enumerate(BODIES):
        cad, simulated = float(bodies[body].mass_kg), float(arrays.body_mass_kg[0, k])
        percent = 100.0 * abs(cad / simulated - 1.0)
        text = f"{body}: CAD {cad:.4f} kg, simulated {simulated:.4f} kg ({percent:.2f}%)"
        yield worst_of(BODY_MASS.of(body), f"{cad:.4f} kg", [Finding(value=percent, text=text)])


def _part_findings(product: Product, parts: Sequence[MassProperties]) -> Iterator[Finding]:
    for kind, part, facts in zip(product.unique, parts, product.solids.result(), strict=True):
        cad, record = float(part.mass_kg), float(kind.part.unit_mass_kg())
        share = abs(cad / record - 1.0)
        if kind.part.catalogue_mass_kg is not None:
            share = max(share, abs(facts.volume_mm3 / float(kind.part.volume_mm3()) - 1.0))
        text = f"{kind.name}: CAD {cad:.5f} kg, record {record:.5f} kg, {share:.2%} off"
        yield Finding(value=100.0 * share, text=text)

"""All checks that an export must pass, in the order in which it reports them."""

from collections.abc import Mapping, Sequence

from pareto_monoped.cad.check import (
    bolts,
    centre_of_mass,
    free_motion,
    gear_mesh,
    inertia,
    mass,
    overlap,
    retention,
    seats,
    strength,
    validity,
    watertight,
)
from pareto_monoped.cad.check.result import Check
from pareto_monoped.cad.check.weighing import weigh_bodies, weigh_parts
from pareto_monoped.cad.product import Product
from pareto_monoped.robot.population import RobotArrays
from pareto_monoped.strength.single import JointFactor


def run_checks(
    product: Product,
    arrays: RobotArrays,
    *,
    part_files: Mapping[str, bytes],
    other_files: Mapping[str, bytes],
    factors: Sequence[JointFactor] | None = None,
) -> tuple[Check, ...]:
    """All checks of a product against the robot that is simulated.

    Args:
        product: solids, meshes, instances.
        arrays: the same robot as the simulation carries it, one row, masses from the parts.
        part_files: the STL file of every unique part, whether it is to be written or not, by the part's name.
        other_files: all other files with triangles, by path.
        factors: of all joints, if they must be as required.
    """
    # First what does not need the solids, which the kernel's process is building meanwhile.
    without_solids = (
        overlap.check(product),
        gear_mesh.check(product),
        *free_motion.check(product),
        *bolts.check(product),
        seats.check(product),
        retention.check(product.robot),
    )
    meshes = watertight.check(product, part_files, other_files)
    parts = weigh_parts(product)
    bodies = weigh_bodies(product, parts)
    return (
        validity.check(product),
        *meshes,
        mass.check_parts(product, parts),
        *mass.check_bodies(bodies, arrays),
        *centre_of_mass.check(bodies, arrays),
        *inertia.check(bodies, arrays),
        *without_solids,
        *(() if factors is None else (strength.check(factors),)),
    )

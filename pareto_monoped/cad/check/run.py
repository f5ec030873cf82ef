"""All checks that an export must pass, in the order in which it reports them."""

from collections.abc import Mapping, Sequence

from pareto_monoped.cad.check import free_motion, gear_mesh, making, mass, overlap, retention, screws, watertight
from pareto_monoped.cad.check.mass import weigh_bodies, weigh_parts
from pareto_monoped.cad.check.result import CHAINS, STRENGTH, VALID, Check, Finding, count_of, worst_of
from pareto_monoped.cad.product import Product
from pareto_monoped.robot.build import Robot
from pareto_monoped.robot.population import RobotArrays
from pareto_monoped.robot.tolerances import robot_chains
from pareto_monoped.strength.factors import JointFactor


def check_strength(factors: Sequence[JointFactor]) -> Check:
    """Compare every factor with the one required; no factors if the design does not jump, and none that only inform."""
    factors = [one for one in factors if not one.joint.informs]
    looked_at = f"{len(factors)} joints under the loads of the jump" if factors else "no joints, as it does not jump"
    findings = []
    for one in factors:
        bound = f"safety factor = {one.factor:.3g}: must be at least {one.joint.required:g}"
        findings.append(Finding(value=one.share, text=f"{one.joint.name}: {bound}; {one.joint.cure}"))
    return worst_of(STRENGTH, looked_at, findings)


def check_chains(robot: Robot) -> Check:
    """Compare the least gap of every dimension chain with the one that it must keep."""
    chains = robot_chains(robot)
    findings = [
        # Rounded, as many chains end at their least gap exactly.
        Finding(value=round(chain.worst_mm[0] - chain.least_mm, 6) + 0.0, text=chain.text)
        for chain in chains
    ]
    return worst_of(CHAINS, f"{len(chains)} dimension chains", findings)


def check_validity(product: Product) -> Check:
    """Have the CAD kernel check topology and geometry of every unique part's solid."""
    solids = zip(product.unique, product.solids.result(), strict=True)
    bad = [f"{kind.name}: its solid is not valid" for kind, solid in solids if not solid.valid]
    return count_of(VALID, f"{len(product.unique)} parts", bad)


def run_checks(
    product: Product,
    arrays: RobotArrays,
    *,
    part_files: Mapping[str, bytes],
    other_files: Mapping[str, bytes],
    factors: Sequence[JointFactor] | None = None,
) -> tuple[Check, ...]:
    """Return all checks of a product against the robot that is simulated, with masses from the parts.

    ``part_files`` has the STL file of every unique part by the part's name, written or not, ``other_files`` all other
    files with triangles by path. ``factors`` are given if they must be as required.
    """
    # First what does not need the solids, which the kernel's process is building meanwhile.
    without_solids = (
        overlap.check(product),
        gear_mesh.check(product),
        *free_motion.check_free_motion(product),
        *screws.check_bolts(product),
        screws.check_seats(product),
        retention.check(product.robot),
        check_chains(product.robot),
        *making.check(product.unique),
    )
    meshes = watertight.check(product, part_files, other_files)
    parts = weigh_parts(product)
    bodies = weigh_bodies(product, parts)
    return (
        check_validity(product),
        *meshes,
        mass.check_parts(product, parts),
        *mass.check_bodies(bodies, arrays),
        *mass.check_centre_of_mass(bodies, arrays),
        *mass.check_inertia(bodies, arrays),
        *without_solids,
        *(() if factors is None else (check_strength(factors),)),
    )

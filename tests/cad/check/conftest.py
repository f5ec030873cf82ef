import pytest

from pareto_monoped.cad.check import free_motion, gear_mesh, making, overlap, retention, run, screws, watertight
from pareto_monoped.cad.check.overlap import PlacedMesh
from pareto_monoped.cad.product import Product
from pareto_monoped.cad.write import files
from pareto_monoped.cad.write.meshes import visuals
from pareto_monoped.robot.population import robot_arrays


@pytest.fixture(scope="session")
def arrays(product, actuator_map):
    """The product's robot as it is simulated."""
    return robot_arrays(product.robot.design.as_array(), actuator_map)


@pytest.fixture(scope="session")
def part_files(product):
    return files.part_meshes(product)


@pytest.fixture(scope="session")
def other_files(product):
    return files.other_meshes(product, visuals(product), ("3mf", "glb"))


@pytest.fixture(scope="package", autouse=True)
def looked_at_once():
    """Two meshes are intersected once per place: a product with something broken is mostly the one before."""

    def kept(look, key):
        known = {}

        def look_once(*arguments):
            if (here := key(*arguments)) not in known:
                known[here] = (look(*arguments), arguments)  # an id is unique only while its object is kept
            return known[here][0]

        return look_once

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(
            PlacedMesh, "of", kept(PlacedMesh.of, lambda name, body, place: (name, id(body), place.tobytes()))
        )
        patch.setattr(free_motion, "radii_mm", kept(free_motion.radii_mm, id))
        look = overlap.overlap_of
        pairs = kept(lambda *pair: tuple(look(*pair)), lambda one, other, where: (id(one), id(other), where))
        for module in (overlap, free_motion):
            patch.setattr(module, "overlap_of", pairs)
        yield


def _reads(argument):
    """What of a check's argument its result can depend on, but for the solids, which have checks of their own."""
    return (argument.instances, argument.unique, argument.robot) if isinstance(argument, Product) else (argument,)


@pytest.fixture(scope="session")
def examine(product, arrays, part_files, other_files):
    """Run all checks with something broken; returns them by name.

    Results of the slow checks are kept as long as nothing changes that these checks read.
    """
    known = {}

    def kept(module, name):
        look = getattr(module, name)

        def check(*arguments):
            reads = [item for argument in arguments for item in _reads(argument)]
            key = (module.__name__, name, *map(id, reads), free_motion.hip_stop, free_motion.knee_stop)
            if key not in known:
                known[key] = (look(*arguments), reads)  # an id is unique only while its object is kept
            return known[key][0]

        return check

    def examined(product=product, arrays=arrays, part_files=part_files, other_files=other_files):
        with pytest.MonkeyPatch.context() as patch:
            for module, *names in (
                (overlap, "check"),
                (free_motion, "check_free_motion"),
                (gear_mesh, "check"),
                (screws, "check_bolts", "check_seats"),
                (retention, "check"),
                (making, "check"),
                (run, "check_chains"),
                (watertight, "check"),
            ):
                for name in names:
                    patch.setattr(module, name, kept(module, name))
            checks = run.run_checks(product, arrays, part_files=part_files, other_files=other_files)
        return {check.name: check for check in checks}

    return examined


@pytest.fixture(scope="session")
def failing(examine):
    """Names of the checks that fail with something broken."""
    return lambda **broken: [name for name, check in examine(**broken).items() if not check.passed]

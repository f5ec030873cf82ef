"""Sun, planets and ring mesh without overlap while the sun turns by one tooth; then all repeats."""

import numpy as np

from pareto_monoped.cad.assembly import Pose, instances
from pareto_monoped.cad.check.contact import Overlap, PlacedMesh, deepest, near, overlap_of
from pareto_monoped.cad.check.limits import GEAR_MESH
from pareto_monoped.cad.check.result import Check
from pareto_monoped.cad.product import Product
from pareto_monoped.geometry.roles import Role

STEPS = 8
"""Positions within one tooth."""


def check(product: Product) -> Check:
    """Look at the gears of both actuators."""
    return deepest(GEAR_MESH, f"sun, planets and ring in {STEPS} steps of one tooth", in_gear_cycle(product))


def in_gear_cycle(product: Product) -> list[Overlap]:
    """Overlaps of sun, planets and ring of both actuators while the sun turns by one tooth."""
    found: list[Overlap] = []
    for name, actuator in (("hip_actuator", product.robot.hip), ("knee_actuator", product.robot.knee)):
        if name == "knee_actuator" and actuator is product.robot.hip:
            break
        bodies = {instance.name: unique.mesh.body for instance, unique in product.placed() if instance.unit == name}
        step = 2.0 * np.pi / (float(actuator.gears.sun_teeth) * actuator.ratio * STEPS)
        for k in range(STEPS):
            pose = Pose(hip_rad=k * step, knee_rad=k * step)
            meshing = [
                PlacedMesh.of(i.name, bodies[i.name], i.moves)
                for i in instances(product.robot, pose, only=name)
                if i.part.role is Role.GEAR
            ]
            for one, other in near(meshing):
                found += overlap_of(one, other, f"in step {k} of the gears' cycle")
    return found

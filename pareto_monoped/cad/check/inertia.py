"""Every body has the inertia tensor of the simulated one."""

from collections.abc import Iterator, Mapping

import numpy as np

from pareto_monoped.cad.check.limits import INERTIA
from pareto_monoped.cad.check.result import Check, Finding, worst_of
from pareto_monoped.geometry.parts import MassProperties
from pareto_monoped.robot.frames import BODIES
from pareto_monoped.robot.population import RobotArrays


def check(bodies: Mapping[str, MassProperties], arrays: RobotArrays) -> Iterator[Check]:
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

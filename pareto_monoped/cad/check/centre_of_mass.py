"""Every body has its centre of mass where the simulated one has it."""

from collections.abc import Iterator, Mapping

import numpy as np

from pareto_monoped.cad.check.limits import CENTRE_OF_MASS
from pareto_monoped.cad.check.result import Check, Finding, worst_of
from pareto_monoped.geometry.parts import MassProperties
from pareto_monoped.robot.frames import BODIES
from pareto_monoped.robot.population import RobotArrays


def check(bodies: Mapping[str, MassProperties], arrays: RobotArrays) -> Iterator[Check]:
    """Compare the centre of mass of every body with the simulated one, by their distance."""
    for k, body in enumerate(BODIES):
        cad_mm, simulated_mm = 1e3 * bodies[body].com_m, 1e3 * arrays.body_com_m[0, k]
        distance_mm = float(np.linalg.norm(cad_mm - simulated_mm))
        text = f"{body}: centre of mass {distance_mm:.2f} mm off what was simulated"
        at = ", ".join(f"{value:.1f}" for value in cad_mm)
        yield worst_of(CENTRE_OF_MASS.of(body), f"({at}) mm", [Finding(value=distance_mm, text=text)])

"""An algorithm of pymoo on objectives and constraints of one's own."""

from pymoo.algorithms.moo.nsga2 import NSGA2
from pymoo.optimize import minimize

import pareto_monoped as pm

study = pm.Study.define(name="gentle", evaluations=1000)  # the budget is pymoo's here


def landing_speed(jumps):
    """Speed of the falling robot, from the free fall of its foot."""
    return (2.0 * 9.81 * jumps["foot_clearance_m"]) ** 0.5


def drift_within_reach(jumps):
    """The foot must not slide by more than a tenth of the leg."""
    return abs(jumps["drift_m"]) - 0.1 * (jumps["thigh_length_m"] + jumps["shank_length_m"])


problem = pm.MonopedProblem(study, objectives=[landing_speed], constraints=[drift_within_reach])
result = minimize(problem, NSGA2(pop_size=40), ("n_gen", 8), seed=1)
found = problem.decode(result.X)
for row in found["height_m"].argsort()[-3:]:
    print(f"{found['height_m'][row]:.3f} m, {found['energy_j'][row]:.1f} J, {landing_speed(found)[row]:.2f} m/s")

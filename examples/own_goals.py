"""Objectives and constraints of one's own in a stored study, which goes on with them."""

import pareto_monoped as pm


def load_factor(jumps):
    """Largest force on the foot over the robot's weight; less is better."""
    return jumps["peak_foot_force_n"] / (9.81 * jumps["mass_kg"])


def slides(jumps):
    """The base must not drift sideways by more than a third of the thigh; holds at <= 0."""
    return jumps["drift_m"] - jumps["thigh_length_m"] / 3.0


study = pm.Study.define(name="gentle", evaluations=160, audit=False)
pm.run(study, "gentle.db", objectives=["height_m", load_factor], constraints=[{"mass_kg": {"max": 5.2}}, slides])
stored = pm.resume("gentle.db", evaluations=240, functions=[load_factor, slides])
print(stored.front()[["height_m", "own_load_factor", "own_slides", "mass_kg"]].round(3).to_string(index=False))
print(stored.pick(at_most={"own_load_factor": 2.5}).why)

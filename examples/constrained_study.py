"""Search with a limit of mass, pick a design, and vary one variable around it."""

import numpy as np

import pareto_monoped as pm

study = pm.Study.define(name="light", motor="VT8020", evaluations=400)
stored = pm.run(
    study,
    "light.db",
    objectives=["height_m", "electrical_energy_j"],
    constraints={"mass_kg": {"max": 4.5}},
    callback=lambda progress: print(f"{progress.evaluations} jumps, {progress.hypervolume:.1f}"),
)
picked = stored.pick(min_height_m=0.8)
print(picked.why)

stiffness = picked.design.stiffness_n_per_m * np.linspace(0.9, 1.1, 11)
varied = stored.simulate([picked.design.replace({"stiffness_n_per_m": k}) for k in stiffness])
print(varied[["stiffness_n_per_m", "height_m", "electrical_energy_j"]].round(3).to_string(index=False))

pm.plot_front(stored, x="electrical_energy_j", y="height_m").write_html("front.html")

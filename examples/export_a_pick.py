"""From a search to files to build from, and the page that shows it."""

import pareto_monoped as pm

stored = pm.run(pm.Study.define(name="built", evaluations=400), "built.db")
picked = stored.pick("knee")
print(picked.why)
for other in stored.alternatives(picked.trial, count=2, tolerance=0.1):
    print(f"or trial {other.trial}: {other.text()}")

record = pm.export_trial(stored, picked, "built_leg", formats=["step", "mjcf", "urdf"])
print(f"{len(record['files'])} files, {record['mass_kg']:.2f} kg")
pm.write_report("built.db", "built.html")

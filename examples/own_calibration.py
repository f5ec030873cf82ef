"""A jump model of one's own: the reference on a slippery floor, for one jump and for a study."""

from dataclasses import replace

import pareto_monoped as pm

known = pm.load_calibration("reference")
wet = replace(known, name="wet_floor", contact=replace(known.contact, friction=0.3))
for calibration in (known, wet):
    jump = pm.simulate(pm.PAPER_CASES["C"].design, calibration=calibration).iloc[0]
    print(f"{calibration.name}: {jump.height_m:.3f} m, drift {1000 * jump.drift_m:.0f} mm")

# The study stores every value of the calibration, so it goes on from its database alone.
stored = pm.run(pm.Study.define(name="wet", evaluations=120), "wet.db", calibration=wet)
stored = pm.resume("wet.db", evaluations=160)
print(stored.pick("knee").why)

"""A motor of one's own: its lightest gearboxes, and what a leg with it can do."""

from dataclasses import replace

import pareto_monoped as pm

# The U8 with copper that fills its slots better: a fifth less resistance, all else the same.
known = pm.load_motor("U8")
ours = replace(known, name="U8 filled", winding_resistance_ohm=0.8 * known.winding_resistance_ohm)
for ratio in (4.0, 6.0, 8.0):
    actuator = pm.actuator_map(ours).lookup(ratio)
    print(f"{actuator.ratio:.2f}:1  {1000 * actuator.mass_kg:.0f} g  {actuator.family}")

design = pm.PAPER_CASES["C"].design
for motor in (known, ours):
    jump = pm.simulate(design, motor=motor).iloc[0]
    print(f"{motor.name}: {jump.height_m:.3f} m on {jump.electrical_energy_j:.1f} J at the battery")

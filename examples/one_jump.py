"""One design: its gearboxes, its mass, its jump."""

import pareto_monoped as pm

design = pm.PAPER_CASES["C"].design.replace({"thigh_length_m": 0.45, "shank_length_m": 0.40})
robot = pm.build_robot(design)
print(f"mass {robot.mass_kg:.2f} kg, gears {robot.hip.ratio:.2f} (hip) and {robot.knee.ratio:.2f} (knee)")

jump = pm.simulate(design).iloc[0]
print(f"{jump.height_m:.3f} m on {jump.energy_j:.1f} J, {jump.electrical_energy_j:.1f} J at the battery")

pm.plot_jump(pm.trace(design), backend="matplotlib").savefig("jump.png", dpi=150)

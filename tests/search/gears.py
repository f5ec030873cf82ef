"""What the gearboxes of made-up lists have in common."""

ALIKE = {"efficiency": 0.97, "reflected_inertia_kg_m2": 0.01}

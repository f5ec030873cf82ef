"""The folder ``test_stand/`` of an export: the arms that hang the base on two vertical rails."""

from pareto_monoped.cad.write.dxf import dxf
from pareto_monoped.leg.dimensions import LegDimensions
from pareto_monoped.leg.stand import MGN12H, arm, carriage_places, carriage_screw, rod_screws


def stand_files(d: LegDimensions) -> dict[str, str]:
    """Content by path in the export's folder: the arm for the laser, and how it is used."""
    return {
        "test_stand/arm.dxf": dxf(arm(d)),
        "test_stand/README.md": _readme(d),
    }


def _readme(d: LegDimensions) -> str:
    part = arm(d)
    (x, low, _), (_, high, _) = carriage_places(d)
    screws = "\n".join(f"| {count} | {which} | {where} |" for where, count, which in rod_screws(d))
    return f"""# Test stand

Two arms hang the base on two vertical rails, which keep it upright as the simulation does. Each weighs
{1e3 * float(part.unit_mass_kg()):.0f} g without its carriages. The simulation counts neither arms nor carriages, which
the robot has to lift as well.

| number | part | where |
|---:|---|---|
| 2 | `arm.dxf`: {part.note}, {part.grade.name if part.grade else ""} | outside of either cheek |
| 4 | carriage {MGN12H.name} (HIWIN, series MGN) | two on the outside of each arm |
| 2 | rail {MGN12H.name.removesuffix("H")}, as long as the jump and {high - low + MGN12H.length_mm:.0f} mm | vertical |
| 16 | {carriage_screw()} | through the arms into the carriages |
{screws}

1. Take out the screws of the rear lower rod and of both upper rods, on both sides. The base stays together by its front
   lower rod.
2. Lay an arm on each cheek, its long end backwards, and the driver's plate on the arm again. Put the screws above in.
3. Screw the carriages to the outsides of the arms. Their middles are {-x:.1f} mm behind the hip's axis, {low:.1f} and
   {high:.1f} mm above it.
4. Let the rails end above the hip's axis in the robot's lowest position: the foot swings through the planes of the
   rails.
"""

"""The ball bearing that carries both ends of the knee's axle and the knee actuator's free end."""

from dataclasses import replace

from pareto_monoped.geometry.parts import Part, Prism
from pareto_monoped.geometry.roles import Role
from pareto_monoped.geometry.shapes import Circle, Numbers
from pareto_monoped.leg.dimensions import LegDimensions
from pareto_monoped.leg.sandwich import Place
from pareto_monoped.materials import MATERIALS

# Our own layout, mm.
LIP = 2.0  # height of a seat's lip, which holds the outer ring only
SHOULDER_RADIUS = 11.8  # of an axle's shoulder, which touches the inner ring only


def bearing_part(
    name: str, d: LegDimensions, *, z0_mm: Numbers = 0.0, places_mm: tuple[Place, ...] | None = None
) -> Part:
    """A bearing from ``z0_mm`` on along z, or one at each place."""
    part = Part(
        name=name,
        role=Role.BEARING,
        material=MATERIALS.steel,
        process="bought",
        prisms=(
            Prism(
                outline=Circle(radius_mm=d.bearing_outer_radius_mm),
                z0_mm=z0_mm,
                z1_mm=z0_mm + d.bearing_width_mm,
                holes=(Circle(radius_mm=d.bearing_bore_radius_mm),),
            ),
        ),
        catalogue_mass_kg=d.bearing_kg,
        note=f"6804, {2.0 * d.bearing_bore_radius_mm:g} x {2.0 * d.bearing_outer_radius_mm:g} x "
        f"{d.bearing_width_mm:g} mm (ISO 15)",
    )
    return part if places_mm is None else replace(part, places_mm=places_mm)

"""The encoder at the back of an actuator: a magnet in the end of the motor's shaft, and a sensor in the backplate.

The sensor is RLS's RM08 (data sheet RM08D01): a sealed body of 8 mm diameter and 7 mm length, which reads a magnet of
4 x 4 mm, magnetised across, over a gap of 1 mm within 0.5 mm. 12 bit per turn of the motor, up to 30,000 rpm. It is
bonded into a cap, which is bonded into the backplate's bore once the gap is set.

Both joints have the same actuator. At the knee, sensor and cable stand in the journal's bore.
"""

import numpy as np

from pareto_monoped.actuator.features import slab, tube
from pareto_monoped.geometry.parts import Part, Prism
from pareto_monoped.geometry.roles import Group, Joint, JointKind, Role, Visibility
from pareto_monoped.geometry.shapes import Numbers
from pareto_monoped.materials import ALLOYS, MATERIALS

BODY_RADIUS_MM, _BODY_MM = 4.0, 7.0
MAGNET_RADIUS_MM, MAGNET_MM = 2.0, 4.0
_GAP_MM = 1.0
_BODY_KG = 0.002
"""Body and 0.3 m of its cable; our own estimate, the data sheet gives none."""
_CAP_MM = 1.5
"""Thickness of the cap: 0.5 mm from the inner ring of an ISSPG's rear bearing; our own choice."""


def encoder_parts(z_shaft_mm: Numbers, z_back_mm: Numbers, bore_mm: Numbers, shaft: str) -> tuple[Part, ...]:
    """Magnet, sensor and cap.

    Args:
        z_shaft_mm: height of the rear end of the motor's shaft, float or shape (n,).
        z_back_mm: height of the backplate's outer face, likewise.
        bore_mm: radius of the backplate's central bore, likewise.
        shaft: name of the part whose end takes the magnet, see ``shaft_end``.
    """
    z_sensor = z_shaft_mm - _GAP_MM
    return (
        Part(
            name="encoder_magnet",
            role=Role.ELECTRONICS,
            visibility=Visibility.INSIDE,
            material=MATERIALS.magnet,
            prisms=slab(z_shaft_mm, z_shaft_mm + MAGNET_MM, MAGNET_RADIUS_MM),
            process="bought",
            group=Group.ROTOR,
            note="4 x 4 mm, magnetised across its axis",
            joint=Joint(kind=JointKind.BONDED, how="bonded into", partner=shaft),
        ),
        Part(
            name="encoder",
            role=Role.ELECTRONICS,
            visibility=Visibility.DETAIL,
            material=MATERIALS.electronics,
            prisms=slab(z_sensor - _BODY_MM, z_sensor, BODY_RADIUS_MM),
            process="bought",
            group=Group.HOUSING,
            catalogue_mass_kg=_BODY_KG,
            note=f"RM08 (RLS), 12 bit; {_GAP_MM:g} mm from the magnet, within 0.5 mm",
            joint=Joint(kind=JointKind.BONDED, how="bonded into", partner="encoder_cap"),
        ),
        Part(
            name="encoder_cap",
            role=Role.HOUSING,
            visibility=Visibility.INSIDE,
            material=MATERIALS.aluminium,
            prisms=tube(z_back_mm, z_back_mm + _CAP_MM, bore_mm, BODY_RADIUS_MM),
            process="machined",
            group=Group.HOUSING,
            grade=ALLOYS["aw_6082_t6"],
            note="flush with the backplate",
            joint=Joint(kind=JointKind.BONDED, how="bonded into", partner="backplate"),
        ),
    )


def shaft_end(z0_mm: Numbers, z1_mm: Numbers, radius_mm: Numbers) -> tuple[Prism, ...]:
    """A shaft whose lower end at ``z0_mm`` has a bore for the magnet."""
    split = np.minimum(z0_mm + MAGNET_MM, z1_mm)[()]
    return (*tube(z0_mm, split, radius_mm, MAGNET_RADIUS_MM), *slab(split, z1_mm, radius_mm))

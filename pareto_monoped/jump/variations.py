"""Robots that differ from what was designed: how each of many jumps departs from its nominal robot.

A robot that was built has other masses, motors and springs than its model. Its controller does not know them: the term
m g of the virtual leg keeps the nominal mass. Its links are measured, so the controller knows their true lengths. It
starts in the balanced pose of its true masses and lengths, on a foot that is compressed as nominal.
"""

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.design import CONTROL, PAPER_CONTROL, Floats
from pareto_monoped.jump.calibration import Calibration
from pareto_monoped.jump.controller_record import KNEE, TRACKING
from pareto_monoped.jump.end_stops import bumper_damping_s_per_m, damping_s_per_m
from pareto_monoped.jump.model import FOOT_GEOM, coordinates, joint_places, motor_places
from pareto_monoped.robot.population import JointStops, RobotArrays
from pareto_monoped.robot.units import BODIES, JOINTS

if TYPE_CHECKING:
    from _typeshed import DataclassInstance


@dataclass(frozen=True, slots=True, kw_only=True)
class Variations:
    """How n robots depart from their design. Factors of 1, lengths and delays of 0 leave a jump as it is to the bit."""

    masses: Floats  #: factors on mass and inertia of the bodies, shape (n, 3), in the order of ``BODIES``
    peak_torques: Floats  #: factors on the motors' peak torque, shape (n, 2)
    no_load_speeds: Floats  #: factors on the no-load speed of both motors, which goes with the voltage, shape (n,)
    #: friction, damping: factors on Coulomb and viscous friction of both joints, shape (n,)
    friction: Floats
    damping: Floats
    #: stop_stiffness, foot_stiffness: factors on the stiffness of the end stops and of the foot, shape (n,)
    stop_stiffness: Floats
    foot_stiffness: Floats
    link_lengths_m: Floats  #: added to thigh and shank, shape (n, 2)
    gains: Floats  #: factors on K, C and T, shape (n, 3)
    delays_s: Floats  #: added to the delay of the calibration, in which they count as whole control periods, shape (n,)
    #: gear_loss, chain_loss: factors on what both gearboxes and the chain lose, shape (n,)
    gear_loss: Floats
    chain_loss: Floats
    winding_resistance: Floats  #: factors, shape (n,)
    rotor_inertia: Floats  #: factors on that of what turns at the motors' speed, shape (n,)
    rebound: Floats  #: factors on the share of an impact's energy that the bumpers give back, shape (n,)
    #: stand_mass, rail_friction: factors on what the base lifts on a stand and on the friction of its rails, shape (n,)
    stand_mass: Floats
    rail_friction: Floats

    def __len__(self) -> int:
        return len(self.masses)


def unvaried(n: int) -> Variations:
    """Return variations that leave n jumps as they are."""
    shapes = {"masses": (len(BODIES),), "peak_torques": (2,), "link_lengths_m": (2,), "gains": (len(PAPER_CONTROL),)}
    names = [field.name for field in fields(Variations)]
    added = ("link_lengths_m", "delays_s")
    return Variations(**{name: np.full((n, *shapes.get(name, ())), float(name not in added)) for name in names})


def varied_robots(robots: RobotArrays, variations: Variations) -> RobotArrays:
    """Return the robots as built. Centres of mass stay, and so does the mass of a link that is a little longer."""
    knee = JOINTS.index("knee")
    more_kg_m2 = robots.rotor_inertia_kg_m2 * (variations.rotor_inertia - 1.0)[:, None]
    reflected_kg_m2 = more_kg_m2 * np.square(robots.ratio)
    less = (1.0 - variations.gear_loss)[:, None]  # of the losses, which may also be more
    return replace(
        robots,
        rotor_inertia_kg_m2=robots.rotor_inertia_kg_m2 + more_kg_m2,
        armature_kg_m2=robots.armature_kg_m2 + reflected_kg_m2,
        knee_reflected_kg_m2=robots.knee_reflected_kg_m2 + reflected_kg_m2[:, knee],
        knee_coupling_kg_m2=robots.knee_coupling_kg_m2 + more_kg_m2[:, knee] * robots.ratio[:, knee],
        rotor_excess_kg_m2=robots.rotor_excess_kg_m2 + more_kg_m2[:, knee],
        efficiency=robots.efficiency + less * (1.0 - robots.efficiency),
        efficiency_total=robots.efficiency_total + less * (1.0 - robots.efficiency_total),
        winding_resistance_ohm=robots.winding_resistance_ohm * variations.winding_resistance[:, None],
        body_mass_kg=robots.body_mass_kg * variations.masses,
        body_inertia_kg_m2=robots.body_inertia_kg_m2 * variations.masses[:, :, None, None],
        peak_torque_n_m=robots.peak_torque_n_m * variations.peak_torques,
        no_load_speed_rad_per_s=robots.no_load_speed_rad_per_s * variations.no_load_speeds[:, None],
        thigh_length_m=robots.thigh_length_m + variations.link_lengths_m[:, 0],
        shank_length_m=robots.shank_length_m + variations.link_lengths_m[:, 1],
        stand_mass_kg=robots.stand_mass_kg * variations.stand_mass,
    )


def varied_control(control: Floats, variations: Variations) -> Floats:
    """Return the gains as they act, shape (n, 6), in the order of ``CONTROL``."""
    varied = control.copy()
    varied[:, [CONTROL.index(name) for name in PAPER_CONTROL]] *= variations.gains
    return varied


def vary_records(records: Any, stops: JointStops, calibration: Calibration, variations: Variations) -> None:
    """Change the controller's records of varied robots: delay, friction, bumpers, chain, and the mass that it knows."""
    true = records["body_mass_kg"]
    known = true / variations.masses
    if calibration.controller.weight == "robot":
        records["weight_n"] *= known.sum(axis=1) / true.sum(axis=1)
    else:
        records["weight_n"] *= known[:, BODIES.index("base")] / true[:, BODIES.index("base")]
    # The damper of the tracking law acts by the knee's motor, as its knots do.
    records["damping_n_s_per_m"] *= np.where(records["law"] == TRACKING, variations.peak_torques[:, KNEE], 1.0)
    records["joint_damping_n_m_s_per_rad"] *= variations.damping[:, None]
    records["rail_friction_n"] *= variations.rail_friction
    records["bumper_n_m"] *= variations.stop_stiffness[:, None]
    chain = calibration.drive.chain_efficiency
    records["loss"][:, KNEE] += (1.0 - records["loss"][:, KNEE]) * (variations.chain_loss - 1.0) * (1.0 - chain) / chain
    for k, joint in enumerate(JOINTS):
        rebound = getattr(stops, joint).bumper.elastomer.rebound_resilience
        changed = damping_s_per_m(rebound * variations.rebound) / bumper_damping_s_per_m(rebound)
        records["bumper_s_per_rad"][:, k] *= changed
    records["delay_periods"] += np.round(variations.delays_s / calibration.simulation.period_s)


def vary_fields(batch: Any, calibration: Calibration, variations: Variations) -> None:
    """Change the friction and the springs of a batch of simulations, after ``prepare`` has set them.

    The springs are MuJoCo's ``solref`` with negative numbers, which are stiffness and damping times a constant.
    """
    motors, slide_z = motor_places(calibration), coordinates(calibration).index("slide_z")
    batch.expand("dof_damping")[:, motors] *= variations.damping[:, None]
    batch.expand("dof_frictionloss")[:, motors] *= variations.friction[:, None]
    batch.expand("dof_frictionloss")[:, slide_z] *= variations.rail_friction
    springs = [(batch.expand("geom_solref")[:, FOOT_GEOM], variations.foot_stiffness)]
    limits = batch.expand("jnt_solref")
    springs += [(limits[:, place], variations.stop_stiffness) for place in joint_places(calibration)]
    for solref, factors in springs:
        solref[:, 0] *= np.where(solref[:, 0] < 0.0, factors, 1.0)


T = TypeVar("T", bound="DataclassInstance")


def take(record: T, rows: NDArray[np.intp]) -> T:
    """Return a copy of a frozen dataclass with some rows of every array and tuple, in this order; the rest stays."""
    kept: dict[str, Any] = {}
    for field in fields(record):
        values = getattr(record, field.name)
        if isinstance(values, tuple):
            kept[field.name] = tuple(values[i] for i in rows)
        elif isinstance(values, np.ndarray):
            kept[field.name] = values[rows]
    return replace(record, **kept)


def joined(records: Sequence[T]) -> T:
    """Return one record with the rows of all, see ``take``; everything else must be the same in all of them."""
    if len(records) == 1:
        return records[0]
    together: dict[str, Any] = {}
    for field in fields(records[0]):
        parts = [getattr(record, field.name) for record in records]
        if isinstance(parts[0], tuple):
            together[field.name] = tuple(item for part in parts for item in part)
        elif isinstance(parts[0], np.ndarray):
            together[field.name] = np.concatenate(parts)
    return replace(records[0], **together)

"""The cables between motors and drivers: where they run, how long they are cut, where ties hold them.

Each driver's cables come up behind its board, between board and plate, and a tie holds them at the plate's upper side.
The hip's come from the back of its actuator, which does not move. The knee's encoder cable comes through the journal's
bore, on the hip's axis. The knee's motor leaves its back below the far cheek and bends to that axis beyond the cheek:
there the thigh's swing only twists it. Both are drawn with the thigh hanging down.

The wires of the motors are counted in no mass: where a motor's own leads end is not known. 0.3 m of each encoder's
cable is counted with the encoder (``actuator.encoder``).
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.actuator.actuator import Actuator
from pareto_monoped.cad.assembly import unit_frame
from pareto_monoped.geometry.parts import Part
from pareto_monoped.geometry.roles import Group, Role
from pareto_monoped.geometry.shapes import Circle, Pattern
from pareto_monoped.leg.actuator_fit import MotorDriver, peak_current_a
from pareto_monoped.leg.electronics import BoardPlace, board_place
from pareto_monoped.leg.journal import far_cheek_z_mm
from pareto_monoped.robot.build import Robot, Unit

Points = NDArray[np.float64]

TIE, TIE_DESIGNATION = "tie", "cable tie 2.5 x 100 mm"  #: What is at the corner with a tie, and what is bought for it.
_WIRES = ((1.0, 2.5), (1.5, 2.8), (2.5, 3.4), (4.0, 4.2), (6.0, 5.2))
"""Copper in mm2 and outer diameter in mm of fine-stranded wires with silicone insulation, type SiF (makers' data)."""
_CURRENT_A_PER_MM2 = 32.0
"""Effective value at the motor's peak torque: it warms copper by 5 K per second, and a jump takes less than one second.
Our own choice."""
_BENDS = 4.0
"""Least bend radius over diameter of wires that do not move (makers' data of SiF); less where no more room is."""
_ENCODER_MM, ENCODER_CABLE_M = 3.0, 0.3
"""Diameter of the encoder's cable, our own estimate, and its length as counted with the encoder."""
_PLAY_MM = 0.5  # between a cable and what it passes
_TAILS_MM = (80.0, 60.0)
"""What is cut longer: to the windings inside the motor, and from the board's edge to its terminals; our own choice."""
_ROUND_MM = 10.0  # cut lengths are rounded up to this
_COPPER_G_PER_MM3, _SILICONE_G_PER_MM3 = 8.96e-3, 1.2e-3
_CURE = "take one that its maker allows to bend so"


_Run = tuple[float, float, Sequence[Points | Sequence[float]], Sequence[str], str]
"""Diameter, bend radius, corners in the base's frame, what is at each of them, up to the tie, and a cure."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Cable:
    """One cable, or the three wires of a motor, which run side by side."""

    name: str  #: such as ``hip_motor``
    start: str  #: what it joins, in words
    end: str
    wires: int  #: how many are cut
    designation: str  #: what is bought
    diameter_mm: float  #: of one wire
    bend_radius_mm: float  #: of its middle line at every corner
    points_mm: Points  #: corners in the assembly's frame, shape (n, 3), with the thigh hanging down
    notes: tuple[str, ...]  #: what is at each corner
    tails_mm: tuple[float, float]  #: what is added at both ends
    mass_g: float  #: of all wires; counted in no body's mass. 0 where it is counted.
    cure: str = _CURE  #: what helps if it bends more tightly than its maker allows

    @property
    def least_bend_radius_mm(self) -> float:
        """What the maker allows."""
        return _BENDS * self.diameter_mm

    @property
    def warning(self) -> str:
        """That it bends more tightly than its maker allows, for want of room, and what helps; '' if it does not."""
        if self.bend_radius_mm >= self.least_bend_radius_mm * (1.0 - 1e-9):
            return ""
        return (
            f"{self.name.replace('_', ' ')} cable: bend radius = {self.bend_radius_mm:.1f} mm, "
            f"{self.bend_radius_mm / self.diameter_mm:.2f} diameters: must be at least "
            f"{self.least_bend_radius_mm:.1f} mm, {_BENDS:g} diameters; {self.cure}"
        )

    @property
    def length_mm(self) -> float:
        """Along the middle line, its corners rounded."""
        return rounded_length_mm(self.points_mm, self.bend_radius_mm)

    @property
    def cut_mm(self) -> float:
        """To cut each wire to."""
        return float(np.ceil((self.length_mm + sum(self.tails_mm)) / _ROUND_MM) * _ROUND_MM)


def rounded(points_mm: Points, radius_mm: float) -> Points:
    """Return a line with its corners as arcs of 16 straight pieces, shape (m, n)."""
    line = [points_mm[0]]
    for before, corner, after in zip(points_mm, points_mm[1:], points_mm[2:], strict=False):
        back, onward = ((end - corner) / np.linalg.norm(end - corner) for end in (before, after))
        half = 0.5 * float(np.arccos(np.clip(-back @ onward, -1.0, 1.0)))
        if half < 1e-6:
            line.append(corner)
            continue
        middle = back + onward
        middle /= np.linalg.norm(middle)
        centre = corner + radius_mm / np.cos(half) * middle
        across = (onward - back) / np.linalg.norm(onward - back)
        line += [
            centre + radius_mm * (np.sin(angle) * across - np.cos(angle) * middle)
            for angle in np.linspace(-half, half, 17)
        ]
    return np.array([*line, points_mm[-1]])


def rounded_length_mm(points_mm: Points, radius_mm: float) -> float:
    """Return the length of straight pieces with arcs as corners: each saves 2 R tan(t / 2) - R t for a turn by t."""
    steps = np.diff(points_mm, axis=0)
    lengths = np.linalg.norm(steps, axis=1)
    ways = steps / lengths[:, None]
    turns = [float(np.arccos(np.clip(one @ other, -1.0, 1.0))) for one, other in pairwise(ways)]
    return float(lengths.sum() - sum(2.0 * radius_mm * np.tan(0.5 * turn) - radius_mm * turn for turn in turns))


def cables(robot: Robot) -> tuple[Cable, ...]:
    """Return the four cables of a robot: motor and encoder of hip and knee."""
    leg, units = robot.leg, {unit.name: unit for unit in robot.units}
    base = next(unit for unit in robot.units if any(part.role is Role.ROD for part in unit.parts))
    far_mm = float(far_cheek_z_mm(1e-3 * robot.knee.length_mm, leg)) + leg.far_cheek_mm
    hip = _hip(robot.hip, units["hip_actuator"], board_place("hip", leg.hip_mount_mm, -1.0, leg), base, robot)
    knee = _knee(robot.knee, units["knee_actuator"], board_place("knee", far_mm, 1.0, leg), base, robot)
    return (*hip, *knee)


def _hip(actuator: Actuator, unit: Unit, board: BoardPlace, base: Unit, robot: Robot) -> tuple[Cable, Cable]:
    """Return cables over the back, along the outside of the casing below the board, and up behind it."""
    wire, wire_mm = _wire(actuator, robot.leg.of("hip").driver)
    back = float(_in_base(unit, np.array([0.0, 0.0, -actuator.length_mm]))[2])
    rim = _width_mm(_backplate(actuator))
    found: list[_Run] = []
    for diameter, side, start in (
        (wire_mm, 1.0, _hole(actuator, unit, np.array([1.0, 0.0]))),
        (_ENCODER_MM, -1.0, np.array([0.0, 0.0, _sensor_mm(actuator, unit)])),
    ):
        x, (under, behind) = side * board.tie_x_mm, _around(board, rim, diameter)
        radius = min(_BENDS * diameter, _radius_below(board, under, behind, diameter))
        out = min(back, float(start[2])) - radius - 0.5 * diameter
        found.append(
            (
                diameter,
                radius,
                [start, [start[0], start[1], out], [x, under, out], [x, under, behind], *_up(board, x, behind)],
                ["leaves the actuator", "turns up", "turns along the casing", "turns up behind the board"],
                _thinner(board, rim, wire) if side > 0.0 else _CURE,
            )
        )
    return _named("hip", found, actuator, base, robot)


def _knee(actuator: Actuator, unit: Unit, board: BoardPlace, base: Unit, robot: Robot) -> tuple[Cable, Cable]:
    """Return cables outwards past the far cheek, on the hip's axis, and up behind the board."""
    wire_mm = _wire(actuator, robot.leg.of("knee").driver)[1]
    hole = _hole(actuator, unit, np.array([0.0, -1.0]))
    motor = board.behind_mm(0.5 * wire_mm + _PLAY_MM)
    encoder = board.behind_mm(0.5 * _ENCODER_MM + _PLAY_MM)
    x = board.tie_x_mm
    found: list[_Run] = [
        (
            wire_mm,
            _BENDS * wire_mm,
            [hole, [hole[0], hole[1], motor], [x, 0.0, motor], *_up(board, x, motor)],
            ["leaves the actuator", "turns to the hip's axis", "beside the axis: the swing twists it below here"],
            _CURE,
        ),
        (
            _ENCODER_MM,
            _BENDS * _ENCODER_MM,
            [
                np.array([0.0, 0.0, _sensor_mm(actuator, unit)]),
                [0.0, 0.0, encoder],
                [-x, board.low_mm, encoder],
                *_up(board, -x, encoder),
            ],
            ["leaves the encoder", "turns up beyond the journal", "goes behind the board"],
            _CURE,
        ),
    ]
    return _named("knee", found, actuator, base, robot)


def _up(board: BoardPlace, x: float, z: float) -> list[list[float]]:
    return [[x, board.tie_y_mm, z], [x, board.high_mm, z]]


def _named(joint: str, found: Sequence[_Run], actuator: Actuator, base: Unit, robot: Robot) -> tuple[Cable, Cable]:
    """Return the cables of a joint's motor and encoder, with their corners in the assembly's frame."""
    frame = unit_frame(base)
    area, diameter = _wire(actuator, robot.leg.of(joint).driver)
    section = 0.25 * np.pi * diameter**2
    made = []
    for what, (one_mm, radius, corners, notes, cure) in zip(("motor", "encoder"), found, strict=True):
        points = np.array([np.asarray(corner, dtype=np.float64) for corner in corners])
        motor = what == "motor"
        cable = Cable(
            name=f"{joint}_{what}",
            start=f"{joint} motor {actuator.motor.name}" if motor else f"{joint} encoder",
            end=f"{joint} driver {robot.leg.of(joint).driver.name}",
            wires=3 if motor else 1,
            designation=f"wire SiF {area:g} mm2, fine-stranded" if motor else "cable that comes with the encoder",
            diameter_mm=one_mm,
            bend_radius_mm=radius,
            points_mm=points @ frame[:3, :3].T + frame[:3, 3],
            notes=(*notes, TIE, "the board's upper edge"),
            tails_mm=_TAILS_MM if motor else (0.0, _TAILS_MM[1]),
            mass_g=0.0,
            cure=cure,
        )
        grams_per_mm = area * _COPPER_G_PER_MM3 + (section - area) * _SILICONE_G_PER_MM3
        made.append(replace(cable, mass_g=3.0 * grams_per_mm * cable.cut_mm) if motor else cable)
    return made[0], made[1]


def _wire(actuator: Actuator, driver: MotorDriver) -> tuple[float, float]:
    """Return copper and diameter of the thinnest wire for the largest current that motor and driver let flow."""
    amplitude = min(peak_current_a(actuator.motor), driver.peak_current_a)
    needed = amplitude / np.sqrt(2.0) / _CURRENT_A_PER_MM2
    return next((wire for wire in _WIRES if wire[0] >= needed), _WIRES[-1])


def _thinner(board: BoardPlace, rim: float, area_mm2: float) -> str:
    """Return the cure for a wire without room for its bend: thinner ones that have, with as much copper."""
    for area, diameter in reversed([wire for wire in _WIRES if wire[0] < area_mm2]):
        if _radius_below(board, *_around(board, rim, diameter), diameter) >= _BENDS * diameter:
            count = int(np.ceil(area_mm2 / area))
            return f"lay {count} wires of {area:g} mm2 in parallel, or {_CURE}"
    return _CURE


def _around(board: BoardPlace, rim: float, diameter: float) -> tuple[float, float]:
    """Return the height of a wire along the outside of the casing, and its distance behind the board."""
    under = float(np.sqrt(rim**2 - board.tie_x_mm**2)) + 0.5 * diameter + _PLAY_MM
    return under, board.behind_mm(0.5 * diameter + _PLAY_MM)


def _backplate(actuator: Actuator) -> Part:
    parts = [part for part in actuator.parts if part.role is Role.HOUSING and part.group is Group.HOUSING]
    return min(parts, key=lambda part: (min(float(p.z0_mm) for p in part.prisms), -_width_mm(part)))


def _width_mm(part: Part) -> float:
    return max(float(p.outline.radius_mm) for p in part.prisms if isinstance(p.outline, Circle))


def _in_base(unit: Unit, point: Points) -> Points:
    """Return a point of a unit in the base's frame, with the leg hanging down."""
    return np.asarray(unit.turn @ point + np.array([0.0, 0.0, unit.z_mm]))


def _hole(actuator: Actuator, unit: Unit, way: Points) -> Points:
    """Return the middle of the hole in the back through which a motor's wires leave: the widest in a direction."""
    patterns = [h for p in _backplate(actuator).prisms for h in p.holes if isinstance(h, Pattern)]
    widest = max(patterns, key=lambda pattern: float(pattern.radius_mm))
    centres = [_in_base(unit, np.array([x, y, -actuator.length_mm])) for x, y in widest.centres_mm()]
    return max(centres, key=lambda centre: float(centre[:2] @ way))


def _sensor_mm(actuator: Actuator, unit: Unit) -> float:
    """Return the height z of the encoder's outer end in the base's frame."""
    (sensor,) = (p for p in actuator.parts if p.role is Role.ELECTRONICS and p.group is Group.HOUSING)
    end = min(float(prism.z0_mm) for prism in sensor.prisms)
    return float(_in_base(unit, np.array([0.0, 0.0, end]))[2])


def _radius_below(board: BoardPlace, under: float, behind: float, diameter: float) -> float:
    """Return the largest bend, from along the casing to behind the board, that keeps clear of the board's lower edge.

    The bend's middle lies R above and outside of its corner, the edge by e and f. The wire's half width h is free for

        R - sqrt((R - e)^2 + (R - f)^2) >= h,   hence   R <= s + sqrt(s^2 - (e^2 + f^2 - h^2)),   s = e + f - h.
    """
    e, f, h = board.low_mm - under, abs(board.inner_mm - behind), 0.5 * diameter
    s = e + f - h
    return float(s + np.sqrt(max(s**2 - (e**2 + f**2 - h**2), 0.0)))

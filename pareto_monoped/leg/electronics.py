"""The motor drivers on the base: a plate on the outside of either cheek, under the upper rods' screws, carries a board.

Each driver stands on the side of its motor. The knee motor's cables come through the journal, on the hip axis, where
the thigh's swing only twists them. Cable ties hold them to the driver's plate; ``cad.cables`` has their paths.
"""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from pareto_monoped.geometry.parts import Part, sheet_part
from pareto_monoped.geometry.roles import Purchase, Role, Visibility
from pareto_monoped.geometry.screws import HEXAGON_FLATS_MM, M4, Screw, between, clearance, hexagon, screw_part
from pareto_monoped.geometry.shapes import Circle, Numbers, Shape, rectangle
from pareto_monoped.leg.actuator_fit import MotorDriver
from pareto_monoped.leg.dimensions import LegDimensions
from pareto_monoped.leg.sandwich import Place, holes_at, rounded
from pareto_monoped.materials import MATERIALS

DRIVER_PLATE_MM = 2.0
"""Thickness of a driver's plate, the least for a flush countersunk M3; our own choice."""
# Our own layout, mm.
_STANDOFF = 8.0  # length, as sold; above the 4 mm high heads of the rods' screws
_STANDOFF_FLATS = HEXAGON_FLATS_MM[3.0]  # as sold for M2.5 and M3
_THREAD = 4.0  # of either screw in a standoff
# Torque of its screws in N m, by thread diameter. M3: makers of spacers for boards allow 0.5 (data sheets of Wuerth
# WA-SMSR and WA-SMSE). M2.5: the same stress in the thread, hence in proportion to the diameter's cube.
_STANDOFF_N_M = {3.0: 0.5, 2.5: 0.5 * (2.5 / 3.0) ** 3}
_BOARD = 1.6  # thickness of a circuit board
_ABOVE_ROD = 6.0  # from the lower rods to the board's lower holes: the board then stays out of the foot's reach
_RIM = 5.0  # of the plate around holes
_FRAME = 5.5  # half the width of the plate's sides, around the window in it
_CORNER = 4.0  # radius of plate and window
_TIE_HOLE = 1.75  # radius: for ties of 2.5 mm
_TIES_X = (6.0, 12.0)  # of the holes for a tie in the plate's upper side
_CLEAR_OF_HOLES = 4.0  # from the board's holes to what stands on it


@dataclass(frozen=True, slots=True, kw_only=True)
class BoardPlace:
    """Where cables pass a driver's board, in the frame of the base."""

    plate_mm: float  #: height z of the plate's outer face
    inner_mm: float  #: height z of the board's face towards it
    low_mm: float  #: height y of the board's lower edge
    high_mm: float  #: of its upper edge
    tie_x_mm: float  #: middle of a pair of holes for a tie, on either side
    tie_y_mm: float

    def behind_mm(self, off_mm: float) -> float:
        """Return the height z of a cable's middle line that lies so far off the plate."""
        return self.plate_mm + float(np.sign(self.inner_mm - self.plate_mm)) * off_mm


def board_place(joint: str, face_mm: float, direction: float, d: LegDimensions) -> BoardPlace:
    """Return the place of a driver's board; see ``driver_parts``."""
    driver = d.of(joint).driver
    plate, middle = face_mm + direction * DRIVER_PLATE_MM, _lower_row_mm(d) + 0.5 * driver.hole_length_mm
    return BoardPlace(
        plate_mm=plate,
        inner_mm=plate + direction * _STANDOFF,
        low_mm=middle - 0.5 * driver.length_mm,
        high_mm=middle + 0.5 * driver.length_mm,
        tie_x_mm=0.5 * sum(_TIES_X),
        tie_y_mm=_lower_row_mm(d) + driver.hole_length_mm,
    )


def driver_parts(joint: str, face_mm: Numbers, direction: float, d: LegDimensions) -> tuple[Part, ...]:
    """Build the driver of ``joint`` on the outside of a cheek, in the base's frame; ``direction`` is outwards."""
    driver = d.of(joint).driver
    holes = _hole_places(driver, d)
    back, under = face_mm + direction * DRIVER_PLATE_MM, face_mm + direction * (DRIVER_PLATE_MM + _STANDOFF)
    over = under + direction * _BOARD
    return (
        sheet_part(
            name=f"{joint}_driver_plate",
            role=Role.BRACKET,
            prisms=(between(_plate_outline(driver, d), face_mm, back, *_plate_holes(driver, d)),),
            features=(
                clearance(
                    driver.screw,
                    holes_at(holes, driver.screw.hole),
                    np.minimum(face_mm, back)[()],
                    np.maximum(face_mm, back)[()],
                    countersunk="low" if direction > 0.0 else "high",
                ),
            ),
            note=f"{DRIVER_PLATE_MM:g} mm sheet; cable ties through the upper holes",
        ),
        _standoff_screw(
            f"{joint}_standoff_screw",
            driver.screw,
            head="countersunk",
            seat_mm=face_mm,
            grip_mm=DRIVER_PLATE_MM,
            direction=direction,
            places_mm=holes,
            note="flush, into the standoff",
        ),
        Part(
            name=f"{joint}_standoff",
            role=Role.SPACER,
            visibility=Visibility.DETAIL,
            material=MATERIALS.aluminium,
            process="bought",
            prisms=(between(hexagon(_STANDOFF_FLATS), back, under, Circle(radius_mm=driver.screw.core)),),
            places_mm=holes,
            purchases=(
                Purchase(
                    kind="standoff",
                    designation=f"hexagon standoff {driver.screw.name} x {_STANDOFF:g}, {_STANDOFF_FLATS:g} mm across "
                    "flats, aluminium, female threads from both ends",
                ),
            ),
        ),
        _board(joint, under, over, direction, d),
        _standoff_screw(
            f"{joint}_driver_screw",
            driver.screw,
            head="cap",
            seat_mm=over,
            grip_mm=_BOARD,
            direction=-direction,
            places_mm=holes,
            note="through the board into the standoff",
        ),
    )


def _standoff_screw(name: str, size: Screw, **own: Any) -> Part:
    """Build a screw in a standoff, whose thread and board bear less than it; ``own`` is as for ``screw_part``."""
    screw = screw_part(name, size, room_mm=_THREAD, **own)
    full = screw.fastening
    assert full is not None
    share = _STANDOFF_N_M[full.thread.diameter_mm] / full.torque_n_m
    # The torque is proportional to the preload.
    return replace(screw, fastening=replace(full, most_preload_n=share * full.preload_n))


def _lower_row_mm(d: LegDimensions) -> float:
    return d.lower_rod_mm[1] + _ABOVE_ROD


def _hole_places(driver: MotorDriver, d: LegDimensions) -> tuple[Place, ...]:
    x, low = 0.5 * driver.hole_width_mm, _lower_row_mm(d)
    return tuple((side * x, y, 0.0) for y in (low, low + driver.hole_length_mm) for side in (-1.0, 1.0))


def _plate_outline(driver: MotorDriver, d: LegDimensions) -> Shape:
    """Return a rectangle around the board's holes; the upper rods lie within."""
    return rounded(
        half_width_mm=max(0.5 * driver.hole_width_mm, d.upper_rod_mm[0]) + _RIM,
        high_mm=_lower_row_mm(d) + driver.hole_length_mm + _RIM,
        low_mm=_lower_row_mm(d) - _RIM,
        corner_mm=_CORNER,
    )


def _plate_holes(driver: MotorDriver, d: LegDimensions) -> tuple[Shape, ...]:
    """Return the holes for screws of rods and standoffs and for cable ties, and the window that saves weight."""
    rod_x, rod_y = d.upper_rod_mm
    low, high = _lower_row_mm(d), _lower_row_mm(d) + driver.hole_length_mm
    ties = tuple((side * x, high, 0.0) for x in _TIES_X for side in (-1.0, 1.0))
    window = rounded(
        half_width_mm=min(0.5 * driver.hole_width_mm, rod_x) - _FRAME,
        high_mm=high - _FRAME,
        low_mm=low + _FRAME,
        corner_mm=_CORNER,
    )
    return (
        window,
        *holes_at(((-rod_x, rod_y, 0.0), (rod_x, rod_y, 0.0)), M4.hole),
        *holes_at(_hole_places(driver, d), driver.screw.hole),
        *holes_at(ties, _TIE_HOLE),
    )


def _board(joint: str, under_mm: Numbers, over_mm: Numbers, direction: float, d: LegDimensions) -> Part:
    """Build the driver: a bare board, and a block for what stands on it between the rows of its screws."""
    driver = d.of(joint).driver
    middle = _lower_row_mm(d) + 0.5 * driver.hole_length_mm
    block = driver.hole_length_mm - 2.0 * _CLEAR_OF_HOLES
    return Part(
        name=f"{joint}_driver",
        role=Role.ELECTRONICS,
        material=MATERIALS.electronics,
        process="bought",
        prisms=(
            between(
                rectangle(width_mm=driver.width_mm, height_mm=driver.length_mm, y_mm=middle),
                under_mm,
                over_mm,
                *holes_at(_hole_places(driver, d), driver.screw.hole),
            ),
            between(
                rectangle(width_mm=driver.width_mm, height_mm=block, y_mm=middle),
                over_mm,
                over_mm + direction * (driver.height_mm - _BOARD),
            ),
        ),
        catalogue_mass_kg=driver.mass_kg,
        purchases=(Purchase(kind="motor driver", designation=f"motor driver {driver.name}, bare board"),),
        note=d.of(joint).driver_note,
    )

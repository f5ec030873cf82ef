"""The parts of the end stops: bumpers, their seats, and strikers; ``strength.stops`` computes what they carry.

A bumper lies between the end lips of its seat and is bonded to its floor. Seats and strikers of the thigh straddle its
plates: their wings stand on the plates' edges, which carry the force, and their feet reach in between, where a bolt
holds them.
"""

from pareto_monoped.geometry.parts import Part, Prism, disc, layer, machined_part
from pareto_monoped.geometry.roles import RUBBER_GLUE, Joint, JointKind, Purchase, Role
from pareto_monoped.geometry.screws import M3, M4, screw_part, tapped
from pareto_monoped.geometry.shapes import Circle, Numbers, Path, polygon
from pareto_monoped.leg.dimensions import LegDimensions
from pareto_monoped.leg.sandwich import Place, Pulley, belt, sleeve_bolt, sleeve_hole
from pareto_monoped.leg.stops import (
    Face,
    JointStop,
    bumper_place,
    hip_seats,
    hip_stop,
    hip_strikers,
    knee_seats,
    knee_stop,
    knee_strikers,
)

# Our own layout of all faces, mm: along the face, behind it, or along the joint's axis.
LIP, LIP_THICKNESS = 3.0, 1.5  # of a seat at either end of its bumper, above its floor
# Our own layout of seats and strikers on the thigh, mm.
WING = 2.5  # from the face to the edges of the plates
BOLT_DEPTH = 6.5  # of the bolt's axis: 1.9 mm of plate around its hole, which carries nothing
FOOT_DEPTH, HALF_FOOT = 10.0, 4.5
# Our own layout of the shank's striker, mm.
HEAD, HALF_HEAD = 11.0, 5.0  # depth behind a face, and half width there
TOE = 3.0  # depth at a face's ends
_HALF_SPINE = 3.0  # half thickness of the web between the heads
_HEAD_BOLT = (0.0, 5.5)  # along and behind either face
# Our own layout of the base's seats, mm.
_FLOOR = 6.0  # thickness of a seat under the bumper: beside the web 11 N m on 18 mm x 6 mm are 100 MPa
_HALF_WEB = 3.0  # 5 kN at 25 mm from the rods are 125 N m on 6 mm x 45 mm: 60 MPa
_WEB_CORNER, _WEB_FILLET = 1.0, 2.0  # radii at the floor's outer end, and from the floor to the lower rod
_BOSS_WALL = 3.5  # around a rod and around the screw's thread
_ROD_PLAY = 0.1
_SCREW_THREAD = 10.0  # usable depth of the screw from the near cheek, 2.5 diameters


def _half_length_mm(stop: JointStop) -> float:
    return 0.5 * stop.bumper.length_mm


def _bumper(name: str, stop: JointStop, seat: Face, partner: str) -> Part:
    half, bumper = _half_length_mm(stop), stop.bumper
    return Part(
        name=name,
        role=Role.BUMPER,
        material=bumper.elastomer,
        process="bought",
        prisms=(disc(0.5 * bumper.diameter_mm, -half, half),),
        places_mm=(bumper_place(seat, stop),),
        purchases=(
            Purchase(
                kind="rubber",
                designation=f"round bar FKM {bumper.elastomer.hardness_shore_a:g} Shore A, {bumper.diameter_mm:g} mm",
                count=bumper.length_mm,
                unit="mm",
                remark=f"cut to {bumper.length_mm:g} mm",
            ),
        ),
        joint=Joint(
            kind=JointKind.BONDED, how="bonded to the floor of", partner=partner, adhesive=RUBBER_GLUE, first=True
        ),
    )


def _both_sides(outline: Path, one_mm: float, other_mm: float) -> tuple[Prism, Prism]:
    """Build a layer of a part and its image below the middle plane."""
    return (layer(outline, -other_mm, -one_mm), layer(outline, one_mm, other_mm))


def _straddling(name: str, role: Role, placed: Face, d: LegDimensions, stop: JointStop) -> Part:
    """Build a seat or striker on the edges of the thigh's plates; a seat has lips."""
    face, half_gap, half = placed.centred, 0.5 * d.gap_mm, _half_length_mm(stop)
    end = stop.half_face_mm
    foot = face.polygon(
        (-end, 0.0), (end, 0.0), (end, WING), (HALF_FOOT, FOOT_DEPTH), (-HALF_FOOT, FOOT_DEPTH), (-end, WING)
    )
    x, y = face.point(0.0, BOLT_DEPTH)
    hole = Circle(radius_mm=sleeve_hole(M3), x_mm=x, y_mm=y)
    wings = _both_sides(_strip(face, end, 0.0, WING), half_gap, half)
    ends = _both_sides(_strip(face, end, -LIP, WING), half, half + LIP_THICKNESS) if role is not Role.STRIKER else ()
    return machined_part(
        name=name,
        role=role,
        prisms=(layer(foot, -half_gap, half_gap, hole), *wings, *ends),
        places_mm=((placed.x_mm, placed.y_mm, 0.0),),
        note="stands on the edges of the thigh's plates",
    )


def _strip(face: Face, end_mm: float, front_mm: float, back_mm: float) -> Path:
    """Return a strip along a face, from ``front_mm`` to ``back_mm`` behind it."""
    return face.polygon((-end_mm, front_mm), (end_mm, front_mm), (end_mm, back_mm), (-end_mm, back_mm))


def thigh_stop_faces(length_mm: Numbers, d: LegDimensions) -> tuple[Face, ...]:
    """Return all faces of stops on the thigh's edges: hip in front, hip behind, knee's extension, knee's flexion."""
    return (*hip_strikers(d), *(seat.at(-length_mm) for seat in knee_seats(d)))


def thigh_stop_bolts(length_mm: Numbers, d: LegDimensions) -> tuple[Place, ...]:
    """Return where bolts hold the seats and strikers of the thigh."""
    return tuple((*face.point(0.0, BOLT_DEPTH), 0.0) for face in thigh_stop_faces(length_mm, d))


def thigh_stop_parts(length_mm: Numbers, d: LegDimensions) -> tuple[Part, ...]:
    """Build the hip's strikers and the knee's bumpers with their seats; their bolts are the thigh's."""
    front, rear, extension, flexion = thigh_stop_faces(length_mm, d)
    hip, knee = hip_stop(d), knee_stop(d)
    return (
        _straddling("hip_striker_front", Role.STRIKER, front, d, hip),
        _straddling("hip_striker_rear", Role.STRIKER, rear, d, hip),
        *(
            part
            for end, seat in (("extension", extension), ("flexion", flexion))
            for part in (
                _straddling(f"knee_seat_{end}", Role.BRACKET, seat, d, knee),
                _bumper(f"knee_bumper_{end}", knee, seat, f"knee_seat_{end}"),
            )
        ),
    )


def shank_stop_parts(d: LegDimensions) -> tuple[Part, ...]:
    """Build the knee's striker in the shank's fork: a bolted head for either end of the range, and a web between."""
    half_gap = 0.5 * d.shank_gap_mm
    extension, flexion = knee_strikers(d)
    end = knee_stop(d).half_face_mm
    holes = tuple(Circle(radius_mm=sleeve_hole(M4), x_mm=x, y_mm=y) for x, y, _ in shank_stop_bolts(d))

    def head(face: Face, hole: Circle) -> tuple[Prism, ...]:
        outline = face.polygon((-end, 0.0), (end, 0.0), (end, TOE), (HALF_HEAD, HEAD), (-HALF_HEAD, HEAD), (-end, TOE))
        return tuple(
            layer(outline, low, high, hole) for low, high in ((-half_gap, -_HALF_SPINE), (_HALF_SPINE, half_gap))
        )

    return (
        machined_part(
            name="knee_striker",
            role=Role.STRIKER,
            prisms=(
                *head(extension, holes[0]),
                layer(_striker_outline(d), -_HALF_SPINE, _HALF_SPINE, *holes),
                *head(flexion, holes[1]),
            ),
            note="meets the bumpers of extension and flexion",
        ),
        sleeve_bolt("knee_striker_bolt", M4, half_gap + d.shank_plate_mm, shank_stop_bolts(d)),
    )


def shank_stop_bolts(d: LegDimensions) -> tuple[Place, ...]:
    """Return where bolts hold the shank's striker."""
    extension, flexion = knee_strikers(d)
    return (*extension.point(*_HEAD_BOLT), 0.0), (*flexion.point(*_HEAD_BOLT), 0.0)


def _striker_outline(d: LegDimensions) -> Path:
    """Return both heads of the knee's striker and the web between them."""
    extension, flexion = knee_strikers(d)
    end = knee_stop(d).half_face_mm
    points = (
        extension.point(-end, 0.0),
        extension.point(end, 0.0),
        extension.point(end, TOE),
        extension.point(HALF_HEAD, HEAD),
        flexion.point(-end, 0.0),
        flexion.point(end, 0.0),
        flexion.point(end, TOE),
        flexion.point(HALF_HEAD, HEAD),
        flexion.point(-end, HEAD),
        extension.point(-HALF_HEAD, HEAD),
        extension.point(-end, TOE),
    )
    return polygon(points)


def base_stop_parts(d: LegDimensions) -> tuple[Part, ...]:
    """Build the hip's bumpers with their seats, which hang on the rods, and the screws into the near cheek."""
    stop = hip_stop(d)
    front, rear = hip_seats(d)
    screw = screw_part(
        "hip_seat_screw",
        M4,
        head="countersunk",
        seat_mm=d.hip_mount_mm,
        grip_mm=d.cheek_mm,
        room_mm=_SCREW_THREAD,
        direction=1.0,
        places_mm=hip_seat_screws(d),
        note="flush, from the hip actuator's side",
    )
    return (
        *(
            part
            for end, seat, mirror in (("front", front, False), ("rear", rear, True))
            for part in (
                _base_seat(f"hip_seat_{end}", seat, mirror, d, stop),
                _bumper(f"hip_bumper_{end}", stop, seat, f"hip_seat_{end}"),
            )
        ),
        screw,
    )


def hip_seat_screws(d: LegDimensions) -> tuple[Place, ...]:
    """Return where screws hold the hip's seats on the near cheek: between each lower rod and the upper one."""
    (x0, y0), (x1, y1) = d.lower_rod_mm, d.upper_rod_mm
    x, y = 0.5 * (x0 + x1), 0.5 * (y0 + y1)
    return ((x, y, 0.0), (-x, y, 0.0))


def _base_seat(name: str, seat: Face, mirror: bool, d: LegDimensions, stop: JointStop) -> Part:
    """Build a floor under the bumper, a web from there to the rods, and bosses from the web to the near cheek."""
    half = _half_length_mm(stop)
    side = -1.0 if mirror else 1.0
    rods = tuple((side * x, y) for x, y in (d.lower_rod_mm, d.upper_rod_mm))
    screw_x, screw_y, _ = hip_seat_screws(d)[int(mirror)]
    bores = tuple(Circle(radius_mm=d.rod_radius_mm + _ROD_PLAY, x_mm=x, y_mm=y) for x, y in rods)
    thread = Circle(radius_mm=M4.core, x_mm=screw_x, y_mm=screw_y)
    boss = d.rod_radius_mm + _BOSS_WALL
    cheek = d.hip_mount_mm + d.cheek_mm
    return machined_part(
        name=name,
        role=Role.BRACKET,
        prisms=(
            layer(_web(seat, stop.half_face_mm, mirror, rods, boss), -_HALF_WEB, _HALF_WEB, *bores, thread),
            *_both_sides(_strip(seat, stop.half_face_mm, 0.0, _FLOOR), _HALF_WEB, half),
            *_both_sides(_strip(seat, stop.half_face_mm, -LIP, _FLOOR), half, half + LIP_THICKNESS),
            *(
                layer(
                    Circle(radius_mm=hole.radius_mm + _BOSS_WALL, x_mm=hole.x_mm, y_mm=hole.y_mm),
                    cheek,
                    -_HALF_WEB,
                    hole,
                )
                for hole in (bores[1], thread)  # beside the lower rod the thigh passes
            ),
        ),
        features=(tapped(M4, (thread,), cheek, _HALF_WEB, enters="low", usable_mm=_SCREW_THREAD),),
        note="slides onto two rods and stands on the near cheek",
    )


def _web(seat: Face, end_mm: float, mirror: bool, rods: tuple[tuple[float, float], ...], boss_mm: float) -> Path:
    """Return the outline around the seat's floor and both rods, of the front seat or of its mirror image behind."""
    inner = 1.0 if mirror else -1.0  # along the face towards the rods

    def corner(along_mm: float, deep_mm: float, radius_mm: float, *, inside: bool = True) -> Pulley:
        x, y = seat.point(along_mm, deep_mm)
        return Pulley(x_mm=x, y_mm=y, radius_mm=radius_mm, inside=inside)

    lower, upper = (Pulley(x_mm=x, y_mm=y, radius_mm=boss_mm) for x, y in rods)
    edge = -inner * (end_mm - _WEB_CORNER)
    pulleys = (
        lower,
        upper,
        corner(edge, _FLOOR - _WEB_CORNER, _WEB_CORNER),
        corner(edge, _WEB_CORNER, _WEB_CORNER),
        corner(inner * (end_mm + _WEB_FILLET), -_WEB_FILLET, _WEB_FILLET, inside=False),
    )
    return belt(pulleys if mirror else tuple(reversed(pulleys)))

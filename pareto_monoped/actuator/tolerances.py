"""The dimension chains of a gearbox: what must turn, must fit between two faces, or must keep its backlash.

The lengths and their limits are those of the parts (``Part.lengths``), which the drawings show. What no drawing limits
stands here: the play of bearings, what is set when parts are bonded, and how far teeth run out.
"""

from dataclasses import replace
from functools import partial

import numpy as np

from pareto_monoped.actuator.actuator import Actuator
from pareto_monoped.actuator.bearings import axial_play_mm, bore_less_mm, clearance_mm, rated_bearing
from pareto_monoped.actuator.gearset import NEEDLE_PLAY_MM, PIN_PLACE_MM
from pareto_monoped.actuator.layout import NECK_PLAY_MM, NECK_WITHIN_MM
from pareto_monoped.actuator.rating.load import runout_um
from pareto_monoped.geometry.chains import Chain, Link
from pareto_monoped.geometry.gears import ExternalGear, InternalGear
from pareto_monoped.geometry.making import GENERAL_SERIES, RATED_SERIES, limits, thickness_tolerance_mm
from pareto_monoped.geometry.parts import Part
from pareto_monoped.geometry.roles import Role
from pareto_monoped.geometry.shapes import Circle

_TURNING_MM = 0.05
"""Least gap between what turns and what stands still, and least float of the planets; our own choice."""
_FIT_SHARE = 0.85
"""Of an interference that a bearing's clearance loses: handbooks give 0.8 to 0.9 (Harris, ch. 3)."""
_GENERAL_CLASS = 8
"""Accuracy of teeth that are not rated, as their drawings have it."""
_SEAT_OFF_MM = 0.01
"""By how much the sun's end bearing may be off the carrier's axis: half the zone of the seats' coaxiality."""
_DOWEL_MM = 0.2
"""By how much less than drawn a dowel may stand out; our own choice."""
_CENTRED_MM = 0.005
"""By how much a ring is off the planets' common axis that was bonded while they turned in it; our own choice."""
_BUSH_PLAY_MM = 0.026
"""By how much a planet may be off its pin in a bush: half of what 8 H7 and walls of 0.980 mm (ISO 3547-1, 1 mm +0.005 /
-0.020; cited from memory) leave around a pin 6 m6."""
_TIP_CLEARANCE = 0.05
"""Of tips in roots at worst, in modules: half of what DIN 867 asks as drawn, 0.1 to 0.4; our own choice."""
_TIP_WIDTH = 0.3
"""Of teeth at their tips at worst, in modules: the least that handbooks give case-hardened ones (Niemann/Winter)."""
_STEP_MODULES = 0.02
"""Of the secant that says how fast teeth become narrower at their tips: about both eccentricities together."""
_OF = {"sun": "sun's", "planet": "planets'", "ring": "ring's"}


def gearbox_chains(actuator: Actuator) -> tuple[Chain, ...]:
    """Return all chains of a gearbox."""
    sums, teeth = _Sums(actuator), _Teeth(actuator)
    return (
        *_planet_chains(sums),
        *_bearing_chains(sums, actuator),
        *_rotor_chains(sums, actuator),
        *_clearances(sums),
        *_backlash(teeth),
        *_tip_clearances(teeth),
        *_tip_widths(teeth),
    )


def length_link(part: Part, name: str, sign: float = 1.0, which: int = 0) -> Link:
    """Return a length of a part as a link; ``which`` tells instances apart."""
    (found,) = (one for one in part.lengths if one.name == name)
    return Link(
        part=part.name,
        name=name,
        sign=sign,
        nominal_mm=found.nominal_mm,
        lower_mm=float(found.lower_mm),
        upper_mm=float(found.upper_mm),
        which=which,
    )


class _Sums:
    """Lengths of an actuator's parts by name, as links."""

    def __init__(self, actuator: Actuator) -> None:
        self.parts: dict[str, Part] = {part.name: part for part in actuator.parts}
        self.play_mm = 0.5 * axial_play_mm(rated_bearing(2.0 * self.radii_mm("main_bearing")[0]))

    def reach_mm(self, part: str) -> float:
        """Return the largest radius of a turned part."""
        outlines = (solid.outline for solid in self.parts[part].prisms)
        return max(float(one.radius_mm) for one in outlines if isinstance(one, Circle))

    def radii_mm(self, part: str) -> tuple[float, float]:
        """Return the radii of bore and outside of a part's first prism, such as a bearing's."""
        solid = self.parts[part].prisms[0]
        hole = solid.holes[0]
        assert isinstance(hole, Circle)
        assert isinstance(solid.outline, Circle)
        return float(hole.radius_mm), float(solid.outline.radius_mm)

    def has(self, part: str, name: str) -> bool:
        """Return whether a part has such a length."""
        return part in self.parts and any(one.name == name for one in self.parts[part].lengths)

    def add(self, part: str, name: str, which: int = 0, sign: float = 1.0) -> Link:
        """Return a length that widens the gap."""
        return length_link(self.parts[part], name, sign, which)

    def less(self, part: str, name: str, which: int = 0) -> Link:
        """Return a length that narrows the gap."""
        return self.add(part, name, which, -1.0)

    def play(self) -> Link:
        """Return how far the main bearing lets the carrier move off the middle of its play."""
        return Link(
            part="main_bearing", name="axial play", sign=-1.0, nominal_mm=0.0, lower_mm=0.0, upper_mm=self.play_mm
        )


def _planet_chains(sums: _Sums) -> tuple[Chain, ...]:
    if "planet_washer" in sums.parts:
        washer = [sums.less("planet_washer", "thickness", which) for which in (0, 1)]
        between = (sums.less("planet", "face"), *washer)
    else:
        between = (sums.less("planet_bush", "length"),)
    holes = (sums.add("carrier", "pin hole"), sums.add("secondary_carrier", "pin hole"))
    if sums.has("carrier", "web"):
        return (
            Chain(
                name="float of the planets",
                links=(sums.add("carrier", "web"), *between),
                least_mm=_TURNING_MM,
                cure="raise needles.washer_play_mm",
            ),
            Chain(
                name="room for the pins between the carriers",
                links=(*holes, sums.add("carrier", "web"), sums.less("planet_pin", "length")),
                cure="make the pins shorter",
            ),
        )
    held = (sums.less("carrier", "pin hole"), sums.less("secondary_carrier", "pin hole"))
    return (
        Chain(
            name="float of the planets",
            links=(sums.add("planet_pin", "length"), *held, *between),
            least_mm=_TURNING_MM,
            cure="raise carrier.planet_clearance_mm",
        ),
    )


def _bearing_chains(sums: _Sums, actuator: Actuator) -> tuple[Chain, ...]:
    """Return the seats of the main bearing, the grooves, and what the fits leave of the bearings' clearance."""
    width, ring = sums.less("main_bearing", "width"), sums.less("retaining_ring", "thickness")
    chains = [
        Chain(
            name="room for bearing and retaining ring on the carrier",
            links=(sums.add("carrier", "inner seat"), width, ring),
            cure="move the groove forwards",
        ),
        Chain(
            name="play of the retaining ring in the carrier's groove",
            links=(sums.add("carrier", "groove"), ring),
            cure="make the groove wider",
        ),
    ]
    if actuator.family == "ISSPG":
        seat = (sums.add("ring_housing", "seat"), sums.less("casing", "register"), width)
    else:
        outer = sums.less("bore_retaining_ring", "thickness")
        seat = (sums.add("ring_housing", "seat"), width, outer)
        chains += [
            Chain(
                name="play of the retaining ring in the ring housing's groove",
                links=(sums.add("ring_housing", "groove"), outer),
                cure="make the groove wider",
            ),
            Chain(
                name="room for the ring between ring housing and casing",
                links=(
                    sums.add("ring_housing", "ring seat"),
                    sums.add("casing", "ring seat"),
                    sums.less("ring", "face"),
                ),
                cure="make the seats deeper",
            ),
            *_planets_to_wall(sums, actuator),
        ]
    chains.append(Chain(name="room for the main bearing in its seat", links=seat, cure="make the seat deeper"))
    return tuple(chains)


def _planets_to_wall(sums: _Sums, actuator: Actuator) -> tuple[Chain, ...]:
    """Return the gap to the wall behind the ring housing's groove; none where the planets stay inside the bearing."""
    gears = actuator.gears
    if gears.carrier_radius_mm + gears.planet().tip_radius_mm <= sums.radii_mm("main_bearing")[1]:
        return ()
    return (
        Chain(
            name="planets to the wall behind the groove",
            links=(
                sums.add("main_bearing", "width"),
                sums.add("carrier", "shoulder"),
                _planet_from_shoulder(sums),
                sums.less("ring_housing", "wall"),
                sums.play(),
            ),
            least_mm=_TURNING_MM,
            cure="make the carrier's shoulder longer",
        ),
    )


def _planet_from_shoulder(sums: _Sums) -> Link:
    """Return how far from the carrier's shoulder a planet is that is pushed forwards."""
    if "planet_washer" in sums.parts:
        return sums.add("planet_washer", "thickness")
    bush, planet = sums.parts["planet_bush"].prisms[0], sums.parts["planet"].prisms[-1]
    stands_out = float(bush.z1_mm) - float(planet.z1_mm)
    return Link(
        part="planet_bush", name="stands out", sign=1.0, nominal_mm=stands_out, lower_mm=-_TURNING_MM, upper_mm=0.0
    )


def _rotor_chains(sums: _Sums, actuator: Actuator) -> tuple[Chain, ...]:
    """Return the gaps between rotor and carriers, and between rotor and housing."""
    neck = Link.about("sun", "neck, set when bonded", NECK_WITHIN_MM, nominal_mm=NECK_PLAY_MM, sign=1.0)
    chains = [
        Chain(name="sun's neck to its end bearing", links=(neck,), least_mm=_TURNING_MM, cure="bond it farther back")
    ]
    # The carrier pushed towards the motor: shoulder behind the main bearing, then web and second carrier.
    behind = [
        sums.less("carrier", "inner seat"),
        sums.add("main_bearing", "width"),
        sums.add("retaining_ring", "thickness"),
        sums.less("carrier", "shoulder"),
        *_between_carriers(sums),
        sums.play(),
    ]
    name, length = ("motor_rotor", "bell") if actuator.family == "ISSPG" else ("coupling", "height")
    (face,) = (float(one.z1_mm) for one in sums.parts[name].lengths if one.name == length)
    last = (sums.less("secondary_carrier", "thickness"), *_dowels(sums, face))
    if actuator.family == "ISSPG":
        base = (sums.add("casing", "length"), sums.less("rear_bearing", "width"), sums.less("coupling", "height"))
        seat = sums.less("ring_housing", "seat")
        chains += [
            Chain(
                name="rotor's bell to the ring housing",
                links=(*base, sums.less("motor_rotor", "bell"), sums.less("ring_housing", "length")),
                least_mm=_TURNING_MM,
                cure="raise casing.rotor_clearance_mm",
            ),
            Chain(
                name="second carrier to coupling and dowels",
                links=(*base, sums.less("motor_rotor", "bell"), seat, *behind, *last),
                least_mm=_TURNING_MM,
                cure="raise casing.motor_carrier_clearance_mm",
            ),
        ]
    else:
        # The outer ring rests on the ring behind it, in the groove's back wall.
        outer = (sums.less("ring_housing", "seat"), sums.add("bore_retaining_ring", "thickness"))
        meets = sums.reach_mm("coupling") > sums.radii_mm("secondary_carrier")[0]  # or the motor's face is next
        chains.append(
            Chain(
                name="second carrier to coupling and dowels",
                links=(
                    sums.add("casing", "length"),
                    sums.add("ring_housing", "length"),
                    sums.less("motor_rotor", "length"),
                    *([sums.less("coupling", "height")] if meets else []),
                    *outer,
                    *behind,
                    *last,
                ),
                least_mm=_TURNING_MM,
                cure="raise casing.motor_carrier_clearance_mm",
            )
        )
    return tuple(chains)


def _dowels(sums: _Sums, face_mm: float) -> tuple[Link, ...]:
    """Return how far the dowels stand out of a face towards the second carrier; nothing where they pass beside it."""
    inner, outer = sums.radii_mm("secondary_carrier")
    circle, dowel = float(sums.parts["coupling_dowel"].pitch_radius_mm), sums.reach_mm("coupling_dowel")
    out = max(float(one.z1_mm) for one in sums.parts["coupling_dowel"].prisms) - face_mm
    if circle + dowel <= inner or circle - dowel >= outer or out <= 0.0:
        return ()
    return (
        Link(part="coupling_dowel", name="stands out", sign=-1.0, nominal_mm=out, lower_mm=-_DOWEL_MM, upper_mm=0.0),
    )


def _between_carriers(sums: _Sums) -> tuple[Link, ...]:
    if sums.has("carrier", "web"):
        return (sums.less("carrier", "web"),)
    return (
        sums.less("planet_pin", "length"),
        sums.add("carrier", "pin hole"),
        sums.add("secondary_carrier", "pin hole"),
    )


def _clearances(sums: _Sums) -> tuple[Chain, ...]:
    """Return what interference on the shafts leaves of the bearings' clearance; their seats H7 take none."""
    chains = []
    for name in ("main_bearing", "end_bearing", "rear_bearing"):
        if name not in sums.parts:
            continue
        bore = 2.0 * sums.radii_mm(name)[0]
        low, high = clearance_mm(bore)
        shaft = limits(bore, "h6")
        of = partial(Link, part=name, nominal_mm=0.0)
        chains.append(
            Chain(
                name=f"running clearance of the {name.replace('_', ' ')}",
                links=(
                    of(name="radial clearance", sign=1.0, lower_mm=low, upper_mm=high),
                    of(name="bore", sign=_FIT_SHARE, lower_mm=-bore_less_mm(bore), upper_mm=0.0),
                    of(name="shaft", sign=-_FIT_SHARE, lower_mm=shaft.lower_mm, upper_mm=shaft.upper_mm),
                ),
                cure="take a bearing of more clearance",
            )
        )
    return tuple(chains)


class _Teeth:
    """What may be off about the teeth of an actuator, as links.

    An eccentricity counts where the gear meets its mate: positive where it takes sun or ring away from the planet, or
    the planet away from the sun. Tips are turned and teeth cut in different clampings, so each has one of its own.
    """

    def __init__(self, actuator: Actuator) -> None:
        gears = actuator.gears
        self.module_mm, self.centre_mm = float(gears.module_mm), float(gears.carrier_radius_mm)
        self.gears: dict[str, ExternalGear | InternalGear] = {
            "sun": gears.sun(),
            "planet": gears.planet(),
            "ring": gears.ring(),
        }
        self.slopes = [2.0 * float(np.tan(one)) for one in (gears.working_angle_rad, gears.ring_working_angle_rad)]
        self.series = RATED_SERIES if actuator.rating is not None else GENERAL_SERIES
        bushes = any(part.role is Role.BUSH for part in actuator.parts)
        self.play_mm = _BUSH_PLAY_MM if bushes else NEEDLE_PLAY_MM
        # Of a part's teeth, the first are those of the gear itself.
        self.runout_mm = {part.name: part.teeth[0].runout_mm for part in actuator.parts if part.teeth}

    def thinning(self, part: str, slope: float = 1.0) -> Link:
        """Return by how much the teeth are thinner than without backlash."""
        gear = self.gears[part]
        most = float(thickness_tolerance_mm(2.0 * gear.pitch_radius_mm, self.series))
        thin = float(gear.backlash_mm)
        return Link(part=part, name="thinning of teeth", sign=slope, nominal_mm=thin, lower_mm=0.0, upper_mm=most)

    def eccentric(self, part: str, slope: float, of: str = "") -> Link:
        """Return half the runout of a gear's teeth, or ``of tips`` that of its tips."""
        pitch_mm = 2.0 * float(self.gears[part].pitch_radius_mm)
        runout_mm = self.runout_mm.get(part) or 1e-3 * float(runout_um(pitch_mm, self.module_mm, _GENERAL_CLASS))
        return Link.about(part, f"eccentricity {of}".strip(), 0.5 * runout_mm, sign=slope)

    def axes(self, mesh: int, slope: float) -> tuple[Link, ...]:
        """Return by how much the axes of a mesh are off, without eccentricities: 0 of sun and planet, 1 of the ring."""
        pin = partial(Link.about, "carrier", "place of the pin", PIN_PLACE_MM)
        if mesh:
            return pin(sign=-slope), Link.about("ring", "place, set when bonded", _CENTRED_MM, sign=slope)
        return pin(sign=slope), Link.about("carrier", "place of the end bearing", _SEAT_OFF_MM, sign=slope)

    def tip(self, part: str, slope: float, nominal_mm: float = 0.0) -> Link:
        """Return a tip diameter, with the limits of its class; without ``nominal_mm`` its deviation alone."""
        zone = "H9" if part == "ring" else "h9"
        found = limits(2.0 * float(self.gears[part].tip_radius_mm), zone)
        of = partial(Link, part=part, name="tip diameter", nominal_mm=nominal_mm)
        return of(sign=0.5 * slope, lower_mm=found.lower_mm, upper_mm=found.upper_mm)

    def root(self, part: str, slope: float) -> tuple[Link, ...]:
        """Return a root diameter: of sun and planets without thinning, and how much deeper the rack is fed for it.

        A ring's root is as drawn: its wire can only go farther out.
        """
        full = replace(self.gears[part], backlash_mm=0.0)
        root = Link.about(part, "root diameter", 0.0, nominal_mm=2.0 * float(full.root_radius_mm), sign=0.5 * slope)
        fed = -0.5 * slope / float(np.tan(full.pressure_angle_rad))
        return (root,) if part == "ring" else (root, self.thinning(part, fed))


def _backlash(teeth: _Teeth) -> tuple[Chain, ...]:
    """Return the backlash of both meshes along the pitch circle; a shift s of an axis takes 2 tan(alpha_w) s."""
    chains = []
    for mesh, (first, second) in enumerate((("sun", "planet"), ("planet", "ring"))):
        slope = teeth.slopes[mesh]
        thin = (teeth.thinning(first), teeth.thinning(second))
        off = (teeth.eccentric(first, -slope if mesh else slope), teeth.eccentric(second, slope))
        links = (*thin, *teeth.axes(mesh, slope), *off)
        chains.append(
            Chain(name=f"backlash of {first} and {second}", links=links, cure="raise gears.backlash_least_mm")
        )
    return tuple(chains)


def _tip_clearances(teeth: _Teeth) -> tuple[Chain, ...]:
    """Return the radial clearance between the tips of each gear and the roots of its mate."""
    chains = []
    for tip, root in (("sun", "planet"), ("planet", "sun"), ("planet", "ring"), ("ring", "planet")):
        mesh = int("ring" in (tip, root))
        away = {"sun": 1.0, "planet": -1.0 if mesh else 1.0, "ring": 1.0}
        grows = {"sun": -1.0, "planet": -1.0, "ring": 1.0}
        pin, other = teeth.axes(mesh, 1.0)
        chains.append(
            Chain(
                name=f"clearance of the {_OF[tip]} tips in the {_OF[root]} roots",
                links=(
                    replace(pin, nominal_mm=teeth.centre_mm),
                    other,
                    Link.about("planet", "play on its pin", teeth.play_mm, sign=away["planet"]),
                    teeth.tip(tip, grows[tip], 2.0 * float(teeth.gears[tip].tip_radius_mm)),
                    *teeth.root(root, grows[root]),
                    teeth.eccentric(tip, away[tip], "of tips"),
                    teeth.eccentric(root, away[root]),
                ),
                least_mm=_TIP_CLEARANCE * teeth.module_mm,
                cure=f"cut the {_OF[tip]} tips shorter",
            )
        )
    return tuple(chains)


def _tip_widths(teeth: _Teeth) -> tuple[Chain, ...]:
    """Return how wide the teeth are at their tips, along the arc, before their edges are broken.

    The width falls by the thinning times the proportion of the radii, and the faster the farther a tip stands out.
    """
    chains = []
    for part, gear in teeth.gears.items():
        width, reach = float(gear.tip_thickness_mm), float(gear.tip_radius_mm / gear.pitch_radius_mm)
        longer = replace(gear, tip_shortening=gear.tip_shortening - _STEP_MODULES)
        lost = float(width - longer.tip_thickness_mm) / (_STEP_MODULES * teeth.module_mm)
        full = width + reach * float(gear.backlash_mm)
        links = (
            Link.about(part, "tips without thinning", 0.0, nominal_mm=full, sign=1.0),
            teeth.thinning(part, -reach),
            teeth.tip(part, lost if part == "ring" else -lost),
            teeth.eccentric(part, -lost),
            teeth.eccentric(part, lost, "of tips"),
        )
        least_mm, cure = _TIP_WIDTH * teeth.module_mm, "take less profile shift"
        chains.append(Chain(name=f"width of the {_OF[part]} tips", links=links, least_mm=least_mm, cure=cure))
    return tuple(chains)

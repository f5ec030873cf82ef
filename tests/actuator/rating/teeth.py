"""Teeth once more, plainly and slowly, drawn and measured: an oracle for gear sets and for the roots of ISO 6336-3.

Profile shifts are those at which the teeth fill the working pitch circles. Roots are traced: the envelope of the rack's
rounding, and in a ring the arc that touches root circle and flank. Tips are as long as a drawing of the line of action
allows. Gears have module 1.
"""

from dataclasses import dataclass, replace
from functools import cache, cached_property
from math import atan2, cos, hypot, pi, sin, sqrt, tan

ALPHA = pi / 9.0
RACK_ADDENDUM, RACK_DEDENDUM, RACK_FILLET = 1.0, 1.25, 0.38
# DIN 3967, series 23: tolerance of the tooth's thickness up to a reference diameter.
THINNER = ((10.0, 0.008), (50.0, 0.012), (125.0, 0.016), (280.0, 0.020))
TIP_MARGIN = 0.02  # in modules, between a tip's reach and the end of its mate's flank
AXIS_OFF_MM = 0.010 + 0.012  # zone of the pins' holes, and half the play of needles between F7 and m6


def inv(angle):
    return tan(angle) - angle


def bisect(function, low, high):
    """Root of a function that changes its sign between two places, to the last bit."""
    below = function(low) > 0.0
    assert below != (function(high) > 0.0)
    while low < (middle := 0.5 * (low + high)) < high:
        if (function(middle) > 0.0) == below:
            low = middle
        else:
            high = middle
    return middle


@dataclass(frozen=True)
class Gear:
    """A gear whose profile ``x`` moves outwards, also in a ring; ``cut`` shortens its tips."""

    teeth: int
    x: float = 0.0
    cut: float = 0.0
    internal: bool = False

    @property
    def base(self):
        return self.teeth / 2.0 * cos(ALPHA)

    @property
    def tip(self):
        reach = RACK_ADDENDUM - self.cut
        return self.teeth / 2.0 + self.x + (-reach if self.internal else reach)

    def with_tip(self, radius):
        return replace(self, cut=self.cut + (radius - self.tip) * (1.0 if self.internal else -1.0))

    def thickness(self, radius):
        """Of a tooth (external gear) or a space (ring) at a radius, along the arc: the involute unwound."""
        angle = sqrt((radius / self.base) ** 2 - 1.0)
        at_reference = (pi + 4.0 * self.x * tan(ALPHA)) / self.teeth
        return radius * (at_reference + 2.0 * (inv(ALPHA) - (angle - atan2(angle, 1.0))))


def line_of_action(pinion, wheel, distance):
    """Distance between the points where the line of action touches both base circles."""
    both = wheel.base - pinion.base if wheel.internal else wheel.base + pinion.base
    return sqrt(distance**2 - both**2)


@cache  # loops over modules, numbers of planets and face widths ask again and again
def shifted(zs, zp, zr, y, x):
    """Sun, planet and ring without backlash at a centre distance (zs + zp) / 2 + y, the sun shifted by x."""
    distance = (zs + zp) / 2.0 + y

    def free_arc(first, second):
        """Pitch less both teeth, or space less tooth, on the working pitch circles."""
        sign = -1.0 if second.internal else 1.0
        radius = distance * first.teeth / (second.teeth + sign * first.teeth)
        mate = radius * second.teeth / first.teeth
        if second.internal:
            return second.thickness(mate) - first.thickness(radius)
        return 2.0 * pi * radius / first.teeth - first.thickness(radius) - second.thickness(mate)

    xp = bisect(lambda one: free_arc(Gear(zs, x), Gear(zp, one)), -3.0, 3.0)
    xr = bisect(lambda one: free_arc(Gear(zp, xp), Gear(zr, one, internal=True)), -5.0, 5.0)
    cut = x + xp - y
    return Gear(zs, x, cut), Gear(zp, xp, cut), Gear(zr, xr, internal=True), distance


def drawn(gears):
    """Sun, planet and ring of a gear set, their tips cut short where it says so, and the centre distance."""
    teeth = int(gears.sun_teeth), int(gears.planet_teeth), int(gears.ring_teeth)
    *three, distance = shifted(*teeth, float(gears.centre_shift), float(gears.sun_shift))
    if gears.tips_fitted:
        three = fitted(*three, distance, float(gears.module_mm), float(gears.backlash_mm))
    return *three, distance


@cache
def fitted(sun, planet, ring, distance, module, backlash_mm):
    """The gears with tips that end where their mates have flanks, wherever the planet's axis may be."""
    sun_flank, planet_flank = (begins(gear, module, backlash_mm) + TIP_MARGIN for gear in (sun, planet))
    ring_flank = form_radius(generated(ring, backlash_mm / module), ring) - TIP_MARGIN
    sun_tips, planet_tips, ring_tips = [sun.tip], [planet.tip], [ring.tip]
    for off_mm in (-AXIS_OFF_MM, 0.0, AXIS_OFF_MM):
        place = distance + off_mm / module
        planet_tips.append(met_by(sun, sun_flank, planet, place))
        sun_tips.append(met_by(planet, planet_flank, sun, place))
        planet_tips.append(met_by(ring, ring_flank, planet, place))
        ring_tips.append(met_by(planet, planet_flank, ring, place))
    return sun.with_tip(min(sun_tips)), planet.with_tip(min(planet_tips)), ring.with_tip(max(ring_tips))


@cache
def begins(gear, module, backlash_mm):
    """Where the straight flank of the rack has cut, of the thickest and the thinnest teeth within their tolerance."""
    thinnest = thinning(gear.teeth, module, backlash_mm)
    return max(form_radius(generated(gear, thinner / module)) for thinner in (backlash_mm, thinnest))


def met_by(gear, radius, mate, distance):
    """Radius of the mate's point that meets a gear's flank at a radius, on a drawing of the line of action.

    The gear's centre is the origin; the line goes through the pitch point on the y axis.
    """
    internal = gear.internal or mate.internal
    centre = distance if gear.internal or not internal else -distance
    between = mate.teeth - gear.teeth if internal else mate.teeth + gear.teeth
    pitch_point = distance * gear.teeth / abs(between)
    # Inclined so that it touches the base circle.
    lean = bisect(lambda angle: pitch_point * cos(angle) - gear.base, 0.0, pi / 2.0)
    foot = -pitch_point * sin(lean)  # from the pitch point, along the line

    def far(along, centre):
        return hypot(along * cos(lean), pitch_point + along * sin(lean) - centre)

    along = bisect(lambda place: far(place, 0.0) - radius, foot, foot + 2.0 * radius)
    return far(along, centre)


@dataclass(frozen=True)
class Fillet:
    """The fillet of one tooth, with the tooth's centre line as y axis and the gear's centre as origin."""

    gear: Gear

    def rounding(self, moved):
        """Centre of the rack's rounding, from the pitch point, when the rack has moved along the pitch line."""
        half_rack_tooth = pi / 4.0 - RACK_DEDENDUM * tan(ALPHA) - RACK_FILLET * (1.0 - sin(ALPHA)) / cos(ALPHA)
        return half_rack_tooth + moved, self.gear.x - (RACK_DEDENDUM - RACK_FILLET)

    def reach(self):
        """From below the pitch point, where it cuts the space's bottom, to where its straight flank begins."""
        low = bisect(lambda moved: self.rounding(moved)[0], -3.0, 3.0)
        high = bisect(lambda moved: atan2(*self.rounding(moved)[::-1]) + ALPHA, low, low + 20.0)
        return low, high

    def point(self, moved):
        """Where it cuts. The rounding's centre, the pitch point and the point of contact lie on one line."""
        radius, centre = self.gear.teeth / 2.0, self.rounding(moved)
        more = 1.0 + RACK_FILLET / hypot(*centre)
        # The gear's centre lies below the pitch point. Turn the gear back, then turn the middle of the tooth on the
        # right, half a pitch away, onto the y axis.
        turn = moved / radius + pi / self.gear.teeth
        x, y = more * centre[0], more * centre[1] + radius
        return x * cos(turn) - y * sin(turn), x * sin(turn) + y * cos(turn)


@dataclass(frozen=True)
class Arc:
    """The root of a ring's tooth, an arc between the root circle and the flank; likewise."""

    gear: Gear  #: whose spaces are as wide as with backlash
    root: float  #: radius of its root circle

    def flank(self, radius):
        """Of the space around the y axis."""
        beside = self.gear.thickness(radius) / (2.0 * radius)
        return radius * sin(beside), radius * cos(beside)

    def centre(self, radius):
        """Of the arc that touches the flank at a radius, from inside the space."""
        step = 1e-5
        (x0, y0), (x1, y1) = self.flank(radius - step), self.flank(radius + step)
        x, y = self.flank(radius)
        long = hypot(x1 - x0, y1 - y0) / RACK_FILLET
        return x - (y1 - y0) / long, y + (x1 - x0) / long

    @cached_property
    def end(self):
        """Radius at which it touches the flank."""
        low = max(self.gear.base + 1e-4, self.root - 2.0)
        return bisect(lambda r: hypot(*self.centre(r)) - (self.root - RACK_FILLET), low, self.root)

    def reach(self):
        centre, end = self.centre(self.end), self.flank(self.end)
        turn = pi / self.gear.teeth
        return atan2(*centre) - turn, atan2(end[0] - centre[0], end[1] - centre[1]) - turn

    def point(self, turned):
        """At an angle around the arc's centre; the tooth on the right has been turned onto the y axis."""
        x, y = self.centre(self.end)
        angle, far = atan2(x, y) - pi / self.gear.teeth, hypot(x, y)
        return far * sin(angle) + RACK_FILLET * sin(turned), far * cos(angle) + RACK_FILLET * cos(turned)


def root_of(made, gear):
    """The root of a gear as ``made`` with backlash; the roots of a ring are as deep as without."""
    return Arc(made, gear.teeth / 2.0 + gear.x + RACK_DEDENDUM) if made.internal else Fillet(made)


def form_radius(made, gear=None):
    """Where the curve of the root ends and the flank begins, as far as cutter or wire leave it."""
    root = root_of(made, gear)
    return hypot(*root.point(root.reach()[1]))


def critical(root, wanted):
    """Half thickness, height and fillet radius where the root's tangent leans so much against the tooth's middle."""
    step, down = 1e-4, -1.0 if isinstance(root, Arc) else 1.0

    def lean(place):
        (x0, y0), (x1, y1) = root.point(place - step), root.point(place + step)
        return atan2(x1 - x0, down * (y1 - y0))

    # From the bottom of the space, where it is a right angle, on to beyond the end of the root.
    low, high = root.reach()
    place = bisect(lambda one: lean(one) - wanted, low, high + 0.5)
    (x0, y0), (x1, y1), (x2, y2) = (root.point(place + k * step) for k in (-1, 0, 1))
    dx, dy, ddx, ddy = (x2 - x0) / 2, (y2 - y0) / 2, x2 - 2 * x1 + x0, y2 - 2 * y1 + y0
    return abs(x1), abs(y1), (dx * dx + dy * dy) ** 1.5 / abs(dx * ddy - dy * ddx)


def on_path(pinion, wheel, distance):
    """Where contact begins (the wheel's tip) and ends (the pinion's), as the pinion's radii of curvature."""
    wheel_curvature = sqrt(wheel.tip**2 - wheel.base**2)
    line = line_of_action(pinion, wheel, distance)
    begin = wheel_curvature - line if wheel.internal else line - wheel_curvature
    return begin, sqrt(pinion.tip**2 - pinion.base**2)


def contact_ratio(pinion, wheel, distance):
    begin, end = on_path(pinion, wheel, distance)
    return (end - begin) / (pi * cos(ALPHA))


def thinning(teeth, module, backlash_mm):
    """By how much a tooth of a rated gear may be thinner than without backlash, in mm: drawn, and by tolerance."""
    return backlash_mm + next(tolerance for largest, tolerance in THINNER if teeth * module <= largest)


@cache  # searches ask for a gear again with each other gear, number of planets and face width
def generated(gear, thinner):
    """The gear whose teeth are thinner (ring: whose spaces are wider) on the reference circle, by shift alone."""
    change = thinner if gear.internal else -thinner
    wanted = gear.thickness(gear.teeth / 2.0) + change
    x = bisect(lambda one: Gear(gear.teeth, one).thickness(gear.teeth / 2.0) - wanted, gear.x - 1.0, gear.x + 1.0)
    return Gear(gear.teeth, x, internal=gear.internal)


@cache  # loops over face widths ask again and again
def form_and_notch(gear, mate, distance, thinner=0.0):
    """Y_F, Y_S and q_s of a gear whose teeth are thinner by so many modules; tips and contact as without backlash."""
    made = generated(gear, thinner)
    pitch = pi * cos(ALPHA)
    if gear.internal:
        begin, end = on_path(mate, gear, distance)
        # Single contact nearest to the ring's tip: one base pitch before the pair leaves at the planet's tip. Curvature
        # of the ring is that of the planet plus the distance of the base circles' tangent points.
        curvature = line_of_action(mate, gear, distance) + end - pitch
    else:
        begin, end = on_path(gear, mate, distance)
        curvature = begin + pitch
    angle = atan2(curvature, gear.base)
    half_thickness, height, radius = critical(root_of(made, gear), pi / 3.0 if gear.internal else pi / 6.0)
    half_tooth = (pi / 2.0 + (-2.0 if gear.internal else 2.0) * made.x * tan(ALPHA)) / gear.teeth
    if gear.internal:
        force_angle = angle + (half_tooth - inv(ALPHA) + inv(angle))
        arm = height - gear.base / cos(force_angle)
    else:
        force_angle = angle - (half_tooth + inv(ALPHA) - inv(angle))
        arm = gear.base / cos(force_angle) - height
    chord = 2.0 * half_thickness
    form = 6.0 * arm * cos(force_angle) / (chord**2 * cos(ALPHA))
    slender, notch = chord / arm, chord / (2.0 * radius)
    return form, (1.2 + 0.13 * slender) * notch ** (1.0 / (1.21 + 2.3 / slender)), notch

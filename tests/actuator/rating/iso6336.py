"""ISO 6336 once more, plainly and slowly, one gear set at a time: an oracle for ``pareto_monoped.actuator.rating``.

Written from the standard's equations, with other means than the product: teeth are those of ``teeth``; contact stress
is Hertz' at the point in question; the pin is a beam solved by stiffness matrices; the sun's twist is summed slice by
slice; crowned teeth are springs side by side. Lengths in mm, forces in N, stresses in MPa.
"""

from functools import cache
from math import ceil, cos, hypot, log, pi, sin, sqrt

import numpy as np

from tests.actuator.rating.teeth import (
    ALPHA,
    bisect,
    contact_ratio,
    drawn,
    form_and_notch,
    generated,
    line_of_action,
    on_path,
    thinning,
)

E_STEEL, NU_STEEL = 206000.0, 0.3
K1 = {5: 7.5, 6: 14.9, 7: 26.8}
STATIC_LIFE = {
    ("case_hardened", "flank"): (1e5, 1.6, 5e7),
    ("case_hardened", "root"): (1e3, 2.5, 3e6),
    ("nitrided", "flank"): (1e5, 1.3, 2e6),
    ("nitrided", "root"): (1e3, 1.6, 3e6),
    ("through_hardened", "flank"): (1e5, 1.6, 5e7),
    ("through_hardened", "root"): (1e4, 2.5, 3e6),
}


def hertz_load(stress, pinion, wheel, distance, module, at_wheel):
    """Tangential load per face width, with Z_epsilon, at which the contact stress of a gear is ``stress``.

    At the inner point of single pair contact of the gear or at the pitch point, whichever has less curvature radius.
    """
    begin, end = on_path(pinion, wheel, distance)
    line, internal = line_of_action(pinion, wheel, distance), wheel.internal
    # The pitch point divides the line of action in proportion to the teeth, from outside in an internal mesh.
    places = [line * pinion.teeth / (wheel.teeth - pinion.teeth if internal else wheel.teeth + pinion.teeth)]
    if not at_wheel:
        places.append(end - pi * cos(ALPHA))
    elif not internal:
        places.append(begin + pi * cos(ALPHA))
    reduced = []
    for first in places:
        second = line + first if internal else line - first
        reduced.append(first * second / (second - first if internal else second + first))
    radius = module * min(reduced)
    compliance = 2.0 * (1.0 - NU_STEEL**2) / E_STEEL
    normal = stress**2 * pi * compliance * radius
    epsilon = contact_ratio(pinion, wheel, distance)
    return normal * cos(ALPHA) / ((4.0 - epsilon) / 3.0)


def life(treatment, kind, cycles):
    """Z_NT or Y_NT, by interpolation in logarithms between the standard's points."""
    start, factor, reference = STATIC_LIFE[treatment, kind]
    return float(np.exp(np.interp(log(cycles), [log(start), log(reference), log(1e10)], [log(factor), 0.0, log(0.85)])))


def damage_cycles(passes, levels, treatment, kind, jumps, highest):
    """Cycles at the highest torque that use up as much life as the levels do: sums of n / N along the sloping line."""
    start, factor, reference = STATIC_LIFE[treatment, kind]
    slope = log(reference / start) / log(factor)

    def allowed(stress):
        return reference * stress ** (-slope)

    total = 0.0
    for share, angle in levels:
        stress = sqrt(share / highest) if kind == "flank" else share / highest
        total += jumps * ceil(passes * angle - 1e-9) / allowed(stress)
    return total * allowed(1.0)


def web_stiffness(planets, r_pin, planet_tip, ring_tip, settings, length):
    """Of one web in N/mm: a beam guided at both ends."""
    area, second = web_section(planets, r_pin, planet_tip, ring_tip, settings.parts.webs, settings.parts.carrier)
    if area == 0.0:
        return 0.0
    aluminium, shear = 70e3, 70e3 / 2.66
    return 1.0 / (length**3 / (12.0 * aluminium * second) + 1.2 * length / (shear * area))


@cache
def web_section(planets, r_pin, planet_tip, ring_tip, data, carrier, slices=20000):
    """Area and second moment of one web, cut into rings around the carrier's axis; 0, 0 where there is none."""
    half = pi / planets
    x_pin, y_pin = r_pin * cos(half), r_pin * sin(half)
    keep = planet_tip + data.clearance_mm
    outer = min(
        ring_tip - data.clearance_mm,
        r_pin + carrier.pin_diameter_mm / 2.0 + carrier.pin_wall_mm + data.overhang_mm,
    )

    def free(radius):
        """Angle from the middle of the gap to where a circle around the axis enters the planet's clearance."""
        cosine = (radius**2 + r_pin**2 - keep**2) / (2.0 * radius * r_pin)
        return half - np.arccos(np.clip(cosine, -1.0, 1.0))

    def gap(x):
        """Half the gap between the planets at a distance x from the axis."""
        return y_pin - sqrt(max(keep**2 - (x - x_pin) ** 2, 0.0))

    if planets < 3 or free(outer) <= 0.0:
        return 0.0, 0.0
    inner = max(min(outer - data.depth_mm, outer * cos(free(outer)) - data.depth_mm / 2.0), x_pin)
    if gap(inner) < data.neck_mm < gap(outer):
        inner = bisect(lambda x: gap(x) - data.neck_mm, inner, outer)
    hole = 1.25 + data.screw_wall_mm
    middle = outer - hole
    if min(hypot(middle - x_pin, y_pin) - keep, middle - inner) < hole:
        return 0.0, 0.0
    edges = np.linspace(inner, outer, slices + 1)
    rings = 0.5 * (edges[1:] + edges[:-1])
    width = edges[1] - edges[0]
    reach = np.minimum(free(rings), np.arccos(inner / rings))
    area = float(np.sum(2.0 * rings * reach) * width)
    second = float(np.sum(rings**3 * (reach - np.sin(reach) * np.cos(reach))) * width)
    return area, second


def pin_tilt(force, width, gap, diameter, stiffness, web):
    """Slope of the planet on its pin: two beam elements, clamped at one end, guided without slope at the other.

    ``stiffness`` is that of both meshes against tilting, in N mm per rad; twice ``force`` acts in the middle, and the
    guided end moves against a spring ``web``.
    """
    length = (width + 2.0 * gap) / 2.0
    bending = E_STEEL * pi * diameter**4 / 64.0
    one = (
        bending
        / length**3
        * np.array(
            [
                [12, 6 * length, -12, 6 * length],
                [6 * length, 4 * length**2, -6 * length, 2 * length**2],
                [-12, -6 * length, 12, -6 * length],
                [6 * length, 2 * length**2, -6 * length, 4 * length**2],
            ]
        )
    )
    whole = np.zeros((6, 6))
    whole[:4, :4] += one
    whole[2:, 2:] += one
    whole[3, 3] += stiffness
    whole[4, 4] += web
    free = [2, 3, 4]  # deflection and slope in the middle, deflection at the guided end
    loads = np.array([2.0 * force, 0.0, 0.0])
    return float(np.linalg.solve(whole[np.ix_(free, free)], loads)[1])


def sun_lag(load, width, diameter, planets, slices=500):
    """How far the pitch circle of the sun's far end lags behind that of the driven end, summed slice by slice."""
    polar, shear = pi * diameter**4 / 32.0, E_STEEL / (2.0 * (1.0 + NU_STEEL))
    x = (np.arange(slices) + 0.5) / slices * width
    torque = planets * load * (width - x) * diameter / 2.0
    return float(np.sum(torque / (shear * polar)) * width / slices * diameter / 2.0)


def springs(misalignment_um, stiffness, mean, crowning_um, count=4001):
    """Greatest over mean load of springs side by side along a face whose mate is askew, and stands back at its ends."""
    place = np.linspace(-1.0, 1.0, count)
    gap = misalignment_um * (1.0 - place) / 2.0 + crowning_um * place**2
    tributary = np.ones(count)
    tributary[[0, -1]] = 0.5
    tributary /= tributary.sum()

    def pressed(approach):
        return stiffness * np.maximum(approach - gap, 0.0)

    most = gap.max() + 1.1 * mean / stiffness
    together = bisect(lambda approach: tributary @ pressed(approach) - mean, gap.min(), most)
    loads = pressed(together)
    k = int(np.argmax(loads))
    if loads[k] <= loads[max(k - 1, 0)] or not 0 < k < count - 1:
        return float(loads[k]) / mean
    # The middle of the contact lies between springs: a parabola through the three most loaded ones.
    before, middle, after = loads[k - 1 : k + 2]
    return float(middle - (after - before) ** 2 / 8.0 / (before - 2.0 * middle + after)) / mean


def mesh_loads(sets, data, width, meshes, over=None):
    """K factors of both meshes; ``sets`` holds what the gear set and motor give, ``data`` the settings.

    ``over`` times the peak torque acts once, without K_A and K_V, and also decides its distribution.
    """
    found = []
    for mesh in meshes:
        epsilon = contact_ratio(mesh["pinion"], mesh["wheel"], sets["distance"])
        load = (over or data.application_factor) * sets["sharing"] * sets["force"] / width
        pace = sets["speed"] * mesh["z1"] / 100.0 * sqrt(mesh["u"] ** 2 / (1.0 + mesh["u"] ** 2))
        slope = 2.0 if pace <= 0.2 else max(2.071 - 0.357 * pace, 2.071 - 0.357 * 2.9)
        dynamic = 1.0 + (K1[data.accuracy_class] / max(load, 100.0) + 0.0193) * pace * slope
        dynamic = 1.0 if over else dynamic
        x1, x2 = mesh["pinion"].x, mesh["wheel"].x
        q = 0.04723 + (0.15551 - 0.11654 * x1) / mesh["z1"] - 0.00635 * x1 + 0.00529 * x1**2
        if not mesh["internal"]:
            q += (0.25791 - 0.24188 * x2) / mesh["z2"] - 0.00193 * x2 + 0.00182 * x2**2
        single = 0.8 / q * (1.0 + 0.5 * (1.2 - 1.25)) * min(load / 100.0, 1.0) ** 0.25
        found.append(
            {"K_V": dynamic, "mean": load * dynamic, "stiff": single * (0.75 * epsilon + 0.25), "eps": epsilon}
        )
    both = sum(0.85e3 * one["stiff"] * width**3 / 12.0 for one in found)
    force = 0.5 * (found[0]["mean"] + found[1]["mean"]) * width
    tilt = pin_tilt(force, width, sets["gap"], sets["pin"], both, sets["web"])
    lag = sun_lag(found[0]["mean"], width, sets["module"] * meshes[0]["z1"], sets["planets"])
    for one, mesh, twist in zip(found, meshes, (lag, 0.0), strict=True):
        grade = sqrt(2.0) ** (data.accuracy_class - 5)
        slopes = [
            grade * (0.05 * sqrt(sets["module"] * z) + 0.35 * sqrt(width) + 4.0) for z in (mesh["z1"], mesh["z2"])
        ]
        run_in = sum(
            0.15 if steel.treatment != "through_hardened" else 320.0 / steel.flank_limit_mpa for steel in mesh["steels"]
        )
        left = (1.0 - run_in / 2.0) * (1e3 * (1.33 * twist + tilt * width) + hypot(*slopes))
        one["K_Hb"] = springs(left, 0.85 * one["stiff"], one["mean"], data.planet_crowning_um)
        slender = width / (2.25 * sets["module"])
        one["K_Fb"] = one["K_Hb"] ** (slender**2 / (1.0 + slender + slender**2))
        run_in = sum(
            0.075 if steel.treatment != "through_hardened" else 160.0 / steel.flank_limit_mpa
            for steel in mesh["steels"]
        )
        pitch = grade * (0.001 * sets["module"] * mesh["z2"] + 0.4 * sets["module"] + 5.0) * cos(ALPHA)
        over = one["mean"] * one["K_Hb"]
        uneven = one["stiff"] * (1.0 - run_in / 2.0) * pitch / over
        if one["eps"] > 2.0:
            share = 0.9 + 0.4 * sqrt(2.0 - 2.0 / one["eps"]) * uneven
        else:
            share = one["eps"] / 2.0 * (0.9 + 0.4 * uneven)
        one["K_Ha"] = min(max(share, 1.0), 3.0 / (4.0 - one["eps"]))
        one["K_Fa"] = min(max(share, 1.0), 1.0 / (0.25 + 0.75 / one["eps"]))
    return found


def rate(gears, motor, width, settings, *, ring_wall, sun_bore, standing_at=None):
    """Safety factors by gear and mesh: {(gear, mesh): (S_H, S_F, overload S_H, overload S_F)}, and the K factors.

    ``standing_at`` is the highest level of a duty, over the peak torque. It acts without K_A on gears that stand still.
    """
    data, duty, steels = settings.parts.rating, settings.parts.duty, settings.gear_steels
    zs, zp, zr, module, planets = (
        gears.sun_teeth,
        gears.planet_teeth,
        gears.ring_teeth,
        gears.module_mm,
        gears.planets,
    )
    table = data.load_sharing_fixed if data.sun_support == "fixed" else data.load_sharing_floating
    ratio = 1.0 + zr / zs
    sets = {
        "force": motor.peak_torque_n_m * 1e3 / planets / (module * zs / 2.0),
        "speed": module * zs / 2000.0 * motor.no_load_speed_rad_per_s * (ratio - 1.0) / ratio,
        "sharing": table[planets - 2],
        "module": module,
        "planets": planets,
        "gap": settings.parts.carrier.planet_clearance_mm,
        "pin": settings.parts.carrier.pin_diameter_mm,
    }
    sun, planet, ring, sets["distance"] = drawn(gears)
    planet_bore = settings.parts.gears.planet_bore_mm
    if data.planet_bearing == "needles":
        sets["gap"] = settings.parts.needles.washer_mm + settings.parts.needles.washer_play_mm
        planet_bore = sets["pin"] + 2.0 * settings.parts.needles.diameter_mm
    sets["web"] = 0.0
    if data.second_carrier == "webs":
        radii = [module * value for value in (sets["distance"], planet.tip, ring.tip)]
        sets["web"] = web_stiffness(planets, *radii, settings, width + 2.0 * sets["gap"])
    meshes = [
        {"pinion": sun, "wheel": planet, "steels": (steels.sun, steels.planet)},
        {"pinion": planet, "wheel": ring, "steels": (steels.planet, steels.ring)},
    ]
    for mesh in meshes:
        mesh |= {"z1": mesh["pinion"].teeth, "z2": mesh["wheel"].teeth, "internal": mesh["wheel"].internal}
        mesh["u"] = mesh["z2"] / mesh["z1"]
    loads, overloads = (mesh_loads(sets, data, width, meshes, over) for over in (standing_at, data.overload_factor))
    turns = (ratio - 1.0) / (2.0 * pi)
    passes = {"sun": planets * turns, "planet": turns * zs / zp, "ring": planets * turns * zs / zr}
    bores = {"sun": sun_bore, "planet": planet_bore}
    safety = {}
    for name, mesh, load, over in zip(("sun mesh", "ring mesh"), meshes, loads, overloads, strict=True):
        members = ("sun", "planet") if name == "sun mesh" else ("planet", "ring")
        nominal = sets["sharing"] * sets["force"] / width
        for which, gear in enumerate(members):
            steel, mate = mesh["steels"][which], mesh["steels"][1 - which]
            own, other = (mesh["pinion"], mesh["wheel"]) if which == 0 else (mesh["wheel"], mesh["pinion"])
            thinner = thinning(own.teeth, module, gears.backlash_mm) / module
            form, notch_stress, notch = form_and_notch(own, other, sets["distance"], thinner)
            if gear == "ring":
                rim = ring_wall / module
                y_b = 1.0 if rim >= 3.5 else 1.15 * log(8.324 / rim)
            elif bores[gear] is None:
                y_b = 1.0
            else:
                root = own.teeth / 2.0 + generated(own, gears.backlash_mm / module).x - 1.25
                rim = (module * root - bores[gear] / 2.0) / (2.25 * module)
                y_b = 1.0 if rim >= 1.2 else 1.6 * log(2.242 / rim)
            finish = data.ring_finish_factor if name == "ring mesh" else data.flank_finish_factor
            limits = permissible(gear, steel, mate, passes[gear], notch, notch_stress, data, duty, finish)
            duty_factor = data.application_factor * load["K_V"] * nominal
            if standing_at:  # the permissible stresses of a duty with a level above 1 are for the peak torque
                duty_factor = nominal
            over_factor = data.overload_factor * nominal
            hertz = [
                hertz_load(limit, mesh["pinion"], mesh["wheel"], sets["distance"], module, which == 1)
                for limit in limits[::2]
            ]
            bend = [limit * module / (form * notch_stress * y_b) for limit in limits[1::2]]
            safety[gear, name] = (
                sqrt(hertz[0] / (load["K_Hb"] * load["K_Ha"] * duty_factor)),
                bend[0] / (load["K_Fb"] * load["K_Fa"] * duty_factor),
                sqrt(hertz[1] / (over["K_Hb"] * over["K_Ha"] * over_factor)),
                bend[1] / (over["K_Fb"] * over["K_Fa"] * over_factor),
            )
    return safety, loads


@cache
def haigh(sensitivity, lower_over_upper):
    """Upper stress that is endured at a stress ratio, over the one at a ratio of 0.

    The endured amplitude falls by ``sensitivity`` per unit of mean stress, along a straight line.
    """
    reversed_amplitude = 0.5 + sensitivity * 0.5  # of the line through amplitude 0.5 at mean 0.5

    def spare(upper):
        lower = lower_over_upper * upper
        return reversed_amplitude - sensitivity * (upper + lower) / 2.0 - (upper - lower) / 2.0

    return bisect(spare, 0.01, 2.0)


def mean_stress(steel, notch_stress, levels, back):
    """Y_M of a gear that turns to and fro; loads on the other flank compress the root 1.2 times as much."""
    sides = [
        max([share for (share, _), side in zip(levels, back, strict=True) if side is way], default=0.0)
        for way in (False, True)
    ]
    sensitivity = 0.8 - 0.15 * notch_stress if steel.treatment == "case_hardened" else 0.3
    return haigh(sensitivity, -1.2 * min(sides) / max(sides))


def permissible(gear, steel, mate, passes, notch, notch_stress, data, duty, finish):
    """sigma_HG, sigma_FG, and both against static failure."""
    levels = list(zip(duty.torque_shares, duty.output_angles_rad, strict=True))
    kind = steel.treatment
    highest = max(1.0, max(duty.torque_shares))
    back = duty.reversed or [False] * len(levels)
    # A flank of sun or ring sees one direction, one of a planet both: from the sun, or from the ring.
    seen = [[level for level, side in zip(levels, back, strict=True) if side is way] for way in (False, True)]
    seen = [levels] if gear == "planet" else seen

    def used(what):
        return max(damage_cycles(passes, some, kind, what, duty.jumps, highest) for some in seen)

    z_nt, y_nt = life(kind, "flank", used("flank")) / sqrt(highest), life(kind, "root", used("root")) / highest
    soft = kind == "through_hardened" and mate.treatment != "through_hardened"
    z_w = 1.2 - (steel.hardness_hv - 130.0) / 1700.0 if soft else 1.0
    support = (1.0 + sqrt(steel.slip_layer_mm * 0.2 * (1.0 + 2.0 * notch))) / (
        1.0 + sqrt(steel.slip_layer_mm * 0.2 * 6.0)
    )
    rough = data.root_roughness_um + 1.0
    rough = 4.299 - 3.259 * rough**0.0058 if kind == "nitrided" else 1.674 - 0.529 * rough**0.1
    reversal = data.reversed_bending_factor if gear == "planet" else mean_stress(steel, notch_stress, levels, back)
    if kind == "case_hardened":
        static = 0.44 * notch_stress + 0.12
    elif kind == "nitrided":
        static = 0.20 * notch_stress + 0.60
    else:
        weight = 0.82 * (300.0 / steel.yield_mpa) ** 0.25
        static = (1.0 + weight * (notch_stress - 1.0)) / (1.0 + weight)
    return (
        steel.flank_limit_mpa * z_nt * finish * z_w,
        2.0 * steel.root_limit_mpa * y_nt * support * rough * reversal,
        steel.flank_limit_mpa * STATIC_LIFE[kind, "flank"][1] * z_w,
        2.0 * steel.root_limit_mpa * STATIC_LIFE[kind, "root"][1] * static,
    )

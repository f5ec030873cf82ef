"""Stage 1 once more, as a slow and obvious loop over plain numbers: an oracle for the vectorised search.

The rules are written out again from their sources; only the parts' masses are the package's, one actuator at a time.
"""

from math import acos, atan, ceil, cos, hypot, pi, radians, sin, sqrt

from pareto_monoped.actuator.actuator import build_actuator
from pareto_monoped.actuator.bearings import catalogue
from pareto_monoped.actuator.gearset import GearSet
from tests.actuator.rating import teeth

ALPHA = radians(20.0)
# Shigley, table 14-2.
LEWIS = {18: 0.309, 19: 0.314, 20: 0.322, 21: 0.328, 22: 0.331, 24: 0.337, 26: 0.346, 28: 0.353, 30: 0.359, 34: 0.371}
LEWIS |= {38: 0.384, 43: 0.397, 50: 0.409, 60: 0.422}


def form_factor(teeth):
    below = max(z for z in LEWIS if z <= teeth)
    above = min(z for z in LEWIS if z >= teeth)
    if below == above:
        return LEWIS[below]
    share = (teeth - below) / (above - below)
    return LEWIS[below] * (1 - share) + LEWIS[above] * share


def face_width(motor, sun, ring, module, planets):
    diameter = 1e-3 * module * sun
    force = 2.0 * 2.0 * motor.peak_torque_n_m / diameter / planets
    carrier_speed = motor.no_load_speed_rad_per_s * sun / (sun + ring)
    speed = (motor.no_load_speed_rad_per_s - carrier_speed) * diameter / 2.0
    stress = 400.0 / 1.2
    width = force * (6.1 + speed) / 6.1 / (stress * module * form_factor(sun))
    return max(width, 6.0 * module)


def main_bearing(bore):
    fitting = [row for row in catalogue() if row[0] >= bore - 1e-9]
    return min(fitting, key=lambda row: (row[3], row[0])) if fitting else None


def contact_ratio(z1, z2, internal):
    """From the lengths of approach and recess along the line of action, module 1."""
    base1, base2 = z1 / 2 * cos(ALPHA), z2 / 2 * cos(ALPHA)
    tip1 = z1 / 2 + 1
    recess = sqrt(tip1**2 - base1**2) - z1 / 2 * sin(ALPHA)
    tip2 = z2 / 2 - 1 if internal else z2 / 2 + 1
    along = sqrt(tip2**2 - base2**2) - z2 / 2 * sin(ALPHA)
    approach = -along if internal else along
    return (recess + approach) / (pi * cos(ALPHA))


def allowed(motor, family, sun, planet, ring, module, planets, width):
    """Whether a set obeys every rule, each written out."""
    body = motor.frameless if family == "ISSPG" else motor.framed
    room = (body.stator_inner_diameter_mm if family == "ISSPG" else body.outer_diameter_mm) - 10.0
    depth = 2.25 * module
    rules = [
        ring == sun + 2 * planet,
        (sun + ring) % planets == 0,
        2 * module * (sun + planet) * sin(pi / planets) - 2 * module * planet >= 5.0 - 1e-9,
        sun >= 18,
        planet >= 18,
        module * ring <= room + 1e-9,
        module * (ring + 2.5) <= room + 2e-9,
        module * (planet / 2 - 1.25) - 4.0 >= 1.2 * depth - 1e-9,
        contact_ratio(sun, planet, False) >= 1.2,
        contact_ratio(planet, ring, True) >= 1.2,
    ]
    # The ring's tip circle cuts the line of action beyond the planet's tangent point: angles, not lengths as in rules.
    tip = module * (ring / 2 - 1)
    pressure_at_tip = acos(module * ring / 2 * cos(ALPHA) / tip) if tip > module * ring / 2 * cos(ALPHA) else 0.0
    planet_tangent = atan((ring - planet) / ring * (sin(ALPHA) / cos(ALPHA)))
    rules.append(pressure_at_tip >= planet_tangent - 1e-12)
    bearing = main_bearing(max(module * (sun + planet) + 10.0, 35.0))
    rules.append(bearing is not None)
    if bearing is None or not all(rules):
        return False
    # The ring's diameter is the next tenth of a millimetre.
    ring_mm = ceil(10 * (module * ring + (5.0 if family == "ISSPG" else 6.0)) - 1e-6) / 10
    wall = ring_mm / 2 - module * (ring / 2 + 1.25)
    if family == "ISSPG":
        rules.append(width <= body.stator_height_mm + 1e-9)
        rules.append(bearing[1] / 2 + 2.0 + 7.0 <= body.outer_diameter_mm / 2 + 2.3 + 1e-9)
    else:
        rules.append(module * (sun / 2 - 1.25) - 3.0 >= 1.2 * depth - 1e-9)
        rules.append(bearing[1] / 2 <= ring_mm / 2 - 1.0 + 1e-9)
    rules.append(wall >= 3.5 * module - 1e-9)
    return all(rules)


def allowed_by_iso6336(motor, family, gears, width):
    """The same for a gear set with or without profile shift under the rules ``iso6336``, but for strength."""
    body = motor.frameless if family == "ISSPG" else motor.framed
    room = (body.stator_inner_diameter_mm if family == "ISSPG" else body.outer_diameter_mm) - 10.0
    module, planets = gears.module_mm, gears.planets
    counts = gears.sun_teeth, gears.planet_teeth, gears.ring_teeth
    sun, planet, ring, distance = teeth.shifted(*counts, float(gears.centre_shift), float(gears.sun_shift))
    worth = 2.0 / sin(ALPHA) ** 2
    if sum(counts[::2]) % planets or ring.tip <= ring.base:
        return False
    thinner = max(0.03 * module, 0.017)
    sun_root, planet_root = (
        module * (gear.teeth / 2 + teeth.generated(gear, thinner / module).x - 1.25) for gear in (sun, planet)
    )
    rules = [
        module * ring.teeth <= room + 1e-9,
        module * (ring.teeth + 2 * ring.x + 2.5) <= room + 2e-9,
        planet_root - (3.0 + 1.5) >= 1.2 * 2.25 * module - 1e-9,  # needles of 1.5 mm around a pin of 6 mm
        sun_root >= 3.0 - 1e-9,
        *(gear.teeth + worth * gear.x >= 18 - 1e-9 for gear in (sun, planet)),
    ]
    if family == "ISSPG":
        rules.append(width <= body.stator_height_mm + 1e-9)
    if not all(rules):
        return False
    sun, planet, ring, distance = teeth.drawn(gears)
    rules = [
        4 * module * (distance * sin(pi / planets) - (planet.tip - 1.0)) >= 5.0 - 1e-9,
        teeth.contact_ratio(sun, planet, distance) >= 1.2,
        teeth.contact_ratio(planet, ring, distance) >= 1.2,
        ring.tip >= hypot(ring.base, teeth.line_of_action(planet, ring, distance)) - 1e-9,
    ]
    for gear in (sun, planet):
        thinned = gear.thickness(gear.tip) * module - thinner * gear.tip / (gear.teeth / 2)
        rules.append(thinned >= 0.4 * module - 1e-9)
    bearing = main_bearing(max(2 * module * distance + 10.0, 35.0))
    if bearing is None or not all(rules):
        return False
    if family == "ISSPG" and bearing[1] / 2 + 2.0 + 7.0 > body.outer_diameter_mm / 2 + 2.3 + 1e-9:
        return False
    # The centre of a root's arc, drawn, must lie on its own side of the ring's space.
    root = teeth.root_of(teeth.generated(ring, thinner / module), ring)
    return root.centre(root.end)[0] * module >= -1e-9


def best_in(motor, family, tenths, settings):
    """The lightest set with tenths / 10 <= ratio < (tenths + 1) / 10, and its mass."""
    best = None
    for module in settings.modules_mm:
        for sun in range(18, 60):
            for planet in range(18, 90):
                ring = sun + 2 * planet
                if not tenths * sun <= 10 * (sun + ring) < (tenths + 1) * sun:
                    continue
                for planets in range(2, 8):
                    width = face_width(motor, sun, ring, module, planets)
                    if not allowed(motor, family, sun, planet, ring, module, planets, width):
                        continue
                    gears = GearSet(
                        sun_teeth=sun,
                        planet_teeth=planet,
                        ring_teeth=ring,
                        module_mm=module,
                        planets=planets,
                        backlash_mm=settings.tooth_thinning_mm(module),
                    )
                    mass = build_actuator(motor, family, gears, settings).mass_kg
                    if best is None or mass < best[0]:
                        best = (mass, gears)
    return best

"""A checking engineer's recalculation from the printed sheet of one actuator alone."""

import itertools
import json
import math
import re
from dataclasses import replace

import pytest

from pareto_monoped import cli
from pareto_monoped.actuator.search import map_for
from pareto_monoped.cli.actuator_sheets import print_gear_sheet
from pareto_monoped.cli.terminal import new_console
from pareto_monoped.geometry.gears import ExternalGear, InternalGear
from pareto_monoped.geometry.roles import Group, Role
from tests.actuator.rating.iso6336 import springs

CASES = [("VT8020", "6.0"), ("U8", "7.5"), ("MN8014", "8.0")]


class Range:
    """A printed number with the half of its last digit; products and quotients of positive ones."""

    def __init__(self, low, high):
        self.low, self.high = low, high

    @classmethod
    def of(cls, text):
        digits = len(text.partition(".")[2])
        return cls(float(text) - 0.5 * 10.0**-digits, float(text) + 0.5 * 10.0**-digits)

    def __mul__(self, other):
        other = other if isinstance(other, Range) else Range(other, other)
        ends = [a * b for a, b in itertools.product((self.low, self.high), (other.low, other.high))]
        return Range(min(ends), max(ends))

    def __truediv__(self, other):
        other = other if isinstance(other, Range) else Range(other, other)
        return self * Range(1.0 / other.high, 1.0 / other.low)

    def root(self):
        return Range(math.sqrt(self.low), math.sqrt(self.high))

    def touches(self, other):
        return self.low <= other.high and other.low <= self.high


def printed(capsys, motor, ratio):
    with pytest.raises(SystemExit):
        cli.main(["actuators", "--motor", motor, "--ratio", ratio])
    return capsys.readouterr().out


def rows(text, count):
    """Rows of a table of ``count`` columns of numbers: name -> texts; the unit after a comma does not count."""
    found = {}
    for line in text.splitlines():
        match = re.match(rf" (\S.*?)((?: +-?[0-9][0-9.e+]*){{{count}}}) *$", line)
        if match:
            found[match[1].split(", at least")[0]] = match[2].split()
    return found


def product(*factors):
    result = Range(1.0, 1.0)
    for factor in factors:
        result = result * factor
    return result


@pytest.mark.parametrize(("motor", "ratio"), CASES)
def test_safeties_can_be_recalculated_from_the_printed_sheet_alone(capsys, motor, ratio):
    """ISO 6336-2 and -3 written out; every number is taken from the sheet, with its rounding."""
    text = printed(capsys, motor, ratio)
    assert max(len(line) for line in text.splitlines()) <= 80
    b = Range.of(re.search(r"face width, length +([0-9.]+) mm", text)[1])
    module = float(re.search(r" m ([0-9.]+) x", text)[1])
    highest = float(re.search(r"highest level +([0-9.]+) times", text)[1])
    y_st = float(re.search(r"Y_ST +([0-9.]+)", text)[1])
    mesh_rows, gear_rows = (
        rows(text.partition("Bearings after")[0].partition("stress and safety")[0], 2),
        rows(text.partition("Bearings after")[0].partition("stress and safety")[2], 4),
    )
    for column in range(4):
        mesh = {name: Range.of(values[column // 2]) for name, values in mesh_rows.items()}
        gear = {name: Range.of(values[column]) for name, values in gear_rows.items() if "cycles" not in name}
        u, sign = mesh["gear ratio u"], -1.0 if column >= 2 else 1.0
        curvature = Range(min((x + sign) / x for x in (u.low, u.high)), max((x + sign) / x for x in (u.low, u.high)))
        load = (
            product(
                mesh["tangential force F_t, N"],
                mesh["application K_A"],
                mesh["load sharing K_gamma"],
                mesh["dynamic K_V"],
            )
            / b
        )
        flank = product(load, mesh["face load, flank K_Hbeta"], mesh["transverse load, flank K_Halpha"])
        stress = product(
            mesh["zone Z_H"],
            mesh["elasticity Z_E, sqrt(MPa)"],
            mesh["contact ratio Z_epsilon"],
            gear["single contact Z_B, Z_D"],
            (flank / mesh["reference diameter d_1, mm"] * curvature).root(),
        )
        limit = product(
            gear["strength sigma_H,lim, MPa"],
            gear["life Z_NT"],
            gear["finish Z_L Z_v Z_R"],
            gear["work hardening Z_W"],
            1.0 / math.sqrt(highest),
        )
        assert stress.touches(gear["contact stress sigma_H, MPa"])
        assert limit.touches(gear["limit sigma_HG, MPa"])
        assert (limit / stress).touches(gear["S_H"])
        assert (limit / stress).high / (limit / stress).low < 1.01
        root = product(load, mesh["face load, root K_Fbeta"], mesh["transverse load, root K_Falpha"])
        bending = product(root / module, gear["form Y_F"], gear["stress correction Y_S"], gear["rim Y_B"])
        bears = product(
            gear["strength sigma_F,lim, MPa"],
            y_st,
            gear["life Y_NT"],
            gear["notch Y_delta,rel,T"],
            gear["roughness Y_R,rel,T"],
            gear["mean stress Y_M"],
            1.0 / highest,
        )
        assert bending.touches(gear["bending stress sigma_F, MPa"])
        assert bears.touches(gear["limit sigma_FG, MPa"])
        assert (bears / bending).touches(gear["S_F"])
        assert (bears / bending).high / (bears / bending).low < 1.02


@pytest.mark.parametrize(("motor", "ratio"), CASES)
def test_static_safeties_can_be_recalculated_from_the_printed_sheet_alone(capsys, motor, ratio):
    """ISO 6336-2 and -3 with static limits: finish, roughness and mean stress are 1, and so are K_A and K_V."""
    text = printed(capsys, motor, ratio)
    b = Range.of(re.search(r"face width, length +([0-9.]+) mm", text)[1])
    module = float(re.search(r" m ([0-9.]+) x", text)[1])
    over = float(re.search(r"overload +([0-9.]+) times", text)[1])
    y_st = float(re.search(r"Y_ST +([0-9.]+)", text)[1])
    loads, _, stresses = text.partition("Bearings after")[0].partition("stress and safety")
    mesh_rows, gear_rows = rows(loads, 2), rows(stresses, 4)
    for column in range(4):
        mesh = {name: Range.of(values[column // 2]) for name, values in mesh_rows.items()}
        gear = {name: Range.of(values[column]) for name, values in gear_rows.items() if "cycles" not in name}
        u, sign = mesh["gear ratio u"], -1.0 if column >= 2 else 1.0
        curvature = Range(min((x + sign) / x for x in (u.low, u.high)), max((x + sign) / x for x in (u.low, u.high)))
        load = product(mesh["tangential force F_t, N"], mesh["load sharing K_gamma"], over) / b
        flank = product(load, mesh["overload, flank K_Hbeta"], mesh["overload, flank K_Halpha"])
        stress = product(
            mesh["zone Z_H"],
            mesh["elasticity Z_E, sqrt(MPa)"],
            mesh["contact ratio Z_epsilon"],
            gear["single contact Z_B, Z_D"],
            (flank / mesh["reference diameter d_1, mm"] * curvature).root(),
        )
        limit = product(gear["strength sigma_H,lim, MPa"], gear["overload, life Z_NT"], gear["work hardening Z_W"])
        assert (limit / stress).touches(gear["S_H at overload"])
        assert (limit / stress).high / (limit / stress).low < 1.01
        root = product(load, mesh["overload, root K_Fbeta"], mesh["overload, root K_Falpha"])
        bending = product(root / module, gear["form Y_F"], gear["stress correction Y_S"], gear["rim Y_B"])
        bears = product(
            gear["strength sigma_F,lim, MPa"],
            y_st,
            gear["overload, life Y_NT"],
            gear["overload, notch Y_delta,rel,T"],
        )
        assert (bears / bending).touches(gear["S_F at overload"])
        assert (bears / bending).high / (bears / bending).low < 1.02


@pytest.mark.parametrize(("motor", "ratio"), CASES[:2])
def test_load_factors_can_be_recalculated_too(capsys, motor, ratio):
    """K_Hbeta and K_Halpha from stiffness, misalignment, crowning and pitch deviation (ISO 6336-1, 7.3.2 and 8.3.2)."""
    text = printed(capsys, motor, ratio)
    b = float(re.search(r"face width, length +([0-9.]+) mm", text)[1])
    crowning = float(re.search(r"crowning +([0-9.]+) um, of the planets", text)[1])
    found = rows(text.partition("stress and safety")[0], 2)
    for column in range(2):
        mesh = {name: float(values[column]) for name, values in found.items()}
        load = math.prod(
            mesh[name] for name in ("tangential force F_t, N", "application K_A", "load sharing K_gamma", "dynamic K_V")
        )
        stiff = mesh["stiffness c_gamma, N/(mm um)"]
        k_face = springs(mesh["misalignment F_beta,y, um"], 0.85 * stiff, load / b, crowning)
        assert mesh["face load, flank K_Hbeta"] == pytest.approx(k_face, rel=1e-3)
        contact = mesh["contact ratio epsilon_alpha"]
        uneven = 0.4 * stiff * mesh["pitch f_pb less running in, um"] / (load / b * k_face)
        free = (
            0.5 * contact * (0.9 + uneven)
            if contact <= 2.0
            else 0.9 + uneven * math.sqrt(2.0 * (contact - 1.0) / contact)
        )
        most = 3.0 / (4.0 - contact)
        assert mesh["transverse load, flank K_Halpha"] == pytest.approx(min(max(free, 1.0), most), rel=1e-3)


def test_tips_roots_and_the_gap_of_the_planets_are_those_of_the_drawn_parts():
    actuator = map_for("VT8020", "iso6336").lookup(6.0)
    shapes = {}
    for part in actuator.parts:
        for prism in part.prisms if part.role is Role.GEAR else ():
            for shape in (prism.outline, *prism.holes):
                if isinstance(shape, ExternalGear | InternalGear) and float(shape.backlash_mm) > 0.0:
                    shapes[{Group.ROTOR: "sun", Group.PLANET: "planet", Group.HOUSING: "ring"}[part.group]] = shape
    for gear in actuator.rating.gears:
        shape = shapes[gear.gear]
        assert gear.tip_diameter_mm == pytest.approx(2.0 * shape.tip_radius_mm)
        assert gear.root_diameter_mm == pytest.approx(2.0 * shape.root_radius_mm)
        assert gear.tip_thickness_mm == pytest.approx(float(shape.tip_thickness_mm))
    (planet,) = (part for part in actuator.parts if part.role is Role.GEAR and part.group is Group.PLANET)
    apart = 2.0 * planet.pitch_radius_mm * math.sin(math.pi / planet.count)
    assert actuator.rating.planet_gap_mm == pytest.approx(apart - 2.0 * shapes["planet"].tip_radius_mm)


def test_teeth_and_spaces_of_a_ring_make_its_pitch_on_the_tip_circle():
    """A space of a ring is a tooth of the external gear of the same data, thicker by the backlash."""
    ring = InternalGear(teeth=90, module_mm=0.6, backlash_mm=0.04, shift=0.3)
    twin = ExternalGear(teeth=90, module_mm=0.6, backlash_mm=-0.04, shift=0.3, tip_shortening=2.0)
    assert twin.tip_radius_mm == pytest.approx(ring.tip_radius_mm)
    pitch = 2.0 * math.pi * ring.tip_radius_mm / 90
    assert float(ring.tip_thickness_mm) == pytest.approx(pitch - float(twin.tip_thickness_mm))


@pytest.mark.parametrize(
    ("motor", "words"),
    [
        ("U8", ("assumed, 1.44 times the continuous one", "rated by maker", "17.9 s from cold", "7.83 N m")),
        ("VT8020", ("published", "rated by maker", "time not known")),
    ],
)
def test_torques_say_what_they_are_and_for_how_long(capsys, motor, words):
    text = printed(capsys, motor, "7.5")
    head = text.partition("no-load speed")[0]
    for word in words:
        assert word in head
    assert head.count("before losses") == 2
    assert ("torque, lasting" in head) == (motor == "U8")
    with pytest.raises(SystemExit):
        cli.main(["actuators", "--motor", motor, "--ratio", "7.5", "--json"])
    known = json.loads(capsys.readouterr().out)
    assert known["continuous_torque_time"] in words
    assert (known["lasting_torque_n_m"] is None) == (motor == "VT8020")
    (rotor,) = (part for part in known["parts"] if part["name"] == "motor_rotor")
    assert rotor["axial_inertia_kg_m2"] == known["motor"]["rotor_inertia_kg_m2"]
    assert f"{1e6 * rotor['axial_inertia_kg_m2']:.2f} kg mm2, of the motor alone" in text
    (line,) = (line for line in text.splitlines() if line.startswith(" motor_rotor "))
    assert line.split()[-1] == f"{1e6 * rotor['axial_inertia_kg_m2']:.2f}"


LOADS = (
    "tangential_force_n", "pitch_speed_m_per_s", "pinion_diameter_mm", "gear_ratio", "contact_ratio",
    "mesh_stiffness_n_per_mm_um", "misalignment_um", "pitch_deviation_um", "application_factor", "sharing_factor",
    "dynamic_factor", "face_load_factor", "root_face_load_factor", "transverse_load_factor",
    "root_transverse_load_factor", "overload_face_load_factor", "overload_root_face_load_factor",
    "overload_transverse_load_factor", "overload_root_transverse_load_factor", "zone_factor", "elasticity_factor",
    "contact_ratio_factor",
)  # fmt: skip
STRESSES = (
    "tip_diameter_mm", "form_diameter_mm", "root_diameter_mm", "tip_thickness_mm", "single_contact_factor",
    "flank_cycles", "flank_life_factor", "contact_number_mpa", "finish_factor", "work_hardening_factor",
    "contact_stress_mpa", "contact_limit_mpa", "flank_safety", "static_flank_life_factor", "overload_flank_safety",
    "form_factor", "stress_correction", "rim_factor", "root_cycles", "root_life_factor", "bending_number_mpa",
    "notch_sensitivity_factor", "roughness_factor", "mean_stress_factor", "bending_stress_mpa", "bending_limit_mpa",
    "root_safety", "static_root_life_factor", "static_notch_factor", "overload_root_safety",
)  # fmt: skip
"""What the rows of the sheet show, from above."""


def test_every_cell_of_the_sheet_is_the_quantity_of_its_row_and_gear():
    """Of numbers that differ in two digits everywhere: those of real gears do not, such as the cycles of two roots."""
    settings, rating = map_for("VT8020").settings, map_for("VT8020").lookup(6.0).rating

    def numbered(record, names, place):
        return replace(record, **{name: 10.0**place * (11 + k) for k, name in enumerate(names)})

    sun, on_sun, on_ring, ring = (numbered(gear, STRESSES, k) for k, gear in enumerate(rating.gears))
    sun_mesh = numbered(replace(rating.sun_mesh, pinion=sun, wheel=on_sun), LOADS, 0)
    ring_mesh = numbered(replace(rating.ring_mesh, pinion=on_ring, wheel=ring), LOADS, 1)
    console = new_console(width=80)
    with console.capture() as sheet:
        print_gear_sheet(console, replace(rating, sun_mesh=sun_mesh, ring_mesh=ring_mesh), settings)
    loads, stresses = sheet.get().split("stress and safety")
    for text, names, count in ((loads, LOADS, 2), (stresses, STRESSES, 4)):
        cells = [list(map(float, row)) for row in rows(text, count).values()]
        assert cells == [[10.0**place * (11 + k) for place in range(count)] for k in range(len(names))]

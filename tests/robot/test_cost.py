"""The rough cost: by hand from the rates, monotone, paid by every part, and the same for populations."""

from dataclasses import asdict, replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pareto_monoped.actuator.actuator import build_actuator
from pareto_monoped.actuator.motors import load_motor, motor_names
from pareto_monoped.actuator.ratiomap import JointMaps
from pareto_monoped.actuator.search import map_for
from pareto_monoped.config import read_shipped
from pareto_monoped.design import NAMES, PAPER_CASES
from pareto_monoped.errors import InputError
from pareto_monoped.geometry.features import Hole, Mouth, bored
from pareto_monoped.geometry.gears import ExternalGear
from pareto_monoped.geometry.making import Fit
from pareto_monoped.geometry.parts import Ball, Part, disc, layer, machined_part, sheet_part, steel_part
from pareto_monoped.geometry.roles import Role
from pareto_monoped.geometry.shapes import Circle, Pattern, rectangle
from pareto_monoped.materials import ALLOYS, GEAR_GRADES, MATERIALS
from pareto_monoped.robot.build import build_robot
from pareto_monoped.robot.cost import RATES, part_cost, rates_of, robot_cost
from pareto_monoped.robot.population import robot_arrays

C = PAPER_CASES["C"].design


def spacer(radius=20.0, length=10.0, bore=5.0, **more):
    prisms = (disc(radius, 0.0, length, Circle(radius_mm=bore)),)
    return machined_part(name="spacer", role=Role.SPACER, prisms=prisms, **more)


def plate(width=100.0, height=60.0, thickness=3.0, **more):
    holes = (Circle(radius_mm=2.0, x_mm=30.0), Circle(radius_mm=2.0, x_mm=-30.0))
    outline = rectangle(width_mm=width, height_mm=height)
    return sheet_part(name="plate", role=Role.PLATE, prisms=(layer(outline, 0.0, thickness, *holes),), **more)


def printed(side=20.0, **more):
    cube = layer(rectangle(width_mm=side, height_mm=side), 0.0, side)
    return Part(
        name="core",
        role=Role.CORE,
        material=MATERIALS.printed_plastic,
        process="3D printed",
        prisms=(cube,),
        **more,
    )


def foot(radius=10.0, **more):
    ball = Ball(radius_mm=radius, y_mm=0.0, top_mm=radius)
    return Part(
        name="foot", role=Role.FOOT, material=MATERIALS.rubber, process="moulded", prisms=(), balls=(ball,), **more
    )


def bearing(radius=16.0, **more):
    prisms = (disc(radius, 0.0, 7.0, Circle(radius_mm=10.0)),)
    return steel_part(name="bearing", role=Role.BEARING, prisms=prisms, **more)


def gear(width=8.0, teeth=20, **more):
    outline, bore = ExternalGear(teeth=teeth, module_mm=1.0), Circle(radius_mm=4.5)
    return Part(
        name="gear",
        role=Role.GEAR,
        material=MATERIALS.gear_steel,
        process="machined",
        prisms=(layer(outline, 0.0, width, bore),),
        grade=GEAR_GRADES["case_hardened_18crnimo7_6"],
        fits=(Fit(diameter_mm=9.0, zone="F7", raceway=True),),
        **more,
    )


EVERY = (spacer, plate, printed, foot, bearing, gear)


def test_a_turned_spacer_by_hand():
    """A ring of 40 x 10 mm with a bore of 10 H7, in aluminium of 2.71 g/cm3, by the rates of data/cost.toml.

    Bar 44 mm, cut at 14 mm: pi 22^2 14 = 21287.43 mm3, 57.689 g at 12 EUR/kg: 0.692. The part has pi (400 - 25) 10 =
    11780.97 mm3, so 9.50646 cm3 at 12 cm3/min take 0.79221 min. Two clampings of 4, a layer of 3, a hole of 0.5 and a
    fit of 6 min: 18.29221 min at 75 EUR/h: 22.8653. Once 10 + 6 + 2 x 30 = 76 min: 95.00.
    """
    cost = part_cost(spacer(fits=(Fit(diameter_mm=10.0, zone="H7"),)))
    assert cost.material_eur == pytest.approx(0.69227, abs=1e-4)
    assert cost.total_eur == pytest.approx(0.69227 + 22.86526 + 95.0, abs=1e-3)
    assert cost.hours == pytest.approx((18.29221 + 76.0) / 60.0, abs=1e-6)
    assert (cost.made, cost.bought, cost.once_eur) == (1, 0, 95.0)


def test_two_laser_cut_plates_by_hand():
    """Each 100 x 60 x 3 mm with two holes of 4 mm, one of them countersunk.

    Sheet 110 x 70 x 3 = 23100 mm3, 62.601 g at 12 EUR/kg: 0.75121. Walls (320 + 2 x 12.56637) x 3 = 1035.398 mm2 at
    10000 mm2/min and 120 EUR/h: 0.20708. A countersink of 0.5 min at 75 EUR/h: 0.625. Once 15 min at 120 EUR/h: 30.
    """
    sink = Hole(
        shapes=(Circle(radius_mm=2.0, x_mm=30.0),),
        low_mm=0.0,
        high_mm=3.0,
        high=Mouth.at_90_degrees(3.5, 2.0),
    )
    cost = part_cost(plate(features=(sink,), places_mm=((0.0, 0.0, 0.0), (0.0, 0.0, 30.0))))
    assert cost.total_eur == pytest.approx(2.0 * (0.75121 + 0.20708 + 0.625) + 30.0, abs=1e-4)
    assert cost.made == 2


def test_three_hardened_gears_by_hand():
    """20 teeth of module 1, 8 mm wide, bore 9 F7 ground.

    Bar of 22 + 4 mm, 8 + 4 mm long: pi 13^2 12 = 6371.15 mm3 at 7850 kg/m3 and 8 EUR/kg: 0.40011. What is left is the
    part's volume V. Roughing (6371.15 - V) / 1000 / 2.5 min, 2 x 4 + 3 + 0.5 = 11.5 min, at 75 EUR/h. Teeth 20 (0.4 +
    0.02 x 8) = 11.2 min at 100 EUR/h: 18.6667. Ground bore 15 min at 90 EUR/h: 22.5. Hardening 5 EUR/kg. Once 76 min at
    75, 180 min at 100, 60 min at 90 EUR/h and a lot of 80 EUR: 95 + 300 + 90 + 80 = 565.
    """
    part = gear(count=3, pitch_radius_mm=20.0)
    volume = float(part.volume_mm3())
    assert 1800.0 < volume < 2200.0
    roughing_min = (6371.15 - volume) / 1000.0 / 2.5
    one = 0.40011 + (roughing_min + 11.5) * 1.25 + 18.66667 + 22.5 + volume * 7.85e-6 * 5.0
    cost = part_cost(part)
    assert cost.total_eur == pytest.approx(3.0 * one + 565.0, abs=2e-3)
    assert cost.made == 3


def test_what_is_printed_moulded_and_bought_by_hand():
    """8 cm3 of 1.43 g/cm3 at 25 EUR/kg, 8 / 14 h at 4 EUR/h, once 30 min at 75 EUR/h; the others likewise.

    A ball of 20 mm has 4188.79 mm3 of rubber, 1.15 g/cm3 or so. A bearing of 32 mm costs 2 + 0.22 x 32.
    """
    assert part_cost(printed()).total_eur == pytest.approx(0.286 + 2.285714 + 37.5, abs=1e-5)
    kg = 4188.79e-9 * MATERIALS.rubber.density_kg_per_m3
    assert part_cost(foot()).total_eur == pytest.approx(kg * 25.0 + 0.5 * 75.0 + 75.0 + 60.0, abs=1e-5)
    assert part_cost(bearing(count=2)).total_eur == pytest.approx(18.08)
    assert part_cost(bearing(count=2)).bought == 2
    assert part_cost(bearing(catalogue_price_eur=7.5)).total_eur == 7.5


@given(size=st.floats(8.0, 60.0), grown=st.floats(1.0, 3.0))
def test_a_larger_part_costs_more(size, grown):
    larger = size * grown
    rounded = 1.0 - 1e-12  # equal costs are sums in another order
    assert part_cost(spacer(larger)).total_eur >= rounded * part_cost(spacer(size)).total_eur
    assert part_cost(spacer(length=larger)).total_eur >= rounded * part_cost(spacer(length=size)).total_eur
    assert part_cost(plate(thickness=larger)).total_eur >= rounded * part_cost(plate(thickness=size)).total_eur
    assert part_cost(plate(width=larger + 70.0)).total_eur >= rounded * part_cost(plate(width=size + 70.0)).total_eur
    assert part_cost(printed(larger)).total_eur >= rounded * part_cost(printed(size)).total_eur
    assert part_cost(foot(larger)).total_eur >= rounded * part_cost(foot(size)).total_eur
    assert part_cost(gear(larger)).total_eur >= rounded * part_cost(gear(size)).total_eur
    assert part_cost(bearing(larger + 3.0)).total_eur >= rounded * part_cost(bearing(size + 3.0)).total_eur
    bolt = steel_part(name="bolt", role=Role.BOLT, prisms=(disc(2.0, 0.0, 9.0),), catalogue_mass_kg=1e-4 * size)
    assert part_cost(replace(bolt, catalogue_mass_kg=1e-4 * larger)).total_eur >= rounded * part_cost(bolt).total_eur


@given(count=st.integers(0, 20), more=st.integers(1, 20), kind=st.sampled_from(EVERY))
def test_one_more_of_it_costs_more(count, more, kind):
    few, many = part_cost(kind(count=count)), part_cost(kind(count=count + more))
    assert many.total_eur > few.total_eur
    assert many.hours >= few.hours
    assert many.made + many.bought == few.made + few.bought + more
    assert (few.total_eur > 0.0) == (count > 0)


def test_one_more_feature_costs_more():
    plain = part_cost(spacer()).total_eur
    hole = bored(Circle(radius_mm=5.0), 0.0, 10.0, enters="both")
    # Its two chamfers of 0.3 mm are 3 mm3 more to cut away.
    assert part_cost(spacer(features=(hole,))).total_eur == pytest.approx(plain + 0.5 / 60.0 * 75.0, abs=1e-3)
    one = Fit(diameter_mm=10.0, zone="H7")
    assert part_cost(spacer(fits=(one,))).total_eur == pytest.approx(plain + 6.0 / 60.0 * 75.0)
    ground = part_cost(spacer(fits=(replace(one, raceway=True),))).total_eur
    assert ground > plain + 100.0
    # Six holes of 3 mm beside the bore, through 10 mm: 3 min, and 424.115 mm3 at 12 cm3/min.
    pattern = Pattern(radius_mm=1.5, pitch_radius_mm=12.0, count=6)
    drilled = replace(spacer(), prisms=(disc(20.0, 0.0, 10.0, Circle(radius_mm=5.0), pattern),))
    assert 60.0 * (part_cost(drilled).hours - part_cost(spacer()).hours) == pytest.approx(3.0 + 0.035343, abs=1e-5)
    stepped = replace(spacer(), prisms=(disc(20.0, 0.0, 4.0, Circle(radius_mm=5.0)), disc(20.0, 4.0, 10.0)))
    assert part_cost(stepped).hours > part_cost(spacer()).hours + (3.0 + 6.0 - 1.0) / 60.0


def test_parts_that_compare_equal_but_are_made_otherwise_are_priced_for_themselves():
    """Grade and fits are left out when parts are compared."""
    hard, soft = gear(), replace(gear(), grade=ALLOYS["c45_qt"], fits=())
    assert hard == soft
    assert part_cost(hard).total_eur > part_cost(soft).total_eur + 100.0


def test_a_batch_shares_set_ups():
    ten = replace(RATES, robots=10)
    one = part_cost(spacer())
    assert part_cost(spacer(), rates=ten).total_eur == pytest.approx(one.total_eur - 0.9 * one.once_eur)


def test_arrays_are_the_parts_one_by_one():
    """Sizes, counts and places of a population."""
    sizes, counts = np.array([9.0, 14.5, 33.0]), np.array([0.0, 1.0, 4.0])
    for kind in (spacer, printed, foot, gear, bearing):
        size = sizes + 5.0 if kind is bearing else sizes
        together = part_cost(kind(size, count=counts))
        for i in range(3):
            alone = part_cost(kind(float(size[i]), count=int(counts[i])))
            for name in ("total_eur", "material_eur", "hours"):
                found = np.broadcast_to(getattr(together, name), 3)[i]
                assert found == pytest.approx(getattr(alone, name), rel=1e-12, abs=1e-12), (kind, name)


def leaves(values, path=()):
    for key, value in values.items():
        yield from leaves(value, (*path, key)) if isinstance(value, dict) else [((*path, key), value)]


def changed(path, factor):
    values = read_shipped("cost.toml", what="cost rates")
    table = values
    for key in path[:-1]:
        table = table[key]
    table[path[-1]] = type(table[path[-1]])(table[path[-1]] * factor)
    return rates_of(values)


def parts_of(kits):
    """The parts of robots of these motors and of every gearbox."""
    found = []
    for motor, rules in kits:
        gearboxes = map_for(motor, rules)
        found += [part for entry in gearboxes.entries if entry.actuator for part in entry.actuator.parts]
        robot = build_robot(C.replace({"hip_ratio": 5.0, "knee_ratio": 6.0}), gearboxes)
        found += [part for unit in robot.units for part in unit.parts]
    return list({id(part): part for part in found}.values())


EVERY_TIME = [("U8", "iso6336"), ("MN8014", "iso6336"), ("VT8020", "iso6336"), ("VT8020", "paper")]
OTHERS = [(motor, "iso6336") for motor in motor_names() if (motor, "iso6336") not in EVERY_TIME]


@pytest.fixture(scope="module")
def shipped_parts():
    return parts_of(EVERY_TIME)


@pytest.mark.parametrize("kits", [None, pytest.param(OTHERS, marks=pytest.mark.long)], ids=["some", "others"])
def test_no_shipped_part_is_without_a_cost(shipped_parts, kits):
    parts = shipped_parts if kits is None else parts_of(kits)
    assert len(parts) > 2000
    for part in parts:
        cost = part_cost(part)
        assert np.isfinite(cost.total_eur)
        assert cost.total_eur > 0.0, part.name
        assert cost.made + cost.bought == part.count * len(part.places_mm)
        if part.process == "bought":
            assert RATES.price_class(part) is not RATES.bought["other"], part.name
        else:
            assert part.material.name.replace(" ", "_") in RATES.materials, part.name


NOT_CUT = {("materials", name, "removal_cm3_per_min") for name in ("printed_plastic", "rubber")}
FASTER = {"robots", "removal_cm3_per_min", "cut_mm2_per_min", "cm3_per_h"}


@pytest.mark.parametrize("path", [path for path, _ in leaves(asdict(RATES))], ids=lambda path: ".".join(map(str, path)))
def test_every_rate_is_paid(shipped_parts, path):
    """Twice a rate costs more, or less where it says how fast or how many."""
    if path in NOT_CUT or path[:2] == ("bought", "other") or dict(leaves(asdict(RATES)))[path] == 0.0:
        return
    some = [shipped_parts[::97], shipped_parts[-140:]]
    before, after = robot_cost(some).total_eur, robot_cost(some, changed(path, 2)).total_eur
    assert after < before if path[-1] in FASTER else after > before


@pytest.mark.parametrize(("hip", "knee"), [("U8", "U8"), ("U12", "MN8014")])
def test_a_population_costs_what_its_robots_cost(hip, knee):
    """Equal ratios, which share set-ups if the motors are equal, too; others; and links beyond the tables."""
    maps = JointMaps(hip=map_for(hip), knee=map_for(knee))
    designs = [C.replace({"hip_ratio": 5.0, "knee_ratio": ratio, "shank_length_m": 0.33}) for ratio in (5.0, 6.0)]
    designs.append(designs[0].replace({"thigh_length_m": 0.2, "shank_length_m": 0.7}))
    arrays = robot_arrays(np.stack([one.as_array() for one in designs]), maps)
    for i, design in enumerate(designs):
        cost = build_robot(design, maps).cost
        assert arrays.cost_eur[i] == pytest.approx(cost.total_eur, rel=1e-12)
        assert (arrays.made_parts[i], arrays.bought_parts[i]) == (cost.made, cost.bought)


def test_a_cost_is_the_same_to_the_last_bit_in_any_company(actuator_map, designs):
    everyone = robot_arrays(designs, actuator_map).cost_eur
    assert len(set(everyone)) == len(designs)
    for rows in ([3], [3, 1], [*range(len(designs) - 1, -1, -1)]):
        assert np.array_equal(robot_arrays(designs[rows], actuator_map).cost_eur, everyone[rows])


def test_equal_gearboxes_share_their_set_ups(actuator_map):
    """Each kind of part of two gearboxes of one ratio is set up once."""
    robot = build_robot(C.replace({"hip_ratio": 5.0, "knee_ratio": 5.0}), actuator_map)
    apart = sum(part_cost(part).total_eur for unit in robot.units for part in unit.parts)
    once = sum(part_cost(part).once_eur for part in robot.hip.parts)
    assert once > 2000.0
    assert robot.cost.total_eur == pytest.approx(apart - once, rel=1e-12)


def test_longer_links_cost_more(actuator_map):
    lengths = np.linspace(0.25, 0.55, 31)
    for name in ("thigh_length_m", "shank_length_m"):
        rows = np.repeat(C.as_array()[None], len(lengths), axis=0)
        rows[:, NAMES.index(name)] = lengths
        assert np.all(np.diff(robot_arrays(rows, actuator_map).cost_eur) > 0.0)


def test_a_motor_s_own_price_goes_before_its_class():
    known = load_motor("U8")
    priced = replace(known, name="priced", price_eur=1000.0)
    gearboxes = map_for("U8", "iso6336")
    gears = gearboxes.lookup(5.0).gears
    by_class, own = (
        robot_cost([build_actuator(motor, "ISSPG", gears, gearboxes.settings).parts]).total_eur
        for motor in (known, priced)
    )
    # U8 without its frame has 0.14 kg: 2 x 80 + 0.14 x 400 = 216 EUR by its class.
    assert own - by_class == pytest.approx(1000.0 - 216.0)


@pytest.mark.parametrize(
    ("path", "value", "words"),
    [
        (("machining", "hour_eur"), -75.0, "machining.hour_eur = -75.0: must be above 0; correct it"),
        (("machining", "setups"), 0, "machining.setups = 0: must be at least 1; correct it"),
        (("machining", "hour_usd"), 75.0, "unknown key 'machining.hour_usd'; remove it"),
        (("bought", "screw", "each_eur"), "cheap", "bought.screw.each_eur = 'cheap': must be a number; correct it"),
        (("laser", "cut_mm2_per_min"), float("nan"), "laser.cut_mm2_per_min = nan: must be"),
        (("gears", "tooth_min"), None, "gears.tooth_min is missing; add it"),
        (("materials", "steel"), None, "materials.steel is missing, which stands for all materials without rates"),
        (("bought", "other"), None, "bought.other is missing, which stands for all bought parts without rates"),
    ],
)
def test_a_wrong_rate_is_refused_in_one_line(path, value, words):
    values = read_shipped("cost.toml", what="cost rates")
    table = values
    for key in path[:-1]:
        table = table[key]
    if value is None:
        del table[path[-1]]
    else:
        table[path[-1]] = value
    with pytest.raises(InputError) as error:
        rates_of(values)
    assert str(error.value).startswith(f"cost rates: {words}")
    assert "\n" not in str(error.value)


def test_every_rate_of_the_file_says_where_it_comes_from():
    """A source in brackets, "our own choice", or the name of what it goes with, on its line or above its tables."""
    lines = read_text().splitlines()
    bought = next(k for k, line in enumerate(lines) if line.startswith("# Stock"))
    for line in lines[:bought]:
        if "=" in line and not line.startswith("#"):
            assert any(words in line for words in ("our own choice", "[1]", "[2]", "tooth_min")), line
    assert "our own choice" in "\n".join(lines[bought:]).lower()


def read_text():
    from importlib import resources

    return (resources.files("pareto_monoped") / "data" / "cost.toml").read_text(encoding="utf-8")

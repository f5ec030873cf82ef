"""The program of a design: alone it makes the same solids, and its drivers change what they name."""

import ast
import csv
import importlib
import inspect
import io
import math
import random
import re
import subprocess
import sys
from collections import Counter
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
import shapely
from scipy.spatial import cKDTree

from pareto_monoped.actuator.motors import motor_names
from pareto_monoped.cad.as_built import built_of
from pareto_monoped.cad.jobs import case_job
from pareto_monoped.cad.product import build_product
from pareto_monoped.cad.shape.outlines import centres_mm
from pareto_monoped.cad.write.drivers import _MODULES
from pareto_monoped.cad.write.formulas import Traced
from pareto_monoped.cad.write.living import living_model
from pareto_monoped.design import RULE_SETS
from pareto_monoped.geometry.shapes import Circle, Pattern
from pareto_monoped.robot.build import build_robot
from tests.lazily import Lazily
from tests.records import compare, signature

bd = Lazily("build123d")
kernel = Lazily("pareto_monoped.cad.kernel.solids")

VOLUME = 1e-4  # 0.01 percent
SOME = (
    "thigh_plate_inner",
    "hip_actuator_ring",
    "hip_actuator_planet",
    "base_rod",
    "foot",
    "drive_sprocket",
    "hip_mount_screw",
)


@pytest.fixture(scope="module")
def living(product, actuator_map):
    return living_model(product, actuator_map)


def run(living, **changes):
    """The names of the program, run with other drivers."""
    names = {"__name__": "model", "__file__": "model.py", "CHANGES": changes}
    exec(living.program.replace("given(globals())", "globals().update(CHANGES)"), names)  # noqa: S102
    return names


@pytest.fixture(scope="module")
def names(living):
    """Those of the program as it is."""
    return run(living)


def test_the_hull_of_discs_is_that_of_their_centres_grown_by_their_radius(names):
    """The stand's plates have such outlines, which few robots have."""
    centres = np.random.default_rng(3).uniform(-40.0, 40.0, (9, 2)).tolist()
    (pieces,) = names["rounded_hull"]([tuple(centre) for centre in centres], 5.0)
    corners = []
    for kind, *numbers in pieces:
        if kind == "arc":
            x, y, radius, start, end = numbers
            turns = np.linspace(start, end, 200)
            corners += np.column_stack((x + radius * np.cos(turns), y + radius * np.sin(turns))).tolist()
        else:
            corners += [numbers[:2], numbers[2:]]
    wanted = shapely.MultiPoint(centres).convex_hull.buffer(5.0, quad_segs=200)
    assert shapely.Polygon(corners).symmetric_difference(wanted).area < 1e-3 * wanted.area


def steps(names):
    return {part: function() for part, (function, *_) in names["PARTS"].items()}


def changed(living, names, **changes):
    """The parts that other drivers change."""
    before, after = steps(names), steps(run(living, **changes))
    return {part for part in before if before[part] != after[part]}


def seen(shape):
    """Volume, centre and moments of inertia of a solid."""
    centre, inertia = shape.center(), shape.matrix_of_inertia
    return np.array([shape.volume, centre.X, centre.Y, centre.Z, *np.ravel(inertia)])


def test_the_program_needs_build123d_alone(living):
    tree = ast.parse(living.program)
    modules = {node.module.split(".")[0] for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)}
    modules |= {alias.name for node in ast.walk(tree) if isinstance(node, ast.Import) for alias in node.names}
    # OCP is the kernel that build123d stands on.
    assert modules - set(sys.stdlib_module_names) == {"build123d", "OCP"}


def test_it_has_the_parts_of_the_design_with_the_volumes_of_its_solids(names, product):
    assert set(names["PARTS"]) == {unique.name for unique in product.unique}
    for unique in (unique for unique in product.unique if unique.name in SOME):
        shape, drawn = names["build"](names["PARTS"][unique.name][0]()), bd.Solid(kernel.solid_of(unique.part))
        assert shape.is_valid
        assert shape.volume == pytest.approx(drawn.volume, rel=VOLUME), unique.name
        np.testing.assert_allclose([*shape.center()], [*drawn.center()], atol=1e-3)


def test_parts_stand_where_the_assembly_has_them(names, product):
    at = {"base": np.eye(4)}
    for body, upper, z, joint in (("thigh", "base", 0.0, "hip"), ("shank", "thigh", names["thigh_length"], "knee")):
        cos, sin = (f(math.radians(names[f"{joint}_angle"])) for f in (math.cos, math.sin))
        at[body] = at[upper] @ [[cos, 0, sin, 0], [0, 1, 0, 0], [-sin, 0, cos, -z], [0, 0, 0, 1]]
    found = []
    for unit, body, z, over, members in names["UNITS"]:
        for member in members:
            for location in names["locations"](member, z, over):
                move = location.wrapped.Transformation()
                matrix = [[move.Value(row, column) for column in range(1, 5)] for row in (1, 2, 3)]
                found.append((unit, member[0], at[body][:3] @ [*matrix, [0, 0, 0, 1]]))
    assert len(found) == len(product.instances)
    for (unit, part, matrix), (instance, unique) in zip(found, product.placed(), strict=True):
        assert (unit, part) == (instance.unit, unique.name)
        np.testing.assert_allclose(matrix, instance.world[:3], atol=1e-6)


def test_most_drivers_have_a_unit_and_words_and_all_are_used(living, names):
    main = [driver for driver in living.drivers if not driver.detail]
    assert 100 <= len(main) <= 180
    assert sum(bool(driver.meaning) for driver in living.drivers) > 0.8 * len(living.drivers)
    words = Counter(re.findall(r"\w+", living.program))
    assert all(words[driver.name] >= 3 for driver in living.drivers)
    assert names["broken"]() == []
    assert all(names[formula.name] == pytest.approx(formula.value, rel=1e-9) for formula in living.formulas)


@pytest.mark.parametrize(
    ("driver", "factor", "some", "others"),
    [
        ("thigh_length", 1.1, {"thigh_plate_inner", "thigh_core", "turnbuckle_bar"}, {"shank_core", "base_rod"}),
        ("hip_module", 1.05, {"hip_actuator_sun", "hip_actuator_planet", "hip_actuator_ring"}, {"knee_actuator_sun"}),
        ("knee_face_width", 1.2, {"knee_actuator_ring_housing", "knee_actuator_casing", "base_rod"}, {"thigh_core"}),
        ("leg_plate", 1.2, {"thigh_plate_outer", "hip_coupling", "thigh_bolt"}, {"hip_actuator_sun"}),
    ],
)
def test_a_driver_changes_what_depends_on_it_and_nothing_else(living, names, driver, factor, some, others):
    value = next(one.value for one in living.drivers if one.name == driver)
    found = changed(living, names, **{driver: value * factor})
    assert some <= found
    assert not others & found


def test_teeth_follow_from_module_and_numbers(living):
    names = run(living, hip_planet_teeth=30.0, hip_sun_teeth=24.0, hip_module=0.5)
    shape = names["build"](names["PARTS"]["hip_actuator_planet"][0]())
    assert shape.is_valid
    box = shape.bounding_box()
    # The tip circle of an unshifted gear, less what is cut short so that its mates clear it.
    assert 0.5 * (30.0 + 1.6) < max(box.size.X, box.size.Y) <= 0.5 * (30.0 + 2.0) + 1e-6
    tips = [face for face in shape.faces() if face.center().X ** 2 + face.center().Y ** 2 > (0.25 * 30.7) ** 2]
    assert len({round(math.atan2(face.center().Y, face.center().X), 3) for face in tips}) >= 30


def test_what_the_drivers_break_is_said(living):
    (planets,) = run(living, hip_planets=7.0)["broken"]()
    assert planets == "(hip_sun_teeth + hip_ring_teeth) % hip_planets == 0"
    assert run(living, interface_output_bolt_count=5.0)["broken"]() == ["interface_output_bolt_count % 2 == 0"]


def evaluated(equations):
    """Values of the equations file, by rules of our own for its form."""
    found = {}
    functions = {"IIf": lambda holds, one, other: one if holds else other, "sqr": math.sqrt, "atn": math.atan,
                 "arcsin": math.asin, "arccos": math.acos, "int": math.floor, "abs": abs, "pi": math.pi,
                 "sin": math.sin, "cos": math.cos, "tan": math.tan, "found": found}  # fmt: skip
    for line in equations.splitlines():
        name, text = re.fullmatch(r'"(\w+)" = (.*)', line).groups()
        assert name not in found
        text = re.sub(r"([\d.])mm$", r"\1", text)
        text = re.sub(r'"(\w+)"', r'found["\1"]', text).replace("^", "**").replace(" = ", " == ")
        found[name] = eval(text, functions)  # noqa: S307
    return found


def test_the_equations_file_has_the_same_drivers_and_formulas(living):
    found = evaluated(living.equations)
    for driver in living.drivers:
        assert found[driver.name] == pytest.approx(driver.value, rel=1e-11), driver.name
    for formula in living.formulas:
        assert found[formula.name] == pytest.approx(formula.value, rel=1e-9, abs=1e-9), formula.name
    assert '"thigh_length" = 400mm' in living.equations.splitlines()
    assert max(map(len, living.equations.splitlines())) < 500
    rows = list(csv.DictReader(io.StringIO(living.parameters_csv)))
    assert {row["name"]: float(row["value"]) for row in rows} == pytest.approx(
        {one.name: one.value for one in (*living.drivers, *living.formulas)}, rel=1e-9
    )


def test_modules_of_parts_stand_behind_those_that_they_import_from():
    """Or they keep functions as they were; a cached one had kept threads with traced diameters for later robots."""
    places = {f"pareto_monoped.{name}": place for place, name in enumerate(_MODULES)}
    for module, place in places.items():
        tree = ast.parse(inspect.getsource(importlib.import_module(module)))
        origins = [node.module for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)]
        assert [origin for origin in origins if places.get(origin, -1) >= place] == [], module


def test_nothing_of_it_stays_in_the_package(living, product, actuator_map):
    """Neither constants nor caches keep a traced number: a robot that is built afterwards is of plain numbers."""
    robot = build_robot(product.robot.design.replace({"thigh_length_m": 0.41}), actuator_map)

    def traced(value):
        if hasattr(value, "__dataclass_fields__"):
            return any(traced(getattr(value, name)) for name in value.__dataclass_fields__ if name != "_known")
        return any(map(traced, value)) if isinstance(value, tuple) else isinstance(value, Traced)

    assert [part.name for unit in robot.units for part in unit.parts if traced(part)] == []
    assert not traced(robot.leg)


def design(case, motor, knee_motor=None, **rules):
    job = case_job(case, motor=motor, knee_motor=knee_motor, folder=None, **rules)
    built = built_of(job.design, job.maps(), job.calibration)
    product = build_product(built.robot, built.pose)
    return product, living_model(product, job.maps())


FIVE = (("C", "VT8020", None), ("A", "U8", None), ("B", "U12", None), ("A", "U10", None), ("B", "VT8020", "U8"))


@pytest.mark.long
@pytest.mark.parametrize("which", FIVE)
def test_five_designs_have_the_solids_of_their_exports(which):
    product, living = design(*which)
    names = run(living)
    assert names["broken"]() == []
    solids = {}
    for unique, facts in zip(product.unique, product.solids.result(), strict=True):
        solids[unique.name] = shape = names["solid"](unique.name)
        assert shape.is_valid, unique.name
        assert shape.volume == pytest.approx(facts.volume_mm3, rel=VOLUME), unique.name
    # As the joints have them.
    found = np.array([[*solid.center()] for solid in names["assembly"](solids).solids()])
    expected = [
        (instance.world @ [*solid.center(), 1.0])[:3]
        for instance, unique in product.placed()
        for solid in solids[unique.name].solids()
    ]
    assert len(found) == len(expected)
    for one, other in ((found, expected), (expected, found)):
        assert cKDTree(one).query(other)[0].max() < 1e-3


@pytest.mark.long
@pytest.mark.parametrize("which", FIVE)
def test_ten_drivers_changed_at_random_rebuild_validly_and_change_what_they_name(which):
    _, living = design(*which)
    base = run(living)
    before = steps(base)
    rng = random.Random(repr(which))
    lengths = [one for one in living.drivers if not one.detail and one.unit == "mm"]
    for driver in rng.sample(lengths, 10):
        names = run(living, **{driver.name: driver.value * rng.choice((0.96, 0.98, 1.03, 1.05))})
        made = {part: value[3] != "bought" for part, value in names["PARTS"].items()}
        other = {part for part, now in steps(names).items() if now != before[part]}
        # A limit that does not bind changes nothing.
        uses = [line for line in living.program.splitlines() if re.search(rf"\b{driver.name}\b", line)]
        assert other or any(re.search(r"max\(|min\(| if ", line) for line in uses), driver
        for part in (part for part in other if made[part]):
            shape = names["build"](names["PARTS"][part][0]())
            assert shape.is_valid, (driver, part)
            assert np.any(np.abs(seen(shape) - seen(base["build"](before[part]))) > 1e-6), (driver, part)


@pytest.mark.long
@pytest.mark.parametrize("rules", RULE_SETS)
@pytest.mark.parametrize("motor", motor_names())
def test_every_motor_has_a_program_with_the_heights_and_holes_of_its_parts(motor, rules, monkeypatch):
    """Without the kernel, which takes far longer."""
    monkeypatch.setattr("pareto_monoped.cad.product.solid_facts", lambda parts: None)
    product, living = design("B", motor, rules=rules)
    names = run(living)
    assert names["broken"]() == []
    for unique in product.unique:
        slabs = [step for step in names["PARTS"][unique.name][0]() if step[0] == "slab"]
        for (_, _, low, high, holes), prism in zip(slabs, unique.part.prisms, strict=True):
            assert (low, high) == pytest.approx((prism.z0_mm, prism.z1_mm), abs=1e-9), unique.name
            round_ones = [hole for hole in prism.holes if isinstance(hole, Circle | Pattern)]
            drawn = [(x, y, hole.radius_mm) for hole in round_ones for x, y in centres_mm(hole)]
            found = [hole[0][1:] for hole in holes if hole[0][0] == "circle"]
            np.testing.assert_allclose(np.array(found), np.array(drawn, dtype=float), atol=1e-9)


@pytest.mark.long
def test_a_user_runs_it_from_the_command_line(living, tmp_path):
    (tmp_path / "model.py").write_text(living.program)

    def python(*arguments):
        return subprocess.run(
            [sys.executable, "model.py", *arguments], cwd=tmp_path, capture_output=True, text=True, check=False
        )

    assert "thigh_length = 400 mm" in python("--list").stdout
    refused = python("thigh_lenght=400")
    assert refused.returncode == 1
    assert refused.stderr == "thigh_lenght: is no driver; see python model.py --list\n"
    done = python("--changed", "shank_length=437")
    assert done.returncode == 0, done.stderr
    made = {path.stem for path in (tmp_path / "changed").iterdir()}
    assert {"shank_core", "foot"} <= made
    assert "thigh_core" not in made
    text = (tmp_path / "changed" / "shank_core.step").read_text()
    assert "FILE_SCHEMA(('AP242" in text
    assert "DESCRIPTIVE_REPRESENTATION_ITEM('printed plastic" in text


def test_its_step_files_have_densities_in_grams_per_cubic_centimetre(names):
    text = (
        "#1 = PRODUCT('foot','foot','',(#9));\n#2 = PRODUCT_DEFINITION_FORMATION('','',#1);\n"
        "#3 = PRODUCT_DEFINITION('design','',#2,#9);\n#4 = ( GEOMETRIC_REPRESENTATION_CONTEXT(3) );\n"
    )
    added = "".join(names["materials"](text))
    (density,) = re.findall(r"POSITIVE_RATIO_MEASURE\(([\d.]+)\)", added)
    assert 0.5 < float(density) < 2.0  # of rubber or printed plastic; water has 1
    assert "SI_UNIT($,.GRAM.)" in added
    assert "SI_UNIT(.CENTI.,.METRE.)" in added
    assert added.count("DERIVED_UNIT_ELEMENT") == 2


def test_only_the_parts_asked_for_are_made(names, tmp_path, monkeypatch):
    made = []
    monkeypatch.setitem(names, "solid", lambda name: SimpleNamespace(volume=1.0, is_valid=True))
    monkeypatch.setitem(names, "write", lambda solid, path: made.append(path))
    monkeypatch.setattr(sys, "argv", ["model.py", "--parts", "foot,base_rod", "--out", str(tmp_path / "some")])
    names["main"]()
    assert made == [tmp_path / "some" / "foot.step", tmp_path / "some" / "base_rod.step"]


NET = {"thigh_length": 1.07, "hip_module": 1.04, "knee_face_width": 1.15, "leg_plate": 1.2}
OTHER_NET = {"shank_length": 0.93, "knee_module": 0.97, "hip_face_width": 0.9}
SOLIDS = (
    "thigh_plate_inner", "shank_core", "foot", "base_rod", "hip_mount_screw", "drive_sprocket", "hip_actuator_planet",
)  # fmt: skip
"""Parts that need every kind of step between them; the others' steps are signed alone."""


def plain(number):
    """To nine digits: the last ones are the machine's."""
    return float(f"{number:.9g}") if abs(number) > 1e-9 else 0.0


def numbers_of(step):
    """A step, or any list in it, with its numbers as those of a signature."""
    if isinstance(step, float | int):
        return plain(step)
    return [numbers_of(one) for one in step] if isinstance(step, tuple | list) else step


def test_signatures_of_what_other_drivers_make(living):
    """Parts, places and solids under two sets of drivers, for a change of any function between them and the drivers."""
    found = {}
    for set_name, factors in (("longer", NET), ("shorter", OTHER_NET)):
        values = {one.name: one.value for one in living.drivers}
        names = run(living, **{name: values[name] * factor for name, factor in factors.items()})
        found[f"{set_name} formulas"] = signature([plain(names[one.name]) for one in living.formulas])
        for part, (function, *looks) in names["PARTS"].items():
            found[f"{set_name} {part}"] = signature(numbers_of(function()), numbers_of(looks))
        for unit, _, z, over, members in names["UNITS"]:
            moves = [at.wrapped.Transformation() for member in members for at in names["locations"](member, z, over)]
            places = [move.Value(row, column) for move in moves for row in (1, 2, 3) for column in (1, 2, 3, 4)]
            found[f"{set_name} {unit} places"] = signature([round(x, 6) + 0.0 for x in places])
        for part in SOLIDS if set_name == "longer" else SOLIDS[:2]:
            shape = names["solid"](part)
            box = shape.bounding_box()
            sizes = [shape.volume, *shape.center(), *box.min, *box.max, *shape.color]
            sizes = [float(f"{x:.6g}") if abs(x) > 1e-5 else 0.0 for x in sizes]
            found[f"{set_name} {part} solid"] = signature(sizes, shape.label)
    compare(found, Path(__file__).parent / "living_signatures.json")


def test_few_teeth_are_undercut_and_many_are_not(names):
    """Their roots end where the rack's rounding does; an undercut root ends before, on the involute."""
    alpha = math.radians(20.0)
    assert names["root_end"](40, 0.0, alpha) == 0.5 * math.pi - alpha
    end = names["root_end"](10, 0.0, alpha)
    assert 0.0 < end < 0.5 * math.pi - alpha
    along, across = names["cut_by_rack"](10, 0.0, end, alpha)
    middle = math.pi / 10 - names["half_angle"](10, 1.0, 0.0, alpha, math.hypot(along, across))
    assert math.atan2(across, along) == pytest.approx(middle, abs=1e-9)

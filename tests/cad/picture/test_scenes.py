"""What the pictures show."""

import numpy as np

from pareto_monoped.cad.picture import scenes
from pareto_monoped.cad.picture.drawing import draw
from pareto_monoped.geometry.roles import Role


def test_every_part_of_an_actuator_is_in_its_section(product):
    scene = scenes.section_scene(product, "knee_actuator")
    unit = next(unit for unit in product.robot.units if unit.name == "knee_actuator")
    assert len(scene.legend) == len(unit.parts)
    seen = np.unique(draw(scene.bodies, scene.view, width=1000, height=820).numbers)
    # Screws and pins may lie in the half that is not cut; bearings and gears must be seen.
    shown = {part.name for k, part in enumerate(unit.parts, 1) if k in seen}
    must = (Role.BEARING, Role.GEAR, Role.CARRIER, Role.MOTOR_STATOR, Role.MOTOR_ROTOR)
    assert {part.name for part in unit.parts if part.role in must} <= shown


def test_the_knee_section_shows_both_links_and_what_is_between_them(product):
    scene = scenes.knee_scene(product)
    seen = set(np.unique(draw(scene.bodies, scene.view, width=1000, height=820).numbers).tolist())
    shown = {row.text.split(" (")[0].replace(" ", "_") for row in scene.legend if row.number in seen}
    joint = {"knee_bearing", "knee_bearing_cup", "knee_axle", "thigh_plate_inner", "shank_plate_near"}
    assert joint <= {unique.name for unique in product.unique}
    assert joint <= shown
    low, high = (np.array([f(b.points_mm, axis=0) for b in scene.bodies]) for f in (np.min, np.max))
    half = scenes._KNEE_AROUND_MM + 1e-6
    assert np.all(low > -half)
    assert np.all(high < half)


def test_exploded_parts_do_not_lie_within_each_other(product):
    """Boxes of parts that lay behind each other have a gap along the joints' axis."""
    scene = scenes.exploded_scene(product)
    assert len(scene.bodies) == len(product.instances)
    low, high = (np.array([f(b.points_mm, axis=0) for b in scene.bodies]) for f in (np.min, np.max))
    over = np.minimum(high[:, None], high[None]) - np.maximum(low[:, None], low[None])
    assert not np.any(np.all(over > 1e-6, axis=2)[np.triu_indices(len(low), 1)])
    # Nothing has moved across the axis.
    for body, (instance, unique) in zip(scene.bodies, product.placed(), strict=True):
        at = unique.mesh.points_mm @ instance.world[:3, :3].T + instance.world[:3, 3]
        assert np.allclose(at[:, [0, 2]], body.points_mm[:, [0, 2]])

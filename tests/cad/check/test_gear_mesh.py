"""Gears that mesh in the pose but not while they roll."""

from dataclasses import replace

import numpy as np
import pytest

from pareto_monoped.actuator.actuator import build_actuator
from pareto_monoped.actuator.gearset import GearSet
from pareto_monoped.actuator.motors import load_motor
from pareto_monoped.actuator.search import map_for
from pareto_monoped.actuator.settings import ActuatorSettings
from pareto_monoped.cad.check import gear_mesh
from pareto_monoped.cad.check.result import GEAR_MESH
from pareto_monoped.geometry.roles import Role


def with_gears(product, joint, change):
    """The product with the gears' outlines of one joint changed, as its solids would have them."""
    actuator = getattr(product.robot, joint)

    def changed(part):
        shape = lambda one: change(one) if hasattr(one, "module_mm") else one  # noqa: E731
        prisms = tuple(replace(p, outline=shape(p.outline), holes=tuple(map(shape, p.holes))) for p in part.prisms)
        return replace(part, prisms=prisms) if part.role is Role.GEAR else part

    parts = tuple(changed(part) for part in actuator.parts)
    return replace(product, robot=replace(product.robot, **{joint: replace(actuator, parts=parts)}))


FAULTS = {
    "thicker teeth": lambda gear: replace(gear, backlash_mm=gear.backlash_mm - 0.03),
    "a ring that is turned": lambda gear: replace(gear, phase_rad=gear.phase_rad + 0.01),
    "a ring of another angle": lambda gear: replace(gear, pressure_angle_rad=np.radians(20.5)),
}
EVERY_TIME = (("hip", "thicker teeth"), ("hip", "a ring of another angle"), ("knee", "a ring that is turned"))


@pytest.mark.parametrize(
    ("joint", "what"),
    [
        pytest.param(joint, what, marks=() if (joint, what) in EVERY_TIME else pytest.mark.long)
        for joint in ("hip", "knee")
        for what in FAULTS
    ],
)
def test_teeth_that_do_not_fit_are_found(product, examine, joint, what):
    rings, change = what.startswith("a ring"), FAULTS[what]
    gears = getattr(product.robot, joint).gears
    check = gear_mesh.check(
        with_gears(product, joint, lambda gear: change(gear) if not rings or gear.teeth == gears.ring_teeth else gear)
    )
    assert check.measured > GEAR_MESH.value
    assert all(text.startswith(f"{joint}_actuator/") for text in check.failures)
    assert check.name in examine()


@pytest.mark.long
def test_the_check_is_named_among_all(product, failing):
    broken = with_gears(product, "hip", lambda gear: replace(gear, backlash_mm=0.0, shift=gear.shift + 0.05))
    assert "gears mesh on their driving flanks" in failing(product=broken)


@pytest.mark.parametrize("fitted", [False, True])
@pytest.mark.parametrize(("sun", "planet", "module", "shift"), [(21, 21, 0.7, 0.0), (16, 30, 0.8, 0.4)])
def test_a_tip_in_a_root_is_found(sun, planet, module, shift, fitted):
    """These won before tips were fitted: their rings reach 4 and 13 um into the planets' roots, cut in shapely."""
    gears = GearSet(
        sun_teeth=sun,
        planet_teeth=planet,
        ring_teeth=sun + 2 * planet,
        module_mm=module,
        planets=3,
        sun_shift=shift,
        backlash_mm=0.03 * module,
        tips_fitted=fitted,
    )
    found = list(gear_mesh.rolled(build_actuator(load_motor("VT8020"), "ESSPG", gears, ActuatorSettings())))
    early = {mesh.name: mesh.early_mm for mesh in found}
    assert early["sun and planet"] < 0.0005
    assert (early["ring and planet"] < 0.0005) is fitted
    assert (early["ring and planet"] > GEAR_MESH.value) is not fitted


@pytest.mark.parametrize("motor", ["VT8020", "U8"])
def test_the_play_is_that_of_the_drawn_teeth(motor):
    """Both gears of a mesh are thinned, so that the play along the normal is twice that, times cos 20 degrees."""
    gears = (actuator := map_for(motor).lookup(6.0)).gears
    for mesh in gear_mesh.rolled(actuator):
        thinned = max(0.03 * gears.module_mm, 0.017)
        assert mesh.clearance_mm == pytest.approx(2.0 * thinned * np.cos(np.radians(20.0)), abs=3e-4)

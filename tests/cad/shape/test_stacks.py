"""Parts with teeth are split so that no cone stands on a face with teeth; the body stays what it was."""

import numpy as np
import pytest

from pareto_monoped.actuator.motors import motor_names
from pareto_monoped.actuator.search import map_for
from pareto_monoped.cad.shape.outlines import stands_on, without_teeth
from pareto_monoped.geometry.features import bored, turned
from pareto_monoped.geometry.gears import ExternalGear, InternalGear
from pareto_monoped.geometry.parts import Part, Prism
from pareto_monoped.geometry.roles import Role
from pareto_monoped.geometry.screws import M3, tapped
from pareto_monoped.geometry.shapes import Circle, Pattern
from pareto_monoped.materials import Material
from tests.lazily import Lazily

process = Lazily("pareto_monoped.cad.kernel.process")

STEEL = Material(name="steel", density_kg_per_m3=7850.0, colour=(0.5, 0.5, 0.5))
BORE, RIM = Circle(radius_mm=4.0), Circle(radius_mm=16.5)
THREADS = Pattern(radius_mm=1.25, pitch_radius_mm=12.0, count=4)
PLANET = Prism(outline=ExternalGear(teeth=18, module_mm=1.0), z0_mm=-10.0, z1_mm=0.0, holes=(BORE,))
HUB = Prism(outline=RIM, z0_mm=0.0, z1_mm=3.0, holes=(InternalGear(teeth=60, module_mm=0.25), THREADS))
PARTS = [
    (PLANET, (bored(BORE, -10.0, 0.0, enters="both", pressed=True),)),
    (HUB, (tapped(M3, (THREADS,), 0.0, 3.0, enters="high"), turned(16.5, 0.0, 1.0))),
]


def volumes(*prisms):
    return np.sum([np.array(prism.integrals(), dtype=float) for prism in prisms], axis=0)


@pytest.mark.parametrize(("prism", "features"), PARTS, ids=["planet", "hub"])
def test_teeth_and_cones_come_apart_and_the_body_stays(prism, features):
    bevels = [bevel for feature in features for bevel in feature.bevels]
    pieces = without_teeth(prism, bevels)
    assert len(pieces) == 2
    assert volumes(*pieces) == pytest.approx(volumes(prism), rel=1e-12, abs=1e-9)
    toothed = [p for p in pieces if any(isinstance(s, ExternalGear | InternalGear) for s in (p.outline, *p.holes))]
    assert len(toothed) == 1
    carried = [sum(stands_on(bevel, piece) for piece in pieces) for bevel in bevels]
    assert carried == [1] * len(bevels)


def test_planets_and_hubs_are_one_valid_body_with_their_cones():
    for prism, features in PARTS:
        part = Part(name="gear", role=Role.GEAR, material=STEEL, prisms=(prism,), process="machined", features=features)
        (facts,) = process.solid_facts([part])
        assert facts.valid
        assert facts.bodies == 1
        assert facts.volume_mm3 == pytest.approx(float(part.volume_mm3()), rel=2e-3)


def test_prisms_without_cones_or_teeth_stay_whole():
    assert without_teeth(PLANET, ()) == (PLANET,)
    disc = Prism(outline=RIM, z0_mm=0.0, z1_mm=3.0, holes=(THREADS,))
    assert without_teeth(disc, tapped(M3, (THREADS,), 0.0, 3.0, enters="both").bevels) == (disc,)


def test_a_cone_stands_on_the_edge_that_it_names_only():
    low, high = bored(BORE, -10.0, 0.0, enters="both").bevels
    below = Prism(outline=RIM, z0_mm=-20.0, z1_mm=-10.0, holes=(BORE,))
    assert stands_on(low, PLANET)
    assert stands_on(high, PLANET)
    assert not stands_on(low, below)  # its cone looks the other way
    assert not stands_on(turned(4.0, 0.0, -1.0).bevels[0], PLANET)  # a shaft's, not a hole's
    thin = Prism(outline=RIM, z0_mm=-0.2, z1_mm=0.0, holes=(BORE,))
    assert not stands_on(high, thin)  # 0.3 mm deep


@pytest.mark.parametrize("step", [0.0825, 0.25, 1.5])
def test_a_chamfer_fits_on_a_bore_beside_one_that_is_little_wider(step):
    """The ring's seat of a knee whose main bearing sits 0.0825 mm wider could not be made, so no export of it could."""
    rim, seat = Circle(radius_mm=40.4), Circle(radius_mm=38.4)
    prisms = (
        Prism(outline=rim, z0_mm=-29.4, z1_mm=-17.3, holes=(seat,)),
        Prism(outline=rim, z0_mm=-17.3, z1_mm=-17.0, holes=(Circle(radius_mm=37.4),)),
        Prism(outline=rim, z0_mm=-17.0, z1_mm=-3.0, holes=(Circle(radius_mm=38.4 + step),)),
    )
    entered = bored(seat, -29.4, -17.3, enters="low", pressed=True)
    part = Part(
        name="housing", role=Role.HOUSING, material=STEEL, prisms=prisms, process="machined", features=(entered,)
    )
    (facts,) = process.solid_facts([part])
    assert facts.valid
    assert facts.volume_mm3 == pytest.approx(float(part.volume_mm3()), rel=1e-6)


@pytest.mark.long
@pytest.mark.parametrize("name", motor_names())
def test_every_winner_is_made_of_valid_solids(name):
    """With chamfers, the exports of a front stop at the first gearbox that cannot be made."""
    for entry in map_for(name, "iso6336").entries:
        if entry.actuator is not None:
            facts = process.solid_facts(list(entry.actuator.parts))
            assert all(fact.valid for fact in facts), entry.actuator.gears

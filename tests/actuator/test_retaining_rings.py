"""Retaining rings: catalogue against the standards' rules, grooves and rings in the parts of all winners."""

import numpy as np
import pytest

from pareto_monoped.actuator.bearings import catalogue, read_retaining_rings, retaining_ring
from pareto_monoped.actuator.motors import motor_names
from pareto_monoped.actuator.search import map_for
from pareto_monoped.errors import InputError
from pareto_monoped.geometry.making import limits
from pareto_monoped.geometry.shapes import Circle

# Size: thickness s, groove diameter d2 with its lower and upper deviation, groove width m, from DIN 471 and DIN 472.
SHAFTS = {
    25.0: (1.2, 23.9, -0.21, 0.0, 1.3),
    30.0: (1.5, 28.6, -0.21, 0.0, 1.6),
    35.0: (1.5, 33.0, -0.25, 0.0, 1.6),
    40.0: (1.75, 37.5, -0.25, 0.0, 1.85),
    45.0: (1.75, 42.5, -0.25, 0.0, 1.85),
    50.0: (2.0, 47.0, -0.25, 0.0, 2.15),
    60.0: (2.0, 57.0, -0.30, 0.0, 2.15),
    100.0: (3.0, 96.5, -0.35, 0.0, 3.15),
    110.0: (4.0, 106.0, -0.54, 0.0, 4.15),
}
BORES = {
    47.0: (1.75, 49.5, 0.0, 0.25, 1.85),
    52.0: (2.0, 55.0, 0.0, 0.30, 2.15),
    65.0: (2.5, 68.0, 0.0, 0.30, 2.65),
    85.0: (3.0, 88.5, 0.0, 0.35, 3.15),
    110.0: (4.0, 114.0, 0.0, 0.54, 4.15),
}


@pytest.mark.parametrize(
    ("standard", "size", "expected"),
    [("DIN 471", *row) for row in SHAFTS.items()] + [("DIN 472", *row) for row in BORES.items()],
)
def test_rings_have_the_dimensions_of_the_standards(standard, size, expected):
    ring = retaining_ring(standard, size)
    zone = limits(float(ring.groove_diameter_mm), ring.groove_zone)
    found = (ring.thickness_mm, ring.groove_diameter_mm, zone.lower_mm, zone.upper_mm, ring.groove_width_mm)
    assert found == pytest.approx(expected)


def test_every_bearing_from_25_mm_has_both_rings():
    for bore, outer in catalogue()[catalogue()[:, 0] >= 25.0, :2]:
        for standard, size in (("DIN 471", bore), ("DIN 472", outer)):
            ring = retaining_ring(standard, float(size))
            assert np.isfinite([ring.thickness_mm, ring.groove_diameter_mm, ring.mass_kg]).all(), (standard, size)
            # A ring is between a half and the whole of the annulus that its greatest width fills.
            annulus = 7.85e-6 * np.pi * abs(ring.r_free**2 - ring.r_groove**2) * ring.thickness_mm
            assert 0.5 < ring.mass_kg / annulus < 1.0, (standard, size)


def test_rings_come_in_arrays_and_none_fits_a_size_between():
    sizes = np.array([40.0, 41.0, 50.0, np.nan])
    ring = retaining_ring("DIN 471", sizes)
    assert ring.thickness_mm == pytest.approx([1.75, np.nan, 2.0, np.nan], nan_ok=True)
    assert np.isnan(retaining_ring("DIN 471", 300.0).mass_kg)
    assert (ring.purchases, ring.groove_note, ring.groove_zone) == ((), "", "")


HEAD = "standard,size_mm,thickness_mm,radial_width_mm,groove_diameter_mm,groove_zone,groove_width_mm,mass_kg\n"
GOOD = "DIN 471,40,1.75,4.4,37.5,h12,1.85,0.006\nDIN 472,52,2,4.7,55,H12,2.15,0.008\n"


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("37.5", "41", ("40", "groove_diameter_mm")),
        (",55,", ",51,", ("52", "groove_diameter_mm")),
        ("1.85", "1.75", ("40", "groove_width_mm", "1.75")),
        ("DIN 472,52", "DIN 471,39,1.75,4.3,37,h12,1.85,0.006\nDIN 472,52", ("39", "size_mm", "40")),
    ],
)
def test_a_ring_that_does_not_fit_is_refused_in_one_line(old, new, words):
    read_retaining_rings(HEAD + GOOD)
    with pytest.raises(InputError) as caught:
        read_retaining_rings(HEAD + GOOD.replace(old, new))
    message = str(caught.value)
    assert "\n" not in message
    assert all(word in message for word in (*words, "data/retaining_rings.csv"))


def spans(part, radius, ring, *, inside):
    """Heights of the round face of this radius that touches a ring. The seat of the gears may have the same radius."""
    faces = [
        (float(prism.z0_mm), float(prism.z1_mm))
        for prism in part.prisms
        for shape in (prism.holes if inside else (prism.outline,))
        if isinstance(shape, Circle) and np.isclose(float(shape.radius_mm), radius)
    ]
    touching = [(low, high) for low, high in faces if low < ring.z1_mm and high > ring.z0_mm]
    return min(low for low, _ in touching), max(high for _, high in touching)


@pytest.mark.parametrize("rules", ["iso6336", "paper"])
@pytest.mark.parametrize("motor", motor_names())
def test_every_groove_is_as_wide_as_its_standard_says_and_holds_its_ring_against_the_bearing(motor, rules):
    for entry in map_for(motor, rules=rules).entries:
        if entry.actuator is None:
            continue
        parts = {part.name: part for part in entry.actuator.parts}
        bearing = parts["main_bearing"].prisms[0]
        bore, outer = (2.0 * float(shape.radius_mm) for shape in (bearing.holes[0], bearing.outline))
        held = [("DIN 471", bore, "retaining_ring", "carrier", False)]
        if "bore_retaining_ring" in parts:
            held.append(("DIN 472", outer, "bore_retaining_ring", "ring_housing", True))
        for standard, size, name, holder, inside in held:
            ring = retaining_ring(standard, size)
            (drawn,) = parts[name].prisms
            low, high = spans(parts[holder], 0.5 * float(ring.groove_diameter_mm), drawn, inside=inside)
            assert high - low == pytest.approx(float(ring.groove_width_mm))
            assert drawn.z1_mm - drawn.z0_mm == pytest.approx(float(ring.thickness_mm))
            # The ring lies between the bearing and the groove's far face.
            face, far = (bearing.z0_mm, low) if inside else (bearing.z1_mm, high)
            assert sorted((float(drawn.z0_mm), float(drawn.z1_mm))) == pytest.approx(sorted((float(face), far)))
            (order,) = parts[name].purchases
            assert order.designation.endswith(f"{standard} - {size:g} x {float(ring.thickness_mm):g}")
            assert f"{float(ring.groove_width_mm):g} H13" in parts[holder].note
            assert any(
                fit.text == f"{float(ring.groove_diameter_mm):g} {ring.groove_zone}" for fit in parts[holder].fits
            )


@pytest.mark.parametrize(
    ("standard", "size", "collar"),
    [("DIN 471", 40.0, 0.75), ("DIN 472", 72.0, 0.75), ("DIN 471", 80.0, 0.875), ("DIN 472", 110.0, 1.0)],
)
def test_collars_are_half_as_thick_as_their_grooves_are_deep_and_no_thinner_than_can_be_turned(standard, size, collar):
    """Grooves of 37.5, 75, 76.5 and 114 mm are 1.25, 1.5, 1.75 and 2 mm deep."""
    assert float(retaining_ring(standard, size).collar_mm) == pytest.approx(collar)


@pytest.mark.parametrize("motor", ["VT8020", "U12"])
def test_collars_are_drawn_between_groove_and_end_of_the_seat(motor):
    for entry in map_for(motor).entries:
        if entry.actuator is None:
            continue
        parts = {part.name: part for part in entry.actuator.parts}
        (ring,), carrier = parts["retaining_ring"].prisms, parts["carrier"]
        bore = 2.0 * float(parts["main_bearing"].prisms[0].holes[0].radius_mm)
        (collar,) = (p for p in carrier.prisms if p.z0_mm == ring.z1_mm)
        assert collar.outline.radius_mm == 0.5 * bore
        assert collar.z1_mm - collar.z0_mm == pytest.approx(float(retaining_ring("DIN 471", bore).collar_mm))
        if "bore_retaining_ring" in parts:
            (ring,), outer = (
                parts["bore_retaining_ring"].prisms,
                float(parts["main_bearing"].prisms[0].outline.radius_mm),
            )
            behind = [
                p for p in parts["ring_housing"].prisms if p.holes[0].radius_mm == outer and p.z1_mm == ring.z0_mm
            ]
            (collar,) = behind
            least = float(retaining_ring("DIN 472", 2.0 * outer).collar_mm)
            assert collar.z1_mm - collar.z0_mm == pytest.approx(least)


def test_the_carrier_turns_freely_in_the_ring_behind_the_bearing():
    for entry in map_for("VT8020").entries:
        parts = {part.name: part for part in entry.actuator.parts} if entry.actuator else {}
        if "bore_retaining_ring" not in parts:
            continue
        (ring,) = parts["bore_retaining_ring"].prisms
        within = [p for p in parts["carrier"].prisms if p.z0_mm < ring.z1_mm - 1e-9 and p.z1_mm > ring.z0_mm + 1e-9]
        radii = [float(prism.outline.radius_mm) for prism in within if isinstance(prism.outline, Circle)]
        assert max(radii) < float(ring.holes[0].radius_mm) - 0.2

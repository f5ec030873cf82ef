"""Parts as stacks of extruded shapes with a material, and the mass properties that follow from them.

Every part of the robot is described this way once. The simulation takes its mass and inertia from the description, and
the CAD builds its solid from the same description. Lengths are in millimetres, results in SI.

Local frame: x and y in the plane of the shapes, z along the extrusion, which is a joint or gearbox axis.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from functools import lru_cache, partial, reduce

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.geometry.features import Bevel, Feature
from pareto_monoped.geometry.making import Fit, Length, ToothMaking
from pareto_monoped.geometry.roles import SOLID_UNITS, Group, Joint, Purchase, Role, Visibility
from pareto_monoped.geometry.shapes import Circle, Floats, Moments, Numbers, Shape
from pareto_monoped.geometry.tightening import Fastening
from pareto_monoped.materials import ALLOYS, MATERIALS, Alloy, GearGrade, Material


@dataclass(frozen=True, slots=True, kw_only=True)
class Prism:
    """A shape with holes, extruded from z0_mm to z1_mm. The prisms of one part may touch but not overlap."""

    outline: Shape
    z0_mm: Numbers
    z1_mm: Numbers
    holes: tuple[Shape, ...] = ()

    def moments(self) -> Moments:
        """Return the area integrals of the cross-section."""
        total = self.outline.moments()
        for hole in self.holes:
            total = total - hole.moments()
        return total

    def volume_mm3(self) -> Numbers:
        """Return the first of ``integrals``, for searches that weigh thousands of parts."""
        area = self.outline.area_mm2()
        for hole in self.holes:
            area = area - hole.area_mm2()
        return area * (np.asarray(self.z1_mm, dtype=np.float64) - self.z0_mm)

    def integrals(self) -> tuple[Numbers, ...]:
        """Return the integrals of 1, x, y, z, xx, yy, zz, xy, xz, yz about the frame's origin, in mm3, mm4 and mm5."""
        area = self.moments()
        z0, z1 = np.asarray(self.z0_mm, dtype=np.float64), np.asarray(self.z1_mm, dtype=np.float64)
        length, z_first, z_second = z1 - z0, 0.5 * (z1**2 - z0**2), (z1**3 - z0**3) / 3.0
        return (
            area.area * length,
            area.x * length,
            area.y * length,
            area.area * z_first,
            area.xx * length,
            area.yy * length,
            area.area * z_second,
            area.xy * length,
            area.x * z_first,
            area.y * z_first,
        )


def layer(outline: Shape, low_mm: Numbers, high_mm: Numbers, *holes: Shape) -> Prism:
    """Build a prism from its lower to its upper height."""
    return Prism(outline=outline, z0_mm=low_mm, z1_mm=high_mm, holes=holes)


def disc(radius_mm: Numbers, low_mm: Numbers, high_mm: Numbers, *holes: Shape) -> Prism:
    """Build a cylinder around the z axis from its lower to its upper height."""
    return layer(Circle(radius_mm=radius_mm), low_mm, high_mm, *holes)


@dataclass(frozen=True, slots=True, kw_only=True)
class Ball:
    """A ball centred on the y axis, cut flat at a height, with a pocket: a foot moulded onto a tongue."""

    radius_mm: Numbers  #: of the ball
    y_mm: Numbers  #: of its centre; x and z are zero
    top_mm: Numbers  #: height above the centre at which the ball is cut flat, at most the radius
    pocket: Prism | None = None  #: a prism that is cut out; it lies wholly inside the ball

    def volume_mm3(self) -> Numbers:
        """Return the first of ``integrals``."""
        return self.integrals()[0]

    def integrals(self) -> tuple[Numbers, ...]:
        """Return the integrals of ``Prism``, over slices of radius sqrt(R^2 - t^2) for t from -R to the cut."""
        r, c, y = self.radius_mm, self.top_mm, self.y_mm
        volume = np.pi * (r**2 * c - c**3 / 3.0 + 2.0 * r**3 / 3.0)
        first = np.pi * (0.5 * r**2 * c**2 - 0.25 * c**4 - 0.25 * r**4)
        along = np.pi * (r**2 * c**3 / 3.0 - 0.2 * c**5 + 2.0 * r**5 / 15.0)
        across = 0.25 * np.pi * (r**4 * c - 2.0 * r**2 * c**3 / 3.0 + 0.2 * c**5 + 8.0 * r**5 / 15.0)
        whole = (
            volume,
            0.0,
            first + volume * y,
            0.0,
            across,
            along + 2.0 * first * y + volume * y**2,
            across,
            0.0,
            0.0,
            0.0,
        )
        if self.pocket is None:
            return whole
        return tuple(a - b for a, b in zip(whole, self.pocket.integrals(), strict=True))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class MassProperties:
    """Mass and its first and second moments about the frame's origin; the sum over parts is that of the whole."""

    mass_kg: Floats  #: shape (...)
    first_kg_m: Floats  #: integral of r dm, shape (..., 3)
    second_kg_m2: Floats  #: integral of r r^T dm, shape (..., 3, 3)

    @classmethod
    def zero(cls) -> "MassProperties":
        """Return nothing, the neutral element of addition."""
        return cls(mass_kg=np.zeros(()), first_kg_m=np.zeros(3), second_kg_m2=np.zeros((3, 3)))

    def __add__(self, other: "MassProperties") -> "MassProperties":
        return MassProperties(
            mass_kg=self.mass_kg + other.mass_kg,
            first_kg_m=self.first_kg_m + other.first_kg_m,
            second_kg_m2=self.second_kg_m2 + other.second_kg_m2,
        )

    def rows(self, chosen: NDArray[np.intp]) -> "MassProperties":
        """Return some rows of properties that have a leading axis."""
        return MassProperties(
            mass_kg=self.mass_kg[chosen], first_kg_m=self.first_kg_m[chosen], second_kg_m2=self.second_kg_m2[chosen]
        )

    def scaled(self, factor: Numbers) -> "MassProperties":
        """Return the same distribution with its density times ``factor``."""
        scale = np.asarray(factor, dtype=np.float64)
        return MassProperties(
            mass_kg=self.mass_kg * scale,
            first_kg_m=self.first_kg_m * scale[..., None],
            second_kg_m2=self.second_kg_m2 * scale[..., None, None],
        )

    def placed(self, rotation: Floats | None = None, translation_m: Floats | None = None) -> "MassProperties":
        """Return the same body rotated (matrix, shape (3, 3)), then moved by ``translation_m``, shape (..., 3)."""
        first, second = self.first_kg_m, self.second_kg_m2
        if rotation is not None:
            first = _turned(first, rotation)
            second = np.swapaxes(_turned(np.swapaxes(_turned(second, rotation), -1, -2), rotation), -1, -2)
        turned = MassProperties(mass_kg=self.mass_kg, first_kg_m=first, second_kg_m2=second)
        return turned if translation_m is None else turned.repeated([np.asarray(translation_m, dtype=np.float64)])

    def repeated(self, places_m: Sequence[Floats]) -> "MassProperties":
        """Return the same body at several places, each a translation of shape (..., 3)."""
        mass, moved = self.mass_kg, reduce(np.add, places_m)
        squares = reduce(np.add, [place[..., :, None] * place[..., None, :] for place in places_m])
        cross = self.first_kg_m[..., :, None] * moved[..., None, :]
        count = len(places_m)
        return MassProperties(
            mass_kg=count * mass + np.zeros(moved.shape[:-1]),
            first_kg_m=count * self.first_kg_m + mass[..., None] * moved,
            second_kg_m2=count * self.second_kg_m2
            + cross
            + np.swapaxes(cross, -1, -2)
            + mass[..., None, None] * squares,
        )

    @property
    def com_m(self) -> Floats:
        """Centre of mass, shape (..., 3); the origin for a massless body."""
        return self.first_kg_m / np.where(self.mass_kg > 0.0, self.mass_kg, 1.0)[..., None]

    @property
    def inertia_kg_m2(self) -> Floats:
        """Inertia tensor about the centre of mass, axes of the frame, shape (..., 3, 3)."""
        com = self.com_m
        central = self.second_kg_m2 - self.mass_kg[..., None, None] * (com[..., :, None] * com[..., None, :])
        trace = np.trace(central, axis1=-2, axis2=-1)
        inertia: Floats = trace[..., None, None] * np.eye(3) - central
        return inertia

    @property
    def inertia_about_z_kg_m2(self) -> Floats:
        """The last element of ``inertia_kg_m2``, to the last bit, in a third of the time; shape (...)."""
        com = self.com_m
        x, y, z = (self.second_kg_m2[..., i, i] - self.mass_kg * (com[..., i] * com[..., i]) for i in range(3))
        return x + y + z - z


def _turned(vectors: Floats, turn: Floats) -> Floats:
    """Rotate every vector along the last axis; written out, so that the sum's order does not depend on their number."""
    return np.stack(
        [turn[i, 0] * vectors[..., 0] + turn[i, 1] * vectors[..., 1] + turn[i, 2] * vectors[..., 2] for i in range(3)],
        axis=-1,
    )


def total(parts: Iterable[MassProperties]) -> MassProperties:
    """Return the sum of many mass properties."""
    result = MassProperties.zero()
    for part in parts:
        result = result + part
    return result


_HERE: tuple[tuple[Numbers, Numbers, Numbers], ...] = ((0.0, 0.0, 0.0),)


@dataclass(frozen=True, slots=True, kw_only=True)
class Part:
    """One kind of part of a unit (an actuator, a link, the base), in the unit's frame."""

    name: str  #: unique in the unit, lower case with underscores, such as ``planet``
    role: Role  #: what it does
    material: Material  #: what it is made of
    prisms: tuple[Prism, ...]  #: its geometry, around the part's own centre if ``pitch_radius_mm`` is not zero
    process: str  #: how it is made: ``machined``, ``laser cut``, ``3D printed``, ``moulded`` or ``bought``
    count: Numbers = 1  #: number of instances at each place
    #: The instances are evenly spread on a circle of this radius about the z axis; 0: on the axis
    pitch_radius_mm: Numbers = 0.0
    phase_rad: Numbers = 0.0  #: angle of the first instance on that circle
    #: Centres of the circles of instances, x, y, z from the unit's origin
    places_mm: tuple[tuple[Numbers, Numbers, Numbers], ...] = _HERE
    balls: tuple[Ball, ...] = ()  #: further geometry, bounded by spheres
    group: Group = Group.FIXED  #: what it moves with
    #: Mass of one instance if it is bought and its solid is only an envelope; replaces the density
    catalogue_mass_kg: Numbers | None = None
    #: List price of one instance if it is bought and the price is known; else its class has one, see ``robot.cost``
    catalogue_price_eur: float | None = None
    #: What is bought for one instance, and used up when it is put in; () for arrays
    purchases: tuple[Purchase, ...] = field(default=(), compare=False)
    note: str = field(default="", compare=False)  #: what else the maker should know
    #: What to watch when it is put in: said in the step in which its joint is made, or it comes
    at_assembly: str = field(default="", compare=False)
    at_last: str = field(default="", compare=False)  #: what is done at it when all is together, before the first jump
    #: Alloy or steel grade with its condition, where the maker must keep to one
    grade: Alloy | GearGrade | None = field(default=None, compare=False)
    fits: tuple[Fit, ...] = field(default=(), compare=False)  #: tolerances of its round faces
    #: Tolerances of faces that centre it or a neighbour and are turned with those beside them, at no price of their own
    registers: tuple[Fit, ...] = field(default=(), compare=False)
    lengths: tuple[Length, ...] = field(default=(), compare=False)  #: tolerances of lengths that others depend on
    #: Of its teeth, after ISO 1328-1; None without teeth, or where only the outline matters
    accuracy_class: int | None = field(default=None, compare=False)
    teeth: tuple[ToothMaking, ...] = field(default=(), compare=False)  #: how its teeth are made
    #: Size, preload, tightening torque and lock of a screw
    fastening: Fastening | None = field(default=None, compare=False)
    joint: Joint | None = None  #: what holds it where its shape does not
    visibility: Visibility = Visibility.OUTSIDE  #: where it is drawn
    features: tuple[Feature, ...] = ()  #: its holes, chamfers and countersunk heads, whose cones are geometry too

    @property
    def toleranced(self) -> tuple[Fit, ...]:
        """All tolerances of round faces."""
        return (*self.fits, *self.registers)

    @property
    def bevels(self) -> tuple[Bevel, ...]:
        """The cones of all features."""
        return tuple(bevel for feature in self.features for bevel in feature.bevels)

    @property
    def described(self) -> str:
        """What is bought as the part itself, and its note, in words."""
        bought = [one.text for one in self.purchases if one.unit in SOLID_UNITS] if self.process == "bought" else []
        return "; ".join(filter(None, (*bought, self.note)))

    def volume_mm3(self) -> Numbers:
        """Return the volume of one instance."""
        volume: Numbers = 0.0
        solids: tuple[Prism | Ball | Bevel, ...] = (*self.prisms, *self.balls, *self.bevels)
        for solid in solids:
            volume = volume + solid.volume_mm3()
        return volume

    def unit_mass_kg(self) -> Numbers:
        """Return the mass of one instance."""
        if self.catalogue_mass_kg is not None:
            return self.catalogue_mass_kg
        return self.volume_mm3() * 1e-9 * self.material.density_kg_per_m3

    def mass_kg(self) -> Numbers:
        """Return the mass of all instances."""
        return self.count * len(self.places_mm) * self.unit_mass_kg()

    def mass_properties(self) -> MassProperties:
        """Return all instances about the unit's origin; a circle counts as a ring, exact for three, or two about z."""
        try:
            return _remembered(self)
        except TypeError:  # arrays have no hash
            return self._everywhere()

    def _everywhere(self) -> MassProperties:
        """Return the instances of all places, about the origin of the unit's frame."""
        circle = self._circle()
        if self.places_mm is _HERE:
            return circle
        return circle.repeated([np.stack(np.broadcast_arrays(*place), axis=-1) * 1e-3 for place in self.places_mm])

    def _circle(self) -> MassProperties:
        """Return the instances of one place, about the centre of their circle."""
        one = _uniform((*self.prisms, *self.balls, *self.bevels), self.material.density_kg_per_m3)
        if self.catalogue_mass_kg is not None:
            one = one.scaled(np.asarray(self.catalogue_mass_kg, dtype=np.float64) / one.mass_kg)
        everything = one.scaled(self.count)
        if np.all(np.asarray(self.pitch_radius_mm) == 0.0):
            return everything
        half = 0.5 * everything.mass_kg * np.square(np.asarray(self.pitch_radius_mm) * 1e-3)
        around = np.zeros((*half.shape, 3, 3))
        around[..., 0, 0] = around[..., 1, 1] = half
        # Averaged over all angles, the part's own x-y moments are those of a round body centred on the axis.
        second = everything.second_kg_m2.copy()
        mean = 0.5 * (second[..., 0, 0] + second[..., 1, 1])
        second[..., 0, 0] = second[..., 1, 1] = mean
        second[..., 0, 1] = second[..., 1, 0] = 0.0
        first = everything.first_kg_m.copy()
        first[..., :2] = 0.0
        return MassProperties(mass_kg=everything.mass_kg, first_kg_m=first, second_kg_m2=second + around)


# What most parts of links and base are made of, and how.
sheet_part = partial(Part, material=MATERIALS.aluminium, grade=ALLOYS["aw_6082_t6"], process="laser cut")
machined_part = partial(Part, material=MATERIALS.aluminium, grade=ALLOYS["aw_6082_t6"], process="machined")
strong_part = partial(Part, material=MATERIALS.aluminium, grade=ALLOYS["aw_7075_t6"], process="machined")
steel_part = partial(Part, material=MATERIALS.steel, process="bought")


# The actuators of a map have some 1,500 parts, which are asked for in the same order for either joint.
@lru_cache(maxsize=8192)
def _remembered(part: Part) -> MassProperties:
    """Return the mass properties of a part of plain numbers, computed once: most depend on no link's length."""
    return part._everywhere()


def _uniform(solids: tuple[Prism | Ball | Bevel, ...], density_kg_per_m3: float) -> MassProperties:
    """Return the mass properties of solids of one density about the origin, in SI."""
    columns = zip(*(solid.integrals() for solid in solids), strict=True)
    sums = [np.asarray(reduce(np.add, column), dtype=np.float64) for column in columns]
    m, mx, my, mz, xx, yy, zz, xy, xz, yz = np.broadcast_arrays(*sums)
    rho = density_kg_per_m3 * 1e-9  # kg per mm3; each length in a moment adds 1e-3
    return MassProperties(
        mass_kg=m * rho,
        first_kg_m=np.stack([mx, my, mz], axis=-1) * (rho * 1e-3),
        second_kg_m2=np.stack([xx, xy, xz, xy, yy, yz, xz, yz, zz], axis=-1).reshape(*m.shape, 3, 3) * (rho * 1e-6),
    )

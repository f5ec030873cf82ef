"""What the process that holds the CAD kernel answers to the questions of ``client``."""

from functools import lru_cache

import numpy as np
from OCP.BRepBuilderAPI import BRepBuilderAPI_Copy
from OCP.BRepCheck import BRepCheck_Analyzer
from OCP.BRepGProp import BRepGProp
from OCP.GProp import GProp_GProps

from pareto_monoped.cad.kernel import step
from pareto_monoped.cad.kernel.client import SolidFacts, StepAssembly
from pareto_monoped.cad.kernel.solids import solid_from, solid_of, solids_in
from pareto_monoped.geometry.features import Bevel
from pareto_monoped.geometry.parts import Ball, Part, Prism


def solid_facts(parts: list[Part]) -> list[SolidFacts]:
    """Facts of the solids of some parts, in their order."""
    return [_facts(part.prisms, part.balls, part.bevels) for part in parts]


def step_files(assembly: StepAssembly) -> tuple[bytes, dict[str, bytes]]:
    """The STEP file of the assembly, and those of its unique parts by name."""
    parts = {
        name: _part_file(part.prisms, part.balls, part.bevels, name, step.Substance.of(part))
        for name, part in assembly.parts.items()
    }
    solids = {name: solid_of(part) for name, part in assembly.parts.items()}
    # Parts of one geometry share a solid in the cache; a document would take them for one.
    compounds = {
        name: BRepBuilderAPI_Copy(solid).Shape() for name, solid in solids.items() if len(solids_in(solid)) > 1
    }
    return step.assembly_step(assembly, parts, compounds), parts


# As many as ``solid_from`` keeps: 20 MB at most.
@lru_cache(maxsize=256)
def _part_file(
    prisms: tuple[Prism, ...], balls: tuple[Ball, ...], bevels: tuple[Bevel, ...], name: str, substance: step.Substance
) -> bytes:
    return step.part_step(solid_from(prisms, balls, bevels), name, substance)


# As many as ``solid_from`` keeps.
@lru_cache(maxsize=256)
def _facts(prisms: tuple[Prism, ...], balls: tuple[Ball, ...], bevels: tuple[Bevel, ...]) -> SolidFacts:
    solid = solid_from(prisms, balls, bevels)
    properties = GProp_GProps()
    BRepGProp.VolumeProperties_s(solid, properties)
    centre, matrix = properties.CentreOfMass(), properties.MatrixOfInertia()
    return SolidFacts(
        valid=bool(BRepCheck_Analyzer(solid, True).IsValid()),
        bodies=len(solids_in(solid)),
        volume_mm3=properties.Mass(),
        centre_mm=np.array([centre.X(), centre.Y(), centre.Z()]),
        inertia_mm5=np.array([[matrix.Value(i, j) for j in (1, 2, 3)] for i in (1, 2, 3)]),
    )

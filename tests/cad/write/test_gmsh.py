"""The STEP assembly in a program that had no part in writing it: gmsh, with its own kernel, where it is installed."""

import csv
from collections import Counter

import pytest

gmsh = pytest.importorskip("gmsh", reason="gmsh is not installed; it reads the STEP assembly as a second program")

DENSITIES_KG_PER_MM3 = {"aluminium": 2710e-9, "printed plastic": 1430e-9, "gear steel": 7850e-9}


@pytest.fixture
def session():
    gmsh.initialize(interruptible=False)
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.option.setNumber("Geometry.OCCImportLabels", 1)
    yield gmsh.model
    gmsh.finalize()


def test_gmsh_finds_every_part_by_its_name_with_its_mass_in_millimetres(exported, session):
    session.occ.importShapes(str(exported.folder / "assembly.step"))
    session.occ.synchronize()
    with (exported.folder / "bom.csv").open(newline="") as stream:
        rows = {row["part"]: row for row in csv.DictReader(stream)}
    volumes = session.getEntities(3)
    # Such as Shapes/monoped/thigh/thigh/thigh_core/thigh_core: each label once for the instance, once for its product.
    names = [session.getEntityName(*volume).split("/") for volume in volumes]
    assert {name[1] for name in names} == {"monoped"}
    assert Counter(name[-1] for name in names) == {name: int(row["count"]) for name, row in rows.items()}
    compared = 0
    for volume, name in zip(volumes, names, strict=True):
        row = rows[name[-1]]
        if row["made_or_bought"] == "made" and row["material"] in DENSITIES_KG_PER_MM3:
            mass_g = 1e3 * session.occ.getMass(*volume) * DENSITIES_KG_PER_MM3[row["material"]]
            assert mass_g == pytest.approx(float(row["mass_g"]), rel=2e-3, abs=0.006), name[-1]
            compared += 1
    assert compared > 30

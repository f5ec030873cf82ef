"""Which file of an export holds what."""

from collections.abc import Collection, Mapping, Sequence
from concurrent.futures import Future
from pathlib import Path
from typing import Any

import numpy as np

from pareto_monoped.cad.assembly import ACTUATOR_UNITS
from pareto_monoped.cad.drawing import drawings
from pareto_monoped.cad.kernel import client as kernel
from pareto_monoped.cad.picture import scenes
from pareto_monoped.cad.picture.drawing import png
from pareto_monoped.cad.product import Product
from pareto_monoped.cad.write import dxf, meshes, mjcf, urdf
from pareto_monoped.cad.write.dxf import stand_files
from pareto_monoped.cad.write.folder import safe, write
from pareto_monoped.cad.write.meshes import METRES, Visual, colliders
from pareto_monoped.cad.write.mjcf import jump_record, replay_script
from pareto_monoped.design import Design
from pareto_monoped.jump.calibration import Calibration, on_stand
from pareto_monoped.jump.document import mjcf as simulated_mjcf
from pareto_monoped.jump.model import start_pose
from pareto_monoped.robot.population import RobotArrays


def part_meshes(product: Product) -> dict[str, bytes]:
    """Return the STL file of every unique part, by the part's name."""
    return {unique.name: meshes.stl(unique.mesh) for unique in product.unique}


def other_meshes(product: Product, shown: Sequence[Visual], formats: Collection[str]) -> dict[str, bytes]:
    """Return content by path of all other files with triangles; ``shown`` are the models' visual meshes."""
    made: dict[str, bytes] = {}
    if "3mf" in formats:
        printed = [unique for unique in product.unique if unique.part.process == "3D printed"]
        made |= {f"print/{safe(unique.name)}.3mf": meshes.threemf(unique.mesh, unique.name) for unique in printed}
    if "glb" in formats:
        made["assembly.glb"] = meshes.glb(product)
    return made | {f"model/meshes/{safe(visual.name)}.stl": meshes.stl(visual.mesh, scale=METRES) for visual in shown}


def write_meshes(
    folder: Path, part_files: Mapping[str, bytes], other_files: Mapping[str, bytes], formats: Collection[str]
) -> None:
    """Write the very bytes that were checked, the parts' STL files only if they are wanted."""
    if "stl" in formats:
        for name, content in part_files.items():
            write(folder, f"parts/stl/{safe(name)}.stl", content)
    for path, content in other_files.items():
        write(folder, path, content)


def write_drawings(folder: Path, product: Product, record: Mapping[str, Any], formats: Collection[str]) -> None:
    """Write the drawing of the assembly, the laser drawings of the flat parts, and the arms of the test stand."""
    if "pdf" in formats:
        write(folder, "drawings/assembly.pdf", drawings.assembly_drawing(product, drawings.origin_of(record)))
    if "dxf" not in formats:
        return
    for unique in product.unique:
        if dxf.is_flat(unique.part):
            write(folder, f"laser/{safe(unique.name)}.dxf", dxf.dxf(unique.part))
    for path, content in stand_files(product.robot.leg, record).items():
        write(folder, path, content)


def write_models(
    folder: Path,
    product: Product,
    shown: Sequence[Visual],
    arrays: RobotArrays,
    design: Design,
    calibration: Calibration,
    formats: Collection[str],
) -> None:
    """Write URDF, MJCF and what its jumps need; no MJCF of a robot that cannot stand, as it has no jump.

    There are two MJCF files and two jumps: under the calibration, and on the test stand.
    """
    if not {"mjcf", "urdf"} & set(formats):
        return
    solid = colliders(product)
    if "mjcf" in formats:
        for place, known in (("", calibration), ("_stand", on_stand(calibration))):
            if np.isfinite(start_pose(arrays, known).hip_rad[0]):
                document = mjcf.mjcf_with_meshes(simulated_mjcf(arrays, known), shown, solid)
                write(folder, f"model/monoped{place}.xml", document)
                write(folder, f"model/jump{place}.json", jump_record(arrays, design, known))
                write(folder, "model/replay.py", replay_script())
    if "urdf" in formats:
        write(folder, "model/monoped.urdf", urdf.urdf(arrays, calibration.joints, shown, solid))


def pictures(product: Product) -> dict[str, Future[bytes]]:
    """Return PNG files by name, which the kernel's process draws from now on."""
    shown = {
        "assembly.png": scenes.assembly_scene(product),
        "exploded.png": scenes.exploded_scene(product),
        **{f"{unit}_section.png": scenes.section_scene(product, unit) for unit in ACTUATOR_UNITS},
        "knee_joint_section.png": scenes.knee_scene(product),
    }
    return {name: kernel.do(_drawing, scene) for name, scene in shown.items()}


def _drawing(scene: scenes.Scene) -> bytes:
    return png(scene.picture())

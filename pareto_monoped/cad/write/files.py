"""Which file of an export holds what."""

from collections.abc import Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path

import numpy as np

from pareto_monoped.cad.picture import scenes
from pareto_monoped.cad.picture.drawing import png
from pareto_monoped.cad.product import Product
from pareto_monoped.cad.write import dxf, mjcf, triangles, urdf, visuals
from pareto_monoped.cad.write.folder import safe, write
from pareto_monoped.jump.calibration import Calibration
from pareto_monoped.jump.model import mjcf as simulated_mjcf
from pareto_monoped.jump.pose import start_pose
from pareto_monoped.robot.population import RobotArrays


def write_geometry(folder: Path, product: Product, formats: Sequence[str]) -> None:
    """Write the meshes and laser drawings of all parts, and the assembly's mesh."""
    for unique in product.unique:
        name = safe(unique.name)
        if "stl" in formats:
            write(folder, f"parts/stl/{name}.stl", triangles.stl(unique.mesh))
        if "3mf" in formats and unique.part.process == "3D printed":
            write(folder, f"print/{name}.3mf", triangles.threemf(unique.mesh, unique.name))
        if "dxf" in formats and dxf.is_flat(unique.part):
            write(folder, f"laser/{name}.dxf", dxf.dxf(unique.part))
    if "glb" in formats:
        write(folder, "assembly.glb", triangles.glb(product))


def write_solids(folder: Path, assembly: bytes, parts: Mapping[str, bytes]) -> None:
    """Write the STEP files that the kernel made: of the assembly, and of each unique part by its name."""
    write(folder, "assembly.step", assembly)
    for name, content in parts.items():
        write(folder, f"parts/step/{safe(name)}.step", content)


def write_models(
    folder: Path, product: Product, arrays: RobotArrays, calibration: Calibration, formats: Sequence[str]
) -> None:
    """Write MJCF, URDF and the meshes that both show; no MJCF of a robot that cannot stand, as it has no jump."""
    if not {"mjcf", "urdf"} & set(formats):
        return
    shown, solid = visuals.visuals(product), visuals.colliders(product)
    for visual in shown:
        write(folder, f"model/meshes/{safe(visual.name)}.stl", triangles.stl(visual.mesh, scale=1e-3))
    if "mjcf" in formats and np.isfinite(start_pose(arrays, calibration).hip_rad[0]):
        document = mjcf.mjcf_with_meshes(simulated_mjcf(arrays, calibration), shown, solid)
        write(folder, "model/monoped.xml", document)
    if "urdf" in formats:
        write(folder, "model/monoped.urdf", urdf.urdf(arrays, shown, solid))


def pictures(product: Product) -> dict[str, Future[bytes]]:
    """PNG files by name, which a thread draws from now on."""
    shown = {
        "assembly.png": scenes.assembly_scene(product),
        "knee_actuator_section.png": scenes.section_scene(product, "knee_actuator"),
    }
    thread = ThreadPoolExecutor(max_workers=1)
    drawn = {name: thread.submit(_drawing, scene) for name, scene in shown.items()}
    thread.shutdown(wait=False)
    return drawn


def _drawing(scene: scenes.Scene) -> bytes:
    return png(scene.picture())

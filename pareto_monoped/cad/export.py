"""Export a design: build it as it can be built, check it, and write one folder that is either whole or not there."""

import json
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from pareto_monoped.actuator.search import ActuatorMap
from pareto_monoped.cad.assembly import Pose
from pareto_monoped.cad.check.checks import Check, run_checks
from pareto_monoped.cad.kernel import client as kernel
from pareto_monoped.cad.picture import scenes
from pareto_monoped.cad.picture.drawing import png
from pareto_monoped.cad.product import Product, build_product, step_tree
from pareto_monoped.cad.write import documents, dxf, models, triangles
from pareto_monoped.cad.write.documents import FORMATS
from pareto_monoped.cad.write.folder import RECORD, beside, files_in, move_in, require_free, safe, write
from pareto_monoped.design import Design
from pareto_monoped.errors import CheckError, DesignError, InputError
from pareto_monoped.jump.calibration import Calibration
from pareto_monoped.jump.evaluate import Evaluator
from pareto_monoped.jump.model import mjcf
from pareto_monoped.jump.pose import start_pose
from pareto_monoped.leg.dimensions import LegDimensions, leg_dimensions
from pareto_monoped.robot.build import Robot, build_robot
from pareto_monoped.robot.population import RobotArrays, robot_arrays

LENGTH_STEP_M = 1e-4
"""Link lengths are made to 0.1 mm."""
_REST = Pose(hip_rad=-0.8, knee_rad=1.6)  # shown when the robot cannot stand in its start pose


@dataclass(frozen=True, slots=True, kw_only=True)
class ExportSummary:
    """What an export made.

    Attributes:
        folder: where.
        record: the content of its ``design.json``.
        checks: all of them passed.
        files: paths relative to the folder.
    """

    folder: Path
    record: dict[str, Any]
    checks: tuple[Check, ...]
    files: tuple[str, ...]


def export_design(
    design: Design,
    actuator_map: ActuatorMap,
    calibration: Calibration,
    out_dir: Path,
    *,
    formats: Sequence[str] | None = None,
    force: bool = False,
    hip_rad: float | None = None,
    knee_rad: float | None = None,
    source: Mapping[str, Any] | None = None,
    progress: Callable[[str], None] = lambda _: None,
) -> ExportSummary:
    """Build, check and write everything about one design.

    Args:
        design: as searched; it is built with lengths of whole 0.1 mm and the real ratios, and simulated again.
        actuator_map: the gearboxes.
        calibration: the jump model, for the re-simulation and the MJCF.
        out_dir: the folder to make; its parent is made too.
        formats: some of ``FORMATS``; default all.
        force: replace the files of an earlier export there. Other files in the folder stay.
        hip_rad: angle of the hip in the assembly, in place of the start pose's.
        knee_rad: the same of the knee.
        source: where the design comes from, written into ``design.json``.
        progress: told what is being done.

    Raises:
        InputError: an unknown format.
        OutputError: the folder is not empty and ``force`` is not given, or cannot be written.
        DesignError: the robot cannot be built, or its actuators do not fit one leg.
        CheckError: a check failed; nothing is written.
    """
    wanted = chosen_formats(formats)
    require_free(out_dir, force=force)
    kernel.start()
    built = as_built(design, actuator_map)
    robot = build_robot(built, actuator_map)
    _require_fit(robot, leg_dimensions(actuator_map))
    arrays = robot_arrays(built.as_array(), actuator_map, calibration.mass)
    pose = _pose(arrays, calibration, hip_rad, knee_rad)
    progress("building")
    product = build_product(robot, pose)
    # The kernel builds and writes solids in its process, a thread draws, and the rest is done here.
    solids = kernel.step_files(step_tree(product, "monoped")) if "step" in wanted else None
    pictures = _drawn(product) if "png" in wanted else {}
    progress("simulating")
    jumps = _jumps({"searched": design, "as_built": built}, actuator_map, calibration)
    progress("checking")
    checks = run_checks(product, robot_arrays(built.as_array(), actuator_map))
    failures = [failure for check in checks for failure in check.failures]
    if failures:
        more = f" (and {len(failures) - 3} more)" if len(failures) > 3 else ""
        raise CheckError(f"export of {out_dir}: {'; '.join(failures[:3])}{more}; nothing was written")
    record = documents.design_record(
        searched=design,
        built=built,
        robot=robot,
        pose=pose,
        jumps=jumps,
        calibration=calibration,
        source=source,
        formats=wanted,
    )
    progress("writing")
    with beside(out_dir) as folder:
        _write_geometry(folder, product, wanted)
        _write_models(folder, product, arrays, calibration, wanted)
        write(folder, "bom.csv", documents.bom(product))
        write(folder, "checks.json", documents.checks_record(checks))
        write(folder, "README.md", documents.readme(record, product, checks, wanted))
        for name, picture in pictures.items():
            write(folder, name, picture.result())
        if solids is not None:
            _write_solids(folder, *solids.result())
        record["files"] = [*files_in(folder), RECORD]
        write(folder, RECORD, json.dumps(record, indent=2) + "\n")
        move_in(folder, out_dir)
    return ExportSummary(folder=out_dir, record=record, checks=checks, files=tuple(record["files"]))


def as_built(design: Design, actuator_map: ActuatorMap) -> Design:
    """The design with link lengths of whole 0.1 mm and the ratios that its gearboxes really have."""
    return design.replace(
        {
            "thigh_length_m": round(round(design.thigh_length_m / LENGTH_STEP_M) * LENGTH_STEP_M, 4),
            "shank_length_m": round(round(design.shank_length_m / LENGTH_STEP_M) * LENGTH_STEP_M, 4),
            "hip_ratio": actuator_map.lookup(design.hip_ratio).ratio,
            "knee_ratio": actuator_map.lookup(design.knee_ratio).ratio,
        }
    )


def _require_fit(robot: Robot, leg: LegDimensions) -> None:
    """A motor's leg is drilled for one bolt circle at either end, and its chain carries so much."""
    drilled = {
        "bolt circle": 2.0 * leg.mount_pitch_radius_mm,
        "back's bolt circle": 2.0 * leg.back_pitch_radius_mm,
    }
    for joint, actuator in (("hip", robot.hip), ("knee", robot.knee)):
        mount = actuator.mount
        circles = (mount.bolts.pitch_circle_mm, mount.back_bolts.pitch_circle_mm)
        for (name, allowed), circle in zip(drilled.items(), circles, strict=True):
            if abs(circle - allowed) > 0.05:
                raise DesignError(
                    f"{name} of the {joint} actuator = {circle:.1f} mm: must be {allowed:.1f} mm, for which this "
                    f"motor's leg is drilled; choose ratios of one family, or give {actuator.motor.name} a frame as "
                    "wide as its frameless kit"
                )
    torque, allowed = robot.knee.peak_torque_n_m, leg.chain.torque_limit_n_m
    if torque > allowed:
        raise DesignError(
            f"peak torque of the knee actuator = {torque:.1f} N m: must be at most {allowed:.1f} N m, half of what "
            f"breaks the thigh's chain ({leg.chain.name}); choose a lower knee_ratio"
        )


def chosen_formats(names: Sequence[str] | None) -> tuple[str, ...]:
    """The formats asked for, in the order of ``FORMATS``; all of them for None.

    Raises:
        InputError: an unknown name.
    """
    if names is None:
        return FORMATS
    for name in names:
        if name not in FORMATS:
            raise InputError(f"format {name!r}: must be one of {', '.join(FORMATS)}; correct the name")
    return tuple(name for name in FORMATS if name in names)


def _jumps(
    designs: Mapping[str, Design], actuator_map: ActuatorMap, calibration: Calibration
) -> dict[str, dict[str, Any]]:
    values = np.stack([design.as_array() for design in designs.values()])
    results = Evaluator(actuator_map, calibration)(values)
    return {
        name: {
            "status": str(results.status[k]),
            "reason": results.reason[k],
            "height_m": documents.plain(results.height_m[k]),
            "energy_j": documents.plain(results.energy_j[k]),
        }
        for k, name in enumerate(designs)
    }


def _pose(arrays: RobotArrays, calibration: Calibration, hip_rad: float | None, knee_rad: float | None) -> Pose:
    start = start_pose(arrays, calibration)
    stands = bool(np.isfinite(start.hip_rad[0]))
    hip = float(start.hip_rad[0]) if stands else _REST.hip_rad
    knee = float(start.knee_rad[0]) if stands else _REST.knee_rad
    return Pose(hip_rad=hip if hip_rad is None else hip_rad, knee_rad=knee if knee_rad is None else knee_rad)


def _drawn(product: Product) -> dict[str, Future[bytes]]:
    """The pictures, as soon as a thread has drawn them."""
    shown = {
        "assembly.png": scenes.assembly_scene(product),
        "knee_actuator_section.png": scenes.section_scene(product, "knee_actuator"),
    }
    thread = ThreadPoolExecutor(max_workers=1)
    pictures = {name: thread.submit(_drawing, scene) for name, scene in shown.items()}
    thread.shutdown(wait=False)
    return pictures


def _drawing(scene: scenes.Scene) -> bytes:
    return png(scene.picture())


def _write_geometry(folder: Path, product: Product, formats: Sequence[str]) -> None:
    for kind in product.unique:
        name = safe(kind.name)
        if "stl" in formats:
            write(folder, f"parts/stl/{name}.stl", triangles.stl(kind.mesh))
        if "3mf" in formats and kind.part.process == "3D printed":
            write(folder, f"print/{name}.3mf", triangles.threemf(kind.mesh, kind.name))
        if "dxf" in formats and dxf.is_flat(kind.part):
            write(folder, f"laser/{name}.dxf", dxf.dxf(kind.part))
    if "glb" in formats:
        write(folder, "assembly.glb", triangles.glb(product))


def _write_solids(folder: Path, assembly: bytes, parts: Mapping[str, bytes]) -> None:
    write(folder, "assembly.step", assembly)
    for name, content in parts.items():
        write(folder, f"parts/step/{safe(name)}.step", content)


def _write_models(
    folder: Path, product: Product, arrays: RobotArrays, calibration: Calibration, formats: Sequence[str]
) -> None:
    if not {"mjcf", "urdf"} & set(formats):
        return
    shown, solid = models.visuals(product), models.colliders(product)
    for visual in shown:
        write(folder, f"model/meshes/{safe(visual.name)}.stl", triangles.stl(visual.mesh, scale=1e-3))
    # A robot that cannot stand has no start pose and so no jump model.
    if "mjcf" in formats and np.isfinite(start_pose(arrays, calibration).hip_rad[0]):
        document = models.mjcf_with_meshes(mjcf(arrays, calibration), shown, solid)
        write(folder, "model/monoped.xml", document)
    if "urdf" in formats:
        write(folder, "model/monoped.urdf", models.urdf(arrays, shown, solid))

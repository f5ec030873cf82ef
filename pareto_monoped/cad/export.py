"""Export a design: build it as it can be built, check it, and write one folder that is either whole or not there."""

import json
import os
import re
import shutil
import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from pareto_monoped.actuator.search import ActuatorMap
from pareto_monoped.cad import documents, drawing, models, scenes, step, trianglefiles
from pareto_monoped.cad.assembly import Pose
from pareto_monoped.cad.checks import Check, run_checks
from pareto_monoped.cad.documents import FORMATS
from pareto_monoped.cad.picture import png
from pareto_monoped.cad.product import Product, build_product
from pareto_monoped.design import Design
from pareto_monoped.errors import CheckError, DesignError, InputError, OutputError
from pareto_monoped.jump.calibration import Calibration
from pareto_monoped.jump.evaluate import Evaluator
from pareto_monoped.jump.model import mjcf
from pareto_monoped.jump.pose import start_pose
from pareto_monoped.leg.dimensions import LegDimensions
from pareto_monoped.robot import Robot, RobotArrays, build_robot, leg_dimensions, robot_arrays

LENGTH_STEP_M = 1e-4
"""Link lengths are made to 0.1 mm."""
RECORD = "design.json"
_REST = Pose(hip_rad=-0.8, knee_rad=1.6)  # shown when the robot cannot stand in its start pose
_SAFE_NAME = re.compile(r"[a-z0-9_]+")


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
    built = as_built(design, actuator_map)
    robot = build_robot(built, actuator_map)
    _require_fit(robot, leg_dimensions(actuator_map))
    arrays = robot_arrays(built.as_array(), actuator_map, calibration.mass)
    progress("simulating")
    jumps = _jumps({"searched": design, "as_built": built}, actuator_map, calibration)
    pose = _pose(arrays, calibration, hip_rad, knee_rad)
    progress("building")
    product = build_product(robot, pose)
    # Drawing is array work that another thread does while the CAD kernel checks and writes.
    drawing_thread = ThreadPoolExecutor(max_workers=1)
    pictures = {
        name: drawing_thread.submit(_drawn, scene)
        for name, scene in (_scenes(product) if "png" in wanted else {}).items()
    }
    drawing_thread.shutdown(wait=False)
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
    with _beside(out_dir) as folder:
        _write_geometry(folder, product, wanted)
        for name, picture in pictures.items():
            _write(folder, name, picture.result())
        _write_models(folder, product, arrays, calibration, wanted)
        _write(folder, "bom.csv", documents.bom(product))
        _write(folder, "checks.json", documents.checks_record(checks))
        _write(folder, "README.md", documents.readme(record, product, checks, wanted))
        files = sorted(str(path.relative_to(folder)) for path in folder.rglob("*") if path.is_file())
        record["files"] = [*files, RECORD]
        _write(folder, RECORD, json.dumps(record, indent=2) + "\n")
        _move_in(folder, out_dir)
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


def require_free(out_dir: Path, *, force: bool) -> None:
    """Refuse a place that must not be written to.

    Raises:
        OutputError: a file, or a folder that is not empty without ``force``.
    """
    if out_dir.exists() and not out_dir.is_dir():
        raise OutputError(f"output {str(out_dir)!r}: is a file; give the name of a folder")
    if out_dir.is_dir() and any(out_dir.iterdir()) and not force:
        raise OutputError(
            f"output {str(out_dir)!r}: is not empty; give another folder, or --force to replace an export"
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
    torque, allowed = robot.knee.peak_torque_n_m, leg.chain_torque_limit_n_m
    if torque > allowed:
        raise DesignError(
            f"peak torque of the knee actuator = {torque:.1f} N m: must be at most {allowed:.1f} N m, half of what "
            f"breaks the thigh's chain ({leg.chain_name}); choose a lower knee_ratio"
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


def _drawn(scene: scenes.Scene) -> bytes:
    return png(scene.picture())


def _scenes(product: Product) -> dict[str, scenes.Scene]:
    return {
        "assembly.png": scenes.assembly_scene(product),
        "knee_actuator_section.png": scenes.section_scene(product, "knee_actuator"),
    }


def _write_geometry(folder: Path, product: Product, formats: Sequence[str]) -> None:
    for kind in product.unique:
        name = _safe(kind.name)
        if "step" in formats:
            _write(folder, f"parts/step/{name}.step", step.part_step(kind.solid, kind.name, kind.part.material.colour))
        if "stl" in formats:
            _write(folder, f"parts/stl/{name}.stl", trianglefiles.stl(kind.mesh))
        if "3mf" in formats and kind.part.process == "3D printed":
            _write(folder, f"print/{name}.3mf", trianglefiles.threemf(kind.mesh, kind.name))
        if "dxf" in formats and drawing.is_flat(kind.part):
            _write(folder, f"laser/{name}.dxf", drawing.dxf(kind.part))
    if "step" in formats:
        _write(folder, "assembly.step", step.assembly_step(product, "monoped"))
    if "glb" in formats:
        _write(folder, "assembly.glb", trianglefiles.glb(product))


def _write_models(
    folder: Path, product: Product, arrays: RobotArrays, calibration: Calibration, formats: Sequence[str]
) -> None:
    if not {"mjcf", "urdf"} & set(formats):
        return
    shown, solid = models.visuals(product), models.colliders(product)
    for visual in shown:
        _write(folder, f"model/meshes/{_safe(visual.name)}.stl", trianglefiles.stl(visual.mesh, scale=1e-3))
    # A robot that cannot stand has no start pose and so no jump model.
    if "mjcf" in formats and np.isfinite(start_pose(arrays, calibration).hip_rad[0]):
        document = models.mjcf_with_meshes(mjcf(arrays, calibration), shown, solid)
        _write(folder, "model/monoped.xml", document)
    if "urdf" in formats:
        _write(folder, "model/monoped.urdf", models.urdf(arrays, shown, solid))


def _safe(name: str) -> str:
    """A name that cannot lead out of the folder.

    Raises:
        OutputError: it could.
    """
    if not _SAFE_NAME.fullmatch(name):
        raise OutputError(f"part name {name!r}: must be letters, digits and underscores to become a file; rename it")
    return name


def _path(folder: Path, name: str) -> Path:
    path = folder / name
    path.parent.mkdir(parents=True, exist_ok=True)
    return path


def _write(folder: Path, name: str, content: str | bytes) -> None:
    path = _path(folder, name)
    if isinstance(content, str):
        path.write_text(content, encoding="utf-8", newline="\n")
    else:
        path.write_bytes(content)


@contextmanager
def _beside(out_dir: Path) -> Iterator[Path]:
    """A temporary folder beside the target; what is still in it when the block ends is deleted."""
    try:
        out_dir.parent.mkdir(parents=True, exist_ok=True)
        folder = Path(tempfile.mkdtemp(prefix=f".{out_dir.name}-", dir=out_dir.parent))
    except OSError as error:
        reason = error.strerror or str(error)
        raise OutputError(f"output {str(out_dir)!r}: cannot be written ({reason}); give a writable folder") from error
    try:
        # mkdtemp makes folders private; an export is meant to be read like any other folder of the user.
        umask = os.umask(0)
        os.umask(umask)
        folder.chmod(0o777 & ~umask)
        yield folder
    except OSError as error:
        reason = error.strerror or str(error)
        raise OutputError(
            f"output {str(out_dir)!r}: cannot be written ({reason}); make room or give another"
        ) from error
    finally:
        shutil.rmtree(folder, ignore_errors=True)


def _move_in(folder: Path, out_dir: Path) -> None:
    """Put a finished folder in its place, instead of the files of an earlier export; other files stay."""
    if not out_dir.exists() or not any(out_dir.iterdir()):
        folder.replace(out_dir)
        return
    for path in _earlier_files(out_dir):
        path.unlink(missing_ok=True)
    for path in sorted(folder.rglob("*")):
        if path.is_file() and path.name != RECORD:
            path.replace(_path(out_dir, str(path.relative_to(folder))))
    # Last, so that a folder with a record is whole.
    (folder / RECORD).replace(out_dir / RECORD)


def _earlier_files(out_dir: Path) -> list[Path]:
    """Files that an earlier export wrote here, its record first."""
    try:
        names = json.loads((out_dir / RECORD).read_text(encoding="utf-8"))["files"]
        paths = [(out_dir / RECORD).resolve(), *((out_dir / str(name)).resolve() for name in names)]
    except (OSError, ValueError, KeyError, TypeError):
        return []
    # The record is a file like any other: it may not point outside.
    return [path for path in paths if path.is_relative_to(out_dir.resolve()) and path.is_file()]

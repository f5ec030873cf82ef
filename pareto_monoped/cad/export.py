"""Export a design: build it as it can be built, check it, and write one folder that is either whole or not there.

The kernel's process makes solids, drawings and pictures while this one simulates and checks.
"""

import gc
import json
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from concurrent.futures import Future
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from pareto_monoped.actuator.ratiomap import Maps, joint_maps
from pareto_monoped.cad.as_built import built_of, design_record
from pareto_monoped.cad.check.result import Check
from pareto_monoped.cad.check.run import run_checks
from pareto_monoped.cad.drawing.drawings import Origin, origin_of, part_drawings
from pareto_monoped.cad.kernel import client as kernel
from pareto_monoped.cad.picture.drawing import prepare
from pareto_monoped.cad.product import ListedPart, Product, build_product, step_assembly
from pareto_monoped.cad.write import files
from pareto_monoped.cad.write.assembly_pack import assembly_pack
from pareto_monoped.cad.write.folder import RECORD, beside, chosen_formats, files_in, move_in, require_free, safe, write
from pareto_monoped.cad.write.living import living_model
from pareto_monoped.cad.write.meshes import visuals
from pareto_monoped.cad.write.readme import readme
from pareto_monoped.cad.write.tables import chain_table, checks_record, parts_list, strength_table
from pareto_monoped.design import LENGTHS, Design
from pareto_monoped.errors import CheckError
from pareto_monoped.jump.calibration import Calibration, on_stand
from pareto_monoped.jump.evaluate import Evaluations, Evaluator
from pareto_monoped.jump.landing import in_words
from pareto_monoped.jump.model import rail_friction_n
from pareto_monoped.leg.dimensions import leg_dimensions
from pareto_monoped.leg.stand import stand_mass_kg
from pareto_monoped.robot.population import robot_arrays
from pareto_monoped.robot.tolerances import robot_chains
from pareto_monoped.strength.factors import GearLife, gear_life, joint_factors
from pareto_monoped.strength.joint import LOAD_NAMES, Loads, loads_of

_AT_ONCE = 6  # drawings in a question: few, so that both processes end at about the same time
_NAMED_FAILURES = 3  # more would not fit on a line


@dataclass(frozen=True, slots=True, kw_only=True)
class Ordered:
    """Files that are being made, their contents by path or name; None for what is not wanted."""

    solids: Future[tuple[bytes, dict[str, bytes]]] | None  #: STEP files of the assembly, and of the parts by name
    pack: Future[dict[str, bytes]] | None  #: the assembly pack: content by path
    sheets: Sequence[Future[dict[str, bytes]]]  #: the parts' drawings by name, some in each
    pictures: Mapping[str, Future[bytes]]  #: PNG files by name

    def write(self, folder: Path) -> None:
        """Do here what the kernel's process has not begun, wait for the rest, and write everything."""
        kernel.help_out()
        for sheets in self.sheets:
            for name, content in sheets.result().items():
                write(folder, f"drawings/{safe(name)}.pdf", content)
        if self.pack is not None:
            for path, content in self.pack.result().items():
                write(folder, path, content)
        for name, picture in self.pictures.items():
            write(folder, name, picture.result())
        if self.solids is not None:
            assembly, parts = self.solids.result()
            write(folder, "assembly.step", assembly)
            for name, content in parts.items():
                write(folder, f"parts/step/{safe(name)}.step", content)


def order(product: Product, record: Mapping[str, Any], formats: Collection[str]) -> Ordered:
    """Ask for the files of the kernel's process; ``record`` is for title blocks and may lack what is computed last."""
    listed = product.listed
    # The longest first, as the last ones may be done in either process.
    pack = kernel.do(assembly_pack, listed) if "assembly" in formats else None
    solids = kernel.step_files(step_assembly(product, "monoped")) if "step" in formats else None
    sheets = _sheets(listed.unique, origin_of(record)) if "pdf" in formats else ()
    return Ordered(
        solids=solids, pack=pack, sheets=sheets, pictures=files.pictures(product) if "png" in formats else {}
    )


def _sheets(parts: Sequence[ListedPart], origin: Origin) -> list[Future[dict[str, bytes]]]:
    """Ask for the drawings of all parts that are made."""
    made = [part for part in parts if part.part.process != "bought"]
    return [
        kernel.do(part_drawings, made[start : start + _AT_ONCE], origin, start + 1)
        for start in range(0, len(made), _AT_ONCE)
    ]


@dataclass(frozen=True, slots=True, kw_only=True)
class ExportSummary:
    """What an export made."""

    folder: Path
    record: dict[str, Any]  #: the content of its ``design.json``
    checks: tuple[Check, ...]  #: all of them passed
    files: tuple[str, ...]  #: paths relative to the folder
    gear_life: GearLife | None  #: of the gears under strikes, where it is known


def export_design(
    design: Design,
    maps: Maps,
    calibration: Calibration,
    out_dir: Path,
    *,
    formats: Sequence[str] | None = None,
    force: bool = False,
    hip_rad: float | None = None,
    knee_rad: float | None = None,
    source: Mapping[str, Any] | None = None,
    strength: bool = False,
    progress: Callable[[str], None] = lambda _: None,
) -> ExportSummary:
    """Build, check and write everything about one design.

    It is built with lengths of whole 0.1 mm and real ratios, and simulated again, in the start pose of its jump or at
    the given angles. With ``force`` the files of an earlier export are replaced; other files in the folder stay. With
    ``strength`` a design with a joint below its required safety factor is refused; the factors are listed either way.
    ``source`` stands in ``design.json``. ``progress`` is called with the name of each step as it begins.

    Raises:
        InputError: an unknown format.
        OutputError: the folder is not empty and ``force`` is not given, or cannot be written.
        DesignError: the robot cannot be built, or its actuators do not fit one leg.
        CheckError: a check failed; nothing is written.
    """
    wanted = chosen_formats(formats)
    require_free(out_dir, force=force)
    with _collecting_rarely(), _second_process(draws=bool({"assembly", "png"} & set(wanted))):
        built = built_of(design, maps, calibration, hip_rad=hip_rad, knee_rad=knee_rad)
        progress("building")
        product = build_product(built.robot, built.pose)
        record = design_record(
            searched=design,
            built=built,
            maps=joint_maps(maps),
            calibration=calibration,
            source=source,
            formats=wanted,
            strength=strength,
        )
        ordered = order(product, record, wanted)
        progress("simulating")
        designs = {"searched": design, "as_built": built.design}
        results = _evaluated(designs, maps, calibration)
        loads = _loads(built.design, results, list(designs).index("as_built"))
        factors = joint_factors(built.design, maps, loads)
        life = gear_life(built.design, maps, loads)
        landing = in_words(built.design.as_array(), maps, calibration)
        record["jumps"] = _jumps(designs, results) | _jump_on_stand(built.design, maps, calibration)
        progress("checking")
        shown = visuals(product) if {"mjcf", "urdf"} & set(wanted) else ()
        part_files, other_files = files.part_meshes(product), files.other_meshes(product, shown, wanted)
        checks = run_checks(
            product,
            robot_arrays(built.design.as_array(), maps),
            part_files=part_files,
            other_files=other_files,
            factors=factors if strength else None,
        )
        _require_passed(checks, out_dir)
        progress("writing")
        with beside(out_dir) as folder:
            files.write_meshes(folder, part_files, other_files, wanted)
            files.write_drawings(folder, product, record, wanted)
            files.write_models(folder, product, shown, built.arrays, built.design, calibration, wanted)
            living = living_model(product, maps)
            write(folder, "bom.csv", parts_list(product, factors))
            write(folder, "strength.csv", strength_table(factors))
            write(folder, "tolerances.csv", chain_table(robot_chains(built.robot)))
            write(folder, "cad/model.py", living.program)
            write(folder, "parameters.csv", living.parameters_csv)
            write(folder, "monoped_equations.txt", living.equations)
            write(folder, "checks.json", checks_record(checks))
            write(folder, "README.md", readme(record, product, checks, record["formats"], factors, life, landing))
            ordered.write(folder)
            record["files"] = [*files_in(folder), RECORD]
            write(folder, RECORD, json.dumps(record, indent=2) + "\n")
            move_in(folder, out_dir)
    return ExportSummary(folder=out_dir, record=record, checks=checks, files=tuple(record["files"]), gear_life=life)


@contextmanager
def _collecting_rarely() -> Iterator[None]:
    """Look for unreachable objects as rarely as the kernel's process does."""
    before = gc.get_threshold()
    gc.set_threshold(kernel.COLLECT_AFTER)
    try:
        yield
    finally:
        gc.set_threshold(*before)


@contextmanager
def _second_process(*, draws: bool) -> Iterator[None]:
    """Start the kernel's process; after an exception nobody waits for it."""
    kernel.start()
    if draws:
        kernel.do(prepare)
    try:
        yield
    except BaseException:
        kernel.give_up()
        raise


def _require_passed(checks: Sequence[Check], out_dir: Path) -> None:
    failures = [failure for check in checks for failure in check.failures]
    if failures:
        rest = len(failures) - _NAMED_FAILURES
        more = f" (and {rest} more)" if rest > 0 else ""
        raise CheckError(f"export of {out_dir}: {'; '.join(failures[:_NAMED_FAILURES])}{more}; nothing was written")


def simulated_jumps(designs: Mapping[str, Design], maps: Maps, calibration: Calibration) -> dict[str, dict[str, Any]]:
    """Return status, reason and some measures of some designs' jumps, by the designs' names, as JSON values.

    The design ``as_built`` jumps on the test stand as well.
    """
    jumps = _jumps(designs, _evaluated(designs, maps, calibration))
    return jumps | _jump_on_stand(designs["as_built"], maps, calibration)


def _jump_on_stand(design: Design, maps: Maps, calibration: Calibration) -> dict[str, dict[str, Any]]:
    known, designs = on_stand(calibration), {"stand": design}
    (jump,) = _jumps(designs, _evaluated(designs, maps, known)).values()
    held = {"mass_kg": stand_mass_kg(leg_dimensions(maps)), "rail_friction_n": rail_friction_n(known)}
    return {"stand": jump | held}


def _evaluated(designs: Mapping[str, Design], maps: Maps, calibration: Calibration) -> Evaluations:
    return Evaluator(maps, calibration.by("mujoco"))(np.stack([design.as_array() for design in designs.values()]))


def _loads(design: Design, results: Evaluations, row: int) -> Loads:
    """Return the loads of a design's parts, from a row of the results of its jump."""
    columns = {name: getattr(results, name)[row : row + 1] for name in LOAD_NAMES if name not in LENGTHS}
    return loads_of(columns | {name: np.array([getattr(design, name)]) for name in LENGTHS})


def _jumps(designs: Mapping[str, Design], results: Evaluations) -> dict[str, dict[str, Any]]:
    return {
        name: {
            "status": str(results.status[k]),
            "reason": results.reason[k],
            **{name: _plain(results.of(name)[k]) for name in ("height_m", "energy_j", "gear_strike_safety")},
        }
        for k, name in enumerate(designs)
    }


def _plain(value: float) -> float | None:
    """Return a JSON number, or None where there is none."""
    return float(value) if np.isfinite(value) else None

"""What leaves the program: an export of one design, the report of studies, and a film of a jump."""

import warnings
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from numpy.typing import ArrayLike

from pareto_monoped.api.given import html_of, number_of, one_design, truth_of
from pareto_monoped.api.jumps import (
    AnyCalibration,
    AnyMotor,
    StrPath,
    build_robot,
    calibrated,
    joint_maps_of,
    trace,
)
from pareto_monoped.api.studies import Picked, StoredStudy, as_path, as_place, load_study
from pareto_monoped.definition.given import as_list
from pareto_monoped.design import PAPER_MOTOR, Design, RuleSet
from pareto_monoped.errors import InputError, complaint, require_extra
from pareto_monoped.jump.calibration_defaults import DEFAULT, strength_for

if TYPE_CHECKING:
    from pandas import DataFrame


class Export(dict[str, Any]):
    """What an export wrote: the content of its ``design.json`` by key, and its folder.

    Example:
        >>> import pareto_monoped as pm
        >>> made = pm.Export("case_c", {"mass_kg": 4.77, "files": ["design.json"]})
        >>> made, made["mass_kg"], [path.name for path in made.files]
        (Export('case_c', 1 files, 4.77 kg), 4.77, ['design.json'])
    """

    def __init__(self, folder: StrPath, record: Mapping[str, Any]) -> None:
        super().__init__(record)
        self.folder = Path(folder)  #: where it is

    @property
    def files(self) -> list[Path]:
        """Everything that was written, ``design.json`` last."""
        return [self.folder / name for name in self["files"]]

    def __repr__(self) -> str:
        """Return one line: the folder, how much is in it, and the robot's mass."""
        return f"Export({str(self.folder)!r}, {len(self['files'])} files, {self['mass_kg']:.2f} kg)"

    def _repr_html_(self) -> str:
        """Return folder, mass and jumps, for notebooks."""
        facts: dict[str, object] = {"mass": f"{self['mass_kg']:.2f} kg", "files": len(self["files"])}
        for name, jump in self.get("jumps", {}).items():
            facts[name.replace("_", " ")] = f"{jump['height_m']:.4f} m, {jump['energy_j']:.3f} J"
        return html_of(f"export {self.folder}", facts)


def export(
    design: "Design | Mapping[str, Any] | DataFrame | ArrayLike",
    folder: StrPath,
    *,
    motor: AnyMotor = PAPER_MOTOR,
    hip_motor: AnyMotor | None = None,
    knee_motor: AnyMotor | None = None,
    calibration: AnyCalibration = DEFAULT,
    rules: RuleSet | None = None,
    formats: Sequence[str] | None = None,
    force: bool = False,
    strength: bool | None = None,
) -> Export:
    """Write CAD, drawings, models, pictures and parts list of a design to a folder.

    The design is built with lengths rounded to 0.1 mm and the real ratios of its gearboxes, then simulated again and
    checked. Nothing is written if a check fails.

    Args:
        design: its variables, in one of the forms that ``trace`` takes. For a trial of a study use ``export_trial``,
            which takes the study's own motors.
        folder: where to; made if missing.
        motor: of both joints: a motor, the name of a shipped one, or a TOML file.
        hip_motor: of the hip, instead of ``motor``.
        knee_motor: of the knee, likewise.
        calibration: the jump model.
        rules: of the gearboxes; by default those that go with the calibration.
        formats: some of step, stl, 3mf, dxf, glb, mjcf, urdf, pdf, assembly, png; by default all.
        force: replace an earlier export there.
        strength: whether every joint must have its required safety factor; by default as for a study with this
            calibration.

    Returns:
        The folder, with the content of its ``design.json``.

    Raises:
        InputError: an unknown format, an unusable motor or calibration, or a folder that holds something else.
        CheckError: the design cannot be built as it stands; the message says what does not hold.

    Example:
        >>> import pareto_monoped as pm
        >>> record = pm.export(pm.PAPER_CASES["C"].design, "case_c", formats=["step"])  # doctest: +SKIP
        >>> print(f"{record['mass_kg']:.2f} kg")  # doctest: +SKIP
        4.77 kg
    """
    require_extra("cad", "CAD")
    from pareto_monoped.cad.batch import run
    from pareto_monoped.cad.jobs import Job
    from pareto_monoped.cad.write.folder import chosen_formats

    model, chosen = calibrated(calibration, rules)
    maps = joint_maps_of(motor, hip_motor, knee_motor, chosen)
    one = one_design(design, maps)
    job = Job(
        design=one,
        motor=maps.hip.motor,
        knee_motor=maps.knee.motor if maps.knee is not maps.hip else None,
        calibration=model,
        rules=chosen,
        folder=as_path(folder, "folder"),
        formats=chosen_formats(as_list(formats)),
        force=truth_of("force", force),
        source={"design": one.as_dict()},
        strength=strength_for(model.name) if strength is None else truth_of("strength", strength),
    )
    return Export(job.folder, run(job))


def export_trial(
    study: StoredStudy | StrPath,
    trial: int | Picked,
    folder: StrPath,
    *,
    formats: Sequence[str] | None = None,
    force: bool = False,
    strength: bool | None = None,
) -> Export:
    """Write CAD, drawings, models, pictures and parts list of a trial, with the motors and calibration of its study.

    Args:
        study: the study or its database.
        trial: its number, or what ``pick`` returned.
        folder: see ``export``.
        formats: see ``export``.
        force: see ``export``.
        strength: see ``export``; by default as the study asked.

    Returns:
        The folder, with the content of its ``design.json``.

    Raises:
        SelectionError: no such trial.
        InputError: see ``export``.
        CheckError: see ``export``.

    Example:
        >>> import pareto_monoped as pm
        >>> knee = pm.load_study("light.db").pick("knee")
        >>> record = pm.export_trial("light.db", knee, "knee", formats=["mjcf", "urdf"])  # doctest: +SKIP
    """
    require_extra("cad", "CAD")
    from pareto_monoped.cad.batch import run
    from pareto_monoped.cad.jobs import trial_job

    stored = study if isinstance(study, StoredStudy) else load_study(study)
    number = trial.trial if isinstance(trial, Picked) else trial
    stored.design(number)  # refuses a number that the study does not have
    job = trial_job(
        stored.data,
        number,
        folder=as_path(folder, "folder"),
        formats=as_list(formats),
        force=truth_of("force", force),
        strength=None if strength is None else truth_of("strength", strength),
    )
    return Export(job.folder, run(job))


def write_report(
    studies: StoredStudy | StrPath | Sequence[StoredStudy | StrPath],
    out: StrPath,
    *,
    exports: StrPath | None = None,
    figures: StrPath | None = None,
    jumps: bool = True,
    force: bool = False,
) -> None:
    """Write the report of one study or several: one HTML page that works without a network.

    Args:
        studies: one study or database, or several that are compared.
        out: the HTML file.
        exports: folder of exported designs, ``exports/trial_N``, which the page shows.
        figures: folder for figures for print, as SVG and PNG.
        jumps: whether the page has the jumps of the fronts' designs; without them it is quicker made, and smaller.
        force: replace a file that is not a report.

    Raises:
        DatabaseError: a database that is missing, damaged, or no study.
        InputError: what is given is neither a study nor a path.
        OutputError: the file cannot be written, or must not be replaced.

    Example:
        >>> import pareto_monoped as pm
        >>> pm.write_report("light.db", "light.html")
    """
    from pareto_monoped.files import refuse_database, write_text
    from pareto_monoped.report.page import page, payload_of

    several = [studies] if isinstance(studies, str) or not isinstance(studies, Sequence) else studies
    allowed = "a study as load_study returns it, the path of its database, or a list of these"
    dbs = [one.path if isinstance(one, StoredStudy) else as_place(one, "studies", allowed=allowed) for one in several]
    target = as_path(out, "out")
    replace = truth_of("force", force)
    refuse_database(target)
    shown = None if exports is None else as_path(exports, "exports")
    payload = payload_of(dbs, exports=shown, most_jumps=None if truth_of("jumps", jumps) else 0, note=warnings.warn)
    write_text(target, page(payload), force=replace)
    if figures is not None:
        from pareto_monoped.report.figures import write_figures

        write_figures(payload, as_path(figures, "figures"), force=replace)


def film(
    design: "Design | Mapping[str, Any] | DataFrame | ArrayLike",
    out: StrPath,
    *,
    motor: AnyMotor = PAPER_MOTOR,
    hip_motor: AnyMotor | None = None,
    knee_motor: AnyMotor | None = None,
    calibration: AnyCalibration = DEFAULT,
    rules: RuleSet | None = None,
    slower: float = 6.0,
    force: bool = False,
) -> Path:
    """Draw the jump of a design with heights and torques beside it, as an animated picture or a video.

    Args:
        design: its variables, in one of the forms that ``trace`` takes.
        out: the file; its ending, .gif, .mp4 or .webm, says which. Videos need ffmpeg, or the extra ``video``.
        motor: see ``simulate``.
        hip_motor: see ``simulate``.
        knee_motor: see ``simulate``.
        calibration: see ``simulate``.
        rules: see ``simulate``.
        slower: how many times slower than the jump it is, 1 to 100.
        force: replace a file of another kind.

    Returns:
        The file.

    Raises:
        DesignError: see ``trace``.
        InputError: another ending, an unusable motor or calibration, or the extra ``cad`` is missing.
        OutputError: the file cannot be written, or must not be replaced.

    Example:
        >>> import pareto_monoped as pm
        >>> pm.film(pm.PAPER_CASES["C"].design, "case_c.gif")  # doctest: +SKIP
    """
    require_extra("cad", "CAD")
    from pareto_monoped.cad.film import VIDEOS, require_video, write_gif, write_video
    from pareto_monoped.cad.film import film as pictures_of

    path, replace, pace = as_path(out, "out"), truth_of("force", force), number_of("slower", slower)
    if not 1.0 <= pace <= 100.0:
        raise InputError(complaint("slower", slower, "1 to 100", "correct it"))
    is_gif = path.suffix.lower() == ".gif"
    if not is_gif:
        if path.suffix.lower() not in VIDEOS:
            raise InputError(complaint("out", str(path), f"a file ending in .gif, {' or '.join(VIDEOS)}", "correct it"))
        require_video(path)
    steps = trace(
        design,
        motor=motor,
        hip_motor=hip_motor,
        knee_motor=knee_motor,
        calibration=calibration,
        rules=rules,
    )
    robot = build_robot(
        design, motor=motor, hip_motor=hip_motor, knee_motor=knee_motor, rules=calibrated(calibration, rules)[1]
    )
    columns = {str(name): steps[name].to_numpy() for name in steps}
    (write_gif if is_gif else write_video)(path, pictures_of(robot, columns, slower=pace), force=replace)
    return path

"""What leaves the program: an export of one design, and the report of studies."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from numpy.typing import ArrayLike

from pareto_monoped.api.given import one_design, truth_of
from pareto_monoped.api.jumps import AnyCalibration, AnyMotor, StrPath, calibrated, joint_maps_of
from pareto_monoped.api.studies import Picked, StoredStudy, as_path, as_place, load_study
from pareto_monoped.definition.given import as_list
from pareto_monoped.design import PAPER_MOTOR, Design, RuleSet
from pareto_monoped.errors import require_extra
from pareto_monoped.jump.calibration_defaults import DEFAULT, strength_for

if TYPE_CHECKING:
    from pandas import DataFrame


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
) -> dict[str, Any]:
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
        The content of its ``design.json``.

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
    return run(job)


def export_trial(
    study: StoredStudy | StrPath,
    trial: int | Picked,
    folder: StrPath,
    *,
    formats: Sequence[str] | None = None,
    force: bool = False,
    strength: bool | None = None,
) -> dict[str, Any]:
    """Write CAD, drawings, models, pictures and parts list of a trial, with the motors and calibration of its study.

    Args:
        study: the study or its database.
        trial: its number, or what ``pick`` returned.
        folder: see ``export``.
        formats: see ``export``.
        force: see ``export``.
        strength: see ``export``; by default as the study asked.

    Returns:
        The content of its ``design.json``.

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
    return run(
        trial_job(
            stored.data,
            number,
            folder=as_path(folder, "folder"),
            formats=as_list(formats),
            force=truth_of("force", force),
            strength=None if strength is None else truth_of("strength", strength),
        )
    )


def write_report(
    studies: StoredStudy | StrPath | Sequence[StoredStudy | StrPath], out: StrPath, *, force: bool = False
) -> None:
    """Write the report of one study or several: one HTML page that works without a network.

    Args:
        studies: one study or database, or several that are compared.
        out: the HTML file.
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
    write_text(target, page(payload_of(dbs)), force=replace)

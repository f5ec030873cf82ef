"""What to export: jobs from a row of the paper's Table I, or from the trials of a study."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Required, TypedDict, Unpack

from pareto_monoped.actuator.motor import Motor
from pareto_monoped.actuator.ratiomap import JointMaps
from pareto_monoped.actuator.search import map_of
from pareto_monoped.cad.write.folder import FORMATS, chosen_formats
from pareto_monoped.design import ALL_NAMES, DEFAULT_RULES, PAPER_CASES, PAPER_MOTOR, Design, RuleSet
from pareto_monoped.jump.calibration import Calibration, load_calibration
from pareto_monoped.jump.calibration_defaults import DEFAULT, strength_for
from pareto_monoped.leg.thigh_outline import maps_for

if TYPE_CHECKING:
    from pareto_monoped.storage.reader import StudyData


@dataclass(frozen=True, slots=True, kw_only=True)
class Job:
    """One design to export: everything that another process needs."""

    design: Design  #: as searched
    motor: Motor  #: of both actuators, or of the hip's where ``knee_motor`` is another one
    calibration: Calibration  #: the jump model
    rules: RuleSet = DEFAULT_RULES  #: of the gearboxes
    folder: Path  #: where to
    formats: tuple[str, ...] = FORMATS  #: of ``FORMATS``, in its order
    force: bool = False  #: replace an export of something else
    source: dict[str, Any]  #: where the design comes from
    strength: bool = False  #: refuse it if a joint has less than its required safety factor
    hip_rad: float | None = None  #: angle of the hip in the assembly, instead of that of the start pose
    knee_rad: float | None = None  #: angle of the knee, likewise
    knee_motor: Motor | None = None  #: of the knee's actuator; None where both have the same

    def maps(self) -> JointMaps:
        """Return the gearboxes of both joints; ``MotorError`` if a motor has none."""
        hip = map_of(self.motor, self.rules)
        return JointMaps(hip=hip, knee=hip if self.knee_motor is None else map_of(self.knee_motor, self.rules))


class How(TypedDict, total=False):
    """Fields of ``Job`` that do not depend on where its design comes from."""

    folder: Required[Path]
    force: bool
    hip_rad: float | None
    knee_rad: float | None


def case_job(
    case: str,
    *,
    motor: str = PAPER_MOTOR,
    knee_motor: str | None = None,
    rules: RuleSet = DEFAULT_RULES,
    formats: Sequence[str] | None = None,
    strength: bool | None = None,
    **how: Unpack[How],
) -> Job:
    """Return the job for a row of the paper's Table I with the default calibration, our best model of that robot.

    ``strength`` defaults to that of a study with this calibration; ``How`` has the other arguments.

    Raises:
        InputError: an unknown format.
        MotorError: an unknown or impossible motor, or one that no gearbox or no leg fits.
    """
    maps = maps_for(motor, knee_motor or motor, rules)
    return Job(
        design=PAPER_CASES[case].design,
        motor=maps.hip.motor,
        knee_motor=maps.knee.motor if maps.knee is not maps.hip else None,
        calibration=load_calibration(DEFAULT),
        rules=rules,
        formats=chosen_formats(formats),
        source={"case": case},
        strength=strength_for(DEFAULT) if strength is None else strength,
        **how,
    )


def trial_job(
    data: "StudyData",
    trial: int,
    *,
    formats: Sequence[str] | None = None,
    strength: bool | None = None,
    **how: Unpack[How],
) -> Job:
    """Return the job for one trial of a study, with its motors and its calibration as the study stores them.

    ``strength`` defaults to what the study asks; ``How`` has the other arguments.

    Raises:
        InputError: an unknown format.
        DatabaseError: the study's motor or calibration is damaged.
    """
    row, kit = data.trials.loc[data.trials["trial"] == trial].iloc[0], data.kit_of_trial(trial)
    return Job(
        design=Design(**{name: row[name] for name in ALL_NAMES if name in row}),
        motor=kit.hip.motor,
        knee_motor=kit.knee.motor if kit.knee is not kit.hip else None,
        calibration=data.calibration,
        rules=data.study.rules,
        formats=chosen_formats(formats),
        source={
            "study": data.study.name,
            "trial": int(trial),
            "date": data.meta.created[:10],
            "content_hash": data.content_hash,
            "sealed": data.sealed,
        },
        strength=data.study.strength if strength is None else strength,
        **how,
    )


def front_jobs(data: "StudyData", *, folder: Path, every: int = 1, **how: Any) -> list[Job]:
    """Return the jobs for the designs on a study's front, from the lowest jump to the highest.

    ``folder`` gets a folder ``trial_N`` per design; only each ``every``-th design is taken, beginning with the first.
    ``how`` is as for ``trial_job``.

    Raises:
        InputError: an unknown format.
        DatabaseError: the study's motor or calibration is damaged.
    """
    trials = data.front()["trial"].astype(int).tolist()[::every]
    return [trial_job(data, trial, folder=folder / f"trial_{trial}", **how) for trial in trials]

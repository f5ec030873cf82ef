"""How stored designs jump as robots are built, from scripts."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from numpy.typing import ArrayLike

from pareto_monoped.api.given import seed_of, trial_of
from pareto_monoped.api.jumps import StrPath
from pareto_monoped.api.studies import Picked, StoredStudy, as_path, load_study
from pareto_monoped.errors import InputError, complaint
from pareto_monoped.study.counts import count_of
from pareto_monoped.study.plain import as_list

if TYPE_CHECKING:
    from pandas import DataFrame


def robust(
    study: StoredStudy | StrPath,
    trials: int | Picked | Sequence[int | Picked] | ArrayLike | None = None,
    *,
    samples: int | None = None,
    seed: int | None = None,
    uncertainty: StrPath | None = None,
    workers: int | None = None,
) -> "DataFrame":
    """Let designs of a study jump as robots are built: masses, motors, friction, gains and more within their ranges.

    All designs have the same samples. What is stored of earlier calls, also of the command ``robust``, is not simulated
    again.

    Args:
        study: the study or its database.
        trials: a trial by its number or as ``pick`` returned it, or several, such as a column ``trial``; by default the
            front.
        samples: jumps per design, a power of two of at least 256; by default 256, or the study's if it asks for more.
        seed: of the samples, by default the study's.
        uncertainty: TOML file of the ranges; by default the study's, or the shipped ones.
        workers: threads that simulate, all cores if None. It does not change the results.

    Returns:
        One row per trial, with ``trial``, ``samples``, ``failed_share`` and ``overloaded_share`` (shares of the jumps
        that fail, and that overload a part), and for every measure its ``.mean``, ``.p05`` and ``.p95``, such as
        ``height_m.p05``, in the unit of its name; NaN where a measure has no value in some jump.

    Raises:
        SelectionError: a trial that is not there or did not jump, or an empty front.
        InputError: too few samples, or no usable ranges.
        StudyError: this code or machine computes other jumps than the stored ones.
        DatabaseError: the study is missing, damaged, or in use by another process.

    Example:
        >>> import pareto_monoped as pm
        >>> knee = pm.load_study("light.db").pick("knee")
        >>> built = pm.robust("light.db", knee)
        >>> bool(built["height_m.p05"][0] < knee.row.height_m)
        True
    """
    import pandas as pd

    from pareto_monoped.measures import MEASURE_NAMES, STATISTICS
    from pareto_monoped.study.robustness import robust as run_robust
    from pareto_monoped.uncertainty.ranges import load_uncertainty
    from pareto_monoped.uncertainty.samples import DEFAULT_SAMPLES
    from pareto_monoped.uncertainty.settings import Sampling

    stored = study if isinstance(study, StoredStudy) else load_study(study)
    own = stored.study.uncertainty or Sampling(ranges=load_uncertainty())
    results = run_robust(
        stored.path,
        own.ranges if uncertainty is None else load_uncertainty(as_path(uncertainty)),
        trials=_numbers(trials),
        samples=count_of("samples", samples) or max(own.samples, DEFAULT_SAMPLES),
        seed=own.seed if seed is None else seed_of(seed),
        workers=count_of("workers", workers),
    )
    rows: list[dict[str, Any]] = []
    for number, result in results.items():
        row: dict[str, Any] = {"trial": number, "samples": result.samples}
        row |= {"failed_share": result.failed, "overloaded_share": result.overloaded}
        for name in MEASURE_NAMES:
            spread = result.measures.get(name)
            row |= {f"{name}.{key}": float("nan") if spread is None else getattr(spread, key) for key in STATISTICS}
        rows.append(row)
    return pd.DataFrame(rows)


def _numbers(trials: Any) -> list[int] | None:
    """Numbers of trials."""
    if trials is None:
        return None
    listed = as_list(trials)
    several = list(listed) if isinstance(listed, Sequence) and not isinstance(listed, str | bytes) else [listed]
    if not several:
        raise InputError(complaint("number of trials", 0, "at least 1", "name one, or leave it out for the front"))
    return [one.trial if isinstance(one, Picked) else trial_of(one) for one in several]

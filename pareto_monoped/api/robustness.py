"""What built robots do: designs of a study under uncertainty, what moves them most, and whether a study is sound."""

import re
from collections.abc import Sequence
from concurrent.futures import Executor
from typing import TYPE_CHECKING, Any

from numpy.typing import ArrayLike

from pareto_monoped.api.given import executor_of, number_of, seed_of, trial_of
from pareto_monoped.api.jumps import StrPath
from pareto_monoped.api.studies import Picked, StoredStudy, as_path, as_place, load_study
from pareto_monoped.definition.given import as_list, count_of
from pareto_monoped.errors import InputError, complaint

if TYPE_CHECKING:
    from pandas import DataFrame

    from pareto_monoped.analysis.verify import Verification
    from pareto_monoped.storage.extra_rows import Limit
    from pareto_monoped.uncertainty.settings import Uncertainty


def robust(
    study: StoredStudy | StrPath,
    trials: int | Picked | Sequence[int | Picked] | ArrayLike | None = None,
    *,
    samples: int | None = None,
    seed: int | None = None,
    uncertainty: StrPath | None = None,
    workers: int | None = None,
    executor: Executor | None = None,
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
        executor: does the jumps in their place, such as ``concurrent.futures.ProcessPoolExecutor``.

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

    from pareto_monoped.analysis.robustness import robust as run_robust
    from pareto_monoped.analysis.robustness import sampling
    from pareto_monoped.measures import MEASURE_NAMES, STATISTICS

    stored = study if isinstance(study, StoredStudy) else load_study(study)
    ranges, number, own_seed = sampling(
        stored.study, _ranges(uncertainty), count_of("samples", samples), None if seed is None else seed_of(seed)
    )
    results = run_robust(
        stored.path,
        ranges,
        trials=_numbers(trials),
        samples=number,
        seed=own_seed,
        workers=count_of("workers", workers),
        executor=executor_of(executor),
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


def sensitivity(
    study: StoredStudy | StrPath,
    trial: int | Picked,
    *,
    samples: int = 256,
    within: float = 0.02,
    seed: int | None = None,
    uncertainty: StrPath | None = None,
    workers: int | None = None,
    executor: Executor | None = None,
) -> "DataFrame":
    """Say which variable and which assumption about the robot as built moves a design most.

    What is stored of earlier calls, also of the command ``sensitivity``, is not simulated again.

    Args:
        study: the study or its database.
        trial: the number of a trial, or what ``pick`` returned.
        samples: base samples, a power of two; each takes a jump per factor, and two more.
        within: how far variables move to either side, as a share of their ranges.
        seed: of the samples, by default the study's.
        uncertainty: TOML file of the ranges; by default the study's, or the shipped ones.
        workers: threads that simulate, all cores if None. It does not change the results.
        executor: does the jumps in their place, see ``run``.

    Returns:
        One row per factor: ``about`` (variables or assumptions), ``name``, ``label``, ``lower``, ``upper``, ``unit``,
        ``tolerance`` (whether it is one of what is made); and for every measure its ``.change`` from end to end of the
        range, ``.first`` and ``.total`` (Sobol' indices) and ``.error``, half the width of the 95 percent interval.

    Raises:
        SelectionError: a trial that is not there or did not jump.
        InputError: a number out of range, or too many jumps that fail.
        StudyError: this code or machine computes other jumps than the stored ones.
        DatabaseError: the study is missing, damaged, or in use by another process.

    Example:
        >>> import pareto_monoped as pm
        >>> stored = pm.load_study("light.db")
        >>> found = pm.sensitivity(stored, stored.pick(min_height_m=0.7), samples=32)
        >>> sorted(set(found.about)), bool((found["height_m.total"] >= 0).any())
        (['assumptions', 'variables'], True)
    """
    import pandas as pd

    from pareto_monoped.analysis.robustness import sampling
    from pareto_monoped.analysis.sensitivity import sensitivity as find

    stored = study if isinstance(study, StoredStudy) else load_study(study)
    own_seed = None if seed is None else seed_of(seed)
    ranges, _, chosen_seed = sampling(stored.study, _ranges(uncertainty), None, own_seed)
    found = find(
        stored.path,
        trial.trial if isinstance(trial, Picked) else trial_of(trial),
        ranges,
        blocks=count_of("samples", samples) or 256,
        within=number_of("within", within),
        seed=chosen_seed,
        workers=count_of("workers", workers),
        executor=executor_of(executor),
    )
    rows = [
        {"about": one["about"], **factor["factor"]}
        | {f"{name}.{key}": value for name, of in factor["measures"].items() for key, value in of.items()}
        for one in (each.as_dict() for each in found)
        for factor in one["factors"]
    ]
    return pd.DataFrame(rows)


def status(study: StoredStudy | StrPath) -> dict[str, Any]:
    """Return how a study stands, also while it runs: state, trials, front, hypervolume, speed, settings and hashes.

    Args:
        study: the study or its database, which is read anew.

    Raises:
        DatabaseError: the study is missing or damaged.

    Example:
        >>> import pareto_monoped as pm
        >>> now = pm.status("light.db")
        >>> now["state"], now["evaluations"]
        ('finished', 200)
    """
    from pareto_monoped.storage.status import status as status_of

    return status_of(study.path if isinstance(study, StoredStudy) else as_place(study, "study"))


def verify(
    study: StoredStudy | StrPath,
    *,
    simulate: int = 0,
    expect: str | None = None,
    workers: int | None = None,
    executor: Executor | None = None,
) -> "Verification":
    """Check that nothing in a study has been lost or changed.

    Args:
        study: the study or its database, which is read anew.
        simulate: how many trials jump again and are compared.
        expect: the content hash that it must have, or its first 16 digits or more.
        workers: threads that simulate, all cores if None.
        executor: does the jumps in their place, see ``run``.

    Returns:
        What was checked, with the content hash.

    Raises:
        DatabaseError: the study is missing, damaged, or not the one that is expected.
        InputError: no content hash, or no number of trials.

    Example:
        >>> import pareto_monoped as pm
        >>> found = pm.verify("light.db", simulate=2)
        >>> found.trials, found.simulated, found.content_hash == pm.status("light.db")["content_hash"]
        (200, 2, True)
    """
    from pareto_monoped.analysis.verify import require_sound
    from pareto_monoped.analysis.verify import verify as verify_study
    from pareto_monoped.compute.chunks import cores

    db = study.path if isinstance(study, StoredStudy) else as_place(study, "study")
    if expect is not None and not (isinstance(expect, str) and re.fullmatch("[0-9a-f]{16,64}", expect.lower())):
        raise InputError(complaint("expect", expect, "16 to 64 hexadecimal digits, as 'status' has them", "correct it"))
    result = verify_study(
        db,
        simulate=trial_of(simulate),
        expect=None if expect is None else expect.lower(),
        workers=count_of("workers", workers) or cores(),
        executor=executor_of(executor),
    )
    require_sound(db, result)
    return result


def _ranges(uncertainty: StrPath | None) -> "Uncertainty | None":
    from pareto_monoped.uncertainty.settings import load_uncertainty

    return None if uncertainty is None else load_uncertainty(as_path(uncertainty))


def limit(
    study: StoredStudy | StrPath,
    trials: int | Picked | Sequence[int | Picked] | ArrayLike | None = None,
    *,
    designs: int | None = None,
    jumps: int | None = None,
    seed: int = 1,
    workers: int | None = None,
) -> "DataFrame":
    """Find the least energy and the greatest height of the best torque found with the hardware of designs.

    The results are stored with the study; what is there is not searched again.

    Args:
        study: the study or its database.
        trials: a trial or several, such as a column ``trial``; by default the front.
        designs: most designs of the front, evenly spread over it; by default 12.
        jumps: of each of a design's four searches, by default 3,000; fewer find less.
        seed: of the searches; the same one finds the same.
        workers: threads that simulate, all cores if None. It does not change the results.

    Returns:
        One row per trial: ``trial``, ``height_m``, ``energy_j``, ``floor_j`` (which no controller can undercut),
        ``controller_gap`` (percent of the energy that is saved at this height) with ``least_energy_j``, and
        ``greatest_height_m``; the same three with ``_held`` without overloading a part, NaN where none was found.
        ``tracking_energy_j`` is that of the law ``tracking``, and ``reaches``, ``profile_reaches`` and
        ``tracking_reaches`` the shares of robots as built within 5 percent of the height by the virtual leg, by the
        torques over time, and by that law.

    Raises:
        SelectionError: a trial that is not there or did not jump, or an empty front.
        InputError: a number out of range.
        StudyError: the study's designs do not jump under the virtual leg.

    Example:
        >>> import pareto_monoped as pm
        >>> found = pm.limit("light.db", pm.load_study("light.db").pick("knee"), jumps=20)
        >>> bool((found["controller_gap"] >= 0).all())
        True
    """
    import pandas as pd

    from pareto_monoped.analysis.limit import JUMPS, MOST_DESIGNS, chosen, limits

    stored = study if isinstance(study, StoredStudy) else load_study(study)
    most, each = count_of("designs", designs) or MOST_DESIGNS, count_of("jumps", jumps) or JUMPS
    rows = chosen(stored.data, stored.data.front(), _numbers(trials) or [], most)
    found = limits(stored.path, rows, jumps=each, seed=seed_of(seed), workers=count_of("workers", workers))
    return pd.DataFrame([_reached(one) for one in found])


def _reached(one: "Limit") -> dict[str, Any]:
    row: dict[str, Any] = {name: getattr(one, name) for name in ("trial", "height_m", "energy_j", "floor_j")}
    for held in ("", "_held"):
        least, greatest = getattr(one, f"least{held}"), getattr(one, f"greatest{held}")
        gap = getattr(one, f"controller_gap{held}")
        row[f"controller_gap{held}"] = float("nan") if gap is None else gap
        row[f"least_energy{held}_j"] = float("nan") if least is None else least.energy_j
        row[f"greatest_height{held}_m"] = float("nan") if greatest is None else greatest.height_m
    row["tracking_energy_j"] = float("nan") if one.tracking is None else one.tracking.energy_j
    jumps = {"": one, "profile_": one.over_time, "tracking_": one.tracking}
    for name, jump in jumps.items():
        found = None if jump is None else jump.perturbed
        row[f"{name}reaches"] = float("nan") if found is None else found.reaches
    return row


def _numbers(trials: Any) -> list[int] | None:
    if trials is None:
        return None
    listed = as_list(trials)
    several = list(listed) if isinstance(listed, Sequence) and not isinstance(listed, str | bytes) else [listed]
    if not several:
        raise InputError(complaint("number of trials", 0, "at least 1", "name one, or leave it out for the front"))
    return [one.trial if isinstance(one, Picked) else trial_of(one) for one in several]

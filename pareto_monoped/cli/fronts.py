"""Commands that read a front: ``front`` and ``pick``."""

import json
import math
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from pareto_monoped.cli import options
from pareto_monoped.cli.options import CSV_FILE, DATABASE, force_option
from pareto_monoped.cli.selection import condition_options, required, selector_options
from pareto_monoped.cli.terminal import WIDTH, echo, note, wrapped
from pareto_monoped.design import KNOTS, VARIABLES, Variable, in_use
from pareto_monoped.storage.place import StudyPlace

if TYPE_CHECKING:
    from pandas import DataFrame

    from pareto_monoped.analysis.alternatives import Alternative
    from pareto_monoped.analysis.robustness import RobustTrials
    from pareto_monoped.definition.study import Study
    from pareto_monoped.pareto.objectives import Objectives
    from pareto_monoped.pareto.selectors import Condition, MaxEnergy, Selector
    from pareto_monoped.storage.reader import StudyData


def shown_columns(study: "Study", used: "Sequence[Variable]", objectives: "Objectives") -> list[str]:
    """The columns of each design in the output of ``front`` and ``pick``: objectives, variables in use, choices."""
    variables = [variable.name for variable in used]
    return ["trial", *objectives.names, *variables, *_motor_columns(study)]


_MOTORS = ("motor", "hip_motor", "knee_motor")  #: Columns with names of motors.


def _motor_columns(study: "Study") -> tuple[str, ...]:
    """Return the columns that tell designs' motors apart: none where all have the same."""
    if len(study.kits) == 1:
        return ()
    return ("motor",) if study.motor is not None else ("hip_motor", "knee_motor")


@click.command()
@click.argument("db", type=DATABASE)
@condition_options
@click.option("--json", "as_json", is_flag=True, help="Print the designs as JSON.")
@click.option("--csv", "csv_file", type=CSV_FILE, metavar="FILE.csv", help="Write the designs to a CSV file.")
@force_option
@click.option("--all", "include_all", is_flag=True, help="Include designs that failed their audit.")
@click.option(
    "--objectives",
    metavar="A,B",
    shell_complete=options.measures,
    help="Two or three measures to judge by, instead of the study's.",
)
@click.option(
    "--most", type=click.IntRange(min=1), metavar="N", help="At most N designs, evenly spread along the front."
)
def front(
    db: StudyPlace,
    conditions: "tuple[Condition | MaxEnergy, ...]",
    as_json: bool,
    csv_file: Path | None,
    force: bool,
    include_all: bool,
    objectives: str | None,
    most: int | None,
) -> None:
    """List the front: the designs that no other design dominates.

    They stand by their first objective, from the least value to the greatest.

    With conditions it is the front of the designs that meet them, and under other objectives than the study's own it is
    what the trials happen to hold: they were not searched for, and the audit has not seen all of them.
    """
    from pareto_monoped.analysis.remarks import why_no_front
    from pareto_monoped.pareto.pick import condition_on
    from pareto_monoped.pareto.selectors import required_fits
    from pareto_monoped.storage.front_reader import read_front
    from pareto_monoped.storage.kept_front import foreign_note
    from pareto_monoped.storage.reader import read_study

    if objectives is None and not include_all and not conditions:
        kept = read_front(db)
        study, rows, used, sealed, chosen = kept.study, kept.rows, kept.used, kept.sealed, kept.study.objectives
        content_hash = kept.content_hash
        if kept.foreign:
            note(foreign_note(kept.foreign))
    else:
        data = read_study(db)
        study, used, sealed, content_hash = data.study, in_use(data.trials), data.sealed, data.content_hash
        chosen = _objectives(objectives, data)
        wanted = tuple(condition_on(one, chosen) for one in conditions)
        rows = data.front(include_ill_conditioned=include_all, objectives=chosen, conditions=wanted)
        if conditions and not len(rows) and len(data.sound):
            required_fits(data.sound, wanted, chosen)  # says which design is nearest
        if chosen != study.objectives or conditions:
            unaudited = int((~rows["trial"].isin(data.audits["trial"])).sum())
            note(f"designs without an audit: {unaudited} of {len(rows)}")
    say_of_study(study, sealed=sealed)
    if len(rows) == 0 and len((whole := read_study(db)).trials):
        note(why_no_front(whole))
    rows = _spread(rows[shown_columns(study, used, chosen)], most)
    if csv_file is not None:
        from pareto_monoped.files import write_text

        write_text(csv_file, rows.to_csv(index=False, lineterminator="\n"), force=force)
        echo(f"wrote {csv_file} ({len(rows)} designs)", err=True)
    if as_json:
        anchored = rows.assign(study_content_hash=content_hash, study_sealed=sealed)
        echo(json.dumps(anchored.to_dict(orient="records"), indent=2))
    elif csv_file is None:
        _print_table(rows, chosen)
        if most is None and len(rows) > _MANY:
            note(f"the front has {len(rows)} designs; --most 40 shows 40 of them, evenly spread")


_MANY = 100  #: Designs of a table that is told how to be shorter: more than two screens. Our own choice.


def _spread(rows: "DataFrame", most: int | None) -> "DataFrame":
    """Return at most ``most`` rows, evenly spread, with both ends; says how many are left out."""
    if most is None or len(rows) <= most:
        return rows
    import numpy as np

    chosen = np.linspace(0, len(rows) - 1, most).round().astype(int)
    note(f"{most} of the front's {len(rows)} designs, evenly spread; leave out --most to see all")
    return rows.iloc[chosen]


def say_of_study(study: "Study", *, sealed: bool) -> None:
    """Say that designs may not hold, where a study did not ask for it, and that it has no running hash."""
    from pareto_monoped.definition.study import NO_STRENGTH
    from pareto_monoped.storage.seals import UNSEALED

    if not study.strength:
        note(NO_STRENGTH)
    if not sealed:
        note(UNSEALED)


def _objectives(given: str | None, data: "StudyData") -> "Objectives":
    """Return the objectives that an option names, or the study's own."""
    from pareto_monoped.definition.goals import names_of, objectives_of
    from pareto_monoped.errors import SelectionError

    if given is None:
        return data.study.objectives
    chosen = objectives_of(names_of(given), source="--objectives")
    for name in chosen.names:
        if name not in data.trials or (len(data.trials) and data.trials[name].isna().all()):
            raise SelectionError(f"--objectives: no trial of {str(data.db)!r} has a value of {name}; choose another")
    return chosen


def _print_table(rows: "DataFrame", objectives: "Objectives") -> None:
    shown = [variable for variable in (*VARIABLES, *KNOTS) if variable.name in rows.columns]
    heads = [f"{entry.short} {entry.unit}".removesuffix(" 1") for entry in objectives.measures]
    widths = [max(len(head), 8) for head in heads]
    # The motors' names stand last, each in a column as wide as the longest.
    motors = {name: max(map(len, (name, *rows[name]))) for name in _MOTORS if name in rows.columns}
    titles = {name: name for name in motors}
    goal_width = 6 + sum(widths) + len(widths)

    def room() -> int:
        return WIDTH - goal_width - sum(width + 1 for width in motors.values())

    wide = 8 * len(shown) <= room()
    if not wide:
        # With a third objective the usual columns do not fit: three digits of each variable then must do, and short
        # heads of the motors. What still does not fit is left out, the last variables first.
        titles = {name: name.removesuffix("_motor") for name in motors}
        motors = {name: max(map(len, (titles[name], *rows[name]))) for name in motors}
        kept = max(room() // 6, 0)
        if kept < len(shown):
            left = ", ".join(variable.symbol for variable in shown[kept:])
            note(f"{left} do not fit into the table; --csv and --json have all columns")
            shown = shown[:kept]
    number: Callable[[float], str] = (
        (lambda value: f"{value:7.3f}") if wide else (lambda value: f"{round(value, 3):5.3g}")
    )
    symbols = " ".join(f"{variable.symbol:>{7 if wide else 5}}" for variable in shown)
    words = " ".join(f"{head:>{width}}" for head, width in zip(heads, widths, strict=True))
    names = "".join(f" {titles[name]:<{width}}" for name, width in motors.items())
    echo(f"{'trial':>6} {words} {symbols}{names}".rstrip())
    # One more than reports show, in the stored unit.
    decimals = [entry.decimals + 1 + round(math.log10(entry.scale)) for entry in objectives.measures]
    for _, row in rows.iterrows():
        values = " ".join(number(row[variable.name]) for variable in shown)
        goals = " ".join(
            f"{row[name]:{width}.{digits}f}"
            for name, width, digits in zip(objectives.names, widths, decimals, strict=True)
        )
        names = "".join(f" {row[name]:<{width}}" for name, width in motors.items())
        echo(f"{int(row['trial']):6d} {goals} {values}{names}".rstrip())


@click.command()
@click.argument("db", type=DATABASE)
@selector_options
@click.option(
    "--alternatives",
    "count",
    type=click.IntRange(0, 50),
    default=0,
    metavar="N",
    help="Also N designs that cost about as much and differ most.",
)
@click.option(
    "--tolerance",
    type=click.FloatRange(0.0, 100.0),
    default=2.0,
    metavar="PERCENT",
    help="How much worse alternatives may be.  [default: 2]",
)
@click.option("--robust", "by_robust", is_flag=True, help="By what 19 of 20 built robots keep; needs 'robust' before.")
@click.option("--json", "as_json", is_flag=True, help="Print the design as JSON.")
def pick(
    db: StudyPlace, selector: "Selector | None", count: int, tolerance: float, by_robust: bool, as_json: bool
) -> None:
    """Pick one design and say why it was chosen.

    Conditions make the front, and one way to choose takes a design from it; without a way, the best one is taken.
    Measures and variables have their stored names and SI units.
    """
    from pareto_monoped.analysis.at_bounds import binding_limits
    from pareto_monoped.analysis.choices import better_than, choose, choose_of, dear_words, whole
    from pareto_monoped.pareto.trade_offs import one_more
    from pareto_monoped.storage.front_reader import read_front
    from pareto_monoped.storage.reader import read_study

    wanted = required(selector)
    data = read_front(db)
    compared: RobustTrials | None = None
    if by_robust:
        from pareto_monoped.analysis.robustness import as_built
        from pareto_monoped.storage.extra_rows import read_robustness

        stored = read_study(db)
        known, compared = as_built(stored, read_robustness(db), notify=note)
        chosen = choose(known, wanted, notify=note)
    else:
        chosen = choose_of(data, wanted, notify=note)
        stored = chosen.data
    rows, picked = chosen.rows, chosen.picked
    names = shown_columns(data.study, data.used, data.study.objectives)
    # Robustness is known of some designs only, which may lie many steps apart.
    step = one_more(rows, picked.trial, data.study.objectives, between=by_robust)
    limits = binding_limits(chosen.data, picked.trial)
    dear = dear_words(whole(stored, data), rows[rows["trial"] == picked.trial].iloc[0])
    ahead = better_than(rows, picked.trial, data.study.objectives)
    best = None
    if data.limits:
        from pareto_monoped.storage.extra_rows import read_limits  # which imports the simulator

        best = read_limits(db).get(picked.trial)
    others: tuple[Alternative, ...] = ()
    if count:
        from pareto_monoped.analysis.alternatives import alternatives

        others = alternatives(
            read_study(db),
            picked.trial,
            count=count,
            tolerance=0.01 * tolerance,
            conditions=picked.conditions,
            rows=None if compared is None else compared.rows,
        )
    say_of_study(data.study, sealed=data.sealed)
    shares = ["failed_share", "overloaded_share"] if by_robust else []
    row = rows.loc[rows["trial"] == picked.trial, list(dict.fromkeys((*names, *shares)))].to_dict(orient="records")[0]
    if as_json:
        more: dict[str, Any] = {"why": picked.why, "one_more": step.as_dict(), "limits": limits}
        if ahead:
            more["behind"] = ahead
        if dear:
            more["dear"] = dear
        if best is not None:
            more |= {name: getattr(best.result, name) for name in ("controller_gap", "controller_gap_held")}
        if count:
            more["alternatives"] = [other.as_dict() for other in others]
        echo(json.dumps(row | more, indent=2))
        return
    echo(wrapped(picked.why))
    for name in names[1:]:
        echo(f"{name:<34} {row[name]}" if name in _MOTORS else f"{name:<34} {row[name]:.6g}")
    if ahead:
        echo(
            wrapped(f"behind the front: {len(ahead)} of its designs are no worse in any objective, as trial {ahead[0]}")
        )
    if dear:
        echo(wrapped(dear))
    echo(wrapped(step.text()))
    echo(wrapped(f"limits: {'; '.join(limits) or 'none binds'}"))
    if best is not None:
        echo(wrapped(best.result.text()))
    echo(wrapped("landing: left out, the leg is caught at the apex; 'export' says whether the design survives it"))
    if by_robust:
        failed, overloaded = (100.0 * row[name] for name in shares)
        ends = "measures are the worse of their 5th and 95th percentiles"
        echo(wrapped(f"robust: {ends}; {failed:.1f} % of jumps fail, {overloaded:.1f} % overload a part"))
    if count:
        _print_alternatives(others, tolerance)
        if compared is not None:
            many = f"compared are the {len(compared.rows)} designs whose robustness is stored and that rarely fail"
            echo(wrapped(f"{many}; 'robust DB --trial N' adds others"))


def _print_alternatives(others: "tuple[Alternative, ...]", tolerance: float) -> None:
    if not others:
        echo(f"no other design is within {tolerance:g} percent; raise --tolerance")
        return
    echo(f"alternatives within {tolerance:g} percent, the most different first:")
    for other in others:
        values = other.objectives.text(other.values)
        echo(wrapped(f"  trial {other.trial} ({values}): {other.text()}", indent=4))
    if unaudited := sum(not other.audited for other in others):
        note(f"alternatives without an audit: {unaudited} of {len(others)}")

"""Payload -> one self-contained HTML file."""

import base64
import hashlib
import json
from collections.abc import Callable, Sequence
from dataclasses import asdict, is_dataclass
from functools import lru_cache
from importlib import resources
from math import isfinite
from pathlib import Path
from string import Template
from typing import Any

from pareto_monoped.errors import StudyError
from pareto_monoped.files import write_text
from pareto_monoped.report.card import Source
from pareto_monoped.report.context import context_section
from pareto_monoped.report.designs_table import designs_table
from pareto_monoped.report.exports import read_models
from pareto_monoped.report.goals import ask_fields, kind, order
from pareto_monoped.report.payload import build
from pareto_monoped.report.resimulation import frames_for, resimulate
from pareto_monoped.report.schema import Payload
from pareto_monoped.report.tables import cases_table, comparison_tables, head, provenance_tables, published_link, safe
from pareto_monoped.study.place import StudyPlace
from pareto_monoped.study.reader import read_study
from pareto_monoped.study.robust_rows import read_robustness
from pareto_monoped.study.run import default_workers
from pareto_monoped.study.seals import UNSEALED
from pareto_monoped.study.sensitivity_rows import read_sensitivity

SCRIPTS = (
    "dom", "data", "jumps", "state", "subject", "link", "scales", "marks", "plots", "chart", "space", "front", "axes",
    "robust", "ask", "robot", "lines", "detail", "parallel", "table", "search", "viewer",
    "shortlist", "compare", "print", "main",
)  # fmt: skip
"""The page's own scripts, in the order in which they run; together they are one closed scope."""


STYLES = ("style", "choose", "print")
"""The page's style sheets, in the order in which they apply."""


def write_report(dbs: Sequence[StudyPlace], out: Path, *, exports: Path | None = None) -> None:
    """Write the report of one or several studies.

    Args:
        dbs: study databases; several are drawn over each other and compared.
        out: the HTML file.
        exports: folder that holds a folder ``trial_N`` per exported design, for the 3D view.

    Raises:
        DatabaseError: a database that is missing, damaged, or no study.
        StudyError: no database was given.
        OutputError: ``exports`` is not a folder, or ``out`` cannot be written.
    """
    write_text(out, page(payload_of(dbs, exports=exports)))


def payload_of(
    dbs: Sequence[StudyPlace],
    *,
    exports: Path | None = None,
    most_jumps: int | None = None,
    note: Callable[[str], None] = lambda _: None,
) -> Payload:
    """Read the studies and simulate what the page shows beyond them.

    Args:
        dbs: study databases.
        exports: as for ``write_report``.
        most_jumps: how many designs of each front jump on the page; None: all of them.
        note: hears of exports that are left out.

    Raises:
        DatabaseError, StudyError: as ``write_report``.
    """
    if not dbs:
        raise StudyError("databases = 0: must be at least 1; name the database of a study")
    # Everything is read before anything is simulated, so that a wrong name is reported at once.
    studies = [read_study(db) for db in dbs]
    if not all(data.sealed for data in studies):
        note(UNSEALED)
    models = read_models(exports, studies, note=note) if exports is not None else [{} for _ in studies]
    frames = frames_for(sum(len(data.front()) for data in studies))
    again = [resimulate(data, most_jumps=most_jumps, frames=frames, workers=default_workers()) for data in studies]
    sources = [
        Source(
            data=data,
            resimulation=simulated,
            models=found,
            robustness=read_robustness(data.db),
            sensitivities=read_sensitivity(data.db),
        )
        for data, simulated, found in zip(studies, again, models, strict=True)
    ]
    return build(sources, literal_cases())


@lru_cache(maxsize=1)
def literal_cases() -> tuple[dict[str, float | None], ...]:
    """Medians and spread of the paper's cases with the paper's motor under the ``paper`` calibration."""
    from pareto_monoped.actuator.search import map_for
    from pareto_monoped.jump.calibration import load_calibration
    from pareto_monoped.jump.table1 import paper_spreads

    spreads = paper_spreads(map_for("VT8020", "paper"), load_calibration("paper"), perturbations=40)
    return tuple({k: v if isfinite(v) else None for k, v in asdict(spread).items()} for spread in spreads)


def page(payload: Payload) -> str:
    """The whole HTML text."""
    script = "(() => {\n'use strict';\n" + "\n".join(asset(f"{name}.js") for name in SCRIPTS) + "\n})();\n"
    # Only this script may run, whatever else gets into the page, and nothing may be loaded.
    policy = (
        f"default-src 'none'; script-src {fingerprint(script)}; style-src 'unsafe-inline'; "
        "img-src data: blob:; base-uri 'none'; form-action 'none'"
    )
    return Template(asset("page.html")).substitute(
        policy=policy,
        title=safe(payload.title),
        style="".join(asset(f"{name}.css") for name in STYLES),
        head=head(payload),
        kind=safe(kind(payload)),
        fields=ask_fields(payload),
        order=safe(order(payload)),
        comparison=comparison_tables(payload),
        designs=designs_table(payload),
        published_link=published_link(payload),
        cases=cases_table(payload),
        context=context_section(payload),
        provenance=provenance_tables(payload),
        version=safe(payload.version),
        payload=embedded(payload),
        script=script,
    )


def embedded(payload: Payload) -> str:
    """The payload as JSON for a script element."""
    return embedded_json(payload)


def embedded_json(values: Any) -> str:
    """JSON for a script element: without ``<``, it can neither end the element nor begin a comment."""
    text = json.dumps(values, default=_plain, allow_nan=False, separators=(",", ":"))
    return text.replace("<", "\\u003c").replace("\u2028", "\\u2028").replace("\u2029", "\\u2029")


def _plain(value: Any) -> Any:
    if is_dataclass(value) and not isinstance(value, type):
        return {name: getattr(value, name) for name in value.__dataclass_fields__}
    raise TypeError(f"{type(value).__name__} does not belong on the page")


def fingerprint(script: str) -> str:
    """What a page's policy calls the one script that may run."""
    return f"'sha256-{base64.b64encode(hashlib.sha256(script.encode('utf-8')).digest()).decode('ascii')}'"


def asset(name: str) -> str:
    """The text of a script, style sheet or page of the report."""
    return (resources.files("pareto_monoped.report") / "assets" / name).read_text(encoding="utf-8")

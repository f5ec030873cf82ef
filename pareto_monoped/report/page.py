"""Studies -> what the page shows, a pure function of their data and of what was simulated again -> one HTML file."""

import base64
import hashlib
import json
import re
import zlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, is_dataclass, replace
from functools import lru_cache
from importlib import resources
from math import isfinite
from pathlib import Path
from string import Template
from typing import TYPE_CHECKING, Any

import numpy as np

from pareto_monoped import __version__
from pareto_monoped.analysis.choices import WORDS
from pareto_monoped.compute.chunks import cores
from pareto_monoped.design import BASE_START_HEIGHT_M, GRAVITY_M_PER_S2, KNOTS, PAPER_CASES, VARIABLES, in_use
from pareto_monoped.errors import StudyError
from pareto_monoped.files import write_text
from pareto_monoped.leg.dimensions import leg_dimensions
from pareto_monoped.measures import ENERGIES, MEASURES, measure
from pareto_monoped.pareto.objectives import Objectives
from pareto_monoped.report.card import FLOOR_HEIGHTS_M, HEADLINES_M, MapPlace, Places, Source, study_card
from pareto_monoped.report.comparison import compare
from pareto_monoped.report.context import context_section
from pareto_monoped.report.exports import read_models
from pareto_monoped.report.motors import leg_table, motor_tables, switches
from pareto_monoped.report.packing import packed_column, unpacked_column
from pareto_monoped.report.quantities import COMPARED, LEADING, quantities_of
from pareto_monoped.report.resimulation import frames_for, resimulate
from pareto_monoped.report.robust import names_of
from pareto_monoped.report.schema import Constants, Gearbox, Jumps, Kit, MotorMap, Payload, Robust, StudyCard, Trials
from pareto_monoped.report.tables import (
    ask_fields,
    cases_table,
    comparison_tables,
    designs_table,
    head,
    importance_tables,
    kind,
    left_out,
    order,
    provenance_tables,
    published_link,
    safe,
)
from pareto_monoped.report.trials import rows_per_study
from pareto_monoped.storage.extra_rows import read_limits, read_robustness, read_sensitivity
from pareto_monoped.storage.place import StudyPlace
from pareto_monoped.storage.reader import StudyData, read_study
from pareto_monoped.storage.seals import UNSEALED

if TYPE_CHECKING:
    from pareto_monoped.actuator.ratiomap import ActuatorMap

PUBLISHED_LINK_KG, PUBLISHED_LINK_KG_PER_M = 0.235, 0.828
"""Mass of a link over its length: straight line through the masses of links that the authors published, for lengths
from 150 to 350 mm."""
SCRIPTS = (
    "dom", "data", "jumps", "state", "choose", "subject", "link", "scales", "marks", "plots", "chart", "subplots",
    "space", "front", "axes", "robust", "ask", "robot", "lines", "detail", "parallel", "table", "search", "viewer",
    "shortlist", "compare", "print", "main",
)  # fmt: skip
"""The page's own scripts, in the order in which they run; together they are one closed scope."""
STYLES = ("style", "choose", "print")  #: The page's style sheets, in the order in which they apply.


def _origin(actuator_map: "ActuatorMap") -> tuple[Any, str]:
    return actuator_map.motor, actuator_map.settings.rules


def build(sources: Sequence[Source], literal: Sequence[Mapping[str, Any]] = ()) -> Payload:
    """Return the page's content; ``literal`` are the paper's cases under its calibration (``jump.table1.Spread``)."""
    mapped: list[Any] = []
    places: list[MapPlace] = []
    gearboxes: list[Gearbox] = []
    maps: list[MotorMap] = []
    for source in sources:
        for actuator_map in source.data.actuator_maps.values():
            if _origin(actuator_map) not in mapped:
                tables = motor_tables(actuator_map, first=len(gearboxes))
                places.append(MapPlace(number=len(maps), first_gearbox=len(gearboxes)))
                mapped.append(_origin(actuator_map))
                maps.append(tables.map)
                gearboxes.extend(tables.gearboxes)
    kits: dict[tuple[int, int], Kit] = {}
    for source in sources:
        for kit in source.data.kits:
            hip, knee = (mapped.index(_origin(one)) for one in (kit.hip, kit.knee))
            if (hip, knee) not in kits:
                leg = None if hip == knee else leg_table(leg_dimensions(kit))
                kits[hip, knee] = Kit(motor=kit.label, hip=hip, knee=knee, leg=leg)
    labels = _labels(sources)
    used = {variable.name for source in sources for variable in in_use(source.data.trials)}
    variables = [variable for variable in (*VARIABLES, *KNOTS) if variable.name in used]
    goals = tuple(dict.fromkeys(name for source in sources for name in source.data.study.objectives.names))
    cards = []
    shown = rows_per_study([len(source.data.trials) for source in sources])
    for source, label, most_rows in zip(sources, labels, shown, strict=True):
        own = {name: mapped.index(_origin(one)) for name, one in source.data.actuator_maps.items()}
        ends = {kit.label: (own[kit.hip.motor.name], own[kit.knee.motor.name]) for kit in source.data.kits}
        numbers = {label: list(kits).index(pair) for label, pair in ends.items()}
        found = Places(maps={name: places[place] for name, place in own.items()}, kits=numbers)
        data = [one.data for one in sources]
        cards.append(study_card(source, label, most_rows, found, variables, goals, data))
    quantities = quantities_of(
        names_of([source.data for source in sources], [card.robust for card in cards]), variables
    )
    shown_as = {quantity.name: quantity for quantity in quantities}
    return Payload(
        version=__version__,
        title=_title(cards),
        objectives=cards[0].objectives,
        goals=goals,
        directions=Objectives(names=goals).directions,
        measure_directions={m.name: m.direction for m in MEASURES if m.direction is not None},
        leading=LEADING,
        compared=COMPARED,
        energies={name: measure(name).work_share for name in ENERGIES},
        constants=Constants(
            gravity_m_per_s2=GRAVITY_M_PER_S2,
            base_start_height_m=BASE_START_HEIGHT_M,
            floor_heights_m=FLOOR_HEIGHTS_M,
            published_link_kg=PUBLISHED_LINK_KG,
            published_link_kg_per_m=PUBLISHED_LINK_KG_PER_M,
        ),
        variables=[asdict(variable) for variable in variables],
        quantities=quantities,
        axes=_axes(cards),
        published=[
            {
                "name": c.name,
                "height_m": c.height_m,
                "energy_j": c.energy_j,
                "design": {one.name: c.design.as_dict().get(one.name, one.default) for one in variables},
            }
            for c in PAPER_CASES.values()
        ],
        literal=literal,
        gearboxes=gearboxes,
        maps=maps,
        kits=list(kits.values()),
        studies=cards,
        switches=[switches(card, gearboxes, shown_as[cards[0].objectives[0]]) for card in cards],
        comparison=compare([source.data for source in sources], labels, HEADLINES_M) if len(sources) > 1 else None,
    )


def _axes(cards: Sequence[StudyCard]) -> list[str]:
    """Return the measures and variables that trials differ in."""
    differ = set()
    for card in cards:
        for name, values in card.trials.columns.items():
            if len({value for value in values if value is not None}) > 1:
                differ.add(name)
        for packed in (card.trials.packed, card.robust.packed if card.robust is not None else {}):
            differ.update(n for n, text in packed.items() if len(np.unique(unpacked_column(text), equal_nan=True)) > 1)
    return sorted(differ - {"hip_gearbox", "knee_gearbox", "motor"})


def _labels(sources: Sequence[Source]) -> list[str]:
    """Return the studies' names; equal ones get what they are for, seed, database or number, as far as needed."""
    names = [source.data.study.name for source in sources]
    if len({source.data.study.objectives for source in sources}) > 1:
        names = [f"{name} by {_aim(source)}" for source, name in zip(sources, names, strict=True)]
    labels: list[str] = []
    for source, name in zip(sources, names, strict=True):
        label = name if names.count(name) == 1 else f"{name}, seed {source.data.study.seed}"
        tries = [label, f"{label}, {source.data.db}", *(f"{label} ({n})" for n in range(2, len(sources) + 2))]
        labels.append(next(text for text in tries if text not in labels))
    return labels


def _title(cards: Sequence[StudyCard]) -> str:
    """Return the study's name, where it is one, or one by several objectives; else the first one's and a count.

    Studies in which variables of another one are opened do not count.
    """
    opened = {place for card in cards for place in card.wider}
    cards = [card for place, card in enumerate(cards) if place not in opened]
    by = {(card.name, tuple(card.objectives)) for card in cards}
    one = len({card.name for card in cards}) == 1 and len(by) == len(cards)
    return cards[0].name if one else f"{cards[0].name} and {len(cards) - 1} more"


def _aim(source: Source) -> str:
    measures = source.data.study.objectives.measures
    return " and ".join(WORDS.get(entry.name, entry.label) for entry in measures if entry.name != "height_m")


def write_report(dbs: Sequence[StudyPlace], out: Path, *, exports: Path | None = None) -> None:
    """Write the report of one or several studies, which are then drawn over each other and compared.

    Designs of which ``exports`` holds a folder ``trial_N`` have a 3D view.

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
    """Read the studies, simulate at most ``most_jumps`` of each front for the page; raise as ``write_report``."""
    if not dbs:
        raise StudyError("databases = 0: must be at least 1; name the database of a study")
    # Everything is read before anything is simulated, so that a wrong name is reported at once.
    studies = [read_study(db) for db in dbs]
    if not all(data.sealed for data in studies):
        note(UNSEALED)
    models = read_models(exports, studies, note=note) if exports is not None else [{} for _ in studies]
    frames = frames_for(sum(len(data.front()) for data in studies))
    again = [resimulate(data, most_jumps=most_jumps, frames=frames, workers=cores()) for data in studies]
    sources = [
        Source(
            data=data,
            resimulation=simulated,
            models=found,
            robustness=read_robustness(data.db),
            sensitivities=read_sensitivity(data.db),
            limits=read_limits(data.db),
        )
        for data, simulated, found in zip(studies, again, models, strict=True)
    ]
    return build(sources, literal_cases())


def with_exports(payload: Payload, exports: Path, studies: Sequence[StudyData], note: Callable[[str], None]) -> Payload:
    """Add exported designs to the content of a page of some studies that has none; raise as ``write_report``."""
    models = read_models(exports, studies, note=note)
    cards = [
        replace(card, models={str(trial): model for trial, model in found.items()})
        for card, found in zip(payload.studies, models, strict=True)
    ]
    return replace(payload, studies=cards)


@lru_cache(maxsize=1)
def literal_cases() -> tuple[dict[str, float | None], ...]:
    """Return medians and spread of the paper's cases with the paper's motor under the ``paper`` calibration."""
    from pareto_monoped.actuator.search import map_for
    from pareto_monoped.jump.calibration import load_calibration
    from pareto_monoped.jump.table1 import paper_spreads

    spreads = paper_spreads(map_for("VT8020", "paper"), load_calibration("paper"), perturbations=40)
    return tuple({k: v if isfinite(v) else None for k, v in asdict(spread).items()} for spread in spreads)


def page(payload: Payload) -> str:
    """Return the whole HTML text."""
    script = closed(*(asset(f"{name}.js") for name in SCRIPTS))
    text = Template(asset("page.html")).substitute(
        policy=policy(plotly(), script),
        title=safe(payload.title),
        style="".join(asset(f"{name}.css") for name in STYLES),
        head=head(payload),
        kind=safe(kind(payload)),
        fields=ask_fields(payload),
        order=safe(order(payload)),
        comparison=comparison_tables(payload),
        designs=designs_table(payload),
        importances=importance_tables(payload),
        published_link=published_link(payload),
        left_out=left_out(payload),
        cases=cases_table(payload),
        context=context_section(payload),
        provenance=provenance_tables(payload),
        version=safe(payload.version),
        payload=deflated(payload),
        plotly=plotly(),
        script=script,
    )
    return in_ascii(text)


def closed(*scripts: str) -> str:
    """Return scripts as one closed scope."""
    return _escaped("(async () => {\n'use strict';\n" + "\n".join(scripts) + "\n})();\n")


def _escaped(script: str) -> str:
    return re.sub(r"[^\x00-\x7f]+", lambda letters: json.dumps(letters[0])[1:-1], script)


def in_ascii(text: str) -> str:
    """Return a page with references for letters beyond ASCII: a browser then keeps the whole in a byte per letter."""
    return text.encode("ascii", "xmlcharrefreplace").decode("ascii")


def deflated(content: Any) -> str:
    """Return a page's content as text that can neither end a script element nor begin a comment.

    First stands how many bytes of numbers there are. These and the rest in JSON follow, deflated and in base64.
    """
    numbers, text = embedded(content)
    return f"{len(numbers)} {base64.b64encode(zlib.compress(numbers + text.encode(), 9)).decode('ascii')}"


def embedded(content: Any) -> tuple[bytes, str]:
    """Return columns and jumps one after another as a browser reads them, and the rest as JSON with their places."""
    numbers = bytearray()

    def placed(raw: bytes, size: int = 4) -> dict[str, int]:
        place = {"at": len(numbers), "count": len(raw) // size}
        numbers.extend(raw + bytes(-len(raw) % 4))
        return place

    def plain(value: Any) -> Any:
        if not is_dataclass(value) or isinstance(value, type):
            raise TypeError(f"{type(value).__name__} does not belong on the page")
        fields = {name: getattr(value, name) for name in value.__dataclass_fields__}
        if isinstance(value, (Trials, Robust)):
            fields["packed"] = {name: placed(base64.b64decode(text)) for name, text in value.packed.items()}
        if isinstance(value, Trials):
            # Whole numbers, such as those of gearboxes, stay as they are.
            numbered = {name for name, column in value.columns.items() if any(isinstance(one, float) for one in column)}
            fields["columns"] = {
                name: placed(base64.b64decode(packed_column(np.array(column, dtype=np.float64))))
                if name in numbered
                else column
                for name, column in value.columns.items()
            }
        if isinstance(value, Jumps):
            fields["data"] = placed(zlib.decompress(base64.b64decode(value.data)), size=2)
        return fields

    text = json.dumps(content, default=plain, allow_nan=False, separators=(",", ":"))
    return bytes(numbers), text


PLOTLY = "plotly-basic-4.1.1.min.js"
"""The charts' library, from the npm package plotly.js-basic-dist-min of that version (MIT, see its LICENSE)."""
PLOTLY_SHA256 = "99784e3abfb07b142a15e521a439e6d9addceadb3f79553fd24c72774f0649ba"
"""Of the file as the package has it."""


@lru_cache(maxsize=1)
def plotly() -> str:
    """Return the charts' library as a function ``makePlotly``, which sets it up: a browser may pause in between.

    The file hands that function to another one, so that a browser reads all of it twice: first for its end only. In
    parentheses it is read once.
    """
    text = (resources.files("pareto_monoped.report") / "plotly" / PLOTLY).read_text(encoding="utf-8")
    start, _, function = text.partition(", () => {")
    return _escaped(f"{start.partition('*/')[0]}*/\nconst makePlotly = (() => {{{function.removesuffix('}));')}}});\n")


def policy(*scripts: str) -> str:
    """Return the policy of a page: only these scripts may run, whatever else gets there, and nothing may be loaded."""
    prints = (base64.b64encode(hashlib.sha256(one.encode("utf-8")).digest()).decode("ascii") for one in scripts)
    allowed = " ".join(f"'sha256-{one}'" for one in prints)
    return (
        f"default-src 'none'; script-src {allowed}; style-src 'unsafe-inline'; "
        "img-src data: blob:; base-uri 'none'; form-action 'none'"
    )


def asset(name: str) -> str:
    """Return the text of a script, style sheet or page of the report."""
    return (resources.files("pareto_monoped.report") / "assets" / name).read_text(encoding="utf-8")

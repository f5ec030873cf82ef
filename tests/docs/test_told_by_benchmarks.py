"""Numbers in running prose of ``benchmarks`` that a table of the pages shows as well, as in ``test_told_by_tables``."""

import json
import math
import re
import tomllib

import numpy as np
import pytest

from pareto_monoped.definition.algorithms import SurrogateSettings
from pareto_monoped.design import LOWER, NAMES
from tests.docs.prose import firsts, given, said, table, untold
from tests.docs.scripts import ROOT, imported, rows


def long_run():
    found = table("benchmarks/long_run.md", "evaluations", "memory, MB")
    first, last = found.iloc[0], found.iloc[-1]
    more = last["memory, MB"] - first["memory, MB"]
    yield f"Memory grows by {100.0 * more / first['memory, MB']:.0f} percent after the first tenth, {more:.0f} MB"
    sizes = found["bytes each"]
    yield f"takes {sizes.min():,} to {sizes.max():,} bytes per evaluation in every tenth"
    minutes = (found["CPU, ms each"] * found["evaluations"].diff().fillna(first["evaluations"])).sum() / 6e4
    yield f"the run takes {minutes:.0f} minutes of processor time"
    faster = 100.0 * (1.0 - last["CPU, ms each"] / first["CPU, ms each"])
    yield f"The last tenth takes {faster:.0f} percent less time"


def search_algorithms():
    page = "benchmarks/search_algorithms.md"
    about = json.loads(
        (ROOT / "benchmarks" / "search_reference" / "VT8020.csv").read_text().split("\n")[0].lstrip("# ")
    )
    searches, each = len(about["seeds"]), 8000
    again = (about["evaluations"] - searches * each) / about["refinements"]
    assert (searches, about["refinements"]) == (8, 2)
    yield f"eight searches of {each:,} jumps by `surrogate`, two refinements of {again:,.0f} jumps each"
    first = table(page, "algorithm, population").set_index("algorithm, population")
    with imported("search_algorithms") as script:
        (own,) = {script.SHOWN["surrogate-40"]}
        (others,) = {seeds for name, seeds in script.SHOWN.items() if name != "surrogate-40"}
        assert set(first.index) == set(script.SHOWN)
    yield f"of seeds {own[0]} to {own[-1]} for `surrogate` and {others[0]} to {others[-1]} for the others"
    (jump_s,) = map(float, re.findall(r"1,000 jumps take ([\d.]+) s\.", said(page)))
    runs = np.where(first.index == "surrogate-40", len(own), len(others))
    minutes = (runs * 8.0 * (first["own s / 1,000"] + jump_s)).sum() / 60.0
    yield f"and {jump_s} s for 1,000 jumps, the searches of the table take {minutes:.0f} minutes of one core"
    after = first["1,000"]["surrogate-40"].split()[0]
    assert all(float(row.split()[0]) < float(after) for name, row in first["8,000"].items() if "surrogate" not in name)
    above = table("benchmarks/search_algorithms.md", "0.7 m", "1.2 m").iloc[0, 1:]
    most = [float(cell.split(" to ")[1].rstrip(")")) for cell in above]
    yield (
        f"All {runs.max() * len(most)} of its least energies after 8,000 jumps are within "
        f"{math.ceil(10.0 * max(most)) / 10.0:.1f} percent of the best known, {runs.max() * len(most[:-1])} of them up "
        f"to 1.1 m within {max(most[:-1]):.2f}."
    )


def search_cases():
    found = table("benchmarks/search_cases.md", "published", "paper's design here").set_index("case")
    less = {}
    for case in "BC":
        design = float(found["paper's design here"][case].split(", ")[1].split()[0])
        less[case] = 100.0 * (1.0 - float(found.iloc[:, -1][case]) / design)
    assert found.iloc[:, -1]["A"] == "not reached"
    jumps = given("benchmarks/search_cases.md", "search_cases.py", "evaluations")
    with imported("search_cases") as script:
        assert len(script.WEIGHTS) == 10
        iterations = jumps // (8 * len(script.WEIGHTS))
    yield f"Each search had {jumps:,} jumps: the default, `surrogate`, and the paper's weighted CMA-ES with ten weights"
    yield f"each with {iterations} iterations of 8 designs"
    lowest = LOWER[NAMES.index("stiffness_n_per_m")]
    assert (
        tomllib.loads((ROOT / "studies" / "wide.toml").read_text())["variables"]["stiffness_n_per_m"]["lower"] < lowest
    )
    yield f"at its lower bound of {lowest:g} N/m"
    yield f"the front needs {less['B']:.0f} percent less energy for B and {less['C']:.0f} percent less for C"


GAINS = {
    "climbs": "Case C",
    "Gaussian process": "Case C, 300 jumps",
    "two drawn generations with bounds and corners": "Case C, 8,000 jumps",
    "learned share of failed jumps": "`wide.toml`",
}
"""Parts of the search, and where the page says what they gain."""
STUCK = (
    "plain evolution",
    "explorers",
    "small steps around the best",
    "climbs",
    "distance from the front in what is behind it",
)
"""Parts without which it gets stuck."""


def search_landscapes():
    page = "benchmarks/search_landscapes.md"
    text = (ROOT / page).read_text(encoding="utf-8")
    seeds, others = dict.fromkeys(re.findall(r"search_landscapes.py --seeds (\d+ \d+)", text))
    yield f"of five seeds, {seeds.replace(' ', ' to ')}, after 1,000 evaluations"
    *parts, more = re.findall(r"(?:^\|.*\n)+", text, re.M)[:3]
    yield f"Of 20 other seeds, {others.replace(' ', ' to ')}, the median of the default search is ahead on both"
    assert all((found := firsts(cells))[0] > found[1:].max() for _, *cells in rows(more)[1:])
    shares = {name: firsts(cells) for part in parts for name, *cells in rows(part)[1:]}
    by = {name: found[0] - found[1:].max() for name, found in shares.items()}
    far = [name for name, gap in by.items() if gap > 10.0]
    assert sorted(far) == ["dtlz2", "dtlz2-3", "dtlz7", "osy", "zdt3", "zdt6"]
    assert sorted(name for name, gap in by.items() if 0.0 < gap <= 10.0) == [
        "bnh",
        "kursawe",
        "srn",
        "tnk",
        "wfg4",
        "zdt4",
    ]
    assert sorted(name for name, gap in by.items() if gap < 0.0) == ["c2dtlz2", "mw7"]
    assert shares["mw1"].eq(0.0).all()
    parts = table(page, "without", "`wide.toml`").set_index("without")
    limits = table(page, "within all limits, %, without", "`wide.toml`").set_index("within all limits, %, without")
    lost = {name: -float(parts.loc[name][case].split()[0]) for name, case in GAINS.items()}
    climbs, process, corners, failing = lost.values()
    yield f"Climbs gain {climbs:.1f} percent on Case C, the Gaussian process {process:.1f} percent with 300 jumps"
    yield f"and designs drawn on bounds and corners {corners:.1f} percent with 8,000"
    yield f"{failing:.1f} percent of the hypervolume of `wide.toml` is missing"
    kept = limits["`wide.toml`"].str.split().str[0]
    yield f"and {kept['learned share of failed jumps']} instead of {kept['nothing']} percent of its jumps hold all"
    kept = limits["Case C"].str.split().str[0]
    yield f"{kept['points behind the front in the fit']} instead of {kept['nothing']} percent of the jumps of Case C do"
    for name in STUCK:
        assert min(float(parts.loc[name][case].split()[0]) for case in ("zdt4", "kursawe")) < -5.0, name
    least = limits["Case C within tight limits"].str.extract(r"\((\d+)\)")[0].astype(int)
    assert sorted(least.index[least < 70]) == ["plain evolution", "tolerance that follows what holds"]
    with imported("search_parts") as script:
        assert set(parts.index) == set(limits.index) == set(script.PARTS)
        assert list(parts.columns) == list(script.LANDSCAPES)
        assert list(limits.columns) == list(script.HELD)
    near = table(page, "said after", "within a factor of two").set_index("said after")["within a factor of two"]
    yield f"after 1,000 evaluations, {near[1000]:.0f} of 20 estimates are within a factor of two of what was gained"
    yield f"after 300, {near[300]:.0f}; most promise too much then"
    with imported("search_limits") as script:
        limits = [next(iter(limit.values())) for limit in script.TIGHT.values()]
        knots = script.STUDIES["torque over time"][1]["controller"]["knots"]
    yield (
        f"a height of at least {limits[0]:.1f} m, at most {limits[1]:g} J and at most {limits[2]:g} N m in the knee's "
        "gears"
    )
    assert knots == 10
    yield f"A torque over time with ten knots per joint makes {2 * knots + 5} variables"  # two lengths, ratios, a time


def search_overhead():
    share = table("benchmarks/search_algorithms.md", "algorithm, population").set_index("algorithm, population")
    after, plain = share["1,000"]["surrogate-40"], share["8,000"]["nsga2-40"]
    assert float(after.split()[0]) > float(plain.split()[0])
    yield "`nsga2` needs more than eight times as many jumps for the same front"
    yield f"which ranks {SurrogateSettings(name='surrogate').offspring} designs for each one simulated"


PAGES = [long_run, search_algorithms, search_cases, search_landscapes, search_overhead]


@pytest.mark.parametrize("page", PAGES, ids=lambda one: one.__name__)
def test_the_prose_says_what_the_tables_show(page):
    assert untold(f"benchmarks/{page.__name__}.md", page()) == []

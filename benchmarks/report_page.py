"""How quick the report's page is in headless Chromium: first view, arrow keys, switches, longest task, size.

Pages are made of studies given by name, and of one of them grown to more trials. Each figure is the median of several
tries, measured in the page by the clock of the browser; processor time of the page's main thread by the DevTools
protocol stands beside it, because other work on the machine stretches only the wall clock. The longest task is that of
a trace, in processor time, too.
Before anything is timed, the page must show what the study has: the number of designs drawn and the design that an
arrow key selects are compared with the data.

    python benchmarks/report_page.py study.db --trials 20000
"""

import argparse
import json
import shutil
import statistics
import tempfile
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from pareto_monoped.definition.study import study_from_dict
from pareto_monoped.design import NAMES
from pareto_monoped.report.card import Source
from pareto_monoped.report.page import build, page
from pareto_monoped.report.resimulation import resimulate
from pareto_monoped.storage.reader import StudyData, read_study
from pareto_monoped.study.run import run

TRIES = 5
FIRST_VIEW = """() => new Promise((done) => {
    const look = () => {
        const chart = document.getElementById("front-chart");
        if (!chart?.data?.length) setTimeout(look, 5);
        else requestAnimationFrame(() => setTimeout(() => done(performance.now())));
    };
    look();
})"""
KEY = """async (key) => {
    const chart = document.getElementById("front-chart");
    chart.focus();
    const start = performance.now();
    chart.dispatchEvent(new KeyboardEvent("keydown", { key, bubbles: true }));
    await new Promise((done) => requestAnimationFrame(() => setTimeout(done)));
    return performance.now() - start;
}"""
CLICK = """async (selector) => {
    const start = performance.now();
    document.querySelector(selector).click();
    await new Promise((done) => requestAnimationFrame(() => setTimeout(done)));
    return performance.now() - start;
}"""
TYPE = """async ([selector, value]) => {
    const start = performance.now(), field = document.querySelector(selector);
    field.value = value;
    field.dispatchEvent(new Event("input", { bubbles: true }));
    await new Promise((done) => requestAnimationFrame(() => setTimeout(done)));
    return performance.now() - start;
}"""


def grown(data: StudyData, count: int) -> StudyData:
    """A study of ``count`` trials: the real ones, then copies of them that cost a little more."""
    rng = np.random.default_rng(1)
    more = data.trials.iloc[rng.integers(0, len(data.trials), max(count - len(data.trials), 0))].copy()
    more["energy_j"] *= 1.0 + rng.exponential(0.1, len(more))
    for i, name in enumerate(NAMES):
        moved = more[name] * rng.normal(1.0, 0.01, len(more))
        more[name] = np.clip(moved, data.study.lower[i], data.study.upper[i])
    trials = pd.concat((data.trials, more), ignore_index=True).iloc[:count].copy()
    trials["trial"] = np.arange(len(trials))
    return replace(data, trials=trials)


def measured(browser: Any, file: Path, data: StudyData, *, traced: bool = False) -> dict[str, float]:
    """One opening of the page: milliseconds of each step; or of its longest task, for which a trace slows all."""
    context = browser.new_context(viewport={"width": 1440, "height": 900}, reduced_motion="reduce")
    tab = context.new_page()
    session = context.new_cdp_session(tab)
    session.send("Performance.enable", {"timeDomain": "threadTicks"})  # else tasks are timed by the wall clock
    if traced:
        browser.start_tracing(page=tab, categories=["toplevel", "__metadata"])
    tab.goto(file.as_uri(), wait_until="commit")
    result = {"first view": float(tab.evaluate(FIRST_VIEW))}
    tab.wait_for_timeout(800)
    result["processor, first view"] = _busy_ms(session)
    equal(tab, data)
    masses = data.front()["mass_kg"].quantile([0.9, 0.7, 0.5, 0.3]).round(3)
    conditions = [["#ask-mass_kg", str(mass)] for mass in masses]
    steps: list[tuple[str, str, Sequence[Any]]] = [
        ("arrow key", KEY, 9 * ["ArrowRight"]),
        ("end key", KEY, 9 * ["End"]),
        ("toggle dominated", CLICK, 6 * ["[data-show=cloud]"]),
        ("toggle infeasible", CLICK, 6 * ["[data-show=infeasible]"]),
        ("condition", TYPE, conditions),
        ("reset", CLICK, ["#reset"]),
    ]
    _step(tab, session, result, steps)
    tab.evaluate("document.getElementById('along').scrollIntoView()")
    tab.wait_for_timeout(500)
    _step(tab, session, result, [(f"{name}, along the front", script, given) for name, script, given in steps[-2:]])
    tab.evaluate("document.getElementById('parallel').scrollIntoView()")
    tab.wait_for_timeout(500)
    _step(tab, session, result, [(f"{name}, parallel axes", script, given) for name, script, given in steps[-2:]])
    if traced:
        result = {"processor, longest task": longest_ms(json.loads(browser.stop_tracing()))}
    context.close()
    return result


def _step(tab: Any, session: Any, result: dict[str, float], steps: Sequence[tuple[str, str, Sequence[Any]]]) -> None:
    for name, script, given in steps:
        before = _busy_ms(session)
        result[name] = statistics.median(tab.evaluate(script, one) for one in given)
        tab.wait_for_timeout(400)  # what is written or drawn later belongs to it
        result[f"processor, {name}"] = (_busy_ms(session) - before) / len(given)


def longest_ms(trace: Any) -> float:
    """Processor time of the longest task of any main thread of a page in a trace."""
    events = trace["traceEvents"]
    main = {(e["pid"], e["tid"]) for e in events if e.get("args", {}).get("name") == "CrRendererMain"}
    return max(float(e.get("tdur", 0)) for e in events if e["ph"] == "X" and (e["pid"], e["tid"]) in main) / 1000.0


def _busy_ms(session: Any) -> float:
    metrics = {m["name"]: m["value"] for m in session.send("Performance.getMetrics")["metrics"]}
    return 1000.0 * float(metrics["TaskDuration"])


def equal(tab: Any, data: StudyData) -> None:
    """Check that the page shows what the study has.

    Raises:
        AssertionError: it does not.
    """
    drawn = tab.evaluate("document.getElementById('front-chart').layers.map((t) => [t.name, t.x.length])")
    front = data.front()
    feasible = int((data.trials["state"] == "feasible").sum())
    counts = dict(drawn)
    assert counts["front"] == len(front), counts
    assert counts["dominated"] == feasible - len(front), counts
    tab.evaluate(KEY, "Home")
    trial = int(front["trial"].iloc[0])
    assert f"Trial {trial}" in tab.inner_text("#subject")


def made(folder: Path) -> Path:
    """A small study to show."""
    settings = {"name": "case_c", "description": "for the page", "case": "C", "evaluations": 1000, "seed": 1}
    db = folder / "case_c.db"
    run(study_from_dict(settings, source="benchmark"), db, workers=2)
    return db


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("db", type=Path, nargs="?", help="a study; without one, 1,000 trials of Case C are made")
    parser.add_argument("--trials", type=int, default=20_000, help="trials of the grown study")
    parser.add_argument("--tries", type=int, default=TRIES)
    given = parser.parse_args()
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright, tempfile.TemporaryDirectory() as folder:
        data = read_study(given.db or made(Path(folder)))
        again = resimulate(data)
        path = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
        browser = playwright.chromium.launch(executable_path=path, args=["--no-sandbox", "--disable-gpu"])
        for study in (data, grown(data, given.trials)):
            file = Path(folder) / f"{len(study.trials)}.html"
            file.write_text(page(build([Source(data=study, resimulation=again, models={})])), encoding="utf-8")
            tries = [
                measured(browser, file, study) | measured(browser, file, study, traced=True) for _ in range(given.tries)
            ]
            figures = {name: round(statistics.median(one[name] for one in tries), 1) for name in tries[0]}
            size = {"trials": len(study.trials), "front": len(study.front()), "megabytes": file.stat().st_size / 1e6}
            print(json.dumps(size | {f"{name}, ms": value for name, value in figures.items()}, indent=1))
        browser.close()


if __name__ == "__main__":
    main()

"""Real small studies, made once a session, and a headless browser without a network."""

import base64
import math
import struct
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from pareto_monoped.definition.study import study_from_dict
from pareto_monoped.design import NAMES
from pareto_monoped.report.card import Source
from pareto_monoped.report.page import build, page
from pareto_monoped.report.resimulation import resimulate
from pareto_monoped.storage.reader import StudyData, read_study
from pareto_monoped.study.run import run

SETTINGS = {"name": "small", "description": "for tests", "case": "C", "evaluations": 200, "seed": 3}


def made(folder: Path, **changes) -> Path:
    study = study_from_dict(SETTINGS | changes, source="test")
    db = folder / f"{study.algorithm.name}_{study.seed}_{study.evaluations}.db"
    run(study, db, workers=2)
    return db


@pytest.fixture(scope="session")
def folder(tmp_path_factory) -> Path:
    return tmp_path_factory.mktemp("report")


@pytest.fixture(scope="session")
def db(folder) -> Path:
    """A real study of 200 jumps."""
    return made(folder)


@pytest.fixture(scope="session")
def other_seed(folder) -> Path:
    """The same study with another seed and budget."""
    return made(folder, seed=4, evaluations=120)


@pytest.fixture(scope="session")
def seeds(folder) -> list[Path]:
    """The same study with three seeds and one small budget: three runs have a median."""
    return [made(folder, seed=seed, evaluations=60) for seed in (3, 4, 6)]


@pytest.fixture(scope="session")
def weighted(folder) -> Path:
    """Two runs of the paper's weighted search."""
    algorithm = {"name": "weighted_cmaes", "height_weights": [0.2, 0.6], "iterations": 4}
    return made(folder, name="weighted", algorithm=algorithm, evaluations=80)


@pytest.fixture(scope="session")
def source_u12(folder) -> Source:
    """A study of another motor than the default."""
    data = read_study(made(folder, name="u12", motor="U12", evaluations=60, seed=5))
    return Source(data=data, resimulation=resimulate(data, most_jumps=1), models={})


@pytest.fixture(scope="session")
def data(db) -> StudyData:
    return read_study(db)


@pytest.fixture(scope="session")
def resimulation(data):
    return resimulate(data, most_jumps=8)


@pytest.fixture(scope="session")
def source(data, resimulation) -> Source:
    return Source(data=data, resimulation=resimulation, models={})


@pytest.fixture(scope="session")
def payload(source):
    return build([source])


@pytest.fixture(scope="session")
def both(source, source_u12):
    """The page's content for studies of two motors."""
    return build([source, source_u12])


@pytest.fixture(scope="session")
def both_file(folder, both) -> Path:
    made = folder / "both.html"
    made.write_text(page(both), encoding="utf-8")
    return made


def unpacked(text: str) -> list[float]:
    """Read as a browser does: numbers in single precision, low byte first."""
    raw = base64.b64decode(text, validate=True)
    return [number for (number,) in struct.iter_unpack("<f", raw)]


def cut(data: StudyData, keep: np.ndarray, *, finished: bool = False, state: str | None = None) -> StudyData:
    """The study with only the trials at a mask, as if it had come no further."""
    trials = data.trials[keep].reset_index(drop=True)
    if state is not None:
        trials["state"] = pd.array([state] * len(trials), dtype="str")
    history = data.history[data.history["evaluations"] <= len(trials)]
    audits = data.audits[data.audits["trial"].isin(trials["trial"])].reset_index(drop=True)
    meta = replace(data.meta, finished=finished, stop_reason=None)
    return replace(data, trials=trials, history=history, audits=audits, meta=meta)


def grown(data: StudyData, count: int) -> StudyData:
    """A study of ``count`` trials: the real ones over and over, each a little off, a tenth of them infeasible."""
    rng = np.random.default_rng(1)
    trials = data.trials.iloc[rng.integers(0, len(data.trials), count)].reset_index(drop=True)
    trials["trial"] = np.arange(count)
    for name in NAMES:
        low, high = data.study.lower[NAMES.index(name)], data.study.upper[NAMES.index(name)]
        trials[name] = np.clip(trials[name] * rng.normal(1.0, 0.03, count), low, high)
    trials["energy_j"] *= 1.0 + rng.exponential(0.2, count)
    trials["height_m"] *= 1.0 - rng.exponential(0.05, count)
    feasible = (trials["state"] == "feasible").to_numpy() & (rng.random(count) > 0.1)
    trials["state"] = pd.array(np.where(feasible, "feasible", "infeasible").astype(str), dtype="str")
    return replace(data, trials=trials, audits=data.audits.iloc[:0])


DOUBLE_CLICK_S = 0.45  # two clicks within 0.4 s on one spot of a chart show the whole of it


class Tab:
    """A tab in a browser without a network, with everything that its page complained about or asked for."""

    def __init__(self, browser, **options) -> None:
        self.context = browser.new_context(reduced_motion="reduce", **options)
        self.context.set_offline(True)
        self.page = self.context.new_page()
        self.complaints: list[str] = []
        self.requests: list[str] = []
        self.clicked_s = -math.inf
        self.seen_as = ("", "")
        self.at_first: dict[str, str] = {}
        self.page.on("console", lambda m: self.complaints.append(m.text) if m.type == "error" else None)
        self.page.on("pageerror", lambda error: self.complaints.append(str(error)))
        self.page.on("dialog", lambda dialog: self.complaints.append(f"dialog {dialog.message}") or dialog.dismiss())
        self.page.on("request", lambda request: self.requests.append(request.url))

    def show(self, file: Path, width: int = 1440, height: int = 900, fragment: str = "", scheme: str = "light") -> None:
        """Leave the present page for good, and load a file."""
        self.page.goto("about:blank")
        self.page.mouse.move(0, 0)
        self.look(width, height, scheme)
        self.complaints.clear()
        self.requests.clear()
        self.page.goto(file.as_uri() + fragment)
        self.page.wait_for_function("() => document.getElementById('front-chart').layers !== undefined")
        self.page.wait_for_selector("#table.live")
        self.page.evaluate("document.querySelector('.fold').open = true")

    def look(self, width: int = 1440, height: int = 900, scheme: str = "light") -> None:
        """A screen of this size, with these colours."""
        if self.page.viewport_size != {"width": width, "height": height}:
            self.page.set_viewport_size({"width": width, "height": height})
        self.medium("screen", scheme)

    def medium(self, media: str, scheme: str) -> None:
        """Show the page on a screen or in print; to ask for what is there already would paint all of it again."""
        if self.seen_as != (media, scheme):
            self.page.emulate_media(media=media, color_scheme=scheme)
            self.seen_as = (media, scheme)

    def reset(self) -> None:
        """The view as it was at first, with the first design of the front selected."""
        self.look()
        self.page.evaluate("document.getElementById('reset').click()")
        self.page.evaluate("document.querySelector('.fold').open = true")
        self.page.evaluate("window.scrollTo(0, 0)")
        self.page.focus("#front-chart")
        self.page.keyboard.press("Home")

    def text(self, selector: str) -> str:
        return self.page.inner_text(selector)

    def expects(self, selector: str, words: str) -> None:
        """Wait until an element has these words."""
        from playwright.sync_api import expect

        expect(self.page.locator(selector)).to_contain_text(words)

    def point(self, trace: str, index: int) -> tuple[float, float]:
        """Where a point of the front chart lies in the window."""
        return tuple(
            self.page.evaluate(
                """([name, i]) => {
                    const gd = document.getElementById("front-chart");
                    const t = gd.layers.find((t) => t.name === name), box = gd.getBoundingClientRect();
                    const [x, y] = gd.chart.at(t.x[i], t.y[i]);
                    return [box.left + x, box.top + y];
                }""",
                [trace, index],
            )
        )

    def to_front(self) -> None:
        """Scroll to the front chart, and wait until it shows the present state."""
        self.to_chart("front-chart")

    def to_chart(self, name: str) -> None:
        """Scroll to a chart, and wait until it shows the present state: out of sight it is not redrawn."""
        self.page.locator(f"#{name}").scroll_into_view_if_needed()
        self.page.evaluate("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")
        self.page.wait_for_timeout(100)

    def texts(self, trace: str) -> list[str]:
        """What hovering shows over each point of a trace of the front chart."""
        return self.page.evaluate(
            """(name) => {
                const t = document.getElementById("front-chart").layers.find((t) => t.name === name);
                return t.x.map((_, i) => t.text(i));
            }""",
            trace,
        )

    def click_point(self, trace: str, index: int) -> None:
        """Click a point of the front chart, long enough after the last one not to make a double click."""
        self.to_front()
        self.page.wait_for_timeout(max(0.0, 1e3 * (self.clicked_s + DOUBLE_CLICK_S - time.monotonic())))
        self.page.mouse.click(*self.point(trace, index))
        self.clicked_s = time.monotonic()

    def scroll_through(self) -> None:
        """Let every chart come into view."""
        for top in range(0, self.page.evaluate("document.documentElement.scrollHeight"), 800):
            self.page.evaluate(f"window.scrollTo(0, {top})")
            self.page.wait_for_timeout(40)
        self.page.evaluate("window.scrollTo(0, 0)")
        self.page.wait_for_timeout(40)

    def quiet(self, file: Path) -> None:
        """Nothing was asked for but the file itself (its icon is empty data), and nothing went wrong."""
        assert [url for url in self.requests if not url.startswith("data:")] == [file.as_uri()]
        assert self.complaints == []


@pytest.fixture(scope="session")
def file(folder, payload) -> Path:
    """The page of the small study."""
    made = folder / "small.html"
    made.write_text(page(payload), encoding="utf-8")
    return made


@pytest.fixture(scope="session")
def shared(file, browser) -> Tab:
    """That page in a tab, for all tests that a reset is enough for."""
    tab = Tab(browser)
    tab.show(file)
    tab.at_first = {part: tab.text(part) for part in ("#subject", "header")}
    return tab


@pytest.fixture(scope="session")
def spare() -> list[Tab]:
    """Tabs that no test uses: a new one takes longer than its page."""
    return []


@pytest.fixture
def open_tab(browser, spare):
    """A function that loads a file in a tab; with options of Playwright, in a new one."""
    used, closed = [], []

    def opened(file: Path, *, options=None, **look) -> Tab:
        tab = Tab(browser, **options) if options else spare.pop() if spare else Tab(browser)
        (closed if options else used).append(tab)
        tab.show(file, **look)
        return tab

    yield opened
    spare.extend(used)
    for tab in closed:
        tab.context.close()


def front_below(card, height_m, mass_kg):
    """Rows of the front of the designs that are as high and as light, the lowest first, and of all; by brute force."""
    columns = card.trials.columns
    able = [row for row, letter in enumerate(card.trials.state) if letter == "f" and row not in card.ill_conditioned]
    able = [r for r in able if columns["height_m"][r] >= height_m and columns["mass_kg"][r] <= mass_kg]

    def cost(row):
        return -columns["height_m"][row], columns["energy_j"][row]

    def beats(one, other):
        """The first of two equal designs stays."""
        (low, less), (high, more) = cost(one), cost(other)
        return low <= high and less <= more and (cost(one) != cost(other) or one < other)

    kept = [row for row in able if not any(beats(other, row) for other in able)]
    assert len(kept) < len(able)
    return sorted(kept, key=lambda row: columns["height_m"][row]), able


def telling_mass_kg(card, height_m=0.0):
    """A greatest mass that brings designs to the front which a lighter or heavier one would not: about the median."""
    columns = card.trials.columns
    masses = sorted(columns["mass_kg"][row] for row in card.front if columns["height_m"][row] >= height_m)
    for mass in masses[len(masses) // 2 :: -1]:
        kept, _ = front_below(card, height_m, round(mass, 3))
        if len(kept) > 1 and set(kept) - set(card.front):
            return round(mass, 3)
    raise AssertionError("no condition on the mass brings a design to the front")

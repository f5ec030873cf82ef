"""What the pages show after each use of each of their controls is as it was.

A walk uses every control that it finds in the document, every key, and the mouse; after each step it signs what has
changed: the document with the values of its fields, the address, the data of charts with the words over each mark,
calls of canvases, copied and downloaded text. Other tests prove what is right; here a change is seen. After one that
is wanted, make ``signatures.json`` again, as CONTRIBUTING.md says. The page's clock stands still between steps, and
``walk.js``, which reads the page, holds each chart in view: the page then follows at once, and nothing waits.
"""

import re
from dataclasses import replace
from importlib import resources
from pathlib import Path
from types import SimpleNamespace

import pandas as pd
import pytest
import trimesh

from pareto_monoped.definition.study import study_from_dict
from pareto_monoped.report.card import Source
from pareto_monoped.report.exports import model_of
from pareto_monoped.report.page import build, page
from pareto_monoped.report.resimulation import resimulate
from pareto_monoped.report.schema import BestTorque
from pareto_monoped.storage.reader import read_study
from pareto_monoped.study.run import run
from pareto_monoped.uncertainty.statistics import Robustness, Spread
from tests.records import compare, signature
from tests.report.conftest import SETTINGS

# Where pixels fall differs between versions of Chromium and its fonts, and the walk takes a minute of processor time.
pytestmark = [pytest.mark.browser, pytest.mark.long]

HERE = Path(__file__).parent
ASSETS = resources.files("pareto_monoped") / "report" / "assets"
RANDOM = {"algorithm": {"name": "random"}, "strength": False}
"""A random search asks for the same trials on every machine, whatever the last digits of its jumps are."""
SEVERAL = RANDOM | {
    "name": "several <b>", "evaluations": 50,
    "motor": ["U8", "VT8020", "MN8014"], "gear_list": True, "rules": "iso6336",
    "objectives": ["height_m", "electrical_energy_j", "mass_kg"], "constraints": {"mass_kg": {"max": 5.6}},
    "variables": {"knee_release_rad": {"lower": 0.0, "upper": 0.4}, "start_height_m": {"lower": 0.4, "upper": 0.6}},
}  # fmt: skip
EXCEPTIONS = {
    "Picture as PNG": "its picture is the machine's; test_browser.py has one",
    "Picture as SVG": "likewise",
}
"""Controls that the walk leaves alone, by what their names hold."""
ALIKE = (
    "brush-fields range ", "rows-head sort ", "parallel-chart head ", "conditions drop ", "parallel-axes parallel ",
    "rows-columns column ", "export-all Copy", "provenance ",
)  # fmt: skip
"""Beginnings of names of controls that one line of a script makes for each measure, so that a few are enough."""
FEW = 4


def stored(folder, changes):
    """A study made in this process: another one takes longer to start."""
    study = study_from_dict(SETTINGS | changes, source="test")
    db = folder / f"signed_{study.seed}_{study.evaluations}.db"
    run(study, db, workers=1)
    return db


def source_of(db, jumps):
    """A study whose times are none, for they are the machine's."""
    data = read_study(db)
    data = replace(data, meta=replace(data.meta, hash="0" * 64), history=data.history.assign(wall_time_s=0.0))
    return Source(data=data, resimulation=resimulate(data, most_jumps=jumps), models={})


def written(folder, name, payload):
    cards = [replace(card, seconds=0.0, database=Path(card.database).name) for card in payload.studies]
    file = folder / f"{name}.html"
    file.write_text(page(replace(payload, studies=cards, version="0")), encoding="utf-8")
    return file


@pytest.fixture(scope="module")
def one(folder):
    """Three objectives, several motors, a limit, failed trials, and the model of a design."""
    source = source_of(stored(folder, SEVERAL), 6)
    trials, front = source.data.trials, source.data.front()["trial"].to_numpy()
    state = trials["state"].to_numpy(dtype=object)
    state[[k for k in range(len(state)) if trials["trial"][k] not in front][:3]] = "failed"
    trials["state"] = pd.array(state.astype(str), dtype="str")
    box = trimesh.creation.box(extents=(40.0, 80.0, 400.0)).triangles
    payload = build([replace(source, models={int(front[1]): model_of([(box, (200, 80, 20))], 100)})])
    return SimpleNamespace(file=written(folder, "signed_one", payload), payload=payload, model=int(front[1]))


@pytest.fixture(scope="module")
def two(folder):
    """Two seeds and another calibration side by side; one has designs under uncertainty, and the best torque found."""
    first, second, third = (
        source_of(stored(folder, RANDOM | {"seed": seed, "evaluations": budget} | more), 4)
        for seed, budget, more in ((5, 50, {}), (6, 40, {}), (7, 45, {"calibration": "ideal", "audit": False}))
    )
    tested = {}
    for at, (_, row) in enumerate(first.data.front().iterrows()):
        measures = {
            name: Spread(mean=row[name], deviation=0.1, p05=row[name] * (0.9 - 0.01 * at), p95=row[name] * 1.1)
            for name in ("height_m", "energy_j")
        }
        result = Robustness(samples=256, failed=0.0, overloaded=0.02 * at, measures=measures)
        tested[int(row["trial"])] = SimpleNamespace(settings={"samples": 256, "seed": 0}, result=result)
    payload = build([replace(first, robustness=tested), second, third])
    card = payload.studies[0]
    jumps = [
        (row, card.trials.columns["height_m"][row], 0.8 * card.trials.columns["energy_j"][row]) for row in card.front
    ]
    best = BestTorque(energy="energy_j", held=False, rows=card.front, gap=[20.0 for _ in jumps], front=jumps)
    payload = replace(payload, studies=[replace(card, best=best), *payload.studies[1:]])
    return SimpleNamespace(file=written(folder, "signed_two", payload), payload=payload)


class Walk:
    """A page whose clock stands still between steps, and the signature of each step."""

    def __init__(self, browser, made, name):
        self.context = browser.new_context(reduced_motion="reduce", viewport={"width": 1440, "height": 900})
        self.page = self.context.new_page()
        self.complaints = []
        self.page.on("pageerror", lambda error: self.complaints.append(str(error)))
        self.page.add_init_script(path=HERE / "walk.js")
        self.page.clock.install(time=0)
        self.page.goto(made.file.as_uri())
        self.page.wait_for_selector("#table.live", state="attached")
        self.page.wait_for_function("() => document.querySelectorAll('.js-plotly-plot').length > 5")
        self.page.clock.pause_at(3600_000)
        self.name, self.found, self.used, self.others = name, {}, set(), set()
        card = made.payload.studies[0]
        self.middle = {}
        for quantity in made.payload.quantities:
            values = [v for v in card.trials.columns.get(quantity.name) or () if isinstance(v, float)]
            self.middle[quantity.name] = sorted(values)[len(values) // 2] * quantity.scale if values else 1.0
        self.sign("begin")

    def sign(self, step):
        """Sign what has changed."""
        self.page.clock.run_for(1100)
        changed = self.page.evaluate("walk.record()")
        parts = " ".join(name for name, _ in changed)
        self.found[f"{self.name} {len(self.found)} {step}: {parts}"] = signature(dict(changed))
        assert self.complaints == [], step

    def use(self, name):
        """Use a control in each of its ways, and sign each."""
        self.used.add(name)
        kind, count, at = self.page.evaluate("walk.kind", name)
        if kind in ("checkbox", "press"):
            self.press(name)
            if kind == "checkbox" and self.page.evaluate("walk.kind", name):
                self.press(name)
        elif kind == "head":
            self.page.evaluate("walk.move", name)
            self.sign(f"key ArrowRight {name}")
        elif kind == "select":
            for choice in dict.fromkeys((1, 2 * count // 3, count - 1)):
                if choice < count:
                    self.set(name, choice)
            self.page.evaluate("([name, at]) => walk.set(name, at)", [name, at])
        elif kind == "number":
            measure, side = self.page.evaluate("walk.end", name)
            self.set(name, f"{self.middle[measure] * (1.05 if side else 0.95):.5g}")
            self.page.evaluate("([name, at]) => walk.set(name, at)", [name, ""])
        elif kind != "focus":
            self.set(name, "30" if kind == "range" else "1")
            self.page.evaluate("([name, at]) => walk.set(name, at)", [name, "0" if kind == "range" else ""])

    def press(self, name):
        self.page.evaluate("walk.press", name)
        self.sign(f"press {name}")

    def set(self, name, value):
        self.page.evaluate("([name, value]) => walk.set(name, value)", [name, value])
        self.sign(f"set {name} {value}")

    def use_all(self, left_out=frozenset()):
        """Use the first control that has not been used, until there is none; a family of controls in one step."""
        while True:
            controls = self.page.evaluate("walk.controls()")
            done = self.used | left_out
            rest = [name for name in controls if name not in done and not excepted(name, done)]
            if not rest:
                return
            self.use(rest[0])

    def go(self, hash_):
        """Follow a link to another view."""
        self.page.evaluate("walk.go", f"view=1&{hash_}")
        self.sign(f"go {hash_}")

    def key(self, selector, key, **more):
        self.page.evaluate(
            "([selector, key, more]) => walk.key(document.querySelector(selector), key, more)", [selector, key, more]
        )
        self.sign(f"key {key} {' '.join(more)} {selector}")

    def drag(self, what, *places):
        """Press the mouse at the first of some places in the window, and release it at the last."""
        mouse = self.page.mouse
        mouse.move(*places[0])
        mouse.down()
        for place in places[1:]:
            mouse.move(*place, steps=2)
        mouse.up()
        mouse.move(1, 1)
        self.sign(f"drag {what}")

    def point(self, what, x, y):
        """Hover over a place, click it, and leave: a pointer that stays would hover again when things move."""
        self.page.mouse.move(x, y)
        self.sign(f"hover {what}")
        self.page.mouse.click(x, y)
        self.page.mouse.move(1, 1)
        self.sign(f"click {what}")

    def mark(self, layer, i):
        return self.page.evaluate("([layer, i]) => walk.mark(layer, i)", [layer, i])

    def into_view(self, selector):
        self.page.evaluate("(at) => document.querySelector(at).scrollIntoView({ block: 'center' })", selector)

    def front(self):
        """Keys and the mouse on the chart of the front."""
        for key in (
            ("Home",)
            if self.name != "one"
            else ("End", "ArrowLeft", "ArrowDown", "Home", "ArrowRight", "ArrowUp", "PageUp", "PageDown")
        ):
            self.key("#front-chart", key)
        for key in ("ArrowRight", "ArrowDown", "ArrowLeft", "ArrowUp"):
            self.key("#front-chart", key, shiftKey=True)
        if self.name != "one":
            return
        for key in ("+", "=", "-"):
            self.key("#front-chart", key)
        self.key("#front-chart", "End")
        self.key("#front-chart", "0")
        for key, more in (("z", {}), ("y", {}), ("z", {}), ("Z", {"shiftKey": True})):
            self.key("#front-chart", key, ctrlKey=True, **more)
        self.page.evaluate("document.activeElement.blur(); document.body.focus()")
        self.key("body", "ArrowLeft")
        self.key("body", "ArrowRight")
        self.into_view("#front-chart")
        for layer in ("front", "dominated"):
            for i in (1, 3):
                self.point(f"{layer} {i}", *self.mark(layer, i))
        x, y = self.mark("front", 2)
        self.page.mouse.dblclick(x + 30, y - 60)
        self.sign("double click")
        for tool, places in (
            ("Zoom", ((x - 60, y - 70), (x + 80, y + 60))),
            ("Show the whole", None),
            ("Pan", ((x, y), (x + 70, y + 40))),
            ("Show the whole", None),
            (
                "Lasso Select",
                ((x - 90, y - 90), (x + 90, y - 90), (x + 90, y + 90), (x - 90, y + 90), (x - 90, y - 80)),
            ),
            ("Box Select", ((x - 60, y - 70), (x + 80, y + 60))),
            ("Zoom", None),
        ):
            self.page.evaluate("walk.press", f"front-chart {tool}")
            if places:
                self.drag(tool, *places)
        self.key("#front-chart", "0")
        self.press("#reset")

    def parallel(self, first, second):
        """The mouse on the parallel coordinates, whose axes two of their measures are."""
        self.into_view("#parallel-chart")

        def at(name, share):
            return self.page.evaluate("([name, share]) => walk.axis(name, share)", [name, share])

        x, y = at(first, 0.4)
        for k in (0, 4):
            self.point(f"lines {k}", x + 30, y + 20 * (k - 4))
        self.drag("along an axis", at(first, 0.2), at(first, 0.7))
        self.drag("along another axis", at(second, 0.8), at(second, 0.3))
        self.point("an axis", x, y)
        self.press("#clear-ranges")
        head = self.page.locator(f"[data-head={second}]").bounding_box()
        self.drag("head", (head["x"] + 20, head["y"] + 5), (x, head["y"] + 5), (x - 20, head["y"] + 5))
        self.press("#undo")

    def elsewhere(self):
        """Clicks on rows, scrolling, paper, and a dark screen."""
        self.go("rows=all&sort=-energy_j")
        self.into_view("#rows")
        self.page.evaluate("document.querySelector('#rows-body [data-row] td:last-child').click()")
        self.sign("click a row")
        self.page.evaluate("Object.assign(document.getElementById('rows'), { scrollTop: 700 })")
        self.page.evaluate("document.getElementById('rows').dispatchEvent(new Event('scroll'))")
        self.sign("scroll rows")
        for event in ("beforeprint", "afterprint"):
            self.page.evaluate("(name) => window.dispatchEvent(new Event(name))", event)
            self.sign(event)
        for scheme in ("dark", "light"):
            before = self.page.evaluate(TINT)
            self.page.emulate_media(color_scheme=scheme)
            self.page.wait_for_function(f"(before) => {TINT} !== before", arg=before)
            self.sign(scheme)
        for width in (600, 1440):
            self.page.set_viewport_size({"width": width, "height": 900})
            self.sign(f"width {width}")
        self.press("#reset")
        self.use_all(self.others)

    def shortlist(self, trials):
        """Keep six designs, one more than there is room for, and let go of one; notes, and moments of all jumps."""
        self.go("&".join(f"keep=0:{trial}:{'' if k else 'a%20%3Cb%3E'}" for k, trial in enumerate(trials[:5])))
        for trial in trials[5:7]:
            self.go_on(trial)
            button = next((n for n in self.page.evaluate("walk.controls()") if n.startswith("keep Keep")), None)
            if button:
                self.press(button)
        for _ in range(2):  # the seventh, and then one of those that are kept
            self.page.evaluate("document.querySelector('#rows-body input:not(:checked)').click()")
            self.sign("keep one too many")
        self.page.evaluate("document.querySelector('#rows-body input:checked').click()")
        self.sign("let go in the table")
        self.page.evaluate("document.querySelector('#kept li:nth-child(2) button:last-child').click()")
        self.sign("remove")
        self.use_all(self.others)

    def go_on(self, trial):
        """Select a design, and keep the rest of the view."""
        self.page.evaluate(
            "(trial) => walk.go(location.hash.slice(1).replace(/at=[^&]*/, '').concat('&at=0:', trial))", trial
        )
        self.sign(f"select {trial}")

    def damaged(self):
        """What is said of addresses that are no view of the page."""
        said = [self.page.evaluate("walk.go", f"view=1&{part}") for part in DAMAGED]
        self.found[f"{self.name} damaged addresses"] = signature(said)
        self.sign("damaged addresses")


def excepted(name, used):
    """Whether a control is left alone; of those that are alike a few are enough."""
    for start in ALIKE:
        if name.startswith(start):
            return sum(one.startswith(start) for one in used) >= FEW
    return any(words in name for words in EXCEPTIONS)


TINT = "document.getElementById('front-chart').layout.font.color"
VIEWS = (
    "range=height_m:0.8:&range=mass_kg::5.5&best=knee&rows=all&find=f&sort=-mass_kg",
    "range=height_m:0.5:0.9&best=compromise&log=xy&size=mass_kg&columns=mass_kg,height_m",
    "range=height_m:9:9&range=mass_kg::1",
    "range=energy_j::1&range=height_m:0.9:",
    "range=energy_j::20&range=height_m:1.2:&range=mass_kg::4.2&range=drift_m::0.01",
    "best=most:mass_kg&x=mass_kg&y=energy_j&colour=height_m&log=x&zoom=4:6:20:90",
    "best=least:energy_j&space=1&colour=mass_kg&size=height_m",
    "layers=front,infeasible,floor&parallel=height_m,mass_kg&colour=",
    "at=0:case:C&x=energy_j",
    "at=0:case:nominal&layers=simulated,published,picks,cloud",
)
"""Views that a link may have, of both pages."""
DAMAGED = (
    "at=0:99999", "at=9:1", "at=0:x", "at=0:case:none", "range=height_m:1", "range=height_m:2:1", "range=height_m:a:",
    "range=none:1:2", "best=some", "best=least:none", "hide=7", "without=9", "keep=0:99999:", "x=none", "y=none",
    "colour=none", "size=none", "zoom=1:2:3", "zoom=2:1:3:4", "zoom=1:2:4:3", "layers=none", "parallel=none",
    "rows=none", "columns=none", "sort=none", "find=%", "none=1", "at=0:1&at=0:2", "x",
    "&".join(f"keep=0:{k}:" for k in range(8)), "keep=0:1:&keep=0:1:",
)  # fmt: skip


@pytest.fixture(scope="module")
def walks(one, two, browser):
    """Both pages after all of their controls have been used."""
    found = []
    for made, name in ((one, "one"), (two, "two")):
        walk = Walk(browser, made, name)
        walk.others = set().union(*(other.used for other in found))
        card = made.payload.studies[0]
        trials = [card.trials.trial[row] for row in card.front]
        walk.use_all(walk.others)
        walk.press("#reset")
        walk.front()
        walk.use_all(walk.others)
        walk.parallel(*(("knee_ratio", "hip_ratio") if name == "one" else ("height_m", "energy_j")))
        for view in VIEWS:
            walk.go(view)
            walk.use_all(walk.others)
        walk.shortlist(trials)
        if name == "one":
            walk.damaged()
        walk.elsewhere()
        if name == "one":
            energies = card.trials.columns["electrical_energy_j"]
            walk.go(f"at=0:{card.trials.trial[energies.index(max(energies))]}")
            walk.use_all()
            walk.go(f"at=0:{made.model}")
            for key in ("ArrowLeft", "ArrowRight", "ArrowUp", "ArrowDown", "+", "-"):
                walk.key("#viewer canvas", key)
            walk.into_view("#viewer canvas")
            box = walk.page.locator("#viewer canvas").bounding_box()
            x, y = box["x"] + 0.5 * box["width"], box["y"] + 0.5 * box["height"]
            walk.drag("model", (x, y), (x + 40, y + 20))
            walk.page.mouse.wheel(0, -100)
            walk.sign("wheel")
            walk.go("space=1")
            walk.into_view("#front-chart")
            x, y = walk.mark("front", 1)
            walk.drag("turn", (x, y), (x + 40, y + 30))
            walk.go("without=1&range=height_m:0.7:")
            walk.use_all()
            walk.go("without=0&without=1&without=2")
        else:
            walk.go("hide=0&at=1:3")
            walk.go("hide=1&hide=2&rows=all&find=small")
            walk.go(f"keep=0:{trials[0]}:a&keep=1:3:b&keep=2:4:c&at=2:4")
        walk.use_all(walk.others)
        found.append(walk)
    yield found
    for walk in found:
        walk.context.close()


def test_pages_show_what_they_did(walks):
    found = {}
    for walk in walks:
        found |= walk.found
    compare(found, HERE / "signatures.json")


def test_every_control_has_been_used(walks):
    """Whatever has ever been on the pages."""
    used = set().union(*(walk.used for walk in walks))
    seen = set().union(*(walk.page.evaluate("[...walk.seen]") for walk in walks))
    assert {name for name in seen - used if not excepted(name, used)} == set()


def test_every_key_that_scripts_listen_for_has_been_pressed(walks):
    pressed = {key for walk in walks for step in walk.found for key in re.findall(r"^\w+ \d+ key (\S+)", step)}
    for file in ASSETS.iterdir():
        for table in re.findall(r"\{([^{}]*)\}\[event\.key\]", file.read_text() if file.name.endswith(".js") else ""):
            keys = set(re.findall(r'(?:^|,)\s*"?([^\s":,]+)"?:', table))
            assert keys <= pressed, (file.name, keys - pressed)

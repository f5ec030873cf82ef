import base64
import hashlib
import re
from dataclasses import replace
from html import unescape
from html.parser import HTMLParser
from pathlib import Path

import pytest

from pareto_monoped import report
from pareto_monoped.design import BASE_START_HEIGHT_M, GRAVITY_M_PER_S2
from pareto_monoped.errors import DatabaseError, OutputError, StudyError
from pareto_monoped.report.page import (
    PLOTLY,
    PLOTLY_SHA256,
    PUBLISHED_LINK_KG,
    PUBLISHED_LINK_KG_PER_M,
    SCRIPTS,
    asset,
    page,
    payload_of,
    plotly,
    write_report,
)


class Scripts(HTMLParser):
    """The scripts of a page as a browser would see them."""

    def __init__(self, text):
        super().__init__(convert_charrefs=False)
        self.found, self.policy = [], ""
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        attributes = dict(attrs)
        if tag == "script":
            self.found.append([attributes.get("type"), ""])
        if attributes.get("http-equiv") == "Content-Security-Policy":
            self.policy = attributes["content"]

    def handle_data(self, data):
        if self.lasttag == "script" and self.found and self.cdata_elem == "script":
            self.found[-1][1] += data


@pytest.fixture(scope="module")
def text(payload):
    return page(payload)


def test_policy_lets_exactly_the_script_of_the_page_run(text):
    scripts = Scripts(text)
    running = [content for kind, content in scripts.found if kind is None]
    assert [kind for kind, _ in scripts.found] == [*3 * ["text/plain"], None, None]
    prints = [base64.b64encode(hashlib.sha256(content.encode()).digest()).decode() for content in running]
    assert sorted(re.findall(r"'sha256-([^']+)'", scripts.policy)) == sorted(prints)
    assert "default-src 'none'" in scripts.policy


def test_page_is_the_same_every_time(payload, text):
    assert page(payload) == text


def test_page_is_in_ascii_and_reads_the_same(payload, text):
    """With one letter beyond it, a browser would keep the whole page in two bytes per letter."""
    assert text.isascii()
    assert "\\u2265" in text  # of a condition in a script
    named = page(replace(payload, title="Sprünge ≥ 1 m"))
    assert named.isascii()
    assert "<h1>Sprünge ≥ 1 m</h1>" in unescape(named)


def test_page_of_a_small_study_is_small(text):
    """Of it, 1.2 MB are the charts' library."""
    assert len(text.encode()) < 1.7e6


def test_the_charts_library_is_that_of_its_package_with_its_licence():
    folder = Path(report.__file__).parent / "plotly"
    assert hashlib.sha256((folder / PLOTLY).read_bytes()).hexdigest() == PLOTLY_SHA256
    assert "v4.1.1" in (folder / PLOTLY).read_text(encoding="utf-8")[:200]
    assert (folder / "LICENSE").read_text(encoding="utf-8").startswith("MIT License")
    # Only what calls it is another; letters beyond ASCII are escaped.
    _, _, inner = (folder / PLOTLY).read_text(encoding="utf-8").partition('"use strict";var Plotly')
    escaped = re.sub(r"[^\x00-\x7f]", lambda letter: f"\\u{ord(letter[0]):04x}", inner.removesuffix("}));"))
    assert plotly().endswith(f'const makePlotly = (() => {{\n"use strict";var Plotly{escaped}}});\n')
    # It asks for no evaluation of text, which the page's policy forbids.
    assert not re.search(r"new Function|[^\w.]eval\(", plotly())


def test_a_missing_database_is_refused_and_nothing_is_written(tmp_path, db):
    out = tmp_path / "r.html"
    with pytest.raises(DatabaseError):
        write_report([db, tmp_path / "none.db"], out)
    assert list(tmp_path.iterdir()) == []


def test_no_database_is_refused():
    with pytest.raises(StudyError, match="databases = 0"):
        payload_of([])


def test_a_folder_that_is_not_there_is_refused(tmp_path, db):
    with pytest.raises(OutputError, match="cannot be written"):
        write_report([db], tmp_path / "none" / "r.html")
    with pytest.raises(OutputError, match="exports folder"):
        payload_of([db], exports=tmp_path / "none")


def test_scripts_hold_no_physical_constants():
    """Gravity, the start height and the published link once stood in the scripts as well as in Python."""
    facts = [9.80665, GRAVITY_M_PER_S2, BASE_START_HEIGHT_M, PUBLISHED_LINK_KG, PUBLISHED_LINK_KG_PER_M]
    facts += [1e-3 * fact for fact in facts]
    assets = Path(report.__file__).parent / "assets"
    for path in [*assets.glob("*.js"), assets / "page.html"]:
        code = re.sub(r"//.*", "", path.read_text(encoding="utf-8"))
        numbers = [float(number) for number in re.findall(r"(?<![\w.])\d*\.?\d+(?![\w.])", code)]
        found = {number for number in numbers if any(number == pytest.approx(fact) for fact in facts)}
        # These compute no physics: their 0.5 are middles, halves and the least zoom.
        assert found <= ({0.5} if path.name in ("viewer.js", "marks.js", "space.js") else set()), path.name
        assert not re.search(r"\d m\b", code), f"{path.name}: a height in words"


def test_no_two_scripts_declare_the_same_name():
    """They run in one scope, in which a second function of a name would silently replace the first."""
    declared = re.compile(r"^(?:async )?(?:function|const|let|class) (\w+)", re.M)
    names = [name for script in SCRIPTS for name in declared.findall(asset(f"{script}.js"))]
    assert len(names) > 100
    assert {name for name in names if names.count(name) > 1} == set()

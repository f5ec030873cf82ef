"""The documentation site: it builds without a warning and a network, no link of it is broken, and it has everything."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

import pareto_monoped as pm
from pareto_monoped.cli import cli
from pareto_monoped.design import VARIABLES
from tests.docs.site import Page, broken, broken_in_markdown, outside, styles

ROOT = Path(__file__).parents[2]
WRITTEN = sorted(
    path
    for folder in (".", "docs", "docs/reference", "benchmarks", "reports", "studies")
    for path in (ROOT / folder).glob("*.md")
)

SITE = pytest.mark.long
"""What looks at the built site: building it takes ten seconds. CI builds it at every push, and fails on a warning."""


@pytest.fixture(scope="module")
def site(tmp_path_factory) -> Path:
    """The folder of the site, as ``make docs`` builds it, but with the notebooks as they are kept, without outputs."""
    pytest.importorskip("sphinx", reason="the extra 'docs' is not installed")
    folder = tmp_path_factory.mktemp("site")
    command = [sys.executable, "-m", "sphinx", "-b", "html", "-c", "docs", "-n", "-W", "--keep-going", "-q"]
    done = subprocess.run(
        [*command, "-D", "nb_execution_mode=off", "-d", str(folder / "doctrees"), ".", str(folder / "html")],
        cwd=ROOT,
        env=os.environ | {"PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
        timeout=300,
    )
    assert done.returncode == 0, done.stderr
    return folder / "html"


@pytest.fixture(scope="module")
def pages(site) -> dict[Path, Page]:
    return {file.resolve(): Page(file) for file in sorted(site.rglob("*.html"))}


@SITE
def test_no_link_anchor_or_image_of_the_site_is_broken(pages):
    assert len(pages) > 25
    assert sum(len(page.links) for page in pages.values()) > 1000
    assert broken(pages) == []


@SITE
def test_the_site_asks_for_nothing_from_a_network(site, pages):
    assert [(file.name, one) for file, page in pages.items() for one in page.fetched if outside(one)] == []
    sheets = list(site.rglob("*.css"))
    assert len(sheets) > 3
    assert [(sheet.name, one) for sheet in sheets for one in styles(sheet.read_text("utf-8")) if outside(one)] == []


@SITE
def test_every_page_is_reached_from_the_first(site, pages):
    reached, new = set(), {(site / "index.html").resolve()}
    while new:
        file = new.pop()
        reached.add(file)
        near = {(file.parent / link.partition("#")[0]).resolve() for link in pages[file].links}
        new |= (near & set(pages)) - reached
    assert set(pages) - reached == set()


def anchors(pages: dict[Path, Page], name: str) -> set[str]:
    (page,) = (page for file, page in pages.items() if file.match(f"docs/reference/{name}.html"))
    return page.ids


@SITE
def test_every_public_name_is_in_the_reference(pages):
    found = set().union(*(page.ids for file, page in pages.items() if file.parent.name == "reference"))
    public = {f"pareto_monoped.{name}" for name in pm.__all__ if name != "__version__"}
    assert public - found == set(), "add the module to a page of docs/reference, by the directive public-names"


@SITE
def test_every_command_and_option_is_in_the_reference(pages):
    import click

    found = anchors(pages, "commands")
    context = click.Context(cli)
    for name in cli.list_commands(context):
        command = cli.get_command(context, name)
        assert f"pareto-monoped-{name}" in found
        for option in command.params:
            if isinstance(option, click.Option) and not option.hidden:
                longest = max(option.opts, key=len).lstrip("-")
                assert f"cmdoption-pareto-monoped-{name}-{longest}" in found, f"{name} --{longest}"


@SITE
def test_every_measure_and_variable_is_in_its_table(pages):
    assert {measure.name for measure in pm.MEASURES} <= anchors(pages, "measures")
    assert {variable.name for variable in VARIABLES} <= anchors(pages, "variables")


def test_every_example_and_notebook_is_shown():
    page = (ROOT / "docs" / "examples.md").read_text(encoding="utf-8")
    shown = re.findall(r"^```\{literalinclude\} \.\./examples/(\w+\.py)$", page, re.M)
    assert sorted(shown) == sorted(path.name for path in (ROOT / "examples").glob("*.py"))
    home = (ROOT / "docs" / "index.md").read_text(encoding="utf-8")
    listed = re.findall(r"<\.\./notebooks/(\w+)>$", home, re.M)
    assert sorted(listed) == sorted(path.stem for path in (ROOT / "notebooks").glob("*.ipynb"))


def test_no_link_of_a_markdown_file_is_broken():
    assert len(WRITTEN) > 25
    assert broken_in_markdown(WRITTEN) == []


@pytest.mark.browser
@pytest.mark.long
def test_the_site_fits_desk_and_phone_and_searches_without_a_network(site, pages, browser):
    context = browser.new_context()
    context.set_offline(True)
    page = context.new_page()
    asked, complaints = [], []
    page.on("request", lambda request: asked.append(request.url))
    page.on("pageerror", lambda error: complaints.append(str(error)))
    files = set(pages) - {(site / "index.html").resolve()}  # which leads to another at once
    # What is too wide for a desk is so for a phone, but for what only a desk has, which is the same on all pages.
    at_desk = [file for file in files if file.stem in ("README", "measures", "commands")]
    assert len(at_desk) == 4
    for width, shown in ((390, files), (1280, at_desk)):
        page.set_viewport_size({"width": width, "height": 844})
        for file in shown:
            page.goto(file.as_uri())
            over = page.evaluate("document.scrollingElement.scrollWidth - innerWidth")
            assert over <= 0, f"{file.name} is {over} px too wide at {width}"
    page.goto((site / "search.html").as_uri() + "?q=turnbuckles")
    page.wait_for_selector("#search-results li a")
    assert "model" in page.inner_text("#search-results")
    assert [url for url in asked if not url.startswith(("file:", "data:"))] == []
    assert complaints == []
    context.close()


def test_what_is_broken_is_found(tmp_path):
    """The checks above can fail."""
    (tmp_path / "there.md").write_text("# A title, twice\n", encoding="utf-8")
    (tmp_path / "a.md").write_text(
        "[right](there.md#a-title-twice) [no file](gone.md) ![no picture](gone.png) [no heading](there.md#gone)\n"
        "`[code](code.md)`\n",
        encoding="utf-8",
    )
    assert broken_in_markdown([tmp_path / "a.md"]) == ["a.md: gone.md", "a.md: gone.png", "a.md: there.md#gone"]
    (tmp_path / "b.html").write_text(
        '<p id="here"><a href="#here">right</a><a href="#gone">no anchor</a><a href="gone.html">no file</a>'
        '<img src="gone.png"><script src="https://cdn.example/a.js"></script>'
        "<style>p { src: url(//cdn.example/b) }</style>",
        encoding="utf-8",
    )
    page = Page((tmp_path / "b.html").resolve())
    assert broken({page.file: page}) == ["b.html: #gone", "b.html: gone.html", "b.html: gone.png"]
    assert [one for one in page.fetched if outside(one)] == ["https://cdn.example/a.js", "//cdn.example/b"]

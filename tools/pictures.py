"""Make the pictures of the page in docs/ again, once the page has changed; look at them before they are committed.

The study, its tests as built and its sensitivity are those of docs/choosing.md: a minute on a quiet core.

    python tools/pictures.py [--main PAGE.html]

With ``--main``, the page of the main job (reports/ after ``make pareto``), docs/report.png is made, too.
"""

import argparse
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[1]
IMAGES = ROOT / "docs" / "images"
WIDTH_PX, HEIGHT_PX = 1280, 960
COMMANDS = (
    "run quick.toml",
    "robust quick.db --every 80 --alternatives 1",
    "report quick.db -o quick.html",
    "sensitivity quick.db --min-height 0.9 --samples 32 --plot sensitivity.html",
)
"""Those of docs/choosing.md, beside a copy of studies/quick.toml."""


def opened(browser: Any, page: Path, width_px: int = WIDTH_PX, height_px: int = HEIGHT_PX) -> Any:
    """A tab with a page at rest."""
    tab = browser.new_page(viewport={"width": width_px, "height": height_px}, reduced_motion="reduce")
    tab.goto(page.as_uri())
    tab.wait_for_timeout(1500)
    return tab


def front(browser: Any, page: Path) -> None:
    """A condition on height and mass, and the design that it selects."""
    tab = opened(browser, page)
    for switch in ("spread", "robust"):
        tab.uncheck(f"[data-show={switch}]")
    tab.fill("#ask-height", "0.9")
    tab.fill("#ask-mass_kg", "4.7")
    tab.locator("h1").click()
    tab.wait_for_timeout(500)
    tab.locator(".decide").screenshot(path=IMAGES / "choosing_front.png")


def compare(browser: Any, page: Path) -> None:
    """The cheapest design that reaches 0.9 m, beside two alternatives to it."""
    tab = opened(browser, page)
    tab.fill("#ask-height", "0.9")
    tab.locator("#keep button").click()
    for place in (0, 1):
        tab.locator("#alternatives .hold").nth(place).click()
    tab.wait_for_timeout(500)
    tab.locator("#shortlist").screenshot(path=IMAGES / "choosing_compare.png")


def robust(browser: Any, page: Path) -> None:
    """The front with error bars, and the robust front."""
    opened(browser, page).locator("#front").screenshot(path=IMAGES / "choosing_robust.png")


def main() -> None:
    """Make the study and its pages in a folder of their own, and the pictures."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--main", type=Path, help="the page of the main job")
    given = parser.parse_args()
    from playwright.sync_api import sync_playwright

    path = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
    with tempfile.TemporaryDirectory() as name, sync_playwright() as playwright:
        folder = Path(name)
        shutil.copy(ROOT / "studies" / "quick.toml", folder)
        for command in COMMANDS:
            subprocess.run([sys.executable, "-m", "pareto_monoped", *command.split()], cwd=folder, check=True)
        browser = playwright.chromium.launch(executable_path=path, args=["--no-sandbox", "--disable-gpu"])
        for make in (front, compare, robust):
            make(browser, folder / "quick.html")
        chart = opened(browser, folder / "sensitivity.html", 1000, 900)
        chart.screenshot(path=IMAGES / "choosing_sensitivity.png")
        if given.main is not None:
            opened(browser, given.main.resolve()).screenshot(path=ROOT / "docs" / "report.png")
        browser.close()


if __name__ == "__main__":
    main()

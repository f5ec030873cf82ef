"""Settings that hold for every test."""

import shutil
from collections.abc import Iterator

import pytest
from hypothesis import settings

# The machine is shared: how long one example takes says nothing about the code.
settings.register_profile("shared_machine", deadline=None)
settings.load_profile("shared_machine")


@pytest.fixture(scope="session")
def browser() -> Iterator[object]:
    """Chromium, once per process: Playwright starts no second time while it runs."""
    path = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
    if path is None:
        pytest.skip("no Chromium is installed")
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        # WebGL by SwiftShader, so that the 3D view is drawn without a graphics card; all else on the processor.
        drawing = ["--disable-gpu", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
        running = playwright.chromium.launch(executable_path=path, args=["--no-sandbox", *drawing])
        yield running
        running.close()

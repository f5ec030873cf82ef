"""Everything else stands in pyproject.toml; this adds the shipped study files to the wheel, and the README's links.

On a package index the README has no folder beside it. Pictures and relative links then lead to the address that
``Source`` in ``[project.urls]`` names, at the tag of the version. Without an address, pictures are left out and links
are text, so that nothing on the page is broken.
"""

import re
import shutil
import tomllib
from pathlib import Path

from setuptools import setup
from setuptools.command.build_py import build_py

ROOT = Path(__file__).parent
STUDIES = ROOT / "studies"

_MARKDOWN_PICTURE = re.compile(r"!\[([^\]]*)\]\((?!https?:)([^)]+)\)")
_HTML_PICTURE = re.compile(r'<img src="(?!https?:)([^"]+)"([^>]*)>')
_LINK = re.compile(r"(?<!!)\[([^\]]+)\]\((?!https?:|#|mailto:)([^)]+)\)")
_PICTURES_ARE_ELSEWHERE = "*The pictures are in the source distribution.*"


def for_an_index(text: str, source: str | None, version: str) -> str:
    """The README as a package index shows it.

    Args:
        text: of the README, in Markdown.
        source: address of the repository on its host; None: not known.
        version: of the package; the repository has it as the tag ``v<version>``.
    """
    if source is None:
        text, count = _MARKDOWN_PICTURE.subn("", text)
        text, more = _HTML_PICTURE.subn("", text)
        text = _LINK.sub(r"\1", text)
        title, _, rest = text.partition("\n")
        return f"{title}\n\n{_PICTURES_ARE_ELSEWHERE}\n{rest}" if count + more else text
    raw, page = (f"{source.rstrip('/')}/{kind}/v{version}" for kind in ("raw", "blob"))
    text = _MARKDOWN_PICTURE.sub(rf"![\1]({raw}/\2)", text)
    text = _HTML_PICTURE.sub(rf'<img src="{raw}/\1"\2>', text)
    return _LINK.sub(rf"[\1]({page}/\2)", text)


def long_description() -> str:
    """The README for an index, with what pyproject.toml and the package say of themselves."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    package = (ROOT / "pareto_monoped" / "__init__.py").read_text(encoding="utf-8")
    version = re.search(r'^__version__ = "([^"]+)"', package, re.M)
    assert version is not None
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    return for_an_index(text, project.get("urls", {}).get("Source"), version[1])


class WithStudies(build_py):
    """Copies ``studies/*.toml`` to ``pareto_monoped/data/studies``, where ``study.shipped`` looks for them."""

    def run(self) -> None:
        """Build as usual, then copy; an editable installation reads the files where they are."""
        super().run()
        if self.editable_mode:
            return
        folder = Path(self.build_lib) / "pareto_monoped" / "data" / "studies"
        folder.mkdir(parents=True, exist_ok=True)
        for path in sorted(STUDIES.glob("*.toml")):
            shutil.copy(path, folder)


if __name__ == "__main__":  # as setuptools runs it; a test imports it
    setup(
        cmdclass={"build_py": WithStudies},
        long_description=long_description(),
        long_description_content_type="text/markdown",
    )

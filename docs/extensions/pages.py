"""The README as the first page of the site, and links between the files of the repository.

A line of a page that is nothing but a link to the README becomes the README without its title; on a code host it is a
plain link. A link to the README leads to that page.
"""

import re
from pathlib import Path
from posixpath import dirname, join, normpath, relpath
from typing import Any

from sphinx.application import Sphinx

ROOT = Path(__file__).parents[2]
HOME = "docs/index.md"
FOLDERS = {"examples": "docs/examples.md", "notebooks": "docs/notebooks.md"}
"""Folders that a page of the site shows; links to other folders become plain text."""
LINK = re.compile(r"(?<!!)\[([^\]]*)\]\((?!\w+:|#)([^)#\s]*)(#[^)\s]*)?\)")
IMAGE = re.compile(r'(!\[[^\]]*\]\(|<img src=")(?!\w+:)([^)"\s]+)')
WHOLE = re.compile(r"^\[[^\]]+\]\(\.\./README\.md\)\n", re.M)


def setup(app: Sphinx) -> dict[str, Any]:
    """Rewrite every page when it is read, and make an entrance."""
    app.connect("source-read", _read)
    app.connect("build-finished", _lead_home)
    return {"parallel_read_safe": True, "parallel_write_safe": True}


def _lead_home(app: Sphinx, error: Exception | None) -> None:
    """Write the page at the top of the site, which leads to the first one."""
    if error is None and app.builder.format == "html":
        first = app.builder.get_target_uri(app.config.root_doc)
        (Path(app.outdir) / "index.html").write_text(
            f'<!doctype html><html lang="en"><meta charset="utf-8"><title>{app.config.project}</title>'
            f'<meta http-equiv="refresh" content="0; url={first}"><a href="{first}">{app.config.project}</a></html>\n',
            encoding="utf-8",
        )


def _read(app: Sphinx, docname: str, content: list[str]) -> None:
    source = Path(app.env.doc2path(docname))
    if source.suffix != ".md":
        return
    page = source.relative_to(ROOT).as_posix()
    text = content[0]
    if WHOLE.search(text):
        app.env.note_dependency(str(ROOT / "README.md"))
        readme = (ROOT / "README.md").read_text(encoding="utf-8").partition("\n")[2]
        before, after = WHOLE.split(text)
        text = relinked(before, page, page) + relinked(readme, "README.md", page) + relinked(after, page, page)
    else:
        text = relinked(text, page, page)
    content[0] = text


def relinked(text: str, origin: str, page: str) -> str:
    """Markdown of one file with its links as another file must have them.

    Args:
        text: the Markdown.
        origin: path of the file it comes from, from the root.
        page: path of the page that shows it.
    """

    def link(found: re.Match[str]) -> str:
        words, target, part = found[1], normpath(join(dirname(origin), found[2])), found[3] or ""
        if target == "README.md":
            target = HOME
        elif (ROOT / target).is_dir():
            if target not in FOLDERS:
                return words
            target = FOLDERS[target]
        return f"[{words}]({relpath(target, dirname(page) or '.')}{part})"

    def image(found: re.Match[str]) -> str:
        return found[1] + relpath(normpath(join(dirname(origin), found[2])), dirname(page) or ".")

    return IMAGE.sub(image, LINK.sub(link, text))

"""What the tests ask of HTML and Markdown files: their anchors, and what they refer to."""

import re
from dataclasses import dataclass, field
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

OWN_FETCHES = {"img": "src", "script": "src", "link": "href", "source": "src", "iframe": "src", "video": "src"}
"""Tags whose target a browser asks for by itself, with the attribute that names it."""


@dataclass(slots=True)
class Page(HTMLParser):
    """One HTML file: its anchors, its links, and what a browser fetches to show it."""

    file: Path
    ids: set[str] = field(default_factory=set)
    links: list[str] = field(default_factory=list)
    fetched: list[str] = field(default_factory=list)

    def __post_init__(self) -> None:
        HTMLParser.__init__(self)
        text = self.file.read_text(encoding="utf-8")
        self.feed(text)
        self.close()
        for style in re.findall(r"<style[^>]*>(.*?)</style>", text, re.S):
            self.fetched += styles(style)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        found = {name: value or "" for name, value in attrs}
        if "id" in found:
            self.ids.add(found["id"])
        if tag == "a" and "href" in found:
            self.links.append(found["href"])
        if tag == "form" and "action" in found:
            self.links.append(found["action"])
        if OWN_FETCHES.get(tag) in found:
            self.fetched.append(found[OWN_FETCHES[tag]])
        if "srcset" in found:
            self.fetched += [one.split()[0] for one in found["srcset"].split(",")]


def styles(text: str) -> list[str]:
    """What a style sheet, or the styles within a page, ask a browser to fetch."""
    return [one or other for one, other in re.findall(r"url\(['\"]?([^'\")]+)|@import ['\"]([^'\"]+)", text)]


def outside(target: str) -> bool:
    """Whether a link leads to a network."""
    parts = urlsplit(target)
    return bool(parts.netloc) or parts.scheme not in ("", "data")


def broken(pages: dict[Path, Page]) -> list[str]:
    """Links, anchors, images, scripts and styles of the pages that lead nowhere."""
    found = []
    for file, page in pages.items():
        for target in (*page.links, *page.fetched):
            parts = urlsplit(target)
            if parts.scheme or parts.netloc:
                continue
            there = (file.parent / unquote(parts.path)).resolve() if parts.path else file
            anchors = pages[there].ids if there in pages else set()
            if not there.is_file() or (there in pages and parts.fragment and unquote(parts.fragment) not in anchors):
                found.append(f"{file.name}: {target}")
    return found


def markdown_links(text: str) -> list[str]:
    """Targets of the links and images of a Markdown file that are not within code."""
    plain = re.sub(r"^```.*?^```|^(?:    .*\n)+|`[^`\n]+`", "", text, flags=re.S | re.M)
    return re.findall(r"\]\(([^)\s]+)", plain) + re.findall(r'<img [^>]*src="([^"]+)"', plain)


def markdown_anchors(text: str) -> set[str]:
    """The anchors that code hosts give the headings of a Markdown file."""
    plain = re.sub(r"^```.*?^```", "", text, flags=re.S | re.M)
    titles = re.findall(r"^#+ +(.+?) *$", plain, re.M)
    return {re.sub(r"[^\w\- ]", "", title.lower()).replace(" ", "-") for title in titles}


def broken_in_markdown(files: list[Path]) -> list[str]:
    """Links of Markdown files to files of the repository, or to headings of them, that lead nowhere."""
    found = []
    for file in files:
        for target in markdown_links(file.read_text(encoding="utf-8")):
            parts = urlsplit(target)
            if parts.scheme:
                continue
            there = file.parent / parts.path if parts.path else file
            known = there.suffix == ".md" and there.exists()
            anchors = markdown_anchors(there.read_text(encoding="utf-8")) if known else set()
            if not there.exists() or (parts.fragment and parts.fragment not in anchors):
                found.append(f"{file.name}: {target}")
    return found

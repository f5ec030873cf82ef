"""Directives that show the records of the package: ``measures``, ``variables`` and ``public-names``."""

from collections.abc import Iterable, Sequence
from typing import Any

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.pycode import ModuleAnalyzer
from sphinx.util.docutils import SphinxDirective

import pareto_monoped
from pareto_monoped import measures
from pareto_monoped.design import VARIABLES

BETTER = {"maximise": "more", "minimise": "less", None: ""}


class Measures(SphinxDirective):
    """A table of measures; the argument is its name in ``pareto_monoped.measures``."""

    required_arguments = 1

    def run(self) -> list[nodes.Node]:
        """One row per record, with its name as anchor."""
        table = getattr(measures, self.arguments[0])
        rows = [(one.name, one.unit, BETTER[one.direction], one.meaning) for one in table]
        return [_table(("name", "unit", "better", "meaning"), rows)]


class Variables(SphinxDirective):
    """The table of design variables."""

    def run(self) -> list[nodes.Node]:
        """One row per record, with its name as anchor."""
        head = ("name", "symbol", "unit", "bounds", "default", "meaning")
        rows = []
        for one in VARIABLES:
            default = "" if one.default is None else f"{one.default:g}"
            rows.append((one.name, one.symbol, one.unit, f"{one.lower:g} to {one.upper:g}", default, one.meaning))
        return [_table(head, rows)]


class PublicNames(SphinxDirective):
    """The API reference of every public name that a module defines, such as ``api.jumps``."""

    required_arguments = 1

    def run(self) -> list[nodes.Node]:
        """The names in the order of the module's entry in the package."""
        home, homes = self.arguments[0], pareto_monoped._HOMES
        if home not in homes:
            raise self.error(f"module {home!r} has no public names; it must be one of {', '.join(homes)}")
        lines = [line for name in homes[home] for line in _reference(name, home)]
        return self.parse_text_to_nodes("\n".join(["```{eval-rst}", *lines, "```"]))


def _reference(name: str, home: str) -> list[str]:
    """The lines in reStructuredText that document a public name."""
    value = getattr(pareto_monoped, name)
    if isinstance(value, type):
        option = ":show-inheritance:" if issubclass(value, Exception) else ":members:"
        return [f".. autoclass:: pareto_monoped.{name}", f"   {option}", ""]
    if callable(value):
        return [f".. autofunction:: pareto_monoped.{name}", ""]
    # The words below an assignment are known to the module that makes it, not to the package that hands it on.
    words = ModuleAnalyzer.for_module(f"pareto_monoped.{home}").find_attr_docs().get(("", name), [])
    return [f".. py:data:: pareto_monoped.{name}", "", *(f"   {line}" for line in words), ""]


def _table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> nodes.table:
    """A table whose first column has names in code; each is the anchor of its row."""
    group = nodes.tgroup(cols=len(head))
    group.extend(nodes.colspec(colwidth=1) for _ in head)
    group += nodes.thead("", _row(nodes.paragraph(text=title) for title in head))
    body = nodes.tbody()
    for name, *rest in rows:
        named = nodes.paragraph("", "", nodes.target("", "", nodes.literal(text=name), ids=[name]))
        body += _row([named, *(nodes.paragraph(text=cell) for cell in rest)])
    group += body
    return nodes.table("", group, classes=["records"])


def _row(cells: Iterable[nodes.Node]) -> nodes.row:
    return nodes.row("", *(nodes.entry("", cell) for cell in cells))


def setup(app: Sphinx) -> dict[str, Any]:
    """Add the directives."""
    app.add_directive("measures", Measures)
    app.add_directive("variables", Variables)
    app.add_directive("public-names", PublicNames)
    return {"parallel_read_safe": True, "parallel_write_safe": True}

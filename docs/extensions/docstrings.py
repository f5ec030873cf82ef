"""What autodoc and napoleon do not do with the docstrings of this package."""

import ast
import inspect
import sys
from dataclasses import MISSING, fields, is_dataclass
from importlib import import_module
from types import MemberDescriptorType
from typing import Any

from numpy.typing import ArrayLike
from sphinx.application import Sphinx
from sphinx.errors import PycodeError
from sphinx.ext.autodoc import INSTANCEATTR
from sphinx.pycode import ModuleAnalyzer
from sphinx.util.typing import stringify_annotation

import pareto_monoped


def setup(app: Sphinx) -> dict[str, Any]:
    """Connect the handlers; those of docstrings run before napoleon's, those of types after autodoc's."""
    app.connect("builder-inited", _know_types)
    app.connect("autodoc-process-docstring", _as_fields, priority=400)
    app.connect("autodoc-skip-member", _skip_fields)
    app.connect("autodoc-process-signature", _shorten_types, priority=900)
    return {"parallel_read_safe": True, "parallel_write_safe": True}


def _know_types(_: Sphinx) -> None:
    """Give each module the names that it imports for type checkers only, so that its annotations can be read."""
    for home in pareto_monoped._HOMES:
        module = import_module(f"pareto_monoped.{home}")
        for node in ast.parse(inspect.getsource(module)).body:
            if isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING":
                for one in node.body:
                    if isinstance(one, ast.ImportFrom) and one.module:
                        import_module(one.module)
                        for alias in one.names:
                            setattr(module, alias.name, getattr(sys.modules[one.module], alias.name))


def _as_fields(_app: Sphinx, kind: str, _name: str, value: Any, _options: Any, lines: list[str]) -> None:
    """Append the fields of a class as a list, and turn the section ``Returns`` into a field.

    The words of fields stand in comments beside them. Napoleon would take the words before the first colon of
    ``Returns`` for a type; types come from annotations here.
    """
    if "Returns:" in lines:
        lines[lines.index("Returns:")] = ":returns:"
    if kind != "class" or not (told := _field_comments(value)):
        return
    lines += ["", ":Attributes:"]
    for name, words in told.items():
        names, colon, rest = " ".join(words).partition(": ")
        if not (colon and names.split(", ")[0] == name):
            names, rest = name, " ".join(words)
        lines.append("    * " + ", ".join(f"**{one}**" for one in names.split(", ")) + f" -- {rest}")
    lines.append("")


def _field_comments(kind: type) -> dict[str, list[str]]:
    """Return the comments of a class's fields by name; a comment of several fields stands above the first."""
    try:
        found = ModuleAnalyzer.for_module(kind.__module__).find_attr_docs()
    except PycodeError:
        return {}
    return {name: words for (owner, name), words in found.items() if owner == kind.__name__}


def _skip_fields(_app: Sphinx, kind: str, name: str, value: Any, skip: bool, _options: Any) -> bool | None:
    """Leave fields to the list of their class."""
    return True if kind == "class" and isinstance(value, MemberDescriptorType | type(INSTANCEATTR)) else None


def _shorten_types(
    app: Sphinx, _kind: str, name: str, value: Any, _options: Any, signature: str | None, returned: str | None
) -> tuple[str | None, str | None]:
    """Leave the fields of a dataclass to its docstring, and write arrays as the source does.

    A dataclass whose fields have no defaults is what functions return; nobody calls it.
    """
    known = app.env.current_document.autodoc_annotations
    if is_dataclass(value):
        known.pop(name, None)
        if hasattr(value, "define") or all(one.default is MISSING for one in fields(value)):
            return "", None
    for argument, kind in known.get(name, {}).items():
        known[name][argument] = kind.replace(ARRAY, "~numpy.typing.NDArray").replace(LIKE, "~numpy.typing.ArrayLike")
    return signature, returned


ARRAY = "~numpy.ndarray[tuple[~typing.Any, ...], ~numpy.dtype[~numpy.float64]]"
"""How Sphinx writes ``NDArray[np.float64]``."""
LIKE = stringify_annotation(ArrayLike, "smart")
"""How it writes ``ArrayLike``."""

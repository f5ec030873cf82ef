"""Formulas as MathML, which browsers draw without a script: the converter is that of docutils."""

from typing import Any

from docutils import nodes
from docutils.utils.math import latex2mathml
from sphinx.application import Sphinx
from sphinx.errors import ExtensionError


def setup(app: Sphinx) -> dict[str, Any]:
    """Add the renderer ``mathml`` and choose it."""
    app.add_html_math_renderer("mathml", (_inline, None), (_block, None))
    app.connect("config-inited", lambda _, config: setattr(config, "html_math_renderer", "mathml"))
    return {"parallel_read_safe": True, "parallel_write_safe": True}


def _inline(translator: Any, node: nodes.math) -> None:
    translator.body.append(mathml(node.astext()))
    raise nodes.SkipNode


def _block(translator: Any, node: nodes.math_block) -> None:
    translator.body.append(f'<div class="math">{mathml(node.astext(), block=True)}</div>\n')
    raise nodes.SkipNode


def mathml(tex: str, *, block: bool = False) -> str:
    """A formula in TeX as MathML.

    Raises:
        ExtensionError: the converter does not know a command of it.
    """
    try:
        return str(latex2mathml.tex2mathml(tex, as_block=block))
    except Exception as error:
        raise ExtensionError(f"formula {tex!r}: {error}") from error

"""How Sphinx builds the site: ``make docs``.

The sources are the Markdown files where they stand, so the root of the repository is Sphinx's source folder and links
between them work on a code host as well as on the site. The site asks for nothing from a network: theme, search and
fonts are files, and formulas are MathML.
"""

import sys
from pathlib import Path

ROOT = Path(__file__).parents[1]
sys.path[:0] = [str(ROOT), str(Path(__file__).parent / "extensions")]

import pareto_monoped  # noqa: E402

project = "pareto_monoped"
author = "The pareto_monoped authors"
version = release = pareto_monoped.__version__

extensions = [
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "sphinx_click",
    "myst_nb",
    "docstrings",
    "mathml",
    "pages",
    "records",
]
root_doc = "docs/index"
include_patterns = [
    "docs/**.md",
    "CHANGELOG.md",
    "CONTRIBUTING.md",
    "SECURITY.md",
    "benchmarks/*.md",
    "notebooks/*.ipynb",
    "reports/README.md",
]
exclude_patterns = [".*", "build", "dist", "*.egg-info", "tests", "pareto_monoped", "**/.ipynb_checkpoints"]
nitpicky = True
# Types of other libraries, whose documentation is not at hand without a network.
nitpick_ignore_regex = [("py:.*", r"(?!pareto_monoped\.)[a-z_]\w*\..*")]

# Markdown
myst_enable_extensions = ["dollarmath", "html_image"]
myst_fence_as_directive = ["math"]
myst_heading_anchors = 4
# Notebooks are kept without outputs. Those that changed are run, which takes two minutes for all; the rest is kept.
nb_execution_mode = "cache"
nb_execution_cache_path = str(ROOT / "build" / "notebooks")
nb_execution_timeout = 300
nb_execution_raise_on_error = True
nb_execution_in_temp = True
nb_merge_streams = True

# API reference
autodoc_member_order = "bysource"
autodoc_typehints = "description"
autodoc_typehints_format = "short"
autodoc_class_signature = "mixed"
napoleon_numpy_docstring = False
napoleon_use_ivar = True
python_use_unqualified_type_names = True
python_maximum_signature_line_length = 88

# HTML
html_theme = "furo"
html_title = f"pareto_monoped {release}"
html_static_path = ["static"]
html_css_files = ["site.css"]
html_copy_source = False
html_domain_indices = False
html_show_sphinx = False
html_show_copyright = False
html_show_search_summary = False  # it would fetch the pages found, which browsers refuse for files
html_last_updated_fmt = None

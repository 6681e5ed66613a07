"""Settings of Sphinx; the sources are laid out by ``stage.py``."""

from __future__ import annotations

import re
import warnings
from pathlib import Path
from typing import Any

import stiction

# Read for the signature before it is given another name below.
warnings.filterwarnings("ignore", message="Unknown section Source")

project = "stiction"
author = "The stiction developers"
copyright = "2026, The stiction developers"
release = version = stiction.__version__
root_doc = "index"

extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "numpydoc",
    "sphinx_copybutton",
    "sphinx_gallery.gen_gallery",
]
exclude_patterns = ["walkthroughs/**"]
nitpicky = False
default_role = "code"
smartquotes = False  # x'' is a second derivative
show_warning_types = True

myst_heading_anchors = 4
myst_enable_extensions = ["colon_fence"]
myst_number_code_blocks = []
# Attributes of several classes share a name; each leads to one of its own class or to none.
suppress_warnings = ["config.cache", "ref.python"]

autodoc_typehints = "none"
autodoc_member_order = "bysource"
autodoc_class_signature = "mixed"
numpydoc_show_class_members = False
numpydoc_xref_param_type = False

html_theme = "furo"
html_title = f"stiction {release}"
html_static_path = ["static"]
html_css_files = ["site.css"]
html_js_files = ["offline-search.js"]
html_search_scorer = str(Path(__file__).parent / "static" / "scorer.js")
html_copy_source = False
html_show_sphinx = False
html_theme_options = {"navigation_with_keys": True}
pygments_style = "friendly"
pygments_dark_style = "native"
copybutton_prompt_text = "$ "
copybutton_only_copy_prompt_lines = True
copybutton_exclude = ".linenos, .gp, .go"

sphinx_gallery_conf: dict[str, Any] = {
    "examples_dirs": ["walkthroughs"],
    "gallery_dirs": ["walked"],
    "filename_pattern": r"/[0-9]\d_",
    "abort_on_example_error": True,
    "only_warn_on_example_error": False,
    "within_subsection_order": "FileNameSortKey",
    "show_memory": False,
    "show_signature": False,
    "download_all_examples": False,
    "min_reported_time": 1e9,
    "write_computation_times": False,
    "matplotlib_animations": False,
    "image_scrapers": ("docs.site.scrape.saved",),
    "capture_repr": (),
    "plot_gallery": "True",
    "run_stale_examples": True,
    "remove_config_comments": True,
}

_BARS = re.compile(r"(?<!`)([|*])(?!`)")


def _plain(app: Any, what: str, name: str, value: Any, options: Any, lines: list[str]) -> None:
    """Bars and stars of formulas are no markup: |v|, K∗x, **kwargs."""
    for k, line in enumerate(lines):
        if line == "Source" and lines[k + 1 : k + 2] == ["-" * len(line)]:
            # A section that numpydoc has under another name.
            lines[k : k + 2] = ["References", "----------"]
        parts = re.split(r"(`+[^`]*`+)", lines[k])
        lines[k] = "".join(p if p.startswith("`") else _BARS.sub(r"\\\1", p) for p in parts)


def setup(app: Any) -> None:
    """Called by Sphinx."""
    # Before numpydoc, which writes markup of its own.
    app.connect("autodoc-process-docstring", _plain, priority=100)

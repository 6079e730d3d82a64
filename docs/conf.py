"""How Sphinx makes the documentation: `make docs`.

The repository itself is the source, so that links between its Markdown files work there
and on the site alike; README.md is the first page.
"""

from __future__ import annotations

import contextlib
import io
import shutil
from importlib.metadata import version as version_of
from pathlib import Path
from typing import TYPE_CHECKING
from unittest.mock import patch

from docutils import nodes
from docutils.parsers.rst import Directive
from latex2mathml.converter import convert

from mmplan.cli import main

if TYPE_CHECKING:
    from sphinx.application import Sphinx
    from sphinx.writers.html5 import HTML5Translator

project = "mmplan"
copyright = "the mmplan authors"
release = version_of("mmplan")
root_doc = "README"
include_patterns = [
    "README.md",
    "CHANGELOG.md",
    "benchmarks/README.md",
    "docs/*.md",
    "examples/README.md",
]
extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
]
html_theme = "furo"
html_title = f"mmplan {release}"
html_copy_source = False
html_static_path = ["site"]
html_css_files = ["site.css"]
html_show_sphinx = False
html_math_renderer = "mathml"

myst_enable_extensions = ["dollarmath"]
myst_heading_anchors = 4
myst_links_external_new_tab = False

# Docstrings say shapes, units and frames in words; `names` in them are code.
default_role = "literal"
autodoc_member_order = "bysource"
autodoc_typehints_format = "short"
autodoc_default_options = {"members": True}
maximum_signature_line_length = 88
python_use_unqualified_type_names = True
napoleon_numpy_docstring = False

# The pages in their order; other pages of docs/ come last.
CONTENTS = {
    "Use": (
        "docs/concepts",
        "docs/commands",
        "docs/viewing",
        "docs/explain",
        "docs/exports",
        "docs/imports",
        "docs/generation",
        "docs/limitations",
    ),
    "Describe": (
        "docs/formats",
        "docs/carrying",
        "docs/plan_format",
        "docs/robots",
        "docs/grasps",
    ),
    "Program": ("docs/python", "docs/extending", "examples/README"),
    "Judge": ("docs/benchmarks", "Measured <benchmarks/README>", "CHANGELOG"),
}


class Help(Directive):
    """What a command says of itself: `{help} solve`."""

    required_arguments = 1
    final_argument_whitespace = True

    def run(self) -> list[nodes.Node]:
        """The text of its `--help`, as wide as a page."""
        text = io.StringIO()
        command = self.arguments[0].split()
        with (
            contextlib.redirect_stdout(text),
            contextlib.suppress(SystemExit),
            patch.dict("os.environ", COLUMNS="80"),
        ):
            main([*command, "--help"])
        return [nodes.literal_block(text=text.getvalue(), language="text")]


def setup(app: Sphinx) -> None:
    """Take part in the build."""
    app.add_directive("help", Help)
    app.add_html_math_renderer(
        "mathml", inline_renderers=(_formula, None), block_renderers=(_formula, None)
    )
    app.connect("source-read", _add_contents)
    app.connect("build-finished", _add_index)


def _add_contents(app: Sphinx, page: str, source: list[str]) -> None:
    """Put the contents at the end of the first page, where they make the sidebar."""
    if page != app.config.root_doc:
        return
    listed = {page for pages in CONTENTS.values() for page in pages}
    all_pages = {f"docs/{path.stem}" for path in Path(app.confdir).glob("*.md")}
    contents = {**CONTENTS, "More": sorted(all_pages - listed)}
    for caption, pages in contents.items():
        if not pages:
            continue
        lines = "\n".join([":hidden:", f":caption: {caption}", *pages])
        source[0] += f"\n```{{toctree}}\n{lines}\n```\n"


def _add_index(app: Sphinx, error: Exception | None) -> None:
    """Let the first page also be found as that of the folder."""
    if error is None:
        shutil.copy(Path(app.outdir) / "README.html", Path(app.outdir) / "index.html")


def _formula(translator: HTML5Translator, node: nodes.math | nodes.math_block) -> None:
    """A formula in MathML, which browsers draw by themselves."""
    block = isinstance(node, nodes.math_block)
    mathml = convert(node.astext(), display="block" if block else "inline")
    translator.body.append(mathml)
    raise nodes.SkipNode

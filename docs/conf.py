"""Sphinx configuration. ``make docs`` builds docs/_build/html, which needs no network to read."""

import sys
from pathlib import Path

import ziamath

import moro

sys.path.insert(0, str(Path(__file__).parent / "_extensions"))

project = "moro"
release = moro.__version__

extensions = ["mathml", "reports", "myst_nb", "sphinx.ext.autodoc", "sphinx_copybutton"]
exclude_patterns = ["_build"]

myst_enable_extensions = ["amsmath", "deflist", "dollarmath"]
myst_heading_anchors = 3
nb_execution_mode = "off"  # the outputs in the files are those that tests have compared

math_renderer = "mathml"
autodoc_member_order = "bysource"
autodoc_typehints = "none"
add_module_names = False

# what is copied is what one types: no prompts, no output
copybutton_prompt_text = r">>> |\.\.\. |\$ "
copybutton_prompt_is_regexp = True

html_theme = "furo"
html_title = "moro"
html_css_files = ["moro.css"]
html_copy_source = False
html_show_copyright = False
# the one font that browsers need for formulas and not every system has
html_static_path = ["_static", str(Path(ziamath.__file__).parent / "fonts/STIXTwoMath-Regular.ttf")]

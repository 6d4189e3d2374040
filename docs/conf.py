"""The site: `sphinx-build -W -b html docs build/docs`. The pages are plain Markdown files."""

from importlib import metadata

project = "gearopt"
author = "The gearopt authors"
project_copyright = author
release = metadata.version("gearopt")

highlight_language = "none"  # blocks without a language are commands and what they print
extensions = ["myst_parser"]
source_suffix = {".md": "markdown"}
myst_heading_anchors = 3  # links to headings work as they do in the plain files

smartquotes = False  # a quoted value of a file is code

html_theme = "furo"
html_title = "gearopt"
html_copy_source = False
html_show_sphinx = False
html_static_path = ["style"]
html_css_files = ["site.css"]

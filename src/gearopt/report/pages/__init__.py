"""Pages that a browser shows without a network: one self-contained HTML file each.

`frame` is what they share; each other module is a page, with a template of its name beside it.
"""

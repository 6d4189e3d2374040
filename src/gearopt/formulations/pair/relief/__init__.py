"""Profile relief of spur gears: flanks cut back towards the tips, so that load passes smoothly.

`meshing` has the pair in mesh at its loads and what relief does to it, `rules` closed forms,
`parametric` the best amounts and lengths, `free_form` the best profile of any shape. All of it is
plane: crowning, and relief of the ends of teeth, vary along the face and are out of its reach.
"""

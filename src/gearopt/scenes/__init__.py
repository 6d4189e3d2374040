"""Problem files: what they may ask for, and how they become formulations.

Each module here is a kind of file and its name is the kind: `Scene` (a pydantic model),
`solve(scene, ask) -> Result`, `model(scene, method) -> Model` for comparisons, and `EXAMPLE`, the
text that `gearopt new KIND` prints. How files are read is in `reading`.
"""

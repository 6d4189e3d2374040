"""Problem files: what they may ask for, and how they become formulations.

Each module here is a kind of file and its name is the kind: `Scene` (a pydantic model),
`solve(scene, ask) -> Result`, `explain(scene, ask) -> Explanation`, `model(scene, method) -> Model`
for comparisons, `compared(scene)` (the methods compared where none are named), and `EXAMPLE`, the
text that `gearopt new KIND` prints. How files are read is in `reading`.
"""

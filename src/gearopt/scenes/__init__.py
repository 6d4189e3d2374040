"""Problem files: what they may ask for, and how they become formulations.

Each module here is a kind of file and its name is the kind: `Scene` (a pydantic model),
`solve(scene, ask) -> Result`, `model(scene, method) -> Model` for comparisons, `compared(scene)`
(the methods compared where none are named), and `EXAMPLE`, the text that `gearopt new KIND` prints.
`METHODS` names its own methods for help and completion, `idle(scene, method)` the options of
`solve` that change nothing, each with the reason. A kind that knows more than the default of
`explaining` has an `explain(scene, ask, result)` of its own; result: the answer, None where it is
not known. How files are read is in `reading`.
"""

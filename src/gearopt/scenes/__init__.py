"""Problem files: what they may ask for, and how they become formulations.

Each package here is a kind of file, and its name is the kind. It ends with `KIND`, a `kind.Kind`:
the tables of a file (`Scene`, a pydantic model), its examples (`examples/NAME.toml`, of which
`gearopt new NAME` prints one), how it is solved, compared and explained. How files are read is in
`reading`, what explanations of all kinds share in `explaining`.
"""

"""Back ends for any problem: one file each, `run(problem, budget, seed, watch) -> Outcome`.

The module name is the method's name. A back end claims; `certificate` judges.
"""

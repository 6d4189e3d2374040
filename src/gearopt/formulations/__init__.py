"""Physics posed as optimisation: one file or one small folder a topic.

Inputs are frozen dataclasses of plain mm-N-s numbers, so every formulation is used from Python
without a problem file.
"""

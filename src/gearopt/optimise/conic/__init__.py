"""Linear and conic problems written in cvxpy: canonical data, scaling, and proofs."""

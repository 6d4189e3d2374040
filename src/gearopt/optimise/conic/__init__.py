"""Linear and conic problems written in cvxpy: canonical data, scaling, and what they prove."""

"""Tables of problem files that a kind may use: their keys, checks and meaning."""

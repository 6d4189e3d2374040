"""Motion of a pair on moving axes: integrated in time, its stability, its periodic orbits."""

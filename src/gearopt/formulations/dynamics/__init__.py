"""The motion of a pair on moving axes: states, response, stability, speeds."""

"""What is to be known of the motion of a pair: states, response, stability, speeds."""

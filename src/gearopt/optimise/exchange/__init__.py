"""Problems in the forms of other tools: AMPL's .nl files, pymoo's problems."""

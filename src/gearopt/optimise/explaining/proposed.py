"""How a number is written that is proposed to a user."""

DIGITS = 6  # rounded to relax the limit
# a proposal asks for this much more than the factor found, to be feasible in doubles
FEASIBILITY_MARGIN = 2e-7

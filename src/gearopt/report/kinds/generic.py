"""Any kind of result, and problems of a user's own: tables of whatever the design holds.

A design with a list of `stages` that has the sizes of gears is drawn, too.
"""

from gearopt.report.kinds import Kind
from gearopt.report.pages import anytime, asked, assurance, design_tables, outcome, prices, ways_out
from gearopt.report.pages.train_views import section as gears_in_one_line

FIRST = (outcome.summary, ways_out.section)
ASKED = (asked.section, outcome.limits, prices.section)
LAST = (anytime.section, assurance.proven, assurance.assumptions)
TOLD = (prices.section, ways_out.section, outcome.summary)  # on the terminal, after the design

KIND = Kind(
    sections=(*FIRST, gears_in_one_line, design_tables.section, *ASKED, *LAST),
    terminal=(design_tables.section, outcome.limits, *TOLD),
)

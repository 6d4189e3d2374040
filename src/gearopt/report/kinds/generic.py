"""Any kind of result, and problems of a user's own: tables of whatever the design holds.

A design with a list of `stages` that has the sizes of gears is drawn, too.
"""

from gearopt.report.answer import asked, assumptions, limits, progress, proven, summary
from gearopt.report.design_tables import tables
from gearopt.report.drawing.impossible_views import section as impossible
from gearopt.report.drawing.train_views import section as gears_in_one_line
from gearopt.report.explained import remedies, sensitivities
from gearopt.report.kinds import Pages

FIRST = (summary, remedies, impossible)
ASKED = (asked, limits, sensitivities)
LAST = (progress, proven, assumptions)
TOLD = (sensitivities, remedies, summary)  # on the terminal, after the design

PAGES = Pages(
    sections=(*FIRST, gears_in_one_line, tables, *ASKED, *LAST),
    terminal=(tables, limits, *TOLD),
)

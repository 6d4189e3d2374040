"""Any kind of result, and problems of a user's own: tables of whatever the design holds.

A design with a list of `stages` that has the sizes of gears is drawn, too.
"""

from gearopt.report.answer import asked, assumptions, limits, progress, proven, summary
from gearopt.report.design_tables import design_section
from gearopt.report.drawing.impossible_views import section as impossible
from gearopt.report.drawing.train_views import section as gears_in_one_line
from gearopt.report.explained import remedies, sensitivities
from gearopt.report.kinds import Pages

OPENING = (summary, remedies, impossible, asked)
REQUEST = (limits, sensitivities)
CLOSING = (progress, proven, assumptions)
AFTER_DESIGN = (sensitivities, remedies, summary)  # on the terminal, after the design

PAGES = Pages(
    sections=(*OPENING, gears_in_one_line, design_section, *REQUEST, *CLOSING),
    terminal=(design_section, limits, *AFTER_DESIGN),
)

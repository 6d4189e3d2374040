"""The table [flank]: how the flanks are modified and misaligned along the face, and its slices."""

from typing import Annotated

from pydantic import Field

from gearopt.scenes.reading.fields import Table, quantity, whole
from gearopt.units import Quantity

GAP = quantity("length", "10 um", "1 mm", signed=True)
SLICES = 41
FEWEST = 11  # slices of what varies along the face
ALONG = ("crowning", "helix_correction", "misalignment")


class FlankTable(Table):
    """Modifications of the flanks along the face, and the slices in which contact is computed."""

    crowning: Annotated[Quantity | None, quantity("length", "5 um", "1 mm", zero=True)] = Field(
        None,
        description="Crowning C_beta of both flanks together: what a parabola takes off at either "
        "end of the face",
    )
    helix_correction: Annotated[Quantity | None, GAP] = Field(
        None,
        description="Helix slope modification C_Hbeta of both flanks together: what a straight "
        "line takes off at the end that a positive misalignment loads",
    )
    misalignment: Annotated[Quantity | None, GAP] = Field(
        None,
        description="Misalignment of the flanks over the face width, of shafts, bearings and teeth "
        "together, along the line of action: above zero it opens the end where contact begins, "
        "below zero the other",
    )
    slices: Annotated[int, whole(SLICES, 1, 201)] = Field(
        SLICES, description="Slices across the face"
    )

    @property
    def modified(self) -> bool:
        """Return whether anything varies along the face."""
        return any(self.millimetres(name) for name in ALONG)

    def millimetres(self, name: str) -> float:
        """Return a modification [mm], 0 where the file has none."""
        held: Quantity | None = getattr(self, name)
        return 0.0 if held is None else held.value

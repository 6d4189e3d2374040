"""Field type of problem files for steels by name."""

from typing import Any

from gearopt.physics import steels
from gearopt.scenes.reading.fields import Reads, refuse

LIST = "gearopt materials lists those that are known"


def steel_name() -> Reads:
    """Read the name or number of a steel, as it is usually written."""

    def read(value: Any, example: Any) -> str:
        if isinstance(value, list | tuple):
            rule = "is a list: gears choose from materials, each a table [[material]] with a steel"
            raise refuse(rule, f"Write materials = {[*map(str, value)]}", action="tell")
        if not isinstance(value, str):
            raise refuse("is not the name of a steel", str(value))
        if rows := steels.named(value):
            return value if value in rows[0].names else rows[0].name
        if steels.is_plastic(value):
            rule = "is a plastic: VDI 2736 is not supported, AGMA 2001 and ISO 6336 rate metals"
            raise refuse(rule, f"Write a steel; {LIST}", action="tell")
        close = steels.near(value)
        rule = f"is no steel that is known by name ({LIST}; or write treatment and hardness)"
        raise refuse(rule, close[0] if close else None)

    return Reads(read, "16MnCr5", {"type": "string"})

"""Names of things that a file may call alike: each is numbered, so that a report tells them apart.

Cylinders of a packing and keep-outs of a layout have such names.
"""

from collections import Counter
from collections.abc import Iterator, Sequence
from itertools import count


def numbered(names: Sequence[str]) -> Iterator[str]:
    """Yield names of which no two are alike: a name that stands once as it is, others numbered.

    A number is left out where another name has it already.
    """
    times = Counter(names)
    taken = {name for name in names if times[name] == 1}
    numbers = {name: count(1) for name in names}
    for name in names:
        if times[name] == 1:
            yield name
            continue
        another = (f"{name} {k}" for k in numbers[name])
        free = next(one for one in another if one not in taken)
        taken.add(free)
        yield free

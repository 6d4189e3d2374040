"""The exceptions of gearopt.

    GearoptError
        SceneError          the problem file (or a command's argument) is wrong
        SolveError          a back end cannot take or broke on this problem
        CertificateError    a result was refused: it contradicts our own computation

An infeasible request is not an exception: it is a status of the result.
"""

from collections.abc import Sequence

from gearopt.frozen import dataclass


class GearoptError(Exception):
    """Everything gearopt raises on purpose."""


class SolveError(GearoptError):
    """A back end cannot take this problem, or failed while solving it."""


class CertificateError(GearoptError):
    """A result was refused because it contradicts what gearopt computed itself."""


@dataclass(frozen=True)
class Fix:
    """A remedy that a machine can apply.

    action: set, rename, remove, swap (exchange the values of two keys), or replace (the whole file
    by what `gearopt VALUE` prints). key: dotted path in the file, `stage[2].module` for the second
    `[[stage]]`. value: TOML text to write (set), the new name (rename), the other key (swap), a
    command (replace), or empty.
    """

    action: str
    key: str
    value: str = ""


class SceneError(GearoptError):
    """A problem file cannot be used: for every mistake where, what was found, and what to write.

    file, key, value: where the first mistake is and what stands there (value as text, shortened).
    rule: what is wrong, one sentence.
    remedy: what to write instead, one sentence.
    fix: the remedy as data, when one change of one key mends the file; else None.
    errors: all mistakes of the file in its order, this one first, each an error of its own; the
    text has a line for each of the first `SHOWN`.
    """

    SHOWN = 20

    def __init__(
        self,
        file: str,
        key: str,
        value: str,
        rule: str,
        remedy: str,
        fix: Fix | None = None,
        more: "Sequence[SceneError]" = (),
    ) -> None:
        self.file, self.key, self.value = file, key, value
        self.rule, self.remedy, self.fix = rule, remedy, fix
        self.errors: tuple[SceneError, ...] = (self, *more)
        lines = [self._line(), *(error._line() for error in more)]
        if (left := len(lines) - self.SHOWN) > 0:
            lines[self.SHOWN :] = [f"{self._name()}: and {left} more"]
        super().__init__("\n".join(lines))

    def __reduce__(self) -> tuple[type, tuple[object, ...]]:
        """Arguments from which copies and other processes build it: its text alone would not do."""
        place = self.file, self.key, self.value
        return SceneError, (*place, self.rule, self.remedy, self.fix, self.errors[1:])

    def _name(self) -> str:
        return "".join(c if c.isprintable() else "?" for c in self.file)

    def _line(self) -> str:
        where = self._name() + (f": {self.key}" if self.key else "")
        value = f" = {self.value}" if self.value else ""
        return f"{where}{value}: {self.rule}. {self.remedy}".rstrip()


def together(errors: Sequence[SceneError]) -> SceneError:
    """Return one error that holds several, of which there is at least one."""
    first = errors[0]
    place = first.file, first.key, first.value
    return SceneError(*place, first.rule, first.remedy, first.fix, errors[1:])

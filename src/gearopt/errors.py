"""The exceptions of gearopt.

    GearoptError
        SceneError          the problem file (or a command's argument) is wrong
        SolveError          a back end cannot take or broke on this problem
        CertificateError    a result was refused: it contradicts our own computation

An infeasible request is not an exception: it is a status of the result.
"""

from dataclasses import dataclass


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
    """A problem file cannot be used: says where, what was found, the rule, and what to write.

    file, key, value: where it is and what stands there (value as text, shortened).
    rule: what is wrong, one sentence.
    remedy: what to write instead, one sentence.
    fix: the remedy as data, when one change of one key mends the file; else None.
    """

    def __init__(
        self,
        file: str,
        key: str,
        value: str,
        rule: str,
        remedy: str,
        fix: Fix | None = None,
    ) -> None:
        self.file, self.key, self.value = file, key, value
        self.rule, self.remedy, self.fix = rule, remedy, fix
        super().__init__(self._text())

    def _text(self) -> str:
        name = "".join(c if c.isprintable() else "?" for c in self.file)
        where = name + (f": {self.key}" if self.key else "")
        found = f" = {self.value}" if self.value else ""
        return f"{where}{found}: {self.rule}. {self.remedy}".rstrip()

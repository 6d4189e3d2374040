"""Frozen classes load faster than the library's, and objects of them behave alike."""

import abc
import dataclasses
import inspect
import pickle
from dataclasses import FrozenInstanceError, asdict, field, fields, replace
from enum import Enum
from typing import ClassVar

import pytest

from gearopt.frozen import dataclass


def _classes(dataclass):
    """The same classes by one decorator or the other."""

    @dataclass(frozen=True)
    class Gear:
        teeth: int
        module: float = 1.0
        notes: list[str] = field(default_factory=list, hash=False)
        name: str = field(default="gear", compare=False)
        secret: int = field(default=3, repr=False)
        wheel_of: ClassVar[str] = "none"

        def diameter(self):
            return self.teeth * self.module

    @dataclass(frozen=True, kw_only=True)
    class Helical(Gear):
        helix: float
        total: float = field(init=False)
        memory: dict[str, int] = field(init=False, default_factory=dict, compare=False)

        def __post_init__(self):
            object.__setattr__(self, "total", self.teeth + self.helix)

    @dataclass(frozen=True)
    class Empty:
        pass

    @dataclass(frozen=True)
    class Spoken:
        word: str

        def __repr__(self):
            return self.word

    return Gear, Helical, Empty, Spoken


OURS, THEIRS = _classes(dataclass), _classes(dataclasses.dataclass)


def _made(classes):
    gear, helical, empty, spoken = classes
    return [
        gear(20),
        gear(20, notes=["ground"]),
        gear(teeth=20, name="other"),
        gear(20, 2.0, [], "gear", 4),
        helical(21, helix=0.5),
        helical(21, 1.0, ["hobbed"], helix=0.5),
        empty(),
        spoken("twenty"),
    ]


def test_objects_are_those_of_the_library():
    """Printed, compared, hashed and read alike, in every pair."""
    ours, theirs = _made(OURS), _made(THEIRS)
    assert [repr(x) for x in ours] == [repr(x) for x in theirs]
    assert [asdict(x) for x in ours] == [asdict(x) for x in theirs]
    assert [[x == y for y in ours] for x in ours] == [[x == y for y in theirs] for x in theirs]
    assert len(set(ours)) == len(set(theirs)) == 7  # notes are no part of a hash, but of equality
    assert ours[0] != theirs[0]
    assert replace(ours[4], helix=1.5).total == replace(theirs[4], helix=1.5).total == 22.5
    assert ours[0].notes is not ours[2].notes


@pytest.mark.parametrize(("our", "their"), [*zip(OURS, THEIRS, strict=True)])
def test_classes_have_fields_and_signature_of_the_library(our, their):
    assert str(inspect.signature(our)) == str(inspect.signature(their))
    assert our.__match_args__ == their.__match_args__
    read = [[(f.name, f.type, f.default, f.kw_only) for f in fields(c)] for c in (our, their)]
    assert read[0] == read[1]
    assert our.__init__.__qualname__.endswith(f"{our.__name__}.__init__")


@pytest.mark.parametrize("classes", [OURS, THEIRS])
def test_nothing_changes(classes):
    gear = classes[0](20)
    with pytest.raises(FrozenInstanceError, match="cannot assign to field 'teeth'"):
        gear.teeth = 21
    with pytest.raises(FrozenInstanceError, match="cannot delete field 'teeth'"):
        del gear.teeth
    with pytest.raises(TypeError, match="missing 1 required"):
        classes[0]()
    with pytest.raises(TypeError, match="positional argument"):
        classes[1](1, 1.0, [], "", 3, 0.5)


@dataclass(frozen=True)
class Sent:
    teeth: int


def test_objects_are_sent_to_other_processes():
    assert pickle.loads(pickle.dumps(Sent(20))) == Sent(20)


def test_mutable_ordered_and_own_comparisons_are_the_librarys():
    @dataclass
    class Count:
        found: int = 0

    @dataclass(frozen=True, order=True)
    class Rank:
        place: int

    @dataclass(frozen=True)
    class Own:
        value: float

        def __eq__(self, other):
            return True

    count = Count()
    count.found += 1
    assert count == Count(1)
    assert Rank(1) < Rank(2)
    assert Own(1.0) == 2


def same(text):
    """The errors, or the repr of `shown`, of a text by one decorator and the other."""
    said = []
    for decorator in (dataclass, dataclasses.dataclass):
        known = {"dataclass": decorator, "field": field, "InitVar": dataclasses.InitVar, "abc": abc}
        known |= {"__name__": __name__, "Enum": Enum}
        try:
            exec(text, known)
            said.append(repr(known["shown"]))
        except Exception as error:
            said.append(f"{type(error).__name__}: {error}")
    return said


FORMS = {
    "init only": """
    teeth: int
    worn: InitVar[int]
    left: int = 0
    def __post_init__(self, worn):
        object.__setattr__(self, "left", self.teeth - worn)
shown = Gear(20, 3), str(inspect_signature(Gear))""",
    "another frozen class": "    teeth: int\n@dataclass(frozen=True, order=True)\nclass B(Gear):\n"
    "    module: float\nshown = B(20, 1.0) < B(20, 2.0)",
    "a mutable class of a frozen one": "    teeth: int\n@dataclass\nclass B(Gear):\n    x: int\n"
    "shown = B",
    "default first": "    module: float = 1.0\n    teeth: int\nshown = Gear",
    "names in use": "    self: int\n    put: int\n    _FACTORY: int\n"
    "    _fresh_notes: int\n    notes: list = field(default_factory=list)\n"
    "shown = Gear(1, 2, 3, 4)",
    "a plain derived class": "    teeth: int\nclass B(Gear):\n    pass\nb = B(20)\nb.extra = 1\n"
    "shown = b.extra, b, b == Gear(20), B(20) == b\nb.teeth = 2",
    "words of a member": "    teeth: int\nclass B(Gear, Enum):\n    SMALL = 17\n"
    "shown = B.SMALL.teeth",
    "base's own words": "    teeth: int\n@dataclass(frozen=True)\nclass B(Gear):\n    '''B.'''\n"
    "    module: float = 1.0\nshown = Gear.__repr__(B(20)), Gear.__eq__(B(20), B(20, 2.0))",
    "hints": "    teeth: 'int'\n    wheel: 'Gear | None' = None\n"
    "globals_of = globals()\nshown = Gear.__init__.__annotations__, Gear.__dataclass_params__",
    "wrong calls": "    teeth: int\nshown = Gear(1).__eq__.__name__, Gear(1).__hash__.__name__",
}


@pytest.mark.parametrize("form", FORMS)
def test_forms_that_are_not_plain_are_the_librarys(form):
    text = f"@dataclass(frozen=True)\nclass Gear:\n    '''A gear.'''\n{FORMS[form]}"
    ours, theirs = same(text.replace("inspect_signature", "__import__('inspect').signature"))
    assert ours == theirs


def test_an_abstract_comparison_stays_what_the_library_makes_of_it():
    ours, theirs = same(
        "class Base(abc.ABC):\n    @abc.abstractmethod\n    def __eq__(self, other): ...\n"
        "@dataclass(frozen=True)\nclass Gear(Base):\n    '''A gear.'''\n    teeth: int\n"
        "shown = Gear(20) == Gear(20)"
    )
    assert ours == theirs == "True"

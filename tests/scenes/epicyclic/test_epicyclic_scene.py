"""Files of planetary trains: answers, refusals, what to write instead of an impossible one."""

import math
import tomllib
from decimal import Decimal
from fractions import Fraction as F
from io import StringIO

import pytest
from rich.console import Console

import gearopt
from gearopt.errors import SceneError
from gearopt.report.pages.result import page
from gearopt.report.terminal import show
from gearopt.scenes.reading.load import read

SIMPLE = {
    "train": {"arrangement": "simple", "planets": 4, "ratio": 5, "fixed": "ring"},
    "teeth": {"sun": 20, "planet": 30, "ring": 80},
}
SIMPLE["train"] |= {"input": "sun", "output": "carrier"}
SERIES = {
    "train": {
        "arrangement": "coupled",
        "planets": 4,
        "ratio": 25,
        "joined": [["carrier1", "sun2"]],
        "fixed": ["ring1", "ring2"],
        "input": "sun1",
        "output": "carrier2",
    },
    "teeth": {"sun1": 20, "planet1": 30, "ring1": 80, "sun2": 20, "planet2": 30, "ring2": 80},
}


def file(base, **tables):
    """A file of a base with other keys of its tables; None: without the key."""
    text = 'gearopt = 1\nkind = "epicyclic"\n'
    for name in {**base, **tables}:
        text += f"[{name}]\n"
        keys = base.get(name, {}) | tables.get(name, {})
        text += "".join(f"{k} = {written(v)}\n" for k, v in keys.items() if v is not None)
    return text


def written(value):
    if isinstance(value, list):
        return f"[{', '.join(map(written, value))}]"
    return f'"{value}"' if isinstance(value, str) else str(value)


def solved(base, **tables):
    return gearopt.solve(read(file(base, **tables).encode())[1])


def refused(base, **tables):
    with pytest.raises(SceneError) as wrong:
        read(file(base, **tables).encode())
        gearopt.solve(read(file(base, **tables).encode())[1])
    return f"{wrong.value.key}: {wrong.value.rule}. {wrong.value.remedy}"


def speed(result, name):
    return next(m["speed"] for m in result.design["members"] if m["name"] == name)


@pytest.mark.parametrize(
    ("use", "ratio", "eta"),
    [
        (("ring", "sun", "carrier"), 5, 0.976),
        (("ring", "carrier", "sun"), "1/5", 0.975855130784708),
        (("sun", "ring", "carrier"), "5/4", 0.994),
        (("sun", "carrier", "ring"), "4/5", 0.9938524590164),
        (("carrier", "sun", "ring"), -4, 0.97),
        (("carrier", "ring", "sun"), "-1/4", 0.97),
    ],
)
def test_six_uses_of_a_simple_set(use, ratio, eta):
    """r = 4, basic efficiency 0.97 (closed forms)."""
    members = dict(zip(("fixed", "input", "output"), use, strict=True))
    losses = {"sun": 0.97, "ring": 1}
    result = solved(SIMPLE, train=members | {"ratio": ratio}, efficiency=losses)
    assert result.status == "optimal" and result.value == 0.0
    assert result.design["efficiency"] == pytest.approx(eta, rel=1e-12)
    assert F(result.design["exact_ratio"]) == F(str(ratio))


def test_stages_in_series_multiply():
    result = solved(SERIES)
    assert result.value == 0.0 and result.design["ratio"] == 25.0
    one = solved(SIMPLE).design["efficiency"]
    assert result.design["efficiency"] == pytest.approx(one**2, rel=1e-12)
    assert speed(result, "carrier1") == pytest.approx(0.2)


def test_the_published_5_mw_stage_needs_shifts():
    """18/36/93 of a public report: 93 - 36 is three teeth more than 18 + 36; 999650.881 N m."""
    teeth = {"sun": 18, "planet": 36, "ring": 93}
    asked = {"ratio": "37/6", "planets": 3}
    result = solved(SIMPLE, train=asked, teeth=teeth)
    assert result.status == "infeasible"
    ways = result.report["ways_out"]
    assert ways["conflict"] == ["equal_centre_distances"]
    written_ways = {c["key"]: c["write"] for r in ways["remedies"] for c in r["changes"]}
    assert written_ways["limits.coaxial_difference"] == "3"
    perfect = {"sun": 1, "ring": 1}
    result = solved(SIMPLE, train=asked, teeth=teeth, limits={"coaxial_difference": 3},
                    efficiency=perfect)  # fmt: skip
    assert result.value == 0.0 and any("profile shifts" in n for n in result.report["notes"])
    carrier = next(m for m in result.design["members"] if m["name"] == "carrier")
    assert -162105.5 * carrier["torque"] == pytest.approx(999650.881, rel=1e-6)


def test_remedies_of_an_impossible_ratio_are_proven_and_accepted():
    ranges = {"sun": [17, 25], "planet": [17, 30], "ring": [50, 90]}
    limits = {"ratio_tolerance": "0.01 %"}
    result = solved(SIMPLE, train={"ratio": 5.37}, teeth=ranges, limits=limits)
    ways = result.report["ways_out"]
    assert result.status == "infeasible" and ways["conflict"] == ["ratio_tolerance"]
    free = solved(SIMPLE, train={"ratio": 5.37}, teeth=ranges)
    by_key = {r["changes"][0]["key"]: r for r in ways["remedies"]}
    ratio = F(by_key["train.ratio"]["changes"][0]["write"].strip('"'))
    assert ratio == F(free.design["exact_ratio"])
    per_cent = float(by_key["limits.ratio_tolerance"]["changes"][0]["write"].strip('"% '))
    assert per_cent == pytest.approx(100.0 * free.value, rel=2e-6) and per_cent >= 100 * free.value
    for remedy in ways["remedies"]:
        edits = {c["key"]: c["write"] for c in remedy["changes"]}
        text = file(SIMPLE, train={"ratio": 5.37}, teeth=ranges, limits=limits)
        content = read(text.encode())[1]
        changed = gearopt.solve(content, {k: parsed(v) for k, v in edits.items()})
        assert changed.status == "optimal", edits


def parsed(text):
    return tomllib.loads(f"x = {text}", parse_float=Decimal)["x"]


def test_unequal_spacing_is_a_way_out_of_an_assembly_that_cannot_be():
    """20 + 80 is no multiple of 3: nearest places are at 0, 33 and 67 hundredths of a turn."""
    result = solved(SIMPLE, train={"planets": 3})
    assert result.status == "infeasible"
    ways = result.report["ways_out"]
    assert ways["conflict"] == ["assembly"]
    choices = [r for r in ways["remedies"] if r["kind"] == "choice"]
    assert [c["changes"][0]["write"] for c in choices] == ['"nearest"']
    near = solved(SIMPLE, train={"planets": 3, "spacing": "nearest"})
    assert [p["turn"] for p in near.design["places"]] == ["0", "33/100", "67/100"]
    gap = 50 * math.sin(0.33 * math.pi) - 32
    assert near.design["gap_modules"] == pytest.approx(gap, rel=1e-12)


def test_what_is_assumed_and_not_rated_is_said():
    notes = " ".join(solved(SIMPLE).report["notes"])
    assert "assumed (unverified): 0.99 at suns, 0.995 at rings." in notes and "rated" in notes
    notes = " ".join(solved(SIMPLE, efficiency={"sun": 0.98}).report["notes"])
    assert "assumed (unverified): 0.995 at rings." in notes
    assert "assumed" not in str(solved(SIMPLE, efficiency={"sun": 1, "ring": 1}).report["notes"])


def test_a_published_3k_set_fits_three_planets_not_six():
    """5/4/13 and 6/21 of modules 15 to 9: 50.4 (public repository CKraft11/pygeartrain)."""
    train = {"arrangement": "wolfrom", "planets": 6, "ratio": "252/5", "module_ratio": "3/5"}
    train |= {"fixed": "ring1", "output": "ring2"}
    teeth = {"planet": None, "ring": None, "sun": 5, "planet1": 4, "ring1": 13}
    tables = {
        "teeth": teeth | {"planet2": 6, "ring2": 21},
        "limits": {"ring_minus_planet": 9, "neighbour_clearance": 0},
    }
    result = solved(SIMPLE, train=train, **tables)
    ways = result.report["ways_out"]
    assert result.status == "infeasible" and ways["conflict"] == ["assembly"]
    assert ways["remedies"][0]["changes"][0]["write"] == "3"
    result = solved(SIMPLE, train=train | {"planets": 3}, **tables)
    assert result.value == 0.0 and result.design["ratio"] == 50.4


def test_a_train_that_locks_itself_says_so():
    train = {
        "arrangement": "wolfrom",
        "planets": 3,
        "ratio": "1/116",
        "input": "ring2",
        "output": "sun",
    }
    teeth = {"planet": None, "ring": None, "sun": 18, "planet1": 36, "ring1": 90}
    teeth |= {"planet2": 33, "ring2": 87}
    losses = {"sun": 0.95, "ring": 0.95}
    result = solved(SIMPLE, train=train | {"fixed": "ring1"}, teeth=teeth, efficiency=losses)
    assert result.design["efficiency"] == 0.0 and "locks itself" in result.report["notes"][0]
    out = StringIO()
    show(result, Console(file=out, width=110))
    assert "locks itself" in " ".join(out.getvalue().split()) and page(result, "")


@pytest.mark.parametrize(
    ("tables", "words"),
    [
        ({"train": {"ratio": 0}}, "train.ratio: is 0"),
        ({"train": {"ratio": "-0/3"}}, "train.ratio"),
        ({"train": {"output": "ring1"}}, "train.output: names ring1; members are carrier, ring, s"),
        ({"train": {"output": "ring"}}, "is used twice"),
        ({"train": {"ratio": None}}, "train.ratio: is missing"),
        ({"train": {"joined": [["sun", "ring"]]}}, "train.joined"),
        ({"teeth": {"ring2": 80}}, "teeth.ring2: is no gear of a simple train"),
        ({"teeth": {"sun": None}}, "teeth.sun: is missing"),
        ({"teeth": {"sun": [30, 20]}}, "wrong order. Write sun = [20, 30]"),
        ({"limits": {"ratio_tolerance": 2}}, 'Write ratio_tolerance = "2 %"'),
        ({"objective": {"minimise": "loss"}}, "limits.ratio_tolerance: is missing"),
        ({"train": {"module_ratio": 0.8}}, "train.module_ratio: is of planets with two steps"),
        ({"teeth": {"sun_teeth": 20}}, "Write sun, in [teeth]"),
        ({"duty": {"power": "1 kW"}}, "duty"),
    ],
)
def test_what_is_refused(tables, words):
    objective = {"objective": {"minimise": "ratio_error"}} if "ratio" in words else {}
    if "loss" in str(tables):
        objective = {}
    assert words in refused(SIMPLE, **(objective | tables))


@pytest.mark.parametrize(
    ("train", "words"),
    [
        ({"fixed": "ring1"}, "three in all"),
        ({"joined": [["sun1", "ring1"]]}, "which are not of two sets"),
        ({"joined": [["carrier1", "sun9"]]}, "is not one of"),
        ({"joined": ["carrier1"]}, "train.joined"),
        ({"fixed": ["ring1", "sun1"]}, "is used twice"),
        ({"fixed": ["ring1", "carrier1"]}, "is used twice|does not turn"),
        ({"output": None}, "train.output: is missing"),
    ],
)
def test_couplings_that_are_none(train, words):
    message = refused(SERIES, train=train)
    assert any(word in message for word in words.split("|")), message


def test_planetary_sets_are_stages_of_drives():
    with pytest.raises(SceneError) as wrong:
        gearopt.solve({"gearopt": 1, "kind": "planetary gear"})
    start = "gearopt new planetary prints a file to start from"
    assert wrong.value.remedy == f'Write kind = "drive"; {start}'


@pytest.mark.parametrize("kind", ["planetary train", "wolfrom", "epicyclic_train"])
def test_other_names_lead_here(kind):
    with pytest.raises(SceneError) as wrong:
        gearopt.solve({"gearopt": 1, "kind": kind})
    assert wrong.value.remedy == 'Write kind = "epicyclic"'


@pytest.mark.parametrize("kind", ["worm", "bevel", "hypoid", "cycloidal", "rack", "ravigneaux"])
def test_gears_that_are_not_here_have_words_of_their_own(kind):
    with pytest.raises(SceneError, match="not supported"):
        gearopt.solve({"gearopt": 1, "kind": kind})


@pytest.mark.parametrize("key", ["sun_teeth", "ring_teeth", "carrier", "planets"])
def test_keys_of_planetary_stages_in_a_drive_lead_here(key):
    with pytest.raises(SceneError) as wrong:
        gearopt.solve({"gearopt": 1, "kind": "drive", "duty": {key: 3}})
    assert any('kind = "epicyclic"' in error.remedy for error in wrong.value.errors)

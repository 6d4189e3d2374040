"""Files that ask for the relief of a pair: what is found, what is refused, what stands beside."""

import copy
import tomllib
from pathlib import Path

import numpy as np
import pytest

import gearopt
from gearopt.errors import SceneError, SolveError

PROBLEMS = Path(__file__).parents[3] / "problems"
FILE = tomllib.loads((PROBLEMS / "relief_two_loads.toml").read_text(encoding="utf-8"))


def with_relief(**keys):
    found = copy.deepcopy(FILE)
    found["relief"] = found["relief"] | keys
    return found


COARSE = with_relief(loads=[1]) | {"sharing": FILE["sharing"] | {"positions": 24}}  # quicker


def test_the_relief_is_proven_and_beats_what_was_published(solved):
    """1.2373 um by a local method from three starts, on 48 positions; loads 0.6 and 1."""
    result = solved("relief_two_loads")
    assert result.status == "optimal" and result.objective["name"] == "peak_to_peak"
    assert result.objective["unit"] == "mm"
    assert 1e3 * result.value < 1.2373 and result.value - result.bound <= 1e-6 * result.value
    assert (
        "proven optimal (under profile + Sainsot, at 99 positions" in repr(result).splitlines()[0]
    )
    relief, contact = result.design["relief"], result.design["contact"]
    page = (PROBLEMS.parent / "docs" / "pair.md").read_text(encoding="utf-8")
    assert f"{1e3 * relief['judged']['value']:.3f} µm of these flanks" in page
    worst = max(load["peak_to_peak_mm"] for load in relief["at"] if load["load"] <= 1.0)
    assert worst == pytest.approx(result.value, rel=1e-12)
    assert [load["load"] for load in relief["at"]] == [0.6, 1.0, 1.25]  # the last is shown only
    assert relief["rows"][0]["value"] == pytest.approx(
        contact["loads"][1]["peak_to_peak_mm"], rel=1e-12
    )


def test_the_profile_is_what_its_amounts_and_lengths_say(solved):
    """a (1 - x/l) at x from the tips, on the grid of the path of contact."""
    design = solved("relief_two_loads").design
    relief, contact = design["relief"], design["contact"]
    s = contact["position_mm"]
    for k, (name, tip) in enumerate((("pinion", s[-1]), ("wheel", s[0]))):
        flank = relief[name]
        removed = [
            flank["amount_mm"] * max(1.0 - abs(tip - at) / flank["length_mm"], 0.0) for at in s
        ]
        assert relief[f"{name}_removed_mm"] == pytest.approx(removed, abs=1e-15), k
        assert flank["start_diameter_mm"] < flank["tip_diameter_mm"]
    assert relief["pinion"]["tip_diameter_mm"] == pytest.approx(81.0, rel=1e-12)
    assert relief["wheel"]["tip_diameter_mm"] == pytest.approx(156.0, rel=1e-12)


def test_rules_stand_beside_it(solved):
    """Amounts by the paper's rule and the corrected one, computed apart from gearopt [um]."""
    rows = {row["name"]: row for row in solved("relief_two_loads").design["relief"]["rows"]}
    assert list(rows) == ["none", "paper's rule", "corrected", "corrected, linear", "this"]
    paper, right = rows["paper's rule"], rows["corrected, linear"]
    amounts = [1e3 * row[f"{m}_amount_mm"] for row in (paper, right) for m in ("pinion", "wheel")]
    assert amounts == pytest.approx([15.790, 15.622, 11.341, 11.173], abs=2e-3)
    assert 1e3 * right["peak_to_peak_mm"][1] == pytest.approx(0.888, abs=2e-3)
    assert all(right["load_jump"][k] == pytest.approx(0.0, abs=1e-12) for k in (0, 1))
    assert all(row["value"] >= rows["this"]["value"] for row in rows.values())


def test_a_relief_that_is_given_is_evaluated():
    result = gearopt.solve(with_relief(amount="11.34 um", length=0.683162, loads=[1]))
    assert result.status == "evaluated" and not result.parts
    assert 1e3 * result.value == pytest.approx(0.888, abs=0.06)
    assert result.design["relief"]["pinion"]["amount_mm"] == pytest.approx(0.01134)


UNNAMED = {k: v for k, v in COARSE.items() if k != "sharing"} | {"sharing": {"positions": 24}}


def test_without_finite_elements_it_is_said_how_to_install_them(monkeypatch):
    monkeypatch.setattr("gearopt.physics.tooth.validity.find_spec", lambda name: None)
    result = gearopt.solve(UNNAMED)
    relief = result.design["relief"]
    assert result.status == "optimal" and "judged" not in relief
    assert (relief["level"], relief["coupling"]) == (
        "profile + Sainsot + linear Hertz",
        "ring torsion",
    )
    assert relief["in_mesh"] == result.design["contact"]["in_mesh"]
    assert "pip install 'gearopt[fem]'" in relief["unjudged"]
    assert "not judged by finite elements" in " ".join(str(result).split())


@pytest.mark.slow
def test_a_relief_is_judged_by_finite_elements_and_chosen_by_them():
    """um, measured by a user: by the usual model, the same flanks judged, the least of all."""
    tables = {k: v for k, v in FILE.items() if k != "sharing"}
    tables["duty"] = {"power": "20 kW", "input_speed": "955 rpm"}
    named = gearopt.solve(tables | {"sharing": {"level": "profile + Sainsot"}})
    relief, best = named.design["relief"], gearopt.solve(tables)
    found = named.value, relief["judged"]["value"], best.value
    assert [1e3 * value for value in found] == pytest.approx((1.442, 2.316, 1.127), abs=6e-4)
    assert named.proof["scope"].startswith("under profile + Sainsot, at")
    assert best.proof["scope"].startswith("under finite elements, at")
    assert (
        "judged" not in best.design["relief"]
        and best.design["relief"]["level"] == "finite elements"
    )
    said = " ".join(str(named).split())
    assert "1.442 µm" in said and "the same flanks by finite elements: 2.316 µm" in said
    low, _, high = (100.0 * value for value in relief["in_mesh"]["penalty"])
    assert f"{low:.0f} to {high:.0f} % above their least" in " ".join(named.to_html().split())


@pytest.mark.slow
def test_any_convex_shape_reaches_less_and_is_proven_too(solved):
    """Published for such shapes, symmetric in contact: 1.0615 um on 48 positions."""
    tables = with_relief(shape="free") | {"sharing": FILE["sharing"] | {"positions": 24}}
    free = gearopt.solve(tables)
    assert free.status == "optimal" and free.value < solved("relief_two_loads").value
    assert 1e3 * free.value == pytest.approx(1.0615, abs=0.02)
    relief, contact = free.design["relief"], free.design["contact"]
    assert "exponent" not in relief["pinion"]  # of a shape of its own
    total = np.add(relief["pinion_removed_mm"], relief["wheel_removed_mm"])
    middle = int(np.argmin(total))
    assert (np.diff(total[middle:]) >= -1e-9).all() and (np.diff(total[:middle]) <= 1e-9).all()
    assert relief["pinion"]["amount_mm"] == pytest.approx(total[-1])
    assert relief["wheel"]["amount_mm"] == pytest.approx(total[0])
    assert min(relief["pinion_removed_mm"]) == 0.0 and contact["contact_ratio"] < 2.0


def test_a_relief_longer_than_the_path_of_contact_is_refused():
    with pytest.raises(
        SolveError, match=r"length goes up to 5 base pitches, but .* has 1\.683\. W"
    ):
        gearopt.solve(with_relief(amount="10 um", length=5))


def test_a_stopped_search_claims_no_more_than_its_bound():
    result = gearopt.solve(with_relief(), budget=gearopt.Budget(0.0))
    assert result.status == "limit" or result.status == "feasible"
    assert "was searched" not in result.proof.get("sentence", "")


@pytest.mark.slow
def test_gears_that_are_not_safe_are_a_part_with_their_limits():
    """A rating that falls short is no limit of the relief, and no optimum is called infeasible."""
    rating = {"standard": "agma", "life": "20000 h", "quality": 8}
    steel = {"treatment": "through-hardened", "hardness": "200 HB"}
    for keys, status in (
        ({"loads": [1]}, "optimal"),
        ({"amount": "11 um", "length": 0.6}, "evaluated"),
    ):
        result = gearopt.solve(with_relief(**keys) | {"rating": rating, "gears": steel})
        (gears,) = result.parts
        assert result.status == status and result.feasible and not result.limits
        assert (
            gears.status == "evaluated" and not gears.feasible and max(gears.limits.values()) > 1.5
        )
        assert "Not safe by its rating" in str(result) and "limits met" not in str(result)
        html = result.to_html()
        assert "Grind" in html and "fall short" in html


@pytest.mark.slow
def test_ranges_of_the_file_hold():
    found = gearopt.solve(with_relief(amount=["0 um", "8 um"], length=[0.3, 0.4], loads=[1]))
    free = gearopt.solve(with_relief(loads=[1]))
    for name in ("pinion", "wheel"):
        flank = found.design["relief"][name]
        assert flank["amount_mm"] <= 8e-3 * (1 + 1e-9)
        assert 0.3 <= flank["length_mm"] / 8.856394302 <= 0.4 + 1e-9
    assert found.status == free.status == "optimal" and found.value > free.value
    notes = found.report["notes"][-2:]  # the best of all is deeper and longer
    assert [note.split(" is ")[1].split(" the range")[0] for note in notes] == 2 * [
        "as deep and as long as"
    ]
    assert not free.report.get("notes")


@pytest.mark.slow
def test_other_criteria_have_no_proven_search_and_say_so():
    result = gearopt.solve(with_relief(minimise="load_jump"), budget=gearopt.Budget(0.3))
    assert result.status in ("feasible", "limit") and result.bound is None
    assert result.objective["unit"] == "" and result.value < 0.3
    assert "of shares of the load there is no bound" in result.message


def test_a_criterion_without_derivatives_has_no_sensitivities_but_keeps_its_answer():
    file = COARSE | {"relief": COARSE["relief"] | {"minimise": "peak_load"}}
    explained = gearopt.explain(file, budget=gearopt.Budget(0.3))
    assert 0.0 < explained.result.value <= 1.0 and not explained.influences
    assert "not proven optimal" in explained.message


@pytest.mark.slow
def test_duty_in_relieved_gears_out(solved):
    """The paper's program from one file: the gears are those of the file without [relief]."""
    result = solved("paper_program")
    (gears,) = result.parts
    assert gears.name == "gears" and gears.status == "optimal"
    alone = tomllib.loads((PROBLEMS / "paper_program.toml").read_text(encoding="utf-8"))
    sized = gearopt.solve({k: v for k, v in alone.items() if k not in ("relief", "x-expected")})
    assert sized.value == gears.value and sized.design["stages"] == result.design["stages"]
    assert result.design["rating"]["safe"] and max(result.limits.values()) <= 1.0 + 1e-9
    assert [load["load"] for load in result.design["relief"]["at"]] == [0.5, 1.0, 1.25]
    before = result.design["contact"]["loads"]
    assert result.value < 0.3 * before[1]["peak_to_peak_mm"]


@pytest.mark.slow
def test_gears_that_cannot_be_sized_have_no_relief():
    tables = tomllib.loads((PROBLEMS / "paper_program.toml").read_text(encoding="utf-8"))
    tables["limits"] = {"pinion_teeth": [18, 60], "wheel_diameter": "90 mm"}
    result = gearopt.solve(tables)
    assert result.status == "infeasible" and not result.design


@pytest.mark.slow
def test_the_worst_case_within_tolerances_is_proven_and_drawn_ones_stay_below():
    """The largest of corners and of a grid inside, by shares computed for each; +-2 um."""
    tables = with_relief(amount="11 um", length=0.68, tolerance="2 um", loads=[1])
    made = gearopt.solve(tables).design["relief"]["made"]
    found = [
        gearopt.solve(with_relief(amount=f"{a} um", length=0.68, loads=[1])).value
        for a in (9, 10, 11, 12, 13)  # both gears alike: part of the box
    ]
    assert max(found) <= made["bound_mm"] * (1 + 1e-9)
    assert made["median_mm"] < made["most_mm"] < made["worst_mm"] <= made["bound_mm"]
    assert made["bound_mm"] <= 1.0011 * made["worst_mm"]
    assert all(abs(a - 0.011) <= 0.002 * (1 + 1e-9) for a in made["worst_amounts_mm"])


@pytest.mark.slow
def test_a_robust_relief_has_a_smaller_worst_case():
    plain, robust = (
        gearopt.solve(
            with_relief(tolerance="2 um", robust=robust), budget=gearopt.Budget(evaluations=5_000)
        )
        for robust in (False, True)
    )
    worst = [one.design["relief"]["made"]["worst_mm"] for one in (plain, robust)]
    assert worst[1] < 0.95 * worst[0] and robust.objective["name"] == "worst_peak_to_peak"
    assert robust.value >= plain.bound and "annealed" in robust.message


WRONG = [
    ({"amount": 10}, r"amount = 10: .* needs a unit"),
    ({"amount": ["30 um", "0 um"]}, r"amount = .*ends in the wrong order"),
    ({"amount": "2 mm"}, r'amount = "2 mm": is above 1 mm'),
    ({"length": "4 mm"}, r'length = "4 mm": is not a number'),
    (
        {"shape": "cubic"},
        r'shape = "cubic": is neither one of "linear", "parabolic", "free"',
    ),
    ({"shape": 0.5}, r"shape = 0\.5: is not between 1 and 10"),
    ({"shape": "free", "minimise": "load_jump"}, r'load_jump": is no criterion of a free shape'),
    ({"shape": "free", "length": 0.5}, r"length = 0\.5: changes nothing: a free shape"),
    ({"robust": True}, r"robust = true: needs tolerance"),
    ({"tolerance": "2 um", "shape": "free"}, r"tolerance = .*: is for the peak_to_peak of"),
    ({"tolerance": "2 um", "minimise": "load_jump"}, r"tolerance = .*: is for the peak_to_peak"),
    ({"tolerance": 2}, r"tolerance = 2: is a bare number"),
    ({"loads": [0]}, r"loads = \[0\]: is no load at all"),
    ({"minimise": "noise"}, r'minimise = "noise": is not one of "peak_to_peak", "harmonics"'),
    ({"ammount": "3 um"}, r"relief\.ammount: unknown key\. Did you mean amount"),
]


@pytest.mark.parametrize(("keys", "said"), WRONG, ids=[str(k) for k, _ in WRONG])
def test_what_is_wrong_is_said_in_one_line(keys, said):
    with pytest.raises(SceneError, match=said) as wrong:
        gearopt.load(with_relief(**keys))
    assert "\n" not in str(wrong.value)


@pytest.mark.slow
def test_fronts_trade_one_load_against_another():
    """The front passes the proven optimum: no design is better at both loads than it."""
    names = ("peak_to_peak_at_60", "peak_to_peak_at_100")
    front = gearopt.pareto(
        FILE, objectives=names, method="nsga2", budget=gearopt.Budget(evaluations=2000)
    )
    values = [[point.values[k] for k in (0, 1)] for point in front.points]
    assert front.method == "nsga2" and len(values) > 20
    assert min(max(pair) for pair in values) >= 0.0012030138 * (1 - 1e-9)
    assert values[0][0] < 0.8e-3 and values[-1][1] < 1e-3


@pytest.mark.slow
def test_points_of_a_front_are_proven():
    """Its ends are the least of each load alone; 24 positions, which is quicker."""
    tables = FILE | {"sharing": FILE["sharing"] | {"positions": 24}}
    names = ("peak_to_peak_at_60", "peak_to_peak_at_100")
    front = gearopt.pareto(tables, objectives=names, points=2)
    assert front.method == "epsilon" and all(point.proven for point in front.points)
    for k, load in enumerate((0.6, 1)):
        alone = gearopt.solve(tables | {"relief": FILE["relief"] | {"loads": [load]}})
        least = min(point.values[k] for point in front.points)
        assert least == pytest.approx(alone.value, rel=1e-5)


def test_criteria_have_names_at_every_load():
    known = "peak_to_peak, harmonics, load_jump, peak_load, peak_to_peak_at_60, peak_to_peak_at_100"
    with pytest.raises(SolveError, match=f"no objective 'noise'; objectives: {known}"):
        gearopt.pareto(FILE, objectives=("peak_to_peak", "noise"))


@pytest.mark.slow
def test_methods_are_compared_against_the_proven_relief():
    found = gearopt.compare(COARSE, seeds=1, evaluations=1000, seconds=0.3)
    rows = {row.method: row for row in found.groups[0].rows}
    assert list(rows) == ["exact", "mpec", "annealing", "nsga2"]
    assert found.groups[0].best == pytest.approx(gearopt.solve(COARSE).value, rel=1e-6)


@pytest.mark.slow
def test_sensitivities_are_those_of_solving_again():
    found = gearopt.explain(COARSE)
    slopes = {
        one.key: sum(one.resolved) / 2 for one in found.influences if None not in one.resolved
    }
    ends = [gearopt.solve(COARSE, {"stage[1].face_width": f"{30 * f} mm"}) for f in (0.999, 1.001)]
    again = (ends[1].value - ends[0].value) / (0.002 * found.result.value)
    assert slopes["stage[1].face_width"] == pytest.approx(again, rel=0.02)
    assert slopes["duty.power"] == pytest.approx(-slopes["duty.input_speed"], rel=1e-3)

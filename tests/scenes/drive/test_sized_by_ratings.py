"""Drives whose limits are the safety factors of their rating."""

import copy
import tomllib
from pathlib import Path
from types import SimpleNamespace

import pytest
from campaigns import few

import gearopt
from gearopt.errors import SceneError, SolveError
from gearopt.optimise.result import Budget
from gearopt.scenes.drive import sizing
from gearopt.scenes.reading.load import examples

PROBLEMS = Path(__file__).parents[3] / "problems"
DRIVE = {
    "gearopt": 1,
    "kind": "drive",
    "duty": {"power": "7.5 kW", "input_speed": "1450 rpm", "ratio": 4},
    "gears": {"treatment": "carburised"},
    "stage": [{"face_width_over_diameter": 0.6}],
    "limits": {"pinion_teeth": [20, 24]},
    "teeth": {},
    "rating": {"life": "20000 h", "quality": 8},
}


HARD = {"name": "hard", "treatment": "carburised", "grade": 2, "price": 9}
TOUGH = {"name": "tough", "treatment": "through-hardened", "hardness": "300 HB", "price": 4}
STEELS = {"hard": HARD, "tough": TOUGH}
WITH_HARD = {
    "face_width_over_diameter": 0.6,
    "pinion": {"materials": ["hard"]},
    "wheel": {"materials": ["hard"]},
}


def drive(**tables):
    """The tables of a small drive with keys of its tables changed; None takes a table away."""
    made = copy.deepcopy(DRIVE)
    for name, more in tables.items():
        if more is None:
            del made[name]
        elif isinstance(more, dict):
            made[name] = made.get(name, {}) | more
        else:
            made[name] = more
    return made


@pytest.fixture(scope="module")
def small():
    return gearopt.solve(drive())


def safeties(result):
    """The least S_F and S_H of a result that is rated."""
    gears = result.design["rating"]["gears"]
    return min(g["bending_safety"] for g in gears), min(g["contact_safety"] for g in gears)


def test_the_answer_is_rated_by_the_exact_form_as_its_limits_say(small):
    result, rating = small, small.design["rating"]
    assert rating["safe"] and result.status == "optimal"
    for gear in rating["gears"]:
        for mode in ("bending", "contact"):
            used = result.limits[f"{gear['member']}_{mode}[{gear['stage']}]"]
            assert used == pytest.approx(1.0 / gear[f"{mode}_safety"], rel=1e-9)


@pytest.mark.parametrize(
    "rating",
    few(
        [{"minimum_contact_safety": 1.2}, {"minimum_bending_safety": 3}, {"overload_factor": 1.5}],
        1,
    ),
    ids=str,
)
def test_more_safety_takes_more_volume(small, rating):
    large = gearopt.solve(drive(rating=rating))
    assert large.value > small.value
    asked = rating.get("minimum_bending_safety", 1), rating.get("minimum_contact_safety", 1)
    assert all(s >= a - 1e-8 for s, a in zip(safeties(large), asked, strict=True))


def test_given_gears_that_are_rated_and_sized_are_the_same(small):
    stage = small.design["stages"][0]
    given = {
        "module": f"{stage['normal_module_mm']} mm",
        "pinion_teeth": stage["pinion_teeth"],
        "wheel_teeth": stage["wheel_teeth"],
        "face_width": f"{stage['face_width_mm']!r} mm",
    }
    rated = gearopt.rate(drive(stage=[given], limits=None))
    assert safeties(rated) == pytest.approx(safeties(small), rel=1e-9)


LOADS = {"preset": "chong-lee-elevator"}


@pytest.mark.parametrize("factor", few([2, 1], 1))
def test_load_limits_beside_a_rating_are_limits_too(factor):
    """The least of both is never below the least of either; the one that binds gives it."""
    rating = {"minimum_contact_safety": factor}
    both = gearopt.solve(drive(limits=LOADS, rating=rating))
    loads = gearopt.solve(drive(limits=LOADS, rating=None, gears=None))
    rated = gearopt.solve(drive(rating=rating))
    assert both.value >= max(loads.value, rated.value) * (1.0 - 1e-12)
    binding = loads if factor == 1 else rated
    assert both.value == pytest.approx(binding.value, rel=1e-12)


@pytest.mark.slow
def test_real_valued_teeth_are_below_whole_ones_and_above_their_bound():
    whole = gearopt.solve(drive())
    real = gearopt.solve(drive(teeth=None, limits={"module": ["1 mm", "10 mm"]}))
    assert real.method == "smooth" and real.design["rating"]["safe"]
    assert real.bound <= real.value <= whole.value * (1.0 + 1e-9)


@pytest.mark.parametrize("standard", ["agma", pytest.param("both", marks=pytest.mark.slow)])
def test_a_spectrum_is_what_gears_carry(standard):
    """Half of the life at half the power takes no more than all of it at full power."""
    rating = {"standard": standard}
    rating |= {"iso6336": {"accuracy_grade": 6}} if standard == "both" else {}
    levels = [{"power": "7.5 kW", "share": 0.5}, {"power": "3.75 kW", "share": 0.5}]
    stage = [{"face_width_over_diameter": [0.2, 1]}]
    light, heavy = (
        gearopt.solve(drive(rating=rating, load=load, stage=stage)) for load in (levels, [])
    )
    assert light.value < heavy.value
    assert light.design["rating"]["safe"] and light.design["rating"]["levels"]
    for gear in light.design["rating"]["gears"]:
        used = light.limits[f"{gear['member']}_contact[1]"]
        assert used == pytest.approx(1.0 / gear["contact_safety"], rel=1e-8)


@pytest.mark.parametrize("standard", few(["iso6336", "both"], 1))
def test_every_standard_asked_for_is_met(standard):
    tables = drive(rating={"standard": standard, "iso6336": {"accuracy_grade": 6}})
    if standard == "iso6336":
        del tables["rating"]["quality"]
    result = gearopt.solve(tables)
    rating = result.design["rating"]
    assert result.status == "optimal" and rating["safe"]
    assert standard == "iso6336" or rating["beside"]["safe"]


@pytest.mark.slow
def test_widths_keep_to_their_limits():
    ends = {"face_width_over_diameter": [0.2, 1], "face_width_over_module": [9, 14]}
    free, held, least = (
        gearopt.solve(drive(stage=[{"face_width_over_diameter": [0.2, 1]} | more]))
        for more in ({}, ends, {"minimum_face_width": "60 mm"})
    )
    stage = held.design["stages"][0]
    assert 9 <= stage["face_width_mm"] / stage["normal_module_mm"] <= 14 + 1e-9
    assert least.design["stages"][0]["face_width_mm"] >= 60 - 1e-9
    assert free.value <= min(held.value, least.value)


@pytest.mark.slow
def test_explain_says_what_steel_and_life_bring():
    found = gearopt.explain(drive())
    brings = {one.key: one.price for one in found.influences}
    assert brings["rating.life"] <= 0.0 and brings["rating.quality"] <= 0.0
    assert "limits.pinion_teeth[2]" in brings


@pytest.mark.slow
def test_an_impossible_drive_is_proven_so_and_every_remedy_works():
    tables = drive(limits={"wheel_diameter": "100 mm", "pinion_teeth": [20, 22]})
    found = gearopt.explain(tables)
    assert found.result.status == "infeasible"
    remedies = {r.what: r for r in found.remedies}
    assert "limits.wheel_diameter" in remedies
    assert all(r.factor is None or r.factor <= 3.0 for r in remedies.values())  # as others help
    for remedy in remedies.values():
        assert gearopt.solve(tables, remedy.edits).value is not None


REFUSED = {  # the mistake: tables, key, what is said
    "no limits at all": ({"rating": None, "gears": None}, "limits.preset", "a table [rating]"),
    "a load limit of a stage alone": (
        {"stage": [{"face_width_over_diameter": 0.6, "k_factor": "2 MPa"}]},
        "stage[1].k_factor",
        "ratings alone limit the gears",
    ),
    "half of the load limits": (
        {"limits": {"k_factor": "2 MPa"}},
        "limits.unit_load",
        "is missing (or give preset)",
    ),
    "process": ({"process_one": {"stage_ratios": [4]}}, "process_one", "is a process by"),
    "no steel": ({"gears": None}, "gears.treatment", "needs the steel"),
    "misspelt safety": (
        {"rating": {"minimum_bending_safty": 2}},
        "rating.minimum_bending_safty",
        "Did you mean minimum_bending_safety",
    ),
}


@pytest.mark.parametrize("name", REFUSED)
def test_mistakes_are_one_message(name):
    tables, key, told = REFUSED[name]
    made = drive(**tables)
    with pytest.raises(SceneError) as refused:
        gearopt.load(made)
    assert refused.value.key == key and told in str(refused.value)
    assert len(refused.value.errors) == 1


@pytest.mark.parametrize(
    ("tables", "told"),
    [
        ({"load": [{"power": "5 kW", "share": 1}]}, "load spectra"),
        ({"gears": None, "material": [HARD], "stage": [WITH_HARD]}, "materials to choose from"),
    ],
    ids=["spectrum", "materials"],
)
def test_what_limits_no_real_valued_teeth_is_named(tables, told):
    with pytest.raises(SolveError, match=told):
        gearopt.solve(drive(teeth=None, **tables))


def test_load_limits_alone_size_real_valued_teeth_that_ratings_cannot():
    """The rating then only tells whether the gears are safe."""
    more, load = {"minimum_contact_safety": 9}, [{"power": "7.5 kW", "share": 1}]
    both = gearopt.solve(drive(limits=LOADS, rating=more, load=load, teeth=None))
    alone = gearopt.solve(drive(limits=LOADS, rating=None, gears=None, teeth=None))
    assert both.value == alone.value and not both.design["rating"]["safe"]
    assert "optimal (sized by load limits alone, rated afterwards)" in repr(both).splitlines()[0]


@pytest.mark.slow
def test_the_best_number_of_stages_is_that_of_each():
    of_all = {"face_width_over_diameter": 0.6}
    tables = drive(stage=[], gears=of_all, duty={"ratio": 8}) | {"stages": [1, 2]}
    del tables["stage"]
    found = gearopt.solve(tables)
    alone = [gearopt.solve(tables | {"stages": n}).value for n in (1, 2)]
    assert found.status == "optimal" and found.value == pytest.approx(min(alone), rel=1e-12)


@pytest.mark.slow
def test_the_file_to_start_from_has_a_safe_answer():
    result = gearopt.solve(tomllib.loads(examples()["sizing"]))
    assert result.status == "optimal" and result.design["rating"]["safe"]


def of_materials(pinion, wheel, minimise="cost", materials=(HARD, TOUGH)):
    """The tables of the small drive whose gears choose of materials."""
    made = drive(
        gears=None,
        objective={"minimise": minimise, "density": "7.85 kg/dm^3"},
        rating={"minimum_bending_safety": 1.4},
    )
    made["stage"][0] |= {"pinion": {"materials": pinion}, "wheel": {"materials": wheel}}
    return made | {"material": [dict(one) for one in materials]}


@pytest.mark.slow
@pytest.mark.parametrize("minimise", ["cost", "mass", "gear_volume"])
def test_the_best_of_lists_is_that_of_every_pair_of_materials(minimise):
    both = gearopt.solve(of_materials([*STEELS], [*STEELS], minimise))
    alone = {
        (a, b): gearopt.solve(of_materials([a], [b], minimise)).value
        for a in STEELS
        for b in STEELS
    }
    best = min(alone, key=alone.get)
    stage = both.design["stages"][0]
    assert both.value == pytest.approx(alone[best], rel=1e-12)
    assert (stage["pinion_material"], stage["wheel_material"]) == best
    prices = STEELS[best[0]]["price"], STEELS[best[1]]["price"]
    cost = stage["pinion_mass_kg"] * prices[0] + stage["wheel_mass_kg"] * prices[1]
    assert minimise != "cost" or both.value == pytest.approx(cost, rel=1e-12)
    assert minimise != "mass" or both.value == pytest.approx(both.design["mass_kg"], rel=1e-12)
    assert both.design["rating"]["safe"]


@pytest.mark.slow
@pytest.mark.parametrize("minimise", ["cost", "gear_volume"])
def test_a_grade_is_chosen_by_what_it_costs(minimise):
    """Finer gears are smaller, and dearer; each grade alone is solved beside."""
    grades = {q: HARD | {"name": f"Q{q}", "quality": q, "price": 5 + 0.4 * q} for q in (7, 9, 11)}
    names, tables = [one["name"] for one in grades.values()], tuple(grades.values())
    found = gearopt.solve(of_materials(names, names, minimise, tables))
    alone = {a: gearopt.solve(of_materials([a], [a], minimise, tables)).value for a in names}
    assert found.value <= min(alone.values()) * (1.0 + 1e-12)
    assert minimise == "cost" or found.value == pytest.approx(alone["Q11"], rel=1e-12)
    for name, quality in zip(names, grades, strict=True):
        plain = of_materials(["hard"], ["hard"], "gear_volume")
        plain["rating"]["quality"] = quality
        own = of_materials([name], [name], "gear_volume", tables)
        assert gearopt.solve(plain).value == pytest.approx(gearopt.solve(own).value, rel=1e-12)


def test_a_material_weighs_as_its_density_says():
    light = TOUGH | {"name": "light", "density": "4 kg/dm^3"}
    tables = of_materials(["light"], ["tough"], "mass", (light, TOUGH))
    stage = gearopt.solve(tables).design["stages"][0]
    squares = stage["pinion_diameter_mm"] ** 2 / stage["wheel_diameter_mm"] ** 2
    ratio = stage["pinion_mass_kg"] / stage["wheel_mass_kg"]
    assert ratio == pytest.approx(squares * 4 / 7.85, rel=1e-9)


WRONG = {
    "unknown": ({}, ["soft"], "stage[1].pinion.materials", "the name of no [[material]]"),
    "no price": ({"price": None}, ["hard"], "material[1].price", "cost needs it"),
    "no steel": ({"treatment": None}, ["hard"], "material[1].treatment", "steel"),
    "name twice": (
        {"name": "tough"},
        ["tough"],
        "material[2].name",
        "that of material[1], too. Rename",
    ),
    "misspelt": ({"densty": "7 kg/dm^3"}, ["hard"], "material[1].densty", "Did you mean density"),
}


@pytest.mark.parametrize("name", WRONG)
def test_mistakes_in_materials_are_one_message(name):
    more, pinion, key, told = WRONG[name]
    hard = {k: v for k, v in (HARD | more).items() if v is not None}
    with pytest.raises(SceneError) as refused:
        gearopt.load(of_materials(pinion, ["tough"], materials=(hard, TOUGH)))
    assert refused.value.key == key and told in str(refused.value)


def test_a_material_in_no_list_is_told():
    note = "[[material]] in no list of a gear: tough."
    assert note in gearopt.solve(of_materials(["hard"], ["hard"])).report["notes"]
    both = gearopt.solve(of_materials(["hard"], ["tough"]))
    assert not any("[[material]]" in line for line in both.report["notes"])


def test_gears_that_may_choose_are_not_rated():
    tables = of_materials([*STEELS], ["tough"])
    for name in ("limits", "objective", "teeth"):
        del tables[name]
    del tables["duty"]["ratio"]
    given = {"module": "2 mm", "pinion_teeth": 20, "wheel_teeth": 80, "face_width": "30 mm"}
    tables["stage"][0] = given | {k: tables["stage"][0][k] for k in ("pinion", "wheel")}
    with pytest.raises(SolveError, match="no material yet, one of hard, tough"):
        gearopt.rate(tables)


@pytest.mark.slow
def test_gears_and_box_at_once_are_rated_and_no_larger_than_one_after_the_other():
    tables = of_materials([*STEELS], ["tough"], "gear_volume")
    tables["layout"] = {"together": True, "shaft_diameters": ["20 mm", "30 mm"]}
    found = gearopt.solve(tables)
    assert found.status == "optimal" and found.design["rating"]["safe"]
    (apart,) = (part for part in found.parts if part.name == "apart")
    assert found.value <= apart.value * (1.0 + 1e-9)
    assert found.design["stages"][0]["wheel_material"] == "tough"
    assert found.design["stages"][0]["pinion_material"] in STEELS
    with pytest.raises(SolveError, match="ipopt takes no gears and box at once"):
        gearopt.solve(tables, method="ipopt")


def test_methods_that_trace_ratings_say_that_they_cannot():
    with pytest.raises(SolveError, match="annealing and nsga2 only: a rating finds roots"):
        gearopt.solve(drive(), method="scip")
    with pytest.raises(SolveError, match="smooth does"):
        gearopt.solve(drive(), method="ipopt")


@pytest.mark.slow
def test_a_range_of_modules_is_widened_to_the_next_one_that_takes():
    """Every module below it is tried, and none takes; the answer is one of the series."""

    def file(module):
        return drive(limits={"pinion_teeth": [20, 21], "module": ["1 mm", module]})

    series = [f"{m} mm" for m in (1.25, 1.5, 2, 2.5, 3, 4, 5)]
    least = next(m for m in series if gearopt.solve(file(m)).value is not None)
    found = {r.what: r for r in gearopt.explain(file("1 mm")).remedies}["limits.module[2]"]
    assert [c.write for c in found.changes] == [f'"{least}"']


@pytest.mark.slow
def test_a_minimum_face_width_is_eased():
    stage = [{"face_width_over_diameter": [0.3, 1], "minimum_face_width": "900 mm"}]
    tables = drive(stage=stage, limits={"pinion_teeth": [20, 21], "module": ["1 mm", "4 mm"]})
    found = {r.what: r for r in gearopt.explain(tables).remedies}
    remedy = found["stage[1].minimum_face_width"]
    assert gearopt.solve(tables, remedy.edits).value is not None


@pytest.mark.slow
def test_a_search_that_is_cut_short_has_the_bound_of_real_valued_sizes(monkeypatch):
    """No whole teeth in no time: the bound is at least that of real-valued sizes, a part of it."""
    monkeypatch.setattr(sizing, "BOUND_SHARE", 0.999)
    monkeypatch.setattr(sizing, "Clock", lambda budget: SimpleNamespace(over=False))
    found = gearopt.solve(PROBLEMS / "elevator_by_both.toml", budget=Budget(0.4))
    (real,) = found.parts
    assert found.status == "limit" and real.name == "sizing"
    assert 0.0 < real.bound <= found.bound < 67020184.0


def test_costs_are_split_into_material_treatment_and_cutting():
    """Of every gear by hand; together they are the objective."""
    prices = ("price", "treatment_price", "cutting_price")
    tables = [{"name": "hard", "price": 3, "treatment_price": 2.5, "cutting_price": 6}]
    tables = [STEELS["hard"] | tables[0]]
    found = gearopt.solve(of_materials(["hard"], ["hard"], "cost", tables))
    (stage,), costs = found.design["stages"], found.design["costs"]
    for member, cost in zip(("pinion", "wheel"), costs, strict=True):
        mass, metres = (
            stage[f"{member}_mass_kg"],
            stage[f"{member}_teeth"] * stage["face_width_mm"] / 1e3,
        )
        by_hand = [u * tables[0][p] for u, p in zip((mass, mass, metres), prices, strict=True)]
        split = [cost[name] for name in ("material", "treatment", "cutting")]
        assert cost["gear"] == f"{member} 1" and cost["total"] == pytest.approx(sum(by_hand))
        assert split == pytest.approx(by_hand, rel=1e-12)
    assert found.value == pytest.approx(sum(cost["total"] for cost in costs), rel=1e-12)
    assert "costs" not in gearopt.solve(of_materials(["hard"], ["hard"], "mass", tables)).design

"""REXS files written: grammar, units, and the same drive when they are read again."""

import math
import random
import tomllib
import xml.etree.ElementTree as ET
from pathlib import Path

import pytest
from campaigns import few
from rexs_files import planetary, unit, xml

import gearopt
from gearopt.physics import steels

PROBLEMS = Path(__file__).parents[3] / "problems"
NEEDED = {"rating.life": "20000 h", "rating.iso6336.accuracy_grade": 6}


def read(data, folder):
    """The tables of the problem file that a REXS file is read as."""
    path = folder / "unit.rexs"
    path.write_bytes(data)
    return tomllib.loads(gearopt.read_rexs(path))


def leaves(value, path=()):
    """Places and values of tables."""
    if isinstance(value, dict | list):
        for key, inner in value.items() if isinstance(value, dict) else enumerate(value):
            yield from leaves(inner, (*path, key))
    else:
        yield path, value


def check_equal(tables, others):
    """Numbers are equal to 1e-12 of them, all else as it is."""
    first, second = (dict(leaves(each)) for each in (tables, others))
    assert first.keys() == second.keys()
    for place, value in first.items():
        number, _, words = str(value).partition(" ")
        other, _, same = str(second[place]).partition(" ")
        if value != second[place]:
            assert words == same and math.isclose(float(number), float(other), rel_tol=1e-12), place


def check_again(result, folder, again=gearopt.rate):
    """A result is written, read, rated, written and read again: the same each time."""
    tables = read(result.to_rexs(), folder)
    other = again(tables)
    assert other.limits.keys() == result.limits.keys()
    for name, value in result.limits.items():
        assert other.limits[name] == pytest.approx(value, rel=1e-12), name
    twice = read(other.to_rexs(), folder)
    check_equal(tables | {"source": ""}, twice | {"source": ""})
    return tables


UNITS = {  # of attributes, as the documentation of REXS 2.0 lists them
    **dict.fromkeys(("normal_module", "face_width", "tip_diameter", "center_distance"), "mm"),
    **dict.fromkeys(("root_form_diameter", "span_measurement", "pitch_diameter"), "mm"),
    **dict.fromkeys(("helix_angle_reference_diameter", "normal_pressure_angle"), "deg"),
    **dict.fromkeys(("number_of_teeth", "addendum_modification_coefficient"), "none"),
    **dict.fromkeys(("safety_factor_pitting_iso_6336_2006", "gear_ratio"), "none"),
    **dict.fromkeys(("contact_stress_iso_6336_2006", "elastic_modulus"), "MPa"),
    "allowable_stress_number_contact_iso_6336_2016": "MPa",
    "nominal_stress_number_tooth_root_iso_6336_2016": "MPa",
    "upper_backlash_allowance_referenced_to_span": "mum",
    "arithmetic_mean_roughness_flank_iso_4287_1997": "mum",
    "viscosity_at_40_degree_celsius": "mm^2 / s",
    "operating_time": "h",
    "operating_time_fraction": "%",
    "rotational_speed": "1 / min",
    "torque_around_u_axis": "N m",
    "density": "kg / dm^3",
}
COMBINATIONS = {  # of components by role, which the schema of 2.0 allows
    "stage": {("cylindrical_stage", "cylindrical_gear", "cylindrical_gear")},
    "stage_gear_data": {("cylindrical_stage", "cylindrical_gear", "cylindrical_stage_gear_data")},
    "flank": {("cylindrical_gear", "cylindrical_gear_flank", "cylindrical_gear_flank")},
    "manufacturing_step": {
        (
            "cylindrical_gear_flank",
            "rack_shaped_tool",
            "cylindrical_gear_manufacturing_settings",
        )
    },
    "reference": {("cylindrical_gear", "material"), ("gear_casing", "lubricant")},
    "assembly": {
        *(("gear_unit", part) for part in ("gear_casing", "shaft", "cylindrical_stage")),
        *(("shaft", part) for part in ("cylindrical_gear", "external_load")),
    },
}


@pytest.fixture(scope="module")
def rated(tmp_path_factory):
    """The two-stage unit of `rexs_files`, rated."""
    return gearopt.rate(read(xml(unit()).encode(), tmp_path_factory.mktemp("unit")), NEEDED)


def test_grammar_units_and_roles(rated):
    """The rules of the grammar: ids are whole numbers, once each, and refer to what is there."""
    model = ET.fromstring(rated.to_rexs())
    assert (model.tag, model.get("version")) == ("model", "2.0.0")
    assert {"applicationId", "applicationVersion", "date"} <= set(model.keys())
    assert [group.tag for group in model] == ["relations", "components", "load_spectrum"]
    kinds = {int(c.get("id")): c.get("type") for c in model.find("components")}
    assert len(kinds) == len(model.find("components"))
    used = set()
    for relation in model.find("relations"):
        pattern = tuple(kinds[int(ref.get("id"))] for ref in relation)
        assert pattern in COMBINATIONS[relation.get("type")]
        used.add(relation.get("type"))
    assert used == set(COMBINATIONS)
    units = {a.get("id"): a.get("unit") for a in model.iter("attribute")}
    assert {name: units[name] for name in UNITS} == UNITS
    for case in model.iter("load_case"):
        assert {kinds[int(c.get("id"))] for c in case} == {"gear_unit", "shaft", "external_load"}


def test_numbers_of_the_rating_are_written(rated):
    model = ET.fromstring(rated.to_rexs())
    gears = rated.design["rating"]["gears"]
    for name, key in (
        ("safety_factor_pitting_iso_6336_2006", "contact_safety"),
        ("tooth_root_stress_iso_6336_2006", "bending_stress_MPa"),
    ):
        texts = [a.text for a in model.iter("attribute") if a.get("id") == name]
        assert [float(text) for text in texts] == [gear[key] for gear in gears]


def test_a_unit_is_read_written_and_read_again(rated, tmp_path):
    tables = check_again(rated, tmp_path)
    wanted = read(xml(unit()).encode(), tmp_path)
    for stage, asked in zip(tables["stage"], wanted["stage"], strict=True):
        for member in ("pinion", "wheel"):
            own = asked.pop(member)
            assert {k: stage[member][k] for k in own} == own
        assert {k: stage[k] for k in asked} == asked
    for table in ("duty", "load"):
        check_equal(tables[table], wanted[table])


def test_sharp_tools_and_their_protuberance_are_kept(tmp_path):
    """A radius of 0 is not the usual one; the protuberance is that before grinding."""
    given = tomllib.loads((PROBLEMS / "two_stages_rated.toml").read_text(encoding="utf-8"))
    sharp = {"tool_tip_radius": 0}
    ground = {"tool_protuberance": 0.02, "grinding_allowance": 0.01}
    changes = {
        f"stage[1].{member}.{key}": value
        for member, keys in (("pinion", sharp), ("wheel", ground))
        for key, value in keys.items()
    }
    stage = read(gearopt.rate(given, changes).to_rexs(), tmp_path)["stage"][0]
    assert stage["pinion"].items() >= sharp.items() and stage["wheel"].items() >= ground.items()


@pytest.mark.slow
def test_planets_are_read_written_and_read_again(tmp_path):
    given = read(xml(planetary()).encode(), tmp_path)
    needed = NEEDED | {f"stage[1].{m}.iso_material": "Eh" for m in ("sun", "planet", "ring")}
    tables = check_again(gearopt.rate(given, needed), tmp_path)
    assert tables["stage"][0]["planets"] == 3


@pytest.mark.slow
@pytest.mark.parametrize(
    "load", ({"torque": f"{400 * 78 / 17} N m"}, {"power": f"{math.pi * 400 / 30} kW"})
)
def test_planets_that_increase_the_speed_are_described_from_the_sun(load, tmp_path):
    """The carrier drives at 1000 17/78 rpm: what it transmits loads the teeth as before."""
    given = read(xml(planetary()).encode(), tmp_path)
    slow = load | {"ratio": "17/78", "input_speed": f"{1000 * 17 / 78} rpm"}
    needed = NEEDED | {f"stage[1].{m}.iso_material": "Eh" for m in ("sun", "planet", "ring")}
    result = gearopt.rate(given | {"duty": slow}, needed)
    tables = read(result.to_rexs(), tmp_path)
    for key, value in (("torque", 400.0), ("input_speed", 1000.0)):
        assert float(tables["duty"][key].split()[0]) == pytest.approx(value, rel=1e-12)
    again = gearopt.rate(tables)
    assert again.limits == pytest.approx(result.limits, rel=1e-12)


def drive_with(standard, **more):
    """Two gears of 16MnCr5, rated by a standard, or tables of one's own."""
    of_both = {"life": "20000 h", "standard": standard}
    agma = {} if standard == "iso6336" else {"quality": 8, "mounting": "commercial"}
    iso = {} if standard == "agma" else {"iso6336": {"accuracy_grade": [6, 7]}}
    pair = {"module": "3 mm", "pinion_teeth": 20, "wheel_teeth": 31, "face_width": "30 mm"}
    head = {"gearopt": 1, "kind": "drive", "gears": {"steel": "16MnCr5"}, "stage": [pair]}
    duty = {"power": "5 kW", "input_speed": "960 rpm"}
    return head | {"duty": duty, "rating": of_both | agma | iso} | more


@pytest.mark.parametrize("standard", ("iso6336", "agma"))
def test_a_steel_is_read_again_where_one_standard_rates_it(standard, tmp_path):
    """A name says strengths by both, and what the other one reads is refused."""
    stage = check_again(gearopt.rate(drive_with(standard)), tmp_path)["stage"][0]
    for member in ("pinion", "wheel"):
        assert stage[member]["steel"] == "16MnCr5"
        assert ("grade" in stage[member]) is (standard == "agma")
        assert ("flank_hardness" in stage[member]) is (standard == "iso6336")


WIDTHS = [45, 40, 36], [36, 40, 45], [40, 45, 45], [45, 45, 40]


@pytest.mark.parametrize("widths", few(WIDTHS, WIDTHS[:1]))
def test_every_gear_beside_an_idler_keeps_its_face_width(widths, tmp_path):
    """Each mesh is as wide as its narrower gear."""
    first, idler, last = ({"face_width": f"{b} mm"} for b in widths)
    pair = {"module": "3 mm", "pinion_teeth": 20, "wheel_teeth": 31}
    stages = [pair | {"pinion": first, "wheel": idler}]
    stages.append({"idler": True, "wheel_teeth": 60, "wheel": last})
    result = gearopt.rate(drive_with("iso6336", stage=stages))
    again = gearopt.rate(check_again(result, tmp_path))
    meshes = [min(pair) for pair in zip(widths, widths[1:], strict=False)]
    assert [stage["face_width_mm"] for stage in again.design["stages"]] == meshes


def test_a_stage_by_agma_keeps_its_overload_factor(tmp_path):
    given = drive_with("agma")
    given["stage"][0]["overload_factor"] = 1.5
    tables = check_again(gearopt.rate(given), tmp_path)
    assert tables["stage"][0]["overload_factor"] == 1.5


def test_an_idler_has_the_grades_of_pinion_and_wheel(tmp_path):
    """Where pinions are of grade 6 and wheels of grade 7, it is rated as each in its mesh."""
    given = drive_with("iso6336")
    given["stage"].append({"idler": True, "wheel_teeth": 60})
    given["rating"]["iso6336"]["tolerances"] = "2013"
    stages = check_again(gearopt.rate(given), tmp_path)["stage"]
    grades = [stages[k][m].get("accuracy_grade") for k, m in ((0, "pinion"), (0, "wheel"))]
    assert grades == [6, None] and stages[1]["wheel"]["accuracy_grade"] == 7


def test_a_design_that_was_found_is_written_with_its_places(solved, tmp_path):
    result = solved("elevator_box")
    model = ET.fromstring(result.to_rexs())
    shafts = [c for c in model.iter("component") if c.get("type") == "shaft"]
    places = [
        [float(c.text) for a in s if "support" in a.get("id") for c in a.iter("c")] for s in shafts
    ]
    rows = result.design["layout"]["shafts"]
    assert places == [[row["from_mm"], row["y_mm"], row["z_mm"]] for row in rows]


def test_the_command_writes_what_python_gives(here, tmp_path):
    path, kept = tmp_path / "x.rexs", tmp_path / "kept.json"
    file = PROBLEMS / "two_stages_rated.toml"
    assert here("export", file, "--rexs", "-o", path).returncode == 0
    result = gearopt.rate(file)
    kept.write_text(result.to_json(), encoding="utf-8")
    printed = here("export", kept, "--rexs").stdout
    for text in (path.read_text(encoding="utf-8"), printed):
        assert _undated(text) == _undated(result.to_rexs().decode())


def _undated(text):
    return [line for line in text.splitlines() if not line.startswith("<model ")]


@pytest.mark.parametrize(
    ("words", "said"),
    (
        ((), "name one format: --dxf, --step, --csv, --rexs"),
        (("--rexs", "-o", "x.toml"), "is a problem file"),
        (("--rexs", "-o", "no/where.rexs"), "there is no folder"),
    ),
)
def test_what_cannot_be_written_is_said_before(here, words, said):
    done = here("export", PROBLEMS / "two_stages_rated.toml", *words)
    assert done.returncode == 2 and said in done.stderr and done.stderr.count("\n") == 1


def test_other_kinds_are_not_written():
    with pytest.raises(gearopt.SolveError, match='"compound" is not exported as rexs'):
        gearopt.export(PROBLEMS / "sandgren_train.toml", "rexs")
    with pytest.raises(
        gearopt.SolveError, match="is not exported as dwg; it is as dxf, step, csv, rexs"
    ):
        gearopt.export(PROBLEMS / "two_stages_rated.toml", "dwg")


def gear(rng, **more):
    """Keys of a gear, any of them."""
    keys = {
        "profile_shift": round(rng.uniform(-0.1, 0.5), 4),
        "tip_alteration": round(rng.uniform(-0.08, 0.0), 3),
        "tool_addendum": round(rng.uniform(1.2, 1.4), 2),
        "tool_tip_radius": rng.choice((0.2, 0.25, 0.3)),
        "roughness": "0.7 um",
        "flank_rz": "4.1 um",
        "iso_quality": rng.choice(("ML", "MQ", "ME")),
        "sigma_Hlim": f"{rng.randint(1200, 1500)} MPa",
        "yield_strength": "700 MPa",
    } | more
    if keys["iso_material"] == "Eh":
        del keys["yield_strength"]
    kept = {k: v for k, v in keys.items() if rng.random() < 0.5 or k in more}
    return kept


def random_stage(rng, standard):
    """A stage of given gears: a pair, a pinion in a ring, or planets."""
    kind = rng.choice(("parallel", "parallel", "planetary", "internal"))
    m, beta = rng.choice((2, 2.5, 3, 4)), rng.choice((0, 8, 15.5))
    material = rng.choice(
        ({"iso_material": "Eh"}, {"iso_material": "V alloy", "hardness": "300 HB"})
    )
    stage = {"type": kind, "module": f"{m} mm", "face_width": f"{rng.randint(10, 20) * m} mm"}
    stage |= {"helix_angle": f"{beta} deg"} if beta else {}
    plain = dict(material)
    if kind == "planetary":
        count = rng.choice((3, 4))
        sun = rng.randint(17, 25)
        planet = rng.randint(20, 30)
        ring = sun + 2 * planet
        ring += -(sun + ring) % count
        stage |= {"sun_teeth": sun, "planet_teeth": planet, "ring_teeth": ring, "planets": count}
        stage |= {"fixed": rng.choice(("ring", "carrier", "sun")), "mesh_load_factor": 1.2}
        stage |= {name: dict(plain) for name in ("sun", "planet", "ring")}
        if rng.random() < 0.5:
            stage |= {"minimum_contact_safety": 1.05, "given_iso6336": {"K_v": [1.2, 1.1]}}
            stage["sun"] |= {"bore": "8 mm", "profile_shift": 0.1}
        if rng.random() < 0.5:
            stage["ring"] |= {"tool_tip_radius": 0.3, "outside_diameter": "500 mm"}
        if rng.random() < 0.5:
            stage["ring"] |= {"cutter_teeth": 25, "cutter_tip_radius": 0.2, "cutter_addendum": 1.27}
    elif kind == "internal":
        stage |= {"pinion_teeth": rng.randint(18, 25), "ring_teeth": rng.randint(60, 90)}
        stage |= {"pinion": dict(plain), "ring": dict(plain)}
    else:
        stage |= {"pinion_teeth": rng.randint(17, 30), "wheel_teeth": rng.randint(35, 90)}
        stage |= {"pinion": gear(rng, **plain), "wheel": gear(rng, **plain)}
        stage |= rng.choice(({}, {"driver": "wheel"}, {"pinion_hand": "left"}))
        stage |= rng.choice(({}, {"overload_factor": 1.5, "minimum_contact_safety": 1.05}))
        if rng.random() < 0.5:
            stage["pinion"]["face_width"] = f"{20 * m + 5} mm"
            stage["wheel"]["thickness_allowance"] = "-0.07 mm"
    return stage


def random_drive(seed):
    """A drive of given gears with a rating by ISO 6336."""
    rng = random.Random(seed)
    iso = {"accuracy_grade": rng.choice(([6, 7], 8)), "edition": rng.choice(("2006", "2019"))}
    iso |= rng.choice(({}, {"oil_grade": "150 mm^2/s"}, {"tip_relief": "25 um"}))
    iso |= rng.choice(({}, {"tolerances": "2013"}))
    rating = {"standard": "iso6336", "life": "15000 h", "overload_factor": 1.25, "iso6336": iso}
    drive = {"gearopt": 1, "kind": "drive", "title": f"drive {seed}", "rating": rating}
    drive["stage"] = [random_stage(rng, rating) for _ in range(rng.randint(1, 3))]
    drive["duty"] = {"power": f"{rng.uniform(5, 30)} kW", "input_speed": "1470 rpm"}
    drive |= rng.choice(({}, {"objective": {"density": "7.8 kg/dm^3"}}))
    shares = [(f"{p} kW", f"{share} %") for p, share in ((9.3, 12.5), (4, 27.5), (2, 60))]
    drive |= rng.choice(({}, {"load": [{"power": p, "share": s} for p, s in shares]}))
    return drive


def drive_of_steels(seed):
    """A drive of steels by name, rated by one standard or both; of odd seeds with idlers."""
    rng, drive = random.Random(seed), random_drive(seed)
    standard = ("iso6336", "agma", "both")[seed % 3]
    drive["rating"]["standard"] = standard
    if standard != "iso6336":
        drive["rating"] |= {"quality": 8, "mounting": "commercial"}
    if standard == "agma":
        del drive["rating"]["iso6336"]
    known = [s for s in steels.steels() if s.treatment or standard == "iso6336"]
    if seed % 2:
        drive["stage"] = [s for s in drive["stage"] if s["type"] == "parallel"] + [None]
        m, teeth = rng.choice((2, 3)), [rng.randint(17, 30), *sorted(rng.sample(range(31, 90), 3))]
        *first, third, fourth = ({"face_width": f"{rng.randint(10, 20) * m} mm"} for _ in teeth)
        pair = {"module": f"{m} mm", "pinion_teeth": teeth[0], "wheel_teeth": teeth[1]}
        pair |= rng.choice((first[0], {"pinion": first[0], "wheel": first[1]}))
        last = {"idler": True, "wheel_teeth": teeth[3], "wheel": fourth}
        between = {"idler": True, "wheel_teeth": teeth[2], "wheel": third}
        drive["stage"][-1:] = rng.choice(([pair, last], [pair, between, last]))
    for stage in drive["stage"]:
        if standard == "agma":
            stage.pop("given_iso6336", None)
        members = ["pinion", "wheel"] if "wheel_teeth" in stage else ["sun", "planet", "ring"]
        members = ["pinion", "ring"] if stage.get("type") == "internal" else members
        for member in members["idler" in stage :]:
            own = stage.setdefault(member, {})
            kept = ("profile_shift", "tip_alteration", "tool_addendum", "tool_tip_radius")
            kept += ("thickness_allowance", "face_width", "bore", "cutter_teeth")
            stage[member] = {k: own[k] for k in kept if k in own}
            stage[member]["steel"] = rng.choice(known).name
            quality = {"iso_quality": rng.choice(("ML", "MQ"))} if standard != "agma" else {}
            stage[member] |= rng.choice(({}, quality))
            stage[member] |= rng.choice(({}, {"grade": 1} if standard != "iso6336" else {}))
    return drive


@pytest.mark.slow
@pytest.mark.parametrize("drive", (random_drive, drive_of_steels))
@pytest.mark.parametrize("seed", range(60))
def test_random_drives_are_the_same_after_a_round_trip(seed, drive, tmp_path):
    """Seed k draws again, at k + 60, k + 120 ..., what no rating takes."""
    for more in range(100):
        try:
            result = gearopt.rate(drive(seed + 60 * more))
        except gearopt.GearoptError:
            continue
        check_again(result, tmp_path)
        return
    raise AssertionError("no drive that a rating takes")

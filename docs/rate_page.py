"""The page "Rate gears": files, outputs and numbers of it are the program's own."""

import io
import re
import tomllib
from pathlib import Path

from rich.console import Console

import gearopt
from gearopt.formulations.drive.rating import DriveRating
from gearopt.optimise.result import Result
from gearopt.optimise.typed import typed
from gearopt.physics.iso6336.materials import CORES, LINES, QUALITIES, SURFACE_HARDENED
from gearopt.physics.mesh_loss import FRICTION_ERROR
from gearopt.physics.shaft_forces import OTHER
from gearopt.report.terminal import show
from gearopt.scenes.drive.rating.iso_material import OF_TREATMENT
from gearopt.scenes.reading.load import examples

HARDNESS = """\
`hardness` in HB counts as HV; of hardened flanks `flank_hardness` is asked for where the strength
depends on it (IF, NV nitrocarburised). Two lines meet inside the range; GGG ferritic has those of
GGG. Eh at MQ is that of a core of 25 HRC; `iso_core = "25 HRC, Jominy"` (28 HRC at J = 12 mm, too)
has 461 and `"30 HRC"` 500 MPa. IF is hardened at the roots, too: with "induction, flanks" give
`sigma_Flim`. Most strengths are unverified: pictures of the table alone have them. They are those
of a failure probability of 1 % or less (IACS UR M56, 2.8 and 3.8)."""
READ = (  # of the standards: part, what was read, what it was met by
    (
        "part",
        "read",
        "met by",
    ),
    (
        "AGMA 2001-D04: stresses, K_v, K_m, K_s, K_B, K_R, life factors, strengths",
        "Shigley and other textbooks, tables, public programs of 2001 and 2101",
        "examples of Shigley, Norton and Mott",
    ),
    (
        "AGMA 908-B89: I and J of spur gears",
        "textbooks, two public programs",
        "the published tables of 908, to their digits",
    ),
    (
        "AGMA 908-B89: I and J of helical gears",
        "two public programs",
        "each other; no print: unverified",
    ),
    (
        "ISO 6336-1, -2, -3: factors of load, contact, bending",
        "IACS UR M56, public programs, DIN 3990 by another program",
        "ISO/TR 6336-30, example 1; the printed report of a 5 MW wind turbine (NREL)",
    ),
    (
        "ISO 6336-5: strengths",
        "pictures of its table in a public repository",
        "ME lines of steels and 1500 MPa of Eh, MQ; the rest is unverified",
    ),
    (
        "ISO 6336-6: load spectra",
        "its annex C in print",
        "that annex, of contact alone",
    ),
    (
        "ISO 1328-1:1995 and 2013, ISO 53, ISO 54, ISO 21771",
        "tables and formulas in print and in programs",
        "tolerances (1995) and geometry of the printed reports",
    ),
    (
        "steels by name",
        "public lists after DIN 743-3, suppliers' sheets after EN 10084, guides of makers",
        "each other: rows of one source are unverified",
    ),
)
PROBLEMS = Path(__file__).parents[1] / "problems"
TEXT = """\
# Rate gears

`gearopt rate FILE` judges gears that are given: stresses, safety factors, lives, every factor with
its clause, forces on the shafts, and the geometry of the teeth, by AGMA 2001-D04 (2101-D04 in
metric terms) with the geometry factors of AGMA 908-B89, by ISO 6336, method B, or by both.
Formulas, sources and published values beside computed ones: [Rating by AGMA](agma.md), [Rating by
ISO 6336](iso6336.md). All keys: [drive](drive.md).

## What was read

None of the standards was. A factor has a clause for its source because that is where others have it
from; what fewer than two of the sources below have, or no published value confirms, is *unverified*
beside the factor.

{read}

Gears of a kept result are rated as they are, `gearopt rate drive.json`; a file may
[take them from another one](from_drive_to_dynamics.md).
A design of a Pareto front is rated by its number: `gearopt rate front.json --design 9`
([Trade-offs](trade_offs.md#a-page-to-pick-from)).

## A pair

```
gearopt new rating > pair.toml
gearopt rate pair.toml
```

The first command prints this file. A pair is a drive of one stage:

```toml
{example}```

With all teeth, modules and widths given, `[limits]` and the ratio of `[duty]` are left out. What
both gears share stands in `[gears]`; the data of one alone in `[stage.pinion]`, `[stage.wheel]`.
A gear that is wider than its mate has a `face_width` there, or the stage
`pinion_face_width_excess = "5 mm"`: see *wider pinions* in [drive](drive.md).
The pinion is the gear with fewer teeth. It drives, unless `driver = "wheel"` of the `[[stage]]`
says that the other gear does: a drive that increases the speed, whose page says so
([Drives that increase the speed](#drives-that-increase-the-speed)).
`overload_factor`, `minimum_bending_safety` and `minimum_contact_safety` of one stage stand in its
`[[stage]]`, in place of those of `[rating]`.
They are cut by the tool of ISO 53 profile A unless a tool is given, and run at the centre distance
without backlash unless `centre_distance` and `thickness_allowance` say otherwise. The same in
inches: `diametral_pitch = 10`, `"1.5 in"`, `"4 hp"`, `"50 ksi"`.

`gearopt rate problems/catalogue_pair.toml`, a pair with shifts and backlash, prints:

```
{catalogue}```

- **safe**: the gears fit, and every safety factor is at least the required one,
  `minimum_bending_safety` and `minimum_contact_safety` (1 by default). The exit code is 0 either
  way: an unsafe pair is an answer too. In `--json`, `limits` holds required over actual, here
  {used_value} for {used}. Gears that cannot be assembled or cannot run (backlash below zero, tips
  that reach into roots or cut into fillets, a bore as wide as its root circle) are never safe, by
  any standard: the reasons come first, in numbers (`misfits` in `--json`), and the exit code is 3.
- **safe, with warnings**: what a designer may accept is said first: undercut, thin tips, a contact
  ratio below 1.2, a backlash of more than four times the recommended least one, a face that is
  loaded in part (K_Hbeta above 2), main resonance, a speed beyond the curve of K_v by AGMA, a ratio
  that is not the one asked for.
- **S_F**, **S_H**: the stress limit over the actual stress. S_H is of stress; of load it is its
  square, {square} here for the pinion.
- **limit**: the allowable stress number of the steel, s_at or s_ac, times Y_N or Z_N (and C_H for a
  softer wheel), over K_T K_R: what the tooth bears for the required life, without a safety factor.
- **power capacity**: the power at which the least safety factor is just the required one.
- **life**: until a safety factor has fallen to 1, of the gear that governs. The curves of Y_N and
  Z_N end at 1e10 cycles: of a gear that lasts longer the hours to there are told, as *over* that.
- **efficiency**: of the mesh alone, from `oil_viscosity` or `friction_coefficient`. A computed
  coefficient of friction may be {friction} % off, which is what ± stands for and is unverified.
- **unverified**: at most one source has it, or no published value confirms it. I and J of helical
  gears are.

`--html page.html` adds drawings, forces, tooth geometry with span and ball measurement; `--csv
FOLDER` writes every table; `--units inch` shows in, psi and hp.

## Factors of your own

Any factor can be given instead of being computed, for all stages in `[rating.given]` or for one in
`[stage.given]`: as a number, or for K_s, K_B, J, s_at, s_ac, Y_N, Z_N and C_H as `[pinion, wheel]`.
Shigley's example 14-4 takes I from a formula and J from a chart:

```toml
{given}```

| | I | J | contact stress, psi | S_H |
|---|---|---|---|---|
{books}

The book's I is that of the pitch point. AGMA 908 takes the lowest point of single tooth contact,
where the pair is stressed {higher} % higher: check what a given factor stands for.

## By ISO 6336

`standard = "iso6336"`, or `"both"` for the two side by side. Beside the keys that both share ISO
asks for an accuracy grade (`problems/pair_by_both.toml`):

```toml
{both}```

It prints:

```
{printed}```

| | AGMA 2001 | ISO 6336 |
|---|---|---|
| overload | `overload_factor` is K_o | the same number is K_A |
| accuracy | `quality`, `accuracy`: K_v | `accuracy_grade`: K_v, K_Hbeta, K_Halpha |
| mounting | `mounting`, `crowned`, `adjusted` | `helix_modification`, `[stage.shaft]` |
| steel | `steel`, or `treatment`, `grade` | `steel`, or `iso_material`, `iso_quality`, `iso_core` |
| reliability | `reliability`: K_R | that of the strengths, 99 % or more |
| oil, roughness | | `oil_grade`, `flank_rz` (or 6 `roughness`), `root_rz` |
| given, all stages | `[rating.given]` | `[rating.iso6336.given]` |
| given, one stage | `[stage.given]` | `[stage.given_iso6336]` |

A key of the one standard is refused where only the other is asked for. Of `[rating.iso6336]`
`edition` is 2006 or 2019, `tolerances` the ISO 1328-1 of 1995 or 2013, `shift` what Y_F takes: the
nominal profile shift or the generating one. What programs choose differently, and what gearopt
chose: [Rating by ISO 6336](iso6336.md). Without helix modification K_Hbeta grows as the load falls.
Materials, with their strengths in MPa at quality ML, MQ and ME by table 1 of ISO 6336-5; x is the
hardness of the flanks:

| `iso_material` | `treatment` | hardness x | sigma_Hlim | sigma_Flim |
|---|---|---|---|---|
{materials}

{hardness}

Gears that are safe by AGMA may not be so by ISO 6336: small through-hardened ones of a coarse grade
[are an example](multi_stage.md#are-these-gears-safe). Published cases in `problems/`, held to what
is printed: `iso_tr_6336_30.toml` and `wind_pair.toml`.

- By both, the pair is safe if every safety factor of either standard is met; the first sentence
  says by which it is. So is `design.rating.safe` of `--json`; `beside.safe` is that of ISO 6336
  alone. The table of gears has both beside each other, factors a table each. `limits`
  holds those of ISO as `pinion_bending_iso[1]` and so on.
- Symbols are those of ISO: sigma_F and sigma_H against the tooth root and pitting stress limits
  sigma_FG and sigma_HG (permissible are sigma_FP and sigma_HP, those over the required safety
  factors). Pages and terminal show them in Greek; `--json` and `--csv` have them in letters.
  Deviations are in µm or µin, stiffnesses in N/(mm µm) or lbf/(in µin); `--json` has both in mm and
  MPa, as its key `unit` says.
- Power capacity by ISO is rated at that power: K_v and the other load factors depend on the load.

## Steels by name

`steel = "16MnCr5"` of a gear, of `[gears]` or of a `[[material]]` stands for its treatment, grade
and hardness by AGMA 2001 and its class and quality by ISO 6336-5; a key beside it goes before.
`gearopt materials` lists 68 steels and irons by their EN, AISI or SAE and JIS names, each with
its sources; `gearopt materials 42CrMo4` one of them. Of several treatments of a steel the first
one counts (42CrMo4: quenched and tempered), unless `treatment` or `iso_material` names another.
The least hardness of its range counts for which the standards have strengths, unless the file
gives one. Class, quality and grade are those usual for the treatment; no source prints them
beside a steel, and the supplier's certificate decides: they are unverified, as rows of fewer than
two sources are.

What the steel does not reach is told with the rating: a hardness outside its range, the hardness
of tempered steel in the section of the gear (R_m (1 - 0.26 lg(d/16 mm)) by DIN 743-2, from
memory; d is the tip diameter or 1.5 face widths), the core of 16MnCr5 and 20MnCr5 above a module
of 3 and 5 mm. So are a face width above 2 d1 or below 3 m_n and an overlap ratio between 0 and 1.
Plastics are refused: VDI 2736 is not supported.

Iron by AGMA 2001 is a `treatment`: `"ASTM A48 class 20"`, `30` or `40`, `"ASTM A536 60-40-18"`,
`80-55-06`, `100-70-03` or `120-90-02`. s_ac and s_at are the lower values of the ranges of tables 3
and 4, from memory of a textbook (*unverified*); stress cycle factors are the lowest curves of
steel, for the standard draws none of iron (*unverified*: beyond 1e7 cycles all curves are one); C_H
is 1; unless the file gives one, E is 22e6 psi of A48 and 24e6 psi of A536 (*unverified*). ISO 6336
rates them as GG, GGG ferritic (60-40-18) and GGG of the given `hardness`.

`sigma_Hlim`, `sigma_Flim`, `s_ac` and `s_at` of a gear or a `[[material]]` are strengths of its
own, in place of those of the tables; its material still says which life curves and running-in it
has. `life_factor_at_1e10` of `[rating.iso6336]` is what Z_NT and Y_NT fall to at 1e10 cycles:
0.85, or up to 1.

## A load spectrum

Tables `[[load]]` stand in the place of the power of `[duty]`, which a file still has but which is
not rated then: levels of power (and `input_speed`, if it is another one), each with its share of
the life. The shares add up to 100 %.

```toml
{load}```

The damage of a level is its number of cycles over the life at its stress; Miner's sum of all levels
is 1 at the end of the life. S_F and S_H are the factors by which all stresses may grow until then.
By ISO 6336 they are marked unverified: the one published spectrum, annex C of part 6, is of
contact. Its levels hold all overloads, K_A = 1: `overload_factor` multiplies every level. Stresses
and factors that are shown are those of the level of largest stress, forces those of the level of
largest force: K_v rises with speed. The first pinion of
`problems/two_stages_rated.toml`, beside one load for the whole life:

| load | S_F | S_H |
|---|---|---|
{levels}

## Ground teeth

`tool_protuberance` pr is how far the tip of the cutter juts out of its flank, `grinding_allowance`
q what grinding takes off a flank, both in normal modules. The rest, s_pr = pr - q, is the undercut
of the finished root: it enters E of ISO 6336-3, the fillet of AGMA 908 and the form circle, while
the thickness of the flanks is the finished one. `tool_addendum` counts from the profile of the
finished tooth: of a hob that stands q/sin alpha_n farther out, take its addendum less q/(m_n sin
alpha_n). More than pr would leave a notch and is refused. Its Y_Sg = 1.3 Y_S/(1.3 - 0.6
sqrt(t_g/rho_g)) (ISO 6336-3, 7.4, *unverified*), of depth t_g and radius rho_g, may be given as Y_S
in `[rating.iso6336.given]`.

## Chamfered tips

`tip_chamfer` is the radial height h_K of a chamfer or round of the tips, in normal modules. Flanks
then touch up to d_Na = d_a - 2 h_K m_n: contact ratios, Z_eps, Z_B, Z_D, sliding, losses, d_Nf of
the mate, the point of load of Y_F (d_en) and J, and I take d_Na, as ISO 6336-3 and the effective
outside radius of AGMA 908 ask. d_a stays in drawings, clearances, masses, and where tips are asked
whether they reach into the mate's fillet, which a chamfer eases.

## A peak torque

Starting, braking and blocking load teeth far more than the duty, but seldom. `static_torque_factor`
of `[rating]` is that torque over the one of the duty; ISO 6336 rates it against static strength:

```toml
[rating]
standard = "iso6336"
static_torque_factor = 3 # of the torque of [duty]
minimum_static_bending_safety = 1.5
minimum_static_contact_safety = 1.2
```

The peak torque stands in the place of K_A; K_v, K_Hbeta and the other factors of load are those at
that torque and at the speed of the duty, which is on the safe side of a peak at standstill. Z_NT
and Y_NT stand at their static ends, Z_L, Z_v, Z_R, Y_RrelT and Y_X are 1, Z_W and Y_deltarelT those
of static stress (Z_W of a soft wheel against a hard pinion is *unverified*); given factors of these
names hold for endurance alone. The peaks are taken to be too few to add to Miner's sum: more than
some 1000 of them belong to a spectrum. `gearopt solve` takes the static safety factors as further
limits (`pinion_contact_static[1]`), proven like the others. AGMA has momentary overloads by yield
strengths of its own, which are not built in: with `standard = "agma"` the key is refused.

## Forces and hands

Forces act at the working pitch circles: F_t = 2 T/d_w drives, F_r = F_t tan alpha_wt pushes the
gears apart, F_a = F_t tan beta_w pushes them along their shafts. Right-hand rule: with the fingers
of the right hand curled the way a right-handed driving gear turns, the thumb shows its thrust; of a
left-handed one take the left hand. The mate has the other hand and the opposite thrust.
`pinion_hand` of a `[[stage]]` sets the hand. By default the first pinion is right-handed, and later
ones are such that the two thrusts of an intermediate shaft oppose each other. Seen from the input
end, where the input turns clockwise, → is away from the eye (`problems/two_stages_rated.toml`):

| shaft | turns | thrusts of its gears | sum |
|---|---|---|---|
{forces}

The sum is what the bearings of a shaft hold. Turned the other way round all thrusts change sides.

## Idlers

With `idler = true` the pinion of a `[[stage]]` is the wheel of the stage before: one gear in two
meshes, between a pinion and a wheel. Its teeth, module, helix angle, shift, width and material are
those of that wheel; of its stage `wheel_teeth` is left to be written:

```toml
[[stage]]
module = "3 mm"
pinion_teeth = 20
wheel_teeth = 31 # of the idler
face_width = "40 mm"

[[stage]]
idler = true
wheel_teeth = 60
```

The ratio is 60/20, whatever the idler's teeth. It is rated in both meshes, *idler 1* and *idler 2*
in the tables, and counted once in volume and mass, in the first. The tooth force of both meshes is
the same, and its shaft has no torque. It has a reversed load by itself: 0.7 of s_at by AGMA 2001,
Y_M = 0.7 by ISO 6336. A revolution loads each of its flanks once, and bends its teeth once each
way, which counts as one load cycle (unverified). Load distribution (K_m, K_Hβ) is that of pairs,
though both meshes load its shaft. Several idlers may follow each other. With `[limits]` and a ratio
its teeth are chosen, too: see [drive](drive.md). There is no `[layout]` of gears with an idler.

A driving gear has no more teeth than the gear that it drives, so that an idler's teeth lie between
those of pinion and wheel. Of another idler rate each mesh as a pair of its own, with
`reversed_load = true` in the table of the idler.

## Planetary stages and rings

A `[[stage]]` of `type = "planetary"` has `sun_teeth`, `planet_teeth`, `ring_teeth` and `planets`,
one of `type = "internal"` `pinion_teeth` and `ring_teeth`; tables `[stage.sun]`, `[stage.planet]`
and `[stage.ring]` stand for those of pinion and wheel. Shifts that are not given follow the rule of
[drives](drive.md). Every mesh is rated by ISO 6336 with every factor (rows of a result then count
meshes, which `named` lists), at its part of the torque and the speed against the carrier; the power
capacity is that of the drive. K_γ that is not given is by the number of planets, unverified.
Factors of `[stage.given_iso6336]` that a mesh has one of may have two values, of sun and planet and
of planet and ring: `K_Hbeta = [2.06, 1.15]`. Planets that cannot be equally spaced, or touch, do
not fit; what an internal mesh breaks of its limits is named. Efficiency counts the power that rolls
alone. The intermediate stage of a 5 MW gearbox (`problems/wind_planetary_stage.toml`) has the Y_F,
Y_S, Z_H, Z_ε, ε_α and α_wt of a printed report, with its load factors its stresses, and its masses,
379.7, 880.3 and 2,712.3 kg, within 0.02 %.

## Drives that increase the speed

`driver = "wheel"` in a `[[stage]]`, or a `ratio` of `[duty]` below 1 for all of them, says that the
wheel drives. Both standards rate a pair by its smaller gear, whichever drives: d1, b/d1, u ≥ 1,
Z_B, Z_D, Z_W, C_H, J and I are those of pinion and wheel all the same, and every gear has the
cycles of its own speed. Without losses the gears are loaded as those of the mirrored drive, with
input and output exchanged and the stages in reverse order, so that all stresses and safety factors
are the same. Rows and keys are by pinion and wheel; *driving gear* beside the teeth of a stage
names the one that drives. Stages up and down may follow one another, as on a layshaft of 1:1;
pinions are handed so that the two thrusts of an intermediate shaft oppose each other, unless
`pinion_hand` says otherwise. How such drives are sized: [drive](drive.md).

## A drive that is sized

With a table `[rating]` beside `[limits]` its safety factors, at the required life, are
limits: `gearopt solve` finds the teeth, modules and face widths of least volume, mass or length
whose gears are all safe, by AGMA, by ISO 6336 or by both, and proves it by exhausting all others
(`problems/elevator_by_agma.toml`, `problems/minimum_volume_pair.toml`). The winner is rated once
more by the exact form, and its rating stands in the answer; one that it found unsafe would be
refused. `gearopt new sizing` prints a file to start from.

```toml
{start}```

Every module of `[teeth]` is tried, as a larger one can be the better one, and of every pair the
first face width that carries. `face_width_over_module` and `minimum_face_width` limit the widths
beside `face_width_over_diameter`. `gearopt explain FILE` says what a better steel, another
quality or a tenth less life brings, each solved again; of an impossible file it moves each number
alone.

Gears may choose of materials: tables `[[material]]` have a name, the keys of a steel, a density
and prices, and `materials = ["a", "b"]` in `[gears]`, `[stage.pinion]` or `[stage.wheel]` names
those that a gear may have. Pinion and wheel choose freely, each of its own list: all combinations
are compared, and `minimise = "cost"` takes material, heat treatment and cutting by the
[prices](drive.md) of a kilogram and of a metre of teeth (`problems/materials_by_cost.toml`). A
material may have a `quality` or an `accuracy_grade`, so that finer gears have their own price; of
Q_v the lower one of a pair counts. The search begins with each material alone, which gives a design
soon, and a run that ends early has a bound.
`same_materials = true` in `[gears]` asks for one material for the pinions of all stages and one for
all wheels: the best of all pairs that every stage may have, matched by name, proven
(`problems/same_materials.toml`: 114.39, in place of 110.54 with a pair for each stage). Rims, webs
and bores enter masses and costs as they enter the ratings: webs and rims of [drives](drive.md),
`problems/light_wheels.toml`.

A load spectrum is what the gears carry: Miner's sum of all levels `[[load]]` gives the safety
factors. A K-factor and unit load in `[limits]` are limits beside the ratings
(`problems/sized_and_rated.toml`: {sized}, so that they alone bind). Without `[teeth]`, or by the
method `smooth`, sizes are real numbers with a proven lower bound: 5 s are spent on it, 15 s
from three stages on, or with `--gap 0.01` as long as that takes. The bound holds for whole
teeth too; a search among them that its `--seconds` cut short has it, and the real-valued sizes
as a part. Spectra and `materials` are for whole teeth alone: real-valued sizes then follow from
a K-factor and unit load, where they are given, and the rating tells whether the gears are safe.
Gears and box at once (`together`) are chosen by their ratings, too
(`problems/elevator_box_rated.toml`); the two processes size by load
limits alone and are refused beside `[rating]`.

Real-valued sizes are sought on a smooth form of the rating and judged by the exact one. Of 20,000
random pairs a case, loaded so that the least safety factor is between 0.8 and 1.25, safety factors
of the smooth form are off by so many per cent, and so many verdicts on a pinion and on a wheel
would be wrong (`gearopt bench smooth`):

| case | limit | median | 99.9 % | worst | unsafe called safe | safe called unsafe |
|---|---|---|---|---|---|---|
| AGMA, spur | bending | 0.0 | 0.0 | 0.0 | 0, 0 | 0, 0 |
| AGMA, spur | contact | 0.0 | 0.0 | 0.0 | 0, 0 | 0, 0 |
| AGMA, low | bending | 0.0 | 0.0 | 0.0 | 0, 0 | 0, 0 |
| AGMA, low | contact | 0.0 | 0.0 | 0.0 | 0, 0 | 0, 0 |
| AGMA, conventional | bending | 2.5 | 6.7 | 6.9 | 214, 193 | 562, 556 |
| AGMA, conventional | contact | 1.3 | 3.3 | 3.4 | 127, 118 | 301, 260 |
| ISO 6336, spur | bending | 0.5 | 34.9 | 46.7 | 69, 74 | 104, 96 |
| ISO 6336, spur | contact | 0.3 | 15.8 | 20.7 | 71, 43 | 160, 74 |
| ISO 6336, helical | bending | 0.5 | 16.1 | 34.1 | 78, 99 | 156, 165 |
| ISO 6336, helical | contact | 0.3 | 7.7 | 15.5 | 82, 40 | 121, 94 |

Above an overlap ratio of 1 the smooth form of AGMA has the mean load sharing (a search then takes
its exact branches); that of ISO 6336 has no mixture of two laws of K_v above the resonance, no
ranges and no rounding of ISO 1328.

## What is not rated

Scuffing, micropitting, wear, flank fracture, shafts, bearings and housings; bevel
gears and worms. Gears that have no rating are refused by name: pointed teeth, contact
that breaks off, a transverse contact ratio of 2 or more of spur gears. What a designer may accept
is a warning: undercut, thin tips, no backlash.
"""


def page() -> str:
    """The page with its files and what the program prints for them now."""
    rated = {
        n: gearopt.rate(PROBLEMS / f"{n}.toml") for n in ("catalogue_pair", "two_stages_rated")
    }
    pair = _rating(rated["catalogue_pair"])
    used = max(rated["catalogue_pair"].limits.items(), key=lambda item: item[1])
    return TEXT.format(
        example=examples()["rating"],
        read=_read(),
        start=examples()["sizing"],
        catalogue=_printed(rated["catalogue_pair"]),
        used=f"`{used[0]}`",
        used_value=f"{used[1]:.3f}",
        square=f"{pair.gears[0].contact_safety ** 2:.2f}",
        friction=f"{100 * FRICTION_ERROR:.0f}",
        given=_table("shigley_14_4", r"\[rating\.given\].*?\n(?=\n|\Z)"),
        books=_books(),
        higher=f"{100 * (_contact('shigley_14_4_by_908') / _contact('shigley_14_4') - 1):.0f}",
        load=_table("two_stages_rated", r"\[\[load\]\].*?\n(?=\n\[x-)"),
        levels=_levels(_rating(rated["two_stages_rated"])),
        forces=_forces(_rating(rated["two_stages_rated"])),
        sized=_sized(),
        both=_table("pair_by_both", r"\[gears\].*?\n(?=\n\[x-)"),
        printed=_printed(gearopt.rate(PROBLEMS / "pair_by_both.toml")),
        materials=_materials(),
        hardness=HARDNESS,
    )


def _materials() -> str:
    """The materials of ISO 6336-5 with the treatments that stand for them and their strengths."""
    rows = []
    for name in dict.fromkeys(line[0] for line in LINES):
        treatments = ", ".join(t for t, material in OF_TREATMENT.items() if material == name)
        ends = [end for line in LINES if line[0] == name for end in line[6:]]
        said = [_strengths(name, stress) for stress in "HF"]
        unit = "HV" if name in SURFACE_HARDENED or name.startswith("V ") else "HB"
        rows.append(
            f"| {name} | {treatments} | {min(ends):.0f} to {max(ends):.0f} {unit} | "
            f"{said[0]} | {said[1]} |"
        )
    return "\n".join(rows)


def _strengths(name: str, stress: str) -> str:
    """The lines of a material, one of each quality."""
    told = {}
    for quality in QUALITIES:
        lines = [
            line
            for line in LINES
            if line[:2] == (name, stress) and quality in line[2] and line[3] in ("", CORES[0])
        ]
        told[quality] = " and ".join(
            f"{line[4]:g} x + {line[5]:g}" if line[4] else f"{line[5]:g}" for line in lines
        )
    return "; ".join(told.values())


def _rating(result: Result) -> DriveRating:
    found: DriveRating = typed(DriveRating, result.design["rating"])
    return found


def _printed(result: Result) -> str:
    """What a terminal of 88 columns shows."""
    screen = Console(width=88, record=True, file=io.StringIO())
    show(result, screen)
    lines = [line.rstrip() for line in screen.export_text().splitlines()]
    return "\n".join(lines).strip("\n") + "\n"


def _read() -> str:
    """What was read of the standards, as a table."""
    head, *rows = (f"| {' | '.join(row)} |" for row in READ)
    return "\n".join([head, "| --- | --- | --- |", *rows])


def _table(name: str, pattern: str) -> str:
    text = (PROBLEMS / f"{name}.toml").read_text(encoding="utf-8")
    found = re.search(pattern, text, re.S)
    assert found, name
    return found[0]


def _contact(name: str) -> float:
    stress = gearopt.rate(PROBLEMS / f"{name}.toml").design["rating"]["gears"][1]
    return float(stress["contact_stress_MPa"])


def _books() -> str:
    """I and J of the pair of Shigley's example, given and by 908, and what follows."""
    rows = []
    for words, name in (
        ("given, from the book", "shigley_14_4"),
        ("by AGMA 908", "shigley_14_4_by_908"),
    ):
        rating = _rating(gearopt.rate(PROBLEMS / f"{name}.toml"))
        pitting, bending = (next(f for f in rating.factors if f.symbol == s) for s in "IJ")
        psi = [gear.contact_stress_MPa / 0.006894757293168361 for gear in rating.gears]
        safety = ", ".join(f"{gear.contact_safety:.2f}" for gear in rating.gears)
        rows.append(
            f"| {words} | {pitting.pinion:.4f} | {bending.pinion:.3f}, {bending.wheel:.3f} | "
            f"{psi[0]:,.0f}, {psi[1]:,.0f} | {safety} |"
        )
    return "\n".join(rows)


def _levels(rating: DriveRating) -> str:
    """S_F and S_H of the first pinion under the spectrum, and under each of its loads alone."""
    file = tomllib.loads((PROBLEMS / "two_stages_rated.toml").read_text(encoding="utf-8"))
    found = [("the spectrum", rating.gears[0])]
    for level in file.pop("load")[:2]:
        alone = file | {"duty": file["duty"] | {"power": level["power"]}}
        found.append((f"{level['power']} throughout", _rating(gearopt.rate(alone)).gears[0]))
    return "\n".join(
        f"| {words} | {gear.bending_safety:.2f} | {gear.contact_safety:.2f} |"
        for words, gear in found
    )


def _forces(rating: DriveRating) -> str:
    """Every shaft with its gears, their hands and thrusts, and the sum."""
    hands = {(tooth.stage, tooth.member): tooth.hand for tooth in rating.teeth}
    lines = []
    for shaft in rating.shafts:
        gears = []
        for stage, member in ((shaft.shaft - 1, "wheel"), (shaft.shaft, "pinion")):
            if (stage, member) not in hands:
                continue
            force = rating.meshes[stage - 1].axial_force_N
            gears.append((stage, member, hands[stage, member], _along(stage, hands, member), force))
        told = [f"{m} {k}, {h}: {a} {f:,.1f} N" for k, m, h, a, f in gears]
        whole = f"{'→' if shaft.axial_force_N > 0 else '←'} {abs(shaft.axial_force_N):,.1f} N"
        lines.append(f"| {shaft.shaft} | {shaft.rotation} | {'; '.join(told)} | {whole} |")
    return "\n".join(lines)


def _along(stage: int, hands: dict[tuple[int, str], str], member: str) -> str:
    """The way of a thrust by the right-hand rule; a driven gear as its mate would not go."""
    pinion = hands[stage, "pinion"]
    assert member == "pinion" or hands[stage, member] == OTHER[pinion]
    away = (pinion == "right") == (stage % 2 == 1)
    return "→" if away == (member == "pinion") else "←"


def _sized() -> str:
    """The answer of the sized drive as its file holds it, which the tests hold to the program."""
    text = (PROBLEMS / "sized_and_rated.toml").read_text(encoding="utf-8")
    expected = tomllib.loads(text)["x-expected"]
    duty = tomllib.loads(text)["duty"]["power"]
    return f"it may transmit {expected['power_capacity_kW']:.1f} kW, {duty} required"

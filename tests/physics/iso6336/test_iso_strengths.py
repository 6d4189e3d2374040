"""Strengths of ISO 6336-5:2016, table 1, line by line, and what is refused."""

import pytest

from gearopt.physics.iso6336.materials import MATERIALS, Material, strength

# material; stress; qualities; core; A; B; range of hardness. sigma_lim = A x + B. Source: pictures
# of the table in a public repository (waa552/fyp-website)
TABLE = """
St; H; ML/MQ; ; 1.0; 190; 110; 210
St; H; ME; ; 1.52; 250; 110; 210
St; F; ML/MQ; ; 0.455; 69; 110; 210
St; F; ME; ; 0.386; 147; 110; 210
St cast; H; ML/MQ; ; 0.986; 131; 140; 210
St cast; H; ME; ; 1.143; 237; 140; 210
St cast; F; ML/MQ; ; 0.313; 62; 140; 210
St cast; F; ME; ; 0.254; 137; 140; 210
GTS; H; ML/MQ; ; 1.371; 143; 135; 250
GTS; H; ME; ; 1.333; 267; 175; 250
GGG; H; ML/MQ; ; 1.434; 211; 175; 300
GGG; H; ME; ; 1.5; 250; 200; 300
GG; H; ML/MQ; ; 1.033; 132; 150; 240
GG; H; ME; ; 1.465; 122; 175; 275
GTS; F; ML/MQ; ; 0.345; 77; 135; 250
GTS; F; ME; ; 0.403; 128; 175; 250
GGG; F; ML/MQ; ; 0.35; 119; 175; 300
GGG; F; ME; ; 0.38; 134; 200; 300
GG; F; ML/MQ; ; 0.256; 8; 150; 240
GG; F; ME; ; 0.2; 53; 175; 275
V carbon; H; ML; ; 0.963; 283; 135; 210
V carbon; H; MQ; ; 0.925; 360; 135; 210
V carbon; H; ME; ; 0.838; 432; 135; 210
V alloy; H; ML; ; 1.313; 188; 200; 360
V alloy; H; MQ; ; 1.313; 373; 200; 360
V alloy; H; ME; ; 2.213; 260; 200; 390
V carbon; F; ML; ; 0.25; 108; 115; 215
V carbon; F; MQ; ; 0.24; 163; 115; 215
V carbon; F; ME; ; 0.283; 202; 115; 215
V alloy; F; ML; ; 0.423; 104; 200; 360
V alloy; F; MQ; ; 0.425; 187; 200; 360
V alloy; F; ME; ; 0.358; 231; 200; 390
V cast carbon; H; ML/MQ; ; 0.831; 300; 130; 215
V cast carbon; H; ME; ; 0.951; 345; 130; 215
V cast alloy; H; ML/MQ; ; 1.276; 298; 200; 360
V cast alloy; H; ME; ; 1.35; 356; 200; 360
V cast carbon; F; ML/MQ; ; 0.224; 117; 130; 215
V cast carbon; F; ME; ; 0.286; 167; 130; 215
V cast alloy; F; ML/MQ; ; 0.364; 161; 200; 360
V cast alloy; F; ME; ; 0.356; 186; 200; 360
Eh; H; ML; ; 0.0; 1300; 600; 800
Eh; H; MQ; ; 0.0; 1500; 660; 800
Eh; H; ME; ; 0.0; 1650; 660; 800
Eh; F; ML; ; 0.0; 312; 600; 800
Eh; F; MQ; 25 HRC; 0.0; 425; 660; 800
Eh; F; MQ; 25 HRC, Jominy; 0.0; 461; 660; 800
Eh; F; MQ; 30 HRC; 0.0; 500; 660; 800
Eh; F; ME; ; 0.0; 525; 660; 800
IF; H; ML; ; 0.74; 602; 485; 615
IF; H; MQ; ; 0.541; 882; 500; 615
IF; H; ME; ; 0.505; 1013; 500; 615
IF; F; ML; ; 0.305; 76; 485; 615
IF; F; MQ; ; 0.138; 290; 500; 570
IF; F; MQ; ; 0.0; 369; 570; 615
IF; F; ME; ; 0.271; 237; 500; 615
NT; H; ML; ; 0.0; 1125; 650; 900
NT; H; MQ; ; 0.0; 1250; 650; 900
NT; H; ME; ; 0.0; 1450; 650; 900
NV; H; ML; ; 0.0; 788; 450; 650
NV; H; MQ; ; 0.0; 998; 450; 650
NV; H; ME; ; 0.0; 1217; 450; 650
NT; F; ML; ; 0.0; 270; 650; 900
NT; F; MQ; ; 0.0; 420; 650; 900
NT; F; ME; ; 0.0; 468; 650; 900
NV; F; ML; ; 0.0; 258; 450; 650
NV; F; MQ; ; 0.0; 363; 450; 650
NV; F; ME; ; 0.0; 432; 450; 650
NV nitrocarburised; H; ML; ; 0.0; 650; 300; 650
NV nitrocarburised; H; MQ/ME; ; 1.167; 425; 300; 450
NV nitrocarburised; H; MQ/ME; ; 0.0; 950; 450; 650
NV nitrocarburised; F; ML; ; 0.0; 224; 300; 650
NV nitrocarburised; F; MQ/ME; ; 0.653; 94; 300; 450
NV nitrocarburised; F; MQ/ME; ; 0.0; 388; 450; 650
"""
LINES = [tuple(cell.strip() for cell in line.split(";")) for line in TABLE.strip().splitlines()]


def test_all_lines_are_there():
    assert len(LINES) == 73
    assert {line[0] for line in LINES} == set(MATERIALS) - {"GGG ferritic"}


@pytest.mark.parametrize("line", LINES, ids=lambda line: " ".join(line[:4] + line[6:7]))
def test_a_line_of_the_table(line):
    name, stress, qualities, core, slope, base, low, high = line
    for quality in qualities.split("/"):
        for share in (0.001, 0.5, 1.0):
            hardness = float(low) + share * (float(high) - float(low))
            found = strength(Material(name, quality, hardness, core or "25 HRC"), stress)
            assert found.stress == pytest.approx(float(slope) * hardness + float(base))
            assert found.within


@pytest.mark.parametrize("line", LINES, ids=lambda line: " ".join(line[:4] + line[6:7]))
def test_a_range_of_the_table(line):
    """A thousandth beyond the ends of all lines of a material nothing is within."""
    name, stress, qualities, core = line[:4]
    same = [other for other in LINES if other[:4] == line[:4]]
    low, high = min(float(o[6]) for o in same), max(float(o[7]) for o in same)
    for quality in qualities.split("/"):
        for hardness, end in ((0.999 * low, low), (1.001 * high, high)):
            found = strength(Material(name, quality, hardness, core or "25 HRC"), stress)
            assert not found.within and found.nearest == end


def test_beyond_a_range_its_end_counts():
    soft = strength(Material("V alloy", "ML", 100.0), "H")
    assert soft.stress == strength(Material("V alloy", "ML", 200.0), "H").stress
    assert not soft.within and soft.nearest == 200.0
    hard = strength(Material("IF", "MQ", 700.0), "F")
    assert hard.stress == 369.0 and not hard.within


def test_ferritic_iron_has_the_lines_of_nodular_iron():
    for stress in "HF":
        one, two = (
            strength(Material(name, "MQ", 200.0), stress) for name in ("GGG", "GGG ferritic")
        )
        assert one == two


def test_what_is_missing_is_named():
    with pytest.raises(ValueError, match="needs its surface hardness"):
        strength(Material("V alloy", "MQ"), "H")
    with pytest.raises(ValueError, match="no material 'butter'; known: St"):
        strength(Material("butter"), "H")
    with pytest.raises(ValueError, match="no material 'butter'; known: St"):
        assert Material("butter").family
    with pytest.raises(ValueError, match="no quality 'MX'"):
        strength(Material("Eh", "MX"), "F")
    with pytest.raises(ValueError, match="no core '20 HRC'"):
        strength(Material("Eh", "MQ", core="20 HRC"), "F")
    assert strength(Material("Eh", "ML"), "F").stress == 312.0

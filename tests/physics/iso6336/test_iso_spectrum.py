"""The load spectrum of ISO 6336-6, annex C: a case-hardened pinion of 17 teeth, 42 levels.

Source: gfsReboucas/Drivetrain, data/table_C2.csv. Its strength is 1500 MPa times Z_NT and Z_L 1.02,
Z_v 0.943 and Z_R 1.01 (MATISO_6336.m), which stay as they are down to static strength; K_A is 1.
"""

import math

import pytest

from gearopt.physics.iso6336.curves import Curve, pitting_curve
from gearopt.physics.rating import Level, damage, spectrum_safety

# level, cycles in 30 years, sigma_H S_H [MPa], Z_NT, N_i, U_i
PRINTED = """
3 2203 2349 1.61 90500 0.0243
4 1285 2344 1.61 92900 0.0138
5 825.9 2344 1.61 92900 0.00889
6 1285 2340 1.61 95400 0.0135
7 2570 2335 1.6 97900 0.0262
8 1285 2330 1.6 101000 0.0128
9 825.9 2326 1.6 103000 0.008
10 1744 2321 1.59 106000 0.0165
11 2570 2316 1.59 109000 0.0236
12 3028 2312 1.59 112000 0.0271
13 2203 2307 1.58 115000 0.0192
14 2203 2297 1.58 121000 0.0182
15 1744 2293 1.57 125000 0.014
16 2386 2283 1.57 132000 0.0181
17 4772 2274 1.56 139000 0.0343
18 4313 2264 1.55 147000 0.0293
19 5690 2250 1.54 160000 0.0355
20 8076 2240 1.54 170000 0.0476
21 6057 2225 1.53 185000 0.0328
22 14960 2211 1.52 202000 0.0741
23 16520 2191 1.5 227000 0.0727
24 7617 2176 1.49 249000 0.0306
25 18350 2156 1.48 281000 0.0653
26 19460 2131 1.46 329000 0.0592
27 9544 2110 1.45 373000 0.0256
28 21840 2084 1.43 440000 0.0497
29 23220 2053 1.41 538000 0.0432
30 18350 2021 1.39 662000 0.0277
31 18900 1988 1.37 820000 0.023
32 27260 1955 1.34 1020000 0.0266
33 29000 1916 1.32 1340000 0.0217
34 30650 1870 1.28 1850000 0.0166
35 32300 1823 1.25 2580000 0.0125
36 25150 1785 1.23 3420000 0.00736
37 26250 1742 1.2 4700000 0.00558
38 37080 1693 1.16 6860000 0.0054
39 39370 1643 1.13 10200000 0.00385
40 41210 1593 1.09 15400000 0.00268
41 42950 1534 1.05 25200000 0.0017
42 27810 1467 1.01 45700000 0.000609
43 16150 1398 0.96 190000000 8.48e-05
44 1101 1318 0.91 1310000000 8.42e-07
"""
ROWS = [tuple(map(float, line.split())) for line in PRINTED.strip().splitlines()]
REFERENCE = 1500.0 * 1.02 * 0.943 * 1.01  # MPa
STATIC = 7  # levels up to it lie above 1.6 REFERENCE, where the print draws the line on


def _curve():
    curve = pitting_curve("Eh")
    return Curve(curve.cycles, tuple(REFERENCE * value for value in curve.values))


def test_the_life_of_every_level():
    """Half a MPa of a printed stress is 0.4 % of a life to 5e7 cycles, 1.3 % beyond them."""
    for level, _, stress, factor, life, _ in ROWS:
        found = _curve().life(stress)
        if level <= STATIC:
            assert found == 0.0 and life < 101000.0 and factor >= 1.6
        else:
            assert found == pytest.approx(life, rel=0.008 if life < 5e7 else 0.02)
            assert stress / REFERENCE == pytest.approx(factor, abs=0.006)


def test_miners_sum_of_the_levels_that_static_strength_allows():
    """The printed sum is 1; without the five levels above static strength 0.9129."""
    levels = [Level(n, _curve(), stress) for level, n, stress, *_ in ROWS if level > STATIC]
    printed = math.fsum(row[5] for row in ROWS if row[0] > STATIC)
    assert math.fsum(row[5] for row in ROWS) == pytest.approx(1.0, abs=1e-3)
    assert damage(levels) == pytest.approx(printed, rel=2e-3)


def test_the_safety_factor():
    """All stresses over 1.3446 = 2349/1747, the print's S_H; static strength allows 2331.5/1747."""
    levels = [Level(n, _curve(), stress / (2349.0 / 1747.0)) for _, n, stress, *_ in ROWS]
    found = spectrum_safety(levels)
    assert found == pytest.approx(1.6 * REFERENCE / 1747.0, rel=1e-9)
    assert found == pytest.approx(2349.0 / 1747.0, rel=8e-3)

"""Fits of gears by tables: tooth thickness of DIN 3967, centre distance js of ISO 286.

Sizes in mm, of rings their absolute values; allowances in mm. A size at the end of a range belongs
to it. Sources: DIN 3967:1978 as two public transcriptions have it alike, its example 27cd and three
printed reports of cd25 among them; IT grades of ISO 286-1:2010, table 1, likewise (DIN 3964 takes
js of these for centre distances), js6 and js7 of two printed reports.
"""

from bisect import bisect_left

MICROMETRE = 1e-3  # mm


def _table(*lines: str) -> tuple[tuple[int, ...], ...]:
    """The rows of a table, written several to a line."""
    return tuple(tuple(map(int, row.split())) for line in lines for row in line.split("/"))


DIAMETERS = (10, 50, 125, 280, 560, 1000, 1600, 2500, 4000, 6300, 10000)  # ends of ranges [mm]
SERIES = ("a", "ab", "b", "bc", "c", "cd", "d", "e", "f", "g", "h")
UPPER = _table(  # -A_sne [um] by range of the reference diameter and series; DIN 3967, table 1
    "100 85 70 58 48 40 33 22 10 5 0 / 135 110 95 75 65 54 44 30 14 7 0",
    "180 150 125 105 85 70 60 40 19 9 0 / 250 200 170 140 115 95 80 56 26 12 0",
    "330 280 230 190 155 130 110 75 35 17 0 / 450 370 310 260 210 175 145 100 48 22 0",
    "600 500 420 340 290 240 200 135 64 30 0 / 820 680 560 460 390 320 270 180 85 41 0",
    "1100 920 760 620 520 430 360 250 115 56 0 / 1500 1250 1020 840 700 580 480 330 155 75 0",
    "2000 1650 1350 1150 940 780 640 450 210 100 0",
)
TOLERANCES = tuple(range(21, 31))
WIDTHS = _table(  # T_sn [um] by range of the reference diameter and tolerance; DIN 3967, table 2
    "3 5 8 12 20 30 50 80 130 200 / 5 8 12 20 30 50 80 130 200 300",
    "6 10 16 25 40 60 100 160 250 400 / 8 12 20 30 50 80 130 200 300 500",
    "10 16 25 40 60 100 160 250 400 600 / 12 20 30 50 80 130 200 300 500 800",
    "16 25 40 60 100 160 250 400 600 1000 / 20 30 50 80 130 200 300 500 800 1300",
    "25 40 60 100 160 250 400 600 1000 1600 / 30 50 80 130 200 300 500 800 1300 2000",
    "40 60 100 160 250 400 600 1000 1600 2400",
)
DISTANCES = (
    *(3, 6, 10, 18, 30, 50, 80, 120, 180, 250, 315, 400, 500),
    *(630, 800, 1000, 1250, 1600, 2000, 2500, 3150),
)
GRADES = tuple(range(5, 12))
IT = _table(  # IT5 to IT11 [um] by range of size; ISO 286-1, table 1
    "4 6 10 14 25 40 60 / 5 8 12 18 30 48 75 / 6 9 15 22 36 58 90 / 8 11 18 27 43 70 110",
    "9 13 21 33 52 84 130 / 11 16 25 39 62 100 160 / 13 19 30 46 74 120 190",
    "15 22 35 54 87 140 220 / 18 25 40 63 100 160 250 / 20 29 46 72 115 185 290",
    "23 32 52 81 130 210 320 / 25 36 57 89 140 230 360 / 27 40 63 97 155 250 400",
    "32 44 70 110 175 280 440 / 36 50 80 125 200 320 500 / 40 56 90 140 230 360 560",
    "47 66 105 165 260 420 660 / 55 78 125 195 310 500 780 / 65 92 150 230 370 600 920",
    "78 110 175 280 440 700 1100 / 96 135 210 330 540 860 1350",
)


def thickness_allowances(diameter: float, series: str, tolerance: int) -> tuple[float, float]:
    """Upper and lower allowance A_sne, A_sni = A_sne - T_sn [mm] of the normal tooth thickness.

    diameter: reference diameter d [mm]; series "cd" and tolerance 25 of DIN 3967's 25cd.
    ValueError for a diameter beyond its tables.
    """
    row = _range(diameter, DIAMETERS, "DIN 3967")
    upper = -MICROMETRE * UPPER[row][SERIES.index(series)]
    return upper, upper - MICROMETRE * WIDTHS[row][TOLERANCES.index(tolerance)]


def distance_allowance(distance: float, grade: int) -> float:
    """Allowance A_a = IT/2 [mm] of a centre distance [mm], up and down, by js of a grade.

    ValueError for a distance beyond the table.
    """
    return 0.5 * MICROMETRE * IT[_range(distance, DISTANCES, "ISO 286")][GRADES.index(grade)]


def _range(size: float, ends: tuple[int, ...], table: str) -> int:
    """The range in which a size lies, that ends there."""
    if not 0.0 < size <= ends[-1]:
        raise ValueError(f"{size:.6g} mm is beyond the table of {table}, which ends at {ends[-1]}")
    return bisect_left(ends, size)

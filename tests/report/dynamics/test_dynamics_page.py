"""The page of a pair on moving axes: what is told of speeds, and axes that move as they did."""

from dataclasses import replace

import numpy as np

from gearopt.formulations.dynamics.design import (
    Chosen,
    DynamicErrors,
    DynamicsDesign,
    Equilibrium,
    Response,
    Speeds,
)
from gearopt.optimise.result import Result
from gearopt.optimise.typed import untyped
from gearopt.report.answer import decided
from gearopt.report.kinds.dynamics import binding_limit, chosen, prices, speeds
from gearopt.report.kinds.dynamics import plots as dynamics_plots
from gearopt.report.measures import INCH, METRIC
from gearopt.report.pages.result import page

REST = Equilibrium(
    normal_load_N=3000.0,
    mean_stiffness_N_per_mm=2e5,
    mesh_mass_kg=0.3,
    deformation_mm=-0.015,
    centre_distance_mm=149.0,
    centre_distance_growth_mm=0.02,
    pressure_angle_deg=20.0,
    bearing_force_N=3000.0,
    frequencies_Hz=(1300.0, 5700.0),
    mesh_shares=(0.1, 0.9),
)
FOUND = Speeds(  # in contact; two motions; two that take two periods or none; without end
    teeth_part=True,
    speed_rpm=(1000.0, 2000.0, 3000.0, 4000.0, 5000.0),
    rms_mm=(0.001, 0.002, 0.003, 0.02, None),
    peak_to_peak_mm=(0.004, 0.005, 0.006, 0.07, None),
    highest_mm=(-0.01, -0.01, -0.01, 0.01, None),
    repeats=(1, 1, 1, 2, 1),
    falling_rms_mm=(0.001, 0.002, 0.03, 0.02, 0.01),
    falling_peak_to_peak_mm=(0.004, 0.005, 0.09, 0.07, 0.05),
    falling_highest_mm=(-0.01, -0.01, 0.04, 0.01, 0.01),
    falling_repeats=(1, 1, 0, 2, 1),
    growth=(0.9, 0.9, 0.9, 0.9, 1.1),
    jammed_rpm=(),
    harmonics_mm=((0.002, 0.002, 0.002, 0.02, None), (0.0, 0.0, 0.0, 0.0, None)),
)

PRICES = {"prices": {"influences": [], "message": "", "basis": ""}}


def told(found):
    design = DynamicsDesign(
        kinematics="exact", axes="line", mesh_frequency_Hz=0.0, equilibrium=REST, speeds=found
    )
    section = speeds(Result("dynamics", "evaluated", "modes", {}, design=untyped(design)), METRIC)
    assert section is not None
    return section


def test_a_sentence_has_the_digits_of_the_table_in_inches():
    """19.1745 µm are 0.7549 mil; from 19.17 µm it would be 0.7547 mil."""
    rest = replace(REST, deformation_mm=-0.0191745)
    design = DynamicsDesign(
        kinematics="exact", axes="line", mesh_frequency_Hz=0.0, equilibrium=rest
    )
    moved = Result("dynamics", "evaluated", "modes", {}, design=untyped(design), scene="dynamics")
    assert decided(moved) == "The mean load deforms the mesh by 19.17 µm."
    assert decided(moved, INCH) == "The mean load deforms the mesh by 0.7549 mil."
    assert "-0.7549" in page(moved, "gearopt solve x.toml", INCH)
    assert (
        INCH.words("a note on 19.2 µm, and on 0.1 mm") == "a note on 0.756 mil, and on 0.00394 in"
    )


def test_speeds_are_told_where_largest_and_where_two():
    section = told(FOUND)
    worst, two = section.words
    assert worst == (
        "The RMS of the deformation about its mean is largest at 3,000 rpm as speed falls: 30 µm, "
        "peak to peak 90 µm."
    )
    assert two.startswith("There are two motions at 3,000 rpm, one up to 10 times as large")
    (table,) = section.tables
    assert table.heads[:2] == ("speed [rpm]", "RMS [µm], rising") and len(table.heads) == 9
    kinds = [(row[4], row[8]) for row in table.rows]
    assert kinds == [
        ("in contact", "in contact"),
        ("in contact", "in contact"),
        ("in contact", "does not repeat"),
        ("repeats after 2 periods", "repeats after 2 periods"),
        ("unstable", "teeth part"),
    ]


def test_the_first_line_has_the_largest_dynamic_factor_and_its_speed():
    factors = {"dynamic_factor": (1.1, 1.2, 1.3, 2.0, None)}
    factors |= {"falling_dynamic_factor": (1.1, 1.2, 2.5, 2.0, 1.5)}
    design = DynamicsDesign(
        kinematics="exact",
        axes="line",
        mesh_frequency_Hz=0.0,
        equilibrium=REST,
        speeds=replace(FOUND, **factors),
    )
    moved = Result("dynamics", "evaluated", "modes", {}, design=untyped(design), scene="dynamics")
    assert decided(moved) == (
        "The mean load deforms the mesh by 15 µm; the dynamic factor is up to 2.5, at 3,000 rpm."
    )


def test_one_motion_is_told_of_rising_speed():
    """Digits beyond those shown do not make a second motion; 1,000 rpm is an end of the range."""
    rms, falling = (0.04, *FOUND.rms_mm[1:]), (0.0400001, *FOUND.rms_mm[1:])
    worst = told(replace(FOUND, rms_mm=rms, falling_rms_mm=falling)).words[0]
    assert "is largest at 1,000 rpm, an end of the range: 40" in worst and "falls" not in worst


def test_teeth_with_errors_are_told_by_their_dynamic_transmission_error():
    errors = DynamicErrors(
        rms_mm=(0.003, 0.001, 0.001, 0.001, None),
        peak_to_peak_mm=(0.009, 0.002, 0.002, 0.002, None),
        highest_mm=(0.021, 0.016, 0.016, 0.016, None),
    )
    loads = tuple((4000.0 + k, 3000.0, 3000.0, 3000.0, None) for k in range(3))
    rows = dict.fromkeys(("errors", "dynamic_factor"), errors.rms_mm) | {"loads_N": loads}
    section = told(replace(FOUND, transmission_error=errors, falling_rms_mm=(), **rows))
    assert section.words[0] == (
        "The RMS of the dynamic transmission error about its mean is largest at 1,000 rpm, an end "
        "of the range: 3 µm, peak to peak 9 µm, maximum 21 µm; the tooth load is up to 4,000 N."
    )
    assert section.figures[0].data[0]["y"] == [3.0, 1.0, 1.0, 1.0, None]
    table = section.tables[0]
    assert table.heads[1] == "dynamic transmission error, RMS about the mean [µm]"
    assert len(table.heads) == len(table.rows[0])


def test_a_plot_over_speed_has_gaps_marks_and_the_unstable_range():
    figure, waterfall = told(FOUND).figures
    rising, falling, marks = figure.data
    assert rising["y"] == [1.0, 2.0, 3.0, 20.0, None] and falling["y"][-1] == 10.0
    assert list(zip(marks["x"], marks["y"], strict=True)) == [(3000.0, 30.0), (4000.0, 20.0)]
    (band,) = figure.layout["shapes"]
    assert (band["x0"], band["x1"]) == (4500.0, 5500.0) and "Shaded" in figure.caption
    assert [row[-1] for row in waterfall.data[0]["z"]] == [None, None]
    assert waterfall.data[0]["z"][0][0] == np.log10(2.0)


def test_without_backlash_one_curve_is_told():
    none = dict.fromkeys(("falling_rms_mm", "falling_peak_to_peak_mm", "falling_highest_mm"), ())
    alone = {**FOUND.__dict__, **none, "falling_repeats": (), "teeth_part": False}
    section = told(Speeds(**alone))
    assert len(section.words) == 1 and len(section.tables[0].heads) == 5
    assert "4,000 rpm: 20 µm" in section.words[0]
    assert len(section.figures[0].data) == 2  # the curve, and where it takes two periods


def test_axes_move_on_the_page_as_they_did():
    turn = np.linspace(0.0, 4.0 * np.pi, 801)
    axes = tuple(
        tuple(0.01 * k * f(turn)) for k, f in ((1, np.cos), (2, np.sin), (3, np.sin), (4, np.cos))
    )
    found = Response(
        method="rk8",
        error=1e-9,
        error_asked=1e-6,
        met=True,
        steps=1,
        separations=0,
        rms_mm=0.0,
        peak_to_peak_mm=0.0,
        highest_mm=0.0,
        time_ms=tuple(np.linspace(0.0, 20.0, 801)),
        deformation_mm=tuple(np.sin(turn)),
        axes_mm=axes,
        frequency_Hz=(0.0, 1000.0),
        amplitude_mm=(0.0, 1e-3),
    )
    made = dynamics_plots.orbit(found, METRIC)
    later = 2.0 * np.pi + np.pi * np.asarray(made.marks - 10.0) / 5.0
    for view, a, b in zip(made.views, (0, 2), (1, 3), strict=True):
        (dot,) = view.front
        places = np.asarray(dot.places)
        scale = 0.01 * np.array([a + 1, b + 1])
        law = (np.cos, np.sin) if a == 0 else (np.sin, np.cos)
        assert np.allclose(places[:, :2], np.stack([f(later) for f in law], axis=1) * scale)
    marked = [dynamics_plots.spectrum(found, f, METRIC) for f in (300.0, 1e-8, 0.0)]
    assert [len(plot.layout["shapes"]) for plot in marked] == [3, 0, 0]
    assert ["multiples" in plot.caption for plot in marked] == [True, False, False]


def test_the_least_vibration_names_its_measure_its_sign_and_the_curves_that_are_drawn():
    best = Chosen(
        **dict.fromkeys(("bearing_stiffness_N_per_mm", "contact_ratio", "ramp"), 1.0),
        **dict.fromkeys(("face_width_mm", "rim", "mass_kg", "displacement_mm"), 1.0),
        **{"dense_maximum_mm": 0.0051, "highest_mm": -0.003429, "largest_multiplier": None},
        **{"harmonics": 3, "speed_rpm": (1e3,), "rounds": (), "dense_rpm": (1e3, 2e3)},
        **{"dense_mm": (0.005, 0.0051), "before_mm": (None, None)},
        **{"parting_speeds": 0, "longest_repeat": 1},
    )
    design = DynamicsDesign(
        kinematics="exact", axes="line", mesh_frequency_Hz=0.0, equilibrium=REST, chosen=best
    )
    found = Result("dynamics", "limit", "screened", {"name": "rms"}, design=untyped(design))
    section = chosen(found, METRIC)
    rows = dict(section.tables[0].rows)
    assert rows["highest deformation δ, negative in compression [µm]"].text == "-3.429"
    assert rows["largest RMS of the deformation about its mean, over all speeds [µm]"].text == "5.1"
    assert binding_limit(found).startswith("the objective is the largest value at 1 speed; ")
    told = replace(found, objective=found.objective | {"value": 0.005}, report=PRICES)
    assert (
        prices(told, METRIC)
        .words[-1]
        .endswith("not used: those of the answer follow from its sizes.")
    )
    (figure,) = section.figures
    assert [t["name"] for t in figure.data] == ["least vibration", "speeds of the problem"]
    assert "over speed, of the pair of least vibration; only" in figure.caption
    figure = dynamics_plots.before_and_after(replace(best, before_mm=(0.01, None)), "RMS", METRIC)
    assert len(figure.data) == 3 and "of the pair of the file and of that of" in figure.caption

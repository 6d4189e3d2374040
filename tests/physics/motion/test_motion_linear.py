"""Static states and natural frequencies, to the digits of an independent computation.

Numbers in mm, N, Hz: an independent program in SI units, with scipy's eigenvalues.
"""

import math

import numpy as np
import pytest
from moving_pairs import paper_pair

from gearopt.physics.motion.linear import linear, mesh_shares, modes, static

STATIC = {  # x1, y1 [mm], pressure angle under load [deg], reaction over load
    "tangent": (-0.6035649588100036, -1.6582810955045443, 21.26500822598379, 1.0),
    "exact": (-0.6035649588100037, -1.6582810955045445, 21.26500822598379, 1.0),
    "paper": (-3.916794335596579, 0.0, 26.778881728435824, 2.2195167901713946),
}
UNLOADED = [135.73408477135146, 167.76404034828968, 188.34911695564318, 205.46814802, 5595.84226347]
FREQUENCIES = {  # kinematics, at the static load
    ("tangent", False): UNLOADED,
    ("exact", False): UNLOADED,
    ("exact", True): [135.734084771, 164.749110169, 188.349116956, 202.338164230, 5595.84226347],
    ("paper", False): [66.1748024913, 167.764040348, 184.325376564, 205.468148020, 11728.4383083],
    ("paper", True): [90.9979890376, 165.493205681, 184.781029336, 203.018544024, 9305.03091690],
}
MESHES = {  # kinematics, at the static load, k_m [N/mm]: the mesh mode [Hz]
    ("tangent", False, 1e5): 3957.899442239906,
    ("exact", True, 1e5): 3957.8994422399082,
    ("paper", False, 1e5): 8294.22313639085,
    ("paper", True, 1e5): 6580.9743004417505,
    ("tangent", False, 4e5): 7912.675453855066,
    ("exact", True, 4e5): 7912.675453855068,
    ("paper", False, 4e5): 16585.551622882307,
    ("paper", True, 4e5): 13157.977104661166,
}
BEARINGS = {  # k_b [N/mm]: Hz
    1e4: [428.388939911, 530.516476973, 595.363483151, 649.747334361, 5609.15612246],
    1e5: [1327.23493988, 1677.64040348, 1874.72812683, 2054.68148020, 5749.52372023],
    1e6: [3287.71446922, 5305.16476973, 5690.91395413, 6497.47334361, 7646.13319637],
}


@pytest.mark.parametrize("kind", list(STATIC))
def test_static_states(kind):
    x, y, angle, reaction = STATIC[kind]
    pair = paper_pair(kind)
    found = static(pair)
    assert found.load == pytest.approx(30000.0 / 17.0, rel=1e-14)  # 1764.7 N
    assert found.delta == pytest.approx(-8.823529411764707e-3, rel=1e-14)
    assert found.axes == pytest.approx([x, y, -x, -y], rel=1e-12, abs=1e-12)
    distance = math.hypot(pair.rest.centre_distance + found.apart[0], found.apart[1])
    assert math.degrees(math.acos(140.0 / distance)) == pytest.approx(angle, abs=1e-11)
    held = 1e3 * math.hypot(*found.axes[:2])
    assert held / found.load == pytest.approx(reaction, rel=1e-12)


@pytest.mark.parametrize(("kind", "loaded"), list(FREQUENCIES))
def test_natural_frequencies(kind, loaded):
    pair = paper_pair(kind)
    system = linear(pair, "plane", static(pair) if loaded else None)
    assert modes(system, 2e5).hertz == pytest.approx(FREQUENCIES[kind, loaded], rel=1e-9)


@pytest.mark.parametrize(("kind", "loaded", "mesh"), list(MESHES))
def test_mesh_modes_over_the_stiffness(kind, loaded, mesh):
    pair = paper_pair(kind, k=mesh)
    system = linear(pair, "plane", static(pair) if loaded else None)
    assert modes(system, mesh).hertz[-1] == pytest.approx(MESHES[kind, loaded, mesh], rel=1e-10)


@pytest.mark.parametrize("held", list(BEARINGS))
def test_natural_frequencies_over_the_bearings(held):
    found = modes(linear(paper_pair(kx=held), "plane"), 2e5).hertz
    assert found == pytest.approx(BEARINGS[held], rel=1e-9)


def test_limits_are_closed_forms():
    fixed = math.sqrt(2e5 * 3400.0) / (2 * math.pi)  # 1/m_e = 60^2/2 + 80^2/4
    assert fixed == pytest.approx(4150.25, abs=5e-3)
    assert modes(linear(paper_pair(), "fixed"), 2e5).hertz == pytest.approx([fixed], rel=1e-13)
    held = modes(linear(paper_pair(kx=1e9), "plane"), 2e5).hertz
    known = [4149.422926391813, 167764.04034829015, 167780.81610880714, 205468.1480204999]
    assert held[:4] == pytest.approx(known, rel=1e-9)
    free = math.sqrt(2e5 * (3400.0 + 1 / 6e-4 + 1 / 9e-4)) / (2 * math.pi)
    assert free == pytest.approx(5594.371084955733, rel=1e-12)
    assert modes(linear(paper_pair(kx=1e-6), "line"), 2e5).hertz[-1] == pytest.approx(free)
    steep = (1 / 6e-4 + 1 / 9e-4) / math.sin(math.radians(20.0)) ** 2  # of the paper's gradient
    steeper = math.sqrt(2e5 * (3400.0 + steep)) / (2 * math.pi)
    assert steeper == pytest.approx(11727.073725687049, rel=1e-12)
    found = modes(linear(paper_pair("paper", kx=1e-6), "plane"), 2e5).hertz[-1]
    assert found == pytest.approx(steeper, rel=1e-9)
    axes = [math.sqrt(1e3 / m) / (2 * math.pi) for m in (9e-4, 6e-4)]
    assert axes == pytest.approx([167.7640403482901, 205.46814802049994], rel=1e-12)
    line = modes(linear(paper_pair(), "line"), 2e5).hertz
    assert line == pytest.approx([UNLOADED[0], UNLOADED[2], UNLOADED[4]], rel=1e-11)


LOADS = {  # kinematics, torque [N mm], balanced: k_perp [N/mm], the lowest frequency [Hz]
    ("exact", 2e5): (442.15222587802506, 135.73408477134345),
    ("exact", 1e6): (302.26798494076283, 135.73408477134888),
    ("exact", 5e6): (117.07390762165393, 88.3966265034238),
    ("exact", 5e7): (14.83324560931488, 31.63424904523355),
    ("paper", 2e5): (459.2931717660205, 101.03304959754574),
    ("paper", 1e6): (379.1145209803894, 126.64465642860841),
    ("paper", 5e6): (223.89689235367958, 121.13139456666248),
    ("paper", 5e7): (40.91639780968957, 52.478740341066135),
}


@pytest.mark.parametrize(("kind", "torque"), list(LOADS))
def test_load_softens_the_axes_across_the_line_of_action_and_never_buckles_them(kind, torque):
    """k_perp = k_b/2 - F/(Z_0 + 2 F/k_b), in the paper's form (k_b/2) C_0/C; both are above 0."""
    pair, load = paper_pair(kind, torques=(torque, torque * 8 / 6)), torque / 60.0
    state = static(pair)
    if kind == "exact":
        across = 500.0 - load / (140.0 * math.tan(math.radians(20.0)) + 2 * load / 1e3)
    else:
        centre = 140.0 / math.cos(math.radians(20.0))
        across = 500.0 * centre / math.hypot(centre + state.apart[0], state.apart[1])
    known, lowest = LOADS[kind, torque]
    assert across == pytest.approx(known, rel=1e-12) and across > 0.0
    g = 500.0 - across  # F/Z, the tangent grown by the load
    masses = np.diag([6e-4, 9e-4])
    squares = np.linalg.eigvals(np.linalg.solve(masses, [[1e3 - g, g], [g, 1e3 - g]])).real
    found = modes(linear(pair, "plane", state), 2e5)
    for square in squares:
        assert np.min(np.abs(found.frequencies**2 / square - 1.0)) < 1e-9
    assert found.hertz[0] == pytest.approx(lowest, rel=1e-9)


def test_of_equal_masses_three_frequencies_are_one():
    """Their shapes are any basis: the space they span is compared."""
    pair = paper_pair(masses=(7.5e-4, 7.5e-4))
    system = linear(pair, "plane")
    found = modes(system, 2e5)
    single = math.sqrt(1e3 / 7.5e-4) / (2 * math.pi)
    assert single == pytest.approx(183.776, abs=5e-4)
    assert found.hertz[1:4] == pytest.approx([single] * 3, rel=1e-9)
    assert found.hertz[[0, 4]] == pytest.approx([137.54631610658546, 5545.173316526311], rel=1e-10)
    sine, cosine = math.sin(pair.pressure_angle), math.cos(pair.pressure_angle)
    known = np.array(
        [[cosine, -sine, 0, 0, 0], [0, 0, 0, cosine, -sine], [sine, cosine, 0, sine, cosine]]
    )
    left = np.linalg.lstsq(found.shapes[:, 1:4], known.T, rcond=None)[0]
    assert found.shapes[:, 1:4] @ left == pytest.approx(known.T, abs=1e-9)
    assert mesh_shares(system, 2e5)[1:4] == pytest.approx([0.0] * 3, abs=1e-12)


def test_line_modes_avoid_each_other():
    """The smallest gap of the upper two, over the bearings: 1907.926 Hz at 1.33352e6 N/mm."""
    found = modes(linear(paper_pair(kx=1.333521432163324e6), "line"), 2e5).hertz
    assert found == pytest.approx([3490.81839378, 6499.90266878, 8407.82884290], rel=1e-9)
    for near in (1.32e6, 1.35e6):
        other = modes(linear(paper_pair(kx=near), "line"), 2e5).hertz
        assert other[2] - other[1] > found[2] - found[1] == pytest.approx(1907.926174, abs=1e-5)

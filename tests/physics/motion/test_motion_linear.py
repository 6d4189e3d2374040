"""Static states and natural frequencies, to the digits of an independent computation.

Numbers in mm, N, Hz: an independent program in SI units, with scipy's eigenvalues.
"""

import math

import pytest
from moving_pairs import paper_pair

from gearopt.physics.motion.linear import linear, modes, static

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

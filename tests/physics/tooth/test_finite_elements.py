"""Finite elements of gears: rings in closed form, another program's gears, halved elements."""

import sys
from dataclasses import replace

import numpy as np
import pytest
from reference_pairs import elastic, five, force, stiffness
from test_ladder import ELEMENTS

from gearopt.physics.gears import GearPair, Rack
from gearopt.physics.tooth import finite_elements
from gearopt.physics.tooth.elastic import ElasticPair
from gearopt.physics.tooth.finite_elements import (
    coupling,
    factorised,
    pair_compliance,
)
from gearopt.physics.tooth.foundation import sainsot_compliance, torsion_compliance
from gearopt.physics.tooth.hertz import half_width
from gearopt.physics.tooth.ladder import COUPLINGS, profile_compliance
from gearopt.physics.tooth.mesh import Fineness, gear_mesh, joined, ring_block

INNER, OUTER = 15.0, 33.75  # mm, of the pinion's ring


def compliance_matrix(elastic, position, force):
    """C (n, n) [mm/N] of all n pairs of teeth that touch with one pair at a position, in order."""
    path = elastic.path
    first = np.ceil((path.start - position) / path.base_pitch - 1e-9)
    last = np.floor((path.end - position) / path.base_pitch + 1e-9)
    places = position + np.arange(first, last + 1.0) * path.base_pitch
    return finite_elements._matrix(elastic, places, force)


@pytest.fixture(scope="module", params=["stress", "strain"])
def ring(request):
    """A ring of the mesh's own blocks, held at its bore, and how it is solved."""
    member = elastic("reference", request.param).members[0]
    line = np.pi * np.linspace(-1.0, 1.0, 65), np.full(65, OUTER)
    made = joined([ring_block(line, 0.0, np.pi, 2.0 * INNER, np.linspace(0.0, 1.0, 9))], {}, 1e-6)
    return member, *factorised(member, made)


def _loaded(ring, directions):
    """Displacements (2, N) of the outer points under 1 N/mm, spread evenly in such directions."""
    _, basis, solve = ring
    x, y = basis.doflocs
    at = np.flatnonzero(np.hypot(x, y) > OUTER * (1.0 - 2e-3))
    corner = np.isin(at, basis.nodal_dofs)
    weight = np.where(corner, 1.0, 2.0)  # Simpson's rule on edges of equal length
    angle = np.arctan2(y[at], x[at])
    even = np.isin(at, np.concatenate((basis.nodal_dofs[0], basis.facet_dofs[0])))
    share = 2.0 * weight / weight.sum() * directions(angle, even)
    forces = np.zeros((int(basis.N), 1))
    forces[at, 0] = share
    found = solve(forces)[at, 0]
    return (found * directions(angle, even))[corner].reshape(-1), angle[corner], even[corner]


def test_a_ring_in_torsion_turns_as_in_closed_form(ring):
    """A force of 1 N/mm in all along the circle: u = r_f T/(4 pi G) (1/r_i^2 - 1/r_f^2)."""
    member = ring[0]
    u, _, is_x = _loaded(ring, lambda a, x: np.where(x, -np.sin(a), np.cos(a)))
    moved = u[is_x].sum() / is_x.sum() + u[~is_x].sum() / is_x.sum()
    known = torsion_compliance(member) * member.gear.face_width
    known *= (OUTER / member.base_radius) ** 2
    assert moved == pytest.approx(known, rel=4e-3)


def test_a_ring_under_pressure_shrinks_as_in_closed_form(ring):
    """Lame: u = A r + B/r with u(r_i) = 0; plane stress and plane strain differ."""
    member = ring[0]
    u, _, is_x = _loaded(ring, lambda a, x: np.where(x, np.cos(a), np.sin(a)))
    moved = u[is_x].sum() / is_x.sum() + u[~is_x].sum() / is_x.sum()
    nu, modulus = member.lateral, member.modulus / member.plane_factor
    ratio = (INNER / OUTER) ** 2
    pressure = 1.0 / (2.0 * np.pi * OUTER)
    strain = pressure * (1.0 - nu**2) / modulus / (1.0 + nu + (1.0 - nu) * ratio)
    assert moved == pytest.approx(strain * OUTER * (1.0 - ratio), rel=4e-3)


def test_the_area_of_the_mesh_is_that_of_the_section():
    """Of the pinion: pi (r_f^2 - r_i^2) and, of the five meshed teeth, what is above r_f."""
    from gearopt.physics.geometry.fillet import profile

    gear = elastic("reference").members[0].gear
    made = gear_mesh(gear, 30.0, Fineness(0.1, 36.0, 40.0, halvings=1))
    x, y = made.points[:, made.quads]
    area = 0.5 * (x * np.roll(y, -1, axis=0) - np.roll(x, -1, axis=0) * y).sum()
    across, up = profile(gear, 4000, 4000)
    angle, radius = np.arctan2(across, up), np.hypot(across, up)
    tooth = 2.0 * np.trapezoid(angle * radius, radius)
    assert area == pytest.approx(np.pi * (OUTER**2 - 15.0**2) + 5.0 * tooth, rel=1e-3)
    assert len(made.flanks) == 5


def test_a_wide_contact_is_that_of_another_program_but_for_a_logarithm():
    """Of 50 times the load, whose contact is sqrt(50) times as wide: coarser elements suffice."""
    pair = elastic("second")
    found = pair_compliance(pair, five(pair)[1:4], 50.0 * force("second"))
    soft = sum(m.plane_factor / (np.pi * m.rigidity) for m in pair.members)
    known = ELEMENTS["second", "strain"][1:4]
    assert stiffness(found + soft * np.log(50.0), pair) == pytest.approx(known, rel=2e-3)


def test_without_scikit_fem_the_extra_is_named(monkeypatch):
    monkeypatch.setitem(sys.modules, "skfem", None)
    finite_elements.body.cache_clear()
    with pytest.raises(ImportError, match=r"pip install 'gearopt\[fem\]'"):
        pair_compliance(elastic("second"), 0.0, 1e6)


@pytest.mark.slow
@pytest.mark.parametrize(("name", "plane"), ELEMENTS)
def test_two_programs_agree(name, plane):
    """That halved elements change nothing, the bench of stiffness says of the same pairs."""
    pair = elastic(name, plane)
    found = stiffness(pair_compliance(pair, five(pair), force(name)), pair)
    finite_elements.body.cache_clear()
    assert found == pytest.approx(ELEMENTS[name, plane], rel=1e-3)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "both_sides", "next_pair"),
    [
        ("reference", (4.44468, 4.46420, 4.44093), 4.53),
        ("second", (5.78601, 5.83385, 5.80229), 6.01),
    ],
)
def test_coupling_of_neighbours(name, both_sides, next_pair):
    """Micrometres at F_n at three places of double contact.

    both_sides: of another program, the mean of the tooth that carries the neighbouring pair and of
    the tooth on the other side; the former moves by 1.6 and 3 % more.
    """
    pair, load = elastic(name), force(name)
    path = pair.path
    middle = 0.5 * (path.start + path.lowest_single)
    places = path.start + 0.15, middle, path.lowest_single - 0.05
    found, means = [], []
    for at in places:
        matrix = compliance_matrix(pair, at, load)
        assert matrix[0, 1] == pytest.approx(matrix[1, 0], rel=1e-3)  # reciprocity
        found.append(1e3 * load * matrix[0, 1])
        means.append(1e3 * load * _mean_of_sides(pair, load, at))
    assert found == pytest.approx([next_pair] * 3, rel=7e-3)
    assert max(found) / min(found) < 1.0075
    assert means == pytest.approx(both_sides, rel=5e-3)
    assert 1e3 * load * coupling(pair) == pytest.approx(found[1], rel=1e-3)
    assert COUPLINGS["ring torsion"](pair) < 0.5 * coupling(pair)


def _mean_of_sides(pair, load, at):
    """c12, as if the next pair were on the tooth after or before the loaded one."""
    total, path = 0.0, pair.path
    here, far = (path.radii_of_curvature(np.array([s])) for s in (at, at + path.base_pitch))
    for each, near, next_ in zip(finite_elements.bodies(pair, load), here, far, strict=True):
        under = each.pressed(near, half_width(pair, np.array([at]), load))
        total += 0.5 * sum(each.moved(under, tooth, next_)[0] for tooth in (1, -1))
    return total / pair.pair.face_width


@pytest.mark.slow
def test_three_pairs_in_contact():
    """A contact ratio of 2.15: neighbours are coupled more than those two teeth apart."""
    tall = GearPair.of_teeth(
        3.0, 40, 50, 30.0, rack=Rack(addendum=1.3, dedendum=1.6, tip_radius=0.2)
    )
    pair = ElasticPair(tall, (40.0, 50.0))
    assert pair.path.transverse_ratio > 2.0
    matrix = compliance_matrix(pair, pair.path.start + 0.05, 5000.0)
    assert matrix.shape == (3, 3)
    assert matrix == pytest.approx(matrix.T, rel=2e-3)
    assert np.linalg.eigvalsh(0.5 * (matrix + matrix.T)).min() > 0.0
    assert COUPLINGS["ring torsion"](pair) < matrix[0, 2] < matrix[0, 1] < matrix[0, 0]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("place", "stiff", "share"),
    [("near A", 17.527, 0.3994), ("middle", 18.092, 0.4904), ("near B", 17.550, 0.5909)],
)
def test_the_mesh_in_double_contact(place, stiff, share):
    """Dense stiffness N/(mm um) and share of the first pair, of another program with its c12."""
    pair = elastic("reference")
    path = pair.path
    at = {
        "near A": path.start + 0.15,
        "middle": 0.5 * (path.start + path.lowest_single),
        "near B": path.lowest_single - 0.05,
    }[place]
    inverse = np.linalg.inv(compliance_matrix(pair, at, force("reference")))
    total = inverse.sum()
    assert 1e-3 * total / 30.0 == pytest.approx(stiff, rel=6e-3)
    assert inverse.sum(axis=1)[0] / total == pytest.approx(share, abs=3e-3)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("ratio", "error"), [(1.15, -23.2), (1.4, -13.1), (2.25, -5.5), (4.0, -1.7), (7.0, 3.3)]
)
def test_sainsots_body_over_bore_ratios(ratio, error):
    """Of the pinion alone at the pitch point, plane stress: per cent of stiffness.

    Another program has -23.2, -13.0, -5.4, -1.7 and +3.4.
    """
    pair = elastic("reference", "stress")
    member = replace(pair.members[0], bore=2.0 * OUTER / ratio)
    load, s = force("reference"), np.array([0.0])
    curvature, wide = pair.path.curvatures[0] + s, half_width(pair, s, load)
    size = float(wide[0]) / 3.0
    body = finite_elements.body(member, Fineness(size, 37.0, 38.0))
    known = body.moved(body.pressed(curvature, wide), 0, curvature) / 30.0
    line = member.load_line(curvature)
    contact = (2.0 * np.log(2.0 * line.depth / wide) - 0.3) / (np.pi * member.rigidity)
    made = profile_compliance(member, line) + sainsot_compliance(member, line) + contact
    assert 100.0 * float((known / made)[0] - 1.0) == pytest.approx(error, abs=0.1)


@pytest.mark.slow
def test_neighbours_of_pairs_that_more_than_three_share():
    """A contact ratio above 3: c12 falls a little with the length of teeth, of the same rings."""
    usual, long_ = (
        ElasticPair(
            GearPair.of_teeth(
                2.0, 80, 120, 20.0, rack=Rack(addendum=a, dedendum=a + 0.2, tip_radius=0.1)
            ),
            (50.0, 50.0),
        )
        for a in (1.0, 1.7)
    )
    assert long_.path.transverse_ratio > 3.0
    assert coupling(long_) == pytest.approx(coupling(usual), rel=0.04)

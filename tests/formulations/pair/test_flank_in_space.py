"""Contact in slices against finite elements of whole helical gears in space."""

import numpy as np
import pytest
from flank_pairs import flank, gears, solid
from solid_gears import contact_lines, shared

from gearopt.physics.contact_lines import Face
from gearopt.physics.tooth import mesh as section
from gearopt.physics.tooth import slices

pytest.importorskip("skfem")
STEPS = 8
SLICES = {"12 degrees": 15, "17 degrees": 21, "25 degrees": 19}
# errors of stiffness, peak to peak and load: coupling by finite elements, by ring torsion, and by
# finite elements where slices do not hold each other
MEASURED = {
    "12 degrees": (0.012, 0.104, 0.076, 0.099, 0.370, 0.070, -0.003, 0.235, 0.144),
    "17 degrees": (-0.038, 0.078, 0.085, 0.031, 0.351, 0.078, -0.059, 0.116, 0.154),
    "25 degrees": (0.015, -0.032, 0.091, 0.073, 0.252, 0.088, -0.019, -0.037, 0.174),
}


@pytest.fixture
def coarse(monkeypatch):
    """Sections of about a thousand points."""
    for name, value in {"COARSE_ELEMENT": 0.6, "ROOT": 0.12, "RADIAL": 0.5, "GROWTH": 1.6}.items():
        monkeypatch.setattr(section, name, value)


def elements(name):
    """Contact lines by finite elements at some travels, loads shared: (line, forces, approach)."""
    pair, _, force = gears(name)
    module, face = float(pair.normal_module), Face.of(pair, SLICES[name])
    travels = np.arange(STEPS) / STEPS
    lines = contact_lines(solid(name), face, force, travels, 0.08 * module, 0.11 * module)
    return [(line, *shared(line.compliances, force)) for line in lines]


def errors(name, known, coupling):
    """Errors of stiffness, peak to peak and load along the lines, of slices."""
    mesh = flank(name, SLICES[name], coupling, steps=STEPS)
    approaches, off, mean = [], [], []
    for line, forces, approach in known:
        at = int(np.flatnonzero(np.isclose(mesh.cycle.travels, line.travel, atol=1e-9))[0])
        approaches.append((approach, mesh.sharing.approach[0, at]))
        own = mesh.sharing.forces[0, at][line.pairs, line.slices]
        off.append((own - forces) / np.sqrt(line.lengths))
        mean.append(forces)
    elements, found = np.array(approaches).T
    stiff = (1.0 / found).mean() / (1.0 / elements).mean() - 1.0
    whole = np.concatenate([line.lengths for line, _, _ in known]).sum()
    rms = np.sqrt(np.square(np.concatenate(off)).sum() / whole)
    return (
        float(stiff),
        float(np.ptp(found) / np.ptp(elements) - 1.0),
        float(rms / (np.concatenate(mean).sum() / whole)),
    )


@pytest.mark.slow
@pytest.mark.campaign
@pytest.mark.parametrize("name", list(SLICES))
def test_slices_agree_with_finite_elements_in_space(coarse, monkeypatch, name):
    """Mean stiffness within 8 %, peak to peak 15 %, load along the lines 10 % rms; as printed.

    Slices that do not hold each other are farther off: coupling across the face is seen. The first
    pair takes 35 s, all three 250 s: it has the fewest slices and elements, passes the same models
    of section, body and lines, and its errors are held to 0.002 like the others'. A sample of slow
    tests has it alone.
    """
    known = elements(name)
    found = errors(name, known, "finite elements")
    ring = errors(name, known, "ring torsion")
    monkeypatch.setattr(slices, "HOLD", 0.0)
    apart = errors(name, known, "finite elements")
    assert abs(found[0]) < 0.08 and abs(found[1]) < 0.15 and found[2] < 0.10
    assert apart[2] > 1.5 * found[2]
    assert [*found, *ring, *apart] == pytest.approx(MEASURED[name], abs=0.002)

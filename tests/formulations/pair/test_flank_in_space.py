"""Contact in slices against finite elements of whole helical gears in space."""

import numpy as np
import pytest
from flank_pairs import flank, gears, solid
from solid_gears import contact_lines, plane_widths, shared

from gearopt.physics.tooth import mesh as section

pytest.importorskip("skfem")
STEPS = 6
PLANES = {"12 degrees": 15, "17 degrees": 21, "25 degrees": 19}
# stiffness and peak to peak relative to the elements, load along the lines rms over its mean
MEASURED = {
    "12 degrees": (0.0, 0.0, 0.0),
    "17 degrees": (0.0, 0.0, 0.0),
    "25 degrees": (0.0, 0.0, 0.0),
}


@pytest.fixture
def coarse(monkeypatch):
    """Sections of about a thousand points."""
    for name, value in {"COARSE_ELEMENT": 0.6, "ROOT": 0.12, "RADIAL": 0.5, "GROWTH": 1.6}.items():
        monkeypatch.setattr(section, name, value)


def compared(name, slices, coupling):
    """Errors of stiffness, peak to peak and load, of slices against finite elements."""
    pair, _, force = gears(name)
    width, module = float(pair.face_width), float(pair.normal_module)
    planes = np.linspace(-0.5 * width, 0.5 * width, PLANES[name])
    travels = np.arange(STEPS) / STEPS
    lines = contact_lines(solid(name), force, planes, travels, 0.08 * module, 0.11 * module)
    mesh = flank(name, slices, coupling, steps=STEPS)
    widths, errors, off, mean = plane_widths(planes), [], [], []
    part, _ = mesh.face.parts(mesh.sliced.path, mesh.cycle.positions)
    for line in lines:
        at = int(np.flatnonzero(np.isclose(mesh.cycle.travels, line.travel, atol=1e-9))[0])
        forces, approach = shared(line.compliances, force)
        errors.append((approach, mesh.sharing.approach[0, at]))
        for k in np.unique(line.pairs):
            some = line.pairs == k
            j = line.planes[some]
            there = part[at, k] > 0.3
            own = mesh.sharing.forces[0, at, k][there] / part[at, k][there] / mesh.face.slice_width
            model = np.interp(planes[j], mesh.face.places[there], own)
            off += list(model - forces[some] / widths[j])
            mean += list(forces[some] / widths[j])
    known, found = np.array(errors).T
    stiff = float((1.0 / found).mean() / (1.0 / known).mean() - 1.0)
    return (
        stiff,
        np.ptp(found) / np.ptp(known) - 1.0,
        np.sqrt(np.mean(np.square(off))) / np.mean(mean),
    )


@pytest.mark.slow
@pytest.mark.parametrize("name", list(PLANES))
def test_slices_agree_with_finite_elements_in_space(coarse, name):
    """Mean stiffness within 8 %, peak to peak 15 %, load along the lines 10 % rms; as printed."""
    found = compared(name, 41, "finite elements")
    print(name, found)
    assert abs(found[0]) < 0.08 and abs(found[1]) < 0.15 and found[2] < 0.10
    assert found == pytest.approx(MEASURED[name], abs=0.005)

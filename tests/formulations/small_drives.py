"""Small drives of every kind of face width, for the parts of the exact search."""

from fractions import Fraction

from gearopt.formulations.drive.teeth.tables import table
from gearopt.formulations.drive.toothing import Toothing
from gearopt.formulations.drive.train import FaceWidth, Stage, Train
from gearopt.formulations.strength.laws.k_factor import K_FACTOR

F = Fraction
FACES = {
    "tied": FaceWidth(F(3, 5), F(3, 5)),
    "free": FaceWidth(F(1, 5), F(3, 5)),
    "open": FaceWidth(F(0), F(3, 5)),
    "stepped": FaceWidth(F(1, 5), F(3, 5), step=F(2)),
    "fixed": FaceWidth(F(1, 5), F(4, 5), fixed=F(24)),
    "fixed alone": FaceWidth(F(0), None, fixed=F(24)),
}
LIMITED = {  # by the module and at least so wide
    "free": FaceWidth(F(1, 5), F(3, 5), over_module=(F(8), F(10)), least=F(14)),
    "tied": FaceWidth(F(3, 5), F(3, 5), over_module=(F(9), F(11)), least=F(15)),
    "stepped": FaceWidth(F(1, 2), F(3, 5), F(2), None, (F(9), F(10)), F(20)),
    "fixed": FaceWidth(F(0), F(1), None, F(24), (F(12), F(16)), F(24)),
}
OBJECTIVES = ("gear_volume", "mass", "sum_of_centre_distances", "total_length")


def drive(stages=2, face="tied", total=12, tolerance=None, **changes):
    face = FACES[face] if isinstance(face, str) else face
    toothing = Toothing(changes.pop("helix_angle", 0.0))
    given = {"modules": (F(1), F(3, 2), F(2), F(3)), "pinion_teeth": (15, 20)}
    of_train = {k: changes.pop(k) for k in ("objective", "coprime") if k in changes}
    made = tuple(
        Stage((1.5 + 0.2 * k, 40.0 + k), face, toothings=(toothing,), **given | changes)
        for k in range(stages)
    )
    tolerance = F(1, 50) if tolerance is None else tolerance
    return Train(2e4, F(total), tolerance, made, density=7.85e-9, law=K_FACTOR, **of_train)


def tables_of(train):
    return [table(train, k, train.highest_ratio) for k in range(len(train.stages))]

"""Whether a point is stationary, and whether it is a local minimum: conditions of both orders.

First order, in the form's variables: no variable promises a decrease, by its slope over its own
scale, that is more than STATIONARY of what acts on it: the gradients of the objective and of the
limits, which cancel in a solution, and the curvature. Neither a unit nor a factor of the objective
changes that.

Second order, and a look further: the Lagrangian must not fall along any direction that the limits
which hold leave free. Its Hessian is reduced to the directions along limits and bounds with a
price; those that hold without a price block one side of a direction. Directions without curvature
are followed for some steps, on the curve along which the limits go on to hold and the Lagrangian is
least across the direction.
"""

from typing import Any

import numpy as np

from gearopt.frozen import dataclass
from gearopt.optimise.form import Form
from gearopt.optimise.kinks import kink, probed
from gearopt.optimise.problem import Problem
from gearopt.optimise.quadratic import dense
from gearopt.optimise.scale import sizes
from gearopt.optimise.terms import Array

ACTIVE_WITHIN = 1e-6  # a row this close to its limit, a variable this close to its bound, is active
STATIONARY = 1e-6  # of what acts on a variable; of the objective itself where the form is convex
WEAK = 1e-8  # of the variable that is acted on most: less is rounding of the multipliers
WEAK_WITHOUT_MULTIPLIERS = 1e-14  # the same without multipliers


@dataclass(frozen=True)
class Point:
    """A point of a form with multipliers, and the derivatives there.

    low, high: bounds of y. f, g, h: values of the form. gradient: of the Lagrangian. pull (n,): the
    sizes of the slopes that are added up in it.
    """

    problem: Problem
    shape: Form
    y: Array
    low: Array
    high: Array
    lam_g: Array
    lam_h: Array
    f: float
    g: Array
    h: Array
    gradient_f: Array
    gradient: Array
    pull: Array


def evaluated(
    problem: Problem, shape: Form, y: Array, low: Array, high: Array, lam_g: Array, lam_h: Array
) -> Point:
    """Evaluate a form and its derivatives at a point with multipliers."""
    import casadi as ca

    p = problem.parameter_values()
    parts = shape.derivatives(y, p, lam_g, lam_h)
    f, g, h, gradient_f, gradient = (np.array(part).ravel() for part in parts)
    pull = np.abs(gradient_f)
    for jacobian, lam in zip(shape.jacobians(y, p), (lam_g, lam_h), strict=True):
        pull = pull + np.array(ca.mtimes(ca.fabs(jacobian).T, np.abs(lam))).ravel()
    given = (problem, shape, y, low, high, lam_g, lam_h)
    return Point(*given, float(f[0]), g, h, gradient_f, gradient, pull)


def residuals(point: Point) -> dict[str, float]:
    """Return stationarity and complementarity of a point, both relative, without units."""
    scales, unit = own_scales(point), acting(point)
    slope = point.gradient
    room = np.clip(np.where(slope > 0.0, point.y - point.low, point.high - point.y), 0.0, scales)
    slack = np.abs(point.lam_g * point.g).max(initial=0.0)
    with np.errstate(divide="ignore", invalid="ignore"):
        promised = np.where(slope == 0.0, 0.0, np.abs(slope) * room / unit)
        held = 0.0 if slack == 0.0 else slack / unit.max()
    return {"stationarity": float(promised.max()), "complementarity": float(held)}


def own_scales(point: Point) -> Array:
    """Return own scale of every y: 1 of a logarithm."""
    natural = sizes(point.problem, point.shape.to_x(point.y))
    return np.where(point.shape.logarithmic, 1.0, natural)


def acting(point: Point) -> Array:
    """Forces on each variable over its own scale (n,): gradients and curvature.

    A logarithm that is proven convex has the unit 1: there a promise bounds the gap.
    """
    if point.shape.convex and point.shape.log_objective:
        return np.ones(len(point.y))
    scales, bend = own_scales(point), np.zeros(len(point.y))
    curved = hessian(point)
    rows, columns = (np.array(k, int) for k in curved.sparsity().get_triplet())
    there = rows == columns
    bend[rows[there]] = np.abs(np.array(curved.nonzeros())[there])
    size = point.pull * scales + 0.5 * bend * scales**2
    held = point.lam_g.any() or point.lam_h.any()
    unit: Array = size + (WEAK if held else WEAK_WITHOUT_MULTIPLIERS) * size.max()
    return unit


def hessian(point: Point) -> Any:
    """Return second derivatives of the Lagrangian, a sparse casadi matrix (n, n)."""
    import casadi as ca

    problem, shape = point.problem, point.shape
    if shape.hessian is not None:  # of rows that are affine
        return shape.hessian(problem.parameter_values())
    key = ("hessian", id(shape))
    if key not in problem.memo:
        y, p, f, g, h = shape.expressions
        lam_g, lam_h = (type(y).sym("lam", rows.numel()) for rows in (g, h))
        lagrangian = f + ca.dot(lam_g, g) + ca.dot(lam_h, h)
        outputs = [ca.hessian(lagrangian, y)[0]]
        problem.memo[key] = ca.Function("hessian", [y, p, lam_g, lam_h], outputs)
    return problem.memo[key](point.y, problem.parameter_values(), point.lam_g, point.lam_h)


FLAT = 1e-6  # of what acts on a direction: curvature below it is none
RANK = 1e-9  # of the largest singular value: a row that depends on others
ALONG = 1e-6  # of a direction's length: less does not leave a limit
FLAT_STEPS = (1e-3, 1e-2, 1e-1)  # of the variables' scale, by which flat directions are followed
BOX = 0.1  # of its box is another scale of a variable: one near zero is small for no reason
NOISE = 1e-12  # of all terms that are added up, in these steps
MAX_FREE = 1000  # variables off their bounds; the reduced Hessian is dense
ROUNDS = 20  # of making the entries of a matrix equal
NO_NUMBER = "its curvature is not a number"
FALLS = "not a minimum: gradients vanish there, but the objective falls along {}"
DOWN = 0.03  # of the own scale: the first step along a direction in which the objective falls
NEWTON = 10  # steps from a straight line to a curve, by the Hessian at the point


@dataclass(frozen=True)
class _Cone:
    """Directions d (k,) of the free variables, in units of `unit`, along the active rows.

    free (n,): which variables have no price on their bound. curved (k, k): Hessian. firm: rows of
    limits with a price and of equalities, loose: of all limits that hold, and of bounds without a
    price; d must meet firm d = 0 and loose d <= 0. priced: which limits are firm. length: of firm
    rows before they were made 1.
    """

    free: Any
    unit: Array
    curved: Array
    firm: Array
    loose: Array
    priced: Any
    length: Array

    def across(self, d: Array) -> Array:
        """Return the Newton step across d that undoes a gradient and an excess of the firm rows.

        (k, k and one for each firm row).
        """
        rows = np.vstack([self.firm, d])
        size, count = len(self.curved), len(rows)
        system = np.block([[self.curved, rows.T], [rows, np.zeros((count, count))]])
        values, vectors = np.linalg.eigh(system)
        some = np.abs(values) > FLAT
        inverse: Array = (vectors[:size, some] / values[some]) @ vectors[:-1, some].T
        return inverse


@dataclass(frozen=True)
class Doubt:
    """Why a stationary point is no local minimum, or is not known to be one; "" where it is one.

    lower: a point (n,) in the problem's own variables, a small step along a direction of descent,
    from which a method may go on; None where none is known.
    """

    words: str = ""
    lower: Array | None = None


def no_minimum(point: Point) -> Doubt:
    """Return why a stationary point may be no local minimum."""
    if point.shape.convex:
        return Doubt()
    name = kink(point.problem, point.shape.to_x(point.y), point.g >= -ACTIVE_WITHIN)
    return _kinked(point, name) if name else _curved(point)


def _curved(point: Point) -> Doubt:
    """Return why the curvature makes a stationary point no minimum; "" where it does not."""
    free = _free(point)
    if free.sum() > MAX_FREE:
        words = f"its curvature was not examined: {free.sum()} variables are off their bounds"
        return Doubt(words)
    cone = _cone(point, free)
    if not np.isfinite(cone.curved).all():
        return Doubt(NO_NUMBER)
    blocked = False
    for value, direction in _eigen(cone.curved, cone.firm):
        for d in (direction, -direction):
            if not (cone.loose @ d <= ALONG).all():
                blocked = blocked or value <= -FLAT
            elif value <= -FLAT or _sinks(point, cone, d):
                return _down(point, cone, d)
    if not blocked:
        return Doubt()
    for value, d in _eigen(cone.curved, np.vstack([cone.firm, cone.loose])):
        if value <= -FLAT:
            return _down(point, cone, d)
    return Doubt("not known to be a minimum: limits are active with Lagrange multipliers of zero")


def _kinked(point: Point, name: str) -> Doubt:
    """Return why a point where a function has a kink may be no minimum: gradients tell nothing."""
    x = point.shape.to_x(point.y)
    along, rising, lower = probed(point.problem, x)
    if along:
        return Doubt(FALLS.format(along), lower)
    if rising and len(x) == 1:
        return Doubt("" if np.isfinite(dense(hessian(point))).all() else NO_NUMBER)
    words = f"{name} has a kink there, where gradients tell nothing"
    return Doubt(f"whether it is a minimum is open: {words}")


def _free(point: Point) -> Any:
    """Return variables that no bound with a price holds, (n,)."""
    scales, slope = own_scales(point), point.gradient
    price = np.abs(slope) * scales > STATIONARY * acting(point)
    low, high = _ends(point)
    return ~((low & high) | (low & price & (slope > 0.0)) | (high & price & (slope < 0.0)))


def _ends(point: Point) -> tuple[Any, Any]:
    """Return which variables sit on their lower, and which on their upper bound."""
    near = ACTIVE_WITHIN * own_scales(point)
    return point.y - point.low <= near, point.high - point.y <= near


def _cone(point: Point, free: Any) -> _Cone:
    """Return the free directions, in units in which the Hessian has entries of up to 1."""
    scales = own_scales(point)
    p = point.problem.parameter_values()
    of_g, of_h = (dense(j) for j in point.shape.jacobians(point.y, p))
    priced = point.lam_g[:, None] * np.abs(of_g) * scales > STATIONARY * acting(point)
    firm = priced.any(axis=1)
    loose = point.g >= -ACTIVE_WITHIN
    low, high = (end[free] for end in _ends(point))
    bounds = np.eye(int(free.sum()))
    curved = dense(hessian(point))[np.ix_(free, free)] * np.outer(scales[free], scales[free])
    size = _equal(curved) + (point.pull * scales)[free]
    size = size + WEAK * size.max(initial=0.0)
    root = np.sqrt(np.where(size > 0.0, size, 1.0))
    unit = scales[free] / root
    held, length = _normal(np.vstack([of_g[firm], of_h])[:, free] * unit)
    sides = np.vstack([_normal(of_g[loose][:, free] * unit)[0], -bounds[low], bounds[high]])
    return _Cone(free, unit, curved / np.outer(root, root), held, sides, firm, length)


def _normal(rows: Array) -> tuple[Array, Array]:
    """Return rows of length 1, and their lengths before."""
    length = np.linalg.norm(rows, axis=1)
    length = np.where(length > 0.0, length, 1.0)
    return rows / length[:, None], length


def _equal(matrix: Array) -> Array:
    """Return the s (k,) that makes the largest entry of each row of M_ij/sqrt(s_i s_j) 1, or 0."""
    scales = np.ones(len(matrix))
    for _ in range(ROUNDS):
        root = np.sqrt(scales)
        largest = (np.abs(matrix) / np.outer(root, root)).max(axis=1, initial=0.0)
        scales = scales * np.where(largest == 0.0, 1.0, largest)
    return np.where(largest == 0.0, 0.0, scales)


def _eigen(curved: Array, rows: Array) -> list[tuple[float, Array]]:
    """Return curvatures below FLAT along rows d = 0, smallest first, and their directions."""
    _, sizes, turned = np.linalg.svd(rows)
    across = turned[int((sizes > RANK).sum()) :].T
    values, vectors = np.linalg.eigh(across.T @ curved @ across)
    pairs = zip(values, (across @ vectors).T, strict=True)
    return [(float(value), d) for value, d in pairs if value < FLAT]


def _sinks(point: Point, cone: _Cone, d: Array) -> bool:
    """Return whether the Lagrangian falls along d, by steps of the own scales or of the box."""
    scales, width = own_scales(point), point.high - point.low
    wide = np.where(np.isfinite(width), np.maximum(scales, BOX * width), scales)
    step = np.zeros(len(point.y))
    step[cone.free] = cone.unit * d
    across = cone.across(d)
    return any(_falls(point, cone, step / (np.abs(step) / s).max(), across) for s in (scales, wide))


def _falls(point: Point, cone: _Cone, step: Array, across: Array) -> bool:
    """Return whether the Lagrangian falls by more than gradient and curvature give, at FLAT_STEPS.

    It need not be seen at the shortest step; but nowhere may it rise.
    """
    curved = dense(hessian(point))
    pull, pulls = curved @ step, np.abs(curved) @ np.abs(step)
    here, size, _ = _lagrangian(point, cone, point.y)
    fell = []
    for t in FLAT_STEPS:
        moved = _curve(point, cone, t * step, across)
        there, more, _ = _lagrangian(point, cone, point.y + moved)
        bent = t * pull @ (moved - 0.5 * t * step)
        further = there - here - point.gradient @ moved - bent
        noise = NOISE * (size + more + t * pulls @ np.abs(moved))
        fell.append(0 if not abs(further) > noise else np.sign(further))
    return bool(max(fell) <= 0 and fell[-2] < 0)


def _curve(point: Point, cone: _Cone, step: Array, across: Array) -> Array:
    """Return a step along a flat direction and, across it, back to Lagrangian and firm rows.

    They ask for slopes and rows as they are at the point; what these are there counts as none.
    """
    moved = step.copy()
    _, _, off = _lagrangian(point, cone, point.y)
    for _ in range(NEWTON):
        _, _, now = _lagrangian(point, cone, point.y + moved)
        moved[cone.free] -= cone.unit * (across @ (now - off))
        moved = np.clip(moved, point.low - point.y, point.high - point.y)
    return moved


def _lagrangian(point: Point, cone: _Cone, y: Array) -> tuple[float, float, Array]:
    """Return the Lagrangian at y, the sizes of its terms, and its gradient with firm rows."""
    p = point.problem.parameter_values()
    parts = point.shape.derivatives(y, p, point.lam_g, point.lam_h)
    f, g, h, _, slope = (np.array(part).ravel() for part in parts)
    value = f[0] + point.lam_g @ g + point.lam_h @ h
    sizes = abs(f[0]) + point.lam_g.sum() + np.abs(point.lam_h).sum()  # the unit of a row is 1
    held = np.concatenate([g[cone.priced], h]) / cone.length
    return float(value), float(sizes), np.concatenate([slope[cone.free] * cone.unit, held])


def _down(point: Point, cone: _Cone, d: Array) -> Doubt:
    """Return along which variables the objective falls, and a point that way."""
    names = [name for (_, name), at in zip(point.problem.columns, cone.free, strict=True) if at]
    scales, step = own_scales(point), np.zeros(len(point.y))
    share = np.abs(cone.unit * d) / scales[cone.free]
    most = [names[k] for k in np.argsort(-share, kind="stable")[:3] if share[k] > 0.3 * share.max()]
    step[cone.free] = DOWN * cone.unit * d / share.max()
    lower = point.shape.to_x(np.clip(point.y + step, point.low, point.high))
    return Doubt(FALLS.format(", ".join(most)), lower)

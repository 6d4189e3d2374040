"""Kahraman and Singh's oscillator with a gap, as a file says it, against integrations written here.

x'' + 2 zeta x' + f(x) = F_m + F_h W^2 cos(W tau), f(x) = x - 1 above 1, x + 1 below -1, else 0: two
gears on fixed axes, x = 1 - delta/b of half a backlash b, tau = omega_n t, F_h b the amplitude of
their transmission error. The damper acts always (Kahraman and Singh, J. Sound Vib. 142, 1990), or
where |x| > 1.
"""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import gearopt

MASS, STIFFNESS, HALF = 1.0 / 3400.0, 2e5, 0.05  # t, N/mm, mm: the file below
RATE = math.sqrt(STIFFNESS / MASS)
LOAD = 0.1  # F_m


def file(ratio, shake, acts, **tables):
    """Shake: cosines and sines of the error over b."""
    gear = {"mass": "1 kg", "bearing_stiffness": "1 kN/mm"}
    force = LOAD * STIFFNESS * HALF
    cosines, sines = ([f"{HALF * a!r} mm" for a in part] for part in shake)
    mesh = {"pressure_angle": "20 deg", "teeth": 30, "axes": "fixed", "stiffness": "200 kN/mm"}
    mesh |= {"error_cosines": cosines} | ({"error_sines": sines} if sines else {})
    mesh |= {"damping": ratio, "damping_acts": acts, "backlash": f"{2.0 * HALF!r} mm"}
    return {
        "gearopt": 1,
        "kind": "dynamics",
        "pinion": gear
        | {"base_diameter": "120 mm", "inertia": "0.002 kg m^2"}
        | {"torque": f"{60e-3 * force!r} N m"},
        "wheel": gear | {"base_diameter": "160 mm", "inertia": "0.004 kg m^2"},
        "mesh": mesh | tables.pop("mesh", {}),
        **tables,
    }


def rpm(w):
    """The speed of 30 teeth whose mesh frequency is W omega_n."""
    return float(60.0 * w * RATE / (2.0 * math.pi) / 30.0)


def carried(ratio, shake, acts, w, state, periods):
    """State after so many periods; x and x' at 200 times of the last: pieces between corners."""
    orders = np.arange(1, 1 + max(map(len, shake)))
    a, b = (np.pad(np.array(part, float), (0, orders.size - len(part))) for part in shake)

    def law(t, y, side):
        angle = orders * w * t
        push = LOAD + np.sum((orders * w) ** 2 * (a * np.cos(angle) + b * np.sin(angle)))
        damped = 2.0 * ratio * y[1] if acts == "always" or side else 0.0
        return y[1], push - damped - ((y[0] - side) if side else 0.0)

    t, end, sampled = 0.0, periods * 2.0 * math.pi / w, []
    times = end - 2.0 * math.pi / w * np.arange(200, 0, -1) / 200.0
    side = np.sign(state[0]) if abs(state[0]) >= 1.0 else 0.0
    while t < end:
        corners = [lambda t, y, side, c=c: y[0] - c for c in ((side,) if side else (-1.0, 1.0))]
        for corner in corners:
            corner.terminal = True
        begun = np.array(state)
        if side == 0.0 and abs(abs(begun[0]) - 1.0) < 1e-9:
            begun[0] -= 1e-11 * np.sign(begun[0])  # off the corner it has just left
        elif side and abs(begun[0] - side) < 1e-9:
            begun[0] += 1e-11 * side
        made = solve_ivp(
            law, (t, end), begun, "DOP853", args=(side,), events=corners, rtol=1e-9, atol=1e-11,
            max_step=0.5, dense_output=True,
        )  # fmt: skip
        inside = times[(times >= t) & (times < made.t[-1])]
        sampled += list(made.sol(inside).T) if inside.size else []
        t, state = made.t[-1], made.y[:, -1]
        if made.status == 1:
            side = 0.0 if side else np.sign(state[0])
    return state, np.array(sampled).T


def force(ratio, x, rate):
    """Load on the teeth over the mean one: spring and damper, which do not pull."""
    return np.where(x > 1.0, np.maximum(x - 1.0 + 2.0 * ratio * rate, 0.0), 0.0) / LOAD


def swept(ratio, shake, acts, speeds, settling):
    """RMS of x and largest load at speeds passed in this order, from rest under the load."""
    state, found = np.array([1.0 + LOAD, 0.0]), []
    for w in speeds:
        state, _ = carried(ratio, shake, acts, w, state, settling)
        state, motion = carried(ratio, shake, acts, w, state, 1)
        found.append((motion[0].std(), force(ratio, *motion).max()))
    return np.array(found).T


@pytest.mark.parametrize("acts", ["in_contact", "always"])
def test_a_motion_of_separated_teeth_is_that_of_the_equations(acts):
    """Near resonance, from rest: with the damper in contact alone it is larger."""
    w, count, shake = 0.85, 6, ((0.15,), ())
    _, (x, rate) = carried(0.05, shake, acts, w, np.array([1.0 + LOAD, 0.0]), count)
    span = count * 2.0 * math.pi / w / RATE
    made = gearopt.solve(
        file(
            0.05,
            shake,
            acts,
            mesh={"speed": f"{rpm(w)!r} rpm"},
            simulate={
                "duration": f"{span!r} s",
                "start": "equilibrium",
                "outputs": 200 * count + 1,
                "error": 1e-8,
            },
        )
    )
    delta = np.array(made.design["response"]["deformation_mm"])
    assert 1.0 - delta[-201:-1] / HALF == pytest.approx(x, abs=2e-6)
    loads = np.array(made.design["response"]["load_N"]) / (LOAD * STIFFNESS * HALF)
    assert loads[-201:-1] == pytest.approx(force(0.05, x, rate), abs=2e-4)
    assert (x.min() < 1.0) and made.design["response"]["separations"] > 1
    said = "also while teeth are apart" if acts == "always" else "not while they are apart"
    assert any(said in sentence for sentence in made.report["assumptions"])


@pytest.mark.slow
@pytest.mark.parametrize(
    ("acts", "shake"),
    [
        ("in_contact", ((0.05,), ())),
        ("always", ((0.05,), ())),
        ("always", ((0.03, 0.004), (0.02, -0.01))),
    ],
)
def test_twenty_speeds_up_and_down_with_a_transmission_error(acts, shake):
    """Those between are passed here, too."""
    asked = np.linspace(0.6, 0.98, 20)
    ends = [f"{rpm(w)!r} rpm" for w in asked[[0, -1]]]
    made = gearopt.solve(file(0.05, shake, acts, speeds={"range": ends, "points": 20}))
    told = made.design["speeds"]
    every = np.sort(np.concatenate([asked, np.sqrt(asked[1:] * asked[:-1])]))
    at = np.searchsorted(every, asked)
    rising = swept(0.05, shake, acts, every, 30)[:, at]
    falling = swept(0.05, shake, acts, every[::-1], 30)[:, ::-1][:, at]
    assert np.array(told["rms_mm"]) / HALF == pytest.approx(rising[0], rel=1e-3)
    assert np.array(told["falling_rms_mm"]) / HALF == pytest.approx(falling[0], rel=1e-3)
    assert told["dynamic_factor"] == pytest.approx(rising[1], rel=1e-3)
    assert told["falling_dynamic_factor"] == pytest.approx(falling[1], rel=1e-3)
    assert np.max(np.abs(rising - falling)[0]) > 0.05  # where there are two motions

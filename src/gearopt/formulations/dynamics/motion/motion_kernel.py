"""Kernel of the equations of motion: what `physics.motion.accelerations` says, on plain arrays.

m is the record in `pair` and w `waves` of `numbers.Numbers`; y holds coordinates and velocities of
its level. `flank`: 0 in contact on the drive flank (always, without backlash), 1 apart, 2 on the
coast flank.
"""

import math

from gearopt.optimise.jit_kernel import inlined


@inlined
def contact(m, u, v):
    """g, its gradient and second derivatives, of the kinematics m.kinematics."""
    if m.kinematics == 1:
        return m.sine * u + m.cosine * v, m.sine, m.cosine, 0.0, 0.0, 0.0
    if m.kinematics == 3:
        return u / m.sine, 1.0 / m.sine, 0.0, 0.0, 0.0, 0.0
    x = m.centres + u
    change = 2.0 * m.centres * u + u * u + v * v
    z = math.sqrt(m.tangent * m.tangent + change)
    longer = change / (z + m.tangent)
    if m.kinematics == 2:
        a, b = x / z, v / z
        return longer, a, b, (1.0 - a * a) / z, -a * b / z, (1.0 - b * b) / z
    r, square = m.radii, x * x + v * v
    turned = math.atan(r * longer / (r * r + z * m.tangent))
    s, c = (z * x - r * v) / square, (r * x + z * v) / square
    return longer - r * turned + r * math.atan2(v, x), s, c, c * c / z, -s * c / z, s * s / z


@inlined
def grown(m, u, v):
    """Growth of the backlash and its gradient."""
    if m.level < 5:
        return 0.0, 0.0, 0.0
    if m.kinematics == 1:
        return 2.0 * m.sine * u, 2.0 * m.sine, 0.0
    if m.kinematics > 1:
        g, gu, gv, _, _, _ = contact(m, u, v)
        return 2.0 * g, 2.0 * gu, 2.0 * gv
    x = m.centres + u
    change = 2.0 * m.centres * u + u * u + v * v
    z = math.sqrt(m.tangent * m.tangent + change)
    longer = change / (z + m.tangent)
    r, square = m.radii, x * x + v * v
    turned = math.atan(r * longer / (r * r + z * m.tangent))
    return 2.0 * (longer - r * turned), 2.0 * z * x / square, 2.0 * z * v / square


@inlined
def waves(m, w, t):
    """The Fourier part of the mesh stiffness, and what the transmission error adds to delta''."""
    k, shake = 0.0, 0.0
    for h in range(w.shape[1]):
        angle = (h + 1) * m.omega * t
        cosine, sine = math.cos(angle), math.sin(angle)
        k += w[0, h] * cosine + w[1, h] * sine
        shake += w[2, h] * cosine + w[3, h] * sine
    return k, shake


@inlined
def pressed(m, k, flank, delta, rate):
    """Force on axes that stay on the line of action."""
    force = m.drag * rate
    if flank == 0:
        force += k * delta + m.damping * rate
    elif flank == 2:
        force += k * (delta - m.backlash) + m.damping * rate
    return force


@inlined
def derivative(m, k, shake, flank, y, out):
    """Write the derivative of y (2 n,) to out; shake: what is added to delta''."""
    n = m.level
    if n >= 5:
        plane_derivative(m, k, shake, flank, y, out)
        return
    for i in range(n):
        out[i] = y[n + i]
    if n == 1:
        force = pressed(m, k, flank, y[0], y[1])
        out[1] = shake - (m.load + force) / m.mesh_mass
        return
    force = pressed(m, k, flank, y[1], y[4])
    out[3] = (force - m.kx1 * y[0] - m.cx1 * y[3]) / m.m1
    out[5] = (-force - m.kx2 * y[2] - m.cx2 * y[5]) / m.m2
    out[4] = out[5] - out[3] + shake - (m.load + force) / m.mesh_mass


@inlined
def opening(m, y):
    """Delta and its rate, and the backlash that there is at the moment with its rate."""
    n = m.level
    delta, rate, room, widening = y[n // 2], y[n + n // 2], m.backlash, 0.0
    if n < 5:
        return delta, rate, room, widening
    u, v, wu, wv = y[3] - y[0], y[4] - y[1], y[n + 3] - y[n], y[n + 4] - y[n + 1]
    delta, rate = y[2], y[n + 2]
    if m.form > 0:
        g, gu, gv, _, _, _ = contact(m, u, v)
        rate = gu * wu + gv * wv
        if n == 6:
            delta = g - m.r1 * y[2] - m.r2 * y[5]
            rate -= m.r1 * y[8] + m.r2 * y[11]
        else:
            delta = g - y[2]
            rate -= y[7]
    if m.backlash < math.inf:
        more, ru, rv = grown(m, u, v)
        room += more
        widening = ru * wu + rv * wv
    return delta, rate, room, widening


@inlined
def flank_of(m, y):
    """0 in contact on the drive flank, 1 apart, 2 on the coast flank; 0 always without backlash."""
    if m.backlash == math.inf:
        return 0
    delta, _, room, _ = opening(m, y)
    if delta <= 0.0:
        return 0
    return 2 if delta > room else 1


@inlined
def plane_derivative(m, k, shake, flank, y, out):
    """Write the derivative of y for axes that move in the plane, in any of the three forms."""
    n = m.level
    for i in range(n):
        out[i] = y[n + i]
    u, v, wu, wv = y[3] - y[0], y[4] - y[1], y[n + 3] - y[n], y[n + 4] - y[n + 1]
    g, gu, gv, suu, suv, svv = contact(m, u, v)
    if m.form == 0:
        delta, rate = y[2], y[7]
    elif n == 5:
        delta, rate = g - y[2], gu * wu + gv * wv - y[7]
    else:
        delta = g - m.r1 * y[2] - m.r2 * y[5]
        rate = gu * wu + gv * wv - m.r1 * y[8] - m.r2 * y[11]
    along = m.drag * rate
    if flank == 0:
        along += k * delta + m.damping * rate
    pu, pv = along * gu, along * gv
    if flank == 2:
        more, ru, rv = grown(m, u, v)
        coast = k * (m.backlash + more - delta) + m.damping * (ru * wu + rv * wv - rate)
        pu += coast * (ru - gu)
        pv += coast * (rv - gv)
        along -= coast
    out[n] = (pu - m.kx1 * y[0] - m.cx1 * y[n]) / m.m1
    out[n + 1] = (pv - m.ky1 * y[1] - m.cy1 * y[n + 1]) / m.m1
    out[n + 3] = (-pu - m.kx2 * y[3] - m.cx2 * y[n + 3]) / m.m2
    out[n + 4] = (-pv - m.ky2 * y[4] - m.cy2 * y[n + 4]) / m.m2
    if n == 6:
        out[8] = (m.torque1 + m.r1 * along) / m.i1
        out[11] = (m.torque2 + m.r2 * along) / m.i2
    elif m.form == 1:
        out[7] = (m.load + along) / m.mesh_mass
    else:
        turned = gu * (out[8] - out[5]) + gv * (out[9] - out[6])
        curved = suu * wu * wu + 2.0 * suv * wu * wv + svv * wv * wv
        out[7] = turned + curved + shake - (m.load + along) / m.mesh_mass

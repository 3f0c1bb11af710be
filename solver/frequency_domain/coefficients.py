"""Equivalent linear drag: (V + r)|V + r| ≈ β r + γ (docs/theory.md, F1-F6)."""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from ..forces.drag import current
from ..forces.weight import wet_point

ROOT2 = math.sqrt(2.0)
ANGLES = 512
SWIFT = 5.0  # from this many σ on, the current keeps |V + r| off its kink and Gauss-Hermite points do
_points, _weights = np.polynomial.hermite_e.hermegauss(16)
_weights = _weights / _weights.sum()


@njit(cache=True)
def random(V, sigma):  # type: ignore[no-untyped-def]
    """(β, γ) for a Gaussian r of standard deviation sigma about a mean velocity V (F2)."""
    if sigma <= 1e-12 * (abs(V) + 1e-12):
        return 2.0 * abs(V), V * abs(V)
    e = math.erf(V / (ROOT2 * sigma))
    g = math.sqrt(2.0 / math.pi) * sigma * math.exp(-0.5 * (V / sigma) ** 2)
    return 2.0 * (V * e + g), (sigma * sigma + V * V) * e + g * V


@njit(cache=True)
def harmonic(V, a):  # type: ignore[no-untyped-def]
    """(β, γ) for r = a cos φ about a mean velocity V, from the first Fourier terms over a cycle (F3)."""
    if a <= 1e-12 * (abs(V) + 1e-12):
        return 2.0 * abs(V), V * abs(V)
    if abs(V) >= a:
        sign = 1.0 if V > 0 else -1.0
        return 2.0 * abs(V), sign * (V * V + 0.5 * a * a)
    p = math.acos(-V / a)
    s, d = math.sin(p), p + 0.5 * math.sin(2.0 * p)
    first = 2.0 * V * V * s + 2.0 * V * a * d + a * a * (2.0 * s - 2.0 * s**3 / 3.0)
    mean = 2.0 * V * V * p + 4.0 * V * a * s + a * a * d
    beta = (2.0 * first - 2.0 * math.pi * V * a) / (math.pi * a)
    gamma = (2.0 * mean - 2.0 * math.pi * V * V - math.pi * a * a) / (2.0 * math.pi)
    return beta, gamma


@njit(cache=True)
def principal(c11, c12, c22):  # type: ignore[no-untyped-def]
    """Principal standard deviations (larger first) and the angle of the larger one."""
    mean, half = 0.5 * (c11 + c22), math.hypot(0.5 * (c11 - c22), c12)
    angle = 0.5 * math.atan2(2.0 * c12, c11 - c22)
    return math.sqrt(max(mean + half, 0.0)), math.sqrt(max(mean - half, 0.0)), angle


@njit(cache=True)
def vector(V1, V2, c11, c12, c22, is_random, B, gamma):  # type: ignore[no-untyped-def]
    """Frame-invariant linearisation of |V + r|(V + r) in the plane normal to the line (F4-F6).

    V1, V2 : mean velocity; c.. : covariance of r; B (2, 2) and gamma (2,) are filled.
    """
    s1, s2, angle = principal(c11, c12, c22)
    c, s = math.cos(angle), math.sin(angle)
    m1, m2 = c * V1 + s * V2, -s * V1 + c * V2
    size = math.hypot(m1, m2)
    b = np.zeros((2, 2))
    g = np.zeros(2)
    if s1 <= 1e-10 * (size + 1e-12):
        if size > 0.0:
            _point(m1, m2, 1.0, b, g)
    elif is_random and size > SWIFT * s1:
        _swift(m1, m2, s1, s2, b, g)
    elif is_random:
        _gaussian(m1, m2, s1, max(s2, max(s1, size) / 80.0), b, g)
    else:
        _cycle(m1, m2, ROOT2 * s1, ROOT2 * s2, b, g)
    B[0, 0] = c * c * b[0, 0] - c * s * (b[0, 1] + b[1, 0]) + s * s * b[1, 1]
    B[1, 1] = s * s * b[0, 0] + c * s * (b[0, 1] + b[1, 0]) + c * c * b[1, 1]
    B[0, 1] = c * s * (b[0, 0] - b[1, 1]) + c * c * b[0, 1] - s * s * b[1, 0]
    B[1, 0] = c * s * (b[0, 0] - b[1, 1]) + c * c * b[1, 0] - s * s * b[0, 1]
    gamma[0] = c * g[0] - s * g[1]
    gamma[1] = s * g[0] + c * g[1]


@njit(cache=True)
def _point(x, y, weight, b, g):  # type: ignore[no-untyped-def]
    """Add |V|V and its derivative |V| I + V Vᵀ/|V| at one velocity."""
    size = math.hypot(x, y)
    if size == 0.0:
        return
    g[0] += weight * size * x
    g[1] += weight * size * y
    b[0, 0] += weight * (size + x * x / size)
    b[1, 1] += weight * (size + y * y / size)
    b[0, 1] += weight * x * y / size
    b[1, 0] += weight * x * y / size


@njit(cache=True)
def _swift(m1, m2, s1, s2, b, g):  # type: ignore[no-untyped-def]
    """E[∂f/∂V] and E[f] in principal axes where the mean velocity is many σ: f is smooth there (F5)."""
    for i in range(_points.size):
        for j in range(_points.size):
            _point(m1 + s1 * _points[i], m2 + s2 * _points[j], _weights[i] * _weights[j], b, g)


@njit(cache=True)
def _gaussian(m1, m2, s1, s2, b, g):  # type: ignore[no-untyped-def]
    """E[∂f/∂V] and E[f] in principal axes: polar about V = 0 in whitened axes, the radius in closed form (F5)."""
    z1, z2 = m1 / s1, m2 / s2
    for k in range(ANGLES):
        phi = 2.0 * math.pi * (k + 0.5) / ANGLES
        e1, e2 = math.cos(phi), math.sin(phi)
        p = z1 * e1 + z2 * e2  # where along the ray the density peaks
        front = math.exp(-0.5 * max(z1 * z1 + z2 * z2 - p * p, 0.0)) / ANGLES
        if front < 1e-18:
            continue
        tail = math.sqrt(0.5 * math.pi) * (1.0 + math.erf(p / ROOT2))
        edge = math.exp(-0.5 * p * p)
        second = (p * p + 1.0) * tail + p * edge  # ∫ρ² exp(-½(ρ-p)²) dρ
        third = (p**3 + 3.0 * p) * tail + (p * p + 2.0) * edge
        x, y = s1 * e1, s2 * e2
        size = math.hypot(x, y)
        b[0, 0] += front * second * (size + x * x / size)
        b[1, 1] += front * second * (size + y * y / size)
        b[0, 1] += front * second * x * y / size
        b[1, 0] += front * second * x * y / size
        g[0] += front * third * size * x
        g[1] += front * third * size * y


@njit(cache=True)
def _cycle(m1, m2, a1, a2, b, g):  # type: ignore[no-untyped-def]
    """Least squares over one turn of r = (a1 cos φ, a2 sin φ): the whole first harmonic of the drag (F6).

    Across a straight path, where nothing moves, the mean of ∂f/∂V serves.
    """
    f11, f12, f21, f22, across = 0.0, 0.0, 0.0, 0.0, 0.0
    for k in range(ANGLES):
        phi = 2.0 * math.pi * (k + 0.5) / ANGLES
        r1, r2 = a1 * math.cos(phi), a2 * math.sin(phi)
        x, y = m1 + r1, m2 + r2
        size = math.hypot(x, y)
        across += (size + y * y / size if size > 0.0 else 0.0) / ANGLES
        g[0] += size * x / ANGLES
        g[1] += size * y / ANGLES
        f11 += size * x * r1 / ANGLES
        f12 += size * x * r2 / ANGLES
        f21 += size * y * r1 / ANGLES
        f22 += size * y * r2 / ANGLES
    b[0, 0] = f11 / (0.5 * a1 * a1)
    b[1, 0] = f21 / (0.5 * a1 * a1)
    b[0, 1] = f12 / (0.5 * a2 * a2) if a2 > 1e-3 * a1 else b[1, 0]
    b[1, 1] = f22 / (0.5 * a2 * a2) if a2 > 1e-3 * a1 else across


@njit(cache=True)
def drag_blocks(line, x, wet, covariance, plane, is_random, as_vector):  # type: ignore[no-untyped-def]
    """Linearised drag of every node (F1).

    wet : (N+1, 2) wet share of the half elements before and after each node.
    covariance : (N+1, 6) of the relative velocity, xx yy zz xy xz yz [m²/s²] (of a harmonic one: half its square).
    plane : (3,) horizontal normal of the line's plane, used where an element is vertical.
    Returns B_L (N+1, 3, 3) [N s/m] and the mean drag (N+1, 3) [N].
    """
    n = line.L.size
    B, mean = np.zeros((n + 1, 3, 3)), np.zeros((n + 1, 3))
    axes, V, S = np.empty((3, 3)), np.empty(3), np.empty((3, 3))
    for i in range(n + 1):
        current(line, x[i, 2], V)
        c = covariance[i]
        S[0, 0], S[1, 1], S[2, 2] = c[0], c[1], c[2]
        S[0, 1] = S[1, 0] = c[3]
        S[0, 2] = S[2, 0] = c[4]
        S[1, 2] = S[2, 1] = c[5]
        for side in range(2):
            j = i - 1 + side
            if j < 0 or j >= n or wet[i, side] == 0.0:
                continue
            local_axes(x, j, plane, axes)
            coefficient = np.array([line.cdt[j], line.cdn[j], line.cdn[j]]) * wet[i, side]
            _add_drag(axes, V, S, coefficient, is_random, as_vector, B[i], mean[i])
        point = line.point_drag[i] * wet_point(x[i, 2], line.point_radius[i])
        if point > 0.0:
            if as_vector:
                _add_point_drag(V, S, point, is_random, B[i], mean[i])
            else:
                local_axes(x, min(i, n - 1), plane, axes)
                _add_drag(axes, V, S, np.full(3, point), is_random, False, B[i], mean[i])
    return B, mean


@njit(cache=True)
def _add_point_drag(V, S, coefficient, is_random, B, mean):  # type: ignore[no-untyped-def]
    """Drag of an attachment, alike in all directions, about a horizontal current V (F6a).

    The vector form in the horizontal plane, and in the vertical plane of the current (without one, of the larger
    horizontal motion) for what is vertical.
    """
    flat, flat_mean, up, up_mean = np.zeros((2, 2)), np.zeros(2), np.zeros((2, 2)), np.zeros(2)
    vector(V[0], V[1], S[0, 0], S[0, 1], S[1, 1], is_random, flat, flat_mean)
    speed = math.hypot(V[0], V[1])
    angle = math.atan2(V[1], V[0]) if speed > 0.0 else principal(S[0, 0], S[0, 1], S[1, 1])[2]
    c, s = math.cos(angle), math.sin(angle)
    along = c * c * S[0, 0] + 2.0 * c * s * S[0, 1] + s * s * S[1, 1]
    vector(speed, V[2], along, c * S[0, 2] + s * S[1, 2], S[2, 2], is_random, up, up_mean)
    B[:2, :2] += coefficient * flat
    B[2, 2] += coefficient * up[1, 1]
    B[0, 2] += coefficient * up[0, 1] * c
    B[1, 2] += coefficient * up[0, 1] * s
    B[2, 0] += coefficient * up[1, 0] * c
    B[2, 1] += coefficient * up[1, 0] * s
    mean[0] += coefficient * flat_mean[0]
    mean[1] += coefficient * flat_mean[1]
    mean[2] += coefficient * up_mean[1]


@njit(cache=True)
def local_axes(x, j, plane, axes):  # type: ignore[no-untyped-def]
    """Rows t, n (in the line's vertical plane) and Π = n × t of element j."""
    t = x[j + 1] - x[j]
    t = t / math.sqrt(t[0] * t[0] + t[1] * t[1] + t[2] * t[2])
    flat = math.hypot(t[0], t[1])
    if flat > 1e-6:
        p0, p1 = -t[1] / flat, t[0] / flat
    else:
        p0, p1 = plane[0], plane[1]
    axes[0] = t
    axes[2, 0], axes[2, 1], axes[2, 2] = p0, p1, 0.0
    axes[1, 0] = t[1] * axes[2, 2] - t[2] * axes[2, 1]
    axes[1, 1] = t[2] * axes[2, 0] - t[0] * axes[2, 2]
    axes[1, 2] = t[0] * axes[2, 1] - t[1] * axes[2, 0]


@njit(cache=True)
def _add_drag(axes, V, S, coefficient, is_random, as_vector, B, mean):  # type: ignore[no-untyped-def]
    first = 3
    if as_vector and coefficient[1] > 0.0:
        first = 1
        n, p = axes[1], axes[2]
        Sn, Sp = S @ n, S @ p
        b, g = np.zeros((2, 2)), np.zeros(2)
        vector(V @ n, V @ p, n @ Sn, n @ Sp, p @ Sp, is_random, b, g)
        for r in range(2):
            for k in range(3):
                mean[k] += coefficient[1] * g[r] * axes[1 + r, k]
            for s in range(2):
                for k in range(3):
                    for m in range(3):
                        B[k, m] += coefficient[1] * b[r, s] * axes[1 + r, k] * axes[1 + s, m]
    for d in range(first):
        if coefficient[d] == 0.0:
            continue
        axis = axes[d]
        sigma = math.sqrt(max(axis @ (S @ axis), 0.0))
        if is_random:
            beta, gamma = random(V @ axis, sigma)
        else:
            beta, gamma = harmonic(V @ axis, ROOT2 * sigma)
        for k in range(3):
            mean[k] += coefficient[d] * gamma * axis[k]
            for m in range(3):
                B[k, m] += coefficient[d] * beta * axis[k] * axis[m]

"""Scenes: named Hamiltonians, each with an initial state, a time scale, a source and its invariants.

Parameters are numbers, text, `Decimal` or `Fraction`. Double-double uses all digits of the latter three. A
float is read as the decimal that Python prints for it. Parameters are dimensionless unless the text names
a unit.
"""

from __future__ import annotations

from decimal import Decimal
from fractions import Fraction
from typing import Union

from ._scene import Scene

Value = Union[int, float, str, Decimal, Fraction]

__all__ = [
    "Scene",
    "arenstorf",
    "charged_particle",
    "dnls",
    "double_pendulum",
    "faou_hairer_pham",
    "fpu",
    "fput_beta",
    "harmonic",
    "henon_heiles",
    "kepler",
    "lennard_jones",
    "lotka_volterra",
    "n_body",
    "outer_solar_system",
    "pendulum",
    "pythagorean",
    "quartic",
    "sine_gordon",
    "spring_pendulum",
    "stiff_double_pendulum",
]


def kepler(*, e: Value = 0.6, mu: Value = 1) -> Scene:
    """Kepler's problem: H = (p1^2 + p2^2)/2 - mu/sqrt(q1^2 + q2^2)

    Parameters
    ----------
    e
        eccentricity of the ellipse, started at its pericentre
    mu
        gravitational parameter
    """
    return Scene("kepler", {"e": e, "mu": mu})


def henon_heiles(*, energy: Value = "1/12", q2: Value = 0.3, p2: Value = 0.2) -> Scene:
    """Hénon–Heiles: H = (p1^2 + p2^2 + q1^2 + q2^2)/2 + q1^2 q2 - q2^3/3

    Parameters
    ----------
    energy
        energy, at most that of the escape
    q2
        q2 of the start on the section q1 = 0
    p2
        p2 of the start
    """
    return Scene("henon-heiles", {"energy": energy, "q2": q2, "p2": p2})


def pendulum(*, q: Value = 0, p: Value = 1) -> Scene:
    """Mathematical pendulum: H = p^2/2 - cos q

    Parameters
    ----------
    q
        starting angle, 0 hanging down, in radians
    p
        starting angular velocity
    """
    return Scene("pendulum", {"q": q, "p": p})


def quartic(*, q: Value = 1, p: Value = 0) -> Scene:
    """Quartic oscillator: H = p^2/2 + q^4/4

    Parameters
    ----------
    q
        starting position
    p
        starting momentum
    """
    return Scene("quartic", {"q": q, "p": p})


def harmonic(*, m: Value = 2, omega: Value = 1, ratio: Value = 2) -> Scene:
    """Harmonic oscillators: H = sum_j (p_j^2 + w_j^2 q_j^2)/2, w_j = omega ratio^(j-1)

    Parameters
    ----------
    m
        number of oscillators
    omega
        first frequency
    ratio
        quotient of consecutive frequencies
    """
    return Scene("harmonic", {"m": m, "omega": omega, "ratio": ratio})


def double_pendulum(
    *, q1: Value = 1.1, q2: Value = -1.1, p1: Value = 2.7746, p2: Value = 2.7746, g: Value = 9.8
) -> Scene:
    """Double pendulum: H = (2 P2^2 + D^2 + 2 P2 D cos Q2)/(3 - cos 2Q2) - 2 g cos Q1 - g cos(Q1 + Q2), D =
    P2 - P1

    Parameters
    ----------
    q1
        starting angle of the first rod
    q2
        starting angle of the second rod against the first
    p1
        starting momentum of Q1
    p2
        starting momentum of Q2
    g
        acceleration of gravity
    """
    return Scene("double-pendulum", {"q1": q1, "q2": q2, "p1": p1, "p2": p2, "g": g})


def stiff_double_pendulum(*, c: Value = 32, g: Value = 9.8) -> Scene:
    """Double pendulum with a stiff spring: H = (2 P2^2 + D^2 + 2 P2 D cos Q2)/(3 - cos 2Q2) - 2 g cos Q1 - g
    cos(Q1 + Q2) + C^2 Q2^2/2, D = P2 - P1

    Parameters
    ----------
    c
        root C of the stiffness
    g
        acceleration of gravity
    """
    return Scene("stiff-double-pendulum", {"c": c, "g": g})


def spring_pendulum(*, k: Value = 10000, g: Value = 1) -> Scene:
    """Stiff spring pendulum: H = |p|^2/2 + g q2 + k (|q| - 1)^2/2

    Parameters
    ----------
    k
        stiffness of the spring
    g
        acceleration of gravity
    """
    return Scene("spring-pendulum", {"k": k, "g": g})


def fpu(*, m: Value = 3, omega: Value = 50) -> Scene:
    """Modified FPU problem with stiff springs (HLW I.5): H = sum (y0_i^2 + y1_i^2)/2 + w^2/2 sum x1_i^2 +
    [(x0_1 - x1_1)^4 + sum (x0_{i+1} - x1_{i+1} - x0_i - x1_i)^4 + (x0_m + x1_m)^4]/4

    Parameters
    ----------
    m
        number of stiff springs
    omega
        frequency of the stiff springs
    """
    return Scene("fpu", {"m": m, "omega": omega})


def fput_beta(*, n: Value = 32, beta: Value = 0.3, amplitude: Value = 10) -> Scene:
    """FPUT-β chain: H = sum p_i^2/2 + sum [d_i^2/2 + beta d_i^4/4], d_i = q_{i+1} -
    q_i, fixed ends

    Parameters
    ----------
    n
        number of masses
    beta
        strength of the cubic force
    amplitude
        amplitude of the first mode
    """
    return Scene("fput-beta", {"n": n, "beta": beta, "amplitude": amplitude})


def outer_solar_system(*, planets: Value = 5) -> Scene:
    """Outer solar system: H = sum |p_i|^2/(2 m_i) - G sum_{i<j} m_i m_j/|q_i - q_j|

    Parameters
    ----------
    planets
        planets taken, in the order Jupiter, Saturn, Uranus, Neptune, Pluto
    """
    return Scene("outer-solar-system", {"planets": planets})


def pythagorean() -> Scene:
    """Pythagorean three bodies: H = |p1|^2/10 + |p2|^2/8 + |p3|^2/6 - 20/|q1 - q2| - 15/|q1 - q3| - 12/|q2 -
    q3|"""
    return Scene("pythagorean", {})


def n_body(*, n: Value = 8, disorder: Value = 0.01, seed: Value = 1) -> Scene:
    """Ring of bodies: H = sum |p_i|^2/(2 m) - sum_{i<j} m^2/|q_i - q_j|, m = 1/n, in space

    Parameters
    ----------
    n
        number of bodies
    disorder
        largest displacement from the ring
    seed
        seed of the displacements
    """
    return Scene("n-body", {"n": n, "disorder": disorder, "seed": seed})


def arenstorf(*, mu: Value = 0.012277471, orbit: Value = 1) -> Scene:
    """Arenstorf orbits: H = (p1^2 + p2^2)/2 + p1 q2 - p2 q1 - (1-mu)/|q + (mu,0)| - mu/|q - (1-mu,0)|

    Parameters
    ----------
    mu
        mass of the Moon as a part of both; the orbits close at the default only
    orbit
        1: period 17.07; 2: period 11.12
    """
    return Scene("arenstorf", {"mu": mu, "orbit": orbit})


def charged_particle(*, b: Value = 1, c: Value = 0.01) -> Scene:
    """Charged particle in a magnetic field: H = |p - A(q)|^2/2 + c/|q|, A(q) = (b/3) |q| (-q2, q1)

    Parameters
    ----------
    b
        strength of the magnetic field
    c
        strength of the repelling potential
    """
    return Scene("charged-particle", {"b": b, "c": c})


def lennard_jones(*, n: Value = 7, speed: Value = 0.2, seed: Value = 1) -> Scene:
    """Lennard-Jones cluster: H = sum |p_i|^2/2 + 4 sum_{i<j} (r^-12 - r^-6), r = |q_i - q_j|, in the plane

    Parameters
    ----------
    n
        number of atoms
    speed
        largest component of the random momenta
    seed
        seed of the momenta
    """
    return Scene("lennard-jones", {"n": n, "speed": speed, "seed": seed})


def faou_hairer_pham() -> Scene:
    """Faou, Hairer and Pham's polynomial: H = p^3/3 - p/2 + q^6/30 + q^4/4 - q^3/3 + 1/6"""
    return Scene("faou-hairer-pham", {})


def lotka_volterra(*, a: Value = 1, b: Value = 2, u: Value = 2, v: Value = 2) -> Scene:
    """Lotka–Volterra in logarithms: H = exp(p) - b p + exp(q) - a q, q = ln u, p = ln v

    Parameters
    ----------
    a
        equilibrium of u
    b
        equilibrium of v
    u
        u at the start
    v
        v at the start
    """
    return Scene("lotka-volterra", {"a": a, "b": b, "u": u, "v": v})


def dnls(*, n: Value = 16, gamma: Value = 1, amplitude: Value = 1, modulation: Value = 0.1) -> Scene:
    """Discrete nonlinear Schrödinger ring: H = sum [(q_{j+1} - q_j)^2 + (p_{j+1} - p_j)^2]/2 - gamma/8 sum
    (q_j^2 + p_j^2)^2

    Parameters
    ----------
    n
        number of sites
    gamma
        nonlinearity, positive for focusing
    amplitude
        amplitude of the start
    modulation
        relative modulation of the start
    """
    return Scene("dnls", {"n": n, "gamma": gamma, "amplitude": amplitude, "modulation": modulation})


def sine_gordon(*, n: Value = 64, length: Value = 40, omega: Value = 0.6) -> Scene:
    """Sine-Gordon breather on a grid: H = sum [p_j^2/2 + (q_{j+1} - q_j)^2/(2 D^2) + 1 - cos q_j], D =
    length/n, ring

    Parameters
    ----------
    n
        number of grid points
    length
        length of the ring
    omega
        frequency of the breather
    """
    return Scene("sine-gordon", {"n": n, "length": length, "omega": omega})

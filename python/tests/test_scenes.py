"""Scenes of the catalogue, and the same formulas written in Python, in the same order: the bits are the same."""

import inspect
from fractions import Fraction

import numpy as np
import pytest

import equip
from equip import _native, scenes

THIRD = Fraction(1, 3)


def gravity(masses, g, d):
    def energy(q, p):
        bodies = range(len(masses))
        a, v = q.reshape(-1, d), p.reshape(-1, d)
        kinetic = sum_of([(v[i] * v[i]).sum() / (2 * masses[i]) for i in bodies])
        pairs = [
            masses[i] * masses[j] / np.sqrt(((a[i] - a[j]) ** 2).sum()) for i in bodies for j in range(i)
        ]
        return kinetic - g * sum_of(pairs)

    return energy


def sum_of(terms):
    return np.sum(np.stack(terms))


def fpu(q, p):
    slow, fast, last = q[:3], q[3:], 2
    kinetic, stiff = p @ p, fast @ fast
    soft = (slow[0] - fast[0]) ** 4 + (slow[last] + fast[last]) ** 4
    for i in range(1, 3):
        soft += (slow[i] - fast[i] - slow[i - 1] - fast[i - 1]) ** 4
    return 0.5 * kinetic + 0.5 * (50.0 * 50.0 * stiff) + 0.25 * soft


def fput_beta(q, p):
    d = np.concatenate([q[1:] - q[:-1], [q[0], q[-1]]])
    return 0.5 * (p @ p) + 0.5 * (d @ d) + 0.25 * (1 * (d**4).sum())


def lennard_jones(q, p):
    a = q.reshape(-1, 2)
    sixths = [(((a[i] - a[j]) ** 2).sum()) ** -3 for i in range(len(a)) for j in range(i)]
    return 0.5 * (p @ p) + 4 * sum_of([s * s - s for s in sixths])


def dnls(q, p):
    dq, dp = np.roll(q, -1) - q, np.roll(p, -1) - p
    return 0.5 * (dq * dq + dp * dp).sum() - Fraction(1, 8) * (1 * ((q * q + p * p) ** 2).sum())


def sine_gordon(n, length):
    def energy(q, p):
        d = np.roll(q, -1) - q
        density = n / length
        return 0.5 * (p @ p) + 0.5 * (density * density * (d @ d)) + (1 - np.cos(q)).sum()

    return energy


def double_pendulum(q, p):
    d = p[1] - p[0]
    kinetic = (2 * (p[1] * p[1]) + d * d + 2 * (p[1] * d * np.cos(q[1]))) / (3 - np.cos(2 * q[1]))
    return kinetic - 9.8 * (2 * np.cos(q[0]) + np.cos(q[0] + q[1]))


def charged_particle(q, p):
    r = np.sqrt(q[0] ** 2 + q[1] ** 2)
    strength = THIRD * (100 * r)
    v1, v2 = p[0] + strength * q[1], p[1] - strength * q[0]
    return 0.5 * (v1 * v1 + v2 * v2) + 0.01 / r


def faou_hairer_pham(q, p):
    q, p = q[0], p[0]
    kinetic = THIRD * p**3 - 0.5 * p
    return kinetic + Fraction(1, 30) * q**6 + 0.25 * q**4 - THIRD * q**3 + Fraction(1, 6)


def stiff_double_pendulum(q, p):
    soft = double_pendulum(q, p)
    stretch = 32 * q[1]
    return soft + 0.5 * (stretch * stretch)


def arenstorf(q, p):
    mu = Fraction(12277471, 10**9)
    rest = 1 - mu

    def distance(x):
        return np.sqrt(x * x + q[1] * q[1])

    rotation = p[0] * q[1] - p[1] * q[0]
    kinetic = 0.5 * (p[0] * p[0] + p[1] * p[1])
    return kinetic + rotation - rest / distance(q[0] + mu) - mu / distance(q[0] - rest)


#: G in au³/(day² solar mass), and G m of the Sun and the outer planets.
G = 0.000295912208286
GM = [
    0.00029591397690000476, 2.825328644881507e-07, 8.450771312727215e-08, 1.293944677450143e-08,
    1.532112500187004e-08, 2.276247756046154e-12,
]  # fmt: skip


SAME = {
    "kepler": (scenes.kepler(e=0.6), lambda q, p: 0.5 * p @ p - 1 / np.sqrt(q @ q)),
    "henon_heiles": (
        scenes.henon_heiles(),
        lambda q, p: 0.5 * (p @ p + q[0] ** 2 + q[1] ** 2) + q[0] ** 2 * q[1] - THIRD * (q[1] * q[1] * q[1]),
    ),
    "pendulum": (scenes.pendulum(), lambda q, p: 0.5 * p[0] ** 2 - np.cos(q[0])),
    "quartic": (scenes.quartic(), lambda q, p: 0.5 * p[0] ** 2 + 0.25 * q[0] ** 4),
    "harmonic": (
        scenes.harmonic(m=2, omega=1, ratio=2),
        lambda q, p: 0.5 * (p[0] ** 2 + q[0] ** 2 + (p[1] ** 2 + 4 * q[1] ** 2)),
    ),
    "spring_pendulum": (
        scenes.spring_pendulum(k=100, g=1),
        lambda q, p: 0.5 * p @ p + 1 * q[1] + 0.5 * (100 * (np.sqrt(q @ q) - 1) ** 2),
    ),
    "lotka_volterra": (
        scenes.lotka_volterra(),
        lambda q, p: (np.exp(p[0]) - 2 * p[0]) + (np.exp(q[0]) - 1 * q[0]),
    ),
    "pythagorean": (scenes.pythagorean(), gravity([5, 4, 3], 1, 2)),
    "n_body": (scenes.n_body(n=4), gravity([Fraction(1, 4)] * 4, 1, 3)),
    "fpu": (scenes.fpu(m=3, omega=50), fpu),
    "fput_beta": (scenes.fput_beta(n=8, beta=1), fput_beta),
    "lennard_jones": (scenes.lennard_jones(n=5), lennard_jones),
    "dnls": (scenes.dnls(n=6, gamma=1), dnls),
    "sine_gordon": (scenes.sine_gordon(n=16, length=20), sine_gordon(16, 20)),
    "double_pendulum": (scenes.double_pendulum(), double_pendulum),
    "charged_particle": (scenes.charged_particle(b=100, c=0.01), charged_particle),
    "stiff_double_pendulum": (scenes.stiff_double_pendulum(c=32), stiff_double_pendulum),
    "arenstorf": (scenes.arenstorf(), arenstorf),
    "outer_solar_system": (scenes.outer_solar_system(), gravity([gm / G for gm in GM], G, 3)),
    "faou_hairer_pham": (scenes.faou_hairer_pham(), faou_hairer_pham),
}


@pytest.mark.parametrize("name", SAME)
def test_bits_are_those_of_the_scene(name):
    scene, energy = SAME[name]
    h = equip.Hamiltonian(energy, scene.shape)
    rng = np.random.default_rng(3)
    for size in (0, 1e-3, 1e-2):
        q, p = scene.q0 + size * rng.normal(size=scene.shape), scene.p0 + size * rng.normal(size=scene.shape)
        assert h(q, p) == scene(q, p)
        assert np.array_equal(h.gradient(q, p), scene.gradient(q, p))
        assert np.array_equal(h.hessian(q, p), scene.hessian(q, p))
    runs = [equip.solve(x, scene.q0, scene.p0, (0, 20 * scene.step), step=scene.step) for x in (h, scene)]
    assert runs[0].success and np.array_equal(runs[0].y, runs[1].y)
    assert np.array_equal(runs[0].energy_error, runs[1].energy_error)


def test_all_scenes_are_functions():
    listed = {name.replace("-", "_"): parameters for name, parameters in _native.scene_list()}
    assert sorted(listed) == sorted(set(scenes.__all__) - {"Scene"})
    for name, parameters in listed.items():
        signature = inspect.signature(getattr(scenes, name))
        given = [(p.name.replace("_", "-"), str(p.default)) for p in signature.parameters.values()]
        assert given == [(key, default) for key, _, default in parameters]
        documented = inspect.getdoc(getattr(scenes, name))
        assert all(meaning in " ".join(documented.split()) for _, meaning, _ in parameters)


@pytest.mark.parametrize("name", sorted(set(scenes.__all__) - {"Scene"}))
def test_scenes_run(name):
    scene = getattr(scenes, name)()
    sol = equip.solve(
        scene, scene.q0, scene.p0, (0, 3 * scene.step), step=scene.step, invariants=scene.invariants
    )
    assert sol.success and len(sol.t) == 4
    assert [i.name for i in sol.certificate.invariants] == list(scene.invariants)
    assert scene.formula.startswith("H = ") and scene.source and name in repr(scene)


def test_parameters_are_read_exactly():
    by_text, by_fraction = scenes.kepler(e="1/10").start("dd"), scenes.kepler(e=Fraction(1, 10)).start("dd")
    by_float = scenes.kepler(e=0.1).start("dd")
    for other in (by_fraction, by_float):
        assert np.array_equal(by_text[0].high, other[0].high) and np.array_equal(by_text[0].low, other[0].low)
    assert by_text[0].low[0] != 0


def test_bad_parameters_are_refused_in_words():
    with pytest.raises(ValueError, match=r"\[0, 1\)"):
        scenes.kepler(e=1)
    with pytest.raises(TypeError, match="mass"):
        scenes.kepler(mass=1)


def test_precisions_of_starts():
    with pytest.raises(ValueError, match="precision is 'x'; it must be 'f64' or 'dd'"):
        scenes.kepler().start("x")

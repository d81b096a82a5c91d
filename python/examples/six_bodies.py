"""Sun and planets: arrays in your own shape, events, dense output, an ensemble."""

import numpy as np

import equip

# Sun, Jupiter, Saturn, Uranus, Neptune, Pluto: AU, days, solar masses. Hairer, Lubich, Wanner, Geometric
# Numerical Integration, I.2.4; here with circular initial orbits in one plane.
G = 2.95912208286e-4
masses = np.array(
    [1.00000597682, 9.54786104043e-4, 2.85583733151e-4, 4.37273164546e-5, 5.17759138449e-5, 7.7e-9]
)
radii = np.array([0.0, 5.2, 9.6, 19.2, 30.1, 39.5])
angles = np.arange(6.0)
q0 = radii[:, None] * np.stack([np.cos(angles), np.sin(angles), 0 * angles], axis=1)
speed = np.sqrt(G * masses[0] / np.maximum(radii, 1)) * (radii > 0)
p0 = (masses * speed)[:, None] * np.stack([-np.sin(angles), np.cos(angles), 0 * angles], axis=1)
p0[0] = -p0[1:].sum(axis=0)  # The barycentre rests.
i, j = np.triu_indices(6, 1)


def energy(q, p):
    """q and p have the shape (6, 3)."""
    kinetic = (p**2 / (2 * masses[:, None])).sum()
    return kinetic - G * (masses[i] * masses[j] / np.linalg.norm(q[i] - q[j], axis=1)).sum()


def jupiter_crosses(t, q, p):
    return q[1, 1] - q[0, 1]


jupiter_crosses.direction = 1

h = equip.Hamiltonian(energy, shape=(6, 3))
print(h)
sol = equip.solve(h, q0, p0, (0, 50_000), events=jupiter_crosses, dense_output=True)
print(sol.certificate)
print("Jupiter's years:", np.diff(sol.t_events[0]).round(2), "days")
print("Saturn after 10 000 days:", sol.sol(10_000)[0][2].round(4), "AU")

# Eight clones of Jupiter, some kilometres apart, each with the bits of a single run.
clones = np.repeat(q0[None], 8, axis=0)
clones[:, 1, 0] += 1e-8 * np.arange(8)
ends = equip.ensemble(h, clones, np.repeat(p0[None], 8, axis=0), (0, 50_000))
print("they end", np.ptp(ends.q[:, 1], axis=0).round(9), "AU apart")

"""SciPy: solve_ivp with the method named by the variant, the right-hand side in NumPy or plain Python, whichever is faster."""

import math

import numpy as np
from scipy.integrate import solve_ivp


def kepler(_parameters):
    def slope(_t, y):
        a, b, u, v = y.tolist()
        r2 = a * a + b * b
        pull = -1.0 / (r2 * math.sqrt(r2))
        return (u, v, pull * a, pull * b)

    return slope


def henon_heiles(_parameters):
    def slope(_t, y):
        a, b, u, v = y.tolist()
        return (u, v, -a - 2.0 * a * b, -b - a * a + b * b)

    return slope


def spring_pendulum(parameters):
    k, g = parameters

    def slope(_t, y):
        a, b, u, v = y.tolist()
        pull = k * (1.0 - 1.0 / math.sqrt(a * a + b * b))
        return (u, v, -pull * a, -pull * b - g)

    return slope


def fpu(parameters):
    m, omega = int(parameters[0]), parameters[1]

    def slope(_t, y):
        slow, fast = y[:m], y[m : 2 * m]
        plus, minus = slow + fast, slow - fast
        f = np.empty(m + 1)
        f[0], f[m] = minus[0], plus[m - 1]
        f[1:m] = minus[1:] - plus[:-1]
        f = f**3
        out = np.empty_like(y)
        out[: 2 * m] = y[2 * m :]
        out[2 * m : 3 * m] = f[1:] - f[:-1]
        out[3 * m - 1] = -f[m] - f[m - 1]
        out[3 * m :] = f[:-1] + f[1:] - omega**2 * fast
        out[4 * m - 1] = f[m - 1] - f[m] - omega**2 * fast[m - 1]
        return out

    return slope


def fput_beta(parameters):
    n, beta = int(parameters[0]), parameters[1]

    def slope(_t, y):
        d = np.diff(y[:n], prepend=0.0, append=0.0)
        return np.concatenate((y[n:], np.diff(d + beta * d * d * d)))

    return slope


def outer_solar_system(parameters):
    gm = np.array(parameters)
    n = len(gm)
    first, second = np.triu_indices(n, 1)

    def slope(_t, y):
        q = y[: 3 * n].reshape(n, 3)
        d = q[second] - q[first]
        d /= ((d * d).sum(axis=1) ** 1.5)[:, None]
        a = np.zeros((n, 3))
        np.add.at(a, first, gm[second, None] * d)
        np.add.at(a, second, -gm[first, None] * d)
        return np.concatenate((y[3 * n :], a.ravel()))

    return slope


def pythagorean(masses):
    pairs = ((0, 1), (0, 2), (1, 2))

    def slope(_t, y):
        y = y.tolist()
        a = [0.0] * 6
        for i, j in pairs:
            u, v = y[2 * i] - y[2 * j], y[2 * i + 1] - y[2 * j + 1]
            r2 = u * u + v * v
            pull = 1.0 / (r2 * math.sqrt(r2))
            a[2 * i] -= masses[j] * pull * u
            a[2 * i + 1] -= masses[j] * pull * v
            a[2 * j] += masses[i] * pull * u
            a[2 * j + 1] += masses[i] * pull * v
        return y[6:] + a

    return slope


SYSTEMS = {
    "pythagorean": pythagorean,
    "kepler": kepler,
    "henon-heiles": henon_heiles,
    "spring-pendulum": spring_pendulum,
    "fpu": fpu,
    "fput-beta": fput_beta,
    "outer-solar-system": outer_solar_system,
}


class Runner:
    def __init__(self, request):
        self.slope = SYSTEMS[request["system"]](request["parameters"])
        self.start = np.array(request["q"] + request["v"])
        self.span = (0.0, request["end"])
        self.tolerance = max(request["setting"], 3e-14)
        self.method = request["variant"]
        self.solution = None

    def reset(self):
        pass

    def run(self):
        self.solution = solve_ivp(
            self.slope, self.span, self.start, method=self.method, rtol=self.tolerance, atol=self.tolerance
        )

    def nothing(self):
        pass

    def end(self):
        if not self.solution.success:
            raise RuntimeError(self.solution.message)
        state = [repr(float(x)) for x in self.solution.y[:, -1]]
        half = len(state) // 2
        return state[:half], state[half:], len(self.solution.t) - 1


def build(request):
    return Runner(request)

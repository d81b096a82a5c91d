"""heyoka: adaptive Taylor series, compiled by LLVM. Variants: default, high-accuracy, long double, real128."""

import heyoka as hy
import numpy as np


def number_type(variant):
    return {"long double": np.longdouble, "real128": hy.real128}.get(variant, float)


def kepler(_, _n):
    x, y, u, v = hy.make_vars("x", "y", "u", "v")
    pull = (x**2 + y**2) ** (-1.5)
    return [(x, u), (y, v), (u, -x * pull), (v, -y * pull)]


def henon_heiles(_, _n):
    x, y, u, v = hy.make_vars("x", "y", "u", "v")
    return [(x, u), (y, v), (u, -x - 2.0 * x * y), (v, -y - x**2 + y**2)]


def spring_pendulum(parameters, _n):
    k, g = parameters
    x, y, u, v = hy.make_vars("x", "y", "u", "v")
    pull = k * (1.0 - (x**2 + y**2) ** (-0.5))
    return [(x, u), (y, v), (u, -pull * x), (v, -pull * y - g)]


def fpu(parameters, _n):
    m, omega = int(parameters[0]), parameters[1]
    q = hy.make_vars(*[f"q{i}" for i in range(2 * m)])
    p = hy.make_vars(*[f"p{i}" for i in range(2 * m)])
    springs = [q[0] - q[m]]
    springs += [q[i] - q[m + i] - q[i - 1] - q[m + i - 1] for i in range(1, m)]
    springs.append(q[m - 1] + q[2 * m - 1])
    # Products: the series of a power divides by its base, which is zero at the start.
    f = [d * d * d for d in springs]
    force = [f[i + 1] - f[i] for i in range(m)]
    force[m - 1] = -f[m] - f[m - 1]
    fast = [f[i] + f[i + 1] - omega**2 * q[m + i] for i in range(m)]
    fast[m - 1] = f[m - 1] - f[m] - omega**2 * q[2 * m - 1]
    return list(zip(q, p)) + list(zip(p, force + fast))


def fput_beta(parameters, _n):
    n, beta = int(parameters[0]), parameters[1]
    q = hy.make_vars(*[f"q{i}" for i in range(n)])
    p = hy.make_vars(*[f"p{i}" for i in range(n)])
    d = [q[0]] + [q[i + 1] - q[i] for i in range(n - 1)] + [-q[n - 1]]
    f = [d + beta * (d * d * d) for d in d]
    return list(zip(q, p)) + [(p[i], f[i + 1] - f[i]) for i in range(n)]


def pythagorean(masses, _n):
    q = hy.make_vars(*[f"q{i}" for i in range(6)])
    v = hy.make_vars(*[f"v{i}" for i in range(6)])
    acceleration = [[] for _ in range(6)]
    for i, j in ((0, 1), (0, 2), (1, 2)):
        d = [q[2 * i + k] - q[2 * j + k] for k in range(2)]
        inverse_cube = hy.sum([d[0] ** 2, d[1] ** 2]) ** (-1.5)
        for k in range(2):
            pull = d[k] * inverse_cube
            acceleration[2 * i + k].append(-masses[j] * pull)
            acceleration[2 * j + k].append(masses[i] * pull)
    return list(zip(q, v)) + [(u, hy.sum(a)) for u, a in zip(v, acceleration)]


SYSTEMS = {
    "pythagorean": pythagorean,
    "kepler": kepler,
    "henon-heiles": henon_heiles,
    "spring-pendulum": spring_pendulum,
    "fpu": fpu,
    "fput-beta": fput_beta,
}


class Runner:
    def __init__(self, request):
        self.kind = number_type(request["variant"])
        self.bodies = request["system"] == "outer-solar-system"
        q, v = request["q"], request["v"]
        if self.bodies:
            system = hy.model.nbody(len(q) // 3, masses=request["parameters"], Gconst=1.0)
            state = [x for i in range(0, len(q), 3) for x in q[i : i + 3] + v[i : i + 3]]
        else:
            system = SYSTEMS[request["system"]](request["parameters"], len(q))
            state = q + v
        self.start = np.array([self.kind(x) for x in state], dtype=self.kind)
        self.end_time = self.kind(request["end"])
        self.integrator = hy.taylor_adaptive(
            system,
            self.start,
            tol=self.kind(request["setting"]),
            fp_type=self.kind,
            high_accuracy=request["variant"] == "high accuracy",
            compact_mode=len(q) > 100,
        )
        self.steps = 0

    def reset(self):
        self.integrator.time = self.kind(0)
        self.integrator.state[:] = self.start

    def run(self):
        self.steps = self.integrator.propagate_until(self.end_time)[3]

    def nothing(self):
        self.integrator.propagate_until(self.end_time)

    def end(self):
        text = repr if self.kind is float else str
        if self.kind is np.longdouble:
            text = lambda x: np.format_float_scientific(x, unique=True)
        state = [text(float(x) if self.kind is float else x) for x in self.integrator.state]
        if self.bodies:
            blocks = [state[i : i + 3] for i in range(0, len(state), 3)]
            return sum(blocks[0::2], []), sum(blocks[1::2], []), self.steps
        half = len(state) // 2
        return state[:half], state[half:], self.steps


def build(request):
    return Runner(request)

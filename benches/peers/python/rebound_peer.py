"""REBOUND: IAS15 with its precision parameter, WHFast with a fixed step. For bodies under gravity only.

WHFast is run at its best: synchronised at the end only, with the symplectic corrector of order 17, and with the kernel named after it.
"""

import rebound


class Runner:
    def __init__(self, request):
        self.q, self.v, self.end_time = request["q"], request["v"], request["end"]
        self.variant, self.setting = request["variant"], request["setting"]
        self.kepler = request["system"] == "kepler"
        self.masses = [1.0, 0.0] if self.kepler else request["parameters"]
        self.dimension = len(self.q) // len(self.masses)
        self.simulation = None

    def reset(self):
        simulation = rebound.Simulation()
        if self.kepler:
            # A test particle about a mass at rest.
            simulation.add(m=1.0)
            simulation.add(m=0.0, x=self.q[0], y=self.q[1], vx=self.v[0], vy=self.v[1])
            simulation.N_active = 1
        else:
            # Positions and velocities in the plane or in space.
            d = self.dimension
            for i, mass in enumerate(self.masses):
                q, v = dict(zip("xyz", self.q[d * i :][:d])), dict(zip(("vx", "vy", "vz"), self.v[d * i :][:d]))
                simulation.add(m=mass, **q, **v)
        integrator, _, kernel = self.variant.partition(" ")
        simulation.integrator = integrator.lower()
        if integrator == "IAS15":
            simulation.integrator.epsilon = self.setting
            simulation.dt = 1e-3 * self.end_time
        else:
            simulation.integrator.safe_mode = 0
            simulation.integrator.corrector = 17
            simulation.integrator.kernel = kernel or "default"
            simulation.dt = self.end_time / self.setting
        self.simulation = simulation

    def run(self):
        self.simulation.integrate(self.end_time, exact_finish_time=1)

    def nothing(self):
        self.simulation.integrate(self.end_time)

    def end(self):
        self.simulation.synchronize()
        bodies = [self.simulation.particles[i] for i in range(self.simulation.N)]
        if self.kepler:
            body = bodies[1]
            q, v = [body.x, body.y], [body.vx, body.vy]
        else:
            q = [x for b in bodies for x in (b.x, b.y, b.z)[: self.dimension]]
            v = [x for b in bodies for x in (b.vx, b.vy, b.vz)[: self.dimension]]
        return [repr(x) for x in q], [repr(x) for x in v], self.simulation.steps_done


def build(request):
    return Runner(request)

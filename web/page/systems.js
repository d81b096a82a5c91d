// The example systems: H, initial condition, stages and step.

const eight = {
  q: "0.97000436, -0.24308753, -0.97000436, 0.24308753, 0, 0",
  p: "0.466203685, 0.43236573, 0.466203685, 0.43236573, -0.93240737, -0.86473146",
};

export const systems = [
  {
    name: "Kepler’s problem, e = 0.6",
    H: "(px^2 + py^2)/2 - 1/sqrt(x^2 + y^2)",
    q: "0.4, 0",
    p: "0, 2",
    stages: 3,
    step: "0.15",
    note: "A planet about the sun, started at its pericentre. The period is 2π.",
  },
  {
    name: "Pendulum near its separatrix",
    H: "p^2/2 - cos(q)",
    q: "0",
    p: "1.99",
    stages: 3,
    step: "0.3",
    note: "An angle q. With p = 2 the pendulum would come to rest upside down.",
  },
  {
    name: "Hénon–Heiles",
    H: "(px^2 + py^2 + x^2 + y^2)/2 + x^2*y - y^3/3",
    q: "0, -0.15",
    p: "0.55, 0",
    stages: 4,
    step: "0.3",
    note: "The motion of a star in a galaxy, chaotic for most initial conditions of this energy.",
  },
  {
    name: "Double well",
    H: "p^2/2 + (q^2 - 1)^2/4",
    q: "0",
    p: "0.05",
    stages: 3,
    step: "0.3",
    note: "Two wells. The motion passes close to the unstable equilibrium q = 0, p = 0.",
  },
  {
    name: "Three bodies on a figure eight",
    H:
      "(p1^2 + p2^2 + p3^2 + p4^2 + p5^2 + p6^2)/2 - 1/hypot(q1 - q3, q2 - q4)" +
      " - 1/hypot(q1 - q5, q2 - q6) - 1/hypot(q3 - q5, q4 - q6)",
    q: eight.q,
    p: eight.p,
    stages: 3,
    step: "0.1",
    note: "Three equal masses on one closed curve (Chenciner, Montgomery 2000). The period is 6.3259.",
  },
];

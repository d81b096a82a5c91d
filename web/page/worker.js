// The simulation, in a thread of its own: the page never waits for it.

import init, { Simulation, constant } from "./pkg/equip_web.js";

const ready = init();
let simulation = null;

// Numbers of a field, separated by commas; each may be a formula such as sqrt(2).
function numbers(text, what) {
  const parts = text.split(",").map((part) => part.trim());
  if (parts.at(-1) === "") parts.pop();
  return Float64Array.from(parts, (part, i) => number(part, `${what} ${i + 1}`));
}

function number(text, what) {
  try {
    return constant(text);
  } catch (error) {
    throw new Error(`${what}: ${error.message}`);
  }
}

function start({ energy, q, p, stages, step }) {
  simulation?.free();
  simulation = null;
  const positions = numbers(q, "initial position");
  const momenta = numbers(p, "initial momentum");
  simulation = new Simulation(energy, positions, momenta, stages, number(step, "step size"));
  return {
    kind: "started",
    q: positions,
    p: momenta,
    initialEnergy: simulation.initialEnergy,
    hasEquip: stages > 1,
  };
}

// At most `steps` steps, in at most about `milliseconds`.
function advance({ steps, milliseconds }) {
  const begun = performance.now();
  const parts = [];
  let made = 0;
  let failure;
  while (made < steps && failure === undefined && performance.now() - begun < milliseconds) {
    const progress = simulation.advance(Math.min(8, steps - made));
    const { times, equipQ, equipP, equipErrors, gaussQ, gaussP, gaussErrors } = progress;
    failure = progress.failure;
    progress.free();
    made += times.length;
    parts.push({ times, equipQ, equipP, equipErrors, gaussQ, gaussP, gaussErrors });
  }
  return {
    kind: "advanced",
    parts,
    made,
    seconds: (performance.now() - begun) / 1000,
    failure,
    roundOffLevel: simulation.roundOffLevel,
    verdict: simulation.verdict,
    uncorrected: simulation.uncorrected,
    equipDigits: simulation.equipDigits,
    gaussDigits: simulation.gaussDigits,
  };
}

onmessage = async ({ data }) => {
  let answer;
  try {
    await ready;
    answer = data.kind === "start" ? start(data) : advance(data);
  } catch (error) {
    // A trap leaves the memory of the module undefined: the page starts another worker.
    const isTrap = error instanceof WebAssembly.RuntimeError;
    const message = isTrap ? `the computation stopped: ${error.message}` : error.message;
    answer = { kind: "refused", message, isTrap };
  }
  postMessage({ ...answer, run: data.run });
};

// The controls of the page: one run at a time, computed by a worker, drawn once per frame.

import { Errors, States } from "./history.js";
import { axesOf, drawErrors, drawTrajectory } from "./pictures.js";
import { Plot } from "./plot.js";
import { systems } from "./systems.js";

const at = (id) => document.getElementById(id);
const fields = ["energy", "q", "p", "stages", "step"];
const plots = { trajectory: new Plot(at("trajectory")), errors: new Plot(at("errors")) };

let worker = null;
let isBusy = false;
let run = null; // what is kept of the run; null as long as there is none
let runNumber = 0;
let isRunning = false;
let isChanged = true; // whether the pictures are to be drawn anew
let lastFrame = 0;
let due = 0; // steps that the chosen speed allows

// A worker that computes cannot be interrupted, so it is replaced.
function freshWorker() {
  if (worker && !isBusy) return;
  worker?.terminate();
  worker = new Worker(new URL("worker.js", import.meta.url), { type: "module" });
  worker.onmessage = ({ data }) => receive(data);
  worker.onerror = (event) => refuse(`the library could not be loaded (${event.message || "no answer"}): build it by web/build`, true);
  isBusy = false;
}

function send(message) {
  isBusy = true;
  worker.postMessage({ ...message, run: runNumber });
}

// A new run with the values of the fields.
function start(runs) {
  freshWorker();
  runNumber += 1;
  run = null;
  isRunning = runs;
  isChanged = true;
  say("");
  const values = Object.fromEntries(fields.map((id) => [id, at(id).value]));
  history.replaceState(null, "", `#${new URLSearchParams(values)}`);
  send({ kind: "start", ...values, stages: Number(values.stages) });
  show();
}

function receive(data) {
  isBusy = false;
  if (data.run !== runNumber) return;
  if (data.kind === "refused") refuse(data.message, data.isTrap);
  else if (data.kind === "started") begin(data);
  else advanced(data);
  isChanged = true;
  show();
}

function begin({ q, p, initialEnergy, hasEquip }) {
  const initial = [...q, ...p];
  run = {
    m: q.length,
    initialEnergy,
    equip: hasEquip ? new States(initial) : null,
    gauss: new States(initial),
    equipErrors: new Errors(),
    gaussErrors: new Errors(),
    roundOffLevel: 2 ** -52,
    steps: 0,
    seconds: 0,
    hasEnded: false,
  };
  const choices = axesOf(run.m);
  const titles = choices.map(([title]) => title);
  const select = at("axes");
  if (titles.join() !== [...select.options].map((option) => option.text).join()) {
    select.replaceChildren(...titles.map((title, i) => new Option(title, i)));
  }
  select.hidden = choices.length < 2;
  due = 0;
}

function advanced({ parts, made, seconds, failure, ...report }) {
  const { m } = run;
  const part = (values, i) => values.subarray(i * m, (i + 1) * m);
  for (const { times, equipQ, equipP, equipErrors, gaussQ, gaussP, gaussErrors } of parts) {
    for (let i = 0; i < times.length; i++) {
      run.gauss.push(part(gaussQ, i), part(gaussP, i));
      run.gaussErrors.push(times[i], gaussErrors[i]);
      if (!run.equip) continue;
      run.equip.push(part(equipQ, i), part(equipP, i));
      run.equipErrors.push(times[i], equipErrors[i]);
    }
    if (times.length) run.time = times.at(-1);
  }
  run.steps += made;
  run.seconds += seconds;
  Object.assign(run, report);
  if (failure === undefined) return;
  run.hasEnded = true;
  isRunning = false;
  say(`The run has ended. ${failure}`);
}

function refuse(message, isTrap) {
  isRunning = false;
  isBusy = isBusy || isTrap;
  if (run) run.hasEnded = true;
  say(message);
  show();
}

function say(message) {
  at("message").textContent = message.charAt(0).toUpperCase() + message.slice(1);
  at("message").hidden = message === "";
}

const exponential = (x) => (Number.isFinite(x) ? x.toExponential(1).replace("-", "−") : "infinite");
const counted = (n, noun) => `${n.toLocaleString("en")} ${noun}${n === 1 ? "" : "s"}`;

// All texts that depend on the run.
function show() {
  at("run").textContent = isRunning ? "Pause" : run?.steps ? "Continue" : "Start";
  at("run").disabled = Boolean(run?.hasEnded);
  at("stages-value").textContent = `${at("stages").value}, order ${2 * at("stages").value}`;
  const hasSteps = Boolean(run?.steps);
  const hasEquip = hasSteps && Boolean(run.equip);
  at("equip-error").textContent = hasEquip ? exponential(run.equipErrors.max) : "–";
  at("equip-digits").textContent = hasEquip ? run.equipDigits.toFixed(1) : "–";
  at("equip-uncorrected").textContent = hasEquip ? `${run.uncorrected.toLocaleString("en")} of ${run.steps.toLocaleString("en")}` : "–";
  at("gauss-error").textContent = hasSteps ? exponential(run.gaussErrors.max) : "–";
  at("gauss-digits").textContent = hasSteps ? run.gaussDigits.toFixed(1) : "–";
  const none = run && !run.equip ? "EQUIP needs 2 stages or more" : "–";
  at("verdict").textContent = hasEquip ? run.verdict : none;
  const { width } = run?.gaussErrors ?? { width: 1 };
  const every = width > 1 ? `Each point of the energy error is the largest of ${width} steps. ` : "";
  const tail = run?.gauss.dropped ? `The trajectory has the last ${counted(run.gauss.mostShown, "state")}.` : "";
  at("detail").textContent = every + tail;
  const isFast = at("speed").value === "Infinity" && run?.seconds > 0.5;
  const perSecond = isFast ? counted(Math.round(run.steps / run.seconds), "step") : "";
  const rate = isFast ? `, ${perSecond} of both methods per second of computing` : "";
  const initial = run?.initialEnergy.toPrecision(6).replace("-", "−");
  const reached = hasSteps ? `${counted(run.steps, "step")} to t = ${run.time.toFixed(2)}` : "";
  at("progress").textContent = hasSteps ? `H₀ = ${initial}, ${reached}${rate}.` : "";
}

function draw() {
  isChanged = false;
  const shown = run ?? emptyRun();
  const [, pairs] = axesOf(shown.m)[run ? at("axes").value : 0] ?? axesOf(shown.m)[0];
  drawTrajectory(plots.trajectory, shown, pairs);
  drawErrors(plots.errors, shown);
}

function emptyRun() {
  const none = () => new States([NaN, NaN]);
  return {
    m: 1,
    initialEnergy: 1,
    equip: none(),
    gauss: none(),
    equipErrors: new Errors(),
    gaussErrors: new Errors(),
    roundOffLevel: 2 ** -52,
  };
}

function frame(now) {
  const elapsed = Math.min(0.1, (now - lastFrame) / 1000);
  lastFrame = now;
  if (isRunning && run && !isBusy) {
    // 0 × ∞ is no number.
    due = Math.min(due + (elapsed * Number(at("speed").value) || 0), 1e6);
    const steps = Math.floor(due);
    if (steps > 0) {
      due -= steps;
      send({ kind: "advance", steps, milliseconds: 25 });
    }
  }
  if (isChanged) draw();
  requestAnimationFrame(frame);
}

function choose({ H, q, p, stages, step, note }) {
  Object.assign(at("energy"), { value: H });
  Object.assign(at("q"), { value: q });
  Object.assign(at("p"), { value: p });
  Object.assign(at("stages"), { value: stages });
  Object.assign(at("step"), { value: step });
  at("note").textContent = note;
}

// The system that a link names: its parameters are the fields.
function chooseLinked() {
  const linked = new URLSearchParams(location.hash.slice(1));
  if (!linked.has("energy")) return false;
  for (const id of fields) if (linked.has(id)) at(id).value = linked.get(id);
  const index = systems.findIndex(({ H }) => H === linked.get("energy"));
  at("system").value = index < 0 ? "own" : index;
  at("note").textContent = systems[index]?.note ?? "";
  return true;
}

at("system").replaceChildren(
  ...systems.map(({ name }, i) => new Option(name, i)),
  new Option("your own H", "own"),
);
at("system").addEventListener("change", ({ target }) => {
  if (target.value === "own") return at("energy").focus();
  choose(systems[target.value]);
  start(true);
});
at("controls").addEventListener("submit", (event) => {
  event.preventDefault();
  if (!run) return start(true);
  isRunning = !isRunning;
  show();
});
at("reset").addEventListener("click", () => start(false));
for (const id of fields) {
  at(id).addEventListener("input", show);
  at(id).addEventListener("change", () => {
    const isExample = systems[at("system").value]?.H === at("energy").value;
    if (!isExample) at("system").value = "own";
    if (!isExample) at("note").textContent = "";
    start(isRunning);
  });
}
at("axes").addEventListener("change", () => (isChanged = true));
addEventListener("resize", () => (isChanged = true));
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => (isChanged = true));

if (!chooseLinked()) choose(systems[0]);
start(!matchMedia("(prefers-reduced-motion: reduce)").matches);
requestAnimationFrame(frame);

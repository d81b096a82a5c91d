// The two pictures of a run: trajectories, and energy errors over time.

// Gauss is a wide line below the thin one of EQUIP: both show where they agree.
const EQUIP = { name: "EQUIP", colour: "equip", width: 1.5 };
const GAUSS = { name: "Gauss", colour: "gauss", width: 4 };

// What the axes of the trajectory may show: [title, pairs of components of (q, p)].
export function axesOf(m) {
  if (m === 1) return [["p over q", [[0, 1]]]];
  const name = (i) => (i < m ? `q${i + 1}` : `p${i - m + 1}`);
  const pair = ([across, up]) => [`${name(up)} over ${name(across)}`, [[across, up]]];
  const all = [];
  if (m >= 4 && m % 2 === 0) {
    const bodies = Array.from({ length: m / 2 }, (_, i) => [2 * i, 2 * i + 1]);
    all.push([`${m / 2} bodies in the plane`, bodies]);
  }
  for (let i = 0; i + 1 < m; i++) all.push(pair([i, i + 1]));
  for (let i = 0; i < m; i++) all.push(pair([i, m + i]));
  return all;
}

function titles(m, pairs) {
  const name = (i) => {
    if (m === 1) return i === 0 ? "position q" : "momentum p";
    const letters = { 2: "xy", 3: "xyz" }[m]?.[i % m];
    const number = i < m ? `q${i + 1}` : `p${i - m + 1}`;
    const other = letters ? ` (${i < m ? letters : `p${letters}`})` : "";
    return `${i < m ? "position" : "momentum"} ${number}${other}`;
  };
  if (pairs.length > 1) return ["positions x: q1, q3, …", "positions y: q2, q4, …"];
  return pairs[0].map(name);
}

function range(values) {
  let [low, high] = [Infinity, -Infinity];
  for (const value of values) {
    if (Number.isFinite(value)) [low, high] = [Math.min(low, value), Math.max(high, value)];
  }
  if (low > high) return { low: -1, high: 1 };
  const margin = 0.06 * (high - low) || 0.5 * Math.max(1e-3, Math.abs(low));
  return { low: low - margin, high: high + margin };
}

export function drawTrajectory(plot, run, pairs) {
  const { m } = run;
  const tracks = [
    { states: run.gauss.last(), style: GAUSS, isHollow: true },
    ...(run.equip ? [{ states: run.equip.last(), style: EQUIP, isHollow: false }] : []),
  ];
  const of = (side) =>
    tracks.flatMap(({ states }) => pairs.flatMap((pair) => states.map((state) => state[pair[side]])));
  const [across, up] = titles(m, pairs);
  const isInPlane = pairs.every(([a, b]) => a < m && b < m);
  plot.frame({
    x: { ...range(of(0)), title: across },
    y: { ...withRoomForLegend(range(of(1))), title: up },
    isEqual: isInPlane,
  });
  for (const { states, style, isHollow } of tracks) {
    for (const [a, b] of pairs) {
      plot.line(states.length, (i) => [states[i][a], states[i][b]], style);
      const end = states.at(-1);
      plot.dot([end[a], end[b]], { ...style, radius: isHollow ? 7 : 4, isHollow });
    }
  }
  plot.legend(run.equip ? [EQUIP, GAUSS] : [GAUSS]);
}

function withRoomForLegend({ low, high }) {
  return { low, high: high + 0.1 * (high - low) };
}

export function drawErrors(plot, run) {
  const curves = [
    { errors: run.gaussErrors, style: { ...GAUSS, width: 2.5 } },
    ...(run.equip ? [{ errors: run.equipErrors, style: EQUIP }] : []),
  ];
  const largest = Math.max(...curves.map(({ errors }) => (errors.max < 1e300 ? errors.max : 1e300)), 1e-14);
  const reached = curves[0].errors.times.at(-1) || 1; // negative where h is
  const relative = run.initialEnergy === 0 ? "energy error |H − H₀|" : "energy error |H − H₀| / |H₀|";
  plot.frame({
    x: { low: Math.min(0, reached), high: Math.max(0, reached), title: "time t" },
    y: { low: -17, high: Math.max(-12, Math.ceil(Math.log10(largest)) + 2), title: relative, isLog: true },
  });
  plot.bandBelow(Math.log10(run.roundOffLevel), "round-off level of H");
  for (const { errors, style } of curves) {
    const { times, largest } = errors;
    const point = (i) => (largest[i] > 0 ? [times[i], Math.log10(largest[i])] : undefined);
    plot.line(times.length, point, style);
  }
  plot.legend(run.equip ? [EQUIP, GAUSS] : [GAUSS]);
}

// What is kept of a run for the pictures. Memory is bounded however long the run is.

const MOST_BUCKETS = 1500;
const MOST_STATES = 600;

// Energy errors over time: the largest of `width` steps each. The width doubles when there are too many buckets.
// Exact zeros are no points of a logarithmic axis.
export class Errors {
  constructor() {
    this.width = 1;
    this.times = [];
    this.largest = [];
    this.steps = 0;
    this.max = 0;
  }

  push(time, error) {
    if (this.steps % this.width === 0) {
      if (this.times.length === MOST_BUCKETS) this.#merge();
      this.times.push(time);
      this.largest.push(0);
    }
    this.steps += 1;
    const last = this.largest.length - 1;
    if (error > this.largest[last]) {
      this.times[last] = time;
      this.largest[last] = error;
    }
    // An infinite error and NaN count as infinite.
    if (!(error <= this.max)) this.max = Number.isFinite(error) ? error : Infinity;
  }

  #merge() {
    const merged = this.times.length / 2;
    for (let i = 0; i < merged; i++) {
      const one = this.largest[2 * i] >= this.largest[2 * i + 1] ? 2 * i : 2 * i + 1;
      this.times[i] = this.times[one];
      this.largest[i] = this.largest[one];
    }
    this.times.length = merged;
    this.largest.length = merged;
    this.width *= 2;
  }
}

// The last states of one method, as arrays (q, p).
export class States {
  constructor(initial) {
    this.states = [initial];
    this.dropped = false;
  }

  push(q, p) {
    this.states.push([...q, ...p]);
    if (this.states.length > 2 * MOST_STATES) {
      this.states.splice(0, this.states.length - MOST_STATES);
      this.dropped = true;
    }
  }

  // The states that are drawn: at most so many.
  last() {
    return this.states.slice(-MOST_STATES);
  }

  get mostShown() {
    return MOST_STATES;
  }
}

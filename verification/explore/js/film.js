// One run: its head and the frames that have come, and what is seen at a time between two of them.

export class Film {
  constructor(head, painter) {
    this.head = head;
    this.painter = painter;
    this.frames = [];
    this.box = [...head.box]; // left, right, low, high of all that has been seen
    this.status = "";
    this.detail = "";
  }

  add(header, columns) {
    const frame = this.painter.read(this.head, header, columns, this.frames.at(-1));
    this.frames.push(frame);
    this.box = this.painter.around(frame, this.box, this.head);
  }

  /** It ends where the run ended, which may have failed. */
  finish(status, detail) {
    this.status = status;
    this.detail = detail;
  }

  get complete() {
    return this.status !== "";
  }

  get last() {
    return this.frames.length ? this.frames.at(-1).t : 0;
  }

  /** The last time that it can have. */
  get end() {
    return this.complete ? this.last : this.head.end;
  }

  /** The number of the last frame that is not after t. */
  before(t) {
    let low = 0;
    let high = this.frames.length - 1;
    while (low < high) {
      const middle = Math.ceil((low + high) / 2);
      if (this.frames[middle].t <= t) low = middle;
      else high = middle - 1;
    }
    return low;
  }

  /** What is seen at t, or at the last time that has come: frames a and b, and how far it is from a to b. */
  at(t) {
    const k = this.before(t);
    const a = this.frames[k];
    const b = this.frames[Math.min(k + 1, this.frames.length - 1)];
    const part = b.t > a.t ? Math.min(1, Math.max(0, (t - a.t) / (b.t - a.t))) : 0;
    return { a, b, part, t: a.t + part * (b.t - a.t) };
  }
}

/** The number of the disc, of so many, that a place lies in; the one whose edge is farthest, null if it is none. */
export function hit(n, where, [x, y], radius) {
  let [best, nearest] = [null, 0];
  for (let i = 0; i < n; i++) {
    const distance = Math.hypot(where("x", i) - x, where("y", i) - y) - radius(i);
    if (distance < nearest) [best, nearest] = [i, distance];
  }
  return best;
}

/** Where the cells of a are between a and b, by their ids: a function of a column's name and a place. */
export function between(a, b, part) {
  if (part === 0 || a === b) return (name, i) => a[name][i];
  return (name, i) => {
    const j = b.places.get(a.id[i]);
    return j === undefined ? a[name][i] : a[name][i] + part * (b[name][j] - a[name][i]);
  };
}

// The painter of particles: discs to scale, what holds them, how deep they violate it, and where the reference is.

import { between, hit } from "./film.js";
import { disc, polyline } from "./view.js";

const [FREE, DEEP, REFERENCE, WALL, PAPER] = ["#4b82bb", "#c8232c", "#000000", "#8a8a8a", "#f1efe9"];
const POINT = 3; // pixels, of a particle without a radius
const VISIBLE = 1e-3; // of the picture: violations below are no colour

export const discs = {
  colourings: {},

  read(head, header, columns, before) {
    const n = header.particles;
    const frame = { t: header.t, n, overlap: header.overlap, error: header.error };
    for (const name of ["x", "y", "deep"]) frame[name] = columns.numbers(n);
    if (head.reference) for (const name of ["rx", "ry"]) frame[name] = columns.numbers(n);
    frame.shapes = header.shapes || (before ? before.shapes : []);
    return frame;
  },

  around(frame, [left, right, low, high], head) {
    for (let i = 0; i < frame.n; i++) {
      const radius = head.radius[i] || 0;
      left = Math.min(left, frame.x[i] - radius);
      right = Math.max(right, frame.x[i] + radius);
      low = Math.min(low, frame.y[i] - radius);
      high = Math.max(high, frame.y[i] + radius);
    }
    return [left, right, low, high];
  },

  draw(view, film, { a, b, part }, { followed }) {
    const pen = view.begin();
    const where = between(a, b, part);
    for (const shape of a.shapes) SHAPES[shape.type](view, shape, where);
    const size = VISIBLE * (film.box[1] - film.box[0]);
    for (let i = 0; i < a.n; i++) {
      pen.fillStyle = where("deep", i) > size ? DEEP : FREE;
      pen.globalAlpha = 0.65;
      disc(pen, where("x", i), where("y", i), film.head.radius[i] || view.pixels(POINT));
      pen.fill();
      pen.globalAlpha = 1;
    }
    if (film.head.reference) references(view, film.head, a, where);
    if (followed !== null && followed < a.n) ring(view, film.head, where, followed);
    view.bar(film.head.unit);
    return pen;
  },

  pick(head, { a, b, part }, place) {
    return hit(a.n, between(a, b, part), place, (i) => head.radius[i] || 0);
  },

  describe(head, { a }, i) {
    return `particle ${i} at (${a.x[i].toFixed(3)}, ${a.y[i].toFixed(3)}), violation ${a.deep[i].toExponential(1)}`;
  },

  caption({ a, t }) {
    const error = a.error === null ? "" : ` · error ${a.error.toExponential(1)}`;
    return `t = ${t.toPrecision(3)} · overlap ${a.overlap.toExponential(1)}${error}`;
  },

  legend(head) {
    const names = [["particle", FREE], ["violates a constraint", DEEP]];
    if (head.reference) names.push(["reference (outline)", REFERENCE]);
    return names.map(([name, colour]) => ({ name, colour }));
  },
};

const SHAPES = {
  /** What is admissible is where normal . x >= offset. */
  wall(view, { normal: [nx, ny], offset }) {
    const { pen } = view;
    const [left, right, low, high] = view.sides();
    const far = right - left + high - low;
    const [x, y] = [nx * offset, ny * offset];
    const along = (side) => [x - side * far * ny, y + side * far * nx];
    const beyond = ([px, py]) => [px - far * nx, py - far * ny];
    polyline(pen, [along(-1), along(1), beyond(along(1)), beyond(along(-1))], true);
    pen.fillStyle = PAPER;
    pen.fill();
    polyline(pen, [along(-1), along(1)]);
    line(view, WALL);
  },

  ball(view, { centre: [x, y], radius, inside }) {
    const { pen } = view;
    disc(pen, x, y, radius);
    pen.fillStyle = PAPER;
    if (!inside) pen.fill();
    line(view, WALL);
  },

  bond(view, { pairs }, where) {
    for (const [i, j] of pairs) {
      polyline(view.pen, [i, j].map((k) => [where("x", k), where("y", k)]));
      line(view, WALL);
    }
  },

  curve(view, { points }) {
    polyline(view.pen, points);
    line(view, WALL);
  },
};

function line(view, colour) {
  view.pen.strokeStyle = colour;
  view.pen.lineWidth = view.pixels(1.5);
  view.pen.stroke();
}

function references(view, head, a, where) {
  for (let i = 0; i < a.n; i++) {
    disc(view.pen, where("rx", i), where("ry", i), head.radius[i] || view.pixels(POINT));
    line(view, REFERENCE);
  }
}

function ring(view, head, where, i) {
  disc(view.pen, where("x", i), where("y", i), 1.1 * (head.radius[i] || view.pixels(POINT)));
  line(view, DEEP);
}

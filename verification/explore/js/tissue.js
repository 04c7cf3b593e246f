// The painter of a tissue: nuclei to scale, springs, apical and basal layer, as in the pictures of tissue/pictures.

import { between, hit } from "./film.js";
import { disc, polyline } from "./view.js";

export const [SPRING, APICAL, BASAL, BELOW, PAPER] = ["#5d6670", "#c8232c", "#1d1d1d", "#f1efe9", "#ffffff"];
const FREE_APICAL = 1;
const FREE_BASAL = 2;
const LENGTHS = ["x", "y", "ax", "ay", "bx", "by", "radius"];
const RAMP = ["#a31621", "#efe6da", "#2b6cb0"]; // of y_AB from basal to apical
const COLOURINGS = { phase: "phase, events", type: "type", yab: "position y_AB" };

export const tissue = {
  colourings: COLOURINGS,

  read(head, header, columns) {
    const frame = cellsOf(header, columns, LENGTHS);
    frame.layer = columns.integers(header.layer);
    frame.chains = header.chains.map((k) => columns.integers(k));
    return frame;
  },

  around(frame, [left, right, low, high], head) {
    for (let i = 0; i < frame.n; i++) {
      left = Math.min(left, frame.x[i] - head.soft, frame.ax[i], frame.bx[i]);
      right = Math.max(right, frame.x[i] + head.soft, frame.ax[i], frame.bx[i]);
      low = Math.min(low, frame.y[i] - head.soft, frame.ay[i], frame.by[i]);
      high = Math.max(high, frame.y[i] + head.soft, frame.ay[i], frame.by[i]);
    }
    return [left, right, low, high];
  },

  draw(view, film, { a, b, part }, { colouring, followed }) {
    const pen = view.begin();
    const where = between(a, b, part);
    const colours = Array.from({ length: a.n }, (_, i) => colourOf(film.head, a, i, colouring, where));
    basalLayer(view, film.head);
    nuclei(view, film.head, a, where, colours);
    layers(view, film.head, a, where);
    if (followed !== null) trail(view, film, a, where, followed);
    view.bar(film.head.unit);
    return pen;
  },

  /** The id of the cell at a place, null if there is none. */
  pick(head, { a, b, part }, place) {
    const i = hit(a.n, between(a, b, part), place, () => head.soft);
    return i === null ? null : a.id[i];
  },

  describe(head, { a }, id) {
    const i = a.places.get(id);
    if (i === undefined) return `cell ${id} is not here`;
    const look = a.look[i] < 0 ? head.phases[a.phase[i]].name : `events: ${head.looks[a.look[i]].name || "none"}`;
    return `cell ${id}, ${head.types[a.kind[i]].name}, ${look}, y_AB = ${a.folded ? "none" : a.yab[i].toFixed(2)}`;
  },

  caption({ a, t }) {
    const height = a.height === null ? "" : ` · height ${a.height.toFixed(1)} µm`;
    const folded = a.folded ? `folded, no height: ${a.folded} · ` : "";
    return `${folded}t = ${t.toFixed(1)} h · ${a.n} cells${height}`;
  },

  legend(head, colouring) {
    if (colouring === "yab") return [0, 0.5, 1].map((y) => ({ name: `y_AB = ${y}`, colour: ramp(y) }));
    if (colouring === "type") return head.types;
    const events = head.looks.map(({ name, colour }) => ({ name: name ? `EMT [${name}]` : "EMT, no event", colour }));
    return [...head.phases, ...events];
  },
};

/** The cells of a frame: ids, lengths, kinds, positions y_AB, and the place of each id. */
export function cellsOf(header, columns, lengths) {
  const n = header.cells;
  const frame = { t: header.t, n, height: header.height, folded: header.folded, id: columns.integers(n) };
  for (const name of lengths) frame[name] = columns.numbers(n);
  for (const name of ["phase", "kind", "look", "free"]) frame[name] = columns.integers(n);
  frame.yab = columns.numbers(n);
  frame.places = new Map(Array.from(frame.id, (id, i) => [id, i]));
  return frame;
}

export function colourOf(head, frame, i, colouring, where) {
  if (colouring === "yab") return ramp(where("yab", i));
  if (colouring === "type") return head.types[frame.kind[i]].colour;
  return frame.look[i] < 0 ? head.phases[frame.phase[i]].colour : head.looks[frame.look[i]].colour;
}

/** Between three colours, over y_AB from 0 to 1. */
function ramp(y) {
  const place = 2 * Math.min(1, Math.max(0, y));
  const [first, second] = place < 1 ? RAMP : RAMP.slice(1);
  const part = place < 1 ? place : place - 1;
  const mix = [1, 3, 5].map((k) => {
    const [from, to] = [first, second].map((colour) => parseInt(colour.slice(k, k + 2), 16));
    return Math.round(from + part * (to - from));
  });
  return `rgb(${mix.join(",")})`;
}

/** The layer, and in grey the side where the tissue is not. */
export function basalLayer(view, head) {
  const { pen } = view;
  const [left, right, low, high] = view.sides();
  pen.lineWidth = view.pixels(1.5);
  pen.strokeStyle = BASAL;
  const line = head.layer.length ? head.layer : [[left, 0], [right, 0]];
  if (!head.layer.length || (head.closed && head.inside)) {
    pen.fillStyle = BELOW;
    pen.fillRect(left, low, right - left, (head.layer.length ? high : Math.min(0, high)) - low);
  }
  polyline(pen, line, head.closed);
  if (head.closed) {
    pen.fillStyle = head.inside ? PAPER : BELOW;
    pen.fill();
  }
  pen.stroke();
}

export function nuclei(view, head, a, where, colours, shown = Array.from({ length: a.n }, (_, i) => i)) {
  const { pen } = view;
  for (const i of shown) {
    pen.fillStyle = pen.strokeStyle = colours[i];
    pen.lineWidth = view.pixels(0.5);
    disc(pen, where("x", i), where("y", i), head.soft);
    pen.globalAlpha = 0.22;
    pen.fill();
    pen.globalAlpha = 0.8;
    pen.stroke();
  }
  pen.globalAlpha = 0.55;
  pen.strokeStyle = SPRING;
  pen.lineWidth = view.pixels(0.8);
  pen.beginPath();
  for (const i of shown) {
    pen.moveTo(where("ax", i), where("ay", i));
    pen.lineTo(where("x", i), where("y", i));
    pen.lineTo(where("bx", i), where("by", i));
  }
  pen.stroke();
  pen.globalAlpha = 1;
  for (const i of shown) {
    disc(pen, where("x", i), where("y", i), where("radius", i));
    pen.fillStyle = colours[i];
    pen.fill();
    pen.strokeStyle = a.look[i] < 0 ? PAPER : "#000000";
    pen.stroke();
  }
}

function layers(view, head, a, where) {
  const { pen } = view;
  const apical = (i) => [where("ax", i), where("ay", i)];
  pen.strokeStyle = APICAL;
  pen.lineWidth = view.pixels(1.8);
  polyline(pen, Array.from(a.layer, apical), head.ring);
  pen.stroke();
  pen.setLineDash([view.pixels(4), view.pixels(2)]);
  pen.lineWidth = view.pixels(1.2);
  for (const chain of a.chains) {
    polyline(pen, Array.from(chain, apical));
    pen.stroke();
  }
  pen.setLineDash([]);
  for (let i = 0; i < a.n; i++) {
    mark(view, ...apical(i), APICAL, a.free[i] & FREE_APICAL);
    mark(view, where("bx", i), where("by", i), BASAL, a.free[i] & FREE_BASAL);
  }
}

/** A dot on a layer, a cross where a point has left it. */
export function mark(view, x, y, colour, free) {
  const { pen } = view;
  const size = view.pixels(free ? 3 : 1.5);
  if (!free) {
    pen.fillStyle = colour;
    disc(pen, x, y, size);
    pen.fill();
    return;
  }
  pen.strokeStyle = colour;
  pen.lineWidth = view.pixels(1.4);
  for (const side of [1, -1]) {
    polyline(pen, [[x - size, y - side * size], [x + size, y + side * size]]);
    pen.stroke();
  }
}

/** A ring around the cell that is followed, and where its nucleus has been. */
function trail(view, film, a, where, id) {
  const i = a.places.get(id);
  if (i === undefined) return;
  const { pen } = view;
  const past = film.frames.filter((frame) => frame.t <= a.t && frame.places.has(id));
  const points = past.map((frame) => [frame.x[frame.places.get(id)], frame.y[frame.places.get(id)]]);
  pen.strokeStyle = "#000000";
  pen.lineWidth = view.pixels(1);
  polyline(pen, [...points, [where("x", i), where("y", i)]]);
  pen.stroke();
  pen.lineWidth = view.pixels(2.5);
  disc(pen, where("x", i), where("y", i), film.head.soft);
  pen.stroke();
}

// The painter of a tissue in space: the sheet, which turns under the mouse, and beside it the section that a slider moves.

import { between } from "./film.js";
import { cutThrough, images, nearest, triangles, turned } from "./space.js";
import { APICAL, BASAL, basalLayer, cellsOf, colourOf, mark, nuclei, tissue } from "./tissue.js";
import { disc, polyline } from "./view.js";

const LENGTHS = ["x", "y", "z", "ax", "ay", "az", "bx", "by", "bz", "radius"];
const GLASS = { fill: 0.1, edge: 0.35 }; // of the apical layer, through which nuclei are seen
const CUT_WIDTH = 2; // pixels
const MARGIN = 1.06; // around all that is seen
const LIGHT = 0.45; // of the way to white, where a nucleus is brightest
const SPRITE = 64; // pixels of the picture of a nucleus

export const sheet = {
  colourings: tissue.colourings,
  turns: true,

  read(head, header, columns) {
    const frame = cellsOf(header, columns, LENGTHS);
    frame.triangles = columns.integers(3 * header.triangles);
    return frame;
  },

  around(frame, box, head) {
    return tissue.around(frame, box, head);
  },

  draw(view, film, { a, b, part }, { colouring, followed, turn, cut }) {
    const pen = view.begin();
    const { head } = film;
    const where = between(a, b, part);
    const points = images(head, a, where);
    const colours = Array.from({ length: a.n }, (_, i) => colourOf(head, a, i, colouring, where));
    const corners = triangles(head, a, points);
    const pieces = cutThrough(corners, cut, head.periods[1]);
    const [left, right] = panes(view.canvas);
    film.drawn = [];
    view.into(left, ball(film, points));
    solid(view, film, { a, where, points, colours, corners, pieces, turn, followed });
    pen.setTransform(1, 0, 0, 1, 0, 0);
    pen.clearRect(...right);
    view.into(right, view.box);
    section(view, film, { a, where, points, colours, pieces, cut, followed });
    view.bar(head.unit);
    return pen;
  },

  /** The id of the cell whose nucleus is in front at a pixel of the canvas, null if there is none. */
  pick(head, moment, place, film, [x, y]) {
    const under = film.drawn.filter((one) => Math.hypot(one.x - x, one.y - y) <= one.radius);
    return under.length ? under.at(-1).id : null;
  },

  describe: tissue.describe,
  caption: tissue.caption,
  legend: tissue.legend,
};

/** Two parts of the canvas: side by side, or one above the other where that is the longer side. */
function panes({ width, height }) {
  if (width >= height) return [[0, 0, width / 2, height], [width / 2, 0, width / 2, height]];
  return [[0, 0, width, height / 2], [0, height / 2, width, height / 2]];
}

/** The box of the smallest ball around the middle of the cells that holds all of them, so that no turn leaves it. */
function ball(film, points) {
  const all = points.flatMap(({ nucleus, apical, basal }) => [nucleus, apical, basal]);
  const middle = [0, 1, 2].map((k) => {
    const values = all.map((point) => point[k]);
    return (Math.min(...values) + Math.max(...values)) / 2;
  });
  const far = Math.max(...all.map((point) => Math.hypot(...point.map((value, k) => value - middle[k]))));
  film.middle = middle;
  const radius = MARGIN * (far + film.head.soft);
  return [-radius, radius, -radius, radius];
}

/** Nuclei below the apical layer as if it were of glass, the farthest first; in red where the plane cuts the layer. */
function solid(view, film, { a, where, points, colours, corners, pieces, turn, followed }) {
  const { pen } = view;
  const turns = turned(turn);
  const seen = (point) => turns(...point.map((value, k) => value - film.middle[k]));
  const things = corners.map((three) => {
    const flat = three.map(seen);
    return { depth: (flat[0][2] + flat[1][2] + flat[2][2]) / 3, draw: () => pane(view, flat) };
  });
  points.forEach(({ nucleus }, i) => {
    const [x, y, depth] = seen(nucleus);
    things.push({ depth, draw: () => nucleusAt(view, film, { x, y, radius: where("radius", i), colour: colours[i], id: a.id[i], followed }) });
  });
  things.sort((one, other) => one.depth - other.depth).forEach(({ draw }) => draw());
  pen.strokeStyle = APICAL;
  pen.lineWidth = view.pixels(CUT_WIDTH);
  for (const piece of pieces) {
    polyline(pen, piece.map(seen));
    pen.stroke();
  }
}

function pane(view, flat) {
  const { pen } = view;
  polyline(pen, flat, true);
  pen.fillStyle = pen.strokeStyle = APICAL;
  pen.globalAlpha = GLASS.fill;
  pen.fill();
  pen.globalAlpha = GLASS.edge;
  pen.lineWidth = view.pixels(0.6);
  pen.stroke();
  pen.globalAlpha = 1;
}

function nucleusAt(view, film, { x, y, radius, colour, id, followed }) {
  const { pen } = view;
  pen.drawImage(sprite(colour), x - radius, y - radius, 2 * radius, 2 * radius);
  film.drawn.push({ x: view.x + view.scale * x, y: view.y - view.scale * y, radius: view.scale * radius, id });
  if (id === followed) ring(view, x, y, film.head.soft);
}

function ring(view, x, y, radius) {
  const { pen } = view;
  pen.strokeStyle = "#000000";
  pen.lineWidth = view.pixels(2.5);
  disc(pen, x, y, radius);
  pen.stroke();
}

const sprites = new Map();

/** The picture of a ball in a colour, lit from above on the left; drawn once. */
function sprite(colour) {
  if (!sprites.has(colour)) {
    const canvas = document.createElement("canvas");
    canvas.width = canvas.height = SPRITE;
    const pen = canvas.getContext("2d");
    const [middle, bright] = [SPRITE / 2, 0.36 * SPRITE];
    disc(pen, middle, middle, middle - 1);
    pen.fillStyle = colour;
    pen.fill();
    // Upside down: the pen of a view has y upwards.
    const light = pen.createRadialGradient(bright, SPRITE - bright, 1, middle, middle, middle);
    light.addColorStop(0, `rgba(255,255,255,${LIGHT})`);
    light.addColorStop(1, "rgba(0,0,0,0.3)");
    pen.fillStyle = light;
    pen.fill();
    sprites.set(colour, canvas);
  }
  return sprites.get(colour);
}

/** The cells whose nuclei the plane z = cut meets, and where it cuts the apical layer: a slice under a microscope. */
function section(view, film, { a, where, points, colours, pieces, cut, followed }) {
  const { pen } = view;
  const { head } = film;
  const [, pz] = head.periods;
  const shown = points.flatMap(({ nucleus }, i) => (Math.abs(nearest(nucleus[2] - cut, pz)) <= where("radius", i) ? [i] : []));
  basalLayer(view, layerAt(head, cut));
  const at = (name, i) => (PLACES[name] ? points[i][PLACES[name][0]][PLACES[name][1]] : where(name, i));
  nuclei(view, head, a, at, colours, shown);
  pen.strokeStyle = APICAL;
  pen.lineWidth = view.pixels(1.8);
  for (const piece of pieces) {
    polyline(pen, piece);
    pen.stroke();
  }
  for (const i of shown) {
    const [x, y] = points[i].nucleus;
    mark(view, at("bx", i), at("by", i), BASAL, 0);
    film.drawn.push({ x: view.x + view.scale * x, y: view.y - view.scale * y, radius: view.scale * head.soft, id: a.id[i] });
    if (a.id[i] === followed) ring(view, x, y, head.soft);
  }
  film.shown = shown.length;
}

const PLACES = {
  x: ["nucleus", 0], y: ["nucleus", 1], ax: ["apical", 0], ay: ["apical", 1], bx: ["basal", 0], by: ["basal", 1],
};

/** The basal layer where the plane cuts it: a line, or a circle, none where a sphere does not come so far. */
function layerAt(head, cut) {
  const { bends, radius, side } = head.surface;
  if (bends === 0) return { layer: [] };
  const round = bends === 2 ? Math.sqrt(Math.max(0, radius ** 2 - cut ** 2)) : radius;
  const turns = Array.from({ length: 181 }, (_, k) => (2 * Math.PI * k) / 180);
  const layer = turns.map((turn) => [round * Math.sin(turn), round * Math.cos(turn)]);
  return { layer, closed: true, inside: side < 0 };
}

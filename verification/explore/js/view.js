// The canvas: lengths of the model to pixels, to one scale, and marks that are the same for all painters.

const EASE = 0.25; // of the way to the wanted box that is gone in each picture
const STILL = 1e-3; // of its size: so near it is there
const BAR = 0.25; // of the width, which the scale bar has at most
const TEXT = "12px sans-serif";

export class View {
  constructor(canvas) {
    this.canvas = canvas;
    this.pen = canvas.getContext("2d");
    this.box = null;
  }

  /** Fit the canvas to its place on the page; true if that changed it. */
  fit() {
    const ratio = window.devicePixelRatio || 1;
    const { width, height } = this.canvas.getBoundingClientRect();
    const [w, h] = [Math.round(width * ratio), Math.round(height * ratio)];
    if (this.canvas.width === w && this.canvas.height === h) return false;
    [this.canvas.width, this.canvas.height] = [w, h];
    return true;
  }

  /** Go towards a box; true as long as it is not reached. */
  follow(box) {
    const size = Math.max(box[1] - box[0], box[3] - box[2]);
    const there = !this.box || box.every((side, k) => Math.abs(side - this.box[k]) < STILL * size);
    this.box = there ? [...box] : this.box.map((side, k) => side + EASE * (box[k] - side));
    return !there;
  }

  /** Clear the canvas, and have the pen draw in lengths of the model, y upwards. */
  begin() {
    const { pen, canvas } = this;
    pen.setTransform(1, 0, 0, 1, 0, 0);
    pen.clearRect(0, 0, canvas.width, canvas.height);
    return this.into([0, 0, canvas.width, canvas.height], this.box);
  }

  /** Have the pen draw a box of the model into a part of the canvas: left, top, width, height in pixels. */
  into([x, y, width, height], [left, right, low, high]) {
    const { pen } = this;
    this.pane = [x, y, width, height];
    this.scale = Math.min(width / (right - left), height / (high - low)); // pixels for a length of 1
    this.x = x + width / 2 - (this.scale * (left + right)) / 2;
    this.y = y + height / 2 + (this.scale * (low + high)) / 2;
    pen.setTransform(this.scale, 0, 0, -this.scale, this.x, this.y);
    pen.lineJoin = "round";
    return pen;
  }

  /** A length of the model that is so many pixels of the page. */
  pixels(n) {
    return (n * (window.devicePixelRatio || 1)) / this.scale;
  }

  /** The sides of all that is seen. */
  sides() {
    const [x, y, width, height] = this.pane;
    const across = (pixel) => (pixel - this.x) / this.scale;
    const up = (pixel) => (this.y - pixel) / this.scale;
    return [across(x), across(x + width), up(y + height), up(y)];
  }

  /** The pixel of the canvas of a click. */
  pixel(event) {
    const { left, top, width } = this.canvas.getBoundingClientRect();
    const ratio = this.canvas.width / width;
    return [ratio * (event.clientX - left), ratio * (event.clientY - top)];
  }

  /** The place in the model of a click. */
  place(event) {
    const [x, y] = this.pixel(event);
    return [(x - this.x) / this.scale, (this.y - y) / this.scale];
  }

  /** A bar of a round length, below on the left of the part of the canvas. */
  bar(unit) {
    const ratio = window.devicePixelRatio || 1;
    const [left, right] = this.sides();
    const length = round(BAR * (right - left));
    const { pen, pane } = this;
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    const [x, y, wide] = [pane[0] / ratio + 10, (pane[1] + pane[3]) / ratio - 10, (this.scale * length) / ratio];
    pen.strokeStyle = pen.fillStyle = "#333333";
    pen.lineWidth = 2;
    pen.beginPath();
    pen.moveTo(x, y);
    pen.lineTo(x + wide, y);
    pen.stroke();
    pen.font = TEXT;
    pen.fillText(`${length} ${unit}`.trim(), x, y - 6);
  }
}

/** The largest of 1, 2, 5, 10, ... that is not above a length. */
function round(length) {
  const power = 10 ** Math.floor(Math.log10(length));
  return Number(([5, 2, 1].find((k) => k * power <= length) * power).toPrecision(1));
}

export function disc(pen, x, y, radius) {
  pen.beginPath();
  pen.arc(x, y, radius, 0, 2 * Math.PI);
}

export function polyline(pen, points, closed = false) {
  pen.beginPath();
  points.forEach(([x, y], k) => (k ? pen.lineTo(x, y) : pen.moveTo(x, y)));
  if (closed) pen.closePath();
}

// The player: a canvas, play, pause, step, speed, scrub, colours, a click on a cell to follow it; in space a drag turns
// the tissue, and a slider moves the section.

import { Film, View, messages, sheet, tissue } from "tissue-pictures";

const PAINTERS = { tissue, sheet };
const WHOLE = 12; // seconds that a run lasts at speed 1
const SPEEDS = [0.25, 0.5, 1, 2, 4];
const SECOND = 1000; // ms
const TURN = 0.01; // radians for each pixel of a drag
const UPRIGHT = 1.5; // radians of pitch at most: straight from above or below there is no more to turn
const STILL = 3; // pixels: a shorter drag is a click
const LEAST = 20; // ms between two pictures: 30 a second where the screen shows 60, and half of the work

export default {
  template: `
    <div class="player" tabindex="0" @keydown="key"
      :data-run="run" :data-time="time.toFixed(3)" :data-frames="frames" :data-cells="cells" :data-state="state"
      :data-status="status" :data-playing="playing" :data-fps="fps" :data-followed="followed"
      :data-turn="turn.map((one) => one.toFixed(3)).join()" :data-shown="shown">
      <div class="caption">{{ caption }}</div>
      <canvas ref="canvas" role="img" :aria-label="caption" :class="{ turns: deep }" @pointerdown="grab"
        @pointermove="drag" @pointerup="release"></canvas>
      <div class="said" role="status">{{ fault || said }}</div>
      <div class="film">
        <button @click="toggle" :aria-label="playing ? 'pause' : 'play'">{{ playing ? "❚❚" : "▶" }}</button>
        <button @click="step(-1)" aria-label="step back">◀|</button>
        <button @click="step(1)" aria-label="step forward">|▶</button>
        <input type="range" min="0" :max="end" step="any" :value="time" @input="seek(Number($event.target.value))"
          aria-label="time" />
        <select v-model.number="speed" aria-label="speed">
          <option v-for="one in speeds" :value="one">{{ one }}×</option>
        </select>
        <select v-if="colourings.length" v-model="colouring" @change="draw" aria-label="colour by">
          <option v-for="[name, words] in colourings" :value="name">{{ words }}</option>
        </select>
      </div>
      <div class="film" v-if="deep">
        <span>section at z = {{ cut.toFixed(1) }} {{ deep.unit }}</span>
        <input type="range" :min="deep.low" :max="deep.high" step="any" v-model.number="cut" @input="draw"
          aria-label="section" />
      </div>
      <div class="legend">
        <span v-for="one in legend"><i :style="{ background: one.colour }"></i>{{ one.name }}</span>
      </div>
    </div>`,
  props: { url: String },

  data() {
    return {
      time: 0, end: 1, frames: 0, cells: 0, run: 0, state: "loading", status: "", playing: true, fps: 0,
      followed: null, speed: 1, speeds: SPEEDS, colouring: "phase", colourings: [], legend: [], caption: "", said: "",
      fault: "", turn: [0.6, 0.5], cut: 0, deep: null, shown: 0,
    };
  },

  mounted() {
    this.view = new View(this.$refs.canvas);
    this.film = null; // not reactive: it is large
    this.watcher = new ResizeObserver(() => this.draw());
    this.watcher.observe(this.$refs.canvas);
    if (this.url) this.load();
  },

  unmounted() {
    this.watcher.disconnect();
    if (this.reading) this.reading.abort();
    cancelAnimationFrame(this.asked);
  },

  watch: {
    url() {
      this.load();
    },
    colouring() {
      this.draw();
    },
  },

  methods: {
    /** Show another run as soon as its first frames are there, at the same time; the old one stays until then. */
    async load() {
      if (this.reading) this.reading.abort();
      const reading = (this.reading = new AbortController());
      this.state = "loading";
      try {
        let film = null;
        for await (const [header, columns] of messages(this.url, reading.signal)) {
          if (reading.signal.aborted) return;
          if (header.kind === "head") film = new Film(header, PAINTERS[header.painter]);
          else if (header.kind === "frame") this.take(film, header, columns);
          else this.finish(film, header);
        }
      } catch (error) {
        if (!reading.signal.aborted) [this.state, this.fault] = ["failed", `No picture: ${error.message}`];
      }
    },

    take(film, header, columns) {
      film.add(header, columns);
      this.frames = film.frames.length;
      if (this.film !== film) this.change(film);
      if (film.last <= this.time || this.frames === 1) this.draw();
      if (this.playing) this.ask();
    },

    change(film) {
      [this.film, this.fault, this.status, this.end] = [film, "", "", film.head.end];
      this.time = Math.min(this.time, this.end);
      const { deep, unit } = film.head;
      this.deep = deep ? { low: deep[0], high: deep[1], unit } : null;
      if (deep) this.cut = Math.min(deep[1], Math.max(deep[0], this.cut));
      this.colourings = Object.entries(film.painter.colourings);
      this.run += 1;
      this.paint();
    },

    finish(film, { status, detail }) {
      this.state = "ready";
      this.status = status;
      if (status !== "SUCCESS") this.fault = `${status} ${detail}`.trim();
      if (!film) return;
      film.finish(status, detail);
      this.end = film.end;
      this.seek(Math.min(this.time, this.end));
    },

    toggle() {
      if (!this.playing && this.time >= this.end) this.time = 0;
      this.playing = !this.playing;
      this.counted = null;
      this.ask();
    },

    /** One kept state on or back. */
    step(side) {
      if (!this.film) return;
      this.playing = false;
      const k = this.film.before(this.time) + side + (side < 0 && this.film.at(this.time).part > 0 ? 1 : 0);
      const frame = this.film.frames[Math.max(0, Math.min(k, this.film.frames.length - 1))];
      this.seek(frame.t);
    },

    seek(time) {
      this.time = time;
      this.draw();
    },

    key(event) {
      const act = { " ": this.toggle, ArrowLeft: () => this.step(-1), ArrowRight: () => this.step(1) }[event.key];
      if (!act || event.target !== this.$el) return;
      event.preventDefault();
      act();
    },

    grab(event) {
      this.$refs.canvas.setPointerCapture(event.pointerId);
      this.grabbed = { x: event.clientX, y: event.clientY, turn: [...this.turn], far: 0 };
    },

    /** Turn the tissue with the pointer that holds it. */
    drag(event) {
      if (!this.grabbed) return;
      const [x, y] = [event.clientX - this.grabbed.x, event.clientY - this.grabbed.y];
      this.grabbed.far = Math.max(this.grabbed.far, Math.hypot(x, y));
      if (!this.deep || this.grabbed.far < STILL) return;
      const [yaw, pitch] = this.grabbed.turn;
      this.turn = [yaw + TURN * x, Math.min(UPRIGHT, Math.max(-UPRIGHT, pitch + TURN * y))];
      this.draw();
    },

    release(event) {
      if (this.grabbed && this.grabbed.far < STILL) this.pick(event);
      this.grabbed = null;
    },

    pick(event) {
      if (!this.film) return;
      const { painter, head } = this.film;
      const [place, pixel] = [this.view.place(event), this.view.pixel(event)];
      this.followed = painter.pick(head, this.film.at(this.time), place, this.film, pixel);
      this.draw();
    },

    draw() {
      if (this.film) this.ask();
    },

    /** Ask for one picture; nothing runs when none is asked for. */
    ask() {
      if (this.asked) return;
      this.asked = requestAnimationFrame((now) => {
        this.asked = null;
        this.next(now);
      });
    },

    next(now) {
      if (!this.film) return;
      if (this.playing && this.counted && now - this.counted.before < LEAST) return this.ask();
      if (this.playing) this.advance(now);
      else this.counted = null;
      if (this.paint() || this.playing) this.ask();
    },

    /** Go on by the time that has passed, and count pictures; wait where the run has not come so far. */
    advance(now) {
      if (!this.counted) this.counted = { since: now, before: now, pictures: 0 };
      const passed = Math.min(now - this.counted.before, SECOND / 4);
      this.counted.before = now;
      const known = this.film.complete ? this.end : this.film.last;
      this.time = Math.min(known, this.time + (this.film.head.end * this.speed * passed) / (WHOLE * SECOND));
      if (this.film.complete && this.time >= this.end) this.playing = false;
      this.counted.pictures += 1;
      if (now - this.counted.since < SECOND) return;
      this.fps = Math.round((SECOND * this.counted.pictures) / (now - this.counted.since));
      [this.counted.since, this.counted.pictures] = [now, 0];
    },

    /** Draw; true if the view still moves. */
    paint() {
      this.view.fit();
      const moves = this.view.follow(this.film.box);
      const { painter, head } = this.film;
      const moment = this.film.at(this.time);
      const { colouring, followed, turn, cut } = this;
      painter.draw(this.view, this.film, moment, { colouring, followed, turn, cut });
      this.shown = this.film.shown ?? moment.a.n;
      this.cells = moment.a.n;
      this.caption = painter.caption(moment);
      this.said = this.followed === null ? "" : painter.describe(head, moment, this.followed);
      this.legend = painter.legend(head, this.colouring);
      return moves;
    },
  },
};

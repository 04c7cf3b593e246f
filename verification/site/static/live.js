// Draws what the reader chose, names the lines at their ends, and lists the cheapest method for each error.
// runs, lines, crosses, front, names, leaders, floor, panel, across, up, grid: models of the chart, see interactive.py.
const root = document.getElementById("live"), given = JSON.parse(root.querySelector("script").textContent);
const data = runs.data, selects = [...root.querySelectorAll("select")], boxes = [...root.querySelectorAll("input")];
const NAME_STEP = 13, TINY = 2 ** -1022; // dots between names; the least normal number

// The choice, and the address that restores it.
function chosen() {
  const values = Object.fromEntries(selects.map(select => [select.name, select.value]));
  return {...values, without: boxes.filter(box => !box.checked).map(box => box.value)};
}
function address({scene, norm, cost, without}) {
  const parts = new URLSearchParams({scene, norm, cost, ...(without.length ? {without: without.join()} : {})});
  return "#" + parts.toString().replaceAll("%2C", ",");
}
function restore() {
  const parts = new URLSearchParams(location.hash.slice(1));
  if (!parts.has("scene")) return false;
  for (const select of selects) {
    const wanted = parts.get(select.name) ?? select.options[0].value;
    if ([...select.options].some(option => option.value === wanted)) select.value = wanted;
  }
  const without = (parts.get("without") ?? "").split(",");
  for (const box of boxes) box.checked = !without.includes(box.value);
  return true;
}

// The runs of each method that is ticked, from coarse to fine.
function methods({scene, norm, cost, without}) {
  const index = given.scenes.indexOf(scene), found = given.methods.map(method => ({...method, done: [], failed: []}));
  for (let k = 0; k < runs.get_length(); k++) {
    if (data.scene[k] !== index) continue;
    const spread = cost === "cpu_seconds" ? data.spread[k] : 1;
    const run = {error: data[norm][k], cost: data[cost][k], spread, setting: data.setting[k], status: data.status[k]};
    if (!isNaN(run.cost)) found[data.method[k]][run.status === "SUCCESS" ? "done" : "failed"].push(run);
  }
  return found.filter(method => !without.includes(method.family));
}

// The rule of verification/instruments/cheapest.py; a test compares both.
function cost_of(done, target) {
  const first = done.findLastIndex(run => !(run.error <= target)) + 1;
  if (first === done.length) return null;
  const least = done.slice(first).reduce((best, run) => run.cost < best.cost ? run : best);
  const run = {value: least.cost, spread: least.spread, dearest: least.cost};
  if (first === 0) return run;
  const [a, b] = [done[first - 1], done[first]], log = value => Math.log(Math.max(value, TINY));
  const share = (log(a.error) - log(target)) / (log(a.error) - log(b.error));
  const value = Math.exp(log(a.cost) + share * (log(b.cost) - log(a.cost)));
  return run.value < value ? run : {value, spread: Math.max(a.spread, b.spread), dearest: Math.max(a.cost, b.cost)};
}
function cheapest(there, target, {scene, norm, cost}) {
  const priced = there.map(method => ({label: method.label, ...cost_of(method.done, target)}));
  const found = priced.filter(price => isFinite(price.value ?? NaN)).sort((a, b) => a.value - b.value), best = found[0];
  if (!best) return {word: target < given.finest[scene][norm] ? given.words.not_resolved : given.words.not_reached};
  const near = price => price.value <= best.value * Math.max(price.spread, best.spread);
  const tied = found.filter(near), next = found.find(price => !near(price));
  const limit = given.limits[scene][cost] ?? Infinity;
  const word = best.dearest > limit ? given.words.at_the_limit : tied.length > 1 ? given.words.tie : "";
  return {word, tied: tied.map(price => price.label), cost: best.value, next, ratio: next && next.value / best.value};
}
function efficient(there) {
  const all = there.flatMap(method => method.done).filter(run => !isNaN(run.error) && run.cost > 0);
  let best = Infinity;
  all.sort((a, b) => a.cost - b.cost || a.error - b.error);
  return all.filter(run => run.error < best && (best = run.error, true));
}

// Lists of what is drawn.
const shown = value => Math.max(value, given.lowest);
function columns(drawn, label) {
  const column = get => drawn.map(get);
  return {x: column(run => run.cost), y: column(run => run.y ?? shown(run.error)), setting: column(run => run.setting),
          status: column(run => run.status), method: column(run => label ?? run.label)};
}
function set_range(range, start, end) {
  range.setv({start, end, reset_start: start, reset_end: end});
}
function draw(choice, there) {
  const points = there.flatMap(method => method.done.filter(run => run.cost > 0 && !isNaN(run.error)));
  const top = 3 * Math.max(...points.map(run => shown(run.error)));
  for (const [k, source] of lines.entries()) {
    const method = there.find(one => one.rank === k);
    const drawn = method ? method.done.filter(run => run.cost > 0 && !isNaN(run.error)) : [];
    source.data = columns(drawn, method?.label);
  }
  crosses.data = columns(there.flatMap(method => method.failed.filter(run => run.cost > 0)
    .map(run => ({...run, label: method.label, y: top}))));
  const best = efficient(there);
  front.data = {x: best.map(run => run.cost), y: best.map(run => shown(run.error))};
  floor.top = given.finest[choice.scene][choice.norm];
  floor.visible = floor.top > 0;
  across.axis_label = given.costs[choice.cost];
  up.axis_label = given.norms[choice.norm];
  if (points.length) set_ranges(points, top, there);
  else name_lines([], 1, 0, 1, 9);
}
function set_ranges(points, top, there) {
  const width = panel.inner_width || 800, small = width < 480, size = small ? 9 : 11;
  const room = Math.min(0.5, (12 + 0.55 * size * Math.max(0, ...there.map(method => method.short.length))) / width);
  const xs = points.map(run => Math.log10(run.cost)), [left, right] = [Math.min(...xs) - 0.1, Math.max(...xs) + 0.1];
  const bottom = Math.min(...points.map(run => shown(run.error))) / 3;
  set_range(panel.x_range, 10 ** left, 10 ** (left + (right - left) / (1 - room)));
  set_range(panel.y_range, bottom, 2 * top);
  for (const part of [across, grid]) part.bounds = [10 ** left, 10 ** right];
  name_lines(there, 10 ** right, Math.log10(bottom), Math.log10(2 * top), size);
}
// One name beside the other at the right, in the order of the ends of the lines.
function name_lines(there, x, low, high, size) {
  const step = NAME_STEP / (panel.inner_height || 500) * (high - low), drawn = run => run.cost > 0 && !isNaN(run.error);
  const ends = there.filter(method => method.done.some(drawn)).map(method => {
    const {cost, error} = method.done.findLast(drawn);
    return {x: cost, y: Math.log10(shown(error)), text: method.short, color: method.ink};
  }).sort((a, b) => a.y - b.y);
  let least = low + step / 2;
  for (const end of ends) { end.at = Math.max(end.y, least); least = end.at + step; }
  let most = high - step / 2;
  for (const end of ends.reverse()) { end.at = Math.min(end.at, most); most = end.at - step; }
  const color = ends.map(end => end.color), y = ends.map(end => 10 ** end.at);
  names.data = {x: ends.map(() => x), y, text: ends.map(end => end.text), color, size: ends.map(() => size + "px")};
  leaders.data = {x0: ends.map(end => end.x), y0: ends.map(end => 10 ** end.y), x1: ends.map(() => x), y1: y, color};
}

// The table below the chart.
function number(value) {
  if (value >= 1e-2 && value < 1e4) return value < 1e3 ? String(Number(value.toPrecision(3))) : value.toFixed(0);
  const [mantissa, power] = value.toExponential(1).split("e");
  const raised = sign => "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"["-0123456789".indexOf(sign)];
  return `${mantissa}·10${[...String(Number(power))].map(raised).join("")}`;
}
function amount(value, {cost}) {
  return cost !== "cpu_seconds" ? number(value) : value < 0.1 ? `${number(1e3 * value)} ms` : `${number(value)} s`;
}
function list(choice, there) {
  root.querySelector("tbody").replaceChildren(...given.targets.map(target => {
    const {word, tied = [], cost, next, ratio} = cheapest(there, target, choice), row = document.createElement("tr");
    const said = [word, tied.join(", ")].filter(Boolean).join(": ");
    const more = next ? `${next.label}, ${number(ratio)}` : "";
    const texts = [number(target).replace("1.0·", ""), said, cost ? amount(cost, choice) : "", more];
    for (const text of texts) row.insertCell().textContent = text;
    Object.assign(row.dataset, {target, word, tied: tied.join("; "), cost: cost ?? ""});
    return row;
  }));
  const absent = there.filter(method => !method.done.some(run => run.cost > 0))
    .map(method => `${method.label} (${given.absent[choice.scene][method.label]})`);
  root.querySelector(".absent").textContent = absent.length ? `Without a line here: ${absent.join(", ")}.` : "";
}
function show() {
  const choice = chosen(), there = methods(choice);
  draw(choice, there);
  list(choice, there);
}
root.addEventListener("change", () => { history.replaceState(null, "", address(chosen())); show(); });
addEventListener("hashchange", () => { if (restore()) { show(); root.scrollIntoView(); } });
for (const side of ["inner_width", "inner_height"]) panel.connect(panel.properties[side].change, show);
const linked = restore();
show();
if (linked) root.scrollIntoView();

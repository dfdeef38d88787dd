
// Draws the mesh before and after a run on two canvases that show the same region. Triangles are filled pixel by pixel:
// that leaves no seams, and many small triangles take no longer than few large ones.

const data = JSON.parse(document.getElementById("data").textContent);

function decoded(Type, text) {
  return new Type(Uint8Array.from(atob(text), (c) => c.charCodeAt(0)).buffer);
}

const wholes = decoded(Uint32Array, data.triangles), halves = decoded(Uint32Array, data.halves);
// Triangles, then two halves of each quadrilateral. Elements are numbered in this order.
const triangles = new Uint32Array(wholes.length + halves.length);
triangles.set(wholes);
triangles.set(halves, wholes.length);
const firstHalf = wholes.length / 3;
// The ends of the edges between elements, which measures of edges color.
const colored = decoded(Uint32Array, data.edges);
const boundary = decoded(Uint32Array, data.boundary);
const between = decoded(Uint32Array, data.between);
const held = decoded(Uint32Array, data.held);
const slid = decoded(Uint32Array, data.slid);
// Triangles that cover the faces that are no elements, and edges of these faces: index of a piece, and two vertices.
const pieces = decoded(Uint32Array, data.pieces);
const faceEdges = decoded(Uint32Array, data.face_edges);
const states = data.states.map((state) => ({
  points: decoded(Float64Array, state.points),
  values: state.values.map((values) => decoded(Float32Array, values)),
  edgeValues: state.edge_values.map((values) => decoded(Float32Array, values)),
  pictures: state.pictures,
  // Images and codes by measure, made when the measure is chosen.
  images: [],
  codes: [],
}));
// The file's ids of the elements, from runs of consecutive ids: index of the first element, and its id.
const ids = new Float64Array(firstHalf + halves.length / 6);
data.ids.forEach(([start, id], i) => {
  const end = data.ids[i + 1]?.[0] ?? ids.length;
  for (let t = start; t < end; t++) ids[t] = id + t - start;
});
const canvases = [...document.querySelectorAll("#views canvas")];
// What was drawn last on each canvas below the marks.
const layers = canvases.map(() => document.createElement("canvas"));
const [low, high] = data.extent;

// The middle of the view in units of the mesh, and CSS pixels per unit. `spot` is the element that a link asked for.
const view = { x: 0, y: 0, scale: 1, isWhole: true, spot: null };
let measure = data.first;
// The element whose values are shown, -1 without any.
let marked = -1;
// Whether colors are those of paper, whatever the theme of the window is.
let isPrinting = false;
// The timer of each canvas that ends its hint.
const hints = new Map();

// Colors by code: 0 is inverted or flat, 1 to BEST goes from bad to good, PALE is a triangle between colored edges, NEUTRAL is
// a face that no measure judges.
const BEST = 65532, PALE = 65533, NEUTRAL = 65534, NOTHING = 65535;
// Number of steps to which the colors of edges are rounded.
const STEPS = 64;
const palette = new Uint32Array(65536);
for (let code = 1; code <= BEST; code++) {
  const place = ((code - 1) / (BEST - 1)) * (data.colors.length - 1);
  const first = Math.min(Math.floor(place), data.colors.length - 2);
  const [r, g, b] = data.colors[first].map((from, i) => Math.round(from + (data.colors[first + 1][i] - from) * (place - first)));
  palette[code] = (255 << 24) | (b << 16) | (g << 8) | r;
}
for (const [code, [r, g, b]] of [[0, data.bad], [PALE, data.pale], [NEUTRAL, data.neutral]]) palette[code] = (255 << 24) | (b << 16) | (g << 8) | r;

/** The element that a triangle is or is half of. */
function elementOf(t) {
  return t < firstHalf ? t : firstHalf + Math.floor((t - firstHalf) / 2);
}

/** The vertices of an element, in order around it. */
function verticesOf(element) {
  const i = 3 * (element < firstHalf ? element : 2 * element - firstHalf);
  const vertices = [triangles[i], triangles[i + 1], triangles[i + 2]];
  return element < firstHalf ? vertices : [...vertices, triangles[i + 5]];
}

/** Whether an element has a measure. */
function has(element, { of_quadrilaterals }) {
  return element < firstHalf || of_quadrilaterals;
}

/** The codes of all elements by the chosen measure. A value that is not a number is that of an element that is not valid. */
function codesOf(state) {
  return (state.codes[measure] ??= Uint16Array.from(state.values[measure], (value, element) => {
    if (!has(element, data.measures[measure])) return NEUTRAL;
    return Number.isNaN(value) ? 0 : 1 + Math.round((BEST - 1) * goodness(data.measures[measure], value));
  }));
}

/** Rates a value from 0 (the bad end of the scale, or worse) to 1 (the good end, or better). */
function goodness({ ends: [bad, good] }, value) {
  return Math.min(1, Math.max(0, (value - bad) / (good - bad)));
}

/** The picture of a large mesh by the chosen measure; null while it is decoded, and for meshes without pictures. */
function imageOf(state) {
  if (!state.pictures.length) return null;
  if (!state.images[measure]) {
    const image = (state.images[measure] = new Image());
    image.onload = redraw;
    image.src = state.pictures[measure];
  }
  return state.images[measure].complete ? state.images[measure] : null;
}

/** Fills the pixels whose middles are in a triangle, or the one of its middle; where several meet, the worst is kept. */
function fill(best, width, height, x0, y0, x1, y1, x2, y2, code) {
  const top = Math.max(0, Math.ceil(Math.min(y0, y1, y2) - 0.5));
  const bottom = Math.min(height - 1, Math.floor(Math.max(y0, y1, y2) - 0.5));
  let met = false;
  for (let row = top; row <= bottom; row++) {
    const y = row + 0.5;
    let from = Infinity, to = -Infinity;
    if ((y0 <= y) !== (y1 <= y)) { const x = x0 + (x1 - x0) * ((y - y0) / (y1 - y0)); from = Math.min(from, x); to = Math.max(to, x); }
    if ((y1 <= y) !== (y2 <= y)) { const x = x1 + (x2 - x1) * ((y - y1) / (y2 - y1)); from = Math.min(from, x); to = Math.max(to, x); }
    if ((y2 <= y) !== (y0 <= y)) { const x = x2 + (x0 - x2) * ((y - y2) / (y0 - y2)); from = Math.min(from, x); to = Math.max(to, x); }
    const end = Math.min(width - 1, Math.floor(to - 0.5));
    for (let column = Math.max(0, Math.ceil(from - 0.5)); column <= end; column++) {
      const i = row * width + column;
      if (code < best[i]) best[i] = code;
      met = true;
    }
  }
  if (!met) {
    const column = Math.floor((x0 + x1 + x2) / 3), row = Math.floor((y0 + y1 + y2) / 3);
    if (column >= 0 && row >= 0 && column < width && row < height) {
      const i = row * width + column;
      if (code < best[i]) best[i] = code;
    }
  }
}

/** Where the vertices are on a canvas, in its pixels. */
function placed(points, canvas, ratio) {
  const scale = view.scale * ratio, at = new Float64Array(points.length);
  for (let i = 0; i < points.length; i += 2) {
    at[i] = canvas.width / 2 + (points[i] - view.x) * scale;
    at[i + 1] = canvas.height / 2 - (points[i + 1] - view.y) * scale;
  }
  return at;
}

/** A path of edges, without those that are not seen. */
function edges(context, list, at) {
  const { width, height } = context.canvas;
  context.beginPath();
  for (let i = 0; i < list.length; i += 2) {
    const a = 2 * list[i], b = 2 * list[i + 1];
    if (Math.max(at[a], at[b]) < 0 || Math.min(at[a], at[b]) > width) continue;
    if (Math.max(at[a + 1], at[b + 1]) < 0 || Math.min(at[a + 1], at[b + 1]) > height) continue;
    context.moveTo(at[a], at[a + 1]);
    context.lineTo(at[b], at[b + 1]);
  }
  context.stroke();
}

/** Draws the edges that are some pixels long in the colors of their values, bad edges above good ones. */
function colorEdges(context, values, at, ratio) {
  const lists = Array.from({ length: STEPS + 1 }, () => []);
  for (let i = 0; i < values.length; i++) {
    const a = colored[2 * i], b = colored[2 * i + 1];
    if (Math.hypot(at[2 * b] - at[2 * a], at[2 * b + 1] - at[2 * a + 1]) < 4 * ratio) continue;
    lists[Math.round(STEPS * goodness(data.measures[measure], values[i]))].push(a, b);
  }
  context.lineWidth = 2.4 * ratio;
  for (let step = STEPS; step >= 0; step--) {
    const color = palette[1 + Math.round((BEST - 1) * (step / STEPS))];
    context.strokeStyle = `rgb(${color & 255} ${(color >> 8) & 255} ${(color >> 16) & 255})`;
    edges(context, lists[step], at);
  }
}

/** Draws a mesh without its marks on a layer that has the size of the canvas. */
function draw(canvas, layer, state) {
  const ratio = window.devicePixelRatio || 1;
  const { width, height } = canvas, context = layer.getContext("2d");
  [layer.width, layer.height] = [width, height];
  const style = getComputedStyle(document.documentElement);
  const [ink, paper] = isPrinting ? ["#000", "#fff"] : ["--ink", "--paper"].map((name) => style.getPropertyValue(name));
  const at = placed(state.points, canvas, ratio), codes = codesOf(state), image = imageOf(state);
  if (image) {
    const scale = view.scale * ratio;
    const left = width / 2 + (low[0] - view.x) * scale, top = height / 2 - (high[1] - view.y) * scale;
    const longest = Math.max(high[0] - low[0], high[1] - low[1]) / Math.max(image.width, image.height);
    context.imageSmoothingEnabled = false;
    context.drawImage(image, left, top, image.width * longest * scale, image.height * longest * scale);
  }

  const best = new Uint16Array(width * height).fill(NOTHING);
  const inner = [];
  /** Fills the triangle whose corners are at `i` of a list. Returns whether it is high enough for its edges to be drawn. */
  const filled = (list, i, code) => {
    const a = 2 * list[i], b = 2 * list[i + 1], c = 2 * list[i + 2];
    const x0 = at[a], y0 = at[a + 1], x1 = at[b], y1 = at[b + 1], x2 = at[c], y2 = at[c + 1];
    if (Math.max(x0, x1, x2) < 0 || Math.min(x0, x1, x2) > width || Math.max(y0, y1, y2) < 0 || Math.min(y0, y1, y2) > height) return false;
    const longest = Math.max((x1 - x0) ** 2 + (y1 - y0) ** 2, (x2 - x1) ** 2 + (y2 - y1) ** 2, (x0 - x2) ** 2 + (y0 - y2) ** 2);
    // Small triangles are seen better in the picture of the whole mesh.
    if (image && longest < (4 * ratio) ** 2) return false;
    const area = Math.abs((x1 - x0) * (y2 - y0) - (y1 - y0) * (x2 - x0));
    const isHigh = area > 4 * ratio * Math.sqrt(longest);
    // A triangle that is too small for colored edges has the color of its worst edge.
    const isPale = isHigh && code > 0 && code <= BEST && data.measures[measure].of_edges;
    fill(best, width, height, x0, y0, x1, y1, x2, y2, isPale ? PALE : code);
    return isHigh;
  };
  for (let t = 0, i = 0; i < triangles.length; t++, i += 3) {
    if (!filled(triangles, i, codes[elementOf(t)]) || data.measures[measure].of_edges) continue;
    const [a, b, c] = [triangles[i], triangles[i + 1], triangles[i + 2]];
    // The diagonal of a quadrilateral ends its first half and begins its second.
    const isFirst = t >= firstHalf && (t - firstHalf) % 2 === 0, isSecond = t >= firstHalf && !isFirst;
    if (a < b && !isSecond) inner.push(a, b);
    if (b < c) inner.push(b, c);
    if (c < a && !isFirst) inner.push(c, a);
  }
  const isHigh = [];
  for (let i = 0; i < pieces.length; i += 3) isHigh.push(filled(pieces, i, NEUTRAL));
  for (let i = 0; i < faceEdges.length; i += 3) if (isHigh[faceEdges[i]]) inner.push(faceEdges[i + 1], faceEdges[i + 2]);
  const pixels = new ImageData(width, height), words = new Uint32Array(pixels.data.buffer);
  for (let i = 0; i < words.length; i++) if (best[i] !== NOTHING) words[i] = palette[best[i]];
  const faces = new OffscreenCanvas(width, height);
  faces.getContext("2d").putImageData(pixels, 0, 0);
  context.drawImage(faces, 0, 0);

  context.lineCap = "round";
  if (inner.length < 200000) {
    context.strokeStyle = "rgb(0 0 0 / 0.4)";
    context.lineWidth = 0.7 * ratio;
    edges(context, inner, at);
  }
  colorEdges(context, state.edgeValues[measure], at, ratio);
  context.strokeStyle = ink;
  context.lineWidth = 4 * ratio;
  edges(context, between, at);
  context.strokeStyle = paper;
  context.lineWidth = 1.6 * ratio;
  edges(context, between, at);
  context.strokeStyle = ink;
  context.lineWidth = 1.8 * ratio;
  edges(context, boundary, at);
  for (const v of held) dot(context, at[2 * v], at[2 * v + 1], ratio, ["#fff", "#000"]);
  for (const v of slid) dot(context, at[2 * v], at[2 * v + 1], ratio, ["#000", "#fff"]);
}

/** A vertex inside the mesh that must not move, or one that slid along its line, by the colors of its inside and its rim. */
function dot(context, x, y, ratio, [inside, rim]) {
  if (x < 0 || y < 0 || x > context.canvas.width || y > context.canvas.height) return;
  context.beginPath();
  context.arc(x, y, 2.6 * ratio, 0, 7);
  context.fillStyle = inside;
  context.fill();
  context.strokeStyle = rim;
  context.lineWidth = 1.4 * ratio;
  context.stroke();
}

/** Draws rings around the worst elements, and the outline of the element whose values are shown. */
function marks(canvas, state) {
  const ratio = window.devicePixelRatio || 1, context = canvas.getContext("2d"), scale = view.scale * ratio;
  const place = (v) => [canvas.width / 2 + (state.points[2 * v] - view.x) * scale, canvas.height / 2 - (state.points[2 * v + 1] - view.y) * scale];
  const cornersOf = (element) => verticesOf(element).map(place);
  const ring = (corners, radius) => {
    const [x, y] = [0, 1].map((axis) => corners.reduce((sum, corner) => sum + corner[axis], 0) / corners.length);
    context.beginPath();
    context.arc(x, y, radius * ratio, 0, 7);
  };
  const stroke = (lines) => {
    for (const [color, line] of lines) {
      context.strokeStyle = color;
      context.lineWidth = line * ratio;
      context.stroke();
    }
  };
  for (const spot of data.spots) {
    if (states[spot.state] !== state || spot.element === marked || spot.size * view.scale > canvasWidth(canvas) / 12) continue;
    ring(cornersOf(spot.element), 8);
    stroke([["#fff", 3.4], ["#000", 1.2]]);
  }
  if (marked < 0) return;
  const corners = cornersOf(marked), size = Math.max(...[0, 1].map((axis) => {
    const places = corners.map((corner) => corner[axis]);
    return Math.max(...places) - Math.min(...places);
  }));
  if (size < 10 * ratio) ring(corners, 11);
  else {
    context.beginPath();
    corners.forEach((corner, k) => (k ? context.lineTo(...corner) : context.moveTo(...corner)));
    context.closePath();
  }
  context.lineJoin = "round";
  stroke([["#fff", 5], ["#000", 2.4]]);
}

function canvasWidth(canvas) {
  return canvas.getBoundingClientRect().width;
}

function redrawNow() {
  canvases.forEach((canvas, i) => draw(canvas, layers[i], states[i]));
  inspect();
}

/** Copies the layers to the canvases, with marks. */
function remark() {
  canvases.forEach((canvas, i) => {
    const context = canvas.getContext("2d");
    context.clearRect(0, 0, canvas.width, canvas.height);
    context.drawImage(layers[i], 0, 0);
    marks(canvas, states[i]);
  });
}

let isDue = false;
function redraw() {
  if (isDue) return;
  isDue = true;
  requestAnimationFrame(() => {
    isDue = false;
    redrawNow();
  });
}

/** Gives the canvases their size: side by side unless the mesh is wide or the window narrow. */
function resize() {
  const size = [0, 1].map((axis) => high[axis] - low[axis]);
  const aspect = Math.min(1.2, Math.max(0.35, size[1] / (size[0] || 1)));
  const isNarrow = window.innerWidth < 700, isStacked = isNarrow || aspect < 0.45;
  document.getElementById("views").classList.toggle("stacked", isStacked);
  const ratio = window.devicePixelRatio || 1;
  for (const canvas of canvases) {
    const width = canvas.clientWidth, height = Math.min(aspect * width, (isNarrow ? 0.36 : 0.75) * window.innerHeight);
    canvas.style.height = `${Math.round(height)}px`;
    canvas.width = Math.max(1, Math.round(width * ratio));
    canvas.height = Math.max(1, Math.round(height * ratio));
  }
  if (view.isWhole) whole();
  else redraw();
}

function whole() {
  const canvas = canvases[0];
  const [across, along] = [0, 1].map((axis) => Math.max(high[axis] - low[axis], 1e-300));
  view.x = (low[0] + high[0]) / 2;
  view.y = (low[1] + high[1]) / 2;
  view.scale = 0.94 * Math.min(canvas.clientWidth / across, canvas.clientHeight / along);
  view.isWhole = true;
  view.spot = null;
  redraw();
}

/** Enlarges by a factor around a place on a canvas, in CSS pixels from its middle. */
function zoom(factor, x = 0, y = 0) {
  const least = 1 / Math.max(high[0] - low[0], high[1] - low[1]);
  const scale = Math.min(Math.max(view.scale * factor, 20 * least), 1e16 * least);
  view.x += x / view.scale - x / scale;
  view.y -= y / view.scale - y / scale;
  view.scale = scale;
  view.isWhole = false;
  redraw();
}

function pan(x, y) {
  view.x -= x / view.scale;
  view.y += y / view.scale;
  view.isWhole = false;
  redraw();
}

/** Shows one of the worst elements, as the link asks for that names it. */
function show(i) {
  const spot = data.spots[i], canvas = canvases[0];
  if (!spot) return;
  [view.x, view.y] = spot.at;
  view.scale = Math.min(canvas.clientWidth, canvas.clientHeight) / (6 * spot.size);
  view.isWhole = false;
  view.spot = i;
  // The values of the element take the place of those at the last position of the pointer.
  pointer = null;
  redraw();
  document.getElementById("views").scrollIntoView({ block: "center" });
}

function legend() {
  const scale = document.getElementById("scale"), colors = data.colors.map((color) => `rgb(${color})`);
  const ticks = data.measures[measure].ticks.map(([place, name]) => `<b style="left:${100 * place}%">${name}</b>`);
  scale.innerHTML = `<i style="background:linear-gradient(to right, ${colors})"></i>${ticks.join("")}`;
}

const select = document.getElementById("measure");
data.measures.forEach(({ name }) => select.add(new Option(name)));
select.selectedIndex = measure;
select.onchange = () => {
  measure = select.selectedIndex;
  legend();
  redraw();
};
document.getElementById("in").onclick = () => zoom(2);
document.getElementById("out").onclick = () => zoom(0.5);
document.getElementById("all").onclick = whole;


// What follows the pointer: moving and enlarging the view, and the values of the element at the pointer.

// The position of the pointer over a canvas in CSS pixels of the window; null elsewhere.
let pointer = null;
// The last click. If the window scrolls below a pointer that rests, browsers report that the pointer moves.
let clicked = { clientX: NaN, clientY: NaN };

function fromMiddle(canvas, event) {
  const box = canvas.getBoundingClientRect();
  return [event.clientX - box.left - box.width / 2, event.clientY - box.top - box.height / 2];
}

/** The index of the first triangle of a list that has a place, -1 without any. */
function found(list, points, [x, y]) {
  const side = (a, b) => (points[2 * b] - points[2 * a]) * (y - points[2 * a + 1]) - (points[2 * b + 1] - points[2 * a + 1]) * (x - points[2 * a]);
  for (let i = 0; i < list.length; i += 3) {
    const [a, b, c] = [list[i], list[i + 1], list[i + 2]];
    const sides = [side(a, b), side(b, c), side(c, a)];
    if (sides.every((s) => s >= 0) || sides.every((s) => s <= 0)) return i / 3;
  }
  return -1;
}

/** Marks the element at the pointer, or else the chosen one of the worst elements, and shows its values beside it. */
function inspect() {
  const spot = data.spots[view.spot], index = pointer ? canvases.indexOf(pointer.canvas) : (spot?.state ?? 0);
  const canvas = canvases[index], { points } = states[index];
  let at = null;
  if (pointer) {
    const [dx, dy] = fromMiddle(canvas, pointer);
    at = [view.x + dx / view.scale, view.y - dy / view.scale];
  } else if (spot) at = spot.at;
  marked = !at ? -1 : pointer ? elementOf(found(triangles, points, at)) : spot.element;
  remark();
  if (!at) return hideTip();
  // A box of the canvas, as the figure also has a caption.
  const x = canvas.clientWidth / 2 + (at[0] - view.x) * view.scale, y = canvas.clientHeight / 2 - (at[1] - view.y) * view.scale;
  if (x < 0 || y < 0 || x > canvas.clientWidth || y > canvas.clientHeight) return hideTip();
  // The box does not hide a chosen element.
  const gap = pointer ? undefined : Math.max(16, 0.6 * spot.size * view.scale);
  showTip(canvas.parentElement, canvas.offsetLeft + x, canvas.offsetTop + y, described(marked, at, points), gap);
}

/** What the box says about an element at a place: its number, its values before and after a run, and the place. */
function described(marked, at, points) {
  const element = (name, text, ...children) => {
    const made = document.createElement(name);
    if (text) made.textContent = text;
    made.append(...children);
    return made;
  };
  const place = element("div", at.map(coordinate).join("  "));
  if (marked < 0) {
    const name = found(pieces, points, at) >= 0 ? data.face : states[0].pictures.length ? "values are known around the worst elements" : "";
    return name ? [element("strong", name), place] : [place];
  }
  const names = states.length > 1 ? [element("tr", "", ...["", "before", "after"].map((name) => element("td", name)))] : [];
  const shown = (measure) => has(marked, measure);
  const rows = data.measures.map((measure, k) => shown(measure) &&
    element("tr", "", element("th", measure.name), ...states.map(({ values }) => element("td", value(measure, values[k][marked])))));
  const kind = marked < firstHalf ? "triangle" : "quadrilateral";
  return [element("strong", `${kind} ${ids[marked]}`), element("table", "", element("tbody", "", ...names, ...rows.filter(Boolean))), place];
}

/** A coordinate with digits down to a tenth of a pixel, at least seven and at most the 17 of double precision. */
function coordinate(x) {
  const digits = Math.ceil(Math.log10(Math.abs(x) * view.scale)) + 1;
  return x.toPrecision(Math.min(17, Math.max(7, Number.isFinite(digits) ? digits : 7)));
}

/** The value of a measure with six of the seven digits of single precision. */
function value({ unit }, x) {
  if (Number.isNaN(x)) return marked < firstHalf ? "inverted or flat" : "not convex";
  return Number.isFinite(x) ? `${x.toPrecision(6)}${unit}` : "infinite";
}

/** Inspects the place of the pointer. */
function tell(canvas, { clientX, clientY }) {
  pointer = { canvas, clientX, clientY };
  inspect();
}

for (const canvas of canvases) {
  canvas.addEventListener("wheel", (event) => {
    // The wheel scrolls the page unless the reader asks for the view. A trackpad reports pinching as Ctrl.
    if (!event.ctrlKey && !event.metaKey && document.activeElement !== canvas) {
      hint(canvas);
      return;
    }
    event.preventDefault();
    zoom(Math.exp(-event.deltaY * (event.deltaMode ? 0.05 : 0.0015)), ...fromMiddle(canvas, event));
  }, { passive: false });
  canvas.addEventListener("pointerdown", (event) => event.pointerType !== "touch" && canvas.setPointerCapture(event.pointerId));
  canvas.addEventListener("pointermove", (event) => {
    if (event.pointerType !== "touch" && event.buttons) {
      pointer = { canvas, clientX: event.clientX, clientY: event.clientY };
      pan(event.movementX, event.movementY);
    } else if (event.clientX !== clicked.clientX || event.clientY !== clicked.clientY) tell(canvas, event);
  });
  canvas.addEventListener("pointerleave", () => {
    pointer = null;
    inspect();
  });
  canvas.addEventListener("click", (event) => tell(canvas, event));
  canvas.addEventListener("dblclick", (event) => zoom(2, ...fromMiddle(canvas, event)));
  canvas.addEventListener("keydown", (event) => {
    const step = 60, moves = { ArrowLeft: [step, 0], ArrowRight: [-step, 0], ArrowUp: [0, step], ArrowDown: [0, -step] };
    if (moves[event.key]) pan(...moves[event.key]);
    else if (event.key === "+") zoom(2);
    else if (event.key === "-") zoom(0.5);
    else if (event.key === "Escape") canvas.blur();
    else return;
    event.preventDefault();
  });
  // One finger scrolls the page, two move the mesh.
  let last = null;
  const two = ([p, q]) => ({ clientX: (p.clientX + q.clientX) / 2, clientY: (p.clientY + q.clientY) / 2, apart: Math.hypot(p.clientX - q.clientX, p.clientY - q.clientY) });
  canvas.addEventListener("touchmove", (event) => {
    if (event.touches.length !== 2) return;
    event.preventDefault();
    const now = two(event.touches);
    if (last) {
      pan(now.clientX - last.clientX, now.clientY - last.clientY);
      zoom(now.apart / last.apart, ...fromMiddle(canvas, now));
    }
    last = now;
  }, { passive: false });
  canvas.addEventListener("touchend", () => (last = null));
}

/** Shows for a moment how the wheel enlarges. */
function hint(canvas) {
  const { classList } = canvas.parentElement.querySelector(".hint");
  classList.add("shown");
  clearTimeout(hints.get(canvas));
  hints.set(canvas, setTimeout(() => classList.remove("shown"), 1500));
}

function follow() {
  const found = /^#spot-(\d+)$/.exec(location.hash);
  if (found) show(Number(found[1]));
}
document.addEventListener("click", (event) => {
  clicked = event;
  // A click on the same link shows the triangle again, which `hashchange` would not tell.
  const link = event.target.closest('a[href^="#spot-"]');
  if (link && link.hash === location.hash) follow();
});
window.addEventListener("hashchange", follow);
window.addEventListener("resize", resize);
// Paper is white, whatever the theme is.
for (const [name, isBefore] of [["beforeprint", true], ["afterprint", false]]) {
  window.addEventListener(name, () => {
    isPrinting = isBefore;
    redrawNow();
  });
}
window.matchMedia("(prefers-color-scheme: dark)").addEventListener("change", redraw);
resize();
legend();
follow();

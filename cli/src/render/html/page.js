"use strict";
// What every page has: hover texts of charts, and tables that sort by the column whose heading is clicked.

// The box beside the pointer.
const tip = document.createElement("div");
tip.id = "tip";
tip.setAttribute("role", "tooltip");
tip.hidden = true;

/**
 * Shows the box beside a place of an element, in CSS pixels from its upper left corner, and inside of the window. `gap` is the
 * distance of the box above or below the place.
 */
function showTip(parent, x, y, nodes, gap = 16) {
  tip.replaceChildren(...nodes);
  if (tip.parentElement !== parent) parent.append(tip);
  tip.hidden = false;
  const box = parent.getBoundingClientRect(), width = document.documentElement.clientWidth;
  const wanted = box.left + x < width / 2 ? x + 14 : x - 14 - tip.offsetWidth;
  tip.style.left = `${Math.max(4 - box.left, Math.min(wanted, width - box.left - tip.offsetWidth - 4))}px`;
  tip.style.top = `${box.top + y < window.innerHeight / 2 ? y + gap : y - gap - tip.offsetHeight}px`;
}

function hideTip() {
  tip.hidden = true;
}

for (const hit of document.querySelectorAll("svg .hit")) {
  // The title would appear as a second, later box.
  const title = hit.querySelector("title"), text = title.textContent, figure = hit.closest("figure");
  title.remove();
  hit.setAttribute("aria-label", text);
  const show = (event) => {
    const box = figure.getBoundingClientRect();
    showTip(figure, event.clientX - box.left, event.clientY - box.top, [text]);
  };
  hit.addEventListener("pointermove", show);
  hit.addEventListener("click", show);
  hit.addEventListener("pointerleave", hideTip);
}

/** Sorts the rows of a table by a column: first the worst, or names in their order; at a second click the other way. */
function sortBy(header) {
  const row = header.parentElement, body = header.closest("table").tBodies[0], column = header.cellIndex;
  const isBack = header.getAttribute("aria-sort") === "ascending";
  for (const other of row.cells) other.removeAttribute("aria-sort");
  header.setAttribute("aria-sort", isBack ? "descending" : "ascending");
  const key = (row) => row.cells[column].dataset.key ?? row.cells[column].textContent;
  const isText = header.dataset.sort === "text";
  // Values of which the larger ones are worse have keys of the opposite sign.
  const order = (a, b) => (isText ? key(a).localeCompare(key(b), undefined, { numeric: true }) : Number(key(a)) - Number(key(b)) || 0);
  body.append(...[...body.rows].sort((a, b) => (isBack ? order(b, a) : order(a, b))));
}

for (const button of document.querySelectorAll("th[data-sort] button")) button.onclick = () => sortBy(button.parentElement);

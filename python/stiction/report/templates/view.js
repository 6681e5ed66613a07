// Walks through the recordings of a diagnosis: time, speed, position and loop, zoomed together.
// Everything comes from the elements of this page; nothing is asked of a network.
const root = document.getElementById("explorer");
const told = JSON.parse(document.getElementById("explorer-data").textContent);
const one = name => root.querySelector(`[data-${name}]`);

// --- numbers

const digits = (value, figures = 3) =>
  Number.isFinite(value) ? String(+value.toPrecision(figures)).replace("-", "−") : "–";
const quantity = (value, unit, figures) =>
  unit === "" || unit === "1" ? digits(value, figures) : `${digits(value, figures)}\u00a0${unit}`;

// --- what is shown

const columns = {};
const { recordings, units, both } = told;
let along;            // time of each row, recordings one after the other
let role;             // of each row
let chosen = null;    // 1 for rows within the selected speeds and positions; null for all
let view = [0, 1];    // window of `along` that is shown
let marked = -1;      // row under the cursor
let candidate = null;
const hidden = new Set();  // of "measured", "before" and "after"
const selected = { speed: null, position: null };

const place = time => {
  let low = 0, high = along.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (along[middle] < time) low = middle + 1; else high = middle;
  }
  return low;
};
const nearest = time => {
  const k = Math.min(place(time), along.length - 1);
  return k > 0 && time - along[k - 1] < along[k] - time ? k - 1 : k;
};
const recordingOf = row => recordings.findIndex(each => row < each.rows[1]);
const span = index => {
  const { rows } = recordings[index];
  return [along[rows[0]], along[rows[1] - 1]];
};
const whole = () => [along[0], along[along.length - 1]];
// The recording that the window lies in, -1 where it shows several.
const single = () => {
  const index = recordings.findIndex((_, k) => {
    const [low, high] = span(k), room = 1e-9 * (high - low);
    return view[0] >= low - room && view[1] <= high + room;
  });
  return index;
};
const roleOf = index => {
  const rows = told.roles.map(() => 0);
  for (const [begin, end, kind] of recordings[index].parts) rows[kind] += end - begin;
  return told.roles.filter((name, kind) => name && rows[kind]).join(", ") || "left out";
};

function show(from, to) {
  const [low, high] = whole();
  const least = 4 * (high - low) / along.length;
  let width = Math.min(Math.max(to - from, least), high - low);
  from = Math.min(Math.max(from, low), high - width);
  view = [from, from + width];
  later();
}
const zoom = factor => {
  const centre = marked >= 0 && along[marked] >= view[0] && along[marked] <= view[1]
    ? along[marked] : (view[0] + view[1]) / 2;
  show(centre - (centre - view[0]) * factor, centre + (view[1] - centre) * factor);
};
const pan = share => {
  const way = share * (view[1] - view[0]);
  show(view[0] + way, view[1] + way);
};
const go = index => {
  marked = -1;
  show(...(index < 0 ? whole() : span(index)));
};
function select(name, range) {
  selected[name] = range;
  chosen = null;
  if (selected.speed || selected.position) {
    chosen = new Uint8Array(along.length).fill(1);
    for (const key of ["speed", "position"]) {
      if (!selected[key]) continue;
      const [low, high] = selected[key], { values } = columns[key];
      for (let k = 0; k < values.length; k++)
        if (!(values[k] >= low && values[k] <= high)) chosen[k] = 0;
    }
  }
  later();
}

// --- colours follow the page: light and dark

let colours = {};
const readColours = () => {
  const style = getComputedStyle(root);
  for (const name of ["ink", "soft", "line", "measured", "before", "after", "effect", "noise", "test"])
    colours[name] = style.getPropertyValue(`--${name}`).trim();
};
const colour = name => () => colours[name];


// Words, drawing and controls; the page begins here.
// --- words

const readout = one("readout"), summary = one("status");
const change = (before, after, unit) =>
  both ? `${digits(before)} → ${quantity(after, unit)}` : quantity(after, unit);

function mark(row) {
  marked = row;
  pairsDrawn.forEach(plot => plot.mark());
  if (row < 0) return;
  const { name, offset } = recordings[recordingOf(row)];
  const at = key => columns[key].values[row];
  const parts = [`${name} (${told.roles[role[row]] || "left out"})`, `${digits(along[row] - offset, 6)}\u00a0s`];
  let position = `position ${quantity(at("position"), units.position, 5)}`;
  if (columns["simulated-after"] && Number.isFinite(at("simulated-after")))
    position += `, simulated ${both ? `${digits(at("simulated-before"), 5)} → ` : ""}${digits(at("simulated-after"), 5)}`;
  parts.push(position, `speed ${quantity(at("speed"), units.speed)}`);
  parts.push(`effort ${quantity(at("effort"), units.effort)}`);
  parts.push(`residual ${change(at("before"), at("after"), units.residual)}`);
  if (candidate) parts.push(`effect ${quantity(columns[candidate].values[row], units.residual)}`);
  readout.textContent = parts.join(" · ");
}

function rms(first, last, values) {
  let sum = 0, rows = 0;
  for (let k = first; k < last; k++) {
    if (!role[k] || (chosen && !chosen[k])) continue;
    const own = values[k];
    if (own === own) { sum += own * own; rows += 1; }
  }
  return rows ? Math.sqrt(sum / rows) : NaN;
}

function tell() {
  const first = place(view[0]), last = place(view[1]);
  const index = single();
  const size = key => columns[key] ? rms(first, last, columns[key].values) : NaN;
  const where = index < 0 ? "Several recordings" : `${recordings[index].name} (${roleOf(index)})`;
  let text = `${where}, ${stamp(view[0])} to ${stamp(view[1])} s: residual `
    + `${change(size("before"), size("after"), units.residual)} rms`;
  const missed = [size("error-before"), size("error-after")];
  if (Number.isFinite(missed[1])) text += `; simulated position off by ${change(...missed, units.error)} rms`;
  for (const key of ["speed", "position"]) if (selected[key])
    text += `; ${key} ${digits(selected[key][0])} to ${quantity(selected[key][1], units[key])} alone`;
  summary.textContent = `${text}.`;
  one("recording").value = index >= 0 ? index : "all";
  one("clear").disabled = !chosen;
}

// --- drawing, at most once a frame

let waiting = 0, telling = 0, over = [], pairsDrawn = [];
function later() {
  if (!waiting) waiting = requestAnimationFrame(() => {
    waiting = 0;
    over.forEach(plot => plot.draw());
    // Points and words follow when the window has come to rest.
    clearTimeout(telling);
    telling = setTimeout(settle, 80);
  });
}
function settle() {
  findRows();
  pairsDrawn.forEach(plot => { plot.draw(); plot.mark(); });
  tell();
}
const rebuild = () => {
  findRows();
  [...over, ...pairsDrawn].forEach(plot => plot.build());
  pairsDrawn.forEach(plot => plot.mark());
  tell();
};

function choose(value) {
  const own = told.candidates[value];
  candidate = own && own.column ? own.column : null;
  one("told").textContent = !own ? "" : own.column ? `${own.told}.`
    : `${own.told}. What it would explain row by row was not kept.`;
  one("legend-effect").hidden = !candidate;
  rebuild();
}

// --- controls

const option = (holder, value, text) => {
  const made = document.createElement("option");
  [made.value, made.textContent] = [value, text];
  return holder.appendChild(made);
};
const group = (holder, text) => {
  const made = document.createElement("optgroup");
  made.label = text;
  return holder.appendChild(made);
};

function controls() {
  const list = one("recording");
  option(list, "all", `All ${recordings.length} recordings, one after the other`);
  const kinds = [["test", "Held out for the test"], ["", "Used to fit and to decide"]];
  for (const [kind, text] of kinds) {
    const own = recordings.map((_, k) => k).filter(k => roleOf(k).includes("test") === (kind === "test"));
    if (!own.length) continue;
    const holder = group(list, text);
    own.forEach(k => option(holder, k, `${recordings[k].name} (${roleOf(k)})`));
  }
  list.addEventListener("change", () => go(list.value === "all" ? -1 : +list.value));
  const effects = one("candidate");
  option(effects, "", "none");
  for (const kind of ["accepted", "refused"]) {
    const own = told.candidates.map((each, k) => [each, k]).filter(([each]) => each.group === kind);
    if (!own.length) continue;
    const holder = group(effects, kind);
    own.forEach(([each, k]) => option(holder, k, each.title + (each.column ? "" : " (not drawn)")));
  }
  effects.addEventListener("change", () => choose(effects.value === "" ? -1 : +effects.value));
  const doing = {
    in: () => zoom(0.5), out: () => zoom(2), earlier: () => pan(-0.3), later: () => pan(0.3),
    whole: () => go(recordingOf(nearest((view[0] + view[1]) / 2))),
    clear: () => { select("speed", null); select("position", null); },
  };
  for (const [name, act] of Object.entries(doing)) one(name).addEventListener("click", act);
  for (const button of root.querySelectorAll("[data-kind]")) button.addEventListener("click", () => {
    const { kind } = button.dataset;
    if (!hidden.delete(kind)) hidden.add(kind);
    button.setAttribute("aria-pressed", String(!hidden.has(kind)));
    rebuild();
  });
  const next = way => {
    const index = single();
    go(Math.min(Math.max((index < 0 ? recordingOf(place(view[0])) : index + way), 0), recordings.length - 1));
  };
  const step = way => {
    const centre = marked >= 0 ? along[marked] : (view[0] + view[1]) / 2;
    const row = nearest(Math.min(Math.max(centre + way * 0.01 * (view[1] - view[0]), view[0]), view[1]));
    over.forEach(({ u }) => u.setCursor({ left: u.valToPos(along[row], "x"), top: 10 }, false));
    mark(row);
    summary.textContent = readout.textContent;
  };
  const keys = {
    "+": doing.in, "=": doing.in, "-": doing.out, ArrowLeft: doing.earlier, ArrowRight: doing.later,
    Home: doing.whole, 0: doing.whole, PageDown: () => next(1), PageUp: () => next(-1),
    Escape: doing.clear, ",": () => step(-1), ".": () => step(1),
  };
  one("plots").addEventListener("keydown", event => {
    if (event.ctrlKey || event.metaKey || event.altKey || !keys[event.key]) return;
    event.preventDefault();
    keys[event.key]();
  });
  one("plots").addEventListener("wheel", event => {
    // With the key that zooms a page: without it a page must scroll.
    if (!event.ctrlKey && !event.metaKey) return;
    event.preventDefault();
    zoom(event.deltaY < 0 ? 0.8 : 1.25);
  }, { passive: false });
}

// What follows from the columns that are stored.
function derive() {
  const { ratio } = told, values = key => columns[key].values;
  const made = (key, own) => {
    columns[key] = levelled(Float64Array.from(values("effort"), own));
  };
  if (columns["simulated-after"]) for (const kind of ["before", "after"])
    made(`error-${kind}`, (_, k) =>
      told.finer * (values("position")[k] - values(`simulated-${kind}`)[k]));
  if (!told.friction) return;
  const bare = k => values("effort")[k] - values("inertial")[k];
  made("friction", (_, k) => bare(k));
  for (const kind of ["before", "after"]) {
    made(`model-${kind}`, (effort, k) => effort - ratio * values(kind)[k]);
    made(`friction-${kind}`, (_, k) => bare(k) - ratio * values(kind)[k]);
  }
}

async function start() {
  if (!window.DecompressionStream || !window.uPlot) return;
  const began = performance.now();
  await Promise.all(Object.keys(told.columns).map(async key => {
    const text = document.getElementById(`column-${key}`).textContent;
    columns[key] = levelled(await unpacked(text, told.columns[key]));
  }));
  derive();
  along = Float64Array.from(columns.time.values);
  role = new Uint8Array(along.length);
  for (const { rows, offset, parts } of recordings) {
    for (let k = rows[0]; k < rows[1]; k++) along[k] += offset;
    for (const [begin, end, kind] of parts) role.fill(kind, begin, end);
  }
  view = span(told.first);
  readColours();
  controls();
  root.hidden = false;
  document.documentElement.classList.add("interactive");
  // The residual of a servo is its error of position.
  const names = Object.keys(lines).filter(name =>
    name !== "error" || (told.friction && columns["error-after"]));
  over = names.map(name =>
    timePanel(name, one("plots").querySelector(`[data-time="${name}"]`), name === "residual"));
  pairsDrawn = pairs.map((pair, k) => {
    const holder = one("pairs").appendChild(document.createElement("div"));
    return pairPanel(pair, holder, k === 2);
  });
  rebuild();
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => { readColours(); rebuild(); });
  let width = root.clientWidth;
  new ResizeObserver(() => {
    if (root.clientWidth === width) return;
    width = root.clientWidth;
    rebuild();
  }).observe(root);
  root.dataset.ready = String(Math.round(performance.now() - began));
}
start().catch(error => {
  root.hidden = true;
  document.documentElement.classList.remove("interactive");
  console.error(error);
});

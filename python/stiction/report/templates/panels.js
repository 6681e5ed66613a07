// Panels over time, and over speed and position.
// --- panels

const lines = {
  position: [["position", "measured"], ["simulated-before", "before"], ["simulated-after", "after"]],
  error: [["error-before", "before"], ["error-after", "after"]],
  effort: [["effort", "measured"], ["model-before", "before"], ["model-after", "after"]],
  residual: [["before", "before"], ["after", "after"], ["effect", "effect"]],
};
const heights = { position: 100, error: 90, effort: 100, residual: 150 };
const pairs = told.friction
  ? [["speed", "friction"], ["position", "residual"], ["position", "friction"]]
  : [["speed", "residual"], ["position", "residual"]];
const points = {
  friction: [["friction", "measured"], ["friction-before", "before"], ["friction-after", "after"]],
  residual: [["before", "before"], ["after", "after"], ["effect", "effect"]],
};
const naming = {
  position: `position (${units.position})`,
  speed: `speed (${units.speed})`,
  error: `error (${units.error})`,
  effort: `effort (${units.effort})`,
  residual: `residual (${units.residual})`,
  friction: `effort less inertia (${units.effort})`,
};
const shown = list => list.filter(([key, kind]) => !hidden.has(kind)).filter(([key, kind]) =>
  columns[key] && (both || kind !== "before") || (key === "effect" && candidate));
const column = key => key === "effect" ? columns[candidate] : columns[key];
const timeLabel = () => single() < 0 && recordings.length > 1
  ? "time, recordings one after the other (s)" : "time in the recording (s)";
const label = text => text.replace(" (1)", "").replace(" ()", "");

const axes = (x, y) => [x, y].map((text, k) => ({
  label: label(text), labelSize: 18, labelGap: 0, size: k ? 58 : 32, gap: 3, space: k ? 24 : 60,
  font: "12px system-ui, sans-serif", labelFont: "12px system-ui, sans-serif",
  stroke: colour("ink"), grid: { stroke: colour("line"), width: 1 },
  ticks: { stroke: colour("line"), width: 1, size: 4 },
  values: (_, splits) => splits.map(value => digits(value, 6)),
}));

// Points of some columns over the window: all of them, or two for each pixel.
function drawn(keys, width) {
  const xs = [], ys = keys.map(() => []);
  const first = place(view[0]), last = place(view[1]);
  const block = Math.max(1, Math.floor((last - first) / width));
  for (const { rows } of recordings) {
    if (rows[1] <= first || rows[0] > last) continue;
    // One more row on either side: lines go on beyond the window.
    const begin = Math.max(rows[0], first - 1), end = Math.min(rows[1], last + 1);
    if (xs.length) { xs.push(along[begin]); ys.forEach(y => y.push(null)); }
    if (block < 3) {
      for (let k = begin; k < end; k++) {
        xs.push(along[k]);
        keys.forEach((key, own) => {
          const value = column(key).values[k];
          ys[own].push(value === value && (!chosen || chosen[k]) ? value : null);
        });
      }
      continue;
    }
    for (let k = begin; k < end; k += block) {
      const stop = Math.min(k + block, end);
      xs.push(along[k], along[(k + stop) >> 1]);
      keys.forEach((key, own) => {
        const seen = extremes(column(key), k, stop);
        ys[own].push(seen ? found.low : null, seen ? found.high : null);
      });
    }
  }
  return [xs, ...ys];
}

function shade(u, name) {
  const { ctx, bbox } = u;
  const at = x => Math.round(u.valToPos(x, "x", true));
  ctx.save();
  ctx.beginPath();
  ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
  ctx.clip();
  ctx.fillStyle = colours.test;
  const test = told.roles.indexOf("test");
  for (const { parts } of recordings) for (const [begin, end, kind] of parts)
    if (kind === test && along[end - 1] >= view[0] && along[begin] <= view[1])
      ctx.fillRect(at(along[begin]), bbox.top, Math.max(at(along[end - 1]) - at(along[begin]), 1), bbox.height);
  if (name === "residual" && told.noise) {
    const top = u.valToPos(2 * told.noise, "y", true), foot = u.valToPos(-2 * told.noise, "y", true);
    ctx.fillStyle = colours.noise;
    ctx.fillRect(bbox.left, top, bbox.width, foot - top);
  }
  ctx.fillStyle = colours.soft;
  for (const { rows } of recordings) {
    const x = along[rows[0]];
    if (x > view[0] && x < view[1]) ctx.fillRect(at(x), bbox.top, 1, bbox.height);
  }
  ctx.restore();
}

const padded = (low, high) => {
  if (!(low <= high)) return [-1, 1];
  const room = 0.06 * (high - low) || 0.06 * Math.abs(high) || 1;
  return [low - room, high + room];
};

function timePanel(name, holder, last) {
  const plot = { keys: [], u: null };
  const build = () => {
    plot.u?.destroy();
    const list = shown(lines[name]);
    plot.keys = list.map(([key]) => key);
    const width = Math.max(holder.clientWidth, 200);
    plot.u = new uPlot({
      width, height: heights[name] + (last ? 50 : 12), legend: { show: false },
      scales: { x: { time: false, range: () => view }, y: { range: (_, low, high) => padded(low, high) } },
      axes: axes("time in the recording (s)", naming[name]).map((axis, k) => k ? axis : {
        ...axis, splits: ticks, ...(last ? { label: timeLabel, values: (_, at) => at.map(stamp), size: 30 }
          : { label: undefined, values: () => [], size: 6 }),
      }),
      series: [{}, ...list.map(([, kind]) => ({
        stroke: colour(kind), width: { measured: 1.6, effect: 2 }[kind] || 1, points: { show: false },
      }))],
      cursor: {
        sync: { key: "recordings" }, y: false, points: { size: 6 },
        drag: { x: true, y: false, setScale: false },
        bind: { dblclick: () => () => { go(recordingOf(nearest((view[0] + view[1]) / 2))); return null; } },
      },
      hooks: {
        drawClear: [u => shade(u, name)],
        setSelect: [u => {
          const { left, width } = u.select;
          if (width < 4) return;
          const [from, to] = [u.posToVal(left, "x"), u.posToVal(left + width, "x")];
          u.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
          show(from, to);
        }],
        setCursor: [u => {
          if (u.cursor.left >= 0 && u.over.matches(":hover")) mark(nearest(u.posToVal(u.cursor.left, "x")));
        }],
      },
    }, drawn(plot.keys, width), holder);
    describe(plot.u, `${naming[name]} over time`);
    touched(plot.u);
  };
  plot.build = build;
  plot.draw = () => plot.u.setData(drawn(plot.keys, plot.u.width));
  return plot;
}

function describe(u, text) {
  u.root.setAttribute("role", "img");
  u.root.setAttribute("aria-label", label(text));
}

// Fingers: one goes along the time, or reads where it taps; two zoom. Up and down the page scrolls.
function touched(u) {
  const at = event => {
    const { left, width } = u.over.getBoundingClientRect();
    return view[0] + (event.clientX - left) / width * (view[1] - view[0]);
  };
  const fingers = new Map();
  let moved = false;
  u.over.addEventListener("pointerdown", event => {
    if (event.pointerType !== "touch") return;
    fingers.set(event.pointerId, at(event));
    moved = false;
  });
  u.over.addEventListener("pointermove", event => {
    if (!fingers.has(event.pointerId)) return;
    const here = fingers.get(event.pointerId), now = at(event);
    moved = true;
    if (fingers.size === 1) return show(view[0] + here - now, view[1] + here - now);
    // What lies under each finger stays there.
    const [other] = [...fingers].filter(([id]) => id !== event.pointerId).map(([, time]) => time);
    if (now === other || (here - other) / (now - other) <= 0) return;
    const factor = (here - other) / (now - other);
    show(other + (view[0] - other) * factor, other + (view[1] - other) * factor);
  });
  for (const name of ["pointerup", "pointercancel"]) u.over.addEventListener(name, event => {
    if (!fingers.delete(event.pointerId) || moved || name === "pointercancel") return;
    mark(nearest(at(event)));
  });
}

// Seconds count from the first row of a recording where the window lies within one.
const origin = () => {
  const index = single();
  return index < 0 ? along[0] : recordings[index].offset;
};
const stamp = time => digits(Math.abs(time - origin()) < 1e-9 ? 0 : time - origin(), 5);
function ticks(u, axis, low, high, step) {
  const zero = origin(), at = [];
  for (let k = Math.ceil((low - zero) / step); zero + k * step <= high; k++) at.push(zero + k * step);
  return at;
}

// --- panels over speed and position

const MOST_POINTS = 4000;

// Rows of the window that are selected; of many so many, evenly.
let rows = [];
function findRows() {
  const first = place(view[0]), last = place(view[1]);
  let number = last - first, step = 1, seen = 0;
  if (chosen) for (let k = first, all = number; k < first + all; k++) number -= 1 - chosen[k];
  step = Math.max(number / MOST_POINTS, 1);
  rows = [];
  for (let k = first; k < last; k++) {
    if (chosen && !chosen[k]) continue;
    if (seen >= rows.length * step) rows.push(k);
    seen += 1;
  }
}

function paint(u, series) {
  uPlot.orient(u, series, (own, _x, _y, scaleX, scaleY, toX, toY, left, top, width, height) => {
    const [xs, ys] = u.data[series], { ctx } = u, joined = u.joined;
    ctx.save();
    ctx.beginPath();
    ctx.rect(u.bbox.left, u.bbox.top, u.bbox.width, u.bbox.height);
    ctx.clip();
    ctx.globalAlpha = joined ? 1 : 0.55;
    ctx.fillStyle = ctx.strokeStyle = own.stroke(u, series);
    ctx.lineWidth = devicePixelRatio;
    const size = 2 * devicePixelRatio;
    ctx.beginPath();
    xs.forEach((x, k) => {
      const cx = toX(x, scaleX, width, left), cy = toY(ys[k], scaleY, height, top);
      if (!joined) ctx.fillRect(cx - size / 2, cy - size / 2, size, size);
      else if (k && u.rows[k] === u.rows[k - 1] + 1) ctx.lineTo(cx, cy);
      else ctx.moveTo(cx, cy);
    });
    if (joined) ctx.stroke();
    ctx.restore();
  });
  return null;
}

function pairPanel([across, up], holder, joins) {
  const plot = { u: null };
  const range = () => {
    if (selected[across]) return selected[across];
    const [first, last] = [place(view[0]), place(view[1])];
    return extremes(columns[across], first, last) ? padded(found.low, found.high) : [-1, 1];
  };
  const data = list => {
    // A panel needs a curve, if only one without points.
    if (!list.length) return [null, [[], []]];
    const at = values => Float64Array.from(rows, k => values[k]);
    const xs = at(columns[across].values);
    return [null, ...list.map(([key]) => [xs, at(column(key).values)])];
  };
  const bounds = u => {
    let low = Infinity, high = -Infinity;
    for (const own of u.data.slice(1)) for (const y of own[1]) {
      if (y < low) low = y;
      if (y > high) high = y;
    }
    return padded(low, high);
  };
  const put = (u, found) => {
    u.rows = rows;
    u.joined = joins && rows.length < MOST_POINTS;
    u.setData(found);
  };
  plot.build = () => {
    plot.u?.destroy();
    plot.list = shown(points[up]);
    const first = data(plot.list);
    plot.u = new uPlot({
      mode: 2, width: Math.max(holder.clientWidth, 180), height: 230, legend: { show: false },
      scales: { x: { time: false, range: () => range() }, y: { range: u => bounds(u) } },
      axes: axes(naming[across], naming[up]),
      series: [{}, ...(plot.list.length ? plot.list : [["", "soft"]]).map(([, kind]) => ({
        facets: [{ scale: "x", auto: true }, { scale: "y", auto: true }],
        stroke: colour(kind), paths: paint, points: { show: false },
      }))],
      cursor: {
        x: false, y: false, points: { show: false }, drag: { x: true, y: false, setScale: false },
        dataIdx: () => null, bind: { dblclick: () => () => { select(across, null); return null; } },
      },
      hooks: { setSelect: [u => {
        const { left, width } = u.select;
        if (width < 4) return;
        const limits = [u.posToVal(left, "x"), u.posToVal(left + width, "x")];
        u.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
        select(across, limits);
      }] },
    }, first, holder);
    put(plot.u, first);
    describe(plot.u, `${naming[up]} over ${naming[across]}`);
    plot.dot = plot.u.over.appendChild(document.createElement("i"));
    plot.u.over.addEventListener("mousemove", event => {
      const box = plot.u.over.getBoundingClientRect();
      hover(plot.u, event.clientX - box.left, event.clientY - box.top);
    });
  };
  plot.draw = () => put(plot.u, data(plot.list));
  plot.mark = () => {
    plot.dot.style.display = "none";
    if (!plot.list.length) return;
    const key = plot.list[plot.list.length - 1][0];
    const x = plot.u.valToPos(columns[across].values[marked], "x");
    const y = plot.u.valToPos(column(key).values[marked], "y");
    const inside = marked >= 0 && x >= 0 && y >= 0 && x <= plot.u.over.clientWidth;
    plot.dot.style.display = inside ? "block" : "none";
    plot.dot.style.transform = `translate(${x - 4}px, ${y - 4}px)`;
  };
  return plot;
}

function hover(u, left, top) {
  let best = 400, row = -1;
  for (const [xs, ys] of u.data.slice(1)) for (let k = 0; k < xs.length; k++) {
    const dx = u.valToPos(xs[k], "x") - left;
    if (dx * dx >= best) continue;
    const dy = u.valToPos(ys[k], "y") - top;
    if (dx * dx + dy * dy < best) [best, row] = [dx * dx + dy * dy, u.rows[k]];
  }
  if (row >= 0) {
    mark(row);
    over.forEach(({ u: other }) =>
      other.setCursor({ left: other.valToPos(along[row], "x"), top: 10 }, false));
  }
}


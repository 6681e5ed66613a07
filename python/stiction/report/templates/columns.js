// Columns of numbers: unpacked from the elements of the page, and asked for extremes.
// --- columns: unpacked once, with the least and greatest value of stretches of 16, 256, … rows

const BASE = 16;

async function unpacked(text, { origin, step, order, blank }) {
  text = atob(text);
  const packed = new Uint8Array(text.length);
  for (let k = 0; k < text.length; k++) packed[k] = text.charCodeAt(k);
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
  const bytes = new Uint8Array(await new Response(stream).arrayBuffer());
  const rows = bytes.length / 4;
  const values = new Float64Array(rows);
  let slope = 0, whole = 0;
  for (let k = 0; k < rows; k++) {
    const zigzag = bytes[k] | bytes[rows + k] << 8 | bytes[2 * rows + k] << 16
      | bytes[3 * rows + k] << 24;
    const change = (zigzag >>> 1) ^ -(zigzag & 1);
    slope = order === 2 ? slope + change : change;
    whole = order === 0 ? slope : whole + slope;
    values[k] = origin + step * whole;
  }
  for (const [begin, end] of blank) values.fill(NaN, begin, end);
  return values;
}

function levelled(values) {
  const levels = [];
  let low = values, high = values;
  while (low.length > BASE) {
    const length = Math.ceil(low.length / BASE);
    const least = new Float64Array(length), most = new Float64Array(length);
    for (let k = 0; k < length; k++) {
      let a = Infinity, b = -Infinity;
      const end = Math.min((k + 1) * BASE, low.length);
      for (let j = k * BASE; j < end; j++) {
        if (low[j] < a) a = low[j];
        if (high[j] > b) b = high[j];
      }
      least[k] = a;
      most[k] = b;
    }
    levels.push([least, most]);
    [low, high] = [least, most];
  }
  return { values, levels };
}

// Least and greatest value of the rows from begin to end; where rows are selected, of those alone.
const found = { low: 0, high: 0 };
function extremes(column, begin, end) {
  let low = Infinity, high = -Infinity;
  if (chosen) {
    for (let k = begin; k < end; k++) {
      const value = column.values[k];
      if (!chosen[k]) continue;
      if (value < low) low = value;
      if (value > high) high = value;
    }
  } else {
    let level = -1, [least, most] = [column.values, column.values];
    for (;;) {
      const upper = column.levels[level + 1];
      const inner = upper && Math.ceil(begin / BASE) < Math.floor(end / BASE);
      const first = inner ? Math.ceil(begin / BASE) * BASE : end;
      const last = inner ? Math.floor(end / BASE) * BASE : end;
      for (let k = begin; k < first; k++) {
        if (least[k] < low) low = least[k];
        if (most[k] > high) high = most[k];
      }
      for (let k = last; k < end; k++) {
        if (least[k] < low) low = least[k];
        if (most[k] > high) high = most[k];
      }
      if (!inner) break;
      [begin, end] = [first / BASE, last / BASE];
      level += 1;
      [least, most] = upper;
    }
  }
  found.low = low;
  found.high = high;
  return low <= high;
}


// The data beside the program: scenes, and columns of numbers unpacked.

const $ = (id) => document.getElementById(id);
const content = JSON.parse($("data").textContent);
const columns = await unpack(content.columns, $("packed").textContent.trim());
const scenes = content.scenes;
const OKABE_ITO = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9"];
const TINTS = ["#0072B2", "#D55E00", "#009E73", "#CC79A7"];

async function unpack(describe, text) {
  const raw = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
  const stream = new Blob([raw]).stream().pipeThrough(new DecompressionStream("deflate"));
  const bytes = new Uint8Array(await new Response(stream).arrayBuffer());
  let place = 0;
  return describe.map(([count, size, low, step]) => {
    const values = new Float64Array(count);
    if (size === 0) return values.fill(low);
    const whole = 256 ** size;
    let sum = 0;
    for (let k = 0; k < count; k++) {
      let difference = 0;
      for (let j = size - 1; j >= 0; j--) difference = difference * 256 + bytes[place + j * count + k];
      sum = (sum + difference) % whole;
      values[k] = sum === whole - 1 ? NaN : low + sum * step;
    }
    place += size * count;
    return values;
  });
}

// Largest index with times[index] <= t, and the part of the way to the next.
function locate(times, t) {
  let low = 0, high = times.length - 1;
  if (high <= 0 || t <= times[0]) return [0, 0];
  if (t >= times[high]) return [high, 0];
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (times[middle] <= t) low = middle; else high = middle;
  }
  const step = times[low + 1] - times[low];
  return [low, step > 0 ? (t - times[low]) / step : 0];
}

function between(column, [k, part]) {
  const a = column[k];
  return part === 0 ? a : a + part * (column[k + 1] - a);
}

// The arrays of the page: gzip, base64, differences of neighbours. `radiosity/viewer/page.py` packs them.

async function inflate(text) {
  const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

// Rows of integers, as the differences to the number before in the row, sign in the lowest bit, byte by byte.
async function unpack(text, rows, columns) {
  const planes = await inflate(text), count = rows * columns, depth = planes.length / count;
  const numbers = new Int32Array(count);
  for (let row = 0; row < rows; row++) {
    let value = 0;
    for (let i = row * columns; i < (row + 1) * columns; i++) {
      let folded = 0;
      for (let byte = depth - 1; byte >= 0; byte--) folded = (folded << 8) | planes[byte * count + i];
      value += (folded >>> 1) ^ -(folded & 1);
      numbers[i] = value;
    }
  }
  return numbers;
}

// Light of each order, W/m²: a logarithm of each channel, in steps too small to see.
function lightOf(codes, meta) {
  const { patches, orders, channels, stops, levels, brightest } = meta;
  const table = new Float32Array(levels + 1);
  for (let code = 1; code <= levels; code++) table[code] = 2 ** (stops * ((code - 1) / (levels - 1) - 1));
  const light = [];
  for (let k = 0; k < orders; k++) {
    const order = new Float32Array(patches * 3);
    for (let c = 0; c < 3; c++) {
      const plane = k * channels + (channels === 3 ? c : 0), top = brightest[plane], from = plane * patches;
      for (let i = 0; i < patches; i++) order[3 * i + c] = top * table[codes[from + i]];
    }
    light.push(order);
  }
  return light;
}

async function loadScene(meta) {
  const [codes, grid, faces, surface] = await Promise.all([
    unpack(meta.light, meta.orders * meta.channels, meta.patches),
    unpack(meta.vertices, 3, meta.vertexCount),
    unpack(meta.faces, 4, meta.patches),
    unpack(meta.surface, 1, meta.patches),
  ]);
  const corners = new Float32Array(meta.patches * 12), V = meta.vertexCount, N = meta.patches;
  for (let i = 0; i < N; i++) {
    for (let j = 0; j < 4; j++) {
      const vertex = faces[j * N + i] < 0 ? faces[2 * N + i] : faces[j * N + i];
      for (let c = 0; c < 3; c++) corners[12 * i + 3 * j + c] = meta.low[c] + grid[c * V + vertex] * meta.step;
    }
  }
  const orders = lightOf(codes, meta), sums = [orders[0]];
  for (let k = 1; k < orders.length; k++) sums.push(orders[k].map((value, i) => value + sums[k - 1][i]));
  return { corners, surface, orders, sums };
}

function areaOf(corners, i) {
  const p = (j, c) => corners[12 * i + 3 * j + c];
  const d = [0, 1, 2].map((c) => p(2, c) - p(0, c)), e = [0, 1, 2].map((c) => p(3, c) - p(1, c));
  return 0.5 * Math.hypot(d[1] * e[2] - d[2] * e[1], d[2] * e[0] - d[0] * e[2], d[0] * e[1] - d[1] * e[0]);
}

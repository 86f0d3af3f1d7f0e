// The arrays of the page: gzip, base64, differences of neighbours. `radiosity/viewer/page_data.py` packs them.

const TEXTURE_WIDTH = 1024; // light lies in textures of so many patches a row; arrays are padded to whole rows

async function inflate(text) {
  const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}
const inflateJSON = async (text) => (text ? JSON.parse(new TextDecoder().decode(await inflate(text))) : []);

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

const padded = (count) => new Float32Array(3 * TEXTURE_WIDTH * Math.ceil(Math.max(1, count) / TEXTURE_WIDTH));

// Light of each order, W/m²: a logarithm of each channel, in steps too small to see.
async function lightOf(packed, count, patches) {
  const { channels, stops, levels, brightest } = packed;
  if (!count) return [];
  const codes = await unpack(packed.light, count * channels, patches);
  const table = new Float32Array(levels + 1);
  for (let code = 1; code <= levels; code++) table[code] = 2 ** (stops * ((code - 1) / (levels - 1) - 1));
  return Array.from({ length: count }, (_, k) => {
    const light = padded(patches);
    for (let c = 0; c < 3; c++) {
      const plane = k * channels + (channels === 3 ? c : 0), top = brightest[plane], from = plane * patches;
      for (let i = 0; i < patches; i++) light[3 * i + c] = top * table[codes[from + i]];
    }
    return light;
  });
}

// Corners (4 a patch; a triangle repeats its third) and surfaces. Solutions on the same patches share them.
async function loadPatches(meta) {
  const [grid, faces, surface] = await Promise.all([
    unpack(meta.vertices, 3, meta.vertexCount), unpack(meta.faces, 4, meta.patches), unpack(meta.surface, 1, meta.patches),
  ]);
  const corners = new Float32Array(meta.patches * 12), vertex = new Int32Array(meta.patches * 4), V = meta.vertexCount, N = meta.patches;
  for (let i = 0; i < N; i++) {
    for (let j = 0; j < 4; j++) {
      const v = (vertex[4 * i + j] = faces[j * N + i] < 0 ? faces[2 * N + i] : faces[j * N + i]);
      for (let c = 0; c < 3; c++) corners[12 * i + 3 * j + c] = meta.low[c] + grid[c * V + v] * meta.step;
    }
  }
  return { corners, surface, grid, vertex, triangle: (i) => faces[3 * N + i] < 0 };
}

// All scenes of the page. One that says `like: n` has the patches of scene n.
async function loadScenes(metas) {
  const shapes = await Promise.all(metas.map((meta) => ("like" in meta ? null : loadPatches(meta))));
  return Promise.all(metas.map(async (own) => {
    const meta = "like" in own ? { ...metas[own.like], wrong: undefined, ...own } : own, N = meta.patches;
    const orders = await lightOf(meta, meta.orders, N), sums = sumsOf(orders, 1);
    const kept = meta.wrong ? await lightOf(meta.wrong, meta.wrong.count, N) : [];
    const wrong = meta.wrong ? meta.wrong.sums.map((k) => (k < 0 ? kept.shift() : sums[k])) : [];
    return { meta, ...shapes["like" in own ? own.like : metas.indexOf(own)], orders, sums, wrong };
  }));
}

// Partial sums of the orders, if all paint is `paint` times as bright: then T is, and T^k is paint^k times what it was.
function sumsOf(orders, paint) {
  const sums = [];
  orders.forEach((order, k) => {
    const share = paint ** k, sum = order.slice();
    if (k) for (let i = 0; i < sum.length; i++) sum[i] = sums[k - 1][i] + share * order[i];
    sums.push(sum);
  });
  return sums;
}

const cornerOf = (corners, i, j) => corners.subarray(12 * i + 3 * j, 12 * i + 3 * j + 3);
const midOf = (corners, i) => [0, 1, 2].map((c) => (corners[12 * i + c] + corners[12 * i + 3 + c] + corners[12 * i + 6 + c] + corners[12 * i + 9 + c]) / 4);
function crossOf(corners, i) {
  const p = (j, c) => corners[12 * i + 3 * j + c];
  const d = [0, 1, 2].map((c) => p(2, c) - p(0, c)), e = [0, 1, 2].map((c) => p(3, c) - p(1, c));
  return cross(d, e);
}
const areaOf = (corners, i) => 0.5 * Math.hypot(...crossOf(corners, i));

// For each corner of each patch, the patches whose mean is shown there: of one surface, and not bent away by 30° or more.
const CREASE = Math.cos(Math.PI / 6), MERGE = 4; // corners so few grid steps apart are one point
function meetings(scene) {
  if (scene.meeting) return scene.meeting;
  const { meta, grid, vertex, surface, corners } = scene, V = meta.vertexCount, N = meta.patches, groups = new Map();
  const normal = Array.from({ length: N }, (_, i) => unit(crossOf(corners, i)));
  const key = (i, j) => `${surface[i]} ${[0, 1, 2].map((c) => Math.floor(grid[c * V + vertex[4 * i + j]] / MERGE + 0.381966))}`;
  const keys = [];
  for (let i = 0; i < N; i++) {
    for (let j = 0; j < 4; j++) {
      const word = key(i, j);
      keys.push(word);
      if (j === 3 && scene.triangle(i)) continue; // counted once
      groups.has(word) ? groups.get(word).push(i) : groups.set(word, [i]);
    }
  }
  scene.meeting = keys.map((word, at) => groups.get(word).filter((i) => dot(normal[i], normal[at >> 2]) > CREASE));
  return scene.meeting;
}

// Light of patches as light of their corners.
function atCorners(scene, light) {
  const corners = padded(4 * scene.meta.patches);
  meetings(scene).forEach((patches, at) => {
    for (const i of patches) for (let c = 0; c < 3; c++) corners[3 * at + c] += light[3 * i + c] / patches.length;
  });
  return corners;
}

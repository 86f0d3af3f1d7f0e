// The page: one state, drawn; controls, keys and gestures only change the state.

const $ = (id) => document.getElementById(id);
const meta = JSON.parse($("data").textContent);
const narrow = matchMedia("(max-width: 820px)");
const EXPOSURES = [-6, 12];
const PLAY_MILLISECONDS = 700;
const state = {
  k: Math.min(1, meta.orders - 1), ev: 0, show: narrow.matches ? "sum" : "both", tone: "reinhard",
  normalised: false, falseColour: false, markClipped: false, playing: false, camera: 0, picked: -1,
};
const viewer = (window.viewer = { state, set, meta });
let scene, painter, camera, radius, timer;

const clamp = (x, low, high) => Math.min(Math.max(x, low), high);
const digits = (x) => (x === 0 ? "0" : x.toPrecision(3).replace(/e\+?(-?\d+)/, " × 10^$1"));
const triple = (values) => (meta.channels === 1 ? digits(values[0]) : [...values].map(digits).join(" / "));
const signed = (x) => (x < -0.049 ? "−" : "+") + Math.abs(x).toFixed(1) + " EV";
const inWords = (k) => ["light the lamps emit", "direct light", "bounced twice"][k] || `bounced ${k} times`;

// The exposure factor of a pane; the same rule as `Series.factor`.
function factorOf(pane) {
  const own = state.normalised && pane === "order" ? meta.own[state.k] : 1;
  return meta.common * 2 ** state.ev * own;
}
const scaleOf = (pane) => (state.normalised && pane === "order" ? meta.ownScales[state.k] : meta.scale);

function noteOf(pane) {
  if (state.falseColour) return "luminance of radiosity B, W/m²";
  if (pane === "order" && !(meta.power[state.k].some((p) => p > 0))) return "no light of this order";
  const parts = [];
  if (state.normalised && pane === "order") parts.push(`×${Number(meta.own[state.k].toPrecision(3))}, ${signed(Math.log2(meta.own[state.k]))}`);
  if (state.ev) parts.push(`exposure ${signed(state.ev)}`);
  return parts.join(" · ") || "common exposure";
}

function panes() {
  const shown = state.show === "both" ? ["order", "sum"] : [state.show];
  const { width, height } = $("canvas"), each = Math.floor(width / shown.length);
  const linear = state.markClipped ? 2 : 1;
  return shown.map((pane, i) => ({
    pane, box: [i * each, 0, each, height], layer: (pane === "sum" ? painter.layers : 0) + state.k,
    tone: state.falseColour ? 3 : state.tone === "linear" ? linear : 0, factor: factorOf(pane), scale: scaleOf(pane),
  }));
}

function draw() {
  const canvas = $("canvas"), ratio = Math.min(devicePixelRatio || 1, 2);
  const width = Math.max(1, Math.round(canvas.clientWidth * ratio)), height = Math.max(1, Math.round(canvas.clientHeight * ratio));
  if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
  painter.draw(panes(), camera, radius);
}

let waiting = false;
function redraw() {
  if (waiting || !painter) return;
  waiting = true;
  requestAnimationFrame(() => { waiting = false; draw(); });
}

// Changes the state, and everything that shows it.
function set(change) {
  Object.assign(state, change);
  state.k = clamp(Math.round(state.k), 0, meta.orders - 1);
  state.ev = clamp(state.ev, ...EXPOSURES);
  if ("camera" in change) useCamera(state.camera);
  if ("playing" in change) play();
  showState();
  redraw();
}

function play() {
  clearInterval(timer);
  if (state.playing) timer = setInterval(() => set({ k: state.k + 1 < meta.orders ? state.k + 1 : 0 }), PLAY_MILLISECONDS);
}

function useCamera(number) {
  const preset = meta.cameras[number % meta.cameras.length];
  camera = { position: preset.position, target: preset.focal_point, up: preset.up, fov: preset.fov };
}

function showState() {
  const { k } = state;
  $("k").value = k;
  $("ev").value = state.ev;
  $("k-out").textContent = k;
  $("ev-out").textContent = signed(state.ev);
  for (const id of ["show", "tone"]) $(id).value = state[id];
  for (const id of ["normalised", "falseColour", "markClipped"]) $(id).checked = state[id];
  $("play").textContent = state.playing ? "pause" : "play";
  $("play").setAttribute("aria-pressed", state.playing);
  for (const title of document.querySelectorAll(".title")) {
    const pane = title.dataset.pane;
    title.hidden = state.show !== "both" && state.show !== pane;
    title.querySelector(".formula").innerHTML = pane === "order"
      ? `T<sup>${k}</sup> L<sub>e</sub>` : `Σ<sub>j = 0…${k}</sub> T<sup>j</sup> L<sub>e</sub>`;
    title.querySelector(".note").textContent = noteOf(pane);
  }
  $("canvas").setAttribute("aria-label", `${document.title}; ${state.show === "sum" ? `all light up to bounce ${k}` : `bounce ${k}: ${inWords(k)}`}`);
  $("scale").hidden = !state.falseColour;
  if (state.falseColour) drawScale($("scale").firstElementChild, scaleOf(state.show === "order" ? "order" : "sum"), meta.falseColours);
  drawPower($("power").querySelector("svg"), meta.power, k, state.picked < 0 ? null : patchByOrder(state.picked));
  showPick();
}

const patchByOrder = (patch) => scene.orders.map((light) => luminance(light, patch));
const luminance = (light, i) => 0.2126 * light[3 * i] + 0.7152 * light[3 * i + 1] + 0.0722 * light[3 * i + 2];

function showPick() {
  if (state.picked < 0) return;
  const i = state.picked, at = (light) => light.slice(3 * i, 3 * i + 3);
  const one = at(scene.orders[state.k]), sum = at(scene.sums[state.k]);
  $("pick").textContent = [
    `patch ${i} of ${meta.surfaceNames[scene.surface[i]]}, ${digits(areaOf(scene.corners, i) * 1e4)} cm²`,
    `bounce ${state.k}: B = ${triple(one)} W/m²`,
    `up to ${state.k}: B = ${triple(sum)} W/m²`,
    `L = B / π = ${triple([...sum].map((x) => x / Math.PI))} W/(m² sr)`,
  ].join("\n");
}

// Which patch each pixel of a pane shows, by rows from the lower left.
const patchesOf = (pane) => {
  const one = panes().find((other) => other.pane === pane);
  return painter.patchesAt(one, camera, radius, one.box);
};

// Picks what a point of the page shows, in pixels of the canvas element from its upper left.
function pick(x, y) {
  const canvas = $("canvas"), ratio = canvas.width / canvas.clientWidth;
  const px = Math.floor(x * ratio), py = canvas.height - 1 - Math.floor(y * ratio);
  const pane = panes().find(({ box }) => px >= box[0] && px < box[0] + box[2]);
  set({ picked: pane ? painter.patchesAt(pane, camera, radius, [px, py, 1, 1])[0] : -1 });
  if (state.picked < 0) $("pick").textContent = "Click a patch to read its light.";
  return state.picked;
}

function turn(dx, dy) {
  const arm = minus(camera.position, camera.target), length = Math.hypot(...arm), up = unit(camera.up);
  const height = clamp(Math.asin(clamp(dot(arm, up) / length, -1, 1)) + dy * 0.006, -1.5, 1.5);
  const level = minus(arm, up.map((u) => u * dot(arm, up)));
  const side = unit(Math.hypot(...level) > 1e-9 * length ? level : cross(up, [0.3, 0.5, 0.7]));
  const across = cross(up, side), angle = -dx * 0.006;
  const flat = side.map((s, i) => s * Math.cos(angle) + across[i] * Math.sin(angle));
  camera.position = camera.target.map((t, i) => t + length * (flat[i] * Math.cos(height) + up[i] * Math.sin(height)));
  redraw();
}

function zoom(factor) {
  const arm = minus(camera.position, camera.target), length = clamp(Math.hypot(...arm) * factor, 0.02 * radius, 50 * radius);
  camera.position = camera.target.map((t, i) => t + unit(arm)[i] * length);
  redraw();
}

function move(dx, dy) {
  const forward = unit(minus(camera.target, camera.position)), right = unit(cross(forward, camera.up)), up = cross(right, forward);
  const size = (2 * Math.tan((camera.fov * Math.PI) / 360) * Math.hypot(...minus(camera.target, camera.position))) / $("canvas").clientHeight;
  const shift = right.map((r, i) => (-dx * r + dy * up[i]) * size);
  camera.position = camera.position.map((p, i) => p + shift[i]);
  camera.target = camera.target.map((t, i) => t + shift[i]);
  redraw();
}

const nextShow = { both: "order", order: "sum", sum: "both" };
const KEYS = {
  ArrowRight: () => set({ k: state.k + 1 }), ArrowLeft: () => set({ k: state.k - 1 }),
  Home: () => set({ k: 0 }), End: () => set({ k: meta.orders - 1 }),
  ArrowUp: () => set({ ev: state.ev + 0.5 }), ArrowDown: () => set({ ev: state.ev - 0.5 }), 0: () => set({ ev: 0 }),
  " ": () => set({ playing: !state.playing }), n: () => set({ normalised: !state.normalised }),
  t: () => set({ tone: state.tone === "linear" ? "reinhard" : "linear" }), f: () => set({ falseColour: !state.falseColour }),
  m: () => set({ markClipped: !state.markClipped }), c: () => set({ camera: state.camera + 1 }),
  v: () => set({ show: nextShow[state.show] }), "?": () => $("help").showModal(), h: () => $("help").showModal(),
};

function listen() {
  $("k").oninput = () => set({ k: +$("k").value, playing: false });
  $("ev").oninput = () => set({ ev: +$("ev").value });
  for (const id of ["show", "tone"]) $(id).onchange = () => set({ [id]: $(id).value });
  for (const id of ["normalised", "falseColour", "markClipped"]) $(id).onchange = () => set({ [id]: $(id).checked });
  $("back").onclick = KEYS.ArrowLeft;
  $("on").onclick = KEYS.ArrowRight;
  $("play").onclick = KEYS[" "];
  $("camera").onclick = KEYS.c;
  $("keys").onclick = KEYS["?"];
  $("power").querySelector("svg").onclick = (event) => {
    const box = event.currentTarget.getBoundingClientRect();
    set({ k: bounceAt(((event.clientX - box.left) / box.width) * 300, meta.orders) });
  };
  addEventListener("keydown", (event) => {
    const typing = ["SELECT", "BUTTON"].includes(event.target.tagName) || (event.target.type === "checkbox" && event.key === " ");
    if (typing || event.ctrlKey || event.metaKey || event.altKey || $("help").open) return;
    const act = KEYS[event.key.length === 1 ? event.key.toLowerCase() : event.key];
    if (act) { event.preventDefault(); act(); }
  });
  listenToFingers($("canvas"), { turn, zoom, move, pick });
  new ResizeObserver(draw).observe($("canvas"));
  $("canvas").addEventListener("webglcontextlost", () => trouble("The graphics memory was lost; load the page again."));
}

function trouble(words) {
  $("trouble").textContent = words;
  $("trouble").hidden = false;
}

// What a link may set: page.html#k=3&ev=1&show=sum&normalised=true
function fromLink() {
  const change = {};
  for (const [name, text] of new URLSearchParams(location.hash.slice(1))) {
    if (name === "k" || name === "ev") change[name] = Number(text) || 0;
    else if (typeof state[name] === "boolean") change[name] = text === "true" || text === "1";
    else if ((name === "show" && text in nextShow) || (name === "tone" && ["reinhard", "linear"].includes(text))) change[name] = text;
  }
  return change;
}

async function begin() {
  const means = "the numbers are in the table below; a browser from 2023 or later shows the picture";
  if (!("DecompressionStream" in window)) return trouble(`This browser cannot unpack the page's data: ${means}.`);
  if (!document.createElement("canvas").getContext("webgl2")) return trouble(`This browser cannot draw with WebGL2: ${means}.`);
  $("k").max = meta.orders - 1;
  scene = await loadScene(meta);
  painter = new Painter($("canvas"), scene, meta);
  radius = meta.radius;
  useCamera(0);
  Object.assign(viewer, { draw, pick, patchesOf, scene, painter });
  listen();
  set(fromLink());
}
viewer.ready = begin().catch((error) => { trouble(`The picture cannot be drawn: ${error.message}`); throw error; });

// The page: one state, drawn; controls, keys and gestures only change the state.

const $ = (id) => document.getElementById(id);
const data = JSON.parse($("data").textContent);
const narrow = matchMedia("(max-width: 820px)");
const EXPOSURES = [-6, 12];
const PLAY_MILLISECONDS = 700;
const NEUTRAL = {
  scene: 0, k: 1, ev: 0, paint: 1, left: "order", wrong: 0, difference: false, beside: 0, colours: 0, figure: 0, titles: ["", ""],
  tone: "reinhard", normalised: false, falseColour: false, markClipped: false, smooth: false, playing: false, camera: 0, picked: -1, other: -1,
};
const state = { ...NEUTRAL, show: narrow.matches && !data.talk ? "sum" : "both" };
const viewer = (window.viewer = { state, set, data });
let scenes, scene, shortcuts = [], plates = [], figures = [], painter, camera, radius, timer;

function draw() {
  const canvas = $("canvas"), ratio = Math.min(devicePixelRatio || 1, 2);
  const width = Math.max(1, Math.round(canvas.clientWidth * ratio)), height = Math.max(1, Math.round(canvas.clientHeight * ratio));
  if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
  const shown = panes();
  painter.draw(shown, camera, radius);
  for (const pane of shown) {
    if (!pane.light || pane.sees !== undefined) continue;
    for (const patch of [state.picked, state.other]) if (patch >= 0) painter.outline(pane, camera, radius, patch);
  }
}

let waiting = false;
function redraw() {
  if (waiting || !painter) return;
  waiting = true;
  requestAnimationFrame(() => { waiting = false; draw(); });
}

// Changes the state, and everything that shows it.
function set(change) {
  if (change.left && change.left !== state.left) {
    change = { ...(change.left === "order" ? {} : { paint: 1 }), titles: NEUTRAL.titles, ...change };
    if (narrow.matches && state.show === "sum" && change.left !== "order") change.show = "order";
  }
  if (change.paint !== undefined && change.paint !== 1 && ["wrong", "beside"].includes(state.left)) change = { ...change, left: "order", titles: NEUTRAL.titles };
  Object.assign(state, change);
  if (scenes[state.scene] !== scene) enter(scenes[state.scene]);
  const last = scene.meta.orders - 1;
  state.k = clamp(Math.round(state.k), 0, last);
  state.ev = clamp(state.ev, ...EXPOSURES);
  if (state.left === "wrong" && change.left === "wrong" && change.k === undefined) state.k = last; // beside all the light there is
  for (const name of ["picked", "other"]) if (state[name] >= scene.meta.patches) state[name] = -1;
  if ("camera" in change) useCamera(state.camera);
  if ("playing" in change) play();
  showState();
  redraw();
}

// Goes over to another scene of the page.
function enter(next) {
  const other = !scene || scene.corners !== next.corners;
  scene = viewer.scene = next;
  viewer.meta = next.meta;
  $("k").max = next.meta.orders - 1;
  if (!other) return;
  painter.useScene(next);
  radius = next.meta.radius;
  useCamera(state.camera);
}

function play() {
  clearInterval(timer);
  if (state.playing) timer = setInterval(() => set({ k: state.k + 1 < scene.meta.orders ? state.k + 1 : 0 }), PLAY_MILLISECONDS);
}

// A preset by its number, or a camera of a lecture's own.
function useCamera(choice) {
  const { cameras } = scene.meta, { position, target, up, fov } = typeof choice === "number" ? cameras[choice % cameras.length] : choice;
  camera = { position: [...position], target: [...target], up: [...up], fov };
}

function showState() {
  const { k } = state;
  $("k").value = k;
  $("ev").value = state.ev;
  $("paint").value = state.paint;
  $("k-out").textContent = k;
  $("ev-out").textContent = signed(state.ev);
  $("paint-out").textContent = `× ${state.paint.toFixed(2)}`;
  $("show").value = state.show;
  $("tone").value = state.tone;
  $("left").value = state.left === "wrong" ? `wrong ${state.wrong}` : state.left;
  for (const id of ["normalised", "falseColour", "markClipped", "smooth", "difference"]) $(id).checked = state[id];
  $("difference").parentElement.hidden = state.left !== "wrong";
  $("play").textContent = state.playing ? "pause" : "play";
  $("play").setAttribute("aria-pressed", state.playing);
  for (const title of document.querySelectorAll(".title")) {
    const { pane } = title.dataset, [heading, note] = titleOf(pane);
    title.hidden = state.show !== "both" && state.show !== pane;
    title.classList.toggle("wrong", pane === "order" && state.left === "wrong");
    title.querySelector(".formula").innerHTML = heading;
    title.querySelector(".note").textContent = note;
  }
  const seen = { wrong: `WRONG: ${shortcuts[state.wrong]?.name}`, sees: `what patch ${state.picked} sees`, figure: "a plot" }[state.left] || `bounce ${k}: ${inWords(k)}`;
  $("canvas").setAttribute("aria-label", `${document.title}; ${state.show === "sum" ? "" : `${seen}; `}all light up to bounce ${k}`);
  showFigure();
  showWrong();
  $("scale").hidden = !state.falseColour;
  if (state.falseColour) drawScale($("scale").firstElementChild, scaleOf(state.show === "order" ? "order" : "sum"), data.falseColours);
  const power = scene.meta.power.map((channels, j) => channels.map((p) => p * state.paint ** j));
  drawPower($("power").querySelector("svg"), power, k, state.picked < 0 ? null : patchByOrder(state.picked));
  showPick();
}

function showFigure() {
  const shown = state.left === "figure" && state.show !== "sum";
  $("figure").hidden = !shown;
  $("picture").classList.toggle("plot", shown);
  $("picture").classList.toggle("both", state.show === "both");
  $("figure").style.width = state.show === "both" ? "50%" : "100%";
  if (shown && $("figure").dataset.number !== String(state.figure)) {
    const { svg, png, alt } = figures[state.figure];
    Object.assign($("figure"), { src: png || `data:image/svg+xml,${encodeURIComponent(svg)}`, alt });
    $("figure").dataset.number = state.figure;
  }
}

function showWrong() {
  $("wrong").hidden = state.left !== "wrong";
  if (state.left !== "wrong") return;
  const { name, sentence, equation } = shortcuts[state.wrong];
  $("wrong-name").textContent = `WRONG: ${name}`;
  if ($("equation").dataset.number !== String(state.wrong)) {
    Object.assign($("equation"), { src: `data:image/svg+xml,${encodeURIComponent(equation)}`, alt: `The equation, with what is missing struck out: ${name}` });
    $("equation").dataset.number = state.wrong;
  }
  const legend = state.difference ? " Blue is too dark, orange too bright; full colour at ±100 %." : "";
  $("wrong-words").textContent = `${sentence} Off by ${percent(scene.meta.wrong.off[state.wrong])} on average.${legend}`;
}

const patchByOrder = (patch) => painted(scene, state.paint).orders.map((light) => luminance(light, patch));
const triple = (values) => (values[0] === values[1] && values[1] === values[2] ? digits(values[0]) : [...values].map(digits).join(" / "));

function showPick() {
  const i = state.picked;
  $("pick").classList.toggle("none", i < 0);
  if (i < 0) {
    $("pick").textContent = "Click a patch to read its light.";
    return;
  }
  const { orders, sums } = painted(scene, state.paint), at = (light) => light.slice(3 * i, 3 * i + 3);
  const sum = at(sums[state.k]), lines = [
    `patch ${i} of ${scene.meta.surfaceNames[scene.surface[i]]}, ${digits(areaOf(scene.corners, i) * 1e4)} cm²`,
    `bounce ${state.k}: B = ${triple(at(orders[state.k]))} W/m²`,
    `up to ${state.k}: B = ${triple(sum)} W/m²`,
    `L = B / π = ${triple(sum.map((x) => x / Math.PI))} W/(m² sr)`,
  ];
  if (state.left === "wrong") lines.splice(3, 0, `WRONG: B = ${triple(at(scene.wrong[state.wrong]))} W/m²`);
  $("pick").textContent = lines.join("\n");
}

// Which patch each pixel of a pane shows, by rows from the lower left.
const patchesOf = (pane) => {
  const one = panes().find((other) => other.pane === pane);
  return painter.patchesAt(one, camera, radius, one.box);
};

// Picks what a point of the page shows, in pixels of the canvas element from its upper left. In the picture of what a
// patch sees this is the recursion, walked by hand.
function pick(x, y) {
  const canvas = $("canvas"), ratio = canvas.width / canvas.clientWidth;
  const px = Math.floor(x * ratio), py = canvas.height - 1 - Math.floor(y * ratio);
  const pane = panes().find(({ box, light }) => light && px >= box[0] && px < box[0] + box[2]);
  const patch = pane ? painter.patchesAt(pane, camera, radius, [px, py, 1, 1])[0] : -1;
  if (patch >= 0 || pane?.sees === undefined) set({ picked: patch, other: -1 });
  return state.picked;
}

function turn(dx, dy) {
  const arm = minus(camera.position, camera.target), length = Math.hypot(...arm), up = unit(camera.up);
  const height = clamp(Math.asin(clamp(dot(arm, up) / length, -1, 1)) + dy * 0.006, -1.5, 1.5);
  const level = plus(arm, up, -dot(arm, up));
  const side = unit(Math.hypot(...level) > 1e-9 * length ? level : cross(up, [0.3, 0.5, 0.7]));
  const across = cross(up, side), angle = -dx * 0.006;
  const flat = side.map((s, i) => s * Math.cos(angle) + across[i] * Math.sin(angle));
  camera.position = camera.target.map((t, i) => t + length * (flat[i] * Math.cos(height) + up[i] * Math.sin(height)));
  redraw();
}

function zoom(factor) {
  const arm = minus(camera.position, camera.target), length = clamp(Math.hypot(...arm) * factor, 0.02 * radius, 50 * radius);
  camera.position = plus(camera.target, unit(arm), length);
  redraw();
}

function move(dx, dy) {
  const forward = unit(minus(camera.target, camera.position)), right = unit(cross(forward, camera.up)), up = cross(right, forward);
  const size = (2 * Math.tan((camera.fov * Math.PI) / 360) * Math.hypot(...minus(camera.target, camera.position))) / $("canvas").clientHeight;
  const shift = right.map((r, i) => (-dx * r + dy * up[i]) * size);
  camera.position = plus(camera.position, shift);
  camera.target = plus(camera.target, shift);
  redraw();
}

// The next shortcut beside the truth; after the last one, the bounces again.
function nextWrong() {
  if (!scene.wrong.length) return;
  if (state.left !== "wrong") set({ left: "wrong", wrong: 0 });
  else set(state.wrong + 1 < scene.wrong.length ? { wrong: state.wrong + 1 } : { left: "order" });
}

function trouble(words) {
  $("trouble").textContent = words;
  $("trouble").hidden = false;
}

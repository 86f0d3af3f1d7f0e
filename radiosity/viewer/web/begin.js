// Listens to keys, controls and fingers, and begins.

const nextShow = { both: "order", order: "sum", sum: "both" };
const KEYS = {
  ArrowRight: () => set({ k: state.k + 1 }), ArrowLeft: () => set({ k: state.k - 1 }),
  Home: () => set({ k: 0 }), End: () => set({ k: scene.meta.orders - 1 }),
  ArrowUp: () => set({ ev: state.ev + 0.5 }), ArrowDown: () => set({ ev: state.ev - 0.5 }), 0: () => set({ ev: 0 }),
  " ": () => set({ playing: !state.playing }), n: () => set({ normalised: !state.normalised }),
  t: () => set({ tone: state.tone === "linear" ? "reinhard" : "linear" }), f: () => set({ falseColour: !state.falseColour }),
  m: () => set({ markClipped: !state.markClipped }), s: () => set({ smooth: !state.smooth }),
  g: () => set({ left: state.left === "sees" ? "order" : "sees" }), x: nextWrong, d: () => set({ difference: !state.difference }),
  c: () => set({ camera: (typeof state.camera === "number" ? state.camera : 0) + 1 }),
  v: () => set({ show: nextShow[state.show] }), "?": () => $("help").showModal(), h: () => $("help").showModal(),
};
const TALK_KEYS = { PageDown: () => talk.forward(), Enter: () => talk.forward(), PageUp: () => talk.back(), Backspace: () => talk.back() };

function listen() {
  $("k").oninput = () => set({ k: +$("k").value, playing: false });
  for (const id of ["ev", "paint"]) $(id).oninput = () => set({ [id]: +$(id).value });
  for (const id of ["show", "tone"]) $(id).onchange = () => set({ [id]: $(id).value });
  for (const id of ["normalised", "falseColour", "markClipped", "smooth", "difference"]) $(id).onchange = () => set({ [id]: $(id).checked });
  $("left").onchange = () => {
    const [left, number] = $("left").value.split(" ");
    set(number === undefined ? { left } : { left, wrong: +number, k: scene.meta.orders - 1 });
  };
  $("back").onclick = KEYS.ArrowLeft;
  $("on").onclick = KEYS.ArrowRight;
  $("play").onclick = KEYS[" "];
  $("camera").onclick = KEYS.c;
  $("keys").onclick = KEYS["?"];
  $("power").querySelector("svg").onclick = (event) => {
    const box = event.currentTarget.getBoundingClientRect();
    set({ k: bounceAt(((event.clientX - box.left) / box.width) * 300, scene.meta.orders) });
  };
  addEventListener("keydown", (event) => {
    const { tagName, type } = event.target;
    const typing = tagName === "SELECT" || (tagName === "BUTTON" && [" ", "Enter"].includes(event.key)) || (type === "checkbox" && event.key === " ");
    if (typing || event.ctrlKey || event.metaKey || event.altKey || $("help").open) return;
    const act = KEYS[event.key.length === 1 ? event.key.toLowerCase() : event.key] || (talk && TALK_KEYS[event.key]);
    if (act) { event.preventDefault(); act(); }
  });
  listenToFingers($("canvas"), { turn, zoom, move, pick });
  new ResizeObserver(draw).observe($("canvas"));
  $("canvas").addEventListener("webglcontextlost", () => trouble("The graphics memory was lost; load the page again."));
}

// The choice of the left pane: what the page has.
function fillLeft() {
  const option = (parent, value, words) => parent.appendChild(Object.assign(document.createElement("option"), { value, textContent: words }));
  option($("left"), "order", "one bounce");
  option($("left"), "sees", "what the patch sees");
  if (shortcuts.length) {
    const group = $("left").appendChild(Object.assign(document.createElement("optgroup"), { label: "WRONG, on purpose" }));
    shortcuts.forEach(({ name }, i) => option(group, `wrong ${i}`, name));
  }
  if (data.talk) for (const [value, words] of [["figure", "the step's plot"], ["beside", "beside it"], ["colours", "form factors"]]) {
    Object.assign(option($("left"), value, words), { hidden: true });
  }
}

// What a link may set: page.html#k=3&ev=1&show=sum&normalised=true, and of a lecture #step=4
function fromLink() {
  const change = {};
  for (const [name, text] of new URLSearchParams(location.hash.slice(1))) {
    if (["k", "ev", "camera", "picked"].includes(name)) change[name] = Number(text) || 0;
    else if (name === "paint") change.paint = clamp(Number(text) || 1, 0, 1);
    else if (typeof state[name] === "boolean") change[name] = text === "true" || text === "1";
    else if (name === "wrong" && scene.wrong[Number(text)]) Object.assign(change, { left: "wrong", wrong: Number(text) });
    else if (name === "left" && ["order", "sees"].includes(text)) change.left = text;
    else if ((name === "show" && text in nextShow) || (name === "tone" && ["reinhard", "linear"].includes(text))) change[name] = text;
  }
  return change;
}

async function begin() {
  const means = "the numbers are in the table below; a browser from 2023 or later shows the picture";
  if (!("DecompressionStream" in window)) return trouble(`This browser cannot unpack the page's data: ${means}.`);
  if (!document.createElement("canvas").getContext("webgl2")) return trouble(`This browser cannot draw with WebGL2: ${means}.`);
  [scenes, shortcuts] = await Promise.all([loadScenes(data.scenes), inflateJSON(data.shortcuts)]);
  if (data.talk) [plates, figures] = await Promise.all([Promise.all(data.talk.plates.map(unpackColours)), inflateJSON(data.talk.figures)]);
  painter = new Painter($("canvas"), data.falseColours);
  Object.assign(state, data.begin);
  enter(scenes[state.scene]);
  useCamera(state.camera);
  if (!scene.wrong.length) shortcuts = [];
  Object.assign(viewer, { draw, pick, patchesOf, scenes, painter });
  fillLeft();
  listen();
  if (data.talk) viewer.talk = talk = new Talk(data.talk);
  else set({ ...data.begin, ...fromLink() });
}
let talk = null;
viewer.ready = begin().catch((error) => { trouble(`The picture cannot be drawn: ${error.message}`); throw error; });

// Which light each pane shows, as a function of the state; and what stands in words above it.

const luminance = (light, i) => 0.2126 * light[3 * i] + 0.7152 * light[3 * i + 1] + 0.0722 * light[3 * i + 2];
const clamp = (x, low, high) => Math.min(Math.max(x, low), high);
const digits = (x) => (x === 0 ? "0" : x.toPrecision(3).replace(/e\+?(-?\d+)/, " × 10^$1").replace("^-", "^−"));
const signed = (x) => (x < -0.049 ? "−" : "+") + Math.abs(x).toFixed(1) + " EV";
const percent = (x) => `${(100 * x).toFixed(0)}\u00a0%`;
const inWords = (k) => ["light the lamps emit", "direct light", "bounced twice"][k] || `bounced ${k} times`;
const KNOWN_LEFTS = ["order", "sees", "wrong", "beside", "colours", "figure"];

// Light with all paint made `paint` times as bright. The last one that was asked for is kept.
function painted(scene, paint) {
  if (paint === 1) return scene;
  if (scene.painted?.paint !== paint) {
    const orders = scene.orders.map((order, k) => order.map((value) => value * paint ** k));
    scene.painted = { paint, orders, sums: sumsOf(orders, 1) };
  }
  return scene.painted;
}

const smoothed = new WeakMap();
function smoothOf(scene, values) {
  if (!smoothed.has(values)) smoothed.set(values, atCorners(scene, values));
  return smoothed.get(values);
}

// How far wrong light is from the truth, as colours: blue too dark, orange too bright, full at ± 100 %.
function differenceColours(wrong, truth, count, stops) {
  const colours = padded(count);
  for (let i = 0; i < count; i++) {
    const right = luminance(truth, i), off = right > 0 ? clamp((luminance(wrong, i) - right) / right, -1, 1) : 0;
    const end = off < 0 ? stops[0] : stops[2], share = Math.abs(off);
    for (let c = 0; c < 3; c++) colours[3 * i + c] = (stops[1][c] + (end[c] - stops[1][c]) * share) / 255;
  }
  return colours;
}

// The exposure factor of a pane; the same rule as `Series.factor`.
function factorOf(pane) {
  const { meta } = scene, own = state.normalised && pane === "order" && state.left === "order" ? meta.own[state.k] : 1;
  return meta.common * 2 ** state.ev * own;
}
const scaleOf = (pane) => (state.normalised && pane === "order" && state.left === "order" ? scene.meta.ownScales[state.k] : scene.meta.scale);

// What the left pane shows. Values the same as before are the same array, so that nothing is sent to the card again.
let lastDifference = {};
function leftLight() {
  const { orders, sums } = painted(scene, state.paint);
  if (state.left === "wrong") {
    const wrong = scene.wrong[state.wrong], truth = sums[sums.length - 1];
    if (!state.difference) return { light: wrong };
    if (lastDifference.wrong !== wrong) lastDifference = { wrong, colours: differenceColours(wrong, truth, scene.meta.patches, data.diverging) };
    return { light: lastDifference.colours, tone: TONES.plain };
  }
  if (state.left === "sees") return state.picked < 0 ? {} : { light: sums[state.k], sees: state.picked };
  if (state.left === "beside") return { light: scenes[state.beside].sums[Math.min(state.k, scenes[state.beside].sums.length - 1)] };
  if (state.left === "colours") return { light: plates[state.colours], tone: TONES.plain };
  if (state.left === "figure") return {};
  return { light: orders[state.k] };
}

function panes() {
  const shown = state.show === "both" ? ["order", "sum"] : [state.show];
  const { width, height } = $("canvas"), each = Math.floor(width / shown.length);
  const tone = state.falseColour ? TONES.scale : state.tone === "reinhard" ? TONES.reinhard : state.markClipped ? TONES.marked : TONES.linear;
  return shown.map((pane, i) => {
    const one = { tone, ...(pane === "order" ? leftLight() : { light: painted(scene, state.paint).sums[state.k] }) };
    const smooth = state.smooth && one.light && one.tone !== TONES.plain;
    if (smooth) one.light = smoothOf(scene, one.light);
    return { pane, slot: pane, box: [i * each, 0, each, height], smooth, factor: factorOf(pane), scale: scaleOf(pane), ...one };
  });
}

// Heading (HTML) and note of a pane.
function titleOf(pane) {
  const { k } = state, own = state.titles[pane === "order" ? 0 : 1];
  const [heading, note] = pane === "order" ? leftTitle() : [`Σ<sub>j = 0…${k}</sub> T<sup>j</sup> L<sub>e</sub>`, exposureNote("sum")];
  return own && (pane === "sum" || !["wrong", "figure"].includes(state.left)) ? [escaped(own), ""] : [heading, note];
}
const escaped = (text) => text.replace(/[&<>]/g, (letter) => `&#${letter.charCodeAt(0)};`);

function leftTitle() {
  if (state.left === "wrong") return ["WRONG", state.difference ? "difference to the truth" : shortcuts[state.wrong].name];
  if (state.left === "sees") {
    return state.picked < 0 ? ["what a patch sees", "click a patch"] : [`what patch ${state.picked} sees`, `bounces 0…${state.k}`];
  }
  if (state.left === "colours" || state.left === "figure") return ["", ""];
  return [`T<sup>${state.k}</sup> L<sub>e</sub>`, exposureNote("order")];
}

function exposureNote(pane) {
  if (state.falseColour) return "luminance of radiosity B, W/m²";
  const { meta } = scene, bounce = pane === "order" && state.left === "order";
  if (bounce && !meta.power[state.k].some((p) => p > 0)) return "no light of this order";
  const parts = [];
  if (state.normalised && bounce) parts.push(`×${Number(meta.own[state.k].toPrecision(3))}, ${signed(Math.log2(meta.own[state.k]))}`);
  if (state.ev) parts.push(`exposure ${signed(state.ev)}`);
  return parts.join(" · ") || "common exposure";
}

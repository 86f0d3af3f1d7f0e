// Power per bounce and the scale of false colour, as SVG. Fingers and mouse on the picture.

const SVG = "http://www.w3.org/2000/svg";
const CURVES = [["#e4572e", "red"], ["#5fb346", "green"], ["#5b8def", "blue"]];
const BOX = { left: 46, right: 292, top: 10, bottom: 160 };

function element(parent, name, attributes, words) {
  const made = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  if (words !== undefined) made.textContent = words;
  parent.appendChild(made);
  return made;
}

const bounceX = (k, count) => BOX.left + ((k + 0.5) / count) * (BOX.right - BOX.left);
const bounceAt = (x, count) => Math.floor(((x - BOX.left) / (BOX.right - BOX.left)) * count);
const powerOfTen = (n) => (n === 0 ? "1" : "10" + String(n).replace(/./g, (d) => "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"["-0123456789".indexOf(d)]));

// Curves of each channel; of a picked patch, dashed, its own light in the same decades, at its own height.
function drawPower(svg, power, k, patch) {
  svg.replaceChildren();
  const all = power.flat().filter((p) => p > 0), count = power.length;
  const high = Math.ceil(Math.log10(Math.max(...all, 1e-300)) + 1e-9);
  const low = Math.max(Math.floor(Math.log10(Math.min(...all)) - 1e-9), high - 8);
  const y = (p) => BOX.bottom - ((Math.log10(p) - low) / (high - low)) * (BOX.bottom - BOX.top);
  for (let n = low; n <= high; n += Math.max(1, Math.floor((high - low + 3) / 4))) {
    element(svg, "line", { x1: BOX.left, x2: BOX.right, y1: y(10 ** n), y2: y(10 ** n), stroke: "#4a525d", "stroke-width": 0.5 });
    element(svg, "text", { x: BOX.left - 5, y: y(10 ** n) + 4, "text-anchor": "end" }, powerOfTen(n));
  }
  const step = Math.ceil(count / 11);
  for (let j = 0; j < count; j += step) element(svg, "text", { x: bounceX(j, count), y: 174, "text-anchor": "middle" }, j);
  element(svg, "text", { x: (BOX.left + BOX.right) / 2, y: 188, "text-anchor": "middle" }, "bounce k");
  element(svg, "line", { x1: bounceX(k, count), x2: bounceX(k, count), y1: BOX.top, y2: BOX.bottom, stroke: "#ff7043", "stroke-width": 2 });
  const curve = (values, style) => {
    const points = values.map((p, j) => [bounceX(j, count), p]).filter(([, p]) => p >= 10 ** low);
    element(svg, "polyline", { points: points.map(([x, p]) => `${x},${y(p)}`).join(" "), fill: "none", "stroke-width": 2, ...style });
    return points;
  };
  power[0].forEach((_, c) => {
    const colour = power[0].length === 3 ? CURVES[c][0] : "#e8eaed";
    for (const [x, p] of curve(power.map((order) => order[c]), { stroke: colour })) element(svg, "circle", { cx: x, cy: y(p), r: 2.6, fill: colour });
  });
  if (patch) {
    const top = Math.max(...patch), lift = (10 ** high * 0.5) / (top || 1);
    curve(patch.map((p) => p * lift), { stroke: "#e8eaed", "stroke-dasharray": "4 3", "stroke-width": 1.5 });
    element(svg, "text", { x: BOX.right, y: BOX.top + 8, "text-anchor": "end" }, "- - picked patch (shape)");
  }
  svg.setAttribute("aria-label", `power per bounce, logarithmic; bounce ${k}: ${power[k].map((p) => p.toPrecision(3)).join(", ")} W`);
}

function drawScale(svg, [low, high], colours) {
  svg.replaceChildren();
  for (let i = 0; i < 64; i++) {
    const place = (i / 63) * 16, stop = Math.min(Math.floor(place), 15), share = place - stop;
    const mix = colours[stop].map((v, c) => Math.round(v + (colours[stop + 1][c] - v) * share));
    element(svg, "rect", { x: 8 + i * 6, y: 0, width: 6, height: 14, fill: `rgb(${mix})`, "shape-rendering": "crispEdges" });
  }
  for (const f of [1, 2, 5, 10, 20, 50, 100]) {
    const share = Math.log(f) / Math.log(high / low);
    if (share <= 1.001) element(svg, "text", { x: 8 + 384 * share, y: 28, "text-anchor": share > 0.9 ? "end" : share < 0.1 ? "start" : "middle" }, String(Number((low * f).toPrecision(3))) + (share > 0.99 ? " W/m²" : ""));
  }
}

// One finger or the left button turns, two fingers pinch and move, a tap picks.
function listenToFingers(canvas, { turn, zoom, move, pick }) {
  const fingers = new Map();
  let moved = 0, together = 0;
  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    fingers.set(event.pointerId, [event.offsetX, event.offsetY]);
    together = Math.max(together, fingers.size);
    if (fingers.size === 1) moved = 0;
  });
  canvas.addEventListener("pointermove", (event) => {
    const before = fingers.get(event.pointerId);
    if (!before) return;
    const here = [event.offsetX, event.offsetY], dx = here[0] - before[0], dy = here[1] - before[1];
    moved += Math.abs(dx) + Math.abs(dy);
    if (fingers.size === 2) {
      const other = [...fingers].find(([id]) => id !== event.pointerId)[1];
      const apart = (p) => Math.hypot(p[0] - other[0], p[1] - other[1]) || 1;
      zoom(apart(before) / apart(here));
      move(dx / 2, dy / 2);
    } else if (event.shiftKey || event.buttons & 6) move(dx, dy);
    else if (moved > 4) turn(dx, dy);
    fingers.set(event.pointerId, here);
  });
  const lift = (event) => {
    if (!fingers.delete(event.pointerId) || fingers.size) return;
    if (event.type === "pointerup" && together === 1 && moved <= 4) pick(event.offsetX, event.offsetY);
    together = 0;
  };
  canvas.addEventListener("pointerup", lift);
  canvas.addEventListener("pointercancel", lift);
  canvas.addEventListener("contextmenu", (event) => event.preventDefault());
  canvas.addEventListener("wheel", (event) => { event.preventDefault(); zoom(Math.exp(clamp(event.deltaY, -200, 200) * 0.0015)); }, { passive: false });
}

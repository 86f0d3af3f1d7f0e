// WebGL2: the light of the patches is a texture for each pane, its colours another, in which every patch looks its own up.
//
// Where the processor does the drawing, the corners of the patches take the time. So a view that is shown again in other
// light is not drawn again: the number of the patch in each pixel is kept, and each pixel looks its colour up.

// Light of patches, or of corners, as colours; both lie in textures, `TEXTURE_WIDTH` of them in a row.
const OVER_ALL = `#version 300 es
void main() { gl_Position = vec4(vec2(gl_VertexID & 1, gl_VertexID >> 1) * 4.0 - 1.0, 0.0, 1.0); }`;
const TONE_MAP = `#version 300 es
precision highp float; precision highp int; precision highp sampler2D;
uniform sampler2D light;
uniform int tone;              // see TONES
uniform float factor;
uniform vec2 scale;            // logarithms of the ends of the false-colour scale
uniform vec3 scaleColours[17];
out vec4 pixel;
vec3 encode(vec3 x) {
  return mix(1.055 * pow(max(x, 0.0031308), vec3(1.0 / 2.4)) - 0.055, 12.92 * x, lessThanEqual(x, vec3(0.0031308)));
}
vec3 colourOf(vec3 x) {
  if (tone == 4) return x;
  if (tone == 3) {
    float place = (log(max(dot(x, vec3(0.2126, 0.7152, 0.0722)), 1e-30)) - scale.x) / (scale.y - scale.x) * 16.0;
    place = clamp(place, 0.0, 16.0);
    int stop = int(min(floor(place), 15.0));
    return mix(scaleColours[stop], scaleColours[stop + 1], place - float(stop));
  }
  x *= factor;
  if (tone == 2 && any(greaterThan(x, vec3(1.0)))) return vec3(1.0, 0.0, 1.0);
  return encode(tone == 0 ? x / (1.0 + x) : min(x, 1.0));
}
void main() { pixel = vec4(colourOf(texelFetch(light, ivec2(gl_FragCoord.xy), 0).rgb), 1.0); }`;
const MOST_LIGHT = 12e6; // numbers of light that are kept on the card: 48 MB, all of 100 000 patches × 20 orders and sums
const TONES = { reinhard: 0, linear: 1, marked: 2, scale: 3, plain: 4 };

// Patches in their colours, in their numbers, or all in one colour.
const VERTEX = `#version 300 es
precision highp float; precision highp int; precision highp sampler2D;
layout(location = 0) in vec3 position;
uniform mat4 camera;
uniform sampler2D colours;
uniform int kind;              // see KINDS
uniform vec3 only;
VARYING out vec3 colour;
void main() {
  gl_Position = camera * vec4(position, 1.0);
  int patch_ = gl_VertexID / 4, at = PLACE;
  if (kind == 0) colour = texelFetch(colours, ivec2(at % ${TEXTURE_WIDTH}, at / ${TEXTURE_WIDTH}), 0).rgb;
  else if (kind == 1) colour = vec3(patch_ & 255, (patch_ >> 8) & 255, (patch_ >> 16) & 255) / 255.0;
  else colour = only;
}`;
const FRAGMENT = `#version 300 es
precision highp float;
VARYING in vec3 colour;
out vec4 pixel;
void main() { pixel = vec4(colour, 1.0); }`;
const KINDS = { colours: 0, numbers: 1, only: 2 };
const [NOTHING, BLACK] = [[1, 1, 1], [0, 1, 1]]; // in place of a patch's number, 0xffffff and 0xffff00

// A view that is shown again in other light: the number of the patch in each pixel, and its depth, are kept.
const LOOK_UP = `#version 300 es
precision highp float; precision highp int; precision highp sampler2D;
uniform sampler2D colours, numbers, depths;
uniform ivec2 corner;
out vec4 pixel;
void main() {
  ivec2 here = ivec2(gl_FragCoord.xy) - corner;
  ivec3 bytes = ivec3(texelFetch(numbers, here, 0).rgb * 255.0 + 0.5);
  int patch_ = bytes.r | bytes.g << 8 | bytes.b << 16;
  gl_FragDepth = texelFetch(depths, here, 0).r;
  if (patch_ == 0xffffff) discard;
  pixel = patch_ == 0xffff00 ? vec4(0.0, 0.0, 0.0, 1.0) : texelFetch(colours, ivec2(patch_ % ${TEXTURE_WIDTH}, patch_ / ${TEXTURE_WIDTH}), 0);
}`;

const minus = (a, b) => a.map((x, i) => x - b[i]);
const plus = (a, b, times = 1) => a.map((x, i) => x + times * b[i]);
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const unit = (a) => a.map((x) => x / (Math.hypot(...a) || 1));

// Perspective × view, column by column. The angle is of the shorter side of a pane, so nothing is cut.
function cameraMatrix(camera, width, height, radius) {
  const forward = unit(minus(camera.target, camera.position));
  const right = unit(cross(forward, camera.up)), up = cross(right, forward);
  const distance = Math.hypot(...minus(camera.target, camera.position));
  const far = distance + 4 * radius, near = Math.max(distance - 4 * radius, 1e-3 * radius);
  const f = 1 / Math.tan((camera.fov * Math.PI) / 360), aspect = width / height;
  const sx = f / Math.max(1, aspect), sy = f * Math.min(1, aspect), a = (far + near) / (near - far), b = (2 * far * near) / (near - far);
  const rows = [[right, sx], [up, sy], [forward, -a]];
  const matrix = new Float32Array(16);
  rows.forEach(([axis, s], r) => {
    for (let c = 0; c < 3; c++) matrix[4 * c + r] = axis[c] * s;
    matrix[12 + r] = -dot(axis, camera.position) * s + (r === 2 ? b : 0);
  });
  for (let c = 0; c < 3; c++) matrix[4 * c + 3] = forward[c];
  matrix[15] = -dot(forward, camera.position);
  return matrix;
}

// The five faces of a hemicube on a patch, unfolded into a box: where each is drawn, what of it is cut out, and its
// camera. `up` is the direction in the patch's plane that points up in the picture.
function hemicubeFaces([left, bottom, width, height], eye, normal, up, radius) {
  const q = Math.max(1, Math.floor(Math.min(width, height) / 4)), right = cross(normal, up);
  const x = left + Math.floor(width / 2), y = bottom + Math.floor(height / 2), back = (a) => a.map((v) => -v);
  const face = (forward, upward, view, cut) => ({
    view: [x + view[0] * q, y + view[1] * q, 2 * q, 2 * q], cut: [x + cut[0] * q, y + cut[1] * q, cut[2] * q, cut[3] * q],
    camera: { position: eye, target: plus(eye, forward, radius), up: upward, fov: 90 },
  });
  return [
    face(normal, up, [-1, -1], [-1, -1, 2, 2]),
    face(right, up, [1, -1], [1, -1, 1, 2]),
    face(back(right), up, [-3, -1], [-2, -1, 1, 2]),
    face(up, back(normal), [-1, 1], [-1, 1, 2, 1]),
    face(back(up), normal, [-1, -3], [-1, -2, 2, 1]),
  ];
}

// Whether the processor does the drawing; smooth edges would then cost four times the time.
function drawnBySoftware() {
  const gl = document.createElement("canvas").getContext("webgl2");
  const info = gl && gl.getExtension("WEBGL_debug_renderer_info");
  const name = gl ? gl.getParameter(info ? info.UNMASKED_RENDERER_WEBGL : gl.RENDERER) : "";
  return /swiftshader|llvmpipe|software|basic render/i.test(name);
}

class Painter {
  constructor(canvas, falseColours) {
    const gl = (this.gl = canvas.getContext("webgl2", { antialias: !drawnBySoftware(), alpha: false }));
    if (!gl) throw new Error("no WebGL2");
    this.canvas = canvas;
    const variant = (varying, place) => this.link(...[VERTEX, FRAGMENT].map((text) => text.replace("VARYING", varying).replace("PLACE", place)));
    this.programs = [variant("flat", "patch_"), variant("", "gl_VertexID")];
    this.toneMap = this.link(OVER_ALL, TONE_MAP);
    gl.useProgram(this.toneMap.program);
    gl.uniform3fv(this.toneMap.place.scaleColours, falseColours.flat().map((x) => x / 255));
    this.lookUp = this.link(OVER_ALL, LOOK_UP);
    gl.useProgram(this.lookUp.program);
    gl.uniform1i(this.lookUp.place.numbers, 1);
    gl.uniform1i(this.lookUp.place.depths, 2);
    Object.assign(this, { slots: {}, lights: new Map(), kept: 0 });
    this.views = new Map(); // what was drawn last: the numbers of its patches, if it was drawn more than once
    this.smoothed = gl.getContextAttributes().antialias; // then a pixel at an edge is no single patch's
    [this.cornerBuffer, this.loopBuffer] = [gl.createBuffer(), gl.createBuffer()];
    gl.enableVertexAttribArray(0);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, gl.createBuffer());
    gl.enable(gl.DEPTH_TEST);
    gl.enable(gl.CULL_FACE);  // faces that look away are left out: walls do not hide the room
    gl.enable(gl.SCISSOR_TEST);
    gl.polygonOffset(1, 1);
  }

  link(...sources) {
    const gl = this.gl, program = gl.createProgram();
    sources.forEach((source, i) => {
      const shader = gl.createShader(i ? gl.FRAGMENT_SHADER : gl.VERTEX_SHADER);
      gl.shaderSource(shader, source);
      gl.compileShader(shader);
      gl.attachShader(program, shader);
    });
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program));
    const names = ["camera", "tone", "factor", "scale", "scaleColours", "kind", "only", "numbers", "depths", "corner"];
    return { program, place: Object.fromEntries(names.map((name) => [name, gl.getUniformLocation(program, name)])) };
  }

  // The patches that are drawn from now on.
  useScene(scene) {
    const gl = this.gl, N = scene.meta.patches, index = new Uint32Array(N * 6);
    for (let i = 0; i < N; i++) index.set([4 * i, 4 * i + 1, 4 * i + 2, 4 * i, 4 * i + 2, 4 * i + 3], 6 * i);
    this.useCorners(this.cornerBuffer, scene.corners);
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, index, gl.STATIC_DRAW);
    Object.assign(this, { corners: scene.corners, patches: N });
    this.forget(this.views, (this.views = new Map()));
  }

  useCorners(buffer, corners) {
    const gl = this.gl;
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    if (corners) gl.bufferData(gl.ARRAY_BUFFER, corners, gl.STATIC_DRAW);
    gl.vertexAttribPointer(0, 3, gl.FLOAT, false, 0, 0);
  }

  // Draws a line around a patch, a hair above it, three times so that it is two pixels wide.
  outline({ box }, camera, radius, patch) {
    const gl = this.gl, { program, place } = this.programs[0], normal = unit(crossOf(this.corners, patch));
    gl.useProgram(program);
    gl.uniform1i(place.kind, KINDS.only);
    gl.uniform3f(place.only, 1.0, 0.44, 0.26);
    this.useCorners(this.loopBuffer, new Float32Array([0, 1, 2, 3].flatMap((j) => plus([...cornerOf(this.corners, patch, j)], normal, 2e-3 * radius))));
    gl.scissor(...box);
    for (const [dx, dy] of [[0, 0], [1, 0], [0, 1]]) {
      gl.viewport(box[0] + dx, box[1] + dy, box[2], box[3]);
      gl.uniformMatrix4fv(place.camera, false, cameraMatrix(camera, box[2], box[3], radius));
      gl.drawArrays(gl.LINE_LOOP, 0, 4);
    }
    this.useCorners(this.cornerBuffer, null);
  }

  // Brings the colours of a slot up to date with the light of patches, or of corners, and binds them.
  bindColours({ slot, light, tone, factor, scale }) {
    const gl = this.gl, rows = light.length / (3 * TEXTURE_WIDTH), look = [tone, factor, ...scale].join();
    if (this.slots[slot]?.rows !== rows) this.makeSlot(slot, rows);
    const held = this.slots[slot];
    if (held.light !== light || held.look !== look) {
      const { program, place } = this.toneMap;
      gl.useProgram(program);
      gl.uniform1i(place.tone, tone);
      gl.uniform1f(place.factor, factor);
      gl.uniform2f(place.scale, Math.log(scale[0]), Math.log(scale[1]));
      this.bindLight(light, rows);
      gl.bindFramebuffer(gl.FRAMEBUFFER, held.frame);
      this.overAll([0, 0, TEXTURE_WIDTH, rows]);
      gl.bindFramebuffer(gl.FRAMEBUFFER, null);
      Object.assign(held, { light, look });
    }
    gl.bindTexture(gl.TEXTURE_2D, held.colours);
  }

  makeSlot(slot, rows) {
    const gl = this.gl, colours = this.makeTexture(gl.RGBA8, TEXTURE_WIDTH, rows);
    if (this.slots[slot]) this.free(this.slots[slot].frame, this.slots[slot].colours);
    this.slots[slot] = { rows, colours, frame: this.makeFrame(colours) };
  }

  // Binds the texture of some light, which stays on the card until there is much other light.
  bindLight(light, rows) {
    const gl = this.gl, known = this.lights.get(light), texture = known || this.makeTexture(gl.RGB32F, TEXTURE_WIDTH, rows);
    gl.bindTexture(gl.TEXTURE_2D, texture);
    if (known) return;
    gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, TEXTURE_WIDTH, rows, gl.RGB, gl.FLOAT, light);
    this.lights.set(light, texture);
    this.kept += light.length;
    for (const [old, unused] of this.lights) {
      if (this.kept <= MOST_LIGHT || old === light) break;
      this.free(null, unused);
      this.lights.delete(old);
      this.kept -= old.length;
    }
  }

  makeTexture(format, width, height) {
    const gl = this.gl, texture = gl.createTexture();
    gl.bindTexture(gl.TEXTURE_2D, texture);
    gl.texStorage2D(gl.TEXTURE_2D, 1, format, width, height);
    for (const filter of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, filter, gl.NEAREST);
    return texture;
  }

  // Runs the program in use for every pixel of a box.
  overAll(box) {
    const gl = this.gl;
    gl.viewport(...box);
    gl.scissor(...box);
    gl.depthFunc(gl.ALWAYS);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
    gl.depthFunc(gl.LESS);
  }

  clear([x, y, width, height], colour) {
    const gl = this.gl;
    gl.scissor(x, y, width, height);
    gl.clearColor(...colour, 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
  }

  triangles(camera, view, cut, radius, place) {
    const gl = this.gl;
    gl.viewport(...view);
    gl.scissor(...cut);
    gl.uniformMatrix4fv(place.camera, false, cameraMatrix(camera, view[2], view[3], radius));
    gl.drawElements(gl.TRIANGLES, this.patches * 6, gl.UNSIGNED_INT, 0);
  }

  // A pane is {slot, box: [left, bottom, width, height] in pixels, light, smooth, tone, factor, scale, sees}; `sees` is a
  // patch whose view is drawn instead of the camera's.
  drawPane(pane, camera, radius, kind = KINDS.colours) {
    const gl = this.gl, { program, place } = this.programs[pane.smooth ? 1 : 0];
    gl.useProgram(program);
    gl.uniform1i(place.kind, kind);
    if (pane.sees === undefined) return this.triangles(camera, pane.box, pane.box, radius, place);
    const faces = this.faces(pane, radius);
    for (const { camera: from, view, cut } of faces) this.triangles(from, view, cut, radius, place);
    // Black backs stop light; a hair behind, for where a front and a back coincide the front is seen.
    gl.uniform1i(place.kind, KINDS.only);
    gl.uniform3f(place.only, ...(kind === KINDS.numbers ? BLACK : [0, 0, 0]));
    gl.cullFace(gl.FRONT);
    gl.enable(gl.POLYGON_OFFSET_FILL);
    for (const { camera: from, view, cut } of faces) this.triangles(from, view, cut, radius, place);
    gl.disable(gl.POLYGON_OFFSET_FILL);
    gl.cullFace(gl.BACK);
    return undefined;
  }

  // Up in the picture is up in the room, or on a level patch to the back.
  faces({ box, sees }, radius) {
    const normal = unit(crossOf(this.corners, sees)), top = [0, 1, -0.1];
    const up = unit(plus(top, normal, -dot(top, normal)));
    return hemicubeFaces(box, plus(midOf(this.corners, sees), normal, 1e-4 * radius), normal, up, radius);
  }

  draw(panes, camera, radius) {
    const before = this.views, now = (this.views = new Map());
    this.clear([0, 0, this.canvas.width, this.canvas.height], BACKGROUND);
    for (const pane of panes) {
      if (!pane.light) continue;
      this.bindColours(pane);
      const key = this.keyOf(pane, camera, radius), again = before.has(key) && !pane.smooth && !this.smoothed;
      if (!now.has(key)) now.set(key, before.get(key));
      if (again) this.lookUpPane(pane, now.get(key) || this.numbersOf(pane, camera, radius));
      else this.drawPane(pane, camera, radius);
    }
    this.forget(before, now);
  }

  // What a pane shows of the scene, whatever the light.
  keyOf({ box, sees }, camera, radius) {
    return [box[2], box[3], sees ?? cameraMatrix(camera, box[2], box[3], radius).join()].join();
  }

  lookUpPane(pane, { numbers, depths }) {
    const gl = this.gl, { program, place } = this.lookUp;
    gl.useProgram(program);
    gl.uniform2i(place.corner, pane.box[0], pane.box[1]);
    for (const [unit, texture] of [[gl.TEXTURE1, numbers], [gl.TEXTURE2, depths], [gl.TEXTURE0, this.slots[pane.slot].colours]]) {
      gl.activeTexture(unit);
      gl.bindTexture(gl.TEXTURE_2D, texture);
    }
    this.overAll(pane.box);
  }

  // The numbers of the patches that a pane shows, and their depths, as textures of its size. Drawn once for each view.
  numbersOf(pane, camera, radius) {
    const gl = this.gl, key = this.keyOf(pane, camera, radius), [, , width, height] = pane.box;
    if (this.views.get(key)) return this.views.get(key);
    const view = this.makeView(width, height), box = [0, 0, width, height];
    this.clear(box, NOTHING);
    this.drawPane({ ...pane, box, smooth: false }, camera, radius, KINDS.numbers);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    this.views.set(key, view);
    return view;
  }

  // Which patch each pixel of a rectangle in a pane shows (from the lower left, by rows); -1 for none.
  patchesAt(pane, camera, radius, [x, y, columns, rows]) {
    const gl = this.gl, view = this.numbersOf(pane, camera, radius), pixels = new Uint8Array(4 * columns * rows);
    gl.bindFramebuffer(gl.FRAMEBUFFER, view.frame);
    gl.readPixels(x - pane.box[0], y - pane.box[1], columns, rows, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    return Int32Array.from({ length: columns * rows }, (_, i) => {
      const patch = pixels[4 * i] + 256 * pixels[4 * i + 1] + 65536 * pixels[4 * i + 2];
      return patch < this.patches ? patch : -1;
    });
  }

  makeView(width, height) {
    const gl = this.gl, numbers = this.makeTexture(gl.RGBA8, width, height), depths = this.makeTexture(gl.DEPTH_COMPONENT24, width, height);
    const view = { numbers, depths, frame: this.makeFrame(numbers) };
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.DEPTH_ATTACHMENT, gl.TEXTURE_2D, depths, 0);
    gl.bindTexture(gl.TEXTURE_2D, null); // what is drawn into is not read from
    return view;
  }

  // A place to draw into, which is bound.
  makeFrame(texture) {
    const gl = this.gl, frame = gl.createFramebuffer();
    gl.bindFramebuffer(gl.FRAMEBUFFER, frame);
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, texture, 0);
    return frame;
  }

  free(frame, ...textures) {
    this.gl.deleteFramebuffer(frame);
    for (const texture of textures) this.gl.deleteTexture(texture);
  }

  // Lets go of the numbers of views that are not among those to be kept.
  forget(views, kept) {
    for (const [key, view] of views) if (view && !kept.has(key)) this.free(view.frame, view.numbers, view.depths);
  }
}
const BACKGROUND = [0x26 / 255, 0x2b / 255, 0x33 / 255];

// WebGL2: every patch looks its light up in a texture, so that a step from bounce to bounce changes one number.

const TEXTURE_WIDTH = 1024;
const VERTEX = `#version 300 es
precision highp float; precision highp int; precision highp sampler2DArray;
layout(location = 0) in vec3 position;
uniform mat4 camera;
uniform sampler2DArray light;
uniform int layer, tone;       // tone: 0 Reinhard, 1 linear, 2 linear with marks, 3 false colour, 4 patch numbers
uniform float factor;
uniform vec2 scale;            // logarithms of the ends of the false-colour scale
uniform vec3 scaleColours[17];
flat out vec3 colour;
vec3 encode(vec3 x) {
  return mix(1.055 * pow(max(x, 0.0031308), vec3(1.0 / 2.4)) - 0.055, 12.92 * x, lessThanEqual(x, vec3(0.0031308)));
}
void main() {
  gl_Position = camera * vec4(position, 1.0);
  int patch_ = gl_VertexID / 4;
  vec3 x = texelFetch(light, ivec3(patch_ % ${TEXTURE_WIDTH}, patch_ / ${TEXTURE_WIDTH}, layer), 0).rgb;
  if (tone == 4) { colour = vec3(patch_ & 255, (patch_ >> 8) & 255, (patch_ >> 16) & 255) / 255.0; return; }
  if (tone == 3) {
    float place = (log(max(dot(x, vec3(0.2126, 0.7152, 0.0722)), 1e-30)) - scale.x) / (scale.y - scale.x) * 16.0;
    place = clamp(place, 0.0, 16.0);
    int stop = int(min(floor(place), 15.0));
    colour = mix(scaleColours[stop], scaleColours[stop + 1], place - float(stop));
    return;
  }
  x *= factor;
  bool over = any(greaterThan(x, vec3(1.0)));
  colour = encode(tone == 0 ? x / (1.0 + x) : min(x, 1.0));
  if (tone == 2 && over) colour = vec3(1.0, 0.0, 1.0);
}`;
const FRAGMENT = `#version 300 es
precision highp float;
flat in vec3 colour;
out vec4 pixel;
void main() { pixel = vec4(colour, 1.0); }`;

const minus = (a, b) => a.map((x, i) => x - b[i]);
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

// Whether the processor does the drawing; smooth edges would then cost four times the time.
function drawnBySoftware() {
  const gl = document.createElement("canvas").getContext("webgl2");
  const info = gl && gl.getExtension("WEBGL_debug_renderer_info");
  const name = gl ? gl.getParameter(info ? info.UNMASKED_RENDERER_WEBGL : gl.RENDERER) : "";
  return /swiftshader|llvmpipe|software|basic render/i.test(name);
}

class Painter {
  constructor(canvas, scene, meta) {
    const gl = (this.gl = canvas.getContext("webgl2", { antialias: !drawnBySoftware(), alpha: false }));
    if (!gl) throw new Error("no WebGL2");
    Object.assign(this, { canvas, meta, layers: scene.orders.length });
    this.program = this.link(VERTEX, FRAGMENT);
    gl.useProgram(this.program);
    this.place = Object.fromEntries(["camera", "layer", "tone", "factor", "scale", "scaleColours"]
      .map((name) => [name, gl.getUniformLocation(this.program, name)]));
    gl.uniform3fv(this.place.scaleColours, meta.falseColours.flat().map((x) => x / 255));
    gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ARRAY_BUFFER, scene.corners, gl.STATIC_DRAW);
    gl.enableVertexAttribArray(0);
    gl.vertexAttribPointer(0, 3, gl.FLOAT, false, 0, 0);
    const index = new Uint32Array(meta.patches * 6);
    for (let i = 0; i < meta.patches; i++) index.set([4 * i, 4 * i + 1, 4 * i + 2, 4 * i, 4 * i + 2, 4 * i + 3], 6 * i);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, index, gl.STATIC_DRAW);
    this.upload([...scene.orders, ...scene.sums]);
    gl.enable(gl.DEPTH_TEST);
    gl.enable(gl.CULL_FACE);  // faces that look away are left out: walls do not hide the room
    gl.enable(gl.SCISSOR_TEST);
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
    return program;
  }

  upload(layers) {
    const gl = this.gl, N = this.meta.patches, height = Math.ceil(N / TEXTURE_WIDTH);
    gl.bindTexture(gl.TEXTURE_2D_ARRAY, gl.createTexture());
    for (const filter of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D_ARRAY, filter, gl.NEAREST);
    gl.texStorage3D(gl.TEXTURE_2D_ARRAY, 1, gl.RGBA32F, TEXTURE_WIDTH, height, layers.length);
    const texels = new Float32Array(TEXTURE_WIDTH * height * 4);
    layers.forEach((light, layer) => {
      for (let i = 0; i < N; i++) for (let c = 0; c < 3; c++) texels[4 * i + c] = light[3 * i + c];
      gl.texSubImage3D(gl.TEXTURE_2D_ARRAY, 0, 0, 0, layer, TEXTURE_WIDTH, height, 1, gl.RGBA, gl.FLOAT, texels);
    });
  }

  // Panes are {box: [left, bottom, width, height] in pixels, layer, tone, factor, scale}.
  draw(panes, camera, radius) {
    const gl = this.gl, { place } = this;
    gl.scissor(0, 0, this.canvas.width, this.canvas.height);
    gl.clearColor(0x26 / 255, 0x2b / 255, 0x33 / 255, 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    for (const { box, layer, tone, factor, scale } of panes) {
      gl.viewport(...box);
      gl.scissor(...box);
      gl.uniformMatrix4fv(place.camera, false, cameraMatrix(camera, box[2], box[3], radius));
      gl.uniform1i(place.layer, layer);
      gl.uniform1i(place.tone, tone);
      gl.uniform1f(place.factor, factor);
      gl.uniform2f(place.scale, Math.log(scale[0]), Math.log(scale[1]));
      gl.drawElements(gl.TRIANGLES, this.meta.patches * 6, gl.UNSIGNED_INT, 0);
    }
  }

  // Which patch each pixel of a rectangle in a pane shows (from the lower left, by rows); -1 for none. Drawn apart, in
  // patch numbers.
  patchesAt(pane, camera, radius, [x, y, columns, rows]) {
    const gl = this.gl, { width, height } = this.canvas;
    if (!this.target || this.target.width !== width || this.target.height !== height) this.makeTarget(width, height);
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.target.frame);
    gl.viewport(...pane.box);
    gl.scissor(x, y, columns, rows);
    gl.clearColor(1, 1, 1, 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.uniformMatrix4fv(this.place.camera, false, cameraMatrix(camera, pane.box[2], pane.box[3], radius));
    gl.uniform1i(this.place.tone, 4);
    gl.drawElements(gl.TRIANGLES, this.meta.patches * 6, gl.UNSIGNED_INT, 0);
    const pixels = new Uint8Array(4 * columns * rows);
    gl.readPixels(x, y, columns, rows, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    return Int32Array.from({ length: columns * rows }, (_, i) => {
      const patch = pixels[4 * i] + 256 * pixels[4 * i + 1] + 65536 * pixels[4 * i + 2];
      return patch < this.meta.patches ? patch : -1;
    });
  }

  makeTarget(width, height) {
    const gl = this.gl, frame = gl.createFramebuffer();
    gl.bindFramebuffer(gl.FRAMEBUFFER, frame);
    for (const [format, attachment] of [[gl.RGBA8, gl.COLOR_ATTACHMENT0], [gl.DEPTH_COMPONENT24, gl.DEPTH_ATTACHMENT]]) {
      const store = gl.createRenderbuffer();
      gl.bindRenderbuffer(gl.RENDERBUFFER, store);
      gl.renderbufferStorage(gl.RENDERBUFFER, format, width, height);
      gl.framebufferRenderbuffer(gl.FRAMEBUFFER, attachment, gl.RENDERBUFFER, store);
    }
    this.target = { frame, width, height };
  }
}

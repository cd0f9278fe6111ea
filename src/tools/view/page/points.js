// Draws points with WebGL 2.

const VERTEX_SHADER = `#version 300 es
uniform mat4 clip_from_world;
uniform float point_scale, max_size, low, high;
uniform bool is_log, in_picture_colors, is_marking, is_probe;
uniform float ring_size;
uniform sampler2D ramp;
in vec3 position, rgb;
in float value, footprint, marked;
out vec4 color;
out float is_ring;

void main() {
  gl_Position = clip_from_world * vec4(position, 1.0);
  gl_PointSize = clamp(point_scale * footprint / gl_Position.w, 1.5, max_size);
  float at = is_log ? log(value / low) / log(high / low) : (value - low) / (high - low);
  bool is_on_axis = is_log ? value > 0.0 : value == value;
  vec3 of_value = is_on_axis ? texture(ramp, vec2((clamp(at, 0.0, 1.0) * 255.0 + 0.5) / 256.0, 0.5)).rgb : vec3(0.5);
  color = vec4(in_picture_colors ? rgb : of_value, 1.0);
  if (is_marking && marked < 0.5) color = vec4(mix(vec3(dot(color.rgb, vec3(0.2, 0.7, 0.1))), vec3(0.5), 0.75), 1.0);
  is_ring = 0.0;
  if (ring_size > 0.0) {
    gl_PointSize = ring_size;
    is_ring = 1.0;
    color = vec4(0.3726, 0.8903, 1.0, 1.0);
    if (marked < 0.5) gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
  }
  if (is_probe) {
    gl_PointSize = 15.0;
    is_ring = 1.0;
    color = vec4(1.0);
  }
}`;

const FRAGMENT_SHADER = `#version 300 es
precision mediump float;
in vec4 color;
in float is_ring;
out vec4 shown;

void main() {
  float radius = 2.0 * length(gl_PointCoord - 0.5);
  if (radius > 1.0) discard;
  if (is_ring > 0.5) {
    if (radius < 0.45) discard;
    shown = radius < 0.62 || radius > 0.86 ? vec4(0.0, 0.0, 0.0, 1.0) : color;
  } else {
    shown = color;
  }
}`;

/** Creates points from arrays of positions, footprints and colors. */
function createPoints(gl, { position, footprint, rgb }) {
  const program = link(gl);
  gl.useProgram(program);
  const at = (name) => gl.getUniformLocation(program, name);
  const buffers = new Map();
  const set = (name, n, values) => {
    const attribute = gl.getAttribLocation(program, name);
    if (!buffers.has(name)) buffers.set(name, gl.createBuffer());
    gl.bindBuffer(gl.ARRAY_BUFFER, buffers.get(name));
    gl.bufferData(gl.ARRAY_BUFFER, values, gl.STATIC_DRAW);
    gl.enableVertexAttribArray(attribute);
    const isByte = values instanceof Uint8Array;
    gl.vertexAttribPointer(attribute, n, isByte ? gl.UNSIGNED_BYTE : gl.FLOAT, isByte, 0, 0);
  };
  set("position", 3, position);
  set("footprint", 1, footprint);
  set("rgb", 3, rgb);
  set("marked", 1, new Uint8Array(footprint.length));
  gl.bindTexture(gl.TEXTURE_2D, gl.createTexture());
  for (const name of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, name, gl.NEAREST);
  for (const name of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T]) gl.texParameteri(gl.TEXTURE_2D, name, gl.CLAMP_TO_EDGE);
  let n_marked = 0;
  const [, largest] = gl.getParameter(gl.ALIASED_POINT_SIZE_RANGE);

  return {
    /** Sets the values, one Float32 per point. */
    setValues: (values) => set("value", 1, values),
    /** Sets the marks, one byte per point, 0 for unmarked; null unmarks all. */
    setMarks(marks) {
      gl.uniform1i(at("is_marking"), marks ? 1 : 0);
      n_marked = marks ? marks.reduce((n, mark) => n + (mark ? 1 : 0), 0) : 0;
      if (marks) set("marked", 1, marks);
    },
    /** Sets the mapping from values to colors. */
    setScale(scale, table) {
      gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGB8, 256, 1, 0, gl.RGB, gl.UNSIGNED_BYTE, table);
      gl.uniform1f(at("low"), scale.low);
      gl.uniform1f(at("high"), scale.high);
      gl.uniform1i(at("is_log"), scale.log ? 1 : 0);
    },
    /** Selects the colors: those of the picture, or those of the values. */
    setPictureColors: (are) => gl.uniform1i(at("in_picture_colors"), are ? 1 : 0),
    /** Draws all points, and a ring around the point with index `ringed` (-1 for none);
     * `point_scale` is the size in pixels of a footprint of 1. */
    draw(matrix, point_scale, background, ringed) {
      gl.viewport(0, 0, gl.drawingBufferWidth, gl.drawingBufferHeight);
      gl.clearColor(...background, 1);
      gl.enable(gl.DEPTH_TEST);
      gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
      gl.uniformMatrix4fv(at("clip_from_world"), false, matrix);
      gl.uniform1f(at("point_scale"), point_scale);
      gl.uniform1f(at("max_size"), Math.min(largest, 64 * devicePixelRatio));
      gl.uniform1i(at("is_probe"), 0);
      gl.uniform1f(at("ring_size"), 0);
      gl.drawArrays(gl.POINTS, 0, footprint.length);
      gl.disable(gl.DEPTH_TEST);
      // A few marked points have rings, which other points do not hide.
      if (n_marked > 0 && n_marked <= MAX_OUTLINES) {
        gl.uniform1f(at("ring_size"), 13 * devicePixelRatio);
        gl.drawArrays(gl.POINTS, 0, footprint.length);
        gl.uniform1f(at("ring_size"), 0);
      }
      if (ringed < 0) return;
      gl.uniform1i(at("is_probe"), 1);
      gl.drawArrays(gl.POINTS, ringed, 1);
    },
  };
}

function link(gl) {
  const program = gl.createProgram();
  for (const [type, source] of [[gl.VERTEX_SHADER, VERTEX_SHADER], [gl.FRAGMENT_SHADER, FRAGMENT_SHADER]]) {
    const shader = gl.createShader(type);
    gl.shaderSource(shader, source);
    gl.compileShader(shader);
    gl.attachShader(program, shader);
  }
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(`WebGL: ${gl.getProgramInfoLog(program)}`);
  return program;
}

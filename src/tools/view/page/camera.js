// A camera that orbits the hit points, and its controls.

const add = (a, b) => a.map((x, i) => x + b[i]);
const scaled = (a, factor) => a.map((x) => x * factor);
const minus = (a, b) => add(a, scaled(b, -1));
const dot = (a, b) => a.reduce((sum, x, i) => sum + x * b[i], 0);
const cross = ([a, b, c], [x, y, z]) => [b * z - c * y, c * x - a * z, a * y - b * x];
const normalized = (a) => scaled(a, 1 / Math.hypot(...a));

/** Rotates a vector around a unit axis by an angle in radians (Rodrigues). */
function rotated(a, axis, angle) {
  const [c, s] = [Math.cos(angle), Math.sin(angle)];
  return add(add(scaled(a, c), scaled(cross(axis, a), s)), scaled(axis, dot(axis, a) * (1 - c)));
}

/** The start: the rendering's camera, with its target at the median depth of the points.
 * It keeps the picture's handedness: left-handed if the scene's camera is. */
function startCamera(positions) {
  const { low, high } = bounds(positions);
  const middle = scaled(add(low, high), 0.5);
  const radius = Math.max(1e-12, Math.hypot(...minus(high, low)) / 2);
  const plane = about.camera;
  if (!plane) {
    const axes = { right: [1, 0, 0], up: [0, 1, 0], back: [0, 0, 1] };
    const distance = 3 * radius;
    return { ...axes, target: middle, distance, start_distance: distance, half: [0.36, 0.36], parallel: false, radius, middle };
  }
  const [w, h] = about.full_size;
  const at = (x, y) => add(plane.origin, add(scaled(plane.right, x), scaled(plane.down, y)));
  const center = at((w - 1) / 2, (h - 1) / 2);
  const parallel = !plane.eye;
  const forward = normalized(parallel ? plane.direction : minus(center, plane.eye));
  const right = normalized(minus(plane.right, scaled(forward, dot(plane.right, forward))));
  const upward = cross(right, forward);
  const up = dot(upward, plane.down) > 0 ? scaled(upward, -1) : upward;
  const eye = parallel ? center : plane.eye;
  // A panorama is shown with 90 degrees from top to bottom.
  const half = plane.panorama ? [2, 1] : [right, up].map((axis) =>
    Math.max(...[[-0.5, -0.5], [w - 0.5, -0.5], [-0.5, h - 0.5], [w - 0.5, h - 0.5]].map(([x, y]) => {
      const corner = minus(at(x, y), eye);
      return Math.abs(dot(corner, axis)) / (parallel ? 1 : dot(corner, forward));
    })));
  const distance = medianDepth(positions, eye, forward);
  const [back, target] = [scaled(forward, -1), add(eye, scaled(forward, distance))];
  return { right, up, back, target, distance, start_distance: distance, half, parallel, radius, middle };
}

/** The bounding box of points. */
function bounds(positions) {
  const [low, high] = [[Infinity, Infinity, Infinity], [-Infinity, -Infinity, -Infinity]];
  for (let i = 0; i < positions.length; i++) {
    low[i % 3] = Math.min(low[i % 3], positions[i]);
    high[i % 3] = Math.max(high[i % 3], positions[i]);
  }
  return { low, high };
}

/** The median distance of points from the eye along `forward`; greater than 0. */
function medianDepth(positions, eye, forward) {
  const depths = new Float32Array(positions.length / 3);
  const [[x, y, z], start] = [forward, dot(forward, eye)];
  for (let i = 0; i < depths.length; i++) {
    depths[i] = x * positions[3 * i] + y * positions[3 * i + 1] + z * positions[3 * i + 2] - start;
  }
  return Math.max(1e-12, depths.sort()[depths.length >> 1]);
}

/** The matrix from world to clip space, column-major for WebGL, and `y`, the height in
 * clip space of one world unit (of a perspective camera at depth 1). */
function clipFromWorld(camera, aspect) {
  const { right, up, back, target, distance, start_distance, half, parallel, radius, middle } = camera;
  const eye = add(target, scaled(back, distance));
  const [x_row, y_row, depth_row] = [right, up, scaled(back, -1)].map((axis) => [...axis, -dot(axis, eye)]);
  const half_height = 1.04 * Math.max(half[1], half[0] / aspect) * (parallel ? distance / start_distance : 1);
  const [x, y] = [1 / (half_height * aspect), 1 / half_height];
  const far = Math.hypot(...minus(middle, eye)) + 1.1 * radius;
  // Independent of the cloud's size: a floor may reach to the horizon.
  const near = parallel ? -far : Math.min(distance / 1000, far / 2);
  const [stretch, shift] = parallel ? [2, far + near] : [far + near, 2 * far * near];
  const z_row = scaled(add(scaled(depth_row, stretch), [0, 0, 0, -shift]), 1 / (far - near));
  const clip = [scaled(x_row, x), scaled(y_row, y), z_row, parallel ? [0, 0, 0, 1] : depth_row];
  return { matrix: new Float32Array([0, 1, 2, 3].flatMap((column) => clip.map((row) => row[column]))), y };
}

/** Rotates the camera around its target; `dx` and `dy` are fractions of the view's
 * height, and a full height is 180 degrees. */
function orbited(camera, start_up, dx, dy) {
  // The pole is the world axis nearest to the picture's up vector.
  const sizes = start_up.map(Math.abs);
  const nearest = sizes.indexOf(Math.max(...sizes));
  const pole = start_up.map((x, i) => (i === nearest ? Math.sign(x) : 0));
  const handedness = Math.sign(dot(cross(camera.up, camera.back), camera.right));
  const around = (axes, by, angle) => axes.map((a) => normalized(rotated(a, by, angle)));
  let axes = around([camera.right, camera.up, camera.back], pole, -handedness * dx * Math.PI);
  const tilted = around(axes, axes[0], -handedness * dy * Math.PI);
  // Do not tilt over the pole.
  if (dot(tilted[1], pole) > 0.02) axes = tilted;
  const [right, up, back] = axes;
  return { ...camera, right, up, back };
}

/** Maps pointer, wheel and keys to calls of `orbit`, `pan`, `zoom` and `home`. */
function listen(canvas, { orbit, pan, zoom, home }) {
  const pointers = new Map();
  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    pointers.set(event.pointerId, event);
  });
  canvas.addEventListener("pointermove", (event) => {
    const before = pointers.get(event.pointerId);
    if (!before) return;
    const share = (now, then) => (now - then) / canvas.clientHeight;
    const [dx, dy] = [share(event.clientX, before.clientX), share(event.clientY, before.clientY)];
    if (pointers.size === 2) {
      const [other] = [...pointers.values()].filter((pointer) => pointer.pointerId !== event.pointerId);
      const span = (a) => Math.hypot(a.clientX - other.clientX, a.clientY - other.clientY);
      zoom(span(before) / Math.max(1, span(event)));
      pan(dx / 2, dy / 2);
    } else if (event.shiftKey || event.buttons & 6) pan(dx, dy);
    else orbit(dx, dy);
    pointers.set(event.pointerId, event);
  });
  for (const end of ["pointerup", "pointercancel"]) canvas.addEventListener(end, (event) => pointers.delete(event.pointerId));
  canvas.addEventListener("contextmenu", (event) => event.preventDefault());
  // A wheel scrolls the page until the canvas has the focus.
  canvas.addEventListener("wheel", (event) => {
    if (!event.ctrlKey && document.activeElement !== canvas) return;
    event.preventDefault();
    zoom(2 ** (event.deltaY / 300));
  }, { passive: false });
  canvas.addEventListener("keydown", (event) => {
    const steps = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (event.key in steps) {
      const [dx, dy] = scaled(steps[event.key], 0.03);
      event.shiftKey ? pan(dx, dy) : orbit(dx, dy);
    } else if (event.key === "+" || event.key === "=") zoom(1 / 1.2);
    else if (event.key === "-") zoom(1.2);
    else if (event.key === "0" || event.key === "Home") home();
    else return;
    event.preventDefault();
  });
}

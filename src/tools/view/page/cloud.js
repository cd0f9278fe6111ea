// The panel of the hit points.

/** Creates the panel; explains in it why if there is nothing to draw. */
async function createCloud(section) {
  const canvas = section.querySelector("canvas");
  const unavailable = (why) => {
    const placeholder = section.querySelector(".placeholder");
    Object.assign(placeholder, { textContent: why, hidden: false });
    for (const unused of section.querySelectorAll("canvas, label, .hint")) unused.hidden = true;
    return { update() {}, mark() {}, probe() {} };
  };
  if (about.cloud.n === 0) return unavailable("There are no hit points: every ray of the camera missed.");
  const gl = canvas.getContext("webgl2", { antialias: true, preserveDrawingBuffer: true });
  if (!gl) return unavailable("This browser has no WebGL 2, which draws the hit points.");

  const position = await numbers("cloud-positions", "f32");
  const pixels = await numbers("cloud-pixels", "u32");
  const ofPoints = (values, Type, n = 1) => {
    const picked = new Type(n * pixels.length);
    for (let i = 0; i < picked.length; i++) picked[i] = values[n * pixels[Math.floor(i / n)] + (i % n)];
    return picked;
  };
  const footprint = ofPoints(await frameArray("footprint"), Float32Array);
  const rgb = ofPoints(await frameArray("RGB"), Uint8Array, 3);
  const points = createPoints(gl, { position, footprint, rgb });
  const start = startCamera(position);
  let camera = start;
  let ringed = -1;
  let shown = null;

  const draw = oncePerFrame(() => {
    const [width, height] = [canvas.clientWidth, canvas.clientHeight].map((n) => Math.round(n * devicePixelRatio));
    if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
    const { matrix, y } = clipFromWorld(camera, width / height);
    // A point is as wide as the pixels that it represents, and half more to close gaps.
    const pixels_per_point_side = Math.sqrt(about.cloud.n_all / about.cloud.n);
    const well = getComputedStyle(document.body).getPropertyValue("--well").trim();
    const background = [1, 3, 5].map((i) => parseInt(well.slice(i, i + 2), 16) / 255);
    points.draw(matrix, 1.5 * pixels_per_point_side * y * 0.5 * height, background, ringed);
  });
  const look = (moved) => {
    camera = { ...camera, ...moved };
    draw();
  };
  listen(canvas, {
    orbit: (dx, dy) => look(orbited(camera, start.up, dx, dy)),
    pan(dx, dy) {
      const view_height = 2 * camera.half[1] * (camera.parallel ? camera.distance / start.distance : camera.distance);
      const shift = add(scaled(camera.right, -dx * view_height), scaled(camera.up, dy * view_height));
      look({ target: add(camera.target, shift) });
    },
    zoom(factor) {
      const distance = camera.distance * factor;
      look({ distance: Math.max(start.distance / 1e4, Math.min(start.distance * 100, distance)) });
    },
    home: () => look(start),
  });
  section.querySelector("input").addEventListener("change", (event) => {
    points.setPictureColors(event.target.checked);
    draw();
  });
  new ResizeObserver(draw).observe(canvas);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", draw);

  return {
    /** Colors the points by a field. */
    update({ field, scale, table }) {
      if (shown !== field) points.setValues(ofPoints(field.values, Float32Array));
      shown = field;
      points.setScale(scale, table);
      draw();
    },
    /** Fades all points except those of marked pixels; null unmarks all. */
    mark(isMarked) {
      points.setMarks(isMarked && Uint8Array.from(pixels, (pixel) => (isMarked(pixel) ? 255 : 0)));
      draw();
    },
    /** Draws a ring around the point of a pixel, if it has one. */
    probe(pixel) {
      ringed = find(pixels, pixel);
      draw();
    },
  };
}

/** The index of a number in a sorted array, by binary search; -1 if it is not there. */
function find(sorted, wanted) {
  let [from, to] = [0, sorted.length];
  while (from < to) {
    const middle = (from + to) >> 1;
    if (sorted[middle] < wanted) from = middle + 1;
    else to = middle;
  }
  return sorted[from] === wanted ? from : -1;
}

// Outlines of marked pixels, since a single pixel is too small to see.

/** Most marked pixels that are outlined. */
const MAX_MARKED = 20_000;
/** Most outlines; more marked regions are visible without them. */
const MAX_OUTLINES = 200;
/** Padding of an outline, in pixels of the screen. */
const OUTLINE_PADDING = 3;
/** Least side of an outline, in pixels of the screen. */
const MIN_OUTLINE_SIDE = 11;

/** The bounding boxes [left, top, right, bottom] of the connected regions (8 neighbors)
 * of pixels with these ascending indices. */
function boxesAround(indices) {
  const remaining = new Set(indices);
  const boxes = [];
  for (const first of indices) {
    if (!remaining.delete(first)) continue;
    const box = [WIDTH, HEIGHT, -1, -1];
    const stack = [first];
    while (stack.length) {
      const at = stack.pop();
      const [x, y] = [at % WIDTH, Math.floor(at / WIDTH)];
      box[0] = Math.min(box[0], x);
      box[1] = Math.min(box[1], y);
      box[2] = Math.max(box[2], x);
      box[3] = Math.max(box[3], y);
      for (const dy of [-1, 0, 1]) {
        for (const dx of [-1, 0, 1]) {
          const next = at + dy * WIDTH + dx;
          if (x + dx >= 0 && x + dx < WIDTH && remaining.delete(next)) stack.push(next);
        }
      }
    }
    boxes.push(box);
  }
  return boxes;
}

/** Creates a layer over a pane that outlines marked pixels. */
function createMarks(box) {
  const canvas = element("canvas", { class: "marks", "aria-hidden": "true" });
  let boxes = [];

  function draw() {
    const [width, height] = [box.clientWidth, box.clientHeight];
    const size = [width, height].map((n) => Math.round(n * devicePixelRatio));
    [canvas.width, canvas.height] = boxes.length ? size : [1, 1];
    if (!boxes.length) return;
    const context = canvas.getContext("2d");
    context.scale(devicePixelRatio, devicePixelRatio);
    const { zoom, x: from_x, y: from_y } = zoomed;
    const outlines = new Path2D();
    for (const [left, top, right, bottom] of boxes) {
      const [x0, x1] = [left, right + 1].map((x) => (x / WIDTH - from_x) * zoom * width);
      const [y0, y1] = [top, bottom + 1].map((y) => (y / HEIGHT - from_y) * zoom * height);
      const [w, h] = [x1 - x0, y1 - y0].map((side) => Math.max(MIN_OUTLINE_SIDE, side + 2 * OUTLINE_PADDING));
      outlines.rect((x0 + x1 - w) / 2, (y0 + y1 - h) / 2, w, h);
    }
    // A light line on a dark one is visible on any color.
    for (const [style, line] of [["#000000", 4], ["#5fe3ff", 2]]) {
      Object.assign(context, { strokeStyle: style, lineWidth: line });
      context.stroke(outlines);
    }
  }

  return {
    canvas,
    /** Outlines the pixels with these ascending indices; null removes the outlines. */
    set(indices) {
      const some = indices && indices.length <= MAX_MARKED ? boxesAround(indices) : [];
      boxes = some.length <= MAX_OUTLINES ? some : [];
      draw();
    },
    draw,
  };
}

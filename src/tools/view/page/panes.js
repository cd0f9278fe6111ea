// The picture and the map, side by side, with a common probe and a common zoom.

/** Most pixels of the screen that the pointer moves during a click. */
const CLICK_TOLERANCE = 4;

/** Creates a canvas of the picture's pixels. Calls `onProbe(x, y, how)` when a "pointer",
 * "click" or "key" moves the probe, `onPin()` to pin or release it, and `onZoom()`. */
function createPane(figure, { onProbe, onPin, onZoom }) {
  const box = figure.querySelector(".pane");
  const canvas = element("canvas", { width: WIDTH, height: HEIGHT });
  const cursor = element("div", { class: "cursor" });
  const marks = createMarks(box);
  box.append(canvas, marks.canvas, cursor);
  box.style.aspectRatio = `${WIDTH} / ${HEIGHT}`;
  box.style.maxWidth = `calc(75vh * ${WIDTH / HEIGHT})`;
  const context = canvas.getContext("2d");
  const image = context.createImageData(WIDTH, HEIGHT);
  const pixels = new Uint32Array(image.data.buffer);
  let probe = { x: 0, y: 0 };

  /** The position of an event, as fractions of the picture's size. */
  const placeOf = (event) => {
    const { left, top, width, height } = canvas.getBoundingClientRect();
    return { x: (event.clientX - left) / width, y: (event.clientY - top) / height };
  };
  const clamp = (x, y, how) =>
    onProbe(Math.max(0, Math.min(WIDTH - 1, x)), Math.max(0, Math.min(HEIGHT - 1, y)), how);

  let dragged = null;
  let pressed = null;
  box.addEventListener("pointerdown", (event) => {
    pressed = event;
    if (zoomed.zoom > 1) {
      box.setPointerCapture(event.pointerId);
      dragged = { at: placeOf(event) };
    }
  });
  box.addEventListener("pointermove", (event) => {
    const { x, y } = placeOf(event);
    if (dragged) {
      moveTo(zoomed.x + dragged.at.x - x, zoomed.y + dragged.at.y - y);
      onZoom();
    } else {
      clamp(Math.floor(x * WIDTH), Math.floor(y * HEIGHT), "pointer");
    }
  });
  for (const end of ["pointerup", "pointercancel"]) box.addEventListener(end, () => (dragged = null));
  box.addEventListener("click", (event) => {
    if (pressed && Math.hypot(event.clientX - pressed.clientX, event.clientY - pressed.clientY) > CLICK_TOLERANCE) return;
    const { x, y } = placeOf(event);
    clamp(Math.floor(x * WIDTH), Math.floor(y * HEIGHT), "click");
    onPin();
  });
  const zoomBy = (factor, at) => {
    zoomTo(zoomed.zoom * factor, at);
    onZoom();
  };
  // A wheel scrolls the page until the pane has the focus.
  box.addEventListener("wheel", (event) => {
    if (!event.ctrlKey && document.activeElement !== box) return;
    event.preventDefault();
    zoomBy(2 ** (-event.deltaY / 200), placeOf(event));
  }, { passive: false });
  box.addEventListener("dblclick", (event) => zoomBy(2, placeOf(event)));
  box.addEventListener("keydown", (event) => {
    const step = event.shiftKey ? 10 : 1;
    const steps = { ArrowLeft: [-step, 0], ArrowRight: [step, 0], ArrowUp: [0, -step], ArrowDown: [0, step] };
    const at = { x: (probe.x + 0.5) / WIDTH, y: (probe.y + 0.5) / HEIGHT };
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (event.key in steps) {
      const [dx, dy] = steps[event.key];
      clamp(probe.x + dx, probe.y + dy, "key");
    } else if (event.key === "Enter" || event.key === " ") onPin();
    else if (event.key === "+" || event.key === "=") zoomBy(1.5, at);
    else if (event.key === "-") zoomBy(1 / 1.5, at);
    else if (event.key === "0") zoomBy(0, at);
    else return;
    event.preventDefault();
  });

  return {
    /** Paints each pixel with `color(index)`, 0xAABBGGRR. */
    paint(color) {
      for (let i = 0; i < pixels.length; i++) pixels[i] = color(i);
      context.putImageData(image, 0, 0);
    },
    /** Outlines marked pixels: their indices, or null for none. */
    outline: marks.set,
    /** Moves the cursor to a pixel, and the canvas to the zoomed part. */
    place(x, y) {
      probe = { x, y };
      const { zoom } = zoomed;
      canvas.style.transform = `translate(${-100 * zoomed.x * zoom}%, ${-100 * zoomed.y * zoom}%) scale(${zoom})`;
      const density = (box.clientWidth * zoom) / WIDTH;
      canvas.style.imageRendering = density > 1 ? "pixelated" : "auto";
      Object.assign(cursor.style, {
        left: `${100 * zoom * (x / WIDTH - zoomed.x)}%`,
        top: `${100 * zoom * (y / HEIGHT - zoomed.y)}%`,
        width: `${(100 * zoom) / WIDTH}%`,
        height: `${(100 * zoom) / HEIGHT}%`,
      });
      marks.draw();
    },
  };
}

/** Returns a function from a pixel's index to its color; unmarked pixels fade if there
 * are marked ones. */
function pictureColor(rgb, isMarked) {
  const [r, g, b] = [(i) => rgb[3 * i], (i) => rgb[3 * i + 1], (i) => rgb[3 * i + 2]];
  const pack = (red, green, blue) => 0xff000000 | (blue << 16) | (green << 8) | red;
  if (!isMarked) return (i) => pack(r(i), g(i), b(i));
  return (i) => {
    const luma = 0.2 * r(i) + 0.7 * g(i) + 0.1 * b(i);
    if (isMarked(i)) return pack(0.5 * luma, 0.4 * luma + 140, 0.3 * luma + 178);
    return pack(30 + 0.3 * luma, 30 + 0.3 * luma, 30 + 0.3 * luma);
  };
}

// The picture and the map, side by side under one probe and one zoom.

const [WIDTH, HEIGHT] = about.size;

/** What both panes show of the picture: from (x, y), in shares of it. */
const zoomed = { zoom: 1, x: 0, y: 0 };

function zoomTo(zoom, at = { x: 0.5, y: 0.5 }) {
  zoom = Math.max(1, Math.min(Math.max(8, WIDTH / 8), zoom));
  // The point `at` of the picture stays where it is.
  const keep = (from, center) => center - (center - from) * (zoomed.zoom / zoom);
  const [x, y] = [keep(zoomed.x, at.x), keep(zoomed.y, at.y)];
  zoomed.zoom = zoom;
  moveTo(x, y);
}

function moveTo(x, y) {
  const last = 1 - 1 / zoomed.zoom;
  [zoomed.x, zoomed.y] = [x, y].map((from) => Math.max(0, Math.min(last, from)));
}

/** Lets the zoomed part follow a pixel. */
function reveal(x, y) {
  const size = 1 / zoomed.zoom;
  const follow = (from, at) => Math.min(Math.max(from, at - size * 0.95), at - size * 0.05);
  const into = (from, at) => (at < from || at > from + size ? follow(from, at) : from);
  moveTo(into(zoomed.x, (x + 0.5) / WIDTH), into(zoomed.y, (y + 0.5) / HEIGHT));
}

/** A canvas of the picture's pixels; tells `onProbe(x, y, byKey)` and `onZoom()`. */
function createPane(figure, { onProbe, onZoom }) {
  const box = figure.querySelector(".pane");
  const canvas = element("canvas", { width: WIDTH, height: HEIGHT });
  const cursor = element("div", { class: "cursor" });
  box.append(canvas, cursor);
  box.style.aspectRatio = `${WIDTH} / ${HEIGHT}`;
  box.style.maxWidth = `calc(75vh * ${WIDTH / HEIGHT})`;
  const context = canvas.getContext("2d");
  const image = context.createImageData(WIDTH, HEIGHT);
  const pixels = new Uint32Array(image.data.buffer);
  let probe = { x: 0, y: 0 };

  /** The event's place in shares of the picture. */
  const placeOf = (event) => {
    const { left, top, width, height } = canvas.getBoundingClientRect();
    return { x: (event.clientX - left) / width, y: (event.clientY - top) / height };
  };
  const clamp = (x, y, byKey) =>
    onProbe(Math.max(0, Math.min(WIDTH - 1, x)), Math.max(0, Math.min(HEIGHT - 1, y)), byKey);

  let dragged = null;
  box.addEventListener("pointerdown", (event) => {
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
      clamp(Math.floor(x * WIDTH), Math.floor(y * HEIGHT), false);
    }
  });
  for (const end of ["pointerup", "pointercancel"]) box.addEventListener(end, () => (dragged = null));
  box.addEventListener("click", (event) => {
    const { x, y } = placeOf(event);
    clamp(Math.floor(x * WIDTH), Math.floor(y * HEIGHT), false);
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
      clamp(probe.x + dx, probe.y + dy, true);
    } else if (event.key === "+" || event.key === "=") zoomBy(1.5, at);
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
    /** Puts the cursor on a pixel and the canvas where the zoom wants it. */
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
    },
  };
}

/** The picture's colors; where something is marked, the rest fades. */
function pictureColor(rgb, isMarked) {
  const [r, g, b] = [(i) => rgb[3 * i], (i) => rgb[3 * i + 1], (i) => rgb[3 * i + 2]];
  const pack = (red, green, blue) => 0xff000000 | (blue << 16) | (green << 8) | red;
  if (!isMarked) return (i) => pack(r(i), g(i), b(i));
  return (i) => {
    const grey = 0.2 * r(i) + 0.7 * g(i) + 0.1 * b(i);
    if (isMarked(i)) return pack(0.5 * grey, 0.4 * grey + 140, 0.3 * grey + 178);
    return pack(30 + 0.3 * grey, 30 + 0.3 * grey, 30 + 0.3 * grey);
  };
}

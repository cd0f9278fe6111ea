// The part of the picture that both panes show.

const [WIDTH, HEIGHT] = about.size;

/** The zoom factor, at least 1, and the top left corner of the shown part, as fractions of
 * the picture's size. */
const zoomed = { zoom: 1, x: 0, y: 0 };

/** Sets the zoom factor; the point `at` of the picture keeps its place on the screen. */
function zoomTo(zoom, at = { x: 0.5, y: 0.5 }) {
  zoom = Math.max(1, Math.min(Math.max(8, WIDTH / 8), zoom));
  const keep = (from, center) => center - (center - from) * (zoomed.zoom / zoom);
  const [x, y] = [keep(zoomed.x, at.x), keep(zoomed.y, at.y)];
  zoomed.zoom = zoom;
  moveTo(x, y);
}

/** Moves the top left corner of the shown part; keeps the part inside the picture. */
function moveTo(x, y) {
  const last = 1 - 1 / zoomed.zoom;
  [zoomed.x, zoomed.y] = [x, y].map((from) => Math.max(0, Math.min(last, from)));
}

/** Moves the shown part so that it contains a pixel. */
function reveal(x, y) {
  const size = 1 / zoomed.zoom;
  const follow = (from, at) => Math.min(Math.max(from, at - size * 0.95), at - size * 0.05);
  const into = (from, at) => (at < from || at > from + size ? follow(from, at) : from);
  moveTo(into(zoomed.x, (x + 0.5) / WIDTH), into(zoomed.y, (y + 0.5) / HEIGHT));
}

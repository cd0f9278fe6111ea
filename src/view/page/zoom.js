// The part of the picture that both panes show.

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

// The histogram and the color bar on a common axis.

const BARS_HEIGHT = 96;
const BAR_TOP = BARS_HEIGHT + 4;
const BAR_HEIGHT = 16;
const RULER_HEIGHT = BAR_TOP + BAR_HEIGHT + 30;
const SVG = document.querySelector("svg").namespaceURI;
/** Space at both ends of the axis for the handles. */
const MARGIN = 14;

function svg(name, attributes = {}, ...children) {
  const made = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  made.append(...children);
  return made;
}

/** Creates the histogram with its color bar. Handles call `onScale(low, high)`, dragging
 * over the histogram calls `onMark(from, to)`. */
function createRuler(section, { onScale, onMark }) {
  const root = section.querySelector("svg");
  let shown = null;
  const inner = () => Math.max(50, root.clientWidth - 2 * MARGIN);
  const positionAt = (event) => {
    const { left } = root.getBoundingClientRect();
    return Math.max(0, Math.min(1, (event.clientX - left - MARGIN) / inner()));
  };

  const move = (end, position) => {
    const { scale, axis } = shown;
    // The ends may touch, but not cross.
    const beside = (value, step) => axis.value(axis.position(value) + step);
    if (end === "low") onScale(Math.min(axis.value(position), beside(scale.high, -1e-3)), scale.high);
    else onScale(scale.low, Math.max(axis.value(position), beside(scale.low, 1e-3)));
  };
  const at = (end) => shown.axis.position(shown.scale[end]);
  const handles = ["low", "high"].map((end) =>
    createHandle(end, { positionAt, at: () => at(end), move: (position) => move(end, position) }));

  const brush = { from: null };
  root.addEventListener("pointerdown", (event) => {
    if (!event.target.classList.contains("field")) return;
    root.setPointerCapture(event.pointerId);
    brush.from = positionAt(event);
  });
  root.addEventListener("pointermove", (event) => {
    if (brush.from === null) return;
    const ends = [brush.from, positionAt(event)].sort((a, b) => a - b);
    if (ends[1] - ends[0] > 0.004) onMark(...marked(ends));
  });
  // A range that reaches an end of the axis includes all values beyond it.
  const marked = ([from, to]) => {
    const { low, high } = extent(shown.field);
    return [from > 0 ? shown.axis.value(from) : Math.min(low, shown.axis.low), to < 1 ? shown.axis.value(to) : Math.max(high, shown.axis.high)];
  };
  const release = (event) => {
    if (brush.from !== null && Math.abs(positionAt(event) - brush.from) <= 0.004) onMark(null, null);
    brush.from = null;
  };
  root.addEventListener("pointerup", release);
  root.addEventListener("pointercancel", () => (brush.from = null));
  new ResizeObserver(() => shown && draw()).observe(root);

  function draw() {
    const width = inner();
    root.setAttribute("height", RULER_HEIGHT);
    const { scale, axis, field } = shown;
    for (const [i, end] of ["low", "high"].entries()) {
      const x = MARGIN + Math.max(0, Math.min(1, axis.position(scale[end]))) * width;
      handles[i].setAttribute("transform", `translate(${x} ${BAR_TOP})`);
      handles[i].setAttribute("aria-valuemin", axis.low);
      handles[i].setAttribute("aria-valuemax", axis.high);
      handles[i].setAttribute("aria-valuenow", scale[end]);
      handles[i].setAttribute("aria-valuetext", formatTick(scale[end], field.name));
    }
    const grip = svg("rect", { class: "field", x: MARGIN, y: 0, width, height: BARS_HEIGHT });
    const outline = bars(shown, width);
    section.querySelector(".hint").textContent = `Pixels, on a logarithmic scale${unplaced(shown)}`;
    const below = [outline, ...band(shown, width), ...colorBar(shown, width), ticks(shown, width), ...pointer(shown, width), grip];
    // The handles stay in the document, or they would lose the focus.
    for (const old of Array.from(root.children)) if (!handles.includes(old)) old.remove();
    if (!handles[0].isConnected) root.append(...handles);
    root.prepend(...below);
  }

  return {
    /** Draws a new state: `axis`, `field`, `scale`, `table`, `mark`, `probed`. */
    update(state) {
      const same = shown?.field === state.field && shown?.axis === state.axis;
      shown = { ...state, bins: same ? shown.bins : null };
      draw();
    },
  };
}

/** Creates a handle on the color bar; `at` returns its position, `move` changes it. */
function createHandle(end, { positionAt, at, move }) {
  const handle = svg("g", { class: "handle", tabindex: 0, role: "slider" });
  handle.setAttribute("aria-label", end === "low" ? "Low end of the colors" : "High end of the colors");
  handle.append(svg("path", { d: "M0 -3 L8 7 V22 H-8 V7 Z" }));
  handle.addEventListener("pointerdown", (event) => {
    handle.setPointerCapture(event.pointerId);
    handle.focus();
    event.preventDefault();
  });
  handle.addEventListener("pointermove", (event) => {
    if (handle.hasPointerCapture(event.pointerId)) move(positionAt(event));
  });
  handle.addEventListener("keydown", (event) => {
    const steps = { ArrowLeft: -1, ArrowDown: -1, ArrowRight: 1, ArrowUp: 1, PageDown: -10, PageUp: 10 };
    if (event.key in steps) move(Math.max(0, Math.min(1, at() + steps[event.key] / 100)));
    else if (event.key === "Home") move(0);
    else if (event.key === "End") move(1);
    else return;
    event.preventDefault();
  });
  return handle;
}

/** The bars as one path; each of a few integer values has its own bar. */
function bars(shown, width) {
  const { field, axis } = shown;
  const n_values = axis.high - axis.low;
  const n_bins = field.whole && !axis.log && n_values < 400 ? n_values : Math.min(240, Math.round(width / 3));
  if (shown.bins?.counts.length !== n_bins) shown.bins = histogram(field, axis, n_bins);
  const highest = Math.log1p(shown.bins.counts.reduce((most, n) => Math.max(most, n), 1));
  const gap = n_bins < 40 ? 2 : 0;
  let path = "";
  shown.bins.counts.forEach((n, i) => {
    if (n === 0) return;
    const height = Math.max(1.5, (Math.log1p(n) / highest) * (BARS_HEIGHT - 6));
    const [from, to] = [MARGIN + (i * width) / n_bins, MARGIN + ((i + 1) * width) / n_bins - gap];
    path += `M${from.toFixed(1)} ${BARS_HEIGHT}V${(BARS_HEIGHT - height).toFixed(1)}H${to.toFixed(1)}V${BARS_HEIGHT}Z`;
  });
  return svg("path", { class: "bars", d: path });
}

/** A text on the values that are not on the axis. */
function unplaced({ field, axis, bins: { counts, n_below, n_above } }) {
  const n = field.values.length - n_below - n_above - counts.reduce((sum, n) => sum + n, 0);
  const why = axis.log ? "have no value above 0" : "have no value";
  const parts = [];
  if (n_below) parts.push(`${format(n_below)} are lower`);
  if (n_above) parts.push(`${format(n_above)} are higher, up to ${format(extent(field).high, field.name)}`);
  if (n) parts.push(`${format(n)} gray ones ${why}`);
  return parts.map((part) => `; ${part}`).join("");
}

/** The color bar, as elements. */
function colorBar(shown, width) {
  const { scale, axis, table } = shown;
  const gradient = svg("linearGradient", { id: "ramp" });
  for (let i = 0; i <= 32; i++) {
    const position = axis.position(scale.value(i / 32));
    const color = table.subarray(3 * Math.round((i / 32) * 255)).subarray(0, 3);
    gradient.append(svg("stop", { offset: Math.max(0, Math.min(1, position)), "stop-color": `rgb(${color})` }));
  }
  const bar = svg("rect", { x: MARGIN, y: BAR_TOP, width, height: BAR_HEIGHT, fill: "url(#ramp)", rx: 2 });
  return [svg("defs", {}, gradient), bar];
}

/** The ticks with their labels, as an element. */
function ticks(shown, width) {
  const group = svg("g", { class: "ticks" });
  const whole = shown.field.whole;
  for (const [value, position] of shown.axis.ticks(Math.max(2, Math.floor(width / 90)))) {
    if (whole && !Number.isInteger(Number(value.toPrecision(9)))) continue;
    const x = MARGIN + position * width;
    const y = BAR_TOP + BAR_HEIGHT;
    group.append(svg("line", { x1: x, x2: x, y1: y, y2: y + 5 }));
    const label = svg("text", { x, y: y + 19 });
    label.textContent = formatTick(value, shown.field.name);
    group.append(label);
  }
  return group;
}

/** The marked range, as elements. */
function band({ mark, axis, field }, width) {
  if (!mark || mark.field.key !== field.key) return [];
  const [from, to] = [mark.from, mark.to].map((value) => Math.max(0, Math.min(1, axis.position(value) || 0)));
  const box = { x: MARGIN + from * width, y: 0, width: Math.max(1, (to - from) * width), height: BARS_HEIGHT };
  return [svg("rect", { class: "brush", ...box })];
}

/** The line at the probed value, as elements. */
function pointer({ axis, probed }, width) {
  const position = axis.position(probed);
  if (Number.isNaN(position)) return [];
  const x = MARGIN + Math.max(0, Math.min(1, position)) * width;
  const line = svg("line", { class: "pointer", x1: x, x2: x, y1: 0, y2: BAR_TOP + BAR_HEIGHT });
  if (position >= 0 && position <= 1) return [line];
  // An arrow points to a value beyond the end.
  const tip = position < 0 ? -10 : 10;
  return [line, svg("path", { class: "pointer", d: `M${x} 8 h${tip} m${-tip / 2} -4 l${tip / 2} 4 l${-tip / 2} 4` })];
}

// The state of the page and its changes.

const byId = (id) => document.getElementById(id);

/** The most expensive pixel that is shown, or the one in the middle: the probe starts there. */
const first_probed = about.hottest.flatMap(({ pixels }) => pixels).find(({ index }) => index !== null)?.index ?? (HEIGHT >> 1) * WIDTH + (WIDTH >> 1);

/** The shown field, its axis and color scale, the marked range of values, the probed
 * pixel, and whether the probe is pinned. */
const state = { field: null, axis: null, scale: null, table: null, mark: null, x: first_probed % WIDTH, y: Math.floor(first_probed / WIDTH), pinned: false };
/** Counts choices of the menu, so that an outdated choice is not shown. */
let n_choices = 0;
let rgb = null;
let cloud = null;

const pane_events = { onProbe: moveProbe, onPin: () => pin(!state.pinned), onZoom: placeCursors };
const picture = createPane(byId("picture"), pane_events);
const map = createPane(byId("map"), pane_events);
const probe = createProbe(byId("probe"));
const ruler = createRuler(byId("ruler"), { onScale: setScale, onMark: (from, to) => mark(state.field, from, to) });

/** Moves the probe; a pinned probe follows only keys and clicks. */
function moveProbe(x, y, how) {
  if (state.pinned && how === "pointer") return;
  Object.assign(state, { x, y });
  if (how === "key") reveal(x, y);
  placeCursors();
  showProbe(how === "key" ? "" : null);
}

/** Pins the probe, or lets it follow the pointer again. */
function pin(isPinned) {
  state.pinned = isPinned;
  document.body.classList.toggle("pinned", isPinned);
  byId("pin").setAttribute("aria-pressed", isPinned);
  showProbe(isPinned ? "Pinned. " : "Released. ");
}

function placeCursors() {
  for (const pane of [picture, map]) pane.place(state.x, state.y);
}

/** Shows the probe's values; announces them to screen readers after `prefix`, unless it
 * is null. */
function showProbe(prefix = null) {
  const index = state.y * WIDTH + state.x;
  probe.update(state.x, state.y, state.field, prefix);
  cloud?.probe(index);
  drawRuler();
}

function drawRuler() {
  ruler.update({ ...state, probed: state.field.values[state.y * WIDTH + state.x] });
}

const paintPixels = oncePerFrame(() => {
  const paint = painter(state.scale, state.table);
  const { values } = state.field;
  map.paint((i) => paint(values[i]));
  cloud?.update(state);
});

/** Updates what depends on the colors. */
function paintMap() {
  paintPixels();
  drawRuler();
  byId("low").value = formatInput(state.scale.low);
  byId("high").value = formatInput(state.scale.high);
}

function setScale(low, high) {
  if (!(low < high) || (state.axis.log && !(low > 0))) return;
  state.scale = new Scale(low, high, state.axis.log);
  paintMap();
}

/** Applies the chosen range to the histogram and the colors. */
function setAxis() {
  const all = axisOf(state.field, byId("log").checked);
  const isAll = byId("range-all").checked;
  state.axis = isAll ? all : withoutOutliers(state.field, all);
  state.scale = isAll ? all : fitted(state.field, all);
  paintMap();
}

const paintMarks = oncePerFrame(() => {
  const { field, from, to } = state.mark ?? {};
  const isMarked = field && ((i) => field.values[i] >= from && field.values[i] <= to);
  picture.paint(pictureColor(rgb, isMarked));
  const indices = field ? outlined(field.values.length, isMarked) : null;
  for (const pane of [picture, map]) pane.outline(indices);
  cloud?.mark(isMarked);
  byId("marked").textContent = field ? describeMark(state.mark) : "Drag over the histogram.";
});

/** The indices below `n` that are marked; null if there are more than MAX_MARKED. */
function outlined(n, isMarked) {
  const indices = [];
  for (let i = 0; i < n && indices.length <= MAX_MARKED; i++) if (isMarked(i)) indices.push(i);
  return indices.length <= MAX_MARKED ? indices : null;
}

/** Marks the pixels whose value of a field is within a range; a null range unmarks all. */
function mark(field, from, to, name = "") {
  state.mark = from === null ? null : { field, from, to, name };
  paintMarks();
  drawRuler();
  const isShown = state.mark && field.key === state.field.key;
  byId("mark-from").value = isShown ? formatInput(from) : "";
  byId("mark-to").value = isShown ? formatInput(to) : "";
}

/** The number of marked pixels and their share of the total cost. */
function describeMark({ field, from, to, name }) {
  let [n, sum, total] = [0, 0, 0];
  for (const value of field.values) {
    if (Number.isNaN(value)) continue;
    total += value;
    if (value >= from && value <= to) [n, sum] = [n + 1, sum + value];
  }
  const share = `${format(n)} pixels, ${percent(n / field.values.length)}`;
  const { group, label } = described(field.name);
  const cost = group === "Cost" && total > 0 ? `; ${percent(sum / total)} of ${label.toLowerCase()}` : "";
  return (name ? `${name}: ` : "") + share + cost;
}

/** Shows the field with this key of the menu. */
async function chooseArray(key) {
  const choice = ++n_choices;
  const chosen = await field(key);
  if (choice !== n_choices) return;
  const { about: text, log, unit } = described(chosen.name);
  state.field = chosen;
  byId("array").value = key;
  byId("array-about").textContent = text;
  byId("map-title").textContent = labelOf(key);
  for (const place of document.querySelectorAll(".unit")) place.textContent = unit && `(${unit})`;
  byId("log").disabled = !hasPositive(chosen);
  byId("log").checked = Boolean(log) && !byId("log").disabled;
  setAxis();
  showProbe();
  if (state.mark) mark(state.mark.field, state.mark.from, state.mark.to, state.mark.name);
}

/** Marks the pixels of an object or a material of the table. */
async function pick(kind, id, name) {
  mark(await field(kind), id, id, name || kind);
  byId("picture").scrollIntoView({ block: "nearest" });
}

function fillMenus() {
  const groups = new Map(["Cost", "Geometry", "Work", "Picture", "Other"].map((name) => [name, element("optgroup", { label: name })]));
  const fields = [...FIELDS.values()];
  for (const name of inOrder(about.arrays.map((array) => array.name))) {
    for (const { key } of fields.filter((field) => field.name === name)) {
      groups.get(described(name).group).append(element("option", { value: key }, labelOf(key)));
    }
  }
  byId("array").append(...[...groups.values()].filter((group) => group.children.length > 0));
  byId("color-map").append(...Object.keys(about.color_maps).map((name) => element("option", {}, name)));
}

/** Calls `accept(from, to)` when two fields hold a valid range; flags invalid fields. */
function onTyped(ids, accept) {
  const typed = () => {
    const [from, to] = ids.map((id) => (byId(id).value.trim() === "" ? NaN : Number(byId(id).value)));
    ids.forEach((id, i) => byId(id).setAttribute("aria-invalid", Number.isNaN([from, to][i]) || from > to));
    if (from <= to) accept(from, to);
  };
  for (const id of ids) byId(id).addEventListener("change", typed);
}

function listenToControls() {
  byId("controls").addEventListener("submit", (event) => event.preventDefault());
  byId("array").addEventListener("change", (event) => chooseArray(event.target.value));
  byId("color-map").addEventListener("change", (event) => {
    state.table = colorTable(event.target.value);
    paintMap();
  });
  byId("log").addEventListener("change", setAxis);
  byId("fit").addEventListener("click", setAxis);
  for (const id of ["range-middle", "range-all"]) byId(id).addEventListener("change", setAxis);
  byId("pin").addEventListener("click", () => pin(!state.pinned));
  document.addEventListener("keydown", (event) => {
    if (event.key === "Escape" && state.pinned) pin(false);
  });
  byId("clear").addEventListener("click", () => mark(null, null, null));
  onTyped(["low", "high"], setScale);
  onTyped(["mark-from", "mark-to"], (from, to) => mark(state.field, from, to));
  new ResizeObserver(placeCursors).observe(byId("map"));
}

async function start() {
  byId("facts").append(...about.facts.map((fact) => element("li", {}, fact)));
  byId("notes").append(...about.notes.map((note) => element("li", {}, note)));
  state.table = colorTable(Object.keys(about.color_maps)[0]);
  fillMenus();
  listenToControls();
  rgb = await frameArray("RGB");
  picture.paint(pictureColor(rgb, null));
  // The scene's own metrics come first, as in cost.png.
  const costs = about.metrics.map((metric) => metric.name);
  const first = [...costs, "distance"].find((name) => FIELDS.has(name));
  await chooseArray(first ?? byId("array").value);
  placeCursors();
  createHottest(byId("hottest"), {
    onMark: (hot) => (hot ? mark(hot, 1, 1, "Most expensive") : mark(null, null, null)),
    onShow: (x, y) => {
      moveProbe(x, y, "key");
      pin(true);
    },
  });
  for (const { name } of about.arrays) probe.add(name, await frameArray(name));
  showProbe();
  await createTable(byId("objects"), { onPick: pick });
  cloud = await createCloud(byId("cloud"));
  cloud.update(state);
  if (state.mark) paintMarks();
  showProbe();
  document.body.dataset.ready = "";
}

function fail(error) {
  const failure = byId("failure");
  const old = typeof DecompressionStream === "undefined" ? " This browser is too old to decompress the page's data." : "";
  failure.textContent = `The page could not be shown: ${error?.message ?? error}.${old}`;
  failure.hidden = false;
}

addEventListener("error", (event) => fail(event.error ?? event.message));
addEventListener("unhandledrejection", (event) => fail(event.reason));
start();

// Labels of arrays and formats of numbers.

/** The known arrays of a rendering, in the order of the menu. */
const ARRAYS = {
  ...Object.fromEntries(about.metrics.map(({ name, ...metric }) => [name, { group: "Cost", ...metric }])),
  time_mad_ns: { group: "Cost", label: "Deviation of time", about: "median deviation of the repeats from the time" },
  tile: { group: "Work", label: "Tile", about: "the tile that the pixel was rendered in" },
  thread: { group: "Work", label: "Thread", about: "the thread that rendered the pixel" },
  distance: { group: "Geometry", label: "Distance", about: "from the camera along its ray" },
  footprint: { group: "Geometry", label: "Footprint", about: "world size of the pixel where it hits" },
  object: { group: "Geometry", label: "Object", about: "position in the scene's list; -1 for none", names: about.objects },
  material: { group: "Geometry", label: "Material", about: "position in the scene's list; -1 for none", names: about.materials },
  Normals: { group: "Geometry", label: "Normal", about: "unit normal on the visible side", components: ["x", "y", "z"] },
  RGB: { group: "Picture", label: "Color", about: "8 bits a channel", components: ["red", "green", "blue"] },
  radiance: { group: "Picture", label: "Light", about: "before exposure and encoding", components: ["red", "green", "blue"] },
};

/** Sorts names of arrays in the order of the menu, unknown ones last. */
function inOrder(names) {
  const known = Object.keys(ARRAYS);
  const place = (name) => (known.includes(name) ? known.indexOf(name) : known.length);
  return names.sort((a, b) => place(a) - place(b));
}

/** The description of an array; the label of an unknown one is its name. */
function described(name) {
  const unit = name.endsWith("_ns") ? "ns" : "";
  return { group: "Other", label: name, about: "", unit, ...ARRAYS[name] };
}

/** The label of a field in the menu. */
function labelOf(key) {
  const { name, n, component } = FIELDS.get(key);
  const { label, components } = described(name);
  return n === 1 ? label : `${label} ${components?.[component] ?? component}`;
}

/** Formats a value of an array. */
function format(value, name = "") {
  if (Number.isNaN(value)) return "none";
  const { names, unit } = described(name);
  if (names) return value < 0 ? "none" : `${names[value] ?? "?"} (${value})`;
  if (unit === "ns") return formatTime(value);
  if (Math.abs(value) >= 1000) return value.toLocaleString("en", { maximumFractionDigits: 2 });
  return String(Number(value.toPrecision(7)));
}

function formatTime(ns, digits = 4) {
  const units = ["ns", "µs", "ms", "s"];
  let unit = 0;
  while (Math.abs(ns) >= 999.95 && unit < 3) [ns, unit] = [ns / 1000, unit + 1];
  return `${Number(ns.toPrecision(digits))} ${units[unit]}`;
}

/** Formats a value as a short label of a tick. */
function formatTick(value, name) {
  if (described(name).unit === "ns") return formatTime(value, 6);
  const size = Math.abs(value);
  for (const [unit, word] of [[1e9, "G"], [1e6, "M"], [1e3, "k"]]) {
    if (size >= unit) return `${Number((value / unit).toPrecision(6))}${word}`;
  }
  return String(Number(value.toPrecision(6)));
}

/** Formats a value for a text field. */
function formatInput(value) {
  return String(Number(value.toPrecision(6)));
}

function percent(share) {
  return `${(100 * share).toFixed(share < 0.1 ? 2 : 1)} %`;
}

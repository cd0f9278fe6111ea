// Decodes the page's numbers: byte planes, compressed by zlib and encoded in base64.

const about = JSON.parse(document.getElementById("about").textContent);

const TYPES = {
  u8: Uint8Array,
  u16: Uint16Array,
  i32: Int32Array,
  u32: Uint32Array,
  i64: BigInt64Array,
  u64: BigUint64Array,
  f32: Float32Array,
  f64: Float64Array,
};

const decoded = new Map();

/** The numbers under an id, decoded at the first call. */
function numbers(id, type) {
  if (!decoded.has(id)) {
    decoded.set(id, bytes(id).then((planes) => gather(planes, TYPES[type])));
  }
  return decoded.get(id);
}

/** Decodes the bytes under an id; works once, since it removes the text. */
async function bytes(id) {
  const element = document.getElementById(id);
  const text = atob(element.textContent);
  element.remove();
  const zlib = new Uint8Array(text.length);
  for (let i = 0; i < zlib.length; i++) zlib[i] = text.charCodeAt(i);
  const plain = new Blob([zlib]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(plain).arrayBuffer());
}

/** Transposes byte planes to numbers. */
function gather(planes, Type) {
  const width = Type.BYTES_PER_ELEMENT;
  const n = planes.length / width;
  const interleaved = new Uint8Array(planes.length);
  for (let plane = 0, from = 0; plane < width; plane++) {
    for (let to = plane; from < n * (plane + 1); from++, to += width) interleaved[to] = planes[from];
  }
  const values = new Type(interleaved.buffer);
  return typeof values[0] === "bigint" ? Float64Array.from(values, Number) : values;
}

/** The 256 colors of a color map, three bytes each. */
function colorTable(name) {
  return Uint8Array.from(atob(about.color_maps[name]), (c) => c.charCodeAt(0));
}

/** The numbers of the frame's array with this name. */
function frameArray(name) {
  const { id, type } = about.arrays.find((array) => array.name === name);
  return numbers(id, type);
}

/** The fields that can be shown, by their keys in the menu: arrays with one number per
 * pixel, and the components of the others. */
const FIELDS = new Map(
  about.arrays.flatMap(({ name, type, n_components: n }) =>
    Array.from({ length: n }, (_, component) => {
      const key = n === 1 ? name : `${name}.${component}`;
      return [key, { key, name, n, component, whole: !type.startsWith("f") }];
    })));

/** A field with its values, one per pixel. */
async function field(key) {
  const { name, n, component } = FIELDS.get(key);
  const all = await frameArray(name);
  let values = all;
  if (n > 1) {
    values = new all.constructor(all.length / n);
    for (let i = 0; i < values.length; i++) values[i] = all[n * i + component];
  }
  return { ...FIELDS.get(key), values };
}

// The page's numbers: zlib in base64, bytes of equal weight together.

const about = JSON.parse(document.getElementById("about").textContent);

const TYPES = {
  u8: Uint8Array,
  i32: Int32Array,
  u32: Uint32Array,
  i64: BigInt64Array,
  u64: BigUint64Array,
  f32: Float32Array,
  f64: Float64Array,
};

const unpacked = new Map();

/** The numbers under an id, unpacked when they are first asked for. */
function numbers(id, type) {
  if (!unpacked.has(id)) {
    unpacked.set(id, bytes(id).then((planes) => gather(planes, TYPES[type])));
  }
  return unpacked.get(id);
}

/** The bytes under an id, which can be had once; the text goes. */
async function bytes(id) {
  const element = document.getElementById(id);
  const packed = atob(element.textContent);
  element.remove();
  const zlib = new Uint8Array(packed.length);
  for (let i = 0; i < zlib.length; i++) zlib[i] = packed.charCodeAt(i);
  const plain = new Blob([zlib]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(plain).arrayBuffer());
}

/** Puts each number's bytes side by side again. */
function gather(planes, Type) {
  const width = Type.BYTES_PER_ELEMENT;
  const n = planes.length / width;
  const together = new Uint8Array(planes.length);
  for (let plane = 0, from = 0; plane < width; plane++) {
    for (let to = plane; from < n * (plane + 1); from++, to += width) together[to] = planes[from];
  }
  const values = new Type(together.buffer);
  return typeof values[0] === "bigint" ? Float64Array.from(values, Number) : values;
}

/** Three bytes a color, for 256 of them. */
function colorTable(name) {
  return Uint8Array.from(atob(about.color_maps[name]), (c) => c.charCodeAt(0));
}

/** The numbers of the frame's array with this name. */
function frameArray(name) {
  const { id, type } = about.arrays.find((array) => array.name === name);
  return numbers(id, type);
}

/** What can be shown, by the keys of the menu: arrays of one number a pixel,
 * and the components of the others. */
const FIELDS = new Map(
  about.arrays.flatMap(({ name, type, n_components: n }) =>
    Array.from({ length: n }, (_, component) => {
      const key = n === 1 ? name : `${name}.${component}`;
      return [key, { key, name, n, component, whole: !type.startsWith("f") }];
    })));

/** A field with its values, one a pixel. */
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

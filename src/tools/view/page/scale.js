// Scales: from values to positions between 0 and 1.

/** A range of values, linear or logarithmic. */
class Scale {
  constructor(low, high, log) {
    const span = log ? Math.log(high / low) : high - low;
    Object.assign(this, { low, high, log, span });
  }

  /** The position of a value: 0 at the low end, 1 at the high end; NaN for NaN, and on a
   * logarithmic scale for values that are not positive. */
  position(value) {
    if (!this.log) return (value - this.low) / this.span;
    return value > 0 ? Math.log(value / this.low) / this.span : NaN;
  }

  /** The value at a position. */
  value(position) {
    return this.log ? this.low * Math.exp(position * this.span) : this.low + position * this.span;
  }

  /** About `n` round values within the range, each with its position. */
  ticks(n) {
    const values = this.log ? logTicks(this, n) : linearTicks(this, n);
    return values.map((value) => [value, this.position(value)]);
  }
}

function linearTicks({ low, high }, n) {
  const rough = (high - low) / n;
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = power * [1, 2, 5, 10].find((factor) => factor * power >= rough);
  const values = [];
  for (let i = Math.ceil(low / step); i * step <= high * (1 + 1e-12); i++) values.push(i * step);
  return values;
}

function logTicks({ low, high }, n) {
  const n_decades = Math.log10(high / low);
  if (n_decades < 0.7) return linearTicks({ low, high }, n);
  const factors = n_decades * 9 < n ? [1, 2, 3, 4, 5, 6, 7, 8, 9] : n_decades * 3 < n ? [1, 2, 5] : [1];
  const each = Math.max(1, Math.ceil(n_decades / n));
  const values = [];
  for (let decade = Math.floor(Math.log10(low)); 10 ** decade <= high; decade += each) {
    for (const factor of factors) values.push(factor * 10 ** decade);
  }
  return values.filter((value) => value >= low && value <= high);
}

/** The least, the greatest and the least positive of a field's finite values. */
function extent({ values }) {
  let [low, high, positive] = [Infinity, -Infinity, Infinity];
  for (const value of values) {
    if (value < low && value > -Infinity) low = value;
    if (value > high && value < Infinity) high = value;
    if (value > 0 && value < positive) positive = value;
  }
  return { low, high, positive };
}

/** The axis that contains all values of a field; a logarithmic axis all positive ones. */
function axisOf(field, log) {
  let { low, high, positive } = extent(field);
  if (log) [low, high] = low < high && low <= 0 ? [positive, high] : [low, high];
  if (!(low <= high)) [low, high] = [1, 1]; // no value at all
  if (log) return low < high ? new Scale(low, high, true) : new Scale(low / 2, high * 2, true);
  if (field.whole && high - low < 400) return new Scale(low - 0.5, high + 0.5, false);
  return low < high ? new Scale(low, high, false) : new Scale(low - 0.5, high + 0.5, false);
}

/** Whether a field has a positive value, so that a logarithmic axis is possible. */
function hasPositive(field) {
  return extent(field).positive < Infinity;
}

/** Counts the values in each of `n_bins` equal bins of an axis, and those beyond its ends. */
function histogram({ values }, axis, n_bins) {
  const counts = new Uint32Array(n_bins);
  let [n_below, n_above] = [0, 0];
  for (const value of values) {
    const position = axis.position(value);
    if (position < 0) n_below++;
    else if (position > 1) n_above++;
    else if (position >= 0) counts[Math.min(n_bins - 1, Math.floor(position * n_bins))]++;
  }
  return { counts, n_below, n_above };
}

const sorted = new WeakMap();

/** A field's finite values, ascending; sorted at the first call. */
function sortedValues({ values }) {
  if (!sorted.has(values)) sorted.set(values, Float64Array.from(values).filter(Number.isFinite).sort());
  return sorted.get(values);
}

/** The range from the 0.5 % quantile to the 99.5 % quantile, so that outliers such as
 * interrupted pixels do not compress the color scale; the whole axis if it is empty. */
function fitted(field, axis) {
  const all = sortedValues(field);
  const values = axis.log ? all.subarray(all.findIndex((value) => value > 0)) : all;
  const n_outside = Math.floor(values.length / 200);
  const [low, high] = [values[n_outside], values[values.length - 1 - n_outside]];
  return low < high ? new Scale(low, high, axis.log) : axis;
}

/** The axis of all values or, if outliers take more than half of it, an axis of the
 * others. */
function withoutOutliers(field, axis) {
  const { names, group } = described(field.name);
  if (names || group === "Work") return axis;
  const middle = fitted(field, axis);
  const [from, to] = [middle.low, middle.high].map((value) => axis.position(value));
  if (to - from > 0.5) return axis;
  const margin = 0.03 * (to - from);
  let [low, high] = [from - margin, to + margin].map((at) => axis.value(Math.max(0, Math.min(1, at))));
  if (field.whole && !axis.log) [low, high] = [Math.ceil(low) - 0.5, Math.floor(high) + 0.5];
  return new Scale(low, high, axis.log);
}

/** Returns a function from a value to its color in the table, 0xAABBGGRR; gray for a
 * value that the scale cannot place. */
function painter(scale, table) {
  const colors = new Uint32Array(256);
  for (let i = 0; i < 256; i++) {
    const [r, g, b] = table.subarray(3 * i, 3 * i + 3);
    colors[i] = 0xff000000 | (b << 16) | (g << 8) | r;
  }
  return (value) => {
    const position = scale.position(value);
    if (Number.isNaN(position)) return 0xff808080;
    return colors[Math.max(0, Math.min(255, Math.round(position * 255)))];
  };
}

// The panel with all values of the probed pixel.

/** Creates the panel; values appear as their arrays are decoded. */
function createProbe(section) {
  const body = section.querySelector("tbody");
  const title = section.querySelector("h2");
  const announcement = section.querySelector("[aria-live]");
  const rows = new Map();
  const known = new Map();
  for (const name of inOrder(about.arrays.map((array) => array.name))) {
    const cell = element("td", {}, "…");
    const { label, about: title } = described(name);
    const row = element("tr", { "data-array": name }, element("th", { scope: "row", title }, label), cell);
    rows.set(name, { row, cell });
    body.append(row);
  }

  /** The column (`axis` 0) or row (1) in the whole picture of a shown one. */
  const fullPlace = (place, axis) => about.origin[axis] + Math.floor(((2 * place + 1) * about.full_size[axis]) / (2 * about.size[axis]));

  /** Splits a label such as `name (3)`, so that a long name is truncated, not its number. */
  const named = (text) => {
    const [, name, id] = text.match(/^(.*)( \(-?\d+\))$/s) ?? [null, text, ""];
    return [element("span", { class: "name" }, name), element("span", {}, id)];
  };

  const texts = (name, index) => {
    const all = known.get(name);
    const n = all.length / (WIDTH * HEIGHT);
    const values = Array.from(all.subarray(n * index, n * index + n));
    const shown = n === 1 ? values.map((value) => format(value, name)) : values.map((value) => format(Number(value.toPrecision(3))));
    const parts = (text) => (described(name).names ? named(text) : [text]);
    const kind = described(name).names ? "named" : "number";
    return values.map((value, i) => element("data", { value, class: kind, title: shown[i] }, ...parts(shown[i])));
  };

  return {
    /** Adds the values of an array. */
    add(name, values) {
      known.set(name, values);
    },
    /** Shows a pixel; `field` is the map's field. Announces it to screen readers after
     * `prefix`, unless it is null. */
    update(x, y, field, prefix = null) {
      const place = `${fullPlace(x, 0)}, ${fullPlace(y, 1)}`;
      title.textContent = `Pixel ${place}`;
      title.title = "column and row from the top left";
      for (const [name, { row, cell }] of rows) {
        row.classList.toggle("shown", field.name === name);
        if (!known.has(name)) continue;
        const parts = texts(name, y * WIDTH + x).flatMap((part, i) => (i ? [" ", part] : [part]));
        if (name === "RGB") {
          const swatch = element("span", { class: "swatch" });
          const values = known.get(name).subarray(3 * (y * WIDTH + x));
          swatch.style.background = `rgb(${values[0]} ${values[1]} ${values[2]})`;
          parts.unshift(swatch);
        }
        cell.replaceChildren(...parts);
      }
      if (prefix !== null) {
        const value = rows.get(field.name).cell.textContent;
        announcement.textContent = `${prefix}Pixel ${place}: ${labelOf(field.key)} ${value}`;
      }
    },
  };
}

// All values of the pixel under the pointer.

/** Shows the pixel's values as they become known. */
function createProbe(section) {
  const body = section.querySelector("tbody");
  const title = section.querySelector("h2");
  const spoken = section.querySelector("[aria-live]");
  const rows = new Map();
  const known = new Map();
  for (const name of inOrder(about.arrays.map((array) => array.name))) {
    const cell = element("td", {}, "…");
    const { label, about: title } = described(name);
    const row = element("tr", { "data-array": name }, element("th", { scope: "row", title }, label), cell);
    rows.set(name, { row, cell });
    body.append(row);
  }

  /** The column and row in the rendering. */
  const fullPlace = (place, axis) =>
    Math.min(place * about.step + Math.floor(about.step / 2), about.full_size[axis] - 1);

  const texts = (name, index) => {
    const all = known.get(name);
    const n = all.length / (WIDTH * HEIGHT);
    const values = Array.from(all.subarray(n * index, n * index + n));
    const shown = n === 1 ? values.map((value) => format(value, name)) : values.map((value) => format(Number(value.toPrecision(3))));
    return values.map((value, i) => element("data", { value }, shown[i]));
  };

  return {
    /** Learns an array. */
    learn(name, values) {
      known.set(name, values);
    },
    /** Shows a pixel; `field` is that of the map. */
    update(x, y, field, byKey) {
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
      if (byKey) {
        const value = rows.get(field.name).cell.textContent;
        spoken.textContent = `Pixel ${place}: ${labelOf(field.key)} ${value}`;
      }
    },
  };
}

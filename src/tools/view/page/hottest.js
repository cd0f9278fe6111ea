// The most expensive pixels, and the commands that trace them.

/** Creates the list and its button. The button calls `onMark(field)` with a field that is
 * 1 at these pixels, or with null to unmark them; an entry calls `onShow(x, y)`. */
function createHottest(section, { onMark, onShow }) {
  const button = section.querySelector("button");
  const list = section.querySelector("ol");
  section.hidden = about.hottest.length === 0;

  const item = (array) => ({ x, y, value, index }) => {
    const place = element("button", { type: "button" }, `${x}, ${y}`);
    place.disabled = index === null;
    if (!place.disabled) place.addEventListener("click", () => onShow(index % WIDTH, Math.floor(index / WIDTH)));
    const { label } = described(array);
    const command = element("code", {}, `${about.trace} --pixel ${x},${y}`);
    return element("li", {}, place, ` ${label}: ${format(value, array)} `, command);
  };
  list.append(...about.hottest.flatMap(({ array, pixels }) => pixels.map(item(array))));

  const isHot = new Float32Array(WIDTH * HEIGHT);
  for (const { pixels } of about.hottest) {
    for (const { index } of pixels) if (index !== null) isHot[index] = 1;
  }
  button.addEventListener("click", () => {
    list.hidden = !list.hidden;
    button.setAttribute("aria-expanded", !list.hidden);
    onMark(list.hidden ? null : { key: "hottest", name: "hottest", values: isHot });
  });
}

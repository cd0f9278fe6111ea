// The table of the cost of each object and each material.

/** Most rows in the document. */
const MAX_ROWS = 500;
/** Columns that filter the rows; they are not shown. */
const CHOICES = ["kind", "charge", "ray_kind"];
/** Columns of text. */
const WORDS = [...CHOICES, "name"];

/** The header of a column; its values show the unit. */
const headed = (name) => name.replace("_ns", "").replaceAll("_", " ");

/** Creates the table; a click on a name calls `onPick(kind, id, name)`. */
async function createTable(section, { onPick }) {
  const placeholder = section.querySelector(".placeholder");
  if (!document.getElementById("objects-table")) {
    const flag = element("code", {}, "--also objects");
    placeholder.append("Render again with ", flag, " to see the cost of each object and each material.");
    return;
  }
  document.querySelector("main").classList.add("wide-table");
  const text = new TextDecoder().decode(await bytes("objects-table"));
  const { columns, rows } = JSON.parse(text);
  const column = (name) => columns.indexOf(name);
  const valueOf = (row, name) => (WORDS.includes(name) ? row[column(name)] : Number(row[column(name)]));
  // A share is shown beside its number, not in its own column.
  const shareOf = (name) => `${name}_share`;
  const isShare = (name) => columns.some((other) => name === shareOf(other));
  const shown = columns.filter((name) => !CHOICES.includes(name) && !isShare(name));
  const sort = { by: ["time_ns", "node_visits"].find((name) => shown.includes(name)) ?? shown[0], down: true };

  const choices = CHOICES.filter((name) => columns.includes(name)).map((name) => {
    const options = [...new Set(rows.map((row) => row[column(name)]))];
    const select = element("select", {}, ...options.map((option) => element("option", {}, option)));
    const label = element("label", {}, `${name.replaceAll("_", " ")} `, select);
    section.querySelector("form").append(label);
    select.addEventListener("change", draw);
    return { name, select };
  });

  const headers = shown.map((name) => {
    const button = element("button", { type: "button" }, headed(name));
    const header = element("th", { scope: "col", class: WORDS.includes(name) ? "" : "number" }, button);
    button.addEventListener("click", () => {
      sort.down = sort.by === name ? !sort.down : !WORDS.includes(name);
      sort.by = name;
      draw();
    });
    return header;
  });
  const body = element("tbody");
  section.querySelector("table").append(element("thead", {}, element("tr", {}, ...headers)), body);

  function cell(row, name) {
    if (name === "name") {
      const button = element("button", { type: "button", title: "mark its pixels" }, row[column("name")] || "unnamed");
      button.addEventListener("click", () => onPick(valueOf(row, "kind"), valueOf(row, "id"), row[column("name")]));
      return element("td", { class: "words" }, button);
    }
    const number = element("data", { value: row[column(name)] }, format(valueOf(row, name), name));
    const made = element("td", { class: "number" }, number);
    if (columns.includes(shareOf(name))) {
      const share = Number(row[column(shareOf(name))]);
      made.classList.add("share");
      made.style.setProperty("--share", `${100 * share}%`);
      made.append(" ", element("small", {}, percent(share)));
    }
    return made;
  }

  function compare(a, b) {
    const [x, y] = [valueOf(a, sort.by), valueOf(b, sort.by)];
    const order = typeof x === "string" ? x.localeCompare(y) : x - y;
    return sort.down ? -order : order;
  }

  function draw() {
    const chosen = rows.filter((row) => choices.every(({ name, select }) => row[column(name)] === select.value));
    chosen.sort(compare);
    shown.forEach((name, i) => {
      const order = name !== sort.by ? "none" : sort.down ? "descending" : "ascending";
      headers[i].setAttribute("aria-sort", order);
      const arrow = { none: "", ascending: " ↑", descending: " ↓" }[order];
      headers[i].firstChild.textContent = headed(name) + arrow;
    });
    const inDocument = chosen.slice(0, MAX_ROWS);
    body.replaceChildren(...inDocument.map((row) => element("tr", {}, ...shown.map((name) => cell(row, name)))));
    const n_left = chosen.length - inDocument.length;
    placeholder.textContent = n_left ? `${format(n_left)} more rows are in objects.csv.` : "";
  }
  draw();
}

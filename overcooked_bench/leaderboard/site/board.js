/* Sorts and filters the tables of the leaderboard; what is chosen stands in the address behind "#", so that a link
   keeps it. Rows hold what they are filtered by in data attributes, cells the number they are sorted by in data-v. */
"use strict";

(() => {
  const form = document.querySelector("form.filters");
  const tables = [...document.querySelectorAll("table.board")];
  const said = document.getElementById("said");
  const all = tables.flatMap((table) => [...table.tBodies[0].rows]);
  let sort = "";

  function number(cell) {
    return cell && cell.dataset.v !== undefined ? Number(cell.dataset.v) : -Infinity;
  }

  function shows(row) {
    const wants = (name) => form.elements[name].value;
    const same = ["status", "kind", "observation", "human"];
    const score = wants("layout") ? row.querySelector(`td[data-layout="${CSS.escape(wants("layout"))}"]`)
      : row.querySelector("td.score");
    return (!wants("name") || row.dataset.name.includes(wants("name").toLowerCase()))
      && same.every((name) => !wants(name) || row.dataset[name] === wants(name))
      && (!wants("steps") || (row.dataset.steps !== "" && Number(row.dataset.steps) <= Number(wants("steps"))))
      && (!wants("least") || number(score) >= Number(wants("least")));
  }

  function arrange(table) {
    const [key, way] = sort.split(":");
    const heads = [...table.tHead.rows[0].cells];
    const index = heads.findIndex((head) => head.dataset.key === key);
    heads.forEach((head) => head.removeAttribute("aria-sort"));
    const rows = [...table.tBodies[0].rows];
    const initial = (one, other) => one.dataset.place - other.dataset.place;
    if (index < 0) {
      rows.sort(initial);
    } else {
      const sign = way === "up" ? 1 : -1, words = "words" in heads[index].dataset;
      heads[index].setAttribute("aria-sort", way === "up" ? "ascending" : "descending");
      const values = new Map(rows.map((row) =>
        [row, words ? row.cells[index].textContent : number(row.cells[index])]));
      const order = (a, b) => (a < b ? -1 : a > b ? 1 : 0);
      rows.sort((one, other) => sign * order(values.get(one), values.get(other)) || initial(one, other));
    }
    table.tBodies[0].append(...rows);
  }

  function apply() {
    const layout = form.elements.layout.value;
    let shown = 0;
    for (const row of all) {
      row.hidden = !shows(row);
      shown += !row.hidden;
    }
    for (const cell of document.querySelectorAll("[data-layout]")) cell.hidden = cell.dataset.layout !== layout;
    tables.forEach(arrange);
    said.textContent = `${shown} of ${all.length} entries shown`;
  }

  function keep() {
    const chosen = new URLSearchParams();
    for (const field of form.elements) if (field.name && field.value) chosen.set(field.name, field.value);
    if (sort) chosen.set("sort", sort);
    history.replaceState(null, "", chosen.size ? `#${chosen}` : location.pathname);
  }

  function restore() {
    const chosen = new URLSearchParams(location.hash.slice(1));
    for (const field of form.elements) if (field.name) field.value = chosen.get(field.name) ?? "";
    sort = chosen.get("sort") ?? "";
    apply();
  }

  form.addEventListener("input", () => { apply(); keep(); });
  form.addEventListener("submit", (event) => event.preventDefault());
  form.addEventListener("reset", () => { sort = ""; setTimeout(() => { apply(); keep(); }); });
  document.addEventListener("click", (event) => {
    const button = event.target.closest("button.sort");
    if (!button) return;
    const key = button.closest("th").dataset.key;
    sort = sort === `${key}:down` ? `${key}:up` : sort === `${key}:up` ? "" : `${key}:down`;
    apply();
    keep();
  });
  addEventListener("hashchange", restore);
  restore();
})();

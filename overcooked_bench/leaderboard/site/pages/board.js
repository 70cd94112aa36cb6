/* Sorts and filters the tables of the leaderboard; what is chosen is in the address behind "#", so that a link keeps
   it. Rows hold what they are filtered by in data attributes, cells the number they are sorted by in data-v. */
"use strict";

(() => {
  const form = document.querySelector("form.filters");
  if (!form) return;
  form.closest("details").open = matchMedia("(min-width: 50rem)").matches || location.hash.length > 1;
  const tables = [...document.querySelectorAll("table.board")];
  const said = document.getElementById("said");
  const all = tables.flatMap((table) => [...table.tBodies[0].rows]);
  const place = new Map(all.map((row, index) => [row, index]));
  const name = new Map(all.map((row) => [row, row.cells[0].textContent.toLowerCase()]));
  const layouts = [...form.elements.layout.options].slice(1).map((option) => option.value);
  let sort = "";

  function number(cell) {
    return cell && cell.dataset.v !== undefined ? Number(cell.dataset.v) : -Infinity;
  }

  function wanted() {
    const value = Object.fromEntries([...form.elements].filter((field) => field.name)
      .map((field) => [field.name, field.type === "checkbox" ? (field.checked ? field.value : "") : field.value]));
    const on = layouts.indexOf(value.layout);
    return { ...value, name: value.name.toLowerCase(), cell: on < 0 ? "td.score" : `td.on${on}`, on };
  }

  function shows(row, want) {
    return name.get(row).includes(want.name)
      && ["status", "kind", "observation", "human"].every((key) => !want[key] || row.dataset[key] === want[key])
      && (!want.steps || (row.dataset.steps !== "" && Number(row.dataset.steps) <= Number(want.steps)))
      && (!want.least || number(row.querySelector(want.cell)) >= Number(want.least));
  }

  function arrange(table) {
    const [key, way] = sort.split(":");
    const heads = [...table.tHead.rows[0].cells];
    const index = heads.findIndex((head) => head.dataset.key === key);
    heads.forEach((head) => head.removeAttribute("aria-sort"));
    const rows = [...table.tBodies[0].rows];
    const initial = (one, other) => place.get(one) - place.get(other);
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
    if (rows.some((row, at) => row !== table.tBodies[0].rows[at])) table.tBodies[0].append(...rows);
  }

  function apply() {
    const want = wanted();
    let shown = 0;
    for (const row of all) {
      const hide = !shows(row, want);
      if (row.hidden !== hide) row.hidden = hide;
      shown += !hide;
    }
    for (const table of tables) {
      table.dataset.on = want.on;
      table.classList.toggle("few", !want.more);
      arrange(table);
    }
    said.textContent = `${shown} of ${all.length} entries shown`;
  }

  function keep() {
    const chosen = new URLSearchParams();
    for (const field of form.elements) {
      if (field.name && field.value && (field.type !== "checkbox" || field.checked)) chosen.set(field.name, field.value);
    }
    if (sort) chosen.set("sort", sort);
    history.replaceState(null, "", chosen.size ? `#${chosen}` : location.pathname + location.search);
  }

  function restore() {
    const chosen = new URLSearchParams(location.hash.slice(1));
    for (const field of form.elements) {
      if (field.type === "checkbox") field.checked = chosen.has(field.name);
      else if (field.name) field.value = chosen.get(field.name) ?? "";
    }
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

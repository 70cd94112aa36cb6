/* Draws ordered curves, one panel per layout: of the two entries that a form names, which the address keeps, or of the
   two in the page. */
"use strict";

(() => {
  const data = JSON.parse(document.getElementById("curves").textContent);
  const form = document.querySelector("form.filters"), panels = document.querySelector("div.panels");
  const colours = { first: "#0072B2", second: "#D55E00" }, wide = 300, high = 190, left = 34, low = 22;

  function element(name, attributes, text) {
    const made = document.createElementNS("http://www.w3.org/2000/svg", name);
    for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
    if (text !== undefined) made.textContent = text;
    return made;
  }

  function panel(layout, chosen) {
    const lines = chosen.map(([which, entry]) => [which, entry.name, entry.curves[layout]]).filter((one) => one[2]);
    const top = Math.max(20, ...lines.flatMap((one) => one[2]));
    const said = lines.map(([, name, values]) => `${name} from ${values[0]} to ${values.at(-1)} points`).join("; ");
    const svg = element("svg", { viewBox: `0 0 ${wide} ${high}`, role: "img", "aria-label": `${layout}: ${said}` });
    for (const share of [0, 0.5, 1]) {
      const y = high - low - share * (high - low - 10);
      svg.append(element("line", { x1: left, x2: wide, y1: y, y2: y, stroke: "var(--line)" }));
      const x = left - 4;
      svg.append(element("text", { x, y: y + 4, "text-anchor": "end", class: "tick" }, Math.round(share * top)));
    }
    svg.append(element("text", { x: left, y: high - 5, class: "tick" }, "worst partner"));
    svg.append(element("text", { x: wide, y: high - 5, "text-anchor": "end", class: "tick" }, "best"));
    for (const [which, , values] of lines) {
      const point = (value, index) => {
        const x = left + (index + 1) / values.length * (wide - left);
        return `${x.toFixed(1)},${(high - low - Math.max(0, value) / top * (high - low - 10)).toFixed(1)}`;
      };
      svg.append(element("polyline", { points: values.map(point).join(" "), fill: "none", stroke: colours[which],
        "stroke-width": 2, "stroke-dasharray": which === "second" ? "6 3" : "none" }));
    }
    const box = document.createElement("div"), title = document.createElement("h3");
    title.textContent = layout;
    box.append(title, svg);
    return box;
  }

  function draw(keys) {
    const chosen = Object.keys(colours).map((which, index) => [which, data.entries[keys[index]]])
      .filter((one) => one[1]);
    panels.replaceChildren(...data.layouts.map((layout) => panel(layout, chosen)));
  }

  function drawChosen() {
    draw([form.elements.first.value, form.elements.second.value]);
  }

  function restore() {
    const chosen = new URLSearchParams(location.hash.slice(1));
    form.elements.first.value = chosen.get("first") ?? data.keys[0];
    form.elements.second.value = chosen.get("second") ?? "";
    drawChosen();
  }

  if (!form) {
    draw(data.keys);
    return;
  }
  form.addEventListener("input", () => {
    drawChosen();
    const chosen = new URLSearchParams({ first: form.elements.first.value });
    if (form.elements.second.value) chosen.set("second", form.elements.second.value);
    history.replaceState(null, "", `#${chosen}`);
  });
  form.addEventListener("submit", (event) => event.preventDefault());
  addEventListener("hashchange", restore);
  restore();
})();

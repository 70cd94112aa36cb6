/* Plays a recorded game of an Overcooked kitchen in a page. One file, without a library.

   const kitchen = new Kitchen(element, game);   // fills the element: picture, buttons, keyboard
   kitchen.play(); kitchen.pause(); kitchen.step(-1); kitchen.show(120); kitchen.speed = 16;
   Kitchen.draw(canvas, game.grid, frame, 48);   // the picture alone, 48 pixels a tile
   Kitchen.fill(document);                       // a player in each <div data-kitchen>, of the JSON that is in it

   game  = {title, grid: ["XXPXX", ...], names: [seat 0, seat 1], frames: [frame, ...]}
           tiles: " " floor, X counter, P pot, O onions, T tomatoes, D dishes, S serving tile
   frame = [step, points, [chef, chef], [[x, y, thing], ...]]
   chef  = [x, y, facing, thing], facing 0 north, 1 south, 2 east, 3 west
   thing = "" nothing, "o" onion, "t" tomato, "d" dish, "s21" soup of 2 onions and 1 tomato; in a pot "s21" does not
           cook yet, "s21 7 20" has cooked for 7 of 20 steps

   rendering/viewer/games.py writes this form. The shapes are those of rendering/sprites.py. */
"use strict";

const Kitchen = (() => {
  const DIRECTIONS = [[0, -1], [0, 1], [1, 0], [-1, 0]], COLOURS = ["blue", "orange"];
  const CHEFS = ["#006bb2", "#f08a00"], DARK = ["#003b62", "#844c00"];
  const INK = "#302824", WHITE = "#fff", STOVE = "#3a4046", POT_INK = "#202428";

  /* Shapes in units of one tile, whose top left corner is at (left, top) tiles. */
  class Brush {
    constructor(context, tile, left, top) {
      Object.assign(this, { context, tile, left: left * tile, top: top * tile });
    }
    oval(x, y, rx, ry, fill, edge, width = 0.025) {
      if (edge) this.oval(x, y, rx, ry, edge);
      const { context: c, tile: t } = this, inside = edge ? width : 0;
      c.beginPath();
      c.ellipse(this.left + x * t, this.top + y * t, (rx - inside) * t, (ry - inside) * t, 0, 0, 2 * Math.PI);
      this.#fill(fill);
    }
    disc(x, y, r, ...look) { this.oval(x, y, r, r, ...look); }
    box(x0, y0, x1, y1, fill, radius = 0) {
      const { context: c, tile: t } = this;
      c.beginPath();
      c.roundRect(this.left + x0 * t, this.top + y0 * t, (x1 - x0) * t, (y1 - y0) * t, radius * t);
      this.#fill(fill);
    }
    shape(points, fill) { this.#path(points).#fill(fill); }
    line(points, colour, width) { this.#path(points).#stroke(colour, width, "round"); }
    arc(x, y, r, share, colour, width) {
      const { context: c, tile: t } = this;
      c.beginPath();
      c.arc(this.left + x * t, this.top + y * t, (r - width / 2) * t, -Math.PI / 2, (2 * share - 0.5) * Math.PI);
      this.#stroke(colour, width, "butt");
    }
    text(x, y, text, size, fill, edge) {
      const { context: c, tile: t } = this;
      Object.assign(c, { font: `500 ${size * t}px sans-serif`, textAlign: "center", textBaseline: "middle" });
      Object.assign(c, { fillStyle: fill, strokeStyle: edge, lineWidth: 0.18 * size * t, lineJoin: "round" });
      for (const write of ["strokeText", "fillText"]) c[write](text, this.left + x * t, this.top + y * t);
    }
    #path(points) {
      this.context.beginPath();
      points.forEach(([x, y]) => this.context.lineTo(this.left + x * this.tile, this.top + y * this.tile));
      return this;
    }
    #fill(colour) {
      this.context.fillStyle = colour;
      this.context.fill();
    }
    #stroke(strokeStyle, width, lineCap) {
      Object.assign(this.context, { strokeStyle, lineWidth: width * this.tile, lineCap, lineJoin: "round" });
      this.context.stroke();
    }
  }

  function onion(b, x, y, size) {
    const r = 0.43 * size, ink = "#804e0e";
    y += 0.07 * size;
    b.line([[x - 0.12 * r, y - 0.9 * r], [x - 0.16 * r, y - 1.35 * r]], ink, 0.24 * r);
    b.line([[x + 0.12 * r, y - 0.9 * r], [x + 0.22 * r, y - 1.3 * r]], ink, 0.2 * r);
    b.shape([[x - 0.62 * r, y - 0.37 * r], [x, y - 1.2 * r], [x + 0.62 * r, y - 0.37 * r]], ink);
    b.oval(x, y, 1.05 * r, r, "#f4be3e", ink, 0.13 * r);
    b.shape([[x - 0.5 * r, y - 0.6 * r], [x, y - r], [x + 0.5 * r, y - 0.6 * r]], "#f4be3e");
    b.oval(x - 0.34 * r, y + 0.02 * r, 0.2 * r, 0.52 * r, "#ffe28e");
    b.oval(x + 0.36 * r, y + 0.06 * r, 0.08 * r, 0.5 * r, ink);
  }

  function tomato(b, x, y, size) {
    const r = 0.45 * size, leaf = "#3a8438", star = [];
    y += 0.04 * size;
    b.oval(x, y, 1.08 * r, r, "#de342c", "#761212", 0.13 * r);
    b.oval(x - 0.45 * r, y + 0.1 * r, 0.16 * r, 0.3 * r, "#f88a78");
    for (let k = 0; k < 10; k++) {
      const reach = (k % 2 ? 0.2 : 0.62) * r, angle = (k / 5 - 0.5) * Math.PI;
      star.push([x + reach * Math.cos(angle), y - 0.58 * r + 0.72 * reach * Math.sin(angle)]);
    }
    b.shape(star, leaf);
    b.line([[x, y - 0.6 * r], [x + 0.08 * r, y - 1.12 * r]], leaf, 0.2 * r);
  }

  function dish(b, x, y, size) {
    b.disc(x, y, 0.5 * size, "#fafbfc", "#5c6a75", 0.055 * size);
    b.disc(x, y, 0.31 * size, "#dbe3e8");
  }

  /* "s21 7 20" -> {onions: 2, tomatoes: 1, tick: 7, of: 20}; tick -1 while it does not cook. */
  function soupOf(thing) {
    const [recipe, tick = -1, of = -1] = thing.split(" ");
    return { onions: +recipe[1], tomatoes: +recipe[2], tick: +tick, of: +of };
  }

  function liquid({ onions, tomatoes }) {
    const share = tomatoes / (onions + tomatoes);
    const mixed = [[217, 205], [142, 66], [44, 36]].map(([a, b]) => Math.round(a + share * (b - a)));
    return `rgb(${mixed})`;
  }

  const ingredients = ({ onions, tomatoes }) => [...Array(onions).fill(onion), ...Array(tomatoes).fill(tomato)];

  function marks(b, x, y, spread, size, soup) {
    const kinds = ingredients(soup);
    const places = [[[0, 0]], [[-0.9, 0], [0.9, 0]], [[0, -0.95], [-0.95, 0.65], [0.95, 0.65]]][kinds.length - 1];
    kinds.forEach((kind, k) => kind(b, x + places[k][0] * spread, y + places[k][1] * spread, size));
  }

  function thingAt(b, x, y, size, thing) {
    if (thing[0] !== "s") return ({ o: onion, t: tomato, d: dish })[thing](b, x, y, size);
    const soup = soupOf(thing);
    b.disc(x, y, 0.54 * size, "#fafbfc", INK, 0.06 * size);
    b.disc(x, y, 0.41 * size, liquid(soup));
    marks(b, x, y, 0.2 * size, 0.33 * size, soup);
  }

  function crate(b, kind) {
    b.box(0.09, 0.09, 0.91, 0.91, "#633f22", 0.08);
    b.box(0.13, 0.13, 0.87, 0.87, "#96683e", 0.05);
    b.box(0.19, 0.19, 0.81, 0.81, "#633f22", 0.03);
    for (const x of [0.13, 0.81]) for (const y of [0.13, 0.81]) b.box(x, y, x + 0.06, y + 0.06, "#b8895a", 0.02);
    for (const [x, y] of [[0.36, 0.34], [0.64, 0.34], [0.34, 0.62], [0.66, 0.62], [0.5, 0.49]]) kind(b, x, y, 0.36);
  }

  function hatch(b) {
    b.box(0.04, 0.04, 0.96, 0.96, "#78d0be", 0.1);
    b.box(0.08, 0.08, 0.92, 0.92, "#188c7a", 0.07);
    b.disc(0.5, 0.27, 0.075, WHITE);
    b.disc(0.5, 0.62, 0.3, WHITE);
    b.box(0.18, 0.625, 0.82, 0.93, "#188c7a");
    b.line([[0.2, 0.71], [0.8, 0.71]], WHITE, 0.09);
    b.line([[0.34, 0.55], [0.38, 0.46], [0.45, 0.4]], "#78d0be", 0.05);
  }

  function pot(b, thing) {
    const soup = soupOf(thing || "s00"), cooking = soup.tick >= 0 && soup.tick < soup.of;
    const ready = soup.of >= 0 && soup.tick >= soup.of;
    b.box(0.03, 0.03, 0.97, 0.97, ready ? "#0c6230" : POT_INK, 0.1);
    b.box(0.06, 0.06, 0.94, 0.94, ready ? "#60d67a" : STOVE, 0.08);
    if (cooking) {
      b.disc(0.5, 0.5, 0.46, "#181b1e");
      b.arc(0.5, 0.5, 0.46, soup.tick / soup.of, "#ffb020", 0.1);
    } else if (!ready) {
      b.disc(0.5, 0.5, 0.42, "#565e65");
      b.disc(0.5, 0.5, 0.39, STOVE);
    }
    for (const x of [0.1, 0.9]) {
      b.box(x - 0.06, 0.42, x + 0.06, 0.58, POT_INK, 0.04);
      b.box(x - 0.035, 0.445, x + 0.035, 0.555, "#b0bac1", 0.03);
    }
    b.disc(0.5, 0.5, 0.36, POT_INK);
    b.disc(0.5, 0.5, 0.335, "#b0bac1");
    b.disc(0.5, 0.5, 0.285, "#484f56");
    if (!thing) return;
    b.disc(0.5, 0.5, 0.285, cooking || ready ? liquid(soup) : "#e2d6b2");
    if (cooking) {
      const kinds = ingredients(soup), left = soup.of - soup.tick, small = b.tile < 32;
      kinds.forEach((kind, k) => kind(b, 0.5 + 0.16 * (k - (kinds.length - 1) / 2), small ? 0.76 : 0.7, 0.18));
      b.text(0.5, 0.44, left, (small ? 0.56 : 0.42) * (left < 100 ? 1 : 0.75), WHITE, INK);
    } else {
      marks(b, 0.5, 0.5, 0.135, 0.28, soup);
    }
    if (ready) {
      b.disc(0.79, 0.79, 0.18, WHITE);
      b.disc(0.79, 0.79, 0.15, "#0c6230");
      b.line([[0.72, 0.79], [0.77, 0.85], [0.86, 0.74]], WHITE, 0.045);
    }
  }

  function chef(b, seat, facing, holding) {
    const [fx, fy] = DIRECTIONS[facing], colour = CHEFS[seat], dark = DARK[seat];
    const at = (forward, aside) => [0.5 + (forward - 0.06) * fx - aside * fy, 0.5 + (forward - 0.06) * fy + aside * fx];
    const [x, y] = at(0, 0);
    b.disc(x, y + 0.05, 0.4, "#0000002d");
    for (const side of [-1, 1]) {
      const arm = [at(0.02, 0.29 * side), at(0.3, 0.2 * side)];
      for (const [ink, width] of [[dark, 0.19], [colour, 0.13]]) b.line(arm, ink, width);
      b.disc(...at(0.33, 0.19 * side), 0.09, "#fad4b0", INK);
    }
    b.oval(x, y, ...(fx ? [0.27, 0.4] : [0.4, 0.27]), colour, dark, 0.03);
    b.disc(...at(0.05, 0), 0.26, "#fad4b0", INK);
    for (const side of [-1, 1]) b.disc(...at(0.2, 0.11 * side), 0.05, INK);
    b.disc(...at(-0.08, 0), 0.235, colour, dark);
    for (let k = 0; k < 6; k++) {
      const angle = (Math.PI * k) / 3;
      b.disc(...at(-0.09 + 0.115 * Math.cos(angle), 0.115 * Math.sin(angle)), 0.1, WHITE, "#80868e", 0.02);
    }
    b.disc(...at(-0.09, 0), 0.14, WHITE);
    if (holding) thingAt(b, ...at(0.43, 0.1), 0.42, holding);
  }

  function tileOf(b, grid, x, y) {
    const tile = grid[y][x], thin = Math.max(1, Math.round(b.tile / 32)) / b.tile;
    if (tile === " ") {
      b.box(0, 0, 1, 1, (x + y) % 2 ? "#ede3d1" : "#f6efe2");
      if (grid[y][x - 1] !== " ") b.box(0, 0, thin, 1, "#d7cbb7");
      if (grid[y - 1]?.[x] !== " ") {
        b.box(0, 0, 1, 0.2, "#d7cbb7");
        b.box(0, 0, 1, 0.1, "#4f616d");
      }
      return;
    }
    b.box(0, 0, 1, 1, "#728693");
    b.box(thin, thin, 1 - thin, 1 - thin, "#7e93a0");
    b.box(0, 0, 1, thin, "#9cb0bb");
    if (tile === "O" || tile === "T") crate(b, tile === "O" ? onion : tomato);
    if (tile === "D") [0.58, 0.52, 0.46].forEach((height) => dish(b, 0.5, height, 0.74));
    if (tile === "S") hatch(b);
    if (tile === "P") pot(b, "");
  }

  function draw(canvas, grid, [, , chefs, things], tile) {
    const dense = window.devicePixelRatio || 1, width = grid[0].length, height = grid.length;
    const pixels = Math.round(tile * dense), context = canvas.getContext("2d");
    Object.assign(canvas, { width: width * pixels, height: height * pixels });
    Object.assign(canvas.style, { width: `${width * tile}px`, height: `${height * tile}px` });
    const brush = (x, y) => new Brush(context, pixels, x, y);
    grid.forEach((row, y) => [...row].forEach((_, x) => tileOf(brush(x, y), grid, x, y)));
    for (const [x, y, thing] of things) {
      const b = brush(x, y);
      if (grid[y][x] === "P") pot(b, thing);
      else {
        b.oval(0.5, 0.6, 0.3, 0.26, "#00000032");
        thingAt(b, 0.5, 0.5, 0.6, thing);
      }
    }
    chefs.forEach(([x, y, facing, thing], seat) => chef(brush(x, y), seat, facing, thing));
  }

  const SPEEDS = [1, 2, 4, 8, 16, 32, 64];
  const ICONS = {
    first: "M4 3h2v10H4zM13 3v10L7 8z", back: "M12 3v10L5 8z", play: "M4 2.5v11L14 8z",
    pause: "M4 3h3v10H4zM9 3h3v10H9z", forward: "M4 3v10l7-5z", last: "M10 3h2v10h-2zM3 3v10l6-5z",
  };
  const STYLE = `
    .kitchen:focus-visible { outline: 2px solid #0072b2; outline-offset: 4px; }
    .kitchen canvas { display: block; border-radius: 4px; }
    .kitchen .bar { display: flex; flex-wrap: wrap; gap: .3rem .4rem; align-items: center; margin-top: .5rem; }
    .kitchen button, .kitchen select { font: inherit; height: 2.25rem; color: inherit; background: var(--paper, Canvas);
      border: 1px solid var(--line, #8886); border-radius: 6px; cursor: pointer; }
    .kitchen button { width: 2.5rem; padding: 0; }
    .kitchen button:hover, .kitchen select:hover { border-color: currentColor; }
    .kitchen svg { width: 1rem; height: 1rem; fill: currentColor; vertical-align: middle; }
    .kitchen input { flex: 1 1 9rem; min-width: 6rem; accent-color: #0072b2; }
    .kitchen .said span { display: block; font-variant-numeric: tabular-nums; }
    .kitchen .said i { display: inline-block; width: .75em; height: .75em; border-radius: 50%; margin-right: .4em; }
    @media print { .kitchen .bar { display: none; } }`;

  function make(tag, attributes, ...children) {
    const element = document.createElement(tag);
    for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
    element.append(...children);
    return element;
  }

  function nameOf(thing) {
    if (thing[0] !== "s") return { "": "nothing", o: "an onion", t: "a tomato", d: "a dish" }[thing];
    const { onions, tomatoes } = soupOf(thing), parts = [];
    if (onions) parts.push(onions > 1 ? `${onions} onions` : "1 onion");
    if (tomatoes) parts.push(tomatoes > 1 ? `${tomatoes} tomatoes` : "1 tomato");
    return `a soup of ${parts.join(" and ")}`;
  }

  document.head.append(make("style", {}, STYLE));

  return class Kitchen {
    #timer = null;
    #speed = 8;

    constructor(element, game) {
      Object.assign(this, { element, game, index: 0, canvas: make("canvas", { role: "img" }) });
      const button = (icon, label, onclick) => {
        const made = Object.assign(make("button", { type: "button", "aria-label": label, title: label }), { onclick });
        made.innerHTML = `<svg viewBox="0 0 16 16" aria-hidden="true"><path d="${ICONS[icon]}"/></svg>`;
        return made;
      };
      const last = game.frames.length - 1;
      this.button = button("play", "Play", () => this.toggle());
      this.slider = make("input", { type: "range", min: 0, max: last, value: 0, "aria-label": "Step" });
      this.slider.oninput = () => this.show(+this.slider.value);
      const offered = SPEEDS.map((speed) => make("option", { value: speed }, `${speed} steps/s`));
      this.speeds = make("select", { "aria-label": "Speed", title: "Speed" }, ...offered);
      this.speeds.onchange = () => (this.speed = +this.speeds.value);
      this.bar = make("div", { class: "bar" },
        button("first", "First step", () => this.show(0)), button("back", "Step back", () => this.step(-1)),
        this.button, button("forward", "Step forward", () => this.step(1)),
        button("last", "Last step", () => this.show(last)), this.slider, this.speeds);
      this.said = make("p", { class: "said", "aria-live": "polite" });
      const keys = "Space plays and pauses, arrows step, + and - change the speed, Home and End go to the ends.";
      const spoken = { role: "group", tabindex: 0, "aria-label": `${game.title}. ${keys}` };
      for (const [name, value] of Object.entries(spoken)) element.setAttribute(name, value);
      element.classList.add("kitchen");
      element.replaceChildren(this.canvas, this.bar, this.said);
      element.addEventListener("keydown", (event) => this.#key(event));
      new ResizeObserver(() => this.#draw()).observe(element);
      this.speed = this.#speed;
      this.show(0);
    }

    get playing() { return this.#timer !== null; }
    get speed() { return this.#speed; }
    set speed(stepsPerSecond) {
      this.#speed = stepsPerSecond;
      this.speeds.value = stepsPerSecond;
      if (this.playing) this.#start();
    }

    play() {
      if (this.index === this.game.frames.length - 1) this.show(0);
      this.#start();
    }

    pause() {
      clearInterval(this.#timer);
      this.#timer = null;
      this.#label("play", "Play");
    }

    toggle() { return this.playing ? this.pause() : this.play(); }

    step(count) { this.pause(); this.show(this.index + count); }

    show(index) {
      const { frames, names } = this.game;
      this.index = Math.max(0, Math.min(index, frames.length - 1));
      const [step, points, chefs] = frames[this.index], end = frames[frames.length - 1][0];
      const now = `step ${step} of ${end}, ${points} points`;
      this.slider.value = this.index;
      this.slider.setAttribute("aria-valuetext", now);
      const holds = chefs.map(([, , , thing], seat) => `${names[seat]} (${COLOURS[seat]}) holds ${nameOf(thing)}`);
      this.canvas.setAttribute("aria-label", holds.join("; "));
      const spoken = chefs.map(([, , , thing], seat) => make("span", {},
        make("i", { style: `background: ${CHEFS[seat]}` }), make("b", {}, names[seat]), ` holds ${nameOf(thing)}`));
      this.said.replaceChildren(make("span", {}, now), ...spoken);
      this.#draw();
    }

    #start() {
      clearInterval(this.#timer);
      this.#timer = setInterval(() => {
        if (this.index === this.game.frames.length - 1 || !this.canvas.offsetParent) this.pause();
        else this.show(this.index + 1);
      }, 1000 / this.#speed);
      this.#label("pause", "Pause");
    }

    #label(icon, label) {
      this.button.querySelector("path").setAttribute("d", ICONS[icon]);
      for (const name of ["aria-label", "title"]) this.button.setAttribute(name, label);
      this.said.setAttribute("aria-live", this.playing ? "off" : "polite"); // not read out while it plays
    }

    #draw() {
      const columns = this.game.grid[0].length;
      const tile = Math.min(64, Math.floor(this.element.clientWidth / columns)); // 0 while it is folded away
      if (tile) draw(this.canvas, this.game.grid, this.game.frames[this.index], tile);
      this.bar.style.maxWidth = `${Math.max(tile * columns, 460)}px`;
    }

    #key(event) {
      const tag = event.target.tagName, arrows = tag !== "INPUT" && tag !== "SELECT";
      const faster = (by) => (this.speed = SPEEDS[SPEEDS.indexOf(this.speed) + by] ?? this.speed);
      const actions = {
        " ": tag !== "BUTTON" && tag !== "SELECT" && (() => this.toggle()),
        ArrowLeft: arrows && (() => this.step(-1)),
        ArrowRight: arrows && (() => this.step(1)),
        Home: arrows && (() => this.show(0)),
        End: arrows && (() => this.show(this.game.frames.length - 1)),
        "+": () => faster(1),
        "-": () => faster(-1),
      };
      const action = actions[event.key];
      if (!action || event.ctrlKey || event.altKey || event.metaKey) return;
      event.preventDefault();
      action();
    }

    static draw = draw;

    static fill(root) {
      for (const place of root.querySelectorAll("[data-kitchen]")) {
        const begin = () => new Kitchen(place, JSON.parse(place.firstElementChild.textContent));
        const folded = place.closest("details:not([open])");
        folded ? folded.addEventListener("toggle", begin, { once: true }) : begin();
      }
    }
  };
})();

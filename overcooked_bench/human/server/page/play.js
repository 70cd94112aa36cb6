/* The page of `overcooked-bench play`: shows a game that runs on the server, and sends keys to it. */
"use strict";

(() => {
  const $ = (id) => document.getElementById(id);
  const given = JSON.parse($("given").textContent), query = new URLSearchParams(location.search);
  const NAMES = ["blue", "orange"], COLOURS = ["#006bb2", "#f08a00"];
  const KEYS = {
    ArrowUp: 0, KeyW: 0, ArrowDown: 1, KeyS: 1, ArrowRight: 2, KeyD: 2, ArrowLeft: 3, KeyA: 3, Space: 5, KeyE: 5,
  };
  let socket, kitchen = null, last = null, wanted = null, late = 0, seconds = 0;

  /* One section at a time. */
  function show(name) {
    for (const section of document.querySelectorAll("section")) section.hidden = section.id !== name;
    if (name !== "game") kitchen = null;
  }
  function complain(text) {
    $("problem").textContent = text;
    $("problem").hidden = !text;
  }
  const send = (message) => socket.readyState === WebSocket.OPEN && socket.send(JSON.stringify(message));

  function make(tag, attributes, ...children) {
    const element = Object.assign(document.createElement(tag), attributes);
    element.append(...children);
    return element;
  }

  /* Consent */
  for (const place of document.querySelectorAll("[data-given]")) place.textContent = given[place.dataset.given];
  for (const place of document.querySelectorAll("[data-if]")) place.hidden = !given[place.dataset.if];
  for (const place of document.querySelectorAll("[data-if-not]")) place.hidden = given[place.dataset.ifNot];
  function answer(agree) {
    send({ type: "consent", agree });
    $("keeping").textContent = agree ? "Games that you finish are kept." : "Nothing of your games is kept.";
    if (given.study) return studied.enroll();
    if (!query.get("room")) return lobby();
    show("loading");
    send({ type: "join", room: query.get("room") });
  }
  $("agree").onclick = () => answer(true);
  $("about").textContent = given.study?.consent;
  $("refuse").onclick = $("enter").onclick = () => answer(false);

  /* Choice of a game */
  const chosen = () => given.layouts[$("layout").selectedIndex];
  function lobby() {
    show("lobby");
    preview();
  }
  function preview() {
    const { name, grid, starts } = chosen(), width = $("choice").clientWidth;
    const tile = Math.floor(Math.min(48, width / grid[0].length, 360 / grid.length));
    Kitchen.draw($("preview"), grid, [0, 0, starts.map(([x, y]) => [x, y, 0, ""]), []], tile);
    $("preview").setAttribute("aria-label", `The kitchen ${name}`);
  }
  function offer() {
    const { offered, refused, suggested } = chosen();
    for (const id of ["partner", "first", "second"]) {
      const before = $(id).value, groups = Object.entries(offered).map(([label, names]) =>
        make("optgroup", { label }, ...names.map((name) => make("option", { value: name }, name.split("/").pop()))));
      $(id).replaceChildren(...groups);
      const names = Object.values(offered).flat();
      $(id).value = names.includes(before) ? before : suggested;
    }
    const reasons = Object.entries(refused);
    $("refused").hidden = !reasons.length;
    $("refused").querySelector("summary").textContent = `Not offered in this kitchen: ${reasons.length}`;
    $("refused").querySelector("dl").replaceChildren(
      ...reasons.flatMap(([name, why]) => [make("dt", {}, name), make("dd", {}, why)]));
  }
  function suit() {
    for (const field of document.querySelectorAll("[data-mode]"))
      field.hidden = !field.dataset.mode.split(" ").includes($("mode").value);
  }
  if (!given.study) $("layout").append(...given.layouts.map(({ name }) => make("option", {}, name)));
  $("layout").onchange = () => (offer(), preview());
  $("mode").onchange = suit;
  $("choice").onsubmit = (event) => {
    event.preventDefault();
    const layout = chosen().name, mode = $("mode").value, seat = +$("seat").value;
    if (mode === "watch") begin({ type: "watch", layout, agents: [$("first").value, $("second").value] });
    else begin({ type: "begin", layout, seat, ...(mode === "agent" ? { partner: $("partner").value } : {}) });
  };
  function begin(message) {
    complain("");
    wanted = message;
    show("loading");
    send(message);
  }

  /* The game */
  function draw() {
    if (!kitchen) return;
    const columns = kitchen.grid[0].length, rows = kitchen.grid.length;
    const room = window.innerHeight * (window.innerWidth > 640 ? 0.62 : 0.45);
    const tile = Math.floor(Math.min(88, $("game").clientWidth / columns, room / rows));
    Kitchen.draw($("kitchen"), kitchen.grid, last, tile);
    const [step, points] = last, left = Math.ceil(((kitchen.horizon - step) * kitchen.pace) / 1000);
    $("state").textContent = `${points} points, ${left} s left`;
    $("kitchen").setAttribute("aria-label", `${kitchen.layout}, step ${step} of ${kitchen.horizon}, ${points} points`);
  }
  function showLatency(milliseconds) {
    const steps = late === 1 ? "1 step" : `${late} steps`;
    const lateness = late ? `; the agent's answer came too late in ${steps}, in which its chef stayed` : "";
    $("measured").textContent = `Latency ${Math.round(milliseconds)} ms, a step every ${kitchen.pace} ms${lateness}.`;
  }
  function count(left) {
    $("countdown").hidden = left <= 0;
    $("countdown").textContent = Math.ceil(left);
    if (left > 0 && kitchen) setTimeout(() => kitchen && count(left - 1), 1000 * Math.min(1, left));
  }
  const HEARD = {
    kitchen(message) {
      complain("");
      show("game");
      [kitchen, last, late] = [message, message.frame, 0];
      const watching = message.seat === null;
      $("who").replaceChildren(...message.names.map((name, seat) => make("span", {},
        Object.assign(make("i", {}), { style: `background: ${COLOURS[seat]}` }), `${NAMES[seat]}: ${name}`)));
      $("controls").hidden = !watching;
      $("pad").hidden = $("keys").hidden = watching;
      [$("take").value, $("step").disabled] = ["", true];
      pausing(false);
      $("measured").textContent = "";
      document.activeElement?.blur();
      draw();
      count(message.countdown);
      send({ type: "ping", at: performance.now() });
    },
    frame(message) {
      [last, late] = [message.frame, message.late];
      count(0);
      draw();
      const now = Math.floor((last[0] * kitchen.pace) / 2000);
      if (now !== seconds) send({ type: "ping", at: performance.now() });
      seconds = now;
    },
    pong: ({ at }) => kitchen && showLatency(performance.now() - at),
    waiting({ room }) {
      const link = new URL(location);
      link.searchParams.set("room", room);
      $("link").textContent = link.href;
      show("waiting");
    },
    end({ points, soups, kept, error }) {
      show("end");
      $("result").textContent = `${points} points, ${soups} soup${soups === 1 ? "" : "s"}`;
      $("saved").textContent = error ? `The game could not be kept: ${error}` : kept ? "The game was kept. Thank you."
        : "The game was not kept.";
      $("again").hidden = !wanted;
      $("result").focus();
    },
    error({ text }) {
      complain(text);
      if (!$("loading").hidden) given.study ? show("trial") : lobby();
    },
    left: lobby,
  };
  const studied = given.study && study({ send, show, make, complain });
  Object.assign(HEARD, studied?.heard);

  /* Keys: those that go down and up, on the keyboard and on the pad. */
  const plays = () => kitchen && (kitchen.seat !== null || $("take").value !== "");
  const down = (action) => plays() && send({ type: "press", action });
  const up = (action) => plays() && send({ type: "release", action });
  function onKey(event) {
    const action = KEYS[event.code], typing = ["SELECT", "INPUT"].includes(event.target.tagName);
    if (action === undefined || !plays() || typing || event.ctrlKey || event.altKey || event.metaKey) return;
    event.preventDefault();
    if (!event.repeat) (event.type === "keydown" ? down : up)(action);
  }
  addEventListener("keydown", onKey);
  addEventListener("keyup", onKey);
  addEventListener("blur", () => [0, 1, 2, 3].forEach(up));
  addEventListener("resize", () => (kitchen ? draw() : $("lobby").hidden || preview()));
  for (const button of $("pad").children) {
    const action = +button.dataset.action;
    button.onpointerdown = (event) => (event.preventDefault(), down(action));
    button.onpointerup = button.onpointercancel = button.onpointerleave = () => up(action);
  }

  /* Watching */
  function pausing(paused) {
    $("pause").setAttribute("aria-pressed", paused);
    $("pause").textContent = paused ? "Go on" : "Pause";
    $("step").disabled = !paused;
  }
  $("pause").onclick = () => {
    const paused = $("step").disabled;
    send({ type: "control", do: paused ? "pause" : "resume" });
    pausing(paused);
  };
  $("step").onclick = () => send({ type: "control", do: "step" });
  $("take").onchange = () => {
    const seat = $("take").value === "" ? null : +$("take").value;
    send({ type: "take", seat });
    $("keys").hidden = $("pad").hidden = seat === null;
    $("take").blur();
  };

  $("leave").onclick = $("give-up").onclick = () => send({ type: "leave" });
  $("again").onclick = () => begin(wanted);
  $("other").onclick = lobby;

  const scheme = location.protocol === "https:" ? "wss" : "ws";
  socket = new WebSocket(`${scheme}://${location.host}/socket?token=${encodeURIComponent(query.get("token") ?? "")}`);
  socket.onmessage = ({ data }) => {
    const message = JSON.parse(data);
    HEARD[message.type](message);
  };
  socket.onopen = () => show("consent");
  socket.onclose = () => {
    show("");
    complain("The connection to the server is lost. Reload the page to go on; games that were finished are safe.");
  };
  if (!given.study) offer(), suit();
  if (given.seat !== null) $("seat").value = given.seat;
})();

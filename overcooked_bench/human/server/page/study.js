/* The pages of a study: what comes next, the questions after a game, thanks. */
"use strict";

const study = ({ send, show, make, complain }) => {
  const $ = (id) => document.getElementById(id), key = `overcooked-bench study ${location.host}`;

  /* Drawn once per browser tab, so that a page that is loaded again goes on where it was. */
  function code() {
    const drawn = () => [...crypto.getRandomValues(new Uint8Array(8))].map((b) => b.toString(16).padStart(2, "0")).join("");
    const kept = sessionStorage.getItem(key) ?? drawn();
    sessionStorage.setItem(key, kept);
    return kept;
  }
  function ask(name, { text, low, high, points }) {
    const numbers = [...Array(points).keys()].map((k) => make("label", {},
      make("input", { type: "radio", name, value: k + 1, required: true }), make("span", {}, k + 1)));
    return make("fieldset", {}, make("legend", {}, text), make("div", { className: "scale" },
      make("span", {}, low), ...numbers, make("span", {}, high)));
  }
  function headed(section, text) {
    show(section);
    const title = $(section).querySelector("h2");
    if (text) title.textContent = text;
    title.focus();
  }
  $("next").onclick = () => {
    complain("");
    show("loading");
    send({ type: "next" });
  };
  $("asked").onsubmit = (event) => {
    event.preventDefault();
    const answers = Object.fromEntries([...new FormData($("asked"))].map(([name, value]) => [name, +value]));
    send({ type: "answers", answers });
  };
  return {
    enroll: () => send({ type: "enroll", code: code() }),
    heard: {
      trial({ number, of, partner }) {
        headed("trial", `Game ${number} of ${of}`);
        $("next-partner").textContent = partner;
      },
      questions({ partner, questions }) {
        $("asked").firstElementChild.replaceChildren(...Object.entries(questions).map(([name, q]) => ask(name, q)));
        headed("questions", `About ${partner}`);
        $("score").textContent = "";
      },
      thanks({ code }) {
        $("code").textContent = code;
        headed("thanks");
      },
      end({ points, soups, error }) {
        $("score").textContent = `Together you had ${points} points, ${soups} soup${soups === 1 ? "" : "s"}.`;
        if (!error) return;
        complain(`The game could not be kept: ${error}`);
        show("trial");
      },
      left: () => show("trial"),
    },
  };
};

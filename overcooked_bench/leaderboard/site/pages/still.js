/* Draws the kitchen of a page's JSON without a game around it. */
"use strict";

for (const data of document.querySelectorAll("script.still")) {
  const game = JSON.parse(data.textContent);
  Kitchen.draw(data.previousElementSibling, game.grid, game.frames[0], 64);
}

"""Games in a page: `kitchen.js`, which draws and plays them, and what it is given."""

// Tables of a report: a click on a column's title sorts by it, a second one the other way round.
"use strict";

// What a cell is sorted by: its number where it has one, after all numbers its text.
function keyOf(row, column) {
  const cell = row.cells[column];
  const value = Number.parseFloat(cell.dataset.value);
  return Number.isNaN(value) ? cell.textContent : value;
}

// Numbers come before texts either way round.
function compare(a, b, turn) {
  if (typeof a === typeof b)
    return turn * (typeof a === "number" ? a - b : a.localeCompare(b));
  return typeof a === "number" ? -1 : 1;
}

function sortTable(table, column) {
  const titles = table.tHead.rows[0].cells;
  const down = titles[column].getAttribute("aria-sort") === "ascending";
  const body = table.tBodies[0];
  const rows = Array.from(body.rows);
  rows.sort((a, b) => compare(keyOf(a, column), keyOf(b, column), down ? -1 : 1));
  for (const title of titles)
    title.removeAttribute("aria-sort");
  titles[column].setAttribute("aria-sort", down ? "descending" : "ascending");
  body.append(...rows);
}

for (const table of document.querySelectorAll("table.sortable")) {
  Array.from(table.tHead.rows[0].cells).forEach((title, column) => {
    const button = document.createElement("button");
    button.type = "button";
    button.append(...title.childNodes);
    title.append(button);
    button.addEventListener("click", () => sortTable(table, column));
  });
}

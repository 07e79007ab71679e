"use strict";
/* On paper: what is folded is opened, and a table wider than a page is laid out in strips. */
(() => {
  const MOST_COLUMNS = 8;  // of results on a page: names of figures are long
  let folded = [], strips = [];

  function cell(kind, text, scope) {
    const made = document.createElement(kind);
    made.textContent = text;
    if (scope) made.scope = scope;
    return made;
  }
  function strip(caption, heads, rows) {
    const made = document.createElement("table");
    made.className = "strip";
    made.createCaption().textContent = caption;
    made.createTHead().insertRow().append(...heads.map((head) => cell("th", head, "col")));
    const body = made.createTBody();
    for (const row of rows) body.insertRow().append(...row.map((text) => cell("td", text)));
    return made;
  }

  /* The first column stands in every strip; what all rows have alike is said once. */
  function laid_out(table) {
    const heads = [...table.tHead.rows[0].cells].map((head) => head.textContent);
    const rows = [...table.tBodies[0].rows].filter((row) => !row.hidden)
      .map((row) => [...row.cells].map((its) => its.textContent));
    const same = [], differ = [];
    for (let column = 1; column < heads.length; column++) {
      const alike = rows.length > 1 && rows.every((row) => row[column] === rows[0][column]);
      (alike ? same : differ).push(column);
    }
    const made = [], room = MOST_COLUMNS - 1;
    for (let at = 0; at < differ.length; at += room) {
      const columns = [0, ...differ.slice(at, at + room)];
      made.push(strip(`Results, columns ${at + 1} to ${at + columns.length - 1} of ${differ.length}`,
        columns.map((column) => heads[column]), rows.map((row) => columns.map((column) => row[column]))));
    }
    const said = same.filter((column) => rows[0][column] !== "");
    if (said.length) {
      made.push(strip("The same in every row", ["column", "value"],
        said.map((column) => [heads[column], rows[0][column]])));
    }
    return made;
  }

  addEventListener("beforeprint", () => {
    folded = [...document.querySelectorAll("details:not([open])")];
    for (const part of folded) part.open = true;
    for (const table of document.querySelectorAll("table.rows")) {
      if (table.tHead.rows[0].cells.length <= MOST_COLUMNS) continue;
      const made = laid_out(table);
      table.classList.add("in-strips");
      table.after(...made);
      strips.push(...made);
    }
  });
  addEventListener("afterprint", () => {
    for (const part of folded) part.open = false;
    for (const made of strips) made.remove();
    for (const table of document.querySelectorAll("table.in-strips")) table.classList.remove("in-strips");
    folded = [];
    strips = [];
  });
})();

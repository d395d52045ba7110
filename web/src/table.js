// The tables of the page are the data of its charts: a chart shows numbers that stand in a table, and no others.

/** The cells of a table by its id; null if there is no such table. A number stands in the attribute data-v. */
export function readTable(id) {
  const table = document.getElementById(`table-${id}`);
  if (!table) return null;
  const columns = [...table.tHead.rows[0].cells].map((th) => (th.firstChild?.textContent ?? '').trim());
  const rows = [...table.tBodies[0].rows].map((tr) =>
    [...tr.cells].map((td) => (td.dataset.v === undefined ? td.textContent : Number(td.dataset.v))));
  return {columns, rows, column: (name) => columns.indexOf(name)};
}

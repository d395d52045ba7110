// The table of a sweep's points: it sorts, it filters, and a click on a point tells how its own page is made.

const cellValue = (cell) => (cell.dataset.v === undefined ? cell.textContent : Number(cell.dataset.v));
const kConditions = {
  '<=': (a, b) => a <= b, '>=': (a, b) => a >= b, '!=': (a, b) => a !== b, '<': (a, b) => a < b, '>': (a, b) => a > b,
  '=': (a, b) => a === b,
};

/** A test of a row's values: words that must occur, and conditions such as cycles<=5000, all of which must hold. */
export function filterOf(text, columns) {
  const tests = text.trim().split(/\s+/).filter(Boolean).map((word) => {
    const parts = word.match(/^([^<>=!]+)(<=|>=|!=|<|>|=)(.+)$/);
    const column = parts ? columns.indexOf(parts[1]) : -1;
    if (column < 0) return (row) => row.some((value) => String(value).toLowerCase().includes(word.toLowerCase()));
    const wanted = parts[3].trim() !== '' && Number.isFinite(Number(parts[3])) ? Number(parts[3]) : parts[3];
    return (row) => typeof row[column] === typeof wanted && kConditions[parts[2]](row[column], wanted);
  });
  return (row) => tests.every((test) => test(row));
}

function sortable(table) {
  const head = [...table.tHead.rows[0].cells];
  head.forEach((th, c) => {
    const button = document.createElement('button');
    button.type = 'button';
    button.textContent = th.textContent;
    th.replaceChildren(button);
    button.addEventListener('click', () => {
      const up = th.getAttribute('aria-sort') !== 'ascending';
      for (const other of head) other.removeAttribute('aria-sort');
      th.setAttribute('aria-sort', up ? 'ascending' : 'descending');
      const rows = [...table.tBodies[0].rows].map((tr) => ({tr, value: cellValue(tr.cells[c])}));
      rows.sort((a, b) => {
        const numbers = (typeof a.value === 'number') - (typeof b.value === 'number');
        if (numbers) return -numbers;  // rows without a number last, in both orders
        const order = typeof a.value === 'number' ? a.value - b.value : a.value.localeCompare(b.value);
        return up ? order : -order;
      });
      table.tBodies[0].append(...rows.map(({tr}) => tr));
    });
  });
}

function filterable(table, columns) {
  const row = document.createElement('p');
  const label = document.createElement('label');
  const input = document.createElement('input');
  const count = document.createElement('output');
  row.className = 'control';
  Object.assign(input, {type: 'search', id: 'points-filter', placeholder: `${columns[2]}=4 done`});
  label.append('Show points with ', input);
  row.append(label, count);
  const apply = () => {
    const passes = filterOf(input.value, columns);
    let shown = 0;
    for (const tr of table.tBodies[0].rows) {
      tr.hidden = !passes([...tr.cells].map(cellValue));
      shown += !tr.hidden;
    }
    count.textContent = `${shown} of ${table.tBodies[0].rows.length} points`;
  };
  input.addEventListener('input', apply);
  apply();
  return row;
}

/** Makes the table lively, if this is the page of a sweep. */
export function sweepTable({sweep}) {
  const table = document.getElementById('table-points');
  if (!sweep || !table) return;
  const columns = [...table.tHead.rows[0].cells].map((th) => th.textContent);
  const folded = table.closest('details');
  if (folded) folded.open = true;
  const panel = document.createElement('div');
  panel.className = 'notice';
  panel.id = 'point';
  panel.setAttribute('aria-live', 'polite');
  panel.textContent = 'Choose a point in a plot or in the table: its own page is made on demand.';
  const place = folded ?? table.parentElement;
  place.before(panel, filterable(table, columns));
  sortable(table);

  const show = (point) => {
    const command = document.createElement('code');
    command.textContent = `carousel report ${/^[\w./-]+$/.test(sweep.folder) ? sweep.folder : `'${sweep.folder.replaceAll("'", "'\\''")}'`} --point ${point}`;
    const link = document.createElement('a');
    link.href = `points/${point}.html`;
    link.textContent = `points/${point}.html`;
    panel.replaceChildren('The command ', command, ' writes the page of this point, ', link, '.');
  };
  for (const tr of table.tBodies[0].rows) {
    const name = tr.cells[0], point = name.textContent;
    tr.id = `point-${point}`;
    const button = document.createElement('button');
    button.type = 'button';
    button.textContent = point;
    name.replaceChildren(button);
    button.addEventListener('click', () => show(point));
  }
  addEventListener('carousel-point', ({detail}) => {
    show(detail);
    panel.scrollIntoView({block: 'nearest'});
  });
}

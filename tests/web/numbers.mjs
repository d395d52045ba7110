// Numbers that a page must show, derived from report.json without the program that made the page.

const near = (a, b) => Math.abs(a - b) <= 1e-9 * Math.max(1, Math.abs(a), Math.abs(b));

/** Differences between the tables of a page, {id: {columns, rows}}, and the report, a line each. */
export function wrongTables(tables, report) {
  const wrong = [];
  const check = (id, row, column, expected) => {
    const table = tables[id];
    if (!table) return wrong.push(`table ${id} is missing`);
    const shown = table.rows[row]?.[table.columns.indexOf(column)];
    if (typeof expected === 'number' ? !near(shown, expected) : shown !== expected)
      wrong.push(`table ${id}, row ${row}, ${column}: shows ${shown}, report.json has ${expected}`);
  };
  const cycles = report.engine.cycles;
  report.resources?.forEach((r, i) => {
    check('resources', i, 'resource', r.resource);
    for (const key of ['rays_completed', 'rays_tested', 'packets_issued', 'box_tests', 'triangle_tests'])
      check('resources', i, key.replaceAll('_', ' '), r[key]);
    if (!r.units) return;
    const banks = Object.values(r.units).filter((u) => typeof u === 'object');
    check('resources', i, 'busiest unit', Math.max(...banks.map((u) => u.busy)) / cycles);
    check('cycles-by-resource', i, 'waits for memory', r.units.box.memory / cycles);
    check('cycles-by-resource', i, 'nothing to do', r.units.box.idle / cycles);
  });
  report.links?.forEach((l, i) => {
    check('links', i, 'from', l.from);
    check('links', i, 'to', l.to);
    check('links', i, 'packets', l.packets);
    if (l.utilisation !== undefined) check('links', i, 'use', l.utilisation);
  });
  const sent = (report.bytes ?? []).filter((b) => b.bytes > 0).sort((a, b) => b.bytes - a.bytes);
  sent.forEach((b, i) => {
    check('bytes-table', i, 'what', b.what);
    check('bytes-table', i, 'bytes', b.bytes);
  });
  report.bottleneck?.gains.forEach((g, i) => {
    check('gains', i, 'gain', g.gain);
    check('gains', i, 'high', g.high);
  });
  (report.packets?.latency ?? report.traffic?.latency)?.quantiles.forEach((q, i) => check('latency-table', i, 'latency not exceeded', q.cycles));
  for (const id of ['cycles-by-part', 'cycles-by-resource'])
    tables[id]?.rows.forEach((row) => {
      const sum = row.slice(1).reduce((a, b) => a + b, 0);
      if (!near(sum, 1)) wrong.push(`table ${id}: ${row[0]} adds up to ${sum}`);
    });
  report.time_series?.rows.forEach((row, i) => check('series-table', i, 'greatest', Math.max(...row.values)));
  return wrong;
}

/** Differences between the charts' data, {id: option}, and the report. */
export function wrongCharts(charts, report) {
  const wrong = [];
  const same = (name, shown, expected) => {
    if (shown.length !== expected.length || !shown.every((v, i) => Math.abs(v - expected[i]) <= 1e-6 * Math.max(1, Math.abs(v))))
      wrong.push(`${name}: draws ${JSON.stringify(shown).slice(0, 200)}, report.json has ${JSON.stringify(expected).slice(0, 200)}`);
  };
  const machine = charts['fig-machine'];
  if (report.links?.[0]?.utilisation !== undefined) same('links of the machine', machine.links, report.links.map((l) => l.utilisation));
  if (report.resources && machine.nodes.filter((n) => n !== null).length !== report.resources.length)
    wrong.push('the machine has another number of resources');
  const sent = (report.bytes ?? []).filter((b) => b.bytes > 0).map((b) => b.bytes).sort((a, b) => b - a);
  if (sent.length) same('bytes', charts['fig-bytes'].series[0], sent);
  if (report.resources?.[0]?.units)
    same('cycles of box units', charts['fig-cycles-each'].series[0], report.resources.map((r) => r.units.box.busy / report.engine.cycles));
  const curves = Object.entries(charts).filter(([id]) => /^fig-time-\d/.test(id)).map(([, chart]) => chart);
  for (const row of report.time_series?.rows.filter((r) => r.part === 'machine') ?? []) {
    const chart = curves.find((c) => c.names.includes(row.quantity));
    if (!chart) wrong.push(`no chart has the curve of ${row.quantity}`);
    else same(`curve of ${row.quantity}`, chart.series[chart.names.indexOf(row.quantity)].map(([, v]) => v), row.values);
  }
  return wrong;
}

// Numbers that the page of a run must show, derived from report.json without the program that made the page.

export const near = (a, b) => Math.abs(a - b) <= 1e-9 * Math.max(1, Math.abs(a), Math.abs(b));

/** The resources that have units: packet processes that serve others stand behind them. */
function testing(report) {
  const processes = (report.config?.topology?.nodes ?? []).filter((n) => n.kind === 'packet_process' && n.serves);
  return report.resources.length - processes.reduce((sum, n) => sum + (n.count > 0 ? n.count : 1), 0);
}

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
    if (!r.units || i >= testing(report)) return;
    const banks = Object.values(r.units).filter((u) => typeof u === 'object' && u.busy !== undefined);
    check('resources', i, 'busiest unit', Math.max(...banks.map((u) => u.busy)) / cycles);
    if (report.resources.length < 2) return;
    check('cycles-by-resource', i, 'waits for memory', r.units.box.memory / cycles);
    check('cycles-by-resource', i, 'nothing to do', r.units.box.idle / cycles);
    const fill = r.units.unit_fill?.box ?? 1;
    check('cycles-by-resource', i, 'working', fill * r.units.box.busy / cycles);
    check('cycles-by-resource', i, 'places left empty', (1 - fill) * r.units.box.busy / cycles);
    check('cycles-by-resource', i, 'other units work', r.units.box.other_units / cycles);
    check('cycles-by-resource', i, 'waits for its pipelines', r.units.box.latency / cycles);
    check('cycles-by-resource', i, 'no test under way', r.units.box.passing / cycles);
  });
  report.links?.forEach((l, i) => {
    check('links', i, 'from', l.from);
    check('links', i, 'to', l.to);
    check('links', i, 'packets', l.packets);
    if (l.utilisation !== undefined) check('links', i, 'use', l.utilisation);
  });
  report.ranks?.forEach((r, i) => {
    for (const key of ['rank', 'resources', 'rays_shaded', 'waiting']) check('ranks', i, key.replaceAll('_', ' '), r[key]);
  });
  report.rank_links?.forEach((l, i) => {
    for (const key of ['from', 'to', 'messages', 'bytes', 'packets_per_message', 'held', 'full'])
      check('rank_links', i, key.replaceAll('_', ' '), l[key]);
  });
  const sent = (report.bytes ?? []).filter((b) => b.bytes > 0).sort((a, b) => b.bytes - a.bytes);
  sent.forEach((b, i) => {
    check('bytes-table', i, 'what', b.what);
    check('bytes-table', i, 'bytes', b.bytes);
  });
  const by = (id, list, keys, titles = {}) => list?.forEach((item, i) => {
    for (const key of keys) check(id, i, titles[key] ?? key.replaceAll('_', ' '), item[key]);
  });
  by('node-depths', report.nodes?.by_depth,
    ['depth', 'inner_nodes', 'leaves', 'visits', 'rays', 'box_tests', 'triangle_tests', 'children_hit', 'misses', 'rays_per_visit']);
  by('ray-bounces', report.rays.by_bounce, ['bounce', 'rays', 'escaped', 'hit', 'absorbed', 'shadow', 'lit', 'occluded']);
  by('residence', report.rays.residence?.classes, ['count'], {count: 'rays'});
  by('collection-ages', report.collections?.age?.classes, ['count'], {count: 'packets'});
  const baseline = report.tests?.depth_first;
  tables['tests-table']?.rows.forEach((row, i) => {
    const key = row[0].replaceAll(' ', '_');
    check('tests-table', i, 'this machine', report.tests[key].per_ray);
    if (baseline?.[key]) check('tests-table', i, 'depth first', baseline[key].per_ray);
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
  if (machine && report.links?.[0]?.utilisation !== undefined) same('links of the machine', machine.links, report.links.map((l) => l.utilisation));
  if (report.resources && machine && machine.nodes.filter((n) => n !== null).length !== testing(report))
    wrong.push('the machine has another number of resources');
  const sent = (report.bytes ?? []).filter((b) => b.bytes > 0).map((b) => b.bytes).sort((a, b) => b - a);
  if (sent.length) same('bytes', charts['fig-bytes'].series[0], sent);
  if (report.resources?.[0]?.units && report.resources.length > 1)
    same('cycles of box units', charts['fig-cycles-each'].series[0], report.resources.slice(0, testing(report)).map((r) => (r.units.unit_fill?.box ?? 1) * r.units.box.busy / report.engine.cycles));
  const rows = report.rays.by_bounce?.length ? report.rays.by_bounce : null;
  if (rows) {
    const sum = (...keys) => rows.reduce((total, row) => keys.reduce((t, key) => t + row[key], total), 0);
    const links = charts['fig-rays'].flow;
    const into = (place) => links.filter((l) => l.to === place).reduce((total, l) => total + l.rays, 0);
    for (const [place, rays] of [['escaped', sum('escaped')], ['absorbed', sum('absorbed')], ['occluded', sum('occluded')],
      ['reached a light', sum('lit')], ['shadow rays', sum('shadow') - sum('passed')], ['bounce 1', rows[1]?.rays ?? 0]])
      if (into(place) !== rays) wrong.push(`flow to ${place}: draws ${into(place)}, report.json has ${rays}`);
  }
  const depths = report.nodes?.by_depth;
  if (depths) {
    const drawn = charts['fig-node-depths'].series[0].map(([, , , value]) => value);
    for (const key of ['visits', 'rays', 'box_tests'])
      for (const row of depths) if (!drawn.includes(row[key])) wrong.push(`heat map by depth lacks ${key} ${row[key]}`);
  }
  for (const [id, list] of [['fig-residence', report.rays.residence?.classes], ['fig-collection-ages', report.collections?.age?.classes]])
    if (list?.length) same(id, charts[id].series[0], list.map((c) => c.count));
  if (report.tests?.depth_first)
    same('tests', charts['fig-tests'].series[0].slice(0, 1), [report.tests.box.per_ray]);
  const curves = Object.entries(charts).filter(([id]) => /^fig-(time-\d|energy-time)/.test(id)).map(([, chart]) => chart);
  for (const row of report.time_series?.rows.filter((r) => r.part === 'machine') ?? []) {
    const chart = curves.find((c) => c.names.includes(row.quantity));
    if (!chart) wrong.push(`no chart has the curve of ${row.quantity}`);
    else same(`curve of ${row.quantity}`, chart.series[chart.names.indexOf(row.quantity)].map(([, v]) => v), row.values);
  }
  return wrong;
}

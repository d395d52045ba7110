// Numbers that the pages of accuracy, stress, sweep, follow and compare must show, derived from their JSON.
import {near} from './numbers.mjs';

/** The value at a path such as `ns_per_ray.median`. */
const at = (object, path) => path.split('.').reduce((value, key) => value?.[key], object);

// By command: tables, each with its list in the JSON, and pairs of a column's title and a path in an item.
const same = (...keys) => keys.map((key) => [key.replaceAll(/[_.]/g, ' '), key]);
const lists = {
  accuracy: (json) => [
    ['levels', json.levels, same('ns_per_ray.median', 'ns_per_ray.most', 'scene.missed', 'modelled_cycles_per_ray')],
    ['levels-on-hardware', json.levels, same('tester_limited_cycles_per_ray', 'unit_area_over_default')],
    ['sampling', json.sampling.rows, same('rmse', 'samples')],
  ],
  stress: (json) => [
    ['queues', json.rows, same('rate_median', 'rate_least', 'rate_most', 'messages', 'message_bytes')],
    ['ring', json.ring, same('rate_median', 'depth', 'occupancy_mean')],
  ],
  follow: (json) => [
    ['stages', json.stages, same('length', 'share', 'times')],
    ['spans', json.spans, same('begin', 'length', 'stage', 'part')],
    ['tests', json.tests, same('at', 'resource', 'shapes')],
  ],
  sweep: (json) => [['points', json.points, json.results.map((name) => [name, `results.${name}`])]],
  compare: (json) => [
    ...json.sections.map((section, i) => [`section-${i}`, section.rows,
      json.runs.map((_, r) => [String.fromCharCode(65 + r), `values.${r}`])]),
    ['configuration', json.configuration, json.runs.map((_, r) => [String.fromCharCode(65 + r), `values.${r}`])],
  ],
};

/** Differences between a page's tables and charts and the JSON, a line each. */
export function wrongStudy(command, {tables, charts}, json) {
  const wrong = [];
  for (const [id, list, columns] of lists[command](json)) {
    if (!list?.length) continue;
    const table = tables[id];
    if (!table || table.rows.length !== list.length) {
      wrong.push(`table ${id}: ${table?.rows.length ?? 'no'} rows, the JSON has ${list.length}`);
      continue;
    }
    for (const [title, path] of columns)
      list.forEach((item, i) => {
        const expected = at(item, path) ?? '–', shown = table.rows[i][table.columns.indexOf(title)];
        if (typeof expected === 'number' ? !near(shown, expected) : String(shown) !== String(expected))
          wrong.push(`table ${id}, row ${i}, ${title}: shows ${shown}, the JSON has ${expected}`);
      });
  }
  const drawn = (id, expected, series = 0) => {
    const values = charts[id]?.series[series];
    if (!values || values.length !== expected.length || !values.every((v, i) => near(v, expected[i])))
      wrong.push(`${id}: draws ${JSON.stringify(values)?.slice(0, 200)}, the JSON has ${JSON.stringify(expected).slice(0, 200)}`);
  };
  if (command === 'accuracy') {
    charts['fig-levels'].series[0] = charts['fig-levels'].series[0].map(([x]) => x);
    drawn('fig-levels', json.levels.map((l) => l.ns_per_ray.median));
  }
  if (command === 'stress') drawn('fig-queues', json.rows.map((r) => r.rate_median));
  if (command === 'follow') drawn('fig-stages', json.stages.map((s) => s.length));
  if (command === 'compare')
    json.sections.forEach((section, i) => {
      const rows = section.rows.filter((r) => r.unit !== 'share');
      if (!rows.length) return section.rows.length && drawn(`fig-section-${i}`, section.rows.map((r) => r.values[0] ?? 0));
      const ratios = rows.filter((r) => r.ratios.slice(1).some((v) => v > 0));
      if (ratios.length && json.runs.length === 2)
        drawn(`fig-section-${i}`, ratios.map((r) => Math.max(-8, Math.min(8, Math.log2(r.ratios[1])))));
    });
  return wrong;
}

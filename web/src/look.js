// Colours and texts that all charts share.

/** The page's colours as they are now, light or dark. */
export function look() {
  const style = getComputedStyle(document.documentElement);
  const colour = (name) => style.getPropertyValue(`--${name}`).trim();
  return {page: colour('page'), ink: colour('ink'), soft: colour('soft'), line: colour('line'), panel: colour('panel'),
    link: colour('link')};
}

// The colours of Okabe and Ito (Color Universal Design, 2008), which differ for all kinds of sight.
// Four more follow, for bars of many pieces; page.css has the same twelve.
export const kHues = ['#0072b2', '#e69f00', '#009e73', '#cc79a7', '#56b4e9', '#d55e00', '#a0a000', '#8a6fd1', '#7f5539', '#00a8a8',
  '#b0b0ff', '#5b8c3a'];
export const kBetter = '#009e73', kWorse = '#d55e00';

// From nothing to full: the stops of cividis (Nunez et al., 2018), dark blue to yellow.
export const kScale = ['#00204d', '#31446b', '#666870', '#958f78', '#cbba69', '#ffea46'];

/** The colour at `part` (0 to 1) of the scale. */
export function scaleColour(part) {
  const at = Math.min(0.99999, Math.max(0, part)) * (kScale.length - 1);
  const i = Math.floor(at);
  const channel = (hex, c) => parseInt(hex.slice(1 + 2 * c, 3 + 2 * c), 16);
  const mixed = [0, 1, 2].map((c) =>
    Math.round(channel(kScale[i], c) + (at - i) * (channel(kScale[i + 1], c) - channel(kScale[i], c))));
  return `rgb(${mixed.join(',')})`;
}

/** The least round maximum above all shares, so that faint differences are seen too. */
export function roundMost(shares) {
  const most = Math.max(0, ...shares);
  return [0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1].find((m) => most <= m) ?? most;
}

export const percent = (share) => `${(100 * share).toFixed(1)} %`;

export function short(value) {
  const size = Math.abs(value);
  for (const [unit, name] of [[1e12, ' T'], [1e9, ' G'], [1e6, ' M'], [1e3, ' k']])
    if (size >= unit) return `${Number((value / unit).toPrecision(3))}${name}`;
  return `${Number(value.toPrecision(3))}`;
}

/** The prefix of a unit in which `most` is at least 1, and its factor: micro for 0.000007. */
export function prefixOf(most) {
  return [[1, ''], [1e-3, 'm'], [1e-6, 'µ'], [1e-9, 'n']].find(([factor]) => most >= factor) ?? [1e-12, 'p'];
}

/** The lines that a legend takes, with names of some 7 pixels a letter. */
export function legendLines(list, width) {
  return list.map((name) => 42 + 7 * name.length)
    .reduce(([full, at], wide) => (at + wide > width - 10 ? [full + 1, wide] : [full, at + wide]), [1, 0])[0];
}

export const full = (value) =>
  value !== 0 && Math.abs(value) < 1e-3 ? `${Number(value.toPrecision(4))}` : value.toLocaleString('en', {maximumFractionDigits: 4});

/** What every chart with axes begins with. */
export function base(colours) {
  return {
    animation: false,
    textStyle: {color: colours.ink, fontFamily: 'system-ui, "DejaVu Sans", sans-serif'},
    tooltip: {
      confine: true, backgroundColor: colours.panel, borderColor: colours.line, textStyle: {color: colours.ink},
    },
    legend: {textStyle: {color: colours.ink}, type: 'scroll', top: 0, left: 0, right: 0, pageTextStyle: {color: colours.ink},
      pageIconColor: colours.link, pageIconInactiveColor: colours.soft},
  };
}

export function axis(colours, more = {}) {
  const {axisLabel, ...others} = more;
  return {
    axisLine: {lineStyle: {color: colours.soft}},
    axisTick: {lineStyle: {color: colours.soft}},
    splitLine: {lineStyle: {color: colours.line}},
    nameTextStyle: {color: colours.ink},
    axisLabel: {color: colours.ink, hideOverlap: true, ...axisLabel},
    ...others,
  };
}

/** The type of an axis for these numbers: logarithmic where each is at least 1.5 times the one before, or all together
 * span the factor `wide` and none is 0. */
export function scaleType(values, wide = 20) {
  const list = [...new Set(values)].sort((a, b) => a - b);
  if (list.length < 3 || !(list[0] > 0)) return 'value';
  const steps = list.slice(1).map((v, i) => v / list[i]);
  return Math.min(...steps) >= 1.5 || list.at(-1) / list[0] >= wide ? 'log' : 'value';
}

/** A logarithmic or linear axis of numbers, with its ends a little beyond them. */
export function numberAxis(colours, values, more = {}, wide = 20) {
  const type = scaleType(values, wide);
  if (type === 'value') return axis(colours, {type, scale: true, ...more});
  const least = Math.min(...values), most = Math.max(...values);
  const doubles = most / least < 1000;
  return axis(colours, {type, logBase: doubles ? 2 : 10, min: least / 1.15, max: most * 1.15, minorSplitLine: {show: false}, ...more,
    axisLabel: {showMinLabel: false, showMaxLabel: false, ...more.axisLabel}});
}

/** An axis of names, first at the top. Long names take two lines where the chart is narrow. */
export function names(colours, list, width) {
  const most = Math.max(90, Math.min(300, width * 0.3));
  const long = Math.max(...list.map((name) => String(name).length)) * 6.8 > most;
  return axis(colours, {
    type: 'category', data: list, inverse: true, axisTick: {show: false}, splitLine: {show: false},
    axisLabel: {interval: list.length > 40 ? 'auto' : 0, ...(width < 600 ? {fontSize: 10} : {}),
      ...(long ? {width: most, overflow: 'break', lineHeight: 13, lineOverflow: 'truncate', height: 28} : {})},
  });
}

// Fills the report from the JSON in #data: report() at the end is the table of contents.
'use strict';

const data = JSON.parse(document.getElementById('data').textContent);
const several = data.series.length > 1;
let chosen = 0;  // the series that pictures and timeline show

function byId(id) {
  return document.getElementById(id);
}

function element(name, text, className) {
  const made = document.createElement(name);
  if (text !== undefined) made.textContent = text;
  if (className) made.className = className;
  return made;
}

// A number with as many digits as its size deserves; "–" for a figure that does not exist.
function digits(value, places) {
  if (value === null || value === undefined) return '–';
  if (typeof value === 'string') return value;
  if (places === undefined) {
    const size = Math.abs(value);
    places = size >= 100 ? 0 : size >= 10 ? 1 : size >= 1 ? 2 : size >= 0.01 ? 3 : size === 0 ? 0 : 5;
  }
  return value.toFixed(places);
}

function withUnit(value, unit, places) {
  return value === null || value === undefined ? '–' : digits(value, places) + ' ' + unit;
}

function named(series, name) {
  return several ? series.label + (name ? ', ' + name : '') : name;
}

// ---- headline ------------------------------------------------------------------------------------------

const headlineRows = [
  ['Missed vsyncs', (f) => withUnit(100 * f.missed_ratio, '%', 2)],
  ['Missed of all', (f) => f.missed_vsyncs + ' of ' + (f.vsyncs - f.startup_vsyncs)],
  ['Longest stale run', (f) => f.longest_stale_run + (f.longest_stale_run === 1 ? ' vsync' : ' vsyncs')],
  ['Motion-to-photon, rotation, p50', (f) => withUnit(f.mtp_ms.rotation.p50, 'ms')],
  ['… p95', (f) => withUnit(f.mtp_ms.rotation.p95, 'ms')],
  ['… p99', (f) => withUnit(f.mtp_ms.rotation.p99, 'ms')],
  ['Motion-to-photon, translation, p50', (f) => withUnit(f.mtp_ms.translation.p50, 'ms')],
  ['… p95', (f) => withUnit(f.mtp_ms.translation.p95, 'ms')],
  ['… p99', (f) => withUnit(f.mtp_ms.translation.p99, 'ms')],
  ['Frame age, p50', (f) => withUnit(f.frame_age_ms.p50, 'ms')],
  ['Eye frames per second, average', (f) => digits(f.fps_avg, 1)],
  ['… 1 % low', (f) => digits(f.fps_1pct_low, 1)],
  ['DSSIM, mean', (f) => digits(f.dssim.mean, 4)],
  ['… p95', (f) => digits(f.dssim.p95, 4)],
  ['… max', (f) => digits(f.dssim.max, 4)],
  ['Angular error, p95', (f) => withUnit(f.angular_error_deg.p95, '°')],
  ['Position error, p95', (f) => withUnit(f.position_error_mm.p95, 'mm')],
];

function tile(name, value, unit, more, bad) {
  const made = element('div', undefined, bad ? 'tile bad' : 'tile');
  made.append(element('div', name, 'name'));
  const figure = element('div', value, 'value');
  if (unit) figure.append(element('small', ' ' + unit));
  made.append(figure, element('div', more, 'more'));
  return made;
}

function showTiles(f) {
  const tiles = element('div', undefined, 'tiles');
  const mtp = f.mtp_ms;
  const spread = (d) => 'p95 ' + digits(d.p95) + ' · p99 ' + digits(d.p99) + ' · max ' + digits(d.max);
  tiles.append(
    tile('Missed vsyncs', digits(100 * f.missed_ratio, 2), '%',
      f.missed_vsyncs + ' of ' + (f.vsyncs - f.startup_vsyncs) + ', longest run ' + f.longest_stale_run,
      f.missed_vsyncs > 0),
    tile('Motion-to-photon, rotation', digits(mtp.rotation.p50), 'ms p50', spread(mtp.rotation)),
    tile('Motion-to-photon, translation', digits(mtp.translation.p50), 'ms p50', spread(mtp.translation)),
    tile('Frame age', digits(f.frame_age_ms.p50), 'ms p50', spread(f.frame_age_ms)),
    tile('Eye frames', digits(f.fps_avg, 1), 'fps', '1 % low ' + digits(f.fps_1pct_low, 1) + ' fps'),
    f.dssim.count > 0
      ? tile('Image error (DSSIM)', digits(f.dssim.mean, 4), 'mean',
        'p95 ' + digits(f.dssim.p95, 4) + ' · max ' + digits(f.dssim.max, 4))
      : tile('Image error (DSSIM)', '–', '', 'no picture was compared'));
  byId('headline').append(tiles);
}

function table(columns, rows, className) {
  const made = element('table', undefined, className);
  const head = element('tr');
  columns.forEach((name) => head.append(element('th', name)));
  made.append(element('thead'), element('tbody'));
  made.tHead.append(head);
  for (const cells of rows) {
    const row = element('tr');
    cells.forEach((cell) => row.append(element('td', cell)));
    made.tBodies[0].append(row);
  }
  return made;
}

function showHeadline() {
  const headline = byId('headline');
  if (!several) {
    showTiles(data.series[0].figures);
  } else {
    const card = element('div', undefined, 'card scroll');
    card.append(table([''].concat(data.series.map((s) => s.label)),
      headlineRows.map(([name, figure]) => [name].concat(data.series.map((s) => figure(s.figures))))));
    headline.append(card);
  }
  headline.append(element('p',
    'Missed: nothing new was latched at the vsync; vsyncs before the first image do not count. Percentiles are ' +
    'nearest rank. Frames per second are those of the ray caster, from the times its eye frames were done; the ' +
    '1 % low is 1000 ms over the 99th percentile of the frame times. DSSIM is (1 − SSIM) / 2 of what the panel ' +
    'shows against an ideal picture at the true pose at photon time, both eyes.', 'quiet'));
}

// ---- pictures and timeline: one series, one place in time ----------------------------------------------

function fillSeriesChoices(onChange) {
  for (const choice of document.querySelectorAll('.series-choice')) {
    choice.hidden = !several;
    data.series.forEach((s, i) => choice.append(new Option(s.label, i)));
    choice.addEventListener('change', () => {
      chosen = Number(choice.value);
      document.querySelectorAll('.series-choice').forEach((other) => { other.value = chosen; });
      onChange();
    });
  }
}

// Back, slider, forward, label; show(position) says what to write into the label.
function stepper(host, count, step, name, show) {
  host.replaceChildren();
  const back = element('button', '◀');
  const slider = element('input');
  const forward = element('button', '▶');
  const label = element('output');
  back.type = forward.type = 'button';
  back.setAttribute('aria-label', 'Earlier ' + name);
  forward.setAttribute('aria-label', 'Later ' + name);
  slider.setAttribute('aria-label', name);
  Object.assign(slider, {type: 'range', min: 0, max: Math.max(0, count - 1), step: 1, value: 0});
  const go = (to) => {
    slider.value = Math.max(0, Math.min(count - 1, to));
    const at = Number(slider.value);
    back.disabled = at === 0;
    forward.disabled = at >= count - 1;
    label.value = show(at);
  };
  back.addEventListener('click', () => go(Number(slider.value) - step));
  forward.addEventListener('click', () => go(Number(slider.value) + step));
  slider.addEventListener('input', () => go(Number(slider.value)));
  host.append(back, slider, forward, label);
  return {go, at: () => Number(slider.value)};
}

function showPictures() {
  const series = data.series[chosen];
  const shown = series.pictures;
  byId('eyes').hidden = data.series.every((s) => s.pictures.length === 0);
  const steps = byId('picture-steps');
  for (const [id, eye] of [['left-eye', 'left'], ['right-eye', 'right']]) byId(id).closest('figure').hidden = !shown.length;
  if (!shown.length) {
    steps.replaceChildren();
    byId('picture-note').textContent = 'No picture of this series was kept.';
    return;
  }
  const controls = stepper(steps, shown.length, 1, 'picture', (at) => {
    byId('left-eye').src = shown[at].left;
    byId('right-eye').src = shown[at].right;
    return 'vsync ' + shown[at].vsync;
  });
  steps.querySelectorAll('button, input').forEach((control) => { control.hidden = shown.length < 2; });
  controls.go(Math.floor(shown.length / 2));
  byId('picture-note').textContent = 'What the panel shows, lens distortion included. ' +
    (series.pictures_total > shown.length
      ? shown.length + ' of the ' + series.pictures_total + ' vsyncs in images/ are on this page.' : '');
}

const lanes = ['ray casting', 'warp', 'scan-out'];  // updates share the ray casting's lane: one queue
let timelineChart = null;
let timelineAt = -1;  // not chosen yet

function spansBetween(spans, from, to) {
  return spans.filter(([start, end]) => end >= from && start <= to);
}

function timelineBars(timeline, from, to) {
  const frameColour = (frame) => css(frame % 2 === 0 ? '--cast' : '--cast-other');
  const dark = document.documentElement.dataset.theme === 'dark';
  const frameInk = (frame) => (frame % 2 === 0) === dark ? '#000' : '#fff';
  const span = (start, end) => digits(end - start, 2) + ' ms, from ' + digits(start, 2) + ' ms';
  const bars = {};
  bars[lanes[0]] = spansBetween(timeline.casts, from, to).map(([start, end, frame]) => ({
    from: start, to: end, text: String(frame), colour: frameColour(frame), ink: frameInk(frame),
    tip: 'eye frame ' + frame + ': ' + span(start, end),
  }));
  bars[lanes[0]].push(...spansBetween(timeline.updates, from, to).map(([start, end, frame]) => ({
    from: start, to: end, colour: css('--update'),
    tip: 'update of the transfer function before eye frame ' + frame + ': ' + span(start, end),
  })));
  bars[lanes[1]] = spansBetween(timeline.warps, from, to).map(([start, end, vsync]) => ({
    from: start, to: end, colour: css('--warp'), tip: 'warp for vsync ' + vsync + ': ' + span(start, end),
  }));
  bars[lanes[2]] = timeline.vsyncs.filter((v) => v[4] !== null && v[5] >= from && v[4] <= to)
    .map(([vsync, , missed, frame, first, last]) => ({
      from: first, to: Math.max(last, first + 0.15), text: String(frame), ink: frameInk(frame),
      colour: frameColour(frame),
      tip: 'vsync ' + vsync + ' shows eye frame ' + frame + (missed ? ' (missed)' : '') + ': ' + span(first, last),
    }));
  return bars;
}

function drawTimelineAt(at) {
  const timeline = data.series[chosen].timeline;
  const window = narrow() ? 5 : 14;
  const vsyncs = timeline.vsyncs;
  timelineAt = at;
  const period = vsyncs.length > 1 ? vsyncs[1][1] - vsyncs[0][1] : 1000 / data.refresh_hz;
  const from = vsyncs[at][1] - 0.25 * period;
  const to = from + window * period;
  const marks = vsyncs.slice(at, at + window + 1).map((v) => ({t: v[1], missed: v[2] === 1}));
  if (timelineChart) {
    charts.splice(charts.indexOf(timelineChart), 1);
    timelineChart.destroy();
  }
  timelineChart = drawTimeline('timeline-chart', lanes, timelineBars(timeline, from, to), marks, from, to);
  return 'from vsync ' + vsyncs[at][0];
}

// Where to look first: just before the longest run of missed vsyncs, or at the start if there is none.
function beforeWorst(vsyncs) {
  let longest = 0, at = 0, run = 0;
  vsyncs.forEach((v, i) => {
    run = v[2] === 1 ? run + 1 : 0;
    if (run > longest) [longest, at] = [run, i - run + 1];
  });
  return Math.max(0, at - 3);
}

function showTimeline() {
  const timeline = data.series[chosen].timeline;
  const vsyncs = timeline.vsyncs;
  const steps = byId('timeline-steps');
  const empty = vsyncs.every((v) => v[4] === null) && !timeline.casts.length && !timeline.warps.length;
  byId('timeline-card').hidden = empty && !several;
  if (empty) return;
  const controls = stepper(steps, vsyncs.length, narrow() ? 4 : 10, 'vsyncs', drawTimelineAt);
  const missed = element('button', 'Next missed');
  missed.type = 'button';
  const next = (after) => vsyncs.findIndex((v, i) => i > after && v[2] === 1 && (i === 0 || vsyncs[i - 1][2] === 0));
  missed.disabled = next(-1) < 0;
  missed.addEventListener('click', () => {
    const found = next(controls.at() + 2);
    controls.go(Math.max(0, (found < 0 ? next(-1) : found) - 2));
  });
  steps.append(missed);
  controls.go(Math.min(timelineAt < 0 ? beforeWorst(vsyncs) : timelineAt, vsyncs.length - 1));
  byId('timeline-note').textContent = 'The bars of an eye frame and of the scan-outs that show it have the same ' +
    'number and shade; neighbouring frames differ in shade. Hover over a bar for its times. ' +
    (timeline.total > vsyncs.length
      ? 'This page holds ' + vsyncs.length + ' of ' + timeline.total + ' vsyncs, around the longest stale run; ' +
        'timeline.json opens in Perfetto and has more.'
      : 'timeline.json holds the same for Perfetto.');
}

function showTimelineLegend() {
  const entries = [['--cast', 'eye frame: ray casting, then scan-out'], ['--warp', 'warp and distortion'],
    ...(data.series[chosen].timeline.updates.length ? [['--update', 'transfer function, skip structure']] : []),
    ['--missed', '✕ missed vsync'], ['--vsync', 'vsync']];
  byId('timeline-legend').replaceChildren(...entries.map(([colour, text]) => {
    const item = element('li');
    const swatch = element('i');
    swatch.style.background = css(colour);
    item.append(swatch, text);
    return item;
  }));
}

// ---- curves and distributions --------------------------------------------------------------------------

const timeAxis = {
  x: 'simulated time, s',
  tipTitle: (x) => digits(x, 3) + ' s',
};

function runSeconds() {
  return Math.max(...data.series.map((s) => s.timeline.total)) / data.refresh_hz;
}

function curves(fields) {
  const lines = [];
  data.series.forEach((series, i) => {
    fields.forEach(([field, name], k) => {
      if (!series[field].length) return;
      lines.push({
        label: named(series, name), points: series[field],
        colour: seriesColour(several ? i : k), dashed: k > 0,
      });
    });
  });
  return lines;
}

function drawCurve(id, fields, title, tip) {
  const lines = curves(fields);
  byId(id).closest('.card').hidden = lines.length === 0;
  if (lines.length) drawLines(id, lines, Object.assign({y: title, tip, xMin: 0, xMax: runSeconds()}, timeAxis));
}

function drawMissed() {
  const none = data.series.every((s) => s.figures.missed_vsyncs === 0);
  byId('missed-box').hidden = none;
  if (none) {
    byId('missed-note').textContent = 'No vsync was missed.';
    return;
  }
  const series = data.series.map((s, i) => ({
    label: several ? s.label : 'missed', points: s.missed.slices,
    colour: several ? seriesColour(i) : css('--missed'),
  }));
  drawBars('missed-chart', series, Object.assign({
    y: 'missed, %', yLeast: 5, tip: (v) => digits(v, 1) + ' % missed', xMin: 0, xMax: runSeconds(),
  }, timeAxis));
  const per = data.series[0].missed.per_slice;
  byId('missed-note').textContent = 'Share of missed vsyncs in slices of ' +
    (per === 1 ? 'one vsync.' : per + ' vsyncs (' + digits(1000 * per / data.refresh_hz) + ' ms).');
}

function drawHistogram(id, histogram, labels, dashedFrom, unit) {
  const lines = histogram.share.map((share, i) => ({
    label: labels[i] + (histogram.beyond[i] > 0 ? ' (' + digits(histogram.beyond[i]) + ' % beyond)' : ''),
    points: share.some((s) => s > 0) ? histogramPoints({from: histogram.from, width: histogram.width, share}) : [],
    colour: seriesColour(several ? i % data.series.length : i), dashed: i >= dashedFrom,
  })).filter((line) => line.points.length);
  byId(id).closest('.card').hidden = lines.length === 0;
  if (!lines.length) return;
  drawLines(id, lines, {
    x: unit, y: 'vsyncs, %',
    tipTitle: (x) => 'near ' + digits(x) + ' ms (bins of ' + digits(histogram.width) + ' ms)',
    tip: (v) => digits(v, 1) + ' %',
  });
}

function drawAll() {
  charts.splice(0).forEach((chart) => chart.destroy());
  timelineChart = null;
  showTimeline();
  showTimelineLegend();
  drawMissed();
  drawCurve('dssim-chart', [['dssim_left', 'left eye'], ['dssim_right', 'right eye']], 'DSSIM', (v) => digits(v, 4));
  const mtpLabels = ['rotation', 'translation'].flatMap((kind) => data.series.map((s) => named(s, kind)));
  drawHistogram('mtp-chart', data.mtp, mtpLabels, data.series.length, 'motion-to-photon, ms');
  drawHistogram('age-chart', data.age, data.series.map((s) => several ? s.label : 'frame age'), 99, 'frame age, ms');
  drawCurve('angle-chart', [['angle_deg', several ? '' : 'angular error']], 'angular error, °', (v) => withUnit(v, '°'));
  drawCurve('position-chart', [['position_mm', several ? '' : 'position error']], 'position error, mm', (v) => withUnit(v, 'mm'));
}

// ---- words ---------------------------------------------------------------------------------------------

function fillList(id, entries) {
  for (const [name, value] of entries) byId(id).append(element('dt', name), element('dd', value));
}

function showFacts() {
  const clock = data.clock;
  const entries = [
    ['Device', data.device + ', ' + digits(data.refresh_hz) + ' Hz, resolution scale ' + data.resolution_scale],
    ['Trace', data.trace],
    ['Clock', clock.mode + ', queue ' + clock.queue],
    ['Costs', clock.cost + ', counted at ' + (clock.cost_resolution === 'full'
      ? "the profile's full resolution" : 'the resolution rendered')],
    ['Deterministic', data.deterministic
      ? 'yes: the same session gives the same records' : 'no: costs were measured or paced on the host'],
  ];
  for (const series of data.series) {
    entries.push([several ? 'Pipeline ' + series.label : 'Pipeline', Object.values(series.pipeline).join(', ')]);
  }
  fillList('facts', entries.concat(Object.entries(data.facts)));
  const host = data.host;
  fillList('host', [['Wall time', withUnit(host.wall_s, 's')], ['CPU time', withUnit(host.cpu_s, 's')],
    ['Peak memory', digits(host.peak_rss_bytes / 1048576, 0) + ' MiB'],
  ].concat(Object.entries(host).filter(([name]) => !['wall_s', 'cpu_s', 'peak_rss_bytes'].includes(name))));
  byId('session').textContent = data.session;
}

function showFailure() {
  if (!data.failure) return;
  byId('failure').hidden = false;
  byId('failure').textContent = 'This run is incomplete: ' + data.failure;
}

function showLeftOut() {
  const rows = data.series.flatMap((s) => s.left_out.map((one) => (several ? [s.label] : []).concat(one.stage, one.reason)));
  byId('left-out-card').hidden = rows.length === 0;
  byId('left-out').replaceWith(table((several ? ['Series'] : []).concat('Stage', 'Why'), rows, 'words'));
}

function showTables() {
  for (const one of data.tables) {
    const card = element('section', undefined, 'card');
    const scroll = element('div', undefined, 'scroll');
    scroll.append(table(one.columns, one.rows));
    card.append(element('h2', one.title), scroll, element('p', one.note, 'quiet'));
    byId('tables').append(card);
  }
}

function showNotes() {
  byId('dssim-note').textContent = 'DSSIM (0: equal) of the picture on the panel against an ideal one at the true ' +
    'pose at photon time: 8×8 windows, mean of red, green and blue, visible pixels only.';
  const longest = Math.max(...data.series.map((s) => s.timeline.total));
  if (longest > data.curve_points) {
    byId('decimation-note').textContent = 'Curves over time are decimated to ' + data.curve_points +
      ' points: the least and the greatest value of each slice of time are kept, so every peak is there. ' +
      'frames.csv has all ' + longest + ' vsyncs.';
  }
}

// ---- theme ---------------------------------------------------------------------------------------------

function setTheme(theme) {
  document.documentElement.dataset.theme = theme;
  byId('theme').textContent = theme === 'dark' ? 'Light' : 'Dark';
}

function followTheme() {
  const system = window.matchMedia('(prefers-color-scheme: dark)');
  let own = false;
  setTheme(system.matches ? 'dark' : 'light');
  system.addEventListener('change', () => {
    if (own) return;
    setTheme(system.matches ? 'dark' : 'light');
    drawAll();
  });
  byId('theme').addEventListener('click', () => {
    own = true;
    setTheme(document.documentElement.dataset.theme === 'dark' ? 'light' : 'dark');
    drawAll();
  });
}

function report() {
  const pipeline = several ? data.series.map((s) => s.label).join(' and ') : data.series[0].pipeline.warp || '';
  document.title = 'Brace: ' + data.device + ', ' + data.trace;
  byId('title').textContent = data.device + (pipeline ? ': ' + pipeline : '');
  byId('subtitle').textContent = data.trace + ' · ' + digits(data.refresh_hz) + ' Hz · ' + data.clock.cost + ' · queue ' +
    data.clock.queue + ' · ' + (data.deterministic ? 'deterministic' : 'not deterministic') + ' · Brace ' + data.version;
  followTheme();
  showHeadline();
  fillSeriesChoices(() => {
    showPictures();
    showTimeline();
  });
  showPictures();
  showFacts();
  showFailure();
  showLeftOut();
  showTables();
  showNotes();
  drawAll();
}

report();

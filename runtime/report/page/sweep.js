// Fills the page of a sweep from the JSON in #data: sweep() at the end is the table of contents.
'use strict';

const data = JSON.parse(document.getElementById('data').textContent);
const shapes = ['circle', 'rect', 'triangle', 'rectRot', 'star', 'crossRot'];
let sortedBy = {column: 0, falling: false};

function byId(id) {
  return document.getElementById(id);
}

function element(name, text) {
  const made = document.createElement(name);
  if (text !== undefined) made.textContent = text;
  return made;
}

// As many digits as tell neighbours apart; "–" for a figure that does not exist.
function digits(value) {
  if (value === null || value === undefined) return '–';
  if (typeof value === 'string') return value;
  if (value === 0 || Number.isInteger(value)) return String(value);
  const size = Math.abs(value);
  return size >= 1e6 ? (value / 1e6).toFixed(2) + ' M' : size >= 100 ? value.toFixed(0) : Number(value.toPrecision(4)).toString();
}

function chosen(kind) {
  const axes = kind === 'work' ? data.works : data.errors;
  return axes[Number(byId(kind).value)];
}

function titleOf(axis) {
  return axis.label + (axis.unit ? ', ' + axis.unit : '');
}

// ---- curves --------------------------------------------------------------------------------------------

function pointsOf(method) {
  const work = chosen('work').figure, error = chosen('error').figure;
  return data.points.map((point, index) => ({point, index, x: point.figures[work], y: point.figures[error]}))
    .filter((one) => one.point.method === method && one.x !== null && one.y !== null);
}

// On a logarithmic axis nothing lies at 0: an error of 0 is shown at the bottom and its tip says so.
function floorOf(all) {
  const above = all.map((one) => one.y).filter((y) => y > 0);
  return above.length ? Math.min(...above) / 3 : 1e-6;
}

function drawCurves() {
  const pair = data.pairs[chosen('work').figure + '|' + chosen('error').figure];
  const all = data.methods.flatMap(pointsOf);
  const floor = floorOf(all);
  const shown = (one) => ({x: one.x, y: Math.max(one.y, floor), one});
  const datasets = data.methods.map((method, i) => ({
    label: method,
    data: pointsOf(method).sort((a, b) => a.x - b.x).map(shown),
    borderColor: seriesColour(i), backgroundColor: seriesColour(i), borderWidth: 1.6,
    borderDash: i >= 5 ? [5, 3] : [], pointRadius: 5, pointHoverRadius: 7, pointStyle: shapes[i % shapes.length], showLine: true,
  }));
  const front = pair.front.map((index) => all.find((one) => one.index === index)).filter((one) => one)
    .sort((a, b) => a.x - b.x).map(shown);
  datasets.push({
    label: 'nothing beats these', data: front, borderColor: css('--quiet'), backgroundColor: 'transparent', borderWidth: 1,
    borderDash: [2, 3], pointRadius: 10, pointStyle: 'circle', pointBorderWidth: 1.5, stepped: 'before', showLine: true,
  });
  const logarithmic = (title) => axis(title, {type: 'logarithmic', ticks: {maxRotation: 0, autoSkipPadding: 18, callback: logText}});
  const chart = drawChart('curves', {
    type: 'scatter',
    data: {datasets},
    options: {
      parsing: false,
      interaction: {mode: 'nearest', intersect: false},
      scales: {x: logarithmic(titleOf(chosen('work'))), y: logarithmic(titleOf(chosen('error')))},
      plugins: {legend: {display: false}, tooltip: {callbacks: {title: (items) => tipTitle(items), label: tipLabel}}},
    },
  });
  showLegend('curves', chart);
  allowZoom(chart);
  const missing = data.points.length - all.length;
  byId('curves-note').textContent = 'Both axes are logarithmic. Turn the wheel over the picture to zoom. ' +
    (data.knob ? 'Along a curve ' + data.knob + ' changes. ' : '') +
    (missing > 0 ? missing + ' of ' + data.points.length + ' points have no such figures. ' : '') +
    (all.some((one) => one.y === 0) ? 'An error of 0 is drawn below all others.' : '');
}

function logText(value) {
  const lead = value / 10 ** Math.floor(Math.log10(value) + 1e-9);
  return [1, 2, 5].some((n) => Math.abs(lead - n) < 1e-6) ? digits(value) : '';
}

function tipTitle(items) {
  const one = items.length ? items[0].raw.one : null;
  return one ? one.point.method + (data.knob ? ', ' + data.knob + ' = ' + one.point.knob : '') : '';
}

function tipLabel(item) {
  const one = item.raw.one;
  return [titleOf(chosen('work')) + ': ' + digits(one.x), titleOf(chosen('error')) + ': ' + digits(one.y),
    one.point.holds_90_hz ? 'holds 90 Hz at p99' : 'does not hold 90 Hz at p99'];
}

// The wheel zooms about the pointer, in both directions.
function allowZoom(chart) {
  chart.canvas.onwheel = (event) => {
    event.preventDefault();
    const factor = event.deltaY < 0 ? 0.8 : 1.25;
    for (const [name, pixel] of [['x', event.offsetX], ['y', event.offsetY]]) {
      const scale = chart.scales[name];
      const at = Math.log(scale.getValueForPixel(pixel));
      chart.options.scales[name].min = Math.exp(at + (Math.log(scale.min) - at) * factor);
      chart.options.scales[name].max = Math.exp(at + (Math.log(scale.max) - at) * factor);
    }
    chart.update();
  };
}

// ---- a figure along the knob ---------------------------------------------------------------------------

function alongAxis() {
  return data.along[Number(byId('along').value) || 0];
}

function drawAlong() {
  if (!data.along.length) return;
  const figure = alongAxis().figure;
  const curveOf = (method) => data.points
    .filter((point) => point.method === method && point.figures[figure] !== null && !Number.isNaN(Number(point.knob)))
    .map((point) => ({x: Number(point.knob), y: point.figures[figure], one: {point}})).sort((a, b) => a.x - b.x);
  const datasets = data.methods.map((method, i) => ({
    label: method, data: curveOf(method), borderColor: seriesColour(i), backgroundColor: seriesColour(i), borderWidth: 1.6,
    borderDash: i >= 5 ? [5, 3] : [], pointRadius: 4, pointStyle: shapes[i % shapes.length], showLine: true,
  })).filter((dataset) => dataset.data.length);
  const chart = drawChart('along-curves', {
    type: 'scatter',
    data: {datasets},
    options: {
      parsing: false,
      interaction: {mode: 'nearest', intersect: false},
      scales: {x: axis(data.knob, {type: 'linear'}), y: axis(titleOf(alongAxis()), {type: 'linear'})},
      plugins: {legend: {display: false}, tooltip: {callbacks: {title: (items) => tipTitle(items),
        label: (item) => titleOf(alongAxis()) + ': ' + digits(item.raw.y)}}},
    },
  });
  showLegend('along-curves', chart);
  byId('along-note').textContent = figure.startsWith('second_eye') ? 'Against two passes with the same settings: V = 1 − (T of ' +
    'the pair − T of an eye) / T of an eye, an eye being half of two passes (means of the casts).' : '';
}

// ---- tables --------------------------------------------------------------------------------------------

function fillTable(id, columns, rows) {
  const made = element('table');
  made.id = id;
  const head = element('tr');
  columns.forEach((name) => head.append(element('th', name)));
  made.append(element('thead'), element('tbody'));
  made.tHead.append(head);
  for (const cells of rows) {
    const row = element('tr');
    cells.forEach((cell) => row.append(element('td', digits(cell))));
    made.tBodies[0].append(row);
  }
  byId(id).replaceWith(made);
  return made;
}

function showNeeds() {
  const work = chosen('work'), error = chosen('error');
  const reach = data.pairs[work.figure + '|' + error.figure].reach;
  const rows = data.methods.map((method) => {
    const best = data.best_at_90_hz[method];
    return [method, reach[method] === null ? 'not reached' : reach[method],
      best ? best.error : 'none holds it', best ? best.knob : '–'];
  });
  fillTable('needs', ['Method', titleOf(work) + ' to ' + error.label + ' ≤ ' + data.reach_error,
    'Least DSSIM (mean) at 90 Hz', data.knob || 'Setting'], rows).className = 'words';
  byId('needs-note').textContent = 'Of the points that were run, nothing is interpolated. 90 Hz holds where the 99th ' +
    'percentiles of cast and warp together fit into 11.1 ms.';
}

const figureColumns = ['cast_ms_p50', 'cast_ms_p95', 'samples', 'rays', 'dssim_mean', 'dssim_p95', 'missed_ratio',
  'mtp_rotation_ms_p99', 'mtp_translation_ms_p99'].concat(
  data.along.map((one) => one.figure).filter((name) => name.startsWith('second_eye')));

function rowOf(point) {
  return [point.point].concat(point.settings, point.status, figureColumns.map((name) => point.figures[name]), point.message || '');
}

function inOrder(a, b) {
  if (a === null || b === null) return (a === null) - (b === null);
  const numbers = [Number(a), Number(b)];
  if (a !== '' && b !== '' && numbers.every((n) => !Number.isNaN(n))) return numbers[0] - numbers[1];
  return String(a).localeCompare(String(b));
}

function showPoints() {
  const words = byId('filter').value.toLowerCase().split(/\s+/).filter((word) => word);
  const rows = data.points.map(rowOf).filter((row) => words.every((word) => row.join(' ').toLowerCase().includes(word)));
  rows.sort((a, b) => inOrder(a[sortedBy.column], b[sortedBy.column]) * (sortedBy.falling ? -1 : 1));
  const columns = ['Point'].concat(data.keys, 'Status', figureColumns, 'Message');
  const made = fillTable('points', columns, rows);
  [...made.tHead.rows[0].cells].forEach((cell, column) => {
    const button = element('button', columns[column] + (sortedBy.column === column ? (sortedBy.falling ? ' ▼' : ' ▲') : ''));
    button.type = 'button';
    button.addEventListener('click', () => {
      sortedBy = {column, falling: sortedBy.column === column && !sortedBy.falling};
      showPoints();
    });
    cell.replaceChildren(button);
  });
  byId('count').textContent = rows.length + ' of ' + data.points.length + ' points';
}

// ---- the page ------------------------------------------------------------------------------------------

function drawAll() {
  charts.splice(0).forEach((chart) => chart.destroy());
  drawCurves();
  drawAlong();
}

function setTheme(theme) {
  document.documentElement.dataset.theme = theme;
  byId('theme').textContent = theme === 'dark' ? 'Light' : 'Dark';
}

function fillChoices() {
  data.works.forEach((one, i) => byId('work').append(new Option(one.label, i)));
  data.errors.forEach((one, i) => byId('error').append(new Option(one.label, i)));
  data.along.forEach((one, i) => byId('along').append(new Option(one.label, i)));
  byId('along-card').hidden = !data.along.length;
  // A sweep without pictures has no error to draw.
  byId('curves-card').hidden = data.along.length > 0 && data.points.every((point) => point.figures.dssim_mean === null);
  byId('along').addEventListener('change', drawAll);
  for (const id of ['work', 'error']) {
    byId(id).addEventListener('change', () => {
      drawAll();
      showNeeds();
    });
  }
  byId('reset').addEventListener('click', drawAll);
  byId('filter').addEventListener('input', showPoints);
  byId('theme').addEventListener('click', () => {
    setTheme(document.documentElement.dataset.theme === 'dark' ? 'light' : 'dark');
    drawAll();
  });
}

function sweep() {
  document.title = 'Brace sweep: ' + data.sweep;
  byId('title').textContent = 'Sweep ' + data.sweep;
  const of = (status) => data.points.filter((point) => point.status === status).length;
  byId('subtitle').textContent = data.points.length + ' points of ' + data.session + ': ' + of('done') + ' done, ' + of('failed') +
    ' failed, ' + of('crashed') + ' crashed · ' + data.repeat + (data.repeat === 1 ? ' run' : ' runs') + ' each · Brace ' + data.version;
  setTheme(window.matchMedia('(prefers-color-scheme: dark)').matches ? 'dark' : 'light');
  fillChoices();
  showNeeds();
  showPoints();
  drawAll();
}

sweep();

// Fills the page of a sweep from the JSON in #data: sweep() at the end is the table of contents.
'use strict';

const data = JSON.parse(document.getElementById('data').textContent);
const shapes = ['circle', 'rect', 'triangle', 'rectRot', 'star', 'crossRot', 'cross', 'rectRounded'];
const marks = ['●', '■', '▲', '◆', '✳', '✖', '✚', '▢'];  // the same in a line of text

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

// So many curves a reader can tell apart; the others are pale, and named by the pointer.
const namedMost = 8;
let picked = [];  // methods that the reader asked for, the newest last

function pointsOf(method) {
  return placed.filter((one) => one.point.method === method);
}

// The points that have both figures of the chosen axes.
let placed = [];
function placePoints() {
  const work = chosen('work').figure, error = chosen('error').figure;
  placed = data.points.map((point, index) => ({point, index, x: point.figures[work], y: point.figures[error]}))
    .filter((one) => one.x !== null && one.y !== null).sort((a, b) => a.x - b.x);
}

function chosenPair() {
  return data.pairs[chosen('work').figure + '|' + chosen('error').figure];
}

// What was picked, then the methods with most points that nothing beats.
function namedMethods() {
  const methods = data.methods.map((name, method) => method);
  if (methods.length <= namedMost) return methods;
  const count = new Map();
  chosenPair().front.forEach((index) => {
    const method = data.points[index].method;
    count.set(method, (count.get(method) || 0) + 1);
  });
  const best = [...count.keys()].sort((a, b) => count.get(b) - count.get(a) || a - b);
  return [...new Set(picked.slice(-namedMost).concat(best))].slice(0, namedMost).sort((a, b) => a - b);
}

// On a logarithmic axis nothing lies at 0: an error of 0 is shown at the bottom and its tip says so.
function floorOf(all) {
  const above = all.map((one) => one.y).filter((y) => y > 0);
  return above.length ? Math.min(...above) / 3 : 1e-6;
}

// One dataset for all pale curves: a point without a place ends each.
function paleDataset(named, curveOf) {
  const others = data.methods.map((name, method) => method).filter((method) => !named.includes(method));
  const gap = {x: NaN, y: NaN};
  const many = others.length > 100;  // thinner, and what lies below shows through
  const colour = css('--pale') + (many ? '80' : '');
  return {
    label: others.length + (others.length === 1 ? ' other method' : ' other methods'),
    data: others.flatMap((method) => curveOf(method).concat(gap)),
    borderColor: colour, backgroundColor: colour, borderWidth: many ? 0.7 : 1, borderDash: [], pointRadius: many ? 1.2 : 2,
    pointHoverRadius: 5, showLine: true, spanGaps: false, order: 3,
  };
}

function namedDataset(method, i, curve) {
  return {
    label: data.methods[method], data: curve, borderColor: seriesColour(i), backgroundColor: seriesColour(i),
    borderWidth: 1.8, borderDash: i >= 5 ? [5, 3] : [], pointRadius: 5, pointHoverRadius: 7,
    pointStyle: shapes[i % shapes.length], marker: marks[i % marks.length], showLine: true, order: 1,
  };
}

// The curve under the pointer, whatever its colour.
function lightUp(chart, shown) {
  const lit = chart.data.datasets[chart.data.datasets.length - 1];
  let method = null;
  chart.options.onHover = (event, items) => {
    const one = items.length ? items[0].element.$context.raw.one : null;
    if (!one || one.point.method === method) return;
    method = one.point.method;
    lit.data = pointsOf(method).map(shown);
    chart.update('none');
  };
}

function drawCurves() {
  placePoints();
  const floor = floorOf(placed);
  const shown = (one) => ({x: one.x, y: Math.max(one.y, floor), one});
  const named = namedMethods();
  const curveOf = (method) => pointsOf(method).map(shown);
  const datasets = named.map((method, i) => namedDataset(method, i, curveOf(method)));
  if (named.length < data.methods.length) datasets.push(paleDataset(named, curveOf));
  const place = new Map(placed.map((one) => [one.index, one]));
  const front = chosenPair().front.map((index) => place.get(index)).filter((one) => one).sort((a, b) => a.x - b.x).map(shown);
  datasets.push({
    label: 'nothing beats these', data: front, borderColor: css('--quiet'), backgroundColor: 'transparent', borderWidth: 1,
    borderDash: [2, 3], pointRadius: front.length > 40 ? 4 : 10, pointStyle: 'circle',
    pointBorderWidth: front.length > 40 ? 0.8 : 1.5, stepped: 'before', showLine: true, order: 2,
  });
  datasets.push({label: '', data: [], borderColor: css('--text'), backgroundColor: css('--text'), borderWidth: 2, borderDash: [],
    pointRadius: 3, pointHitRadius: 0, showLine: true, order: 0, unlisted: true});
  const logarithmic = (title) => axis(title, {type: 'logarithmic', ticks: {maxRotation: 0, autoSkipPadding: 18, callback: logText}});
  const chart = drawChart('curves', {
    type: 'scatter',
    data: {datasets},
    options: {
      parsing: false,
      interaction: {mode: 'nearest', intersect: false},
      scales: {x: logarithmic(titleOf(chosen('work'))), y: logarithmic(titleOf(chosen('error')))},
      plugins: {
        legend: {display: false},
        tooltip: {filter: (item, i) => i === 0 && item.raw.one, callbacks: {title: (items) => tipTitle(items), label: tipLabel}},
      },
    },
  });
  showLegend('curves', chart);
  lightUp(chart, shown);
  allowZoom(chart);
  const missing = data.points.length - placed.length;
  byId('curves-note').textContent = 'Both axes are logarithmic. Turn the wheel over the picture to zoom. ' +
    (data.knob ? 'Along a curve ' + data.knob + ' changes. ' : '') +
    (named.length < data.methods.length ? 'Coloured are the methods with most points that nothing beats; the pointer names the ' +
      'others, and a method picked in the table below is coloured, too. ' : '') +
    (missing > 0 ? missing + ' of ' + data.points.length + ' points have no such figures. ' : '') +
    (placed.some((one) => one.y === 0) ? 'An error of 0 is drawn below all others.' : '');
}

// Long names break in a tip that is no wider than the picture.
function inLines(text, longest) {
  const lines = [''];
  for (const word of text.split(' ')) {
    const line = lines[lines.length - 1];
    if (line && line.length + word.length > longest) lines.push(word);
    else lines[lines.length - 1] = line ? line + ' ' + word : word;
  }
  return lines;
}

function logText(value) {
  const lead = value / 10 ** Math.floor(Math.log10(value) + 1e-9);
  return [1, 2, 5].some((n) => Math.abs(lead - n) < 1e-6) ? digits(value) : '';
}

function tipTitle(items) {
  const one = items.length ? items[0].raw.one : null;
  if (!one) return '';
  return inLines(data.methods[one.point.method] + (data.knob ? ', ' + data.knob + ' = ' + one.point.knob : ''), narrow() ? 34 : 60);
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
  const named = namedMethods();
  const datasets = named.map((method, i) => namedDataset(method, i, curveOf(method))).filter((dataset) => dataset.data.length);
  if (named.length < data.methods.length) datasets.push(paleDataset(named, curveOf));
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

const rowsPerPage = 100;

// Of each table: the column that it is sorted by, the page that is shown.
const views = {needs: {column: -1, falling: false, page: 0}, points: {column: 0, falling: false, page: 0}};

function isNumber(cell) {
  return cell !== null && cell !== '' && !Number.isNaN(Number(cell));
}

// Numbers before words, and what is missing last.
function inOrder(a, b) {
  if (a === null || b === null) return (a === null) - (b === null);
  if (isNumber(a) && isNumber(b)) return Number(a) - Number(b);
  if (isNumber(a) !== isNumber(b)) return isNumber(a) ? -1 : 1;
  return String(a).localeCompare(String(b));
}

function matching(id, rows) {
  const words = byId(id + '-filter').value.toLowerCase().split(/\s+/).filter((word) => word);
  return rows.filter((row) => words.every((word) => row.join(' ').toLowerCase().includes(word)));
}

function headOf(id, columns, again) {
  const view = views[id];
  const row = element('tr');
  columns.forEach((name, column) => {
    const button = element('button', name + (view.column === column ? (view.falling ? ' ▼' : ' ▲') : ''));
    button.type = 'button';
    button.addEventListener('click', () => {
      Object.assign(view, {column, falling: view.column === column && !view.falling, page: 0});
      again();
    });
    const cell = element('th');
    cell.append(button);
    row.append(cell);
  });
  return row;
}

function showPager(id, shown, total, again) {
  const view = views[id], pages = Math.max(1, Math.ceil(shown / rowsPerPage));
  const turn = (text, by) => {
    const button = element('button', text);
    button.type = 'button';
    button.disabled = view.page + by < 0 || view.page + by >= pages;
    button.addEventListener('click', () => {
      view.page += by;
      again();
    });
    return button;
  };
  const from = view.page * rowsPerPage;
  const text = (shown === 0 ? 'none' : (from + 1) + '–' + Math.min(shown, from + rowsPerPage)) + ' of ' + shown +
    (shown < total ? ' that match, ' + total + ' in all' : '');
  byId(id + '-pager').replaceChildren(...(pages > 1 ? [turn('‹ Back', -1), turn('Next ›', 1)] : []), element('span', text));
}

// Rows that match the table's filter, in its order, a page of them. `fill(cell, row, column)` makes a cell.
function showTable(id, columns, rows, fill) {
  const view = views[id], again = () => showTable(id, columns, rows, fill);
  const found = matching(id, rows);
  if (view.column >= 0)
    found.sort((a, b) => inOrder(a[view.column], b[view.column]) * (view.falling ? -1 : 1));
  view.page = Math.max(0, Math.min(view.page, Math.ceil(found.length / rowsPerPage) - 1));
  const made = element('table');
  made.id = id;
  made.className = byId(id).className;
  made.append(element('thead'), element('tbody'));
  made.tHead.append(headOf(id, columns, again));
  for (const row of found.slice(view.page * rowsPerPage, (view.page + 1) * rowsPerPage)) {
    const line = element('tr');
    columns.forEach((name, column) => {
      const cell = element('td');
      fill(cell, row, column);
      line.append(cell);
    });
    made.tBodies[0].append(line);
  }
  byId(id).replaceWith(made);
  showPager(id, found.length, rows.length, again);
  byId(id + '-filter').oninput = () => {
    view.page = 0;
    again();
  };
}

// A method's name, and whether its curve is coloured.
function fillMethod(cell, method) {
  const button = element('button', data.methods[method]);
  button.type = 'button';
  button.className = 'method';
  button.setAttribute('aria-pressed', String(namedMethods().includes(method)));
  button.addEventListener('click', () => {
    picked = picked.includes(method) ? picked.filter((one) => one !== method) : picked.concat(method);
    drawAll();
    showNeeds();
  });
  cell.append(button);
}

function showNeeds() {
  const work = chosen('work'), error = chosen('error'), reach = chosenPair().reach;
  const rows = data.methods.map((name, method) => {
    const best = data.best_at_90_hz[method];
    return [name, reach[method] === null ? 'not reached' : reach[method],
      best ? best.error : 'none holds it', best ? best.knob : '–', method];
  });
  const many = data.methods.length > namedMost;
  if (many && views.needs.column < 0) views.needs.column = 1;
  showTable('needs', ['Method', titleOf(work) + ' to ' + error.label + ' ≤ ' + data.reach_error,
    'Least DSSIM (mean) at 90 Hz', data.knob || 'Setting'], rows, (cell, row, column) => {
    if (column === 0 && many) fillMethod(cell, row[4]);
    else cell.textContent = digits(row[column]);
  });
  byId('needs-note').textContent = 'Of the points that were run, nothing is interpolated. 90 Hz holds where the 99th ' +
    'percentiles of cast and warp together fit into 11.1 ms.' + (many ? ' Click a method to colour its curve.' : '');
}

const figureColumns = ['cast_ms_p50', 'cast_ms_p95', 'samples', 'rays', 'dssim_mean', 'dssim_p95', 'missed_ratio',
  'mtp_rotation_ms_p99', 'mtp_translation_ms_p99'].concat(
  data.along.map((one) => one.figure).filter((name) => name.startsWith('second_eye')));

function rowOf(point) {
  return [point.point].concat(point.settings, point.status, figureColumns.map((name) => point.figures[name]), point.message || '');
}

function showPoints() {
  showTable('points', ['Point'].concat(data.keys, 'Status', figureColumns, 'Message'), data.points.map(rowOf),
    (cell, row, column) => { cell.textContent = digits(row[column]); });
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

// Charts of the report: thin functions over Chart.js that know the page's colours, units and sizes.
'use strict';

const charts = [];

function css(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
}

function seriesColour(index) {
  return css('--series-' + (1 + index % 5));
}

function narrow() {
  return window.innerWidth < 520;
}

function drawChart(id, config) {
  Chart.defaults.color = css('--quiet');
  Chart.defaults.borderColor = css('--grid');
  Chart.defaults.font.family = getComputedStyle(document.body).fontFamily;
  Chart.defaults.animation = false;
  config.options = Object.assign({responsive: true, maintainAspectRatio: false}, config.options);
  const chart = new Chart(document.getElementById(id), config);
  charts.push(chart);
  return chart;
}

function axis(title, more) {
  return Object.assign({
    type: 'linear',
    title: {display: true, text: title},
    grid: {color: css('--grid'), drawTicks: false},
    ticks: {maxRotation: 0, autoSkipPadding: 14, padding: 6, includeBounds: false, callback: tickText},
  }, more);
}

// Every tick with the decimals that the step between ticks needs, so that 0.1 stands above 0.08 as 0.10.
function tickText(value, index, ticks) {
  const step = ticks.length > 1 ? Math.abs(ticks[1].value - ticks[0].value) : 1;
  const decimals = [0, 1, 2, 3, 4, 5, 6].find((n) => Math.abs(step * 10 ** n - Math.round(step * 10 ** n)) < 1e-6);
  return value.toFixed(decimals === undefined ? 6 : decimals);
}

// What the colours and dashes mean, below the chart; a click hides and shows. Chart.js' own legend cannot show
// a dashed line. None for a single dataset.
function showLegend(id, chart) {
  const box = document.getElementById(id).parentElement;
  if (box.nextElementSibling && box.nextElementSibling.matches('.legend')) box.nextElementSibling.remove();
  const datasets = chart.data.datasets;
  if (datasets.filter((dataset) => !dataset.unlisted).length < 2) return;
  const list = document.createElement('ul');
  list.className = 'legend';
  datasets.forEach((dataset, i) => {
    if (dataset.unlisted) return;
    const key = document.createElement('button');
    const swatch = document.createElement('i');
    key.type = 'button';
    if (dataset.borderColor) {
      swatch.className = 'line';
      swatch.style.borderTop = '2px ' + (dataset.borderDash.length ? 'dashed ' : 'solid ') + dataset.borderColor;
    } else {
      swatch.style.background = dataset.backgroundColor;
    }
    key.setAttribute('aria-pressed', 'true');
    key.append(swatch, ...(dataset.marker ? [markOf(dataset)] : []), dataset.label);
    key.addEventListener('click', () => {
      const visible = !chart.isDatasetVisible(i);
      chart.setDatasetVisibility(i, visible);
      chart.update();
      key.setAttribute('aria-pressed', String(visible));
    });
    const item = document.createElement('li');
    item.append(key);
    list.append(item);
  });
  box.after(list);
}

// The shape of a dataset's points, where they have one of their own.
function markOf(dataset) {
  const mark = document.createElement('b');
  mark.textContent = dataset.marker;
  mark.style.color = dataset.borderColor;
  return mark;
}

// A line: {label, points: [[x, y], …], colour, dashed}.
function lineDataset(line) {
  return {
    label: line.label,
    data: line.points.map(([x, y]) => ({x, y})),
    borderColor: line.colour,
    backgroundColor: line.colour,
    borderWidth: line.points.length > 600 ? 1 : 1.6,
    borderDash: line.dashed ? [5, 3] : [],
    pointRadius: line.points.length < 40 ? 2 : 0,
    pointHitRadius: 6,
    stepped: line.stepped || false,
    fill: false,
  };
}

function drawLines(id, lines, options) {
  const chart = drawChart(id, {
    type: 'line',
    data: {datasets: lines.map(lineDataset)},
    options: {
      parsing: false,
      interaction: {mode: 'nearest', axis: 'x', intersect: false},
      scales: {
        x: axis(options.x, {min: options.xMin, max: options.xMax}),
        y: axis(options.y, {beginAtZero: true, ticks: {padding: 6, maxTicksLimit: 7, callback: tickText}}),
      },
      plugins: {
        legend: {display: false},
        tooltip: {
          callbacks: {
            title: (items) => items.length ? options.tipTitle(items[0].parsed.x) : '',
            label: (item) => item.dataset.label + ': ' + options.tip(item.parsed.y),
          },
        },
      },
    },
  });
  showLegend(id, chart);
  return chart;
}

function drawBars(id, series, options) {
  const chart = drawChart(id, {
    type: 'bar',
    data: {
      datasets: series.map((one) => ({
        label: one.label, data: one.points.map(([x, y]) => ({x, y})), backgroundColor: one.colour,
        categoryPercentage: 1, barPercentage: 0.95, minBarLength: 0,
      })),
    },
    options: {
      scales: {
        x: axis(options.x, {min: options.xMin, max: options.xMax, offset: false}),
        y: axis(options.y, {beginAtZero: true, suggestedMax: options.yLeast, ticks: {padding: 6, maxTicksLimit: 6, callback: tickText}}),
      },
      plugins: {
        legend: {display: false},
        tooltip: {
          callbacks: {
            title: (items) => items.length ? options.tipTitle(items[0].parsed.x) : '',
            label: (item) => item.dataset.label + ': ' + options.tip(item.parsed.y),
          },
        },
      },
    },
  });
  showLegend(id, chart);
  return chart;
}

// A histogram as an outline: bins {from, width, share: [percent, …]}.
function histogramPoints(bins) {
  const points = [[bins.from, 0]];
  bins.share.forEach((share, i) => {
    points.push([bins.from + i * bins.width, share], [bins.from + (i + 1) * bins.width, share]);
  });
  points.push([bins.from + bins.share.length * bins.width, 0]);
  return points;
}

// Lines at each vsync, a cross where it was missed, and frame numbers in bars that have room for them.
const timelineMarks = {
  id: 'timelineMarks',
  beforeDatasetsDraw(chart) {
    const {ctx, chartArea: area, scales: {x}} = chart;
    ctx.save();
    ctx.lineWidth = 1;
    for (const mark of chart.options.marks) {
      const at = x.getPixelForValue(mark.t);
      if (at < area.left - 1 || at > area.right + 1) continue;
      ctx.strokeStyle = mark.missed ? css('--missed') : css('--vsync');
      ctx.setLineDash(mark.missed ? [] : [3, 3]);
      ctx.beginPath();
      ctx.moveTo(at, area.top - (mark.missed ? 4 : 0));
      ctx.lineTo(at, area.bottom);
      ctx.stroke();
      if (!mark.missed) continue;
      ctx.setLineDash([]);
      ctx.lineWidth = 2;
      ctx.beginPath();
      ctx.moveTo(at - 4, area.top - 14); ctx.lineTo(at + 4, area.top - 6);
      ctx.moveTo(at + 4, area.top - 14); ctx.lineTo(at - 4, area.top - 6);
      ctx.stroke();
      ctx.lineWidth = 1;
    }
    ctx.restore();
  },
  afterDatasetsDraw(chart) {
    const {ctx, chartArea: area} = chart;
    ctx.save();
    ctx.font = '11px ' + Chart.defaults.font.family;
    ctx.textAlign = 'center';
    ctx.textBaseline = 'middle';
    ctx.beginPath();
    ctx.rect(area.left, area.top, area.width, area.height);
    ctx.clip();
    chart.data.datasets.forEach((dataset, index) => {
      chart.getDatasetMeta(index).data.forEach((bar, i) => {
        const text = dataset.data[i].text;
        if (text === undefined) return;
        const {x, base, y} = bar.getProps(['x', 'base', 'y'], true);
        const left = Math.max(Math.min(x, base), area.left);
        const right = Math.min(Math.max(x, base), area.right);
        if (right - left < ctx.measureText(text).width + 4) return;
        ctx.fillStyle = dataset.data[i].ink;
        ctx.fillText(text, (left + right) / 2, y);
      });
    });
    ctx.restore();
  },
};

// bars: {lane: [{from, to, text, colour, ink, tip}, …]}; marks: [{t, missed}, …]; times in ms.
function drawTimeline(id, lanes, bars, marks, from, to) {
  const datasets = lanes.map((lane) => ({
    label: lane,
    data: bars[lane].map((bar) => Object.assign({x: [bar.from, bar.to], y: lane}, bar)),
    backgroundColor: bars[lane].map((bar) => bar.colour),
    grouped: false, barPercentage: 0.75, categoryPercentage: 0.9, borderSkipped: false, borderRadius: 2,
  }));
  return drawChart(id, {
    type: 'bar',
    data: {labels: lanes, datasets},
    plugins: [timelineMarks],
    options: {
      indexAxis: 'y',
      marks,
      layout: {padding: {top: 18}},
      scales: {
        x: axis('simulated time, ms', {min: from, max: to, grid: {display: false}}),
        y: {type: 'category', labels: lanes, grid: {display: false}, ticks: {color: css('--text'), autoSkip: false}},
      },
      plugins: {
        legend: {display: false},
        tooltip: {callbacks: {title: () => '', label: (item) => item.raw.tip}},
      },
    },
  });
}

// Charts along the speed: dygraphs draws, zooms and reads; this file links their cursors and windows, shades bands and
// takes a click to the nearest computed speed.
const charts = [];

const nearestRow = (x, at) => {
  let best = 0;
  for (let k = 1; k < x.length; ++k) if (Math.abs(x[k] - at) < Math.abs(x[best] - at)) best = k;
  return best;
};

// 1, 2, 5 of each decade, or decades alone, or every so many of them, as there is room.
const logTicks = (low, high, pixels) => {
  const decades = Math.log10(high / low), room = Math.max(2, pixels / 34);
  const steps = 3 * decades <= room ? [1, 2, 5] : [1], every = Math.max(1, Math.ceil(decades / room));
  const ticks = [];
  for (let e = Math.floor(Math.log10(low)); e <= Math.ceil(Math.log10(high)); ++e) {
    if (e % every !== 0) continue;
    for (const m of steps) { const v = m * Math.pow(10, e); if (v >= low && v <= high) ticks.push({v, label: short(v, 3)}); }
  }
  return ticks;
};

class SpeedChart {
  // columns: [{label, values (one per row; NaN: none there, null: not asked there), colour, dash, dots}], over the
  // rows' x.
  constructor(host, {label, x, columns, yLabel, logscale = false, yRange = null, bands = [], under = () => {}, over = () => {}, labels = () => {}}) {
    this.host = host;
    this.x = x;
    this.under = under;
    const rows = Array.from(x, (v, k) => [v, ...columns.map((c) => { const y = c.values[k]; return y === null || (Number.isFinite(y) && (!logscale || y > 0)) ? y : NaN; })]);
    const series = {};
    columns.forEach((c) => { series[c.label] = {color: `var(--${c.colour})`, strokePattern: c.dash || null, strokeWidth: c.width || 1.6, drawPoints: !!c.dots, pointSize: 2.4}; });
    this.columns = columns;
    const box = element("div", {style: "width:100%;height:100%"});
    clear(host);
    host.append(box);
    this.box = box;
    this.here = element("div", {class: "here"});
    this.chart = new Dygraph(box, rows, {
      labels: ["x", ...columns.map((c) => c.label)],
      series: this.inColours(series),
      xlabel: withUnit(report.axis.label, report.axis.unit), ylabel: yLabel,
      logscale, valueRange: yRange, dateWindow: state.zoom ? [...state.zoom] : null, connectSeparatedPoints: true,
      legend: "onmouseover", labelsSeparateLines: false, highlightCircleSize: 3.5, xRangePad: 4, yRangePad: logscale ? 0 : 8,
      axisLabelFontSize: 12, gridLineColor: colours.grid, axisLineColor: colours.rule,
      axes: {x: {pixelsPerLabel: 50, axisLabelFormatter: (v) => short(v, 5), valueFormatter: (v) => `${report.axis.symbol || "x"} ${short(v, 7)}`},
        y: {axisLabelWidth: 64, ...(logscale ? {ticker: logTicks} : {}), axisLabelFormatter: (v) => short(v, 4), valueFormatter: (v) => short(v, 5)}},
      underlayCallback: (pen, area, chart) => {
        pen.save();
        pen.beginPath();
        pen.rect(area.x, area.y, area.w, area.h);
        pen.clip();
        pen.fillStyle = colours["unstable-band"];
        for (const band of bands) {
          const a = chart.toDomXCoord(band.from), b = chart.toDomXCoord(band.to);
          pen.fillRect(a, area.y, Math.max(1, b - a), area.h);
        }
        under(pen, area, chart);
        pen.restore();
      },
      drawCallback: (chart) => { this.chart = chart; this.place(); labels(chart, this.host); },
      zoomCallback: (from, to) => shareZoom(this, from, to),
      highlightCallback: (event, at, found, row) => { for (const other of charts) if (other !== this) other.chart.setSelection(other.x === this.x ? row : nearestRow(other.x, at)); },
      unhighlightCallback: () => { for (const other of charts) if (other !== this && other.chart.getSelection() !== -1) other.chart.clearSelection(); },
      // Mouse only: touches scroll the page, and a tap is a click.
      interactionModel: {
        mousedown: (event, chart, context) => { context.initializeMouseDown(event, chart, context); Dygraph.startZoom(event, chart, context); },
        mousemove: (event, chart, context) => { if (context.isZooming) Dygraph.moveZoom(event, chart, context); },
        mouseup: (event, chart, context) => { if (context.isZooming) Dygraph.endZoom(event, chart, context); },
        dblclick: (event, chart) => chart.resetZoom(),
      },
    });
    host.append(this.here);
    this.label = label;
    host.setAttribute("role", "img");
    host.setAttribute("aria-label", label);
    let down = null;
    host.addEventListener("mousedown", (event) => { down = [event.clientX, event.clientY]; }, true);
    host.addEventListener("click", (event) => {
      if (down && Math.hypot(event.clientX - down[0], event.clientY - down[1]) > 4) return;
      const left = box.getBoundingClientRect().left, at = this.chart.toDataXCoord(event.clientX - left);
      if (Number.isFinite(at)) chooseSpeed(nearestIndex(at));
    });
    charts.push(this);
    onSpeed.push(() => this.place());
  }

  inColours(series) {
    for (const c of this.columns) series[c.label].color = colours[c.colour];
    return series;
  }
  place() {
    if (!this.chart || !this.chart.getArea) return;
    const area = this.chart.getArea(), at = this.chart.toDomXCoord(points.x[state.index]);
    const inside = at >= area.x - 1 && at <= area.x + area.w + 1;
    this.here.hidden = !inside || points.count === 0;
    this.here.style.left = at - 1 + "px";
    this.here.style.top = area.y + "px";
    this.here.style.height = area.h + "px";
  }
  // Once, with colours and size as they are now.
  redraw() {
    const size = this.chart.size(), resized = size.width !== this.box.clientWidth || size.height !== this.box.clientHeight;
    const series = {};
    this.columns.forEach((c) => { series[c.label] = {strokePattern: c.dash || null, strokeWidth: c.width || 1.6, drawPoints: !!c.dots, pointSize: 2.4}; });
    this.chart.updateOptions({series: this.inColours(series), gridLineColor: colours.grid, axisLineColor: colours.rule}, resized);
    if (resized) this.chart.resize();
  }
  // On paper the cleared canvas that dygraphs keeps on top for the pointer covers the chart: a copy of the chart stands
  // for both.
  onPaper(on) {
    for (const old of this.box.querySelectorAll(".paper")) old.remove();
    const canvases = [...this.box.querySelectorAll("canvas")], chart = canvases[0];
    for (const canvas of canvases) canvas.style.visibility = on ? "hidden" : "";
    if (!on || !chart) return;
    const copy = element("canvas", {class: "paper", width: chart.width, height: chart.height});
    copy.style.cssText = "position:absolute;left:0;top:0;width:" + chart.style.width + ";height:" + chart.style.height;
    copy.getContext("2d").drawImage(chart, 0, 0);
    chart.after(copy);
  }
}

let sharing = false;
const shareZoom = (from, low, high) => {
  if (sharing) return;
  sharing = true;
  const first = points.x[0], last = points.x[points.count - 1];
  const whole = low <= first && high >= last;
  state.zoom = whole ? null : [low, high];
  for (const chart of charts) if (chart !== from) chart.chart.updateOptions({dateWindow: whole ? null : [low, high]});
  sharing = false;
  writeFragment();
};

// Values split in two curves: where linear theory holds, and beyond it ("1" of `marks`), drawn grey and dashed.
const splitByMarks = (marks, label, values, colour, width) => {
  if (!marks || !marks.includes("1")) return [{label, values, colour, width}];
  const inside = new Float64Array(values.length).fill(NaN), outside = new Float64Array(values.length).fill(NaN);
  for (let k = 0; k < values.length; ++k) {
    if (marks[k] === "1") outside[k] = values[k]; else inside[k] = values[k];
    // Both ends of the piece between a good and a bad point belong to the dashed curve.
    if (marks[k] !== "1" && (marks[k - 1] === "1" || marks[k + 1] === "1")) outside[k] = values[k];
  }
  return [{label, values: inside, colour, width}, {label: label + " beyond linear theory", values: outside, colour: "rigid", dash: [4, 3]}];
};
const splitByTheory = (rod, label, values, colour) => splitByMarks(report.along.rods[rod].beyond, label, values, colour);

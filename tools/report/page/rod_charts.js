// Campbell diagram, growth rate and response of each rod along the speed.
const crankHertz = (x) => {
  switch (report.axis.kind) {
    case "rpm": return x / 60;
    case "omega": return x * units.hertz;
    default: return points.omega[0] * units.hertz;
  }
};

// Order lines n Omega, and half orders dashed: where parametric resonances of the modes start.
const orderLines = (top, most) => {
  const slowest = crankHertz(points.x[0]), lines = [];
  for (let half = 1; half <= 2 * most; ++half) {
    const order = half / 2, whole = half % 2 === 0;
    if ((whole || half <= 7) && order * slowest <= top) lines.push({order, whole});
  }
  return lines;
};
const drawOrders = (lines) => (pen, area, chart) => {
  const [x0, x1] = chart.xAxisRange();
  for (const {order, whole} of lines) {
    pen.strokeStyle = whole ? colours.order : colours.ghost;
    pen.lineWidth = whole ? 1.2 : 1;
    pen.setLineDash(whole ? [] : [4, 4]);
    pen.beginPath();
    pen.moveTo(chart.toDomXCoord(x0), chart.toDomYCoord(order * crankHertz(x0)));
    pen.lineTo(chart.toDomXCoord(x1), chart.toDomYCoord(order * crankHertz(x1)));
    pen.stroke();
  }
  pen.setLineDash([]);
};
// Names of whole orders where they leave the picture, as many as there is room for.
const nameOrders = (lines) => (chart, host) => {
  for (const old of host.querySelectorAll(".order")) old.remove();
  const area = chart.getArea(), [x0, x1] = chart.xAxisRange(), [y0, y1] = chart.yAxisRange();
  const taken = [];
  for (const {order, whole} of lines) {
    if (!whole) continue;
    const name = order === 1 ? "Ω" : `${order}Ω`;
    const atEnd = order * crankHertz(x1);
    let left = area.x + area.w, top, right = true;
    if (atEnd <= y1) {
      if (atEnd < y0) continue;
      top = chart.toDomYCoord(atEnd);
    } else {
      const slope = crankHertz(x1) - crankHertz(x0);
      if (!(slope > 0)) continue;
      const x = x0 + ((y1 / order - crankHertz(x0)) / slope) * (x1 - x0);
      if (x <= x0) continue;
      left = chart.toDomXCoord(x); top = area.y + 14; right = false;
    }
    if (taken.some(([l, t]) => Math.abs(l - left) < 30 && Math.abs(t - top) < 13)) continue;
    taken.push([left, top]);
    host.append(element("div", {class: right ? "order right" : "order", style: `left:${left}px;top:${top}px`}, name));
  }
};

const markCritical = (rod, yOf) => (pen, area, chart) => {
  for (const peak of criticalOf(rod)) {
    const y = yOf(peak);
    if (!Number.isFinite(y)) continue;
    pen.beginPath();
    pen.arc(chart.toDomXCoord(peak.x), chart.toDomYCoord(y), 4, 0, 2 * Math.PI);
    pen.fillStyle = colours.ink;
    pen.fill();
  }
};

// Orange is for what grows.
const lineColour = (i) => ["c1", "c3", "c4", "c5", "c6", "c7"][i % 6];

const campbellChart = (host, rod, along, x) => {
  const frequencies = along.frequency.map((ref) => floats(ref)), growth = along.growth.map(floats);
  const fastest = crankHertz(points.x[points.count - 1]);
  const finite = (list) => Array.from(list).filter(Number.isFinite);
  let top = 2 * fastest;
  for (const f of frequencies.slice(0, 2)) top = Math.max(top, 1.15 * Math.max(0, ...finite(f)));
  if (!isLinkage) top = Math.max(...frequencies.map((f) => 1.3 * Math.max(0, ...finite(f)))) || top;
  const shown = frequencies.map((f, i) => ({f, i})).filter(({f}) => finite(f).some((v) => v <= 1.02 * top));
  const columns = shown.map(({f, i}) => ({label: "mode " + (i + 1), values: f, colour: lineColour(i), width: 2}));
  for (const {f, i} of shown) {
    const growing = f.map((v, k) => (growth[i][k] > 0 ? v : NaN));
    if (finite(growing).length > 0) columns.push({label: `mode ${i + 1} growing`, values: growing, colour: "unstable", width: 4.5});
  }
  const orders = criticalOf(rod.name).map((peak) => peak.order || 0);
  const lines = orderLines(top, Math.min(16, Math.max(6, 2 + Math.max(0, ...orders)))), marks = markCritical(rod.name, (peak) => (peak.frequency === undefined ? NaN : peak.frequency * units.hertz));
  new SpeedChart(host, {
    label: `Campbell diagram of ${rod.name}: frequencies of ${shown.length} modes, order lines, ${bandsOf(rod.name).length} unstable bands`,
    x, columns, yLabel: "frequency [Hz]", yRange: [0, top], bands: bandsOf(rod.name),
    under: (pen, area, chart) => { drawOrders(lines)(pen, area, chart); marks(pen, area, chart); }, labels: nameOrders(lines),
  });
  const items = shown.map(({i}) => ({text: "mode " + (i + 1), colour: lineColour(i)}));
  const left = frequencies.length - shown.length;
  host.after(legend([...items, {text: "growing", colour: "unstable"}, {text: "nΩ", colour: "order"}, {text: "nΩ/2", colour: "ghost", dashed: true}, {text: "unstable band, ends computed", colour: "unstable-band", box: true}]),
    element("p", {class: "caption"}, `Dots: resonance peaks. Drag to zoom, double click for the whole, click for that speed.${left > 0 ? ` ${left} ${left === 1 ? "mode lies" : "modes lie"} above the picture.` : ""}`));
};

const growthChart = (host, rod, along, x) => {
  const rate = floats(along.growth_rate), error = floats(along.growth_error);
  const low = rate.map((v, k) => v - error[k]), high = rate.map((v, k) => v + error[k]);
  const sorted = Array.from(rate).filter(Number.isFinite).sort((a, b) => a - b);
  const size = sorted.length ? Math.max(Math.abs(sorted[Math.floor(0.02 * sorted.length)]), Math.abs(sorted[sorted.length - 1])) : 1;
  const seen = error.some((e) => e > 0.004 * size);
  const columns = [{label: "growth", values: rate, colour: "c1", width: 2}];
  if (seen) columns.push({label: "lower end of the error", values: low, colour: "rigid", dash: [2, 3], width: 1}, {label: "upper end of the error", values: high, colour: "rigid", dash: [2, 3], width: 1});
  const most = Math.max(0, sorted[sorted.length - 1] || 0), least = Math.min(0, sorted[0] || 0), pad = 0.08 * (most - least || 1);
  new SpeedChart(host, {
    label: `Growth rate of ${rod.name} along the speed`, x, columns, yLabel: withUnit("growth rate", units.rate), bands: bandsOf(rod.name), yRange: [least - pad, most + pad],
    under: (pen, area, chart) => {
      const zero = chart.toDomYCoord(0);
      pen.strokeStyle = colours.unstable; pen.lineWidth = 1.2;
      pen.beginPath(); pen.moveTo(area.x, zero); pen.lineTo(area.x + area.w, zero); pen.stroke();
    },
  });
  host.after(element("p", {class: "caption"}, `Above zero disturbances grow. Errors ${seen ? "are drawn" : "are below the line's width"}; the table has them.`));
};

// Values at the computed points that are stable, of a column over all rows.
const stableValues = (rod, values, x) => {
  const fine = [];
  let k = 0;
  for (let row = 0; row < x.length; ++row) {
    while (k < points.count && points.x[k] < x[row]) ++k;
    const stable = points.x[k] === x[row] && ["stable", "bounded"].includes(verdictOf(rod, k));
    if (stable && values[row] > 0) fine.push(values[row]);
  }
  return fine;
};

const responseChart = (host, rod, along, x) => {
  const columns = [];
  along.max_abs.slice(0, 3).forEach((ref, i) => columns.push(...splitByTheory(rod.name, "max |q" + subscript(i + 1) + "|", floats(ref), "c" + (1 + i))));
  const values = columns.flatMap((c) => Array.from(c.values)).filter((v) => Number.isFinite(v) && v > 0);
  if (values.length === 0) { host.append(element("p", {class: "missing"}, "No response: it was not asked for, or there is none.")); return; }
  const branches = branchCurves(rod.name, 0);
  const all = [...values, ...branches.flatMap((b) => b.y.filter((v) => v > 0))];
  // Resonance spikes would flatten all that is valid: the picture reaches well above the stable speeds.
  const fine = stableValues(rod.name, floats(along.max_abs[0]), x);
  const top = Math.min(1.6 * Math.max(...all), fine.length ? 100 * Math.max(...fine) : Infinity), bottom = Math.max(Math.min(...all) / 1.6, 1e-7 * top);
  new SpeedChart(host, {
    label: `Largest response of ${rod.name} along the speed`, x, columns, yLabel: withUnit("max |q|", units.response), logscale: true, yRange: [bottom, top], bands: bandsOf(rod.name),
    under: (pen, area, chart) => { drawBranches(branches)(pen, area, chart); markCritical(rod.name, (peak) => (peak.max_abs === null ? NaN : peak.max_abs))(pen, area, chart); },
  });
  const beyond = columns.some((c) => c.dash);
  host.after(legend([...along.max_abs.slice(0, 3).map((_, i) => ({text: "max |q" + subscript(i + 1) + "|", colour: "c" + (1 + i)})),
    ...(beyond ? [{text: "beyond linear theory", colour: "rigid", dashed: true}] : []), ...branchLegend(branches)]));
};

const setUpCharts = () => {
  const caption = document.getElementById("speeds-caption");
  if (!report.along || points.count < 2) {
    const section = document.getElementById("speeds");
    for (const host of section.querySelectorAll("[data-chart]")) host.append(element("p", {class: "missing"}, points.count === 1 ? "One speed only: hb sweep or hb report computes more." : "This page holds no sweep."));
    section.classList.add("empty");
    return;
  }
  const x = doubles(report.along.x);
  caption.textContent = report.along.words || "";
  for (const views of document.querySelectorAll("#speeds .rod-views")) {
    const rod = rods.find((r) => r.name === views.dataset.rod), along = rod && report.along.rods[rod.name];
    if (rods.length === 1 && !isLinkage) views.querySelector(".rod-title").hidden = true;
    for (const host of views.querySelectorAll("[data-chart]")) {
      const stability = along && along.growth_rate;
      if (host.dataset.chart === "campbell") { if (stability && along.frequency) campbellChart(host, rod, along, x); else host.append(element("p", {class: "missing"}, "Stability was not asked for: no frequencies.")); }
      if (host.dataset.chart === "growth") { if (stability) growthChart(host, rod, along, x); else host.append(element("p", {class: "missing"}, "Stability was not asked for.")); }
      if (host.dataset.chart === "response") { if (along && along.max_abs) responseChart(host, rod, along, x); else host.append(element("p", {class: "missing"}, "The response was not asked for.")); }
    }
  }
};

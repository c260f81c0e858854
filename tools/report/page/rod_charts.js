// Campbell diagram, growth rate and response of each rod along the speed.
// The speed as a frequency, in the unit of the modes' frequencies.
const crankFrequency = (x) => (isSpeedAxis ? x * (points.omega[0] / points.x[0]) : points.omega[0]) * units.frequency.factor;

// Order lines n Omega, and half orders dashed: where parametric resonances of the modes start.
const orderLines = (top, most) => {
  const slowest = crankFrequency(points.x[0]), lines = [];
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
    pen.moveTo(chart.toDomXCoord(x0), chart.toDomYCoord(order * crankFrequency(x0)));
    pen.lineTo(chart.toDomXCoord(x1), chart.toDomYCoord(order * crankFrequency(x1)));
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
    const atEnd = order * crankFrequency(x1);
    let left = area.x + area.w, top, right = true;
    if (atEnd <= y1) {
      if (atEnd < y0) continue;
      top = chart.toDomYCoord(atEnd);
    } else {
      const slope = crankFrequency(x1) - crankFrequency(x0);
      if (!(slope > 0)) continue;
      const x = x0 + ((y1 / order - crankFrequency(x0)) / slope) * (x1 - x0);
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

// Locked to the crank a mode's frequency is known up to multiples of half the speed: where it jumps by them, its line
// breaks. Rows behind which some mode of some rod does.
const jumps = (f, k, x) => Math.abs(f[k + 1] - f[k]) > 0.35 * crankFrequency(x[k]);
const jumpRows = (x) => {
  const rows = new Set();
  for (const along of Object.values(report.along.rods))
    for (const f of (along.frequency || []).map((ref) => floats(ref))) for (let k = 0; k + 1 < x.length; ++k) if (jumps(f, k, x)) rows.add(k);
  return rows;
};
// One list for all charts, whose cursors go by rows.
let gapped = null;
const gappedX = (x) => {
  if (!gapped) { const rows = jumpRows(x); gapped = {rows, x: Float64Array.from(withGaps(x, rows, (k) => 0.5 * (x[k] + x[k + 1])))}; }
  return gapped.x;
};
const spread = (columns) => columns.map((c) => ({...c, values: withGaps(c.values, gapped.rows, () => null)}));
// Values over rows with one more behind each of these.
const withGaps = (values, rows, at) => Array.from(values).flatMap((v, k) => (rows.has(k) ? [v, at(k)] : [v]));

const campbellChart = (host, rod, along, x) => {
  const frequencies = along.frequency.map((ref) => floats(ref)), growth = along.growth.map(floats);
  const fastest = crankFrequency(points.x[points.count - 1]);
  const finite = (list) => Array.from(list).filter(Number.isFinite);
  const highest = frequencies.map((f) => Math.max(0, ...finite(f)));
  // Mode 1 whole, mode 2 where low orders reach it: higher ones would press what matters to the bottom.
  let top = Math.max(2 * fastest, 1.25 * highest[0], Math.min(1.15 * (highest[1] || 0), 6.5 * fastest));
  if (!isLinkage) top = 1.3 * Math.max(...highest) || top;
  // A mode that does not swing at all (overdamped) has no line.
  const swings = highest.map((f) => f > 1e-6 * top);
  const shown = frequencies.map((f, i) => ({f: f.map((v) => (v > 0 ? v : NaN)), i})).filter(({f, i}) => swings[i] && finite(f).some((v) => v <= 1.02 * top));
  gappedX(x);
  const broken = (values, f) => withGaps(values, gapped.rows, (k) => (jumps(f, k, x) ? NaN : null));
  const columns = shown.map(({f, i}) => ({label: "mode " + (i + 1), values: broken(f, f), colour: lineColour(i), width: 2}));
  for (const {f, i} of shown) {
    const growing = f.map((v, k) => (growth[i][k] > 0 ? v : NaN));
    if (finite(growing).length > 0) columns.push({label: `mode ${i + 1} growing`, values: broken(growing, f), colour: "unstable", width: 4.5});
  }
  const orders = criticalOf(rod.name).map((peak) => peak.order || 0);
  const lines = orderLines(top, Math.min(16, Math.max(6, 2 + Math.max(0, ...orders)))), marks = markCritical(rod.name, (peak) => (peak.frequency === undefined ? NaN : peak.frequency * units.frequency.factor));
  new SpeedChart(host, {
    label: `Campbell diagram of ${rod.name}: frequencies of ${shown.length} mode${shown.length === 1 ? "" : "s"}, order lines, ${bandsOf(rod.name).length} unstable band${bandsOf(rod.name).length === 1 ? "" : "s"}`,
    x: gappedX(x), columns, yLabel: `frequency [${units.frequency.name}]`, yRange: [0, top], bands: bandsOf(rod.name),
    under: (pen, area, chart) => { drawOrders(lines)(pen, area, chart); marks(pen, area, chart); }, labels: nameOrders(lines),
  });
  const items = shown.map(({i}) => ({text: "mode " + (i + 1), colour: lineColour(i)}));
  const still = swings.filter((swing) => !swing).length, left = frequencies.length - shown.length - still;
  const grows = columns.some((c) => c.colour === "unstable");
  host.after(legend([...items, ...(grows ? [{text: "growing", colour: "unstable"}] : []), {text: "nΩ", colour: "order"}, {text: "nΩ/2", colour: "ghost", dashed: true}, ...(bandsOf(rod.name).length ? [{text: "unstable band, ends computed", colour: "unstable-band", box: true}] : [])]),
    element("p", {class: "caption"}, criticalOf(rod.name).length ? "Dots: resonance peaks. " : "", element("span", {class: "hint"}, "Drag to zoom, double click to see all, click to go to that speed."), `${left > 0 ? ` ${left} ${left === 1 ? "mode lies" : "modes lie"} above the picture.` : ""}${still > 0 ? ` ${still} ${still === 1 ? "mode is" : "modes are"} so strongly damped that ${still === 1 ? "it does" : "they do"} not swing.` : ""}`));
};

// Growth rate less and more by what the linear theory leaves out, at points where this link's is the mechanism's (the
// largest of all); null where that is not known.
const theoryAround = (rod, rate, x) => {
  if (nonlinear) return null;
  const own = atPoints(x, rate), low = new Float64Array(points.count).fill(NaN), high = low.slice();
  let known = false;
  for (let k = 0; k < points.count; ++k) {
    const here = place(k), numbers = here && here.numbers, error = numbers && numbers.growth_theory_error;
    if (!Number.isFinite(error) || !Number.isFinite(own[k])) continue;
    const mine = (numbers.rods[rod.name] || {}).growth_rate;
    if (Object.values(numbers.rods).some((other) => other.growth_rate > mine)) continue;
    low[k] = own[k] - error; high[k] = own[k] + error;
    known = true;
  }
  return known ? {low, high} : null;
};
const drawTheory = (theory) => (pen, area, chart) => {
  if (!theory) return;
  pen.strokeStyle = colours.rigid; pen.lineWidth = 1; pen.setLineDash([5, 4]);
  for (const values of [theory.low, theory.high]) {
    pen.beginPath();
    let down = false;
    for (let k = 0; k < points.count; ++k) {
      if (!Number.isFinite(values[k])) { down = down && !isKept(k); continue; }
      const px = chart.toDomXCoord(points.x[k]), py = Math.max(area.y - 1e4, Math.min(area.y + area.h + 1e4, chart.toDomYCoord(values[k])));
      if (down) pen.lineTo(px, py); else pen.moveTo(px, py);
      down = true;
    }
    pen.stroke();
  }
  pen.setLineDash([]);
};

const growthChart = (host, rod, along, x) => {
  const rate = floats(along.growth_rate), error = floats(along.growth_error);
  const low = rate.map((v, k) => v - error[k]), high = rate.map((v, k) => v + error[k]);
  const sorted = Array.from(rate).filter(Number.isFinite).sort((a, b) => a - b);
  const size = sorted.length ? Math.max(Math.abs(sorted[Math.floor(0.02 * sorted.length)]), Math.abs(sorted[sorted.length - 1])) : 1;
  const seen = error.some((e) => e > 0.004 * size);
  const branches = nonlinear ? growthBranches().filter((branch) => branch.y.length > 0) : [];
  for (const branch of branches) sorted.push(...Array.from(branch.y).filter(Number.isFinite));
  sorted.sort((a, b) => a - b);
  const around = bandsAround(rod, "growth_rate", x, [rate], ["c1"]), theory = theoryAround(rod, rate, x);
  for (const bands of around) for (const {low: least, high: most} of bands) sorted.push(...[...least, ...most].filter(Number.isFinite));
  sorted.sort((a, b) => a - b);
  const columns = [{label: nonlinear ? "linear" : "growth", values: rate, colour: nonlinear ? "rigid" : "c1", width: nonlinear ? 1.4 : 2}];
  if (seen) columns.push({label: "lower end of the error", values: low, colour: "rigid", dash: [2, 3], width: 1}, {label: "upper end of the error", values: high, colour: "rigid", dash: [2, 3], width: 1});
  const most = Math.max(0, sorted[sorted.length - 1] || 0), least = Math.min(0, sorted[0] || 0), pad = 0.08 * (most - least || 1);
  new SpeedChart(host, {
    label: `Growth rate of ${rod.name} along the speed`, x: gappedX(x), columns: spread(columns), yLabel: withUnit("growth rate", units.rate), bands: nonlinear ? [] : bandsOf(rod.name), yRange: [least - pad, most + pad],
    under: (pen, area, chart) => {
      const zero = chart.toDomYCoord(0);
      pen.strokeStyle = colours.unstable; pen.lineWidth = 1.2;
      pen.beginPath(); pen.moveTo(area.x, zero); pen.lineTo(area.x + area.w, zero); pen.stroke();
      drawShownBand(around)(pen, area, chart);
      drawTheory(theory)(pen, area, chart);
      drawBranches(branches)(pen, area, chart);
    },
  });
  host.after(nonlinear ? legend([...branchLegend(), {text: "linear theory", colour: "rigid"}]) : legend([...(theory ? [{text: "± error of linear theory, estimated", colour: "rigid", dashed: true}] : []), ...bandLegend(around)]), element("p", {class: "caption"},
    `Above zero disturbances grow. ${nonlinear ? "Coloured: of all links together, along the motions without linearisation; grey: of this link alone, by the linear theory." : `Errors ${seen ? "are drawn" : "are below the line's width"}; the table has them.`}`));
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
  // Beside motions without linearisation the linear answer is for comparison: its first component, in grey.
  if (nonlinear) columns.push({label: "linear max |q₁|", values: floats(along.max_abs[0]), colour: "rigid", width: 1.4});
  else along.max_abs.slice(0, 3).forEach((ref, i) => columns.push(...splitByTheory(rod.name, "max |q" + subscript(i + 1) + "|", floats(ref), "c" + (1 + i))));
  const branches = nonlinear ? peakBranches(rod.name, 0) : [];
  const positive = (lists) => lists.flatMap((list) => Array.from(list)).filter((v) => Number.isFinite(v) && v > 0);
  const values = positive(columns.map((c) => c.values)), bent = positive(branches.map((b) => b.y));
  if (values.length === 0) { noChart(host, "No response: it was not asked for, or there is none."); return; }
  // Resonance spikes would flatten all that is valid: the picture reaches well above the stable speeds.
  const fine = stableValues(rod.name, floats(along.max_abs[0]), x);
  // A deflection beyond the link's own length says nothing any more.
  const top = Math.min(rod.length || Infinity, nonlinear ? 1.8 * Math.max(...bent, 0) || 1.6 * Math.max(...values) : Math.min(1.6 * Math.max(...values), fine.length ? 100 * Math.max(...fine) : Infinity));
  const bottom = Math.max(Math.min(...values, ...bent) / 1.6, (nonlinear ? 1e-4 : 1e-7) * top);
  const around = nonlinear ? [] : bandsAround(rod, "max_abs", x, along.max_abs.slice(0, 3).map(floats), ["c1", "c2", "c3"]);
  const marks = nonlinear ? drawEvents((event) => (event.max_abs[rod.name] || [])[0]) : markCritical(rod.name, (peak) => (peak.max_abs === null ? NaN : peak.max_abs));
  new SpeedChart(host, {
    label: `Largest response of ${rod.name} along the speed${nonlinear ? `: ${branches.length} branches without linearisation over the linear answer, ${nonlinear.folds.length} folds` : ""}`,
    x: gappedX(x), columns: spread(columns), yLabel: withUnit(nonlinear ? "max |q₁|" : "max |q|", units.response), logscale: true, yRange: [bottom, top], bands: nonlinear ? [] : bandsOf(rod.name),
    under: (pen, area, chart) => { drawShownBand(around)(pen, area, chart); drawBranches(branches)(pen, area, chart); marks(pen, area, chart); },
  });
  const beyond = columns.some((c) => c.dash);
  host.after(legend(nonlinear ? [...branchLegend(), {text: "linear theory", colour: "rigid"}]
    : [...along.max_abs.slice(0, 3).map((_, i) => ({text: "max |q" + subscript(i + 1) + "|", colour: "c" + (1 + i)})), ...(beyond ? [{text: "beyond linear theory", colour: "rigid", dashed: true}] : []), ...bandLegend(around)]),
  nonlinear ? element("p", {class: "caption"}, branchWords()) : "");
};

const noChart = (host, words) => { host.classList.add("blank"); host.append(element("p", {class: "missing"}, words)); };

const setUpCharts = () => {
  const caption = document.getElementById("speeds-caption");
  if (!report.along || points.count < 2) {
    const section = document.getElementById("speeds");
    for (const host of section.querySelectorAll("[data-chart]")) noChart(host, points.count === 1 ? "One speed only: hb sweep or hb report computes more." : "This page holds no sweep.");
    return;
  }
  const x = doubles(report.along.x);
  setUpSweepBands();
  caption.textContent = (report.along.words || "") + (nonlinear ? " Frequencies, bands and forces along the speed are those of the linear theory." : "");
  for (const views of document.querySelectorAll("#speeds .rod-views")) {
    const rod = rods.find((r) => r.name === views.dataset.rod), along = rod && report.along.rods[rod.name];
    if (rods.length === 1 && !isLinkage) views.querySelector(".rod-title").hidden = true;
    for (const host of views.querySelectorAll("[data-chart]")) {
      const stability = along && along.growth_rate;
      if (host.dataset.chart === "campbell") { if (stability && along.frequency) campbellChart(host, rod, along, x); else noChart(host, "Stability was not asked for: no frequencies."); }
      if (host.dataset.chart === "growth") { if (stability) growthChart(host, rod, along, x); else noChart(host, "Stability was not asked for."); }
      if (host.dataset.chart === "response") { if (along && along.max_abs) responseChart(host, rod, along, x); else noChart(host, "The response was not asked for."); }
    }
  }
};

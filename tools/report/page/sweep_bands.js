// How response and growth rate along the speed move with damping, Young's modulus or mass of the elastic links: what the
// curves as given and with both factors cover.
const sweepBands = report.sweep_bands || [];
const bandWords = (band) => `${band.parameter}${isLinkage ? " of the elastic links" : ""} times ${short(band.from)} to ${short(band.to)}`;

// Of a column over all rows the values at the computed points, which the bands have.
const atPoints = (x, values) => {
  const own = new Float64Array(points.count).fill(NaN);
  let k = 0;
  for (let row = 0; row < x.length; ++row) {
    while (k < points.count && points.x[k] < x[row]) ++k;
    if (points.x[k] === x[row]) own[k] = values[row];
  }
  return own;
};
// [{low, high, colour}] of each band: smallest and largest of the three curves at every point.
const covered = (given, ends, colour) => {
  const low = new Float64Array(points.count), high = new Float64Array(points.count);
  for (let k = 0; k < points.count; ++k) {
    const three = [given[k], ends[0][k], ends[1][k]], known = three.every(Number.isFinite);
    low[k] = known ? Math.min(...three) : NaN;
    high[k] = known ? Math.max(...three) : NaN;
  }
  return {low, high, colour};
};
const bandsAround = (rod, key, x, columns, colours) => sweepBands.map((band) => {
  const own = (band.rods[rod.name] || {})[key];
  if (!own) return [];
  const pairs = key === "growth_rate" ? [own] : own;
  return pairs.slice(0, columns.length).map((pair, i) => covered(atPoints(x, columns[i]), pair.map(floats), colours[i]));
});
const drawShownBand = (bands) => (pen, area, chart) => {
  const bottom = area.y + area.h, place = (v) => { const y = chart.toDomYCoord(v); return Number.isFinite(y) ? Math.max(area.y - 10, Math.min(bottom + 10, y)) : bottom + 10; };
  for (const {low, high, colour} of bands[state.band] || []) {
    pen.fillStyle = colours[colour];
    pen.globalAlpha = 0.2;
    for (let k = 0; k < points.count;) {
      if (!Number.isFinite(low[k])) { ++k; continue; }
      let end = k;
      while (end + 1 < points.count && Number.isFinite(low[end + 1])) ++end;
      pen.beginPath();
      for (let j = k; j <= end; ++j) pen.lineTo(chart.toDomXCoord(points.x[j]), place(high[j]));
      for (let j = end; j >= k; --j) pen.lineTo(chart.toDomXCoord(points.x[j]), place(low[j]));
      pen.fill();
      k = end + 1;
    }
    pen.globalAlpha = 1;
  }
};
const shadedWords = () => `as given and with ${sweepBands[state.band].parameter} times ${short(sweepBands[state.band].from)} to ${short(sweepBands[state.band].to)}`;
const bandLegend = (bands) => (bands.some((band) => band.length > 0) ? [{text: shadedWords(), colour: "band", box: true, name: "shaded"}] : []);

// Above the charts: which of the bands is shaded.
const setUpSweepBands = () => {
  if (sweepBands.length === 0) return;
  if (!(state.band < sweepBands.length)) state.band = 0;
  const choice = element("select", {id: "shown-band", onchange: (event) => { state.band = Number(event.target.value); writeFragment(); for (const item of document.querySelectorAll(".legend .shaded")) item.lastChild.textContent = shadedWords(); for (const chart of charts) chart.redraw(); }},
    sweepBands.map((band, k) => element("option", {value: k, selected: k === state.band}, bandWords(band))));
  document.getElementById("speeds-caption").after(element("div", {class: "toolbar"}, element("label", {}, "shaded: what growth rate and response cover with ", choice, " and as given")));
};

const sweepBandTables = () => {
  if (sweepBands.length === 0) return null;
  const number = (value) => element("td", value === null ? {} : {"data-value": String(value)}, short(value, 5));
  return element("div", {id: "sweep-bands"}, sweepBands.map((band) => tableOf(`${bandWords(band)}, largest of all points`, ["", `${short(band.from)} times`, "as given", `${short(band.to)} times`],
    (band.largest || []).map((row) => element("tr", {}, element("td", {}, raised(row.name)), number(row.from), number(row.given), number(row.to))))));
};

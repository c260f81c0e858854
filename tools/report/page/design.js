// What hb tune changed: numbers, goal and conditions before and after, and both designs along the speed.
const metricWords = {stress: "largest bending stress", "total-stress": "largest stress", safety: "least safety", stable: "stability margin", deflection: "largest deflection", mass: "mass of elastic links", theory: "theory error", torque: "largest driving torque", ripple: "torque ripple", force: "largest joint force"};
const metricName = (metric) => {
  const [kind, ...rest] = metric.split(":");
  return metricWords[kind] ? [metricWords[kind], ...rest].join(" ") : metric;
};
const unitText = (unit) => (unit ? " " + raised(unit) : "");
const worstCell = (side, unit) => element("td", {"data-value": side ? String(side.value) : ""}, side && side.value !== null ? `${side.confirmed === false ? "about " : ""}${significantOr(side.value, Math.min(8, trustedDigits(side.value, side.error || 0)))}` : "–",
  side && side.error > 0 ? element("span", {class: "error"}, ` ± ${errorText(side.error)}`) : "", unitText(unit));

const designTables = (tune) => {
  const tables = [];
  if (tune.variables && tune.variables.length) {
    tables.push(tableOf("Numbers chosen", ["scene number", "before", "after", "from", "to", ""], tune.variables.flatMap((v) => [
      element("tr", {}, element("td", {}, withUnit(v.path, v.unit)), cell(v.before, {digits: 8}), cell(v.after, {digits: 8}), cell(v.lower, {digits: 6}), cell(v.upper, {digits: 6}),
        textCell(v.after <= v.lower ? "at its lower bound" : v.after >= v.upper ? "at its upper bound" : "")),
      ...Object.entries(v.tied || {}).map(([path, value]) => element("tr", {}, element("td", {}, path), element("td", {}, ""), cell(value, {digits: 8}), element("td", {}, ""), element("td", {}, ""), textCell(`tied to ${v.path}`)))])));
  }
  if (tune.metrics && tune.metrics.length) {
    tables.push(tableOf("Worst cases over the speeds", ["quantity", "before", "after", "where, after"], tune.metrics.map((m) => element("tr", {}, element("td", {}, metricName(m.metric)), worstCell(m.before, m.unit), worstCell(m.after, m.unit),
      textCell([m.after.at, m.after.rpm !== undefined ? `${short(m.after.rpm, 6)} rpm` : m.after.omega !== undefined ? `Ω = ${short(m.after.omega, 6)}` : ""].filter(Boolean).join(", "))))));
  }
  if (tune.conditions && tune.conditions.length) {
    tables.push(tableOf("Conditions", ["condition", "value", ""], tune.conditions.map((c) => element("tr", {}, element("td", {}, c.condition), cell(c.value, {error: c.error}),
      textCell(!c.met ? "NOT MET" : c.active ? "met, active" : "met with room")))));
  }
  return tables;
};

const setUpDesign = () => {
  const design = report.design;
  if (!design) return;
  document.documentElement.classList.add("tuned");
  const host = document.getElementById("design-views"), tune = design.tune;
  if (tune.shortfall) host.append(element("div", {class: "note warning"}, element("p", {}, tune.shortfall)));
  const goal = tune.minimise ? `minimise ${tune.minimise}` : tune.maximise ? `maximise ${tune.maximise}` : "";
  host.append(element("p", {class: "caption"}, `Goal: ${goal}: ${short(tune.goal.before, 6)} before, ${short(tune.goal.after, 6)} after${unitText(tune.goal.unit)}. All else on this page is the design after.`));
  const cards = element("div", {class: "cards"});
  host.append(element("div", {class: "tables"}, designTables(tune)), cards);
  for (const curve of design.curves || []) {
    const plot = element("div", {class: "plot"});
    cards.append(element("div", {class: "card"}, element("h4", {}, curve.title), plot, legend([{text: "before", colour: "rigid", dashed: true}, {text: "after", colour: "elastic"}])));
    const area = new PlotArea(plot, `${curve.title}, before and after`);
    const [x0, before, x1, after] = [curve.before_x, curve.before, curve.after_x, curve.after].map((ref) => Array.from(doubles(ref)));
    // Resonances would flatten the rest: as in the chart of the response, the picture stays within a hundred times the median.
    const sorted = [...before, ...after].filter(Number.isFinite).sort((a, b) => a - b), middle = Math.abs(sorted[Math.floor(sorted.length / 2)] || 0);
    const shown = sorted.filter((v) => middle === 0 || Math.abs(v) <= 30 * middle);
    addView(plot, () => {
      area.begin({x: rangeOf([x0, x1]), y: rangeOf([shown]), xLabel: axisName(), yLabel: withUnit(curve.title.split(/ of |, /)[0], curve.unit), pad: 0.08});
      area.clipped(() => { area.line(x0, before, {colour: colours.rigid, dash: [5, 4]}); area.line(x1, after, {colour: colours.elastic}); });
    });
  }
  if (design.text) host.append(element("details", {}, element("summary", {}, "All that hb tune says"), element("pre", {}, design.text)));
};

// Joint forces and torque along the speed: smallest and largest over the turn, elastic beside rigid.
// Of the kept points, "1" where a link lies beyond the linear theory.
const beyondMarks = () => {
  const kept = report.points.kept || Array.from({length: points.count}, (_, k) => k);
  return kept.map((k) => (rods.some((rod) => isBeyondAt(k, rod.name)) ? "1" : "0")).join("");
};
const setUpForceRange = () => {
  const host = document.getElementById("force-range"), sweep = report.sweep;
  if (!sweep || !sweep.joints || Object.keys(sweep.joints).length === 0 || points.count < 2 || !report.along) return;
  const choices = [];
  for (const [joint, components] of Object.entries(sweep.joints))
    for (const c of Object.keys(components)) if (!c.endsWith("_rigid")) choices.push({name: `${joint} ${c}`, elastic: components[c], rigid: components[c + "_rigid"], unit: units.force});
  if (sweep.torque) choices.unshift({name: "driving torque", elastic: sweep.torque, rigid: sweep.torque.rigid, unit: units.moment});
  if (choices.length === 0) return;
  const select = element("select", {}, choices.map((c, k) => element("option", {value: k}, c.name)));
  const chart = element("div", {class: "chart"});
  host.append(element("div", {class: "card"}, element("h4", {}, "Forces along the speed"),
    element("div", {class: "toolbar"}, element("label", {}, "smallest and largest over the turn of ", select)), chart,
    legend([{text: isNonlinear ? "elastic, linear theory" : "elastic", colour: "elastic"}, {text: "rigid", colour: "ink", dashed: true}, ...(beyondMarks().includes("1") && !isNonlinear ? [{text: "elastic beyond linear theory", colour: "rigid", dashed: true}] : [])])));
  const values = (range, end, factor) => Float64Array.from(floats(range[end])).map((v) => v * factor);
  const x = doubles(sweep.forces_x), kept = report.points.kept;
  let shown = null;
  const show = () => {
    const {name, elastic, rigid, unit} = choices[Number(select.value)];
    const columns = [];
    for (const end of ["min", "max"]) {
      const words = end === "min" ? "smallest" : "largest";
      const all = values(elastic, end, unit.factor), marks = beyondMarks();
      columns.push(...splitByMarks(marks, words, all, "elastic", 2));
      if (rigid) columns.push({label: `rigid ${words}`, values: values(rigid, end, unit.factor), colour: "ink", dash: [2, 4], width: 1.3});
    }
    // Resonance spikes would flatten all that is valid: the picture holds the stable speeds, zooming out shows the rest.
    const stable = [];
    for (let k = 0; k < x.length; ++k) {
      const fine = rods.every((rod) => ["stable", "bounded", undefined, ""].includes(verdictOf(rod.name, kept ? kept[k] : k)));
      if (fine) for (const c of columns) if (Number.isFinite(c.values[k])) stable.push(c.values[k]);
    }
    const all = columns.flatMap((c) => Array.from(c.values).filter(Number.isFinite));
    const sorted = (stable.length > 8 ? stable : all).sort((a, b) => a - b);
    const low = sorted[Math.floor(0.01 * sorted.length)], high = sorted[Math.ceil(0.99 * (sorted.length - 1))], pad = 0.3 * (high - low || 1);
    if (shown) { charts.splice(charts.indexOf(shown), 1); shown.chart.destroy(); clear(chart); }
    shown = new SpeedChart(chart, {label: `${name} along the speed`, x, columns, yLabel: withUnit(name, unit.name), yRange: sorted.length ? [low - pad, high + pad] : null,
      bands: rods.flatMap((rod) => bandsOf(rod.name))});
  };
  select.addEventListener("change", show);
  show();
};

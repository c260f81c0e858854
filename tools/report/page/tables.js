// Tables along the speed: verdicts, unstable bands, critical speeds, errors of every speed.
const period = isLinkage ? "the crank's period" : "the period";
const kindText = (kind) => ({"+1": `with ${period} (+1)`, "-1": `with twice ${period} (−1)`, complex: "two frequencies (complex pair)"}[kind] || kind || "open: the sweep ends inside");
const byLinear = isNonlinear ? ", by the linear theory" : "";
const axisName = () => withUnit(report.axis.label, report.axis.unit);
const tableOf = (caption, heads, rows) => {
  const wordy = (column) => rows.length > 0 && rows[0].children[column] && rows[0].children[column].classList.contains("words");
  return element("div", {class: "scroll"}, element("table", {}, element("caption", {}, caption),
    element("thead", {}, element("tr", {}, heads.map((h, c) => element("th", {scope: "col", class: wordy(c) ? "words" : ""}, h)))), element("tbody", {}, rows)));
};
const textCell = (text) => element("td", {class: "words"}, text);

const verdictTable = () => {
  const names = ["stable", "bounded", "unstable", "undecided"];
  const together = report.verdicts[""] && !rods.some((rod) => report.verdicts[rod.name]);
  const rows = (together ? [{name: ""}] : rods.filter((rod) => report.verdicts[rod.name])).map((rod) => {
    const letters = report.verdicts[rod.name], count = (name) => [...letters].filter((l) => verdictNames[l] === name).length;
    const missing = [...letters].filter((l) => l === "-").length;
    return element("tr", {}, element("td", {}, rod.name || "all together"), names.map((name) => element("td", {}, String(count(name)))), element("td", {}, String(missing)));
  });
  return rows.length ? tableOf("Verdicts of the computed speeds", ["link", ...names, "no answer"], rows) : null;
};

const bandTable = () => {
  const details = (report.sweep && report.sweep.band_details) || null;
  if (!details) return null;
  const rows = Object.entries(details).flatMap(([rod, bands]) => bands.map((band) => element("tr", {}, element("td", {}, rod),
    band.from_kind === null ? element("td", {"data-value": band.from}, "before ", short(band.from, 8)) : cell(band.from, {error: band.from_error}),
    band.to_kind === null ? element("td", {"data-value": band.to}, "beyond ", short(band.to, 8)) : cell(band.to, {error: band.to_error}),
    cell(band.fastest_growth, {digits: 5}), cell(band.fastest_at, {digits: 7}), textCell(kindText(band.from_kind)), textCell(kindText(band.to_kind)))));
  if (rows.length === 0) return element("p", {class: "caption"}, `No unstable band was found at the computed speeds or between them${byLinear}.`);
  return tableOf(`Unstable bands${byLinear}, ${axisName()}`, ["link", "from", "to", `fastest growth of its points [${units.rate}]`, "at", "begins", "ends"], rows);
};

// Places between computed speeds that the search could not settle.
const notExcludedTable = () => {
  const places = Object.entries((report.sweep && report.sweep.not_excluded) || {}).flatMap(([rod, pairs]) => pairs.map(([from, to]) =>
    element("tr", {}, element("td", {}, rod), cell(from, {digits: 10}), cell(to, {digits: 10}))));
  return places.length ? tableOf(`Not excluded: a narrow unstable band, or a stable gap in one, may lie here${byLinear}, ${axisName()}`, ["link", "from", "to"], places) : null;
};

const criticalTable = () => {
  const critical = (report.sweep && report.sweep.critical) || null;
  if (!critical) return null;
  if (critical.length === 0) return element("p", {class: "caption"}, "No resonance peak.");
  return tableOf(`Critical speeds: peaks of the response${byLinear}, ${axisName()}`, ["link", "at", "of", withUnit("max |q|", units.response), "mode", "order n", `frequency [${units.frequency.name}]`, `damping [${units.rate}]`],
    critical.map((c) => element("tr", {}, element("td", {}, c.rod), cell(c.x, {error: c.error}), textCell("q" + subscript(c.q)), c.unbounded ? element("td", {}, "unbounded") : cell(c.max_abs, {digits: 6}),
      element("td", {}, c.mode === undefined ? "–" : String(c.mode)), element("td", {}, c.order === undefined ? "–" : String(c.order)),
      cell(c.frequency === undefined ? null : c.frequency * units.frequency.factor, {digits: 6}), cell(c.damping === undefined ? null : c.damping, {digits: 5}))));
};

// Where branches without linearisation turn back or meet others, and where a stable motion ends.
const foldTable = () => {
  if (!nonlinear) return null;
  const rows = [...nonlinear.folds.map((event) => [event, "fold: the motion turns back"]), ...nonlinear.bifurcations.map((event) => [event, event.name + ": " + kindText(event.kind)])]
    .sort(([a], [b]) => a.x - b.x);
  if (rows.length === 0) return element("p", {class: "caption"}, "The branches of motions have no fold and no other bifurcation.");
  return tableOf(`Folds and bifurcations of the motions without linearisation, ${axisName()}`, ["at", "branch", "what"],
    rows.map(([event, what]) => element("tr", {}, cell(event.x, {error: event.error}), element("td", {}, String(event.branch + 1)), textCell(what))));
};
const peakWords = (peaks) => Object.entries(peaks).map(([rod, own]) => `${rod} ${short(own.max_abs[0], 4)}`).join(", ") + (units.response ? " " + units.response : "");
const jumpTable = () => {
  if (!nonlinear || nonlinear.jumps.length === 0) return null;
  return tableOf(`Jumps: a stable motion ends when ${report.axis.label} is changed slowly, ${axisName()}`, ["at", "direction", "from max |q₁|", "to a stable motion with about"],
    nonlinear.jumps.map((jump) => element("tr", {}, cell(jump.x, {error: jump.error}), textCell(jump.direction), textCell(peakWords(jump.from.rods || jump.from)),
      textCell(jump.to.length ? jump.to.map((to) => peakWords(to.rods || to)).join("; or ") : "none found"))));
};
const branchTable = () => {
  if (!nonlinear || nonlinear.branches.length === 0) return null;
  return tableOf("Branches of motions without linearisation", ["branch", "turns", "points", "from", "to", "stable", "ends"], allBranches().map((branch, b) => element("tr", {},
    element("td", {}, String(b + 1)), element("td", {}, String(branch.period)), element("td", {}, String(branch.x.length)), cell(Math.min(...branch.x), {digits: 7}), cell(Math.max(...branch.x), {digits: 7}),
    element("td", {}, branch.verdict.includes("-") ? "–" : `${branch.verdicts.filter((v) => v === "stable").length} of ${branch.x.length}`), textCell(branch.end + (branch.why ? ": " + branch.why : "")))));
};

// Of the speeds that a thinned page keeps without their documents.
const knownGrowth = (rod) => report.growth && report.growth[isNonlinear ? "" : rod];

// One row for each computed speed; made when it is opened, as it may be long.
const speedTable = () => {
  const make = () => {
    const heads = [axisName()];
    for (const rod of rods) heads.push(`${rod.name}: verdict`, `growth rate [${units.rate}]`, withUnit("max |q₁|", units.response), "error of q", "error of modes", ...(report.has_theory ? ["error of theory"] : []));
    const changes = [...Array(points.count).keys()].map((k) => { const here = place(k); return here && here.numbers ? here.numbers.growth_theory_error : undefined; });
    if (changes.some(Number.isFinite)) heads.push(`growth rate of all: error of theory [${units.rate}]`);
    const rows = [];
    for (let k = 0; k < points.count; ++k) {
      const here = place(k), numbers = here && here.numbers;
      const row = element("tr", {}, element("td", {"data-value": points.x[k]}, element("a", {href: "#controls", onclick: () => chooseSpeed(k)}, short(points.x[k], 10))));
      for (const rod of rods) {
        const own = (numbers && numbers.rods && numbers.rods[rod.name]) || {}, known = knownGrowth(rod.name);
        const stability = own.growth_rate !== undefined ? own : (numbers && numbers.system) || {};
        const rate = stability.growth_rate !== undefined ? stability.growth_rate : known ? doubles(known.rate)[k] : null;
        const error = stability.exponent_error !== undefined ? stability.exponent_error : known ? doubles(known.error)[k] : undefined;
        const q = own.q && own.q.max_abs ? own.q.max_abs[0] : own.max_abs ? own.max_abs[0] : null;
        row.append(element("td", {}, verdictMark(verdictOf(rod.name, k))), cell(rate, {error}), cell(q, {digits: 6}), cell(own.error_bound === undefined ? null : own.error_bound, {digits: 2}), cell(own.modes_error === undefined ? null : own.modes_error, {digits: 2}));
        if (report.has_theory) row.append(own.theory_error === null || own.theory_error === undefined ? element("td", {}, own.theory === "beyond" ? "beyond" : "not judged") : cell(own.theory_error, {digits: 2}));
      }
      if (changes.some(Number.isFinite)) row.append(cell(changes[k], {digits: 2}));
      rows.push(row);
    }
    return tableOf("Every computed speed", heads, rows);
  };
  let made = false;
  return element("details", {ontoggle: (event) => { if (event.target.open && !made) { made = true; event.target.append(make()); } }}, element("summary", {}, `Every computed speed (${points.count})`));
};

const boundaryTable = () => {
  if (!report.map || report.map.boundaries.length === 0) return null;
  return tableOf(`Boundary curves of the map`, ["link", "kind", "points", "largest error, along x or y"], report.map.boundaries.slice(0, 60).map((curve) => element("tr", {}, element("td", {}, curve.rod || ""), textCell(kindText(curve.kind)),
    element("td", {}, String(Array.isArray(curve.points[0]) ? curve.points.length : curve.count)), cell(curve.error, {digits: 2}))));
};

const setUpTables = () => {
  const host = document.getElementById("tables-views");
  host.className = "tables";
  const all = [verdictTable(), bandTable(), notExcludedTable(), criticalTable(), branchTable(), foldTable(), jumpTable(), boundaryTable(), bandTables(), sweepBandTables(), points.count > 0 ? speedTable() : null].filter(Boolean);
  host.append(...(all.length ? all : [element("p", {class: "missing"}, "No tables: nothing was computed along the speed.")]));
};

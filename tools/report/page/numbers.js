// The numbers of the chosen speed with their errors. Each cell carries the number as JSON has it in data-value.
const cell = (value, {factor = 1, unit = "", error, relative, digits = 6, path = ""} = {}) => {
  if (value === null || value === undefined) return element("td", {"data-path": path}, "–");
  const shown = value * factor, size = relative !== undefined && relative !== null ? Math.abs(relative * shown) : error !== undefined && error !== null ? error * factor : null;
  const text = size === null ? short(shown, digits) : significantOr(shown, Math.min(8, trustedDigits(shown, size)));
  return element("td", {"data-path": path, "data-value": String(value)}, text,
    size === null ? "" : element("span", {class: "error"}, ` ± ${errorText(size)}`), unit ? ` ${unit}` : "");
};
const significantOr = (value, digits) => (Number.isFinite(value) ? significant(value, digits) : short(value));

const verdictMark = (verdict) => element("span", {class: "verdict", "data-verdict": verdict}, verdict || "–");

// "halved in 0.043 s (0.22 turns)"
const pace = (growth, verdict, omega) => {
  if (!(Math.abs(growth) > 0) || (verdict !== "stable" && verdict !== "unstable")) return "";
  const time = (verdict === "stable" ? Math.LN2 : Math.LN10) / Math.abs(growth), turnsOf = (time * omega) / (2 * Math.PI);
  return `disturbances ${verdict === "stable" ? "are halved" : "grow tenfold"} in ${short(time, 3)} ${units.time} (${short(turnsOf, 3)} turns)`;
};

// What the linear theory leaves out of the growth rate of the whole mechanism, which is the largest of its links'.
const growthTheoryRows = (numbers) => {
  const error = numbers.growth_theory_error;
  if (error === undefined || error === null) return [];
  const rate = Math.max(...Object.values(numbers.rods).map((own) => (own.growth_rate === undefined ? -Infinity : own.growth_rate)));
  return [element("tr", {}, element("td", {}, rods.length > 1 ? "growth rate of all links: error of linear theory" : "its error by linear theory, estimated"), cell(error, {unit: units.rate, digits: 2, path: "growth_theory_error"})),
    ...(error < Math.abs(rate) ? [] : [element("tr", {class: "marked"}, element("td", {colspan: 2, class: "words"}, "Not less than the growth rate itself: the verdict is the linear model's."))])];
};

// Of all links together, where the motion is without linearisation.
const systemRows = (numbers) => {
  if (numbers.theory !== "nonlinear") return [];
  const system = numbers.system, rows = [element("tr", {}, element("th", {colspan: 2, class: "words", scope: "colgroup"}, "All links together, without linearisation"))];
  const add = (name, ...cells) => rows.push(element("tr", {}, element("td", {}, name), ...cells));
  if (system && system.verdict) {
    add("verdict", element("td", {}, verdictMark(system.verdict)));
    add("growth rate", cell(system.growth_rate, {unit: units.rate, error: system.exponent_error, path: "system.growth_rate"}));
    const words = pace(system.growth_rate, system.verdict, numbers.omega);
    if (words) rows.push(element("tr", {}, element("td", {colspan: 2, class: "words error"}, words)));
  }
  if (numbers.period > 1) add("period", element("td", {}, `${numbers.period} turns`));
  for (const other of numbers.other_motions || []) rows.push(element("tr", {}, element("td", {colspan: 2, class: "words"}, `Another motion at this speed${other.verdict ? ", " + other.verdict : ""}: max |q₁| ${peakWords(other.rods)}`)));
  return rows;
};

const rodRows = (rod, numbers) => {
  const own = numbers.rods && numbers.rods[rod.name], rows = [];
  const path = (key) => `rods.${rod.name}.${key}`;
  const add = (name, ...cells) => rows.push(element("tr", {}, element("td", {}, name), ...cells));
  if (!own) return [element("tr", {}, element("td", {colspan: 2, class: "words"}, `${rod.name}: not reported`))];
  const stability = own.growth_rate !== undefined ? own : null;
  rows.push(element("tr", {}, element("th", {colspan: 2, class: "words", scope: "colgroup"}, isLinkage ? rod.name : "system")));
  if (stability) {
    add("verdict", element("td", {}, verdictMark(stability.verdict)));
    add("growth rate", cell(stability.growth_rate, {unit: units.rate, error: stability.exponent_error, path: path("growth_rate")}));
    const words = pace(stability.growth_rate, stability.verdict, numbers.omega);
    if (words) rows.push(element("tr", {}, element("td", {colspan: 2, class: "words error"}, words)));
    // Once: at the link whose growth rate is the mechanism's.
    if (!Object.values(numbers.rods).some((other) => other.growth_rate > own.growth_rate)) rows.push(...growthTheoryRows(numbers));
  }
  if (own.status && own.status !== "converged") add("periodic motion", element("td", {}, own.status === "singular" ? "none: a multiplier is +1" : own.status));
  const q = own.q && own.q.max_abs ? own.q.max_abs : own.max_abs;
  (q || []).slice(0, 3).forEach((value, i) => add(`max |q${subscript(i + 1)}|`, cell(value, {unit: units.response, relative: own.error_bound === null ? undefined : own.error_bound * (i === 0 ? 1 : Math.max(...q) / Math.max(value, 1e-300)), path: path(`q.max_abs.${i}`)})));
  const named = {deflection: ["largest deflection", units.length, 1], bending_moment: ["largest bending moment", units.moment.name, units.moment.factor]};
  for (const [key, [name, unit, factor]] of Object.entries(named)) {
    const peak = own[key];
    if (!peak) continue;
    add(name, cell(peak.max_abs, {factor, unit, digits: 6, path: path(`${key}.max_abs`), error: peak.error}));
    rows.push(element("tr", {}, element("td", {colspan: 2, class: "words error"}, `at x = ${short(peak.x)} ${units.length}, crank angle ${short(peak.crank_angle * units.degrees, 5)}°`)));
  }
  for (const [name, cells] of strengthRows(own, path)) add(name, cells);
  if (own.error_bound !== undefined) add("error of q, relative", cell(own.error_bound, {digits: 2, path: path("error_bound")}));
  if (own.modes_error !== undefined) add("error of the modes left out", cell(own.modes_error, {digits: 2, path: path("modes_error")}));
  if (own.theory_error !== undefined) {
    const beyond = own.theory === "beyond" || own.theory_error > 0.05;
    add("error of linear theory", own.theory_error === null ? element("td", {}, beyond ? "beyond the theory" : "not judged") : cell(own.theory_error, {digits: 2, path: path("theory_error")}));
    if (beyond) rows.push(element("tr", {class: "marked"}, element("td", {colspan: 2, class: "words"}, "Beyond the linear theory: the numbers are the linear model's alone.")));
  }
  if (numbers.theory === "nonlinear") {
    const linear = linearResponseOf(rod.name);
    if (linear) add("max |q₁| by the linear theory", cell(Math.max(...samplesOf(linear[0], samplesNeeded(linear)).map(Math.abs)), {unit: units.response, digits: 4}));
  }
  if (own.modes !== undefined) add(isLinkage ? "modes, harmonics" : "unknowns, harmonics", element("td", {}, `${own.modes}, ${own.harmonics === undefined ? "–" : own.harmonics}`));
  return rows;
};

// Folded, or open as the reader left it; a heading alone is filled when it is opened.
const foldedTable = (key, title, parts) => element("details", {open: state[key], ontoggle: (event) => { state[key] = event.target.open; if (event.target.open && event.target.children.length === 1) showNumbers(); }}, element("summary", {}, title), ...parts);

const jointTable = (numbers, heading) => {
  if (!numbers.joints || Object.keys(numbers.joints).length === 0) return null;
  const title = "Joint forces and torque";
  if (heading) return foldedTable("jointsOpen", title, []);
  const f = units.force, rows = [];
  const row = (name, range, rigid, unit, path) => rows.push(element("tr", {}, element("td", {}, name),
    cell(range.min, {factor: unit.factor, digits: 5, path: path + ".min"}), cell(range.max, {factor: unit.factor, digits: 5, path: path + ".max"}),
    cell(rigid && rigid.min, {factor: unit.factor, digits: 5, path: path + "_rigid.min"}), cell(rigid && rigid.max, {factor: unit.factor, digits: 5, path: path + "_rigid.max"})));
  for (const [joint, components] of Object.entries(numbers.joints))
    for (const c of Object.keys(components)) if (!c.endsWith("_rigid") && components[c] && "min" in components[c]) row(`${joint} ${c}`, components[c], components[c + "_rigid"], f, `joints.${joint}.${c}`);
  if (numbers.torque) row("torque", numbers.torque, numbers.torque.rigid, units.moment, "torque");
  const errors = numbers.joints_error === undefined ? "" : ` Relative errors: forces ${short(numbers.joints_error, 2)}, torque ${short(numbers.torque_error, 2)}; from the modes left out ${short(numbers.joints_modes_error, 2)} and ${short(numbers.torque_modes_error, 2)}.`;
  return foldedTable("jointsOpen", title, [
    element("div", {class: "scroll"}, element("table", {},
      element("thead", {}, element("tr", {}, element("th", {}, "forces [N], torque [N m]"), element("th", {}, "min"), element("th", {}, "max"), element("th", {}, "rigid min"), element("th", {}, "rigid max"))),
      element("tbody", {}, rows))), element("p", {class: "caption"}, `Smallest and largest over the turn.${errors}`)]);
};

// Of a speed that the page keeps without its document: what the sweep knows.
const sparseRows = () => {
  const rows = [];
  for (const rod of rods) {
    rows.push(element("tr", {}, element("th", {colspan: 2, class: "words"}, rod.name)), element("tr", {}, element("td", {}, "verdict"), element("td", {}, verdictMark(verdictOf(rod.name, state.index)))));
    const known = knownGrowth(rod.name);
    if (known) rows.push(element("tr", {}, element("td", {}, "growth rate"), cell(doubles(known.rate)[state.index], {unit: units.rate, error: doubles(known.error)[state.index]})));
  }
  return rows;
};

// `lean`: without what is folded away.
const showNumbers = (lean = false) => {
  const host = document.getElementById("numbers");
  clear(host);
  if (points.count === 0) { host.append(element("p", {class: "missing"}, whyEmpty("numbers"))); return; }
  const here = place(state.index);
  if (here && here.problem) { host.append(element("p", {class: "missing"}, here.problem)); return; }
  const numbers = here && here.numbers;
  // A table for each link, side by side where there is room.
  const tables = numbers ? [systemRows(numbers), ...rods.map((rod) => rodRows(rod, numbers))] : [sparseRows()];
  host.append(element("div", {class: "number-tables"}, tables.filter((rows) => rows.length > 0).map((rows) => element("div", {class: "scroll"}, element("table", {}, element("tbody", {}, rows))))));
  if (!numbers) { host.append(element("p", {class: "caption"}, whyEmpty("numbers"))); return; }
  for (const table of [jointTable(numbers, lean && !state.jointsOpen), machineTable(numbers, lean && !state.machineOpen)]) if (table) host.append(table);
  const warned = [...(here.lacking ? [here.lacking] : []), ...(numbers.notes || []), ...(numbers.warnings || [])];
  if (warned.length) host.append(element("div", {class: "note warning"}, warned.map((w) => element("p", {}, w))));
};

// The tables follow at once; while the slider is held, folded ones and tables out of sight wait until it is let go.
const numbersView = {inSight: true, held: false, due: false};
const showDueNumbers = () => { if (numbersView.due) { numbersView.due = false; showNumbers(); } };
const holdSlider = (held) => { numbersView.held = held; if (!held) showDueNumbers(); };
new IntersectionObserver(([entry]) => { numbersView.inSight = entry.isIntersecting; if (numbersView.inSight) showDueNumbers(); }, {rootMargin: "150px"})
  .observe(document.getElementById("numbers-card"));
slider.addEventListener("pointerdown", () => holdSlider(true));
slider.addEventListener("keydown", (event) => { if (event.repeat) holdSlider(true); });
for (const end of ["pointerup", "pointercancel", "keyup", "blur"]) window.addEventListener(end, () => holdSlider(false));
const numbersFollow = () => {
  numbersView.due = true;
  if (!numbersView.held) showDueNumbers();
  else if (numbersView.inSight) showNumbers(true);
};

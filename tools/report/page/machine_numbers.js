// Stress of the rods at the chosen speed, and what bearings, frame and motor feel.
const megapascal = (1e-6 * units.force.factor ** 3) / units.moment.factor ** 2;  // force/length^2, with length = moment/force
const degreesAt = (angle) => `${short(angle * units.degrees, 5)}°`;

// Rows of a link's table: [name, cells].
const strengthRows = (own, path) => {
  const rows = [], stress = own.stress, axial = own.axial_force, at = (key) => path(`stress.${key}`);
  const mpa = (key, more = {}) => cell(stress[key], {factor: megapascal, unit: "MPa", digits: 4, path: at(key), ...more});
  if (own.static_deflection) rows.push(["deflection at rest", cell(own.static_deflection.max_abs, {unit: units.length, error: own.static_deflection.error || undefined, path: path("static_deflection.max_abs")})]);
  if (axial) {
    rows.push(["largest pull along it", cell(axial.tension, {factor: units.force.factor, unit: "N", digits: 5, path: path("axial_force.tension")})]);
    rows.push(["largest push along it", cell(axial.compression, {factor: units.force.factor, unit: "N", digits: 5, path: path("axial_force.compression")})]);
    rows.push(["share of its buckling load", cell(axial.buckling_share, {digits: 3, path: path("axial_force.buckling_share")})]);
  }
  if (!stress) return rows;
  rows.push(["largest axial stress", mpa("axial")]);
  rows.push([stress.height_known ? "largest bending stress" : "largest bending stress, taken as a rectangle", mpa("bending")]);
  if (stress.max_abs !== undefined) {
    rows.push(["both together", mpa("max_abs", {error: stress.error})]);
    rows.push(["stress cycle, mean", mpa("mean", {error: stress.error})], ["stress cycle, amplitude", mpa("amplitude", {error: stress.error})]);
  }
  for (const [key, name] of [["yield_safety", "safety against yielding"], ["fatigue_safety", `safety against fatigue${stress.fatigue_line ? `, ${stress.fatigue_line} line` : ""}`]])
    if (stress[key] !== undefined) rows.push([name, cell(stress[key], {error: stress[key + "_error"], digits: 3, path: at(key)})]);
  return rows;
};

const bearingTable = (numbers) => {
  const f = units.force.factor, known = numbers.joints_error !== undefined && numbers.joints_error !== null;
  const largest = Math.max(...Object.values(numbers.bearings).map((load) => load.max));
  const error = known ? (numbers.joints_error + (numbers.joints_modes_error || 0)) * largest : undefined;
  const newton = (value, path, bar) => cell(value, {factor: f, digits: 5, path, error: bar});
  return tableOf("Length of each joint's force [N]", ["joint", "largest", "at crank angle", "mean", "rigid mechanism"], Object.entries(numbers.bearings).map(([joint, load]) => element("tr", {}, element("td", {}, joint),
    newton(load.max, `bearings.${joint}.max`, error), element("td", {}, degreesAt(load.crank_angle)), newton(load.mean, `bearings.${joint}.mean`), newton(load.max_rigid, `bearings.${joint}.max_rigid`))));
};

const rangeText = (range, factor) => `${short(range.min * factor, 5)} … ${short(range.max * factor, 5)}`;

const driveTable = (numbers) => {
  const rows = [], {frame, torque, power, flywheel, sliders} = numbers, watt = units.moment.factor / (report.units.time_in_s || 1);
  const add = (name, ...cells) => rows.push(element("tr", {}, element("td", {}, name), ...cells)), words = (text) => element("td", {}, text);
  const bar = numbers.torque_error === undefined || numbers.torque_error === null ? undefined : numbers.torque_error + (numbers.torque_modes_error || 0);
  if (frame) {
    add("largest shaking force on the frame", cell(frame.max, {factor: units.force.factor, unit: "N", digits: 5, error: frame.force_error, path: "frame.max"}));
    add("its components", words(`x ${rangeText(frame.x, units.force.factor)} N, y ${rangeText(frame.y, units.force.factor)} N`));
    add("shaking moment about the crank's pivot", words(`${rangeText(frame.moment, units.moment.factor)} N m`));
  }
  if (torque && torque.rms !== undefined) {
    const largest = Math.max(Math.abs(torque.min), Math.abs(torque.max)), error = bar === undefined ? undefined : bar * largest;
    const mean = error !== undefined && Math.abs(torque.mean) <= error ? 0 : torque.mean;  // what its error hides
    add("mean driving torque", element("td", {"data-path": "torque.mean", "data-value": String(torque.mean)}, `${short(mean * units.moment.factor, 5)} N m`));
    if (torque.mean_theory_error !== undefined && torque.mean_theory_error !== null)
      add("its error by linear theory, estimated", cell(torque.mean_theory_error, {factor: units.moment.factor, unit: "N m", digits: 2, path: "torque.mean_theory_error"}));
    add("driving torque, root mean square", cell(torque.rms, {factor: units.moment.factor, unit: "N m", digits: 5, error, path: "torque.rms"}));
  }
  if (power) {
    add("power", words(`${rangeText(power, watt)} W`));
    add("power, root mean square", cell(power.rms, {factor: watt, unit: "W", digits: 5, relative: bar, path: "power.rms"}));
  }
  if (flywheel) {
    add("energy that a flywheel takes up and gives back", cell(flywheel.energy_fluctuation, {factor: units.moment.factor, unit: "J a turn", digits: 5, path: "flywheel.energy_fluctuation"}));
    if (flywheel.speed_fluctuation !== null && flywheel.speed_fluctuation !== undefined)
      add("fluctuation of the speed with the crank's inertia", words(`${short(100 * flywheel.speed_fluctuation, 3)} %`));
  }
  for (const [name, slider] of Object.entries(sliders || {}))
    add(name, words(`${rangeText(slider.position, 1)} ${units.length}, velocity ${rangeText(slider.velocity, 1)} ${units.length}/${units.time}, acceleration ${rangeText(slider.acceleration, 1)} ${units.length}/${units.time}²`));
  return rows.length ? tableOf("Frame, motor and sliders", ["", "over the turn"], rows) : null;
};

const machineTable = (numbers, heading) => {
  const title = "Bearings, frame and motor", bearings = numbers.bearings && Object.keys(numbers.bearings).length > 0;
  if (heading) return bearings || numbers.frame || numbers.power ? foldedTable("machineOpen", title, []) : null;
  const parts = [bearings ? bearingTable(numbers) : null, driveTable(numbers)].filter(Boolean);
  return parts.length > 0 ? foldedTable("machineOpen", title, parts) : null;
};

// How the answer moves with a number that is not known well (hb steady --band).
const bandValue = (value, error) => (value === null || value === undefined ? "–" : short(value, error > 0 && Number.isFinite(error) ? Math.min(6, trustedDigits(value, error)) : 6));
const knownBand = (band) => {
  const slope = (one) => (one.slope === null || one.slope === undefined ? "–" : short(Math.abs(one.slope) < 1e-6 ? 0 : one.slope, 3) + (one.straight === false ? " *" : ""));
  const text = (value) => element("td", {"data-value": String(value)}, value);
  const numbersOf = band.quantities.map((one) => element("tr", {}, element("td", {}, `${one.of}: ${one.name}${one.unit ? ` [${raised(one.unit)}]` : ""}`),
    text(bandValue(one.from, one.error_from)), text(bandValue(one.nominal, one.error)), text(bandValue(one.to, one.error_to)), text(slope(one))));
  const verdicts = [band.verdict_from, band.verdict, band.verdict_to];
  return tableOf(bandWords(band), ["", `${short(band.from)} times`, "as given", `${short(band.to)} times`, "% per % of it"],
    [...(verdicts.some(Boolean) ? [element("tr", {}, element("td", {}, "verdict"), verdicts.map((verdict) => element("td", {}, verdictMark(verdict))), element("td", {}, ""))] : []), ...numbersOf]);
};
const bandTables = () => {
  if (!report.bands || report.bands.length === 0) return null;
  const starred = report.bands.some((band) => band.quantities.some((one) => one.straight === false));
  return element("div", {id: "bands"}, ...report.bands.map(knownBand), starred ? element("p", {class: "caption"}, "*: holds nearby only; the computed ends do not confirm it.") : "");
};

// What one elastic link does at the chosen speed: response, deflected shape, bending moment, exponents.
const responseCurves = (rod) => () => {
  const q = responseOf(rod.name);
  if (!q) return whyEmpty("response");
  const count = samplesNeeded(q), beyond = isBeyond(rod.name);
  const curves = q.slice(0, 7).map((component, i) => ({name: "q" + subscript(i + 1), values: samplesOf(component, count), colour: beyond ? colours.rigid : modeColour(i), dash: beyond ? [6, 4] : [], note: beyond ? "beyond the linear theory" : ""}));
  const linear = linearResponseOf(rod.name);
  if (!linear || turns() > 1) return curves;
  // Beside what the mechanism does; where the linear answer is many times as large it would flatten that.
  const values = samplesOf(linear[0], count), largest = Math.max(...curves[0].values.map(Math.abs));
  const fits = Math.max(...values.map(Math.abs)) <= 4 * largest;
  return [...(fits ? [{name: "linear q₁", values, colour: colours.rigid, dash: [5, 4]}] : []), ...curves.map((c) => ({...c, note: fits ? "" : "linear theory: out of the picture"}))];
};

// Smallest and largest w over the turn at each place.
const envelope = (q, places) => {
  const count = samplesNeeded(q), samples = q.map((component) => samplesOf(component, count));
  const low = new Float64Array(places.length), high = new Float64Array(places.length);
  places.forEach((share, p) => {
    const sines = q.map((_, i) => Math.sin((i + 1) * Math.PI * share));
    let a = Infinity, b = -Infinity;
    for (let j = 0; j < count; ++j) {
      let w = 0;
      for (let i = 0; i < q.length; ++i) w += samples[i][j] * sines[i];
      if (w < a) a = w;
      if (w > b) b = w;
    }
    low[p] = a; high[p] = b;
  });
  return {low, high};
};
const filledBand = (area, xs, low, high) => area.line([...xs, ...[...xs].reverse()], [...low, ...[...high].reverse()], {fill: colours.grid, close: true, colour: ""});

class ShapePlot {
  constructor(host, rod) {
    this.rod = rod;
    this.shares = Array.from({length: 61}, (_, k) => k / 60);
    this.area = new PlotArea(host, `Deflected shape of ${rod.name}`);
    this.area.onPointer((x) => this.read(x));
    addView(host, () => this.draw(true), () => this.draw(false));
  }
  draw(fresh) {
    const q = responseOf(this.rod.name), area = this.area;
    if (!q) { this.w = null; area.words(whyEmpty("shape")); return; }
    if (fresh) this.whole = envelope(q, this.shares);
    const now = coordinatesAt(this.rod.name, state.angle), xs = this.shares.map((s) => s * this.rod.length);
    this.w = this.shares.map((share) => deflection(now, share));
    area.begin({x: [0, this.rod.length], y: rangeOf([this.whole.low, this.whole.high, [0]]), xLabel: withUnit("x from joint 0 to joint 1", units.length), yLabel: withUnit("w across the link", units.length)});
    area.clipped(() => { filledBand(area, xs, this.whole.low, this.whole.high); area.line(xs, this.w, isBeyond(this.rod.name) ? {colour: colours.rigid, dash: [6, 4], width: 2} : {colour: colours.rod, width: 2}); });
    if (isBeyond(this.rod.name)) area.note("beyond the linear theory");
    if (fresh) { const [a, b] = rangeOf([this.whole.low, this.whole.high]); area.describe(`Deflected shape of ${this.rod.name}: over the turn from ${short(a)} to ${short(b)} ${units.length}`); }
  }
  read(x) {
    if (!this.w || x < 0 || x > this.rod.length) return "";
    const k = Math.round((x / this.rod.length) * 60);
    return `x ${short(x)}: w ${short(this.w[k])} ${units.length}, over the turn ${short(this.whole.low[k])} … ${short(this.whole.high[k])}`;
  }
}

class MomentPlot {
  constructor(host, rod) {
    this.rod = rod;
    this.area = new PlotArea(host, `Bending moment of ${rod.name}`);
    this.area.onPointer((x) => this.read(x));
    addView(host, () => this.draw());
  }
  draw() {
    const here = place(state.index), area = this.area, curves = here && here.curves && here.curves.rods[this.rod.name];
    this.values = null;
    if (!curves || !curves.moment) { area.words(whyEmpty("bending moment")); return; }
    const all = floats(curves.moment), n = all.length / 2, factor = units.moment.factor;
    this.values = {low: Array.from(all.subarray(0, n), (v) => v * factor), high: Array.from(all.subarray(n), (v) => v * factor)};
    const xs = this.values.low.map((_, k) => (k / (n - 1)) * this.rod.length);
    area.begin({x: [0, this.rod.length], y: rangeOf([this.values.low, this.values.high, [0]]), xLabel: withUnit("x from joint 0 to joint 1", units.length), yLabel: withUnit("M, smallest and largest over the turn", units.moment.name)});
    area.clipped(() => {
      filledBand(area, xs, this.values.low, this.values.high);
      const style = isBeyond(this.rod.name) ? {colour: colours.rigid, dash: [6, 4]} : {colour: colours.accent};
      area.line(xs, this.values.low, style);
      area.line(xs, this.values.high, style);
    });
    if (isBeyond(this.rod.name)) area.note("beyond the linear theory");
    const known = here.numbers.rods[this.rod.name];
    if (known && known.bending_moment) {
      const peak = known.bending_moment, size = peak.max_abs * factor, k = Math.round((peak.x / this.rod.length) * (n - 1));
      const sign = Math.abs(this.values.low[k]) > Math.abs(this.values.high[k]) ? -1 : 1;
      area.dot(peak.x, sign * size, {colour: colours.unstable});
      area.describe(`Bending moment of ${this.rod.name}: largest ${short(size)} N m at x = ${short(peak.x)} ${units.length}`);
    }
  }
  read(x) {
    if (!this.values || x < 0 || x > this.rod.length) return "";
    const k = Math.round((x / this.rod.length) * (this.values.low.length - 1));
    return `x ${short(x)} ${units.length}: M ${short(this.values.low[k])} … ${short(this.values.high[k])} N m`;
  }
}

// What exponents are folded by: the frequency of the motion, Omega/T.
const foldOf = (index) => {
  const here = place(index);
  return points.omega[index] / ((here && here.numbers && here.numbers.period) || 1);
};

// Exponents over the unit of growth; imaginary parts in turns of the crank, folded: an exponent is known up to
// multiples of i Omega.
class ExponentPlane {
  constructor(host, rod) {
    this.rod = rod;
    this.area = new PlotArea(host, `Exponents of ${rod.name}`);
    this.area.onPointer((x, y) => this.read(x, y));
    this.near = true;
    const button = element("button", {type: "button", onclick: () => { this.near = !this.near; button.textContent = this.near ? "all exponents" : "leading ones"; this.view.dirty = "all"; askFrame(); }}, "all exponents");
    this.view = addView(host, () => this.draw());
    host.after(element("div", {class: "toolbar"}, button), element("p", {class: "caption"},
      `A disturbance changes as exp(λt): the real part is its growth rate, and right of zero it grows. Imaginary parts in multiples of Ω are folded to −½ … ½, as an exponent is known up to multiples of iΩ. Light: the other computed speeds.`));
  }
  known(index) {
    const here = place(index);
    if (!here || !here.numbers) return null;
    const own = here.numbers.rods && here.numbers.rods[this.rod.name];
    return own && own.exponents ? own : here.numbers.system && here.numbers.system.exponents ? here.numbers.system : null;
  }
  // (Re, Im/Omega) of all speeds, once.
  everywhere() {
    if (this.others) return this.others;
    this.others = [];
    for (let k = 0; k < points.count; ++k) {
      const known = this.known(k);
      if (known) for (const [re, im] of known.exponents) if (Number.isFinite(re)) this.others.push([re, im / foldOf(k)]);
    }
    const growth = this.others.map(([re]) => re).sort((a, b) => a - b);
    this.low = growth[Math.floor(0.02 * growth.length)];
    this.high = Math.max(growth[growth.length - 1], 0);
    return this.others;
  }
  // The leading exponent and zero with room, in round steps: the picture changes rarely from speed to speed.
  static around(leading) {
    const size = Math.abs(leading) || 1, power = Math.pow(10, Math.floor(Math.log10(size))), step = [2, 5, 10].find((m) => 1.25 * size <= m * power) || 20;
    return leading > 0 ? [-0.5 * step * power, step * power] : [-step * power, 0.5 * step * power];
  }
  draw() {
    const area = this.area, known = this.known(state.index);
    this.shown = [];
    if (!known) { area.words(whyEmpty("exponents")); return; }
    const all = this.everywhere(), errors = known.exponent_errors || [];
    const leading = Math.max(...known.exponents.map(([re]) => re));
    const x = this.near ? ExponentPlane.around(leading)
      : [Math.min(this.low, ...known.exponents.map(([re]) => re)), Math.max(this.high, 0.04 * Math.abs(this.low), leading)];
    const pad = 0.04 * (x[1] - x[0]);
    area.begin({x: [x[0] - pad, x[1] + pad], y: [-0.5, 0.5], xLabel: withUnit("Re λ", units.rate), yLabel: turns() === 1 ? "Im λ / Ω" : `Im λ / (Ω/${turns()})`});
    area.clipped(() => {
      const pen = area.pen;
      if (area.x1 > 0) { pen.fillStyle = colours["unstable-band"]; pen.fillRect(area.x(0), area.top, area.right - area.x(0), area.bottom - area.top); }
      area.rule([0, 0], [-0.6, 0.6], colours.unstable, 1.2);
      pen.fillStyle = colours.ghost;
      for (const [re, im] of all) if (re >= area.x0) pen.fillRect(area.x(re) - 1, area.y(im) - 1, 2, 2);
      known.exponents.forEach(([re, im], k) => {
        const value = {re, im, error: errors[k]};
        this.shown.push(value);
        const radius = Number.isFinite(errors[k]) ? Math.abs(area.x(errors[k]) - area.x(0)) : 0;
        const colour = re === leading ? colours[known.verdict] || colours.accent : colours.ink;
        if (radius > 5) area.dot(re, im / foldOf(state.index), {colour, size: radius, hollow: true});
        area.dot(re, im / foldOf(state.index), {colour, size: re === leading ? 5.5 : 4});
      });
      for (const other of known.exponents_uncertain || []) {
        const [re, im] = other.exponent;
        area.dot(re, im / foldOf(state.index), {colour: colours.undecided, size: 5, hollow: true});
        this.shown.push({re, im, error: other.error});
      }
    });
    area.describe(`Exponents of ${this.rod.name}: leading real part ${short(leading)} ${units.rate}, ${known.verdict || ""}`);
  }
  read(x, y) {
    const area = this.area;
    let best = null, distance = 25;
    for (const value of this.shown || []) {
      const d = Math.hypot(area.x(value.re) - area.x(x), area.y(value.im / foldOf(state.index)) - area.y(y));
      if (d < distance) { distance = d; best = value; }
    }
    if (!best) return "";
    return `λ = ${short(best.re, 6)} ${best.im < 0 ? "−" : "+"} ${short(Math.abs(best.im), 6)} i  ± ${errorText(best.error)} ${units.rate}; per ${turns() === 1 ? "turn" : `${turns()} turns`} × ${short(Math.exp((2 * Math.PI * best.re) / foldOf(state.index)), 3)}`;
  }
}

// Whether some point has what a view draws.
const drawnKeys = {response: "q", shape: "q", moment: "moment", stress: "stress"};
const everDrawn = (rod, view) => (report.places || []).some((entry, k) => {
  if (view !== "exponents") return entry.curves && entry.curves.rods[rod.name] && entry.curves.rods[rod.name][drawnKeys[view]];
  const here = place(report.points.kept ? report.points.kept[k] : k), own = here && here.numbers;
  return own && ((own.rods[rod.name] || {}).exponents || (own.system || {}).exponents);
});

const setUpRods = () => {
  for (const views of document.querySelectorAll("#rods .rod-views")) {
    const rod = rods.find((r) => r.name === views.dataset.rod);
    if (!rod) continue;
    for (const host of views.querySelectorAll(".plot")) {
      const view = host.dataset.view;
      if ((!isLinkage && (view === "shape" || view === "moment")) || (view === "stress" && !rod.section)) { host.closest(".card").remove(); continue; }
      host.classList.toggle("blank", !everDrawn(rod, view));
      switch (view) {
        case "response":
          new TurnPlot(host, {label: `Response of ${rod.name}`, yLabel: isLinkage ? "q, amplitude of sin(iπx/l)" : "q", unit: units.response, curves: responseCurves(rod)});
          host.after(legend(Array.from({length: Math.min(7, rod.modes)}, (_, i) => ({text: "q" + subscript(i + 1), colour: "c" + (1 + (i % 7))}))));
          break;
        case "shape": new ShapePlot(host, rod); break;
        case "moment":
          new MomentPlot(host, rod);
          if (!rod.section) host.after(element("p", {class: "caption"}, "Stress over the turn is drawn where a link's section is given."));
          break;
        case "stress": new StressMap(host, rod); break;
        case "exponents": new ExponentPlane(host, rod); break;
      }
    }
    if (rods.length === 1) views.querySelector(".rod-title").hidden = !isLinkage;
  }
};

// Stress of a link over its length and the turn: sigma(x, tau) = a0 + a1 s + a2 s^2 +- sum b_i sin(i pi s), s = x/l, of
// the axial force and of the bending moment, + at the fibre right of the way from joint 0 to joint 1.
const stressColours = (() => {
  let table = null;
  return () => table || (table = Array.from({length: 257}, (_, k) => growthColour(k / 128 - 1)));
})();

class StressField {
  constructor(series) {
    this.angles = 180; this.places = 61;
    const rows = series.map((component) => samplesOf(component, this.angles));
    const n = this.angles + 1, axial = new Float64Array(n * this.places), bending = new Float64Array(n * this.places);
    for (let p = 0; p < this.places; ++p) {
      const s = p / (this.places - 1), at = p * n, sines = rows.slice(3).map((_, i) => Math.sin((i + 1) * Math.PI * s));
      for (let j = 0; j < n; ++j) {
        axial[at + j] = rows[0][j] + s * (rows[1][j] + s * rows[2][j]);
        let sum = 0;
        for (let i = 0; i < sines.length; ++i) sum += rows[i + 3][j] * sines[i];
        bending[at + j] = sum;
      }
    }
    this.n = n; this.axial = axial; this.bending = bending;
    this.largest = 0; this.side = 1;
    for (let k = 0; k < axial.length; ++k) {
      const size = Math.abs(axial[k]) + Math.abs(bending[k]);
      if (size > this.largest) { this.largest = size; this.side = axial[k] * bending[k] < 0 ? -1 : 1; }
    }
  }
  value(place, angle, side) { const k = place * this.n + angle; return this.axial[k] + side * this.bending[k]; }
  // One pixel for each place and angle, joint 0 below.
  image(side) {
    const cells = element("canvas", {width: this.n, height: this.places}), pen = cells.getContext("2d"), image = pen.createImageData(this.n, this.places), table = stressColours();
    for (let p = 0; p < this.places; ++p) {
      for (let j = 0; j < this.n; ++j) {
        const [r, g, b] = table[Math.round(128 + (128 * this.value(p, j, side)) / (this.largest || 1))], at = 4 * (j + this.n * (this.places - 1 - p));
        image.data[at] = r; image.data[at + 1] = g; image.data[at + 2] = b; image.data[at + 3] = 255;
      }
    }
    pen.putImageData(image, 0, 0);
    return cells;
  }
}
const fibreName = (side) => (side > 0 ? "right fibre" : "left fibre");

class StressMap {
  constructor(host, rod) {
    this.rod = rod;
    this.area = new PlotArea(host, `Stress of ${rod.name}`);
    this.cursor = element("div", {class: "cursor"});
    host.append(this.cursor);
    this.area.onPointer((x, y) => this.read(x, y), (x) => { if (this.field) { play(false); setAngle((x * Math.PI) / 180); } });
    this.choice = element("select", {onchange: () => { state.fibre = Number(this.choice.value); writeFragment(); this.view.dirty = "all"; askFrame(); }},
      [["0", "where it is largest"], ["1", "right of the way from joint 0 to joint 1"], ["-1", "left of it"]].map(([value, words]) => element("option", {value, selected: Number(value) === state.fibre}, words)));
    host.after(element("div", {class: "toolbar"}, element("label", {}, "fibre ", this.choice)),
      element("p", {class: "caption"}, "Axial force and bending moment together. Red: tension, blue: compression; circle: the largest. Drawn to about 0.5 % of the largest; the numbers have their errors."));
    this.view = addView(host, () => this.draw(), () => this.move());
  }
  draw() {
    const area = this.area, here = place(state.index), curves = here && here.curves && here.curves.rods[this.rod.name];
    if (!curves || !curves.stress) {
      this.field = null;
      this.cursor.hidden = true;
      area.words(isNonlinear ? "Stress over the turn is computed with the linear theory only." : whyEmpty("stress"));
      return;
    }
    if (this.series !== curves.stress) { this.series = curves.stress; this.field = this.made = new StressField(seriesOf(curves.stress)); }
    this.field = this.made;
    const field = this.field, side = this.side = Number(this.choice.value) || field.side, l = this.rod.length;
    const pen = area.canvas.getContext("2d"), largest = field.largest * megapascal;
    this.ticks = niceTicks(-largest, largest, 5);
    const room = 24 + Math.max(...this.ticks.map((v) => pen.measureText(short(v, 3)).width), pen.measureText("MPa").width);
    const narrow = sizeOf(area.host).width < 420, ticks = [];
    for (let v = 0; v <= 360; v += narrow ? 90 : 45) ticks.push(v);
    area.begin({x: [0, 360], y: [0, l], pad: 0, xTicks: ticks, rightRoom: room, xLabel: "crank angle [°]", yLabel: withUnit("x from joint 0 to joint 1", units.length)});
    const beyond = isBeyond(this.rod.name), wide = area.right - area.left, high = area.bottom - area.top;
    pen.globalAlpha = beyond ? 0.4 : 1;
    pen.imageSmoothingEnabled = true;
    // The outer pixels' middles lie on the frame.
    area.clipped(() => pen.drawImage(field.image(side), 0.5, 0.5, field.n - 1, field.places - 1, area.left, area.top, wide, high));
    pen.globalAlpha = 1;
    this.bar(beyond);
    this.cursor.hidden = false;
    if (beyond) area.note("beyond the linear theory"); else area.note(fibreName(side), colours.muted);
    const known = here.numbers.rods[this.rod.name], peak = known && known.stress;
    if (peak && peak.max_abs !== undefined && peak.side === side) {
      area.dot(peak.crank_angle * units.degrees, peak.x, {colour: "#ffffff", size: 5.5});
      area.dot(peak.crank_angle * units.degrees, peak.x, {colour: "#111111", size: 5.5, hollow: true});
    }
    area.describe(`Stress of ${this.rod.name} along the link and over the turn, ${fibreName(side)}` + (peak && peak.max_abs !== undefined ? `; largest ${short(peak.max_abs * megapascal)} MPa at x = ${short(peak.x)} ${units.length}, crank angle ${degreesAt(peak.crank_angle)}, ${fibreName(peak.side)}` : ""));
    this.move();
  }
  bar(beyond) {
    const area = this.area, pen = area.pen, left = area.right + 8, high = area.bottom - area.top, largest = this.field.largest * megapascal;
    pen.globalAlpha = beyond ? 0.4 : 1;
    growthBar(pen, left, area.top, 10, high);
    pen.globalAlpha = 1;
    pen.fillStyle = colours.muted;
    pen.textAlign = "left"; pen.textBaseline = "middle";
    for (const v of this.ticks) pen.fillText(short(v, 3), left + 14, area.top + (high * (1 - v / largest)) / 2);
    pen.textAlign = "right"; pen.textBaseline = "top";
    pen.fillText("MPa", area.width - 1, 3);
  }
  move() {
    if (!this.field) return;
    this.cursor.style.transform = `translate(${this.area.x((state.angle * 180) / Math.PI)}px, ${this.area.top}px)`;
    this.cursor.style.height = this.area.bottom - this.area.top + "px";
  }
  read(angle, x) {
    if (!this.field || angle < 0 || angle > 360 || x < 0 || x > this.rod.length) return "";
    const j = Math.round((angle / 360) * this.field.angles), p = Math.round((x / this.rod.length) * (this.field.places - 1));
    return `${Math.round(angle)}°, x ${short(x, 3)} ${units.length}: ${short(this.field.value(p, j, this.side) * megapascal, 3)} MPa`;
  }
}

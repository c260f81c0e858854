// The stability map: growth rate of every grid point as a cell of colour (nothing is interpolated between them), the
// computed boundary curves, resonance lines, and a cross-hair that takes the speed along.
const kindColours = {"-1": "#000000", "+1": "#00604c", complex: "#7b3294"};
const kindWords = {"-1": "boundary −1, disturbances with twice the period", "+1": "boundary +1, with the period", complex: "boundary, complex pair"};

class MapPlot {
  constructor(canvas) {
    this.canvas = canvas;
    const map = report.map;
    this.map = map;
    this.x = map.x.values; this.y = map.y.values;
    this.growth = floats(map.growth_rate);
    this.error = floats(map.growth_error);
    this.verdicts = map.verdict;
    const sizes = Array.from(this.growth).filter(Number.isFinite).map(Math.abs).sort((a, b) => a - b);
    this.largest = sizes[sizes.length - 1] || 1;
    const seen = sizes.filter((s) => s > 1e-6 * this.largest);
    this.scale = seen[Math.floor(seen.length / 2)] || this.largest;
    this.window = null;
    this.reading = element("p", {class: "map-reading", "aria-live": "polite"});
    canvas.after(this.reading);
    canvas.addEventListener("pointermove", (event) => this.tell(this.nodeAt(event)));
    canvas.addEventListener("pointerleave", () => this.tell(state.mapNode));
    canvas.addEventListener("pointerdown", (event) => { this.down = this.inside(event); });
    canvas.addEventListener("pointerup", (event) => this.release(event));
    canvas.addEventListener("dblclick", () => { this.window = null; this.draw(); });
    canvas.tabIndex = 0;
    canvas.addEventListener("keydown", (event) => this.key(event));
    this.view = addView(canvas, () => this.draw());
    onSpeed.push(() => { this.followSpeed(); this.view.dirty = "all"; askFrame(); });
    this.cells = this.paint();
    // A place that the address gives is kept until another speed is chosen.
    const [i, j] = state.mapNode || [-1, -1];
    this.given = i >= 0 && i < this.x.length && j >= 0 && j < this.y.length;
    if (!this.given) { state.mapNode = null; this.followSpeed(); }
    this.tell(state.mapNode);
  }

  // Letters of the verdict grid and colours of the growth, as an image of one pixel for each node.
  paint() {
    const nx = this.x.length, ny = this.y.length, cells = element("canvas", {width: nx, height: ny});
    const image = cells.getContext("2d").createImageData(nx, ny), limit = Math.asinh(this.largest / this.scale);
    for (let j = 0; j < ny; ++j) {
      for (let i = 0; i < nx; ++i) {
        const letter = this.verdicts[j][i], at = 4 * (i + nx * (ny - 1 - j));
        let rgb = growthColour(Math.asinh(this.growth[i + nx * j] / this.scale) / limit);
        if (letter === "?") rgb = [150, 150, 150];
        if (letter === "b") rgb = [150, 210, 190];
        if (letter === "-") rgb = [92, 96, 104];
        image.data.set([...rgb, 255], at);
      }
    }
    cells.getContext("2d").putImageData(image, 0, 0);
    return cells;
  }

  box() {
    if (this.window) return this.window;
    return [this.x[0], this.x[this.x.length - 1], this.y[0], this.y[this.y.length - 1]];
  }
  inside(event) {
    const box = this.canvas.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  }
  px(x) { const [x0, x1] = this.box(); return this.left + ((x - x0) / (x1 - x0)) * (this.right - this.left); }
  py(y) { const [, , y0, y1] = this.box(); return this.bottom - ((y - y0) / (y1 - y0)) * (this.bottom - this.top); }
  xAt(p) { const [x0, x1] = this.box(); return x0 + ((p - this.left) / (this.right - this.left)) * (x1 - x0); }
  yAt(p) { const [, , y0, y1] = this.box(); return y0 + ((this.bottom - p) / (this.bottom - this.top)) * (y1 - y0); }
  static nearest(values, v) {
    const share = (v - values[0]) / (values[values.length - 1] - values[0]);
    return Math.max(0, Math.min(values.length - 1, Math.round(share * (values.length - 1))));
  }
  nodeAt(event) {
    const [px, py] = this.inside(event);
    if (px < this.left || px > this.right || py < this.top || py > this.bottom) return state.mapNode;
    return [MapPlot.nearest(this.x, this.xAt(px)), MapPlot.nearest(this.y, this.yAt(py))];
  }

  release(event) {
    if (!this.down) return;
    const [px, py] = this.inside(event), [dx, dy] = this.down;
    this.down = null;
    if (Math.abs(px - dx) > 8 && Math.abs(py - dy) > 8 && event.pointerType === "mouse") {
      this.window = [this.xAt(Math.min(px, dx)), this.xAt(Math.max(px, dx)), this.yAt(Math.max(py, dy)), this.yAt(Math.min(py, dy))];
      this.draw();
      return;
    }
    this.choose(this.nodeAt(event));
  }
  // A step across the speed leaves the slider, whose speeds lie closer, where it is.
  choose(node) {
    if (!node) return;
    const before = state.mapNode && this.speedOf(state.mapNode), speed = this.speedOf(node);
    state.mapNode = node;
    this.tell(node);
    if (speed !== null && (speed !== before || !this.stepping) && points.count > 0) chooseSpeed(nearestIndex(speed));
    state.mapNode = node;
    this.view.dirty = "all";
    askFrame();
    writeFragment();
  }
  key(event) {
    const moves = {ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1]}, move = moves[event.key];
    if (!move || !state.mapNode) return;
    event.preventDefault();
    const [i, j] = state.mapNode;
    this.stepping = true;
    this.choose([Math.max(0, Math.min(this.x.length - 1, i + move[0])), Math.max(0, Math.min(this.y.length - 1, j + move[1]))]);
    this.stepping = false;
  }
  // The speed of a node on the slider's axis, or null where neither axis of the map is the speed.
  speedOf([i, j]) {
    const kind = report.axis.kind;
    if (this.map.x.path === kind) return this.x[i];
    if (this.map.y.path === kind) return this.y[j];
    return null;
  }
  // The node nearest to the chosen speed, at the scene's own value of the other number.
  followSpeed() {
    if (this.given) { this.given = false; return; }
    if (points.count === 0) { state.mapNode = state.mapNode || [Math.floor(this.x.length / 2), Math.floor(this.y.length / 2)]; return; }
    const kind = report.axis.kind, here = points.x[state.index], own = report.map.scene_values || {};
    const old = state.mapNode || [Math.floor(this.x.length / 2), Math.floor(this.y.length / 2)];
    const at = (axis, values, before) => axis.path === kind ? MapPlot.nearest(values, here) : Number.isFinite(own[axis.path]) ? MapPlot.nearest(values, own[axis.path]) : before;
    state.mapNode = [at(this.map.x, this.x, old[0]), at(this.map.y, this.y, old[1])];
    this.tell(state.mapNode);
  }

  tell(node) {
    if (!node) { this.reading.textContent = ""; return; }
    const [i, j] = node, k = i + this.x.length * j, letter = this.verdicts[j] ? this.verdicts[j][i] : undefined;
    if (letter === undefined) return;
    const place = `${this.map.x.label} = ${short(this.x[i], 6)}${this.map.x.unit ? " " + raised(this.map.x.unit) : ""}, ${this.map.y.label} = ${short(this.y[j], 6)}${this.map.y.unit ? " " + raised(this.map.y.unit) : ""}`;
    if (letter === "-") { this.reading.textContent = `${place}: no system`; return; }
    const error = this.error[k];
    this.reading.textContent = `${place}: ${verdictNames[letter]}, growth rate ${short(this.growth[k], Number.isFinite(error) ? Math.min(6, trustedDigits(this.growth[k], error)) : 3)}${Number.isFinite(error) ? " ± " + errorText(error) : ""} ${units.rate}` +
      (Number.isFinite(error) ? "" : ", not computed itself: it lies in a cell of one verdict");
  }

  // All but the cross-hair; kept until the size, the window or the colours change.
  ground(box) {
    const key = [box.width, box.height, window.devicePixelRatio, colours.muted, ...this.box()].join();
    if (this.groundKey === key) return this.kept;
    this.groundKey = key;
    this.kept = this.kept || element("canvas");
    const pen = cleanPen(this.kept, box);
    const [x0, x1, y0, y1] = this.box();
    const xTicks = niceTicks(x0, x1, Math.max(3, Math.round(box.width / 120))), yTicks = niceTicks(y0, y1, 6);
    const narrow = box.width < 560;
    this.left = 14 + Math.max(...yTicks.map((v) => pen.measureText(tickText(v, yTicks)).width));
    this.right = box.width - 36 - Math.max(...this.barValues().map((v) => pen.measureText(short(v, 2)).width));
    this.top = 26;
    this.bottom = box.height - 42;
    const width = this.right - this.left, height = this.bottom - this.top;
    // Half a cell lies beyond the outer nodes; the frame cuts it off.
    pen.save();
    pen.beginPath(); pen.rect(this.left, this.top, width, height); pen.clip();
    pen.imageSmoothingEnabled = false;
    const nx = this.x.length, ny = this.y.length;
    const hx = (this.x[nx - 1] - this.x[0]) / (nx - 1) / 2, hy = (this.y[ny - 1] - this.y[0]) / (ny - 1) / 2;
    const a = this.px(this.x[0] - hx), b = this.px(this.x[nx - 1] + hx), c = this.py(this.y[ny - 1] + hy), d = this.py(this.y[0] - hy);
    pen.drawImage(this.cells, a, c, b - a, d - c);
    this.trace(pen, (this.map.resonance_lines || []).flatMap((line) => line.pieces.map((piece) => ({points: piece}))), () => ["#555555", 1, [6, 5]]);
    for (const range of this.map.band || []) this.trace(pen, range.boundaries, (curve) => [kindColours[curve.kind], 1.1, [3, 3]]);
    this.trace(pen, this.map.boundaries, (curve) => [kindColours[curve.kind] || "#000000", 2, curve.kind === "-1" ? [] : curve.kind === "+1" ? [9, 3] : [2, 3]]);
    this.nameLines(pen);
    pen.restore();
    pen.strokeStyle = colours.muted; pen.lineWidth = 1;
    pen.strokeRect(this.left + 0.5, this.top + 0.5, width, height);
    pen.fillStyle = colours.muted;
    pen.textAlign = "right"; pen.textBaseline = "middle";
    for (const v of yTicks) pen.fillText(tickText(v, yTicks), this.left - 6, this.py(v));
    pen.textAlign = "center"; pen.textBaseline = "top";
    for (const v of xTicks) pen.fillText(tickText(v, xTicks), this.px(v), this.bottom + 5);
    pen.fillText(withUnit(this.map.x.label, this.map.x.unit), (this.left + this.right) / 2, box.height - 17);
    pen.textAlign = "left";
    pen.fillText(withUnit(this.map.y.label, this.map.y.unit), 2, 6);
    this.colourBar(pen, box, narrow);
    return this.kept;
  }
  draw() {
    const box = sizeOf(this.canvas), ground = this.ground(box), pen = cleanPen(this.canvas, box);
    if (ground.width > 0 && ground.height > 0) pen.drawImage(ground, 0, 0, box.width, box.height);
    if (!state.mapNode) return;
    const [i, j] = state.mapNode, x = this.px(this.x[i]), y = this.py(this.y[j]);
    pen.save();
    pen.beginPath(); pen.rect(this.left, this.top, this.right - this.left, this.bottom - this.top); pen.clip();
    pen.strokeStyle = "#ffffff"; pen.lineWidth = 3; this.cross(pen, x, y);
    pen.strokeStyle = "#111111"; pen.lineWidth = 1; this.cross(pen, x, y);
    pen.beginPath(); pen.arc(x, y, 5, 0, 2 * Math.PI); pen.fillStyle = "#fff"; pen.fill(); pen.lineWidth = 2; pen.stroke();
    pen.restore();
  }
  cross(pen, x, y) { pen.beginPath(); pen.moveTo(this.left, y); pen.lineTo(this.right, y); pen.moveTo(x, this.top); pen.lineTo(x, this.bottom); pen.stroke(); }
  trace(pen, curves, style) {
    for (const curve of curves) {
      const [colour, lineWidth, dash] = style(curve);
      const values = Array.isArray(curve.points[0]) ? curve.points : null, flat = values ? null : doubles(curve.points);
      const count = values ? values.length : flat.length / 2;
      pen.beginPath();
      for (let k = 0; k < count; ++k) {
        const x = this.px(values ? values[k][0] : flat[2 * k]), y = this.py(values ? values[k][1] : flat[2 * k + 1]);
        if (k) pen.lineTo(x, y); else pen.moveTo(x, y);
      }
      pen.strokeStyle = colour; pen.lineWidth = lineWidth; pen.setLineDash(dash); pen.lineJoin = "round"; pen.stroke();
    }
    pen.setLineDash([]);
  }
  nameLines(pen) {
    const taken = [];
    pen.textAlign = "center"; pen.textBaseline = "middle";
    for (const line of this.map.resonance_lines || []) {
      const longest = line.pieces.reduce((best, piece) => (piece.length > best.length ? piece : best), []);
      for (const share of [0.9, 0.75, 0.6, 0.4, 0.2]) {
        const p = longest[Math.floor(share * (longest.length - 1))];
        if (!p) break;
        const x = this.px(p[0]), y = this.py(p[1]), name = line.speed.replace(/ω_?(\d)/g, (_, digit) => "ω" + subscript(digit)), half = pen.measureText(name).width / 2 + 3;
        if (x - half < this.left || x + half > this.right || y < this.top + 10 || y > this.bottom - 10 || taken.some(([u, v, h]) => Math.abs(u - x) < h + half && Math.abs(v - y) < 16)) continue;
        taken.push([x, y, half]);
        pen.fillStyle = "rgba(247,247,247,.85)"; pen.fillRect(x - half, y - 8, 2 * half, 16);
        pen.fillStyle = "#333333"; pen.fillText(name, x, y);
        break;
      }
    }
  }
  barValues() {
    const values = [0];
    for (let e = Math.floor(Math.log10(this.scale)); e <= Math.log10(this.largest); ++e) for (const s of [1, -1]) values.push(s * Math.pow(10, e));
    return values;
  }
  colourBar(pen, box, narrow) {
    const left = this.right + 14, wide = 14, limit = Math.asinh(this.largest / this.scale), height = this.bottom - this.top;
    growthBar(pen, left, this.top, wide, height);
    pen.fillStyle = colours.muted;
    pen.textAlign = "left"; pen.textBaseline = "middle";
    const taken = [];
    for (const v of this.barValues()) {
      const y = this.top + (height * (1 - Math.asinh(v / this.scale) / limit)) / 2;
      if (y < this.top - 2 || y > this.bottom + 2 || taken.some((t) => Math.abs(t - y) < 15)) continue;
      taken.push(y);
      pen.fillText(short(v, 2), left + wide + 4, y);
    }
    pen.textAlign = "right";
    pen.fillText(withUnit(narrow ? "growth" : "growth rate", units.rate), box.width - 2, 10);
  }
}

const setUpMap = () => {
  const canvas = document.getElementById("map");
  if (!canvas || !report.map) {
    document.getElementById("map-views").classList.add("empty-card");
    document.getElementById("map-views").append(element("p", {class: "missing"}, "This page holds no map: hb report with --x and --y, or hb map, computes one."));
    return;
  }
  const map = report.map;
  new MapPlot(canvas);
  const kinds = [...new Set(map.boundaries.map((curve) => curve.kind))];
  canvas.parentNode.append(
    element("p", {class: "caption"}, isNonlinear ? "By the linear theory. " : "", kinds.map((kind) => `${kind === "-1" ? "Solid" : kind === "+1" ? "Long dashes" : "Dots"}: ${kindWords[kind] || kind}. `).join("") +
      "Blue: disturbances die out, red: they grow; every cell is one computed point. Light grey: undecided, green: bounded, dark grey: no system. " +
      (map.words ? map.words + " " : ""), element("span", {class: "hint"}, "A click moves the cross-hair and takes the speed along; drag to zoom, double click to see all.")));
  canvas.setAttribute("role", "img");
  canvas.setAttribute("aria-label", `Stability map over ${map.x.label} and ${map.y.label}: ${map.counts ? Object.entries(map.counts).filter(([, n]) => n > 0).map(([name, n]) => `${n} ${name}`).join(", ") : ""}; arrow keys move the cross-hair`);
};

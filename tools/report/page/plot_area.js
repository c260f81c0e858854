// A canvas with two axes: sizes for sharp pixels, ticks at round numbers, lines and marks in the plot's own units.
const niceTicks = (low, high, wanted) => {
  const range = high - low;
  if (!(range > 0) || !Number.isFinite(range)) return [low];
  // The smallest round step that gives no more than `wanted` intervals; where that leaves less than three ticks, the
  // next smaller one.
  const power = Math.pow(10, Math.floor(Math.log10(range / wanted)));
  const steps = [1, 2, 5, 10].map((m) => m * power);
  const ticksOf = (size) => {
    const ticks = [];
    for (let k = Math.ceil(low / size - 1e-9); k * size <= high + 1e-9 * size; ++k) ticks.push(k * size);
    return ticks;
  };
  const fitting = steps.filter((s) => range / s <= wanted), ticks = ticksOf(fitting[0]);
  return ticks.length >= 3 ? ticks : ticksOf(steps[Math.max(0, steps.indexOf(fitting[0]) - 1)]);
};
const tickText = (value, ticks) => {
  const size = ticks.length > 1 ? ticks[1] - ticks[0] : Math.abs(value) || 1;
  const most = Math.max(...ticks.map(Math.abs));
  if (Math.abs(value) < 1e-9 * most) return "0";
  if (most >= 1e5 || most < 1e-3) return short(value, 4);
  return minus(value.toFixed(Math.max(0, Math.min(6, -Math.floor(Math.log10(size) + 1e-9)))));
};

class PlotArea {
  // Inside `host`, which gives the size.
  constructor(host, label) {
    this.host = host;
    clear(host);
    this.canvas = element("canvas", {role: "img", "aria-label": label});
    this.hover = element("div", {class: "hover", hidden: true});
    host.append(this.canvas, this.hover);
  }

  describe(text) { this.canvas.setAttribute("aria-label", text); }

  // Clears, and makes room for axes with these ranges. `equal`: same scale both ways.
  begin({x, y, xLabel = "", yLabel = "", xTicks = null, equal = false, pad = 0.06, rightRoom = 12}) {
    const size = sizeOf(this.host);
    this.width = Math.max(80, size.width);
    this.height = Math.max(60, size.height);
    const pen = this.pen = cleanPen(this.canvas, this);
    let [y0, y1] = y, [x0, x1] = x;
    if (!(y1 > y0)) { const size = Math.abs(y0) || 1; y0 -= 0.5 * size; y1 += 0.5 * size; }
    if (!(x1 > x0)) { const size = Math.abs(x0) || 1; x0 -= 0.5 * size; x1 += 0.5 * size; }
    const grow = pad * (y1 - y0);
    y0 -= grow; y1 += grow;
    this.top = yLabel ? 22 : 8;
    this.bottom = this.height - (xLabel ? 36 : 22);
    const rough = niceTicks(y0, y1, Math.max(4, Math.round((this.bottom - this.top) / 40)));
    this.left = Math.min(0.3 * this.width, 14 + Math.max(...rough.map((v) => pen.measureText(tickText(v, rough)).width)));
    this.right = this.width - rightRoom;
    if (equal) {
      const scale = Math.min((this.right - this.left) / (x1 - x0), (this.bottom - this.top) / (y1 - y0));
      const cx = (x0 + x1) / 2, cy = (y0 + y1) / 2, w = (this.right - this.left) / scale / 2, h = (this.bottom - this.top) / scale / 2;
      [x0, x1, y0, y1] = [cx - w, cx + w, cy - h, cy + h];
    }
    this.x0 = x0; this.x1 = x1; this.y0 = y0; this.y1 = y1;
    const yTicks = niceTicks(y0, y1, Math.max(4, Math.round((this.bottom - this.top) / 40)));
    const ticks = xTicks || niceTicks(x0, x1, Math.max(2, Math.round((this.right - this.left) / 80)));
    pen.lineWidth = 1;
    pen.strokeStyle = colours.grid;
    pen.fillStyle = colours.muted;
    pen.beginPath();
    for (const v of yTicks) { const p = Math.round(this.y(v)) + 0.5; pen.moveTo(this.left, p); pen.lineTo(this.right, p); }
    for (const v of ticks) { const p = Math.round(this.x(v)) + 0.5; pen.moveTo(p, this.top); pen.lineTo(p, this.bottom); }
    pen.stroke();
    pen.textAlign = "right"; pen.textBaseline = "middle";
    for (const v of yTicks) pen.fillText(tickText(v, yTicks), this.left - 6, this.y(v));
    pen.textAlign = "center"; pen.textBaseline = "top";
    for (const v of ticks) {
      const text = tickText(v, ticks);
      pen.fillText(text, Math.min(this.x(v), this.width - 1 - pen.measureText(text).width / 2), this.bottom + 5);
    }
    if (xLabel) pen.fillText(xLabel, (this.left + this.right) / 2, this.height - 15);
    pen.textAlign = "left";
    if (yLabel) pen.fillText(yLabel, 2, 3);
    this.labelEnd = yLabel ? 2 + pen.measureText(yLabel).width : 0;
    pen.strokeStyle = colours.muted;
    if (y0 < 0 && y1 > 0) this.rule([x0, x1], [0, 0], colours.muted, 0.6);
    pen.strokeStyle = colours.rule;
    pen.strokeRect(this.left + 0.5, this.top + 0.5, this.right - this.left, this.bottom - this.top);
  }

  x(v) { return this.left + ((v - this.x0) / (this.x1 - this.x0)) * (this.right - this.left); }
  y(v) { return this.bottom - ((v - this.y0) / (this.y1 - this.y0)) * (this.bottom - this.top); }
  xAt(pixel) { return this.x0 + ((pixel - this.left) / (this.right - this.left)) * (this.x1 - this.x0); }
  yAt(pixel) { return this.y0 + ((this.bottom - pixel) / (this.bottom - this.top)) * (this.y1 - this.y0); }

  clipped(draw) {
    this.pen.save();
    this.pen.beginPath();
    this.pen.rect(this.left, this.top, this.right - this.left, this.bottom - this.top);
    this.pen.clip();
    draw();
    this.pen.restore();
  }
  rule(xs, ys, colour, width = 1) { this.line(xs, ys, {colour, width}); }
  line(xs, ys, {colour, width = 1.6, dash = [], close = false, fill = null}) {
    const pen = this.pen;
    pen.beginPath();
    let down = false;
    for (let k = 0; k < xs.length; ++k) {
      if (!Number.isFinite(xs[k]) || !Number.isFinite(ys[k])) { down = false; continue; }
      if (down) pen.lineTo(this.x(xs[k]), this.y(ys[k])); else pen.moveTo(this.x(xs[k]), this.y(ys[k]));
      down = true;
    }
    if (close) pen.closePath();
    if (fill) { pen.fillStyle = fill; pen.fill(); }
    if (!colour) return;
    pen.strokeStyle = colour;
    pen.lineWidth = width;
    pen.setLineDash(dash);
    pen.lineJoin = "round";
    pen.stroke();
    pen.setLineDash([]);
  }
  dot(x, y, {colour, size = 4, hollow = false}) {
    const pen = this.pen;
    pen.beginPath();
    pen.arc(this.x(x), this.y(y), size, 0, 2 * Math.PI);
    if (hollow) { pen.strokeStyle = colour; pen.lineWidth = 1.4; pen.stroke(); } else { pen.fillStyle = colour; pen.fill(); }
  }
  // Above the frame, at its right; inside it where the axis' name leaves no room.
  note(text, colour = colours.unstable) {
    const pen = this.pen, wide = pen.measureText(text).width, above = this.right - wide > this.labelEnd + 8;
    if (!above) { pen.fillStyle = colours.card; pen.globalAlpha = 0.8; pen.fillRect(this.right - wide - 8, this.top + 1, wide + 7, 18); pen.globalAlpha = 1; }
    pen.textAlign = "right"; pen.textBaseline = "top";
    pen.fillStyle = colour;
    pen.fillText(text, above ? this.right : this.right - 4, above ? 3 : this.top + 4);
  }
  words(text) {
    this.begin({x: [0, 1], y: [0, 1], xTicks: []});
    this.pen.clearRect(0, 0, this.width, this.height);
    this.pen.fillStyle = colours.muted;
    this.pen.textAlign = "left";
    this.pen.textBaseline = "top";
    // Lines as wide as the plot.
    let line = "", y = 20;
    for (const word of text.split(" ")) {
      if (line && this.pen.measureText(line + " " + word).width > this.width - 20) { this.pen.fillText(line, 8, y); y += 18; line = ""; }
      line += (line ? " " : "") + word;
    }
    this.pen.fillText(line, 8, y);
    this.describe(text);
  }

  say(text) {
    this.hover.hidden = !text;
    if (this.hover.textContent !== text) this.hover.textContent = text;
  }
  // read(x, y in the plot's units) -> text for the pointer, "" for none; choose on click.
  onPointer(read, choose) {
    const where = (event) => {
      const box = this.canvas.getBoundingClientRect();
      return [this.xAt(event.clientX - box.left), this.yAt(event.clientY - box.top)];
    };
    this.canvas.addEventListener("pointermove", (event) => this.say(this.x1 === undefined ? "" : read(...where(event))));
    this.canvas.addEventListener("pointerleave", () => this.say(""));
    if (choose) this.canvas.addEventListener("click", (event) => { if (this.x1 !== undefined) choose(...where(event)); });
  }
}

// Colours by their names in the style sheet.
const legend = (items) => element("div", {class: "legend"}, items.map(({text, colour, dashed, box, name}) =>
  !colour ? element("span", {class: "said"}, text) : element("span", {class: name || ""}, element("i", {class: box ? "box" : dashed ? "dashed" : "", style: box ? `background:var(--${colour})` : `border-top-color:var(--${colour})`}), text)));
const rangeOf = (lists) => {
  let low = Infinity, high = -Infinity;
  for (const list of lists) for (const v of list) { if (v < low) low = v; if (v > high) high = v; }
  return low <= high ? [low, high] : [0, 0];
};

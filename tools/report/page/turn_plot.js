// Curves over the turn with a cursor at the crank's angle; a click turns the crank there.
class TurnPlot {
  // curves() -> [{name, values (closed, equally spaced), colour, dash}] or a sentence why there are none.
  constructor(host, {label, yLabel, unit, curves}) {
    this.area = new PlotArea(host, label);
    this.label = label; this.yLabel = yLabel; this.unit = unit; this.curves = curves;
    this.cursor = element("div", {class: "cursor"});
    host.append(this.cursor);
    this.area.onPointer((x) => this.read(x), (x) => { play(false); setAngle((x * Math.PI) / 180); });
    addView(host, () => this.draw(), () => this.move());
  }

  draw() {
    const area = this.area, curves = this.curves();
    this.shown = typeof curves === "string" ? [] : curves;
    if (this.shown.length === 0) {
      const said = area.host.parentNode.querySelector(".said");
      if (said) said.textContent = "";
      this.cursor.hidden = true;
      area.words(curves);
      return;
    }
    this.cursor.hidden = false;
    const end = 360 * turns(), step = end <= 360 ? (sizeOf(area.host).width < 420 ? 90 : 45) : 90 * turns();
    const ticks = [];
    for (let v = 0; v <= end; v += step) ticks.push(v);
    area.begin({x: [0, end], y: rangeOf(this.shown.map((c) => c.values)), xTicks: ticks, xLabel: isLinkage ? "crank angle [°]" : "Ωt [°]", yLabel: withUnit(this.yLabel, this.unit)});
    area.clipped(() => {
      for (const curve of this.shown) {
        const n = curve.values.length - 1;
        area.line(Array.from(curve.values, (_, j) => (end * j) / n), curve.values, curve);
      }
    });
    // What the curves say together, in the legend below.
    const said = area.host.parentNode.querySelector(".said"), below = this.shown.map((c) => c.below).find(Boolean);
    if (said) said.textContent = below ? `${below} ${this.unit}` : "";
    const note = this.shown.map((c) => c.note).find(Boolean);
    if (note) area.note(note);
    const names = area.host.parentNode.querySelector(".legend");
    if (names && !said) names.classList.toggle("greyed", this.shown.every((c) => c.colour === colours.rigid));
    area.describe(`${this.label}: ` + this.shown.map((c) => { const [a, b] = rangeOf([c.values]); return `${c.name} from ${short(a)} to ${short(b)} ${this.unit}`; }).join("; "));
    this.move();
  }

  move() {
    if (this.shown.length === 0) return;
    const area = this.area, x = area.x((state.angle * 180) / Math.PI);
    this.cursor.style.transform = `translate(${x}px, ${area.top}px)`;
    this.cursor.style.height = area.bottom - area.top + "px";
  }

  read(x) {
    const end = 360 * turns();
    if (this.shown.length === 0 || x < 0 || x > end) return "";
    return `${Math.round(x)}°  ` + this.shown.map((c) => {
      const n = c.values.length - 1;
      return `${c.name} ${short(c.values[Math.round((x / end) * n)])}`;
    }).join("  ") + (this.unit ? " " + this.unit : "");
  }
}

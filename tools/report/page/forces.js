// Joint forces and driving torque at the chosen speed, elastic beside rigid, over the turn and as polar diagram.
const jointNames = () => {
  for (let k = 0; k < points.count; ++k) {
    const here = place(k);
    if (here && here.curves && here.curves.joints) return Object.keys(here.curves.joints);
  }
  return [];
};

// Rigid forces are polynomials of the speed: F0 + Omega F1 + Omega^2 F2; a scene number along the axis has its own at
// every point.
const rigidSeries = (own, powers) => {
  if (own) return seriesOf(own);
  if (!powers) return null;
  const Omega = points.omega[state.index];
  const parts = powers.map(seriesOf);
  return parts[0].map((_, c) => {
    const sum = new Float64Array(Math.max(...parts.map((p) => p[c].length)));
    parts.forEach((part, p) => part[c].forEach((v, k) => { sum[k] += Math.pow(Omega, p) * v; }));
    return sum;
  });
};
const jointSeries = (name) => {
  const here = place(state.index);
  if (!here || !here.curves || !here.curves.joints) return null;
  const rigid = report.rigid || {joints: {}};
  return {
    elastic: seriesOf(here.curves.joints[name]),
    rigid: rigidSeries(here.curves.rigid && here.curves.rigid.joints[name], rigid.joints[name]),
  };
};
const torqueSeries = () => {
  const here = place(state.index);
  if (!here || !here.curves || !here.curves.torque) return null;
  return {
    elastic: seriesOf(here.curves.torque),
    rigid: rigidSeries(here.curves.rigid && here.curves.rigid.torque, report.rigid && report.rigid.torque),
  };
};

const elasticBesideRigid = (series, component, factor) => {
  const count = samplesNeeded([...series.elastic, ...(series.rigid || [])]);
  const scaled = (c) => samplesOf(c, count).map((v) => v * factor);
  const curves = [];
  const beyond = rods.some((rod) => isBeyond(rod.name));
  const elastic = scaled(series.elastic[component]);
  curves.push({name: "elastic", values: elastic, colour: beyond ? colours.rigid : colours.elastic, dash: beyond ? [6, 4] : [], width: 2, note: beyond ? "elastic: beyond the linear theory" : ""});
  if (series.rigid) {
    const rigid = scaled(series.rigid[component]), most = Math.max(...elastic.map((v, k) => Math.abs(v - rigid[k])));
    curves.push({name: "rigid", values: rigid, colour: colours.ink, dash: [2, 4], width: 1.3});
    curves[0].below = `elastic − rigid: at most ${short(most, 3)}`;
  }
  return curves;
};
const besideLegend = () => legend([{text: "elastic", colour: "elastic"}, {text: "rigid", colour: "ink", dashed: true}, {text: ""}]);

class PolarPlot {
  constructor(host, joint) {
    this.joint = joint;
    this.area = new PlotArea(host, "Polar diagram of the joint force");
    this.mark = element("div", {class: "cursor", style: "border:0;width:9px;height:9px;border-radius:50%;background:var(--elastic);opacity:1;margin:-4.5px"});
    host.append(this.mark);
    this.area.onPointer((x, y) => this.read(x, y));
    addView(host, () => this.draw(), () => this.move());
  }
  draw() {
    const series = jointSeries(this.joint()), area = this.area;
    this.series = null;
    this.mark.hidden = true;
    if (!series) { area.words(whyEmpty("joint forces")); return; }
    if (series.elastic.length < 2) { area.words("A guide's force has one direction, across the guide: no polar diagram."); return; }
    const f = units.force.factor, count = samplesNeeded(series.elastic);
    const path = (s) => s.map((c) => samplesOf(c, count).map((v) => v * f));
    const elastic = path(series.elastic), rigid = series.rigid ? path(series.rigid) : null;
    area.begin({x: rangeOf([elastic[0], [0], ...(rigid ? [rigid[0]] : [])]), y: rangeOf([elastic[1], [0], ...(rigid ? [rigid[1]] : [])]), equal: true, pad: 0.08,
      xLabel: withUnit("along", units.force.name), yLabel: withUnit("across", units.force.name)});
    area.clipped(() => {
      area.rule([0, 0], [area.y0, area.y1], colours.rule);
      const beyond = rods.some((rod) => isBeyond(rod.name));
      area.line(elastic[0], elastic[1], beyond ? {colour: colours.rigid, dash: [6, 4], width: 2} : {colour: colours.elastic, width: 2});
      if (rigid) area.line(rigid[0], rigid[1], {colour: colours.ink, dash: [2, 4], width: 1.3});
      area.line([elastic[0][0] * 0, elastic[0][0]], [0, elastic[1][0]], {colour: colours.ghost, width: 1});
    });
    let most = 0;
    for (let j = 0; j < count; ++j) most = Math.max(most, Math.hypot(elastic[0][j], elastic[1][j]));
    this.series = series.elastic;
    area.describe(`Polar diagram of the force at ${this.joint()}: largest ${short(most)} ${units.force.name}`);
    this.move();
  }
  move() {
    if (!this.series) return;
    const [x, y] = this.series.map((c) => valueAt(c, state.angle / turns()) * units.force.factor);
    this.mark.hidden = false;
    this.mark.style.transform = `translate(${this.area.x(x)}px, ${this.area.y(y)}px)`;
  }
  read(x, y) {
    return this.series ? `${short(Math.hypot(x, y))} ${units.force.name} at ${Math.round((Math.atan2(y, x) * 180) / Math.PI)}°` : "";
  }
}

const setUpForces = () => {
  const host = document.getElementById("forces-views"), joints = jointNames();
  if (joints.length === 0) {
    host.append(element("p", {class: "missing"}, !isLinkage ? "A [hill] scene has no joints." : points.count === 0 ? whyEmpty("joint forces") : "Joint forces were not asked for, or no speed has a periodic motion."));
    return;
  }
  if (!joints.includes(state.joint)) state.joint = joints[0];
  const choice = element("select", {}, joints.map((name) => element("option", {value: name, selected: name === state.joint}, name)));
  const titles = [element("h4"), element("h4")];
  const along = element("div", {class: "plot"}), across = element("div", {class: "plot"}), polar = element("div", {class: "plot square"}), torque = element("div", {class: "plot tall"});
  const second = element("div", {class: "card"}, titles[1], across, besideLegend());
  const name = () => {
    const single = state.joint.endsWith(".guide");
    titles[0].textContent = single ? `${state.joint}, n: across the guide` : `${state.joint}, x: along`;
    titles[1].textContent = `${state.joint}, y: across`;
    second.hidden = single;
  };
  choice.addEventListener("change", () => { state.joint = choice.value; name(); redraw(); writeFragment(); });
  host.append(
    element("div", {class: "toolbar"}, element("label", {}, "joint ", choice)),
    element("p", {class: "caption"}, report.force_frames || ""),
    element("div", {class: "cards"},
      element("div", {class: "card"}, titles[0], along, besideLegend()), second,
      element("div", {class: "card"}, element("h4", {}, "Polar diagram"), polar, besideLegend()),
      element("div", {class: "card"}, element("h4", {}, "Driving torque on the crank"), torque, besideLegend())));
  name();
  const curves = (component) => () => {
    const series = jointSeries(state.joint);
    if (!series) return whyEmpty("joint forces");
    return component < series.elastic.length ? elasticBesideRigid(series, component, units.force.factor) : "A guide has one component.";
  };
  new TurnPlot(along, {label: "Joint force along", yLabel: "force", unit: units.force.name, curves: curves(0)});
  new TurnPlot(across, {label: "Joint force across", yLabel: "force", unit: units.force.name, curves: curves(1)});
  new PolarPlot(polar, () => state.joint);
  new TurnPlot(torque, {label: "Driving torque", yLabel: "torque", unit: units.moment.name, curves: () => {
    const series = torqueSeries();
    return series ? elasticBesideRigid(series, 0, units.moment.factor) : whyEmpty("torque");
  }});
};

// The mechanism as it moves, with the rods' vibration magnified by the stated factor.
const mechanismCanvas = document.getElementById("mechanism");

const magnifications = [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000, 10000, 100000, 1e6, 1e7];
// So that a usual deflection is drawn as some 6 % of its rod: median of the largest at the computed speeds.
const usualMagnification = () => {
  const sizes = [];
  for (let k = 0; k < points.count; ++k) {
    const here = place(k);
    if (!here || !here.numbers || !here.numbers.rods) continue;
    for (const rod of rods) {
      if (!["stable", "bounded"].includes(verdictOf(rod.name, k)) && report.verdicts[rod.name] && /[sb]/.test(report.verdicts[rod.name])) continue;
      const known = here.numbers.rods[rod.name], w = known && known.deflection && known.deflection.max_abs;
      if (w > 0 && rod.length > 0) sizes.push(w / rod.length);
    }
  }
  if (sizes.length === 0) return 1;
  sizes.sort((a, b) => a - b);
  const wanted = 0.06 / sizes[Math.floor(sizes.length / 2)];
  return magnifications.reduce((best, m) => (Math.abs(Math.log(m / wanted)) < Math.abs(Math.log(best / wanted)) ? m : best), 1);
};

// The box that all bodies stay in over the turn.
const reach = (motion) => {
  if (motion.box) return motion.box;
  const low = [Infinity, Infinity], high = [-Infinity, -Infinity];
  motion.paths = motion.bodies.map((body) => body.points.map(() => []));
  const poses = 144;
  for (let j = 0; j <= poses; ++j) {
    motionAt(motion, (2 * Math.PI * j) / poses).forEach((pose, b) => pose.body.points.forEach((point, p) => {
      const z = pose.at(point.at);
      motion.paths[b][p].push(z);
      for (const c of [0, 1]) { low[c] = Math.min(low[c], z[c]); high[c] = Math.max(high[c], z[c]); }
    }));
  }
  motion.box = {low, high};
  return motion.box;
};

// Bodies with their joints in the plane; joint 1 of a bent link stands where its chord ends.
const posesAt = (motion, angle) => motionAt(motion, angle).map((pose) => {
  const q = motion.turns && pose.body.elastic ? coordinatesAt(pose.body.name, angle) : null;
  const chord = q ? alongChord(q, pose.body.length, 40) : null;
  const joints = pose.body.points.map((point, p) => pose.at(chord && p === 1 ? [chord[40], 0] : point.at));
  return {...pose, chord, joints};
});

// The design before stands behind where its bodies are elsewhere.
let otherBefore;
const hasOtherBefore = () => {
  if (otherBefore !== undefined) return otherBefore;
  const before = report.design && report.motions[report.design.before_motion];
  const ends = (motion) => [0.3, 2.1, 4.4].flatMap((angle) => motionAt(motion, angle).flatMap((pose) => pose.body.points.flatMap((p) => pose.at(p.at))));
  const here = before ? ends(report.motions[0]) : [], there = before ? ends(before) : [], size = Math.max(1e-300, ...here.map(Math.abs));
  return (otherBefore = there.some((v, k) => Math.abs(v - here[k]) > 1e-3 * size));
};

const drawMechanism = () => {
  const canvas = mechanismCanvas, box = sizeOf(canvas), pen = cleanPen(canvas, box);
  const motion = motionHere();
  if (!motion) {
    const why = isLinkage ? whyEmpty("mechanism") : "A [hill] scene is a system of equations: it has no mechanism to draw.";
    pen.fillStyle = colours.muted;
    pen.textAlign = isLinkage ? "center" : "left";
    pen.textBaseline = "middle";
    pen.fillText(why, isLinkage ? box.width / 2 : 2, box.height / 2, box.width - 20);
    canvas.setAttribute("aria-label", why);
    return;
  }
  const paths = motion.rigid || motion, {low, high} = reach(paths);
  const margin = 34, width = high[0] - low[0] || 1, height = high[1] - low[1] || 1;
  const scale = Math.min((box.width - 2 * margin) / width, (box.height - 2 * margin) / height);
  const at = (z) => [box.width / 2 + scale * (z[0] - (low[0] + high[0]) / 2), box.height / 2 - scale * (z[1] - (low[1] + high[1]) / 2)];
  const stroke = (zs, colour, lineWidth, dash = []) => {
    pen.beginPath();
    zs.forEach((z, k) => { const [x, y] = at(z); if (k) pen.lineTo(x, y); else pen.moveTo(x, y); });
    pen.strokeStyle = colour;
    pen.lineWidth = lineWidth;
    pen.setLineDash(dash);
    pen.lineCap = pen.lineJoin = "round";
    pen.stroke();
    pen.setLineDash([]);
  };
  for (const guide of motion.guides || []) {
    const far = 2 * (width + height), [dx, dy] = [Math.cos(guide.direction), Math.sin(guide.direction)];
    stroke([[guide.at[0] - far * dx, guide.at[1] - far * dy], [guide.at[0] + far * dx, guide.at[1] + far * dy]], colours.ghost, 1, [5, 4]);
  }
  motion.bodies.forEach((body, b) => body.points.forEach((point, p) => { if (!point.fixed) stroke(paths.paths[b][p], colours.ghost, 1); }));
  const clippedRods = [], beyondRods = [];
  const drawBody = (pose, ghost) => {
    const {body} = pose, zs = pose.joints;
    if (body.slider) {
      const a = 10 / scale, c = 6.5 / scale;
      const corners = [[-a, -c], [a, -c], [a, c], [-a, c], [-a, -c]].map(pose.at);
      stroke(corners, ghost ? colours.ghost : colours.body, ghost ? 1 : 2);
      for (const z of zs.slice(1)) stroke([zs[0], z], ghost ? colours.ghost : colours.body, 2);
      return;
    }
    const colour = ghost ? colours.ghost : body.elastic ? colours.rod : colours.body;
    if (!ghost && body.elastic) {
      stroke(zs.slice(0, 2), colours.ghost, 1.2, [4, 4]);
      const q = coordinatesAt(body.name, state.angle);
      if (q) {
        const most = 0.4 * body.length;
        // A vibration too large for the picture is drawn as large as there is room: its shape stays.
        const shares = Array.from({length: 41}, (_, k) => deflection(q, k / 40)), largest = Math.max(...shares.map(Math.abs));
        const cut = state.magnification * largest > most, factor = cut ? most / largest : state.magnification;
        const shape = shares.map((w, k) => pose.at([pose.chord ? pose.chord[k] : (body.length * k) / 40, factor * w]));
        if (cut) clippedRods.push(body.name);
        const beyond = isBeyond(body.name);
        if (beyond) beyondRods.push(body.name);
        stroke(shape, beyond ? colours.rigid : colour, 2.6, beyond ? [7, 5] : []);
        return;
      }
    }
    stroke(zs.slice(0, 2), colour, ghost ? 1 : body.elastic ? 2.6 : 4);
    for (const z of zs.slice(2)) { stroke([zs[0], z], colour, ghost ? 1 : 4); stroke([zs[1], z], colour, ghost ? 1 : 2); }
  };
  if (hasOtherBefore())
    for (const pose of posesAt(report.motions[report.design.before_motion], state.angle)) drawBody(pose, true);
  const poses = posesAt(motion, state.angle);
  for (const pose of poses) drawBody(pose, false);
  for (const pose of poses) {
    pose.body.points.forEach((point, p) => {
      const [x, y] = at(pose.joints[p]);
      pen.fillStyle = colours.card;
      pen.strokeStyle = colours.body;
      pen.lineWidth = 1.6;
      if (point.fixed) {
        pen.beginPath(); pen.moveTo(x, y); pen.lineTo(x - 8, y + 13); pen.lineTo(x + 8, y + 13); pen.closePath();
        pen.fill(); pen.stroke();
      }
      pen.beginPath(); pen.arc(x, y, 3.6, 0, 2 * Math.PI); pen.fill(); pen.stroke();
    });
    // The link's name beside its middle.
    const [a, b] = [pose.joints[0], pose.joints[Math.min(1, pose.joints.length - 1)]];
    const [ax, ay] = at(a), [bx, by] = at(b), length = Math.hypot(bx - ax, by - ay);
    const [nx, ny] = length > 1 ? [(by - ay) / length, -(bx - ax) / length] : [0, -1.6];
    pen.fillStyle = pose.body.elastic ? colours.rod : colours.muted;
    pen.textAlign = "center"; pen.textBaseline = "middle";
    const half = pen.measureText(pose.body.name).width / 2;
    // A halo keeps it legible on what it crosses.
    pen.strokeStyle = colours.card; pen.lineWidth = 4; pen.lineJoin = "round";
    const [tx, ty] = [(ax + bx) / 2 + nx * (10 + half), (ay + by) / 2 + ny * 12];
    pen.strokeText(pose.body.name, tx, ty);
    pen.fillText(pose.body.name, tx, ty);
  }
  const note = document.getElementById("mechanism-note");
  const elastic = motion.bodies.some((body) => body.elastic);
  const words = !elastic ? "No elastic link." : clippedRods.length
    ? `${clippedRods.join(", ")}: too large a vibration for this magnification, drawn with 0.4 of the link's length at most.`
    : `${state.magnification === 1 ? "Drawn to scale" : `Vibration drawn ${short(state.magnification)} times larger`}; dashed: ${motion.rigid ? "the chord" : "the rigid link"}.`;
  const theory = beyondRods.length ? ` Beyond the linear theory: ${beyondRods.join(", ")}, drawn grey and dashed.` : "";
  const more = theory + (hasOtherBefore() ? " Light: the design before." : "");
  if (note.textContent !== words + more) note.textContent = words + more;
};

const setUpMechanism = () => {
  if (rods.length > 1) document.getElementById("mechanism-section").classList.add("several");
  if (!isLinkage || !(report.motions || []).length) {
    document.getElementById("mechanism-controls").remove();
    addView(mechanismCanvas, drawMechanism, drawMechanism);
    return;
  }
  const select = document.getElementById("magnification");
  if (!state.magnification) state.magnification = usualMagnification();
  const sizes = magnifications.includes(state.magnification) ? magnifications : [...magnifications, state.magnification].sort((a, b) => a - b);
  for (const m of sizes) select.append(element("option", {value: m, selected: m === state.magnification}, m >= 1e5 ? `10${m === 1e5 ? "⁵" : m === 1e6 ? "⁶" : "⁷"} ×` : `${m} ×`));
  select.addEventListener("change", () => { state.magnification = Number(select.value); redraw(); writeFragment(); });
  const pace = document.getElementById("pace");
  for (const s of [1, 2, 4, 8, 16, 32]) pace.append(element("option", {value: s, selected: s === state.secondsPerTurn}, `${s} s`));
  pace.addEventListener("change", () => { state.secondsPerTurn = Number(pace.value); writeFragment(); });
  const button = document.getElementById("play"), angle = document.getElementById("angle"), value = document.getElementById("angle-value");
  button.addEventListener("click", () => { play(!state.playing); writeFragment(); });
  onPlay.push(() => { button.textContent = state.playing ? "Pause" : "Play"; button.setAttribute("aria-pressed", String(state.playing)); });
  angle.addEventListener("input", () => { play(false); setAngle((Number(angle.value) * Math.PI) / 180); writeFragment(); });
  onAngle.push(() => {
    const degrees = Math.round((state.angle * 180) / Math.PI);
    angle.max = 360 * turns();
    angle.value = degrees;
    value.textContent = `${degrees}°`;
  });
  const view = addView(mechanismCanvas, () => { fitMechanism(); drawMechanism(); describeMechanism(); }, drawMechanism);
  return view;
};
// No higher than the mechanism and its vibration need.
const fitMechanism = () => {
  const motion = motionHere();
  if (!motion) return;
  const {low, high} = reach(motion.rigid || motion), share = (high[1] - low[1]) / (high[0] - low[0] || 1);
  const most = `${Math.round(Math.max(340, Math.min(640, 68 + share * sizeOf(mechanismCanvas).width)))}px`;
  if (mechanismCanvas.style.maxHeight !== most) mechanismCanvas.style.maxHeight = most;
};
const describeMechanism = () => {
  const motion = motionHere();
  if (!motion) return;
  mechanismCanvas.setAttribute("aria-label", `The mechanism: ${motion.bodies.map((b) => b.name + (b.elastic ? " (elastic)" : b.slider ? " (slider)" : "")).join(", ")}; vibration drawn ${state.magnification} times larger.`);
};

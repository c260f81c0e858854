// Where the bodies are: joint 0 and direction of each as Fourier series of the crank angle, their points in their own
// frames.
const motionAt = (motion, angle) => motion.bodies.map((body, k) => {
  const series = motionSeries(motion, k);
  const [x, y, ex, ey] = series.map((component) => valueAt(component, angle / (motion.turns || 1)));
  return {
    body, origin: [x, y], direction: [ex, ey],
    at: (p) => [x + ex * p[0] - ey * p[1], y + ey * p[0] + ex * p[1]],
  };
});
const motionSeries = (motion, k) => {
  if (!motion.series) motion.series = motion.bodies.map((body) => seriesOf(body.frame));
  return motion.series[k];
};

// Motion of the chosen point: one for all where only the speed differs.
const rigidMotionHere = () => {
  const here = place(state.index);
  if (here && here.motion !== undefined && here.motion !== null) return report.motions[here.motion];
  return here && here.problem ? null : (report.motions || [])[0] || null;
};
// With frames of its own where the mechanism moves as its bent links let it: series over as many turns as the motion has.
const motionHere = () => {
  const rigid = rigidMotionHere(), here = place(state.index), frames = here && here.curves && here.curves.frames;
  if (!rigid || !frames) return rigid;
  if (!here.bentMotion) here.bentMotion = {...rigid, series: null, turns: turns(), rigid, bodies: rigid.bodies.map((body, k) => ({...body, frame: frames[k]}))};
  return here.bentMotion;
};

// Shape of one rod: w(x) = sum q_i sin(i pi x/l), to the left of joint 0 -> joint 1 positive.
const deflection = (q, share) => {
  let w = 0;
  for (let i = 0; i < q.length; ++i) w += q[i] * Math.sin((i + 1) * Math.PI * share);
  return w;
};

// Places along the chord of an inextensible rod: each piece dx of the rod covers sqrt(1 - w'^2) dx of it.
const alongChord = (q, length, pieces) => {
  const places = [0];
  for (let k = 0; k < pieces; ++k) {
    let slope = 0;
    for (let i = 0; i < q.length; ++i) slope += ((q[i] * (i + 1) * Math.PI) / length) * Math.cos(((i + 1) * Math.PI * (k + 0.5)) / pieces);
    places.push(places[k] + (length / pieces) * Math.sqrt(Math.max(0, 1 - slope * slope)));
  }
  return places;
};

// Ritz coordinates of a rod at the chosen speed as series; null where there is no periodic motion.
let responseCache = {index: -1, of: {}};
const responseOf = (name) => {
  if (responseCache.index !== state.index) responseCache = {index: state.index, of: {}};
  if (!(name in responseCache.of)) {
    const here = place(state.index), curves = here && here.curves && here.curves.rods[name];
    responseCache.of[name] = curves && curves.q ? seriesOf(curves.q) : null;
  }
  return responseCache.of[name];
};
// The linear answer, where the motion shown is another one.
const linearResponseOf = (name) => {
  const here = place(state.index), curves = here && here.curves && here.curves.rods[name];
  return curves && curves.linear ? seriesOf(curves.linear) : null;
};
const coordinatesAt = (name, angle) => {
  const q = responseOf(name);
  return q ? q.map((component) => valueAt(component, angle / turns())) : null;
};

// The rod's answer at the chosen speed lies beyond the linear theory: drawn dashed and grey.
const isBeyondAt = (index, name) => {
  const here = place(index), own = here && here.numbers && here.numbers.rods && here.numbers.rods[name];
  return !!own && (own.theory === "beyond" || own.theory_error > 0.05);
};
const isBeyond = (name) => isBeyondAt(state.index, name);

// Why a plot of this speed is empty.
const whyEmpty = (what) => {
  if (points.count === 0) return `Without single speeds this page has no ${what}: hb report, sweep and steady compute them.`;
  const here = place(state.index);
  if (!isKept(state.index)) return `Left out here: of ${points.count} speeds the page keeps curves of every ${report.points.every}th. Verdict and growth rate are those of this speed.`;
  if (here && here.problem) return here.problem;
  return `No ${what} at this speed: there is no periodic motion, or it was not asked for.`;
};

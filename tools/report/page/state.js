// What is chosen: the speed's index, the crank angle, and how things are drawn. Views register with an element and are
// drawn once per frame, and only while they are in sight.
const state = {
  index: 0, angle: 0, playing: false, magnification: 0, secondsPerTurn: 4, joint: "", zoom: null, mapNode: null, band: 0, fibre: 0,
};

const views = [];
let frameAsked = false;

const flush = () => {
  frameAsked = false;
  for (const view of views) {
    if (!view.dirty || !view.visible) continue;
    const what = view.dirty;
    view.dirty = "";
    if (what === "all") view.draw(); else view.move();
  }
};
const askFrame = () => {
  if (frameAsked) return;
  frameAsked = true;
  requestAnimationFrame(flush);
};

const observer = new IntersectionObserver((entries) => {
  for (const entry of entries) {
    for (const view of views) if (view.element === entry.target) view.visible = entry.isIntersecting;
  }
  askFrame();
}, {rootMargin: "150px"});
// Sizes as the observer told them: asking the page while numbers change would make it lay itself out at every step.
const sizes = new WeakMap();
const sizeOf = (node) => {
  if (!sizes.has(node)) { const box = node.getBoundingClientRect(); sizes.set(node, {width: box.width, height: box.height}); }
  return sizes.get(node);
};
const resized = new ResizeObserver((entries) => {
  for (const entry of entries) {
    sizes.set(entry.target, {width: entry.contentRect.width, height: entry.contentRect.height});
    for (const view of views) if (view.element === entry.target) view.dirty = "all";
  }
  askFrame();
});

// A cleared canvas with sharp pixels, drawn on in units of the page.
const cleanPen = (canvas, {width, height}) => {
  const ratio = window.devicePixelRatio || 1, pen = canvas.getContext("2d"), wide = Math.round(width * ratio), high = Math.round(height * ratio);
  if (canvas.width !== wide || canvas.height !== high) { canvas.width = wide; canvas.height = high; }
  pen.setTransform(ratio, 0, 0, ratio, 0, 0);
  pen.clearRect(0, 0, width, height);
  pen.font = "12px system-ui, 'DejaVu Sans', sans-serif";
  return pen;
};

// draw(): everything, after another speed or size; move(): what follows the crank angle. A view that does not follow
// the speed is drawn for its size and colours alone.
const addView = (node, draw, move = () => {}, follows = true) => {
  const view = {element: node, draw, move, follows, dirty: "all", visible: true};
  views.push(view);
  observer.observe(node);
  resized.observe(node);
  return view;
};
const redraw = () => { for (const view of views) view.dirty = "all"; askFrame(); };
const redrawSpeed = () => { for (const view of views) if (view.follows) view.dirty = "all"; askFrame(); };
const drawNow = () => {
  for (const view of views) { sizes.delete(view.element); view.visible = true; view.dirty = "all"; }
  flush();
};

const onSpeed = [];
const slider = document.getElementById("speed");

// The one way to another speed: the slider's own event.
const chooseSpeed = (index) => {
  const wanted = Math.max(0, Math.min(points.count - 1, Math.round(index)));
  if (!Number.isFinite(wanted) || (wanted === state.index && slider.value === String(wanted))) return;
  slider.value = String(wanted);
  slider.dispatchEvent(new Event("input", {bubbles: true}));
};
const nearestIndex = (x) => {
  let best = 0;
  for (let k = 1; k < points.count; ++k) if (Math.abs(points.x[k] - x) < Math.abs(points.x[best] - x)) best = k;
  return best;
};

const turns = () => { const here = place(state.index); return (here && here.numbers && here.numbers.period) || 1; };
const setAngle = (angle) => {
  const whole = 2 * Math.PI * turns();
  state.angle = ((angle % whole) + whole) % whole;
  for (const view of views) if (!view.dirty && view.follows) view.dirty = "angle";
  for (const tell of onAngle) tell();
  askFrame();
};
const onAngle = [];

let lastTime = 0;
const step = (time) => {
  if (!state.playing) return;
  if (lastTime) setAngle(state.angle + (2 * Math.PI * Math.min(100, time - lastTime)) / (1000 * state.secondsPerTurn));
  lastTime = time;
  requestAnimationFrame(step);
};
const play = (on) => {
  if (state.playing === on) return;
  state.playing = on;
  lastTime = 0;
  for (const tell of onPlay) tell();
  if (on) requestAnimationFrame(step);
};
const onPlay = [];

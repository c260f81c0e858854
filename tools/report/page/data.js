// The data document of the page: JSON in an element of its own, whose number columns and Fourier series point into one
// block of bytes (base64, little endian).
const report = JSON.parse(document.getElementById("report-data").textContent);

const bytes = (() => {
  const text = atob(report.bytes || "");
  const block = new Uint8Array(text.length);
  for (let k = 0; k < text.length; ++k) block[k] = text.charCodeAt(k);
  return block.buffer;
})();
delete report.bytes;

// Columns: [byte offset, count]. NaN stands for "no number".
const doubles = (ref) => (ref ? new Float64Array(bytes, ref[0], ref[1]) : new Float64Array(0));
const floats = (ref) => (ref ? new Float32Array(bytes, ref[0], ref[1]) : new Float32Array(0));

// A Fourier series f(tau) = sum c_n e^{i n tau}: [byte offset, [harmonics of each component]], per component
// (re, im) of c_0 .. c_H.
const seriesOf = (ref) => {
  if (!ref) return null;
  let offset = ref[0];
  return ref[1].map((harmonics) => {
    const values = new Float32Array(bytes, offset, 2 * (harmonics + 1));
    offset += values.byteLength;
    return values;
  });
};

// f at one angle; c_-n = conj c_n, so f = c_0 + 2 sum Re(c_n e^{i n tau}).
const valueAt = (component, angle) => {
  if (component.length === 0) return 0;
  let sum = 0;
  const c = Math.cos(angle), s = Math.sin(angle);
  let re = 1, im = 0;
  for (let k = 2; k < component.length; k += 2) {
    [re, im] = [re * c - im * s, re * s + im * c];
    sum += component[k] * re - component[k + 1] * im;
  }
  return component[0] + 2 * sum;
};

// f at count + 1 equally spaced angles of the period, the last closing it.
const samplesOf = (component, count) => {
  const values = new Float64Array(count + 1);
  for (let j = 0; j < count; ++j) values[j] = valueAt(component, (2 * Math.PI * j) / count);
  values[count] = values[0];
  return values;
};
const samplesNeeded = (components) => {
  const most = Math.max(0, ...components.map((c) => c.length / 2 - 1));
  return Math.min(1440, Math.max(180, 8 * most));
};

const points = {
  count: report.points.count,
  x: doubles(report.points.x),
  rpm: doubles(report.points.rpm),
  omega: doubles(report.points.omega),
};
const isLinkage = report.kind === "linkage";
// Motions without linearisation, where they were asked for; a single speed may have none.
const isNonlinear = report.theory === "nonlinear";
const isSpeedAxis = report.axis.kind !== "parameter";
const rods = report.rods;

// What is known of one point: its document of numbers (as `hb steady --json` has it) and its curves. Null where the
// page was thinned or the scene has no answer.
const place = (() => {
  const kept = report.points.kept, where = new Map();
  if (kept) kept.forEach((index, k) => where.set(index, k));
  const slot = (index) => (kept ? where.get(index) : index);
  const shapes = report.shapes || [], words = report.words || [], numbers = doubles(report.numbers);
  // A document's shape with its numbers, texts and truth values put back, in order.
  const filled = (shape, next) => {
    if (shape === 0) { const value = next(); return Number.isNaN(value) ? null : value; }
    if (shape === 1) return words[next()];
    if (shape === 2) return next() === 1;
    if (Array.isArray(shape)) return shape.map((part) => filled(part, next));
    const whole = {};
    for (const key of Object.keys(shape)) whole[key] = filled(shape[key], next);
    return whole;
  };
  const known = new Map();
  return (index) => {
    if (known.has(index)) return known.get(index);
    const k = slot(index);
    let value = null;
    const entry = k === undefined ? null : (report.places || [])[k];
    if (entry) {
      let at = entry.numbers;
      const shape = shapes[entry.shape];
      value = {
        problem: entry.problem || "",
        lacking: entry.lacking || "",
        numbers: shape === undefined ? null : filled(shape, () => numbers[at++]),
        curves: entry.curves || null,
        motion: entry.motion,
      };
    }
    known.set(index, value);
    return value;
  };
})();
const isKept = (index) => !report.points.kept || report.points.kept.includes(index);

const verdictNames = {s: "stable", b: "bounded", u: "unstable", "?": "undecided", "-": ""};
// Of one link; of all together where they have one verdict only.
const lettersOf = (rod) => report.verdicts[rod] || report.verdicts[""] || "";
const verdictOf = (rod, index) => verdictNames[lettersOf(rod)[index]] || "";

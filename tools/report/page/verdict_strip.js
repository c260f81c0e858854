// Under the slider: a tick for every computed speed in the colour of its verdict, a row per rod, and the unstable
// bands with their computed ends. Between ticks nothing is said.
const setUpStrip = () => {
  const host = document.getElementById("strip");
  const together = isNonlinear && report.verdicts[""];
  const rows = together ? [{name: "all links together", key: ""}] : rods.filter((rod) => report.verdicts[rod.name]).map((rod) => ({name: rod.name, key: rod.name}));
  if (points.count === 0 || rows.length === 0) { host.remove(); return; }
  const height = rows.length > 3 ? 7 : 10;
  host.style.height = rows.length * (height + 3) + "px";
  const canvas = element("canvas", {title: "verdicts of the computed speeds"});
  host.append(canvas);
  const first = points.x[0], last = points.x[points.count - 1];
  // The slider goes by index; equally spaced speeds stand under their place.
  const xOf = (x) => (last > first ? (x - first) / (last - first) : 0.5);
  const draw = () => {
    const box = sizeOf(host), pen = cleanPen(canvas, box);
    const wide = Math.max(0.6, Math.min(4, 0.7 * (box.width / Math.max(1, points.count - 1))));
    rows.forEach((rod, r) => {
      const top = r * (height + 3);
      pen.fillStyle = colours.grid;
      pen.fillRect(0, top, box.width, height);
      pen.fillStyle = colours["unstable-band"];
      for (const band of bandsOf(rod.key)) pen.fillRect(xOf(band.from) * box.width, top, Math.max(1, (xOf(band.to) - xOf(band.from)) * box.width), height);
      const letters = report.verdicts[rod.key];
      for (let k = 0; k < points.count; ++k) {
        pen.fillStyle = colours[verdictNames[letters[k]] || "none"];
        pen.fillRect(xOf(points.x[k]) * box.width - wide / 2, top, wide, height);
      }
    });
  };
  addView(host, draw, draw, false);
  canvas.addEventListener("click", (event) => {
    const box = canvas.getBoundingClientRect();
    chooseSpeed(nearestIndex(first + ((event.clientX - box.left) / box.width) * (last - first)));
  });
  const words = rows.map((rod) => {
    const counts = {};
    for (const letter of report.verdicts[rod.key]) counts[verdictNames[letter] || "no answer"] = (counts[verdictNames[letter] || "no answer"] || 0) + 1;
    return `${rod.name}: ` + Object.entries(counts).map(([name, n]) => `${n} ${name}`).join(", ");
  });
  host.setAttribute("aria-label", "Verdicts of the computed speeds. " + words.join("; "));
  host.title = rows.map((rod) => rod.name).join(", ") + ": one tick for each computed speed";
};

// Unstable bands as `hb sweep --json` lists them.
const bandsOf = (name) => ((report.sweep && report.sweep.band_details) || {})[name] || [];
const criticalOf = (name) => ((report.sweep && report.sweep.critical) || []).filter((c) => c.rod === name);

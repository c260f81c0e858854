// The page comes alive.
const showSpeed = () => {
  const value = document.getElementById("rpm-value"), axis = document.getElementById("axis-value");
  const known = points.count > 0;
  value.textContent = known ? asJson(points.rpm[state.index]) : "–";
  if (!isSpeedAxis && known) axis.textContent = `${report.axis.label} = ${short(points.x[state.index], 8)}${report.axis.unit ? " " + report.axis.unit : ""}`;
  else if (report.axis.kind === "omega" && known) axis.textContent = `Ω = ${short(points.omega[state.index], 8)} rad/${units.time}`;
  const words = [];
  for (const rod of rods) {
    const verdict = known ? verdictOf(rod.name, state.index) : "", mark = document.getElementById("verdict-" + rod.name);
    if (!mark) continue;
    mark.textContent = verdict || "–";
    mark.dataset.verdict = verdict;
    words.push(`${rod.name} ${verdict || "no verdict"}`);
  }
  slider.setAttribute("aria-valuetext", known ? `${short(points.rpm[state.index], 8)} rpm: ${words.join(", ")}` : "no speeds");
  numbersFollow();
};

slider.addEventListener("input", () => {
  const index = Number(slider.value);
  if (!(index >= 0 && index < points.count)) return;
  state.index = index;
  showSpeed();
  for (const tell of onSpeed) tell();
  redrawSpeed();
  writeFragment();
});
document.getElementById("speed-down").addEventListener("click", () => chooseSpeed(state.index - 1));
document.getElementById("speed-up").addEventListener("click", () => chooseSpeed(state.index + 1));
document.addEventListener("keydown", (event) => {
  if (event.altKey || event.ctrlKey || event.metaKey || event.target.closest("input, select, button, canvas, summary, a, pre")) return;
  if (event.key === "ArrowLeft") chooseSpeed(state.index - 1);
  else if (event.key === "ArrowRight") chooseSpeed(state.index + 1);
  else if (event.key === " " && isLinkage) play(!state.playing);
  else return;
  event.preventDefault();
});

const start = () => {
  if (!report.map) document.querySelector("nav a[href='#map-section']").hidden = true;
  if (isNonlinear) document.querySelector(".badges").append(element("span", {class: "badge note-badge"}, "all links together, without linearisation"));
  if (!isLinkage) {
    document.documentElement.classList.add("no-linkage");
    document.querySelector("#mechanism-section > h2").textContent = "At this speed";
    document.querySelector("nav a[href='#mechanism-section']").textContent = "Numbers";
    document.querySelector(".skip").textContent = "Skip to the numbers";
    document.querySelector("#rods > h2").textContent = "The system at this speed";
    document.querySelector("nav a[href='#rods']").textContent = "System";
  }
  if (points.count === 0) document.documentElement.classList.add("no-points");
  // The number that the slider goes by stands first.
  if (report.axis.kind !== "rpm") document.getElementById("controls").classList.add("by-axis");
  readFragment();
  slider.value = String(state.index);
  document.getElementById("announce").remove();
  setUpNotes();
  setUpStrip();
  setUpMechanism();
  setUpRods();
  setUpForces();
  setUpCharts();
  setUpForceRange();
  setUpMap();
  setUpDesign();
  setUpTables();
  showSpeed();
  for (const tell of onSpeed) tell();
  for (const tell of onAngle) tell();
  const still = window.matchMedia("(prefers-reduced-motion: reduce)").matches;
  if (isLinkage && (report.motions || []).length && (state.wantsPlay === undefined ? !still : state.wantsPlay)) play(true);
  const recolour = () => { readColours(); for (const chart of charts) chart.redraw(); redraw(); };
  window.matchMedia("(prefers-color-scheme: dark)").addEventListener("change", recolour);
  // Paper is white: colours of the light scheme, sizes of the page, and everything drawn, in sight or not.
  const onPaper = (on) => {
    document.documentElement.classList.toggle("printing", on);
    for (const more of document.querySelectorAll("#notes details")) more.open = on;
    recolour();
    for (const chart of charts) chart.onPaper(on);
    showDueNumbers();
    drawNow();
  };
  window.addEventListener("beforeprint", () => onPaper(true));
  window.addEventListener("afterprint", () => onPaper(false));
};
start();

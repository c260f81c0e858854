// Branches of motions without linearisation over the axis: along their arc, so that folds stay folds.
const nonlinear = (report.sweep && report.sweep.nonlinear) || null;
const allBranches = () => (nonlinear ? nonlinear.branches : []).map((branch) => ({
  ...branch, x: doubles(branch.x), verdicts: [...branch.verdict].map((letter) => verdictNames[letter] || "undecided"),
  growth: floats(branch.growth_rate),
}));

// Columns of one rod's component, or of the growth of all rods together.
const peakBranches = (rod, component) => allBranches().map((branch) => ({...branch, y: floats(branch.rods[rod][component])}));
const growthBranches = () => allBranches().map((branch) => ({...branch, y: branch.growth}));

// Solid where stable, dashed elsewhere; a piece whose ends differ counts as undecided.
const drawBranches = (branches) => (pen, area, chart) => {
  pen.lineJoin = "round";
  for (const {x, y, verdicts} of branches) {
    const at = (k) => [chart.toDomXCoord(x[k]), chart.toDomYCoord(y[k])];
    for (let k = 1; k < x.length;) {
      const kind = verdicts[k - 1] === verdicts[k] ? verdicts[k] : "undecided";
      pen.strokeStyle = colours[kind] || colours.ink;
      pen.setLineDash(kind === "stable" || kind === "bounded" ? [] : [6, 4]);
      pen.lineWidth = 2.4;
      pen.beginPath();
      pen.moveTo(...at(k - 1));
      // One line for all pieces of a kind: dashes run on.
      do pen.lineTo(...at(k++)); while (k < x.length && kind === (verdicts[k - 1] === verdicts[k] ? verdicts[k] : "undecided"));
      pen.stroke();
    }
  }
  pen.setLineDash([]);
};
// Folds as dots, other bifurcations as circles.
const drawEvents = (yOf) => (pen, area, chart) => {
  for (const [events, hollow] of nonlinear ? [[nonlinear.folds, false], [nonlinear.bifurcations, true]] : []) {
    for (const event of events) {
      const y = yOf(event);
      if (!Number.isFinite(y)) continue;
      pen.beginPath();
      pen.arc(chart.toDomXCoord(event.x), chart.toDomYCoord(y), 4, 0, 2 * Math.PI);
      pen.fillStyle = hollow ? colours.card : colours.ink;
      pen.strokeStyle = colours.ink;
      pen.lineWidth = 1.5;
      pen.fill();
      pen.stroke();
    }
  }
};
const branchLegend = () => (nonlinear ? [{text: "stable motion", colour: "stable"}, {text: "unstable motion", colour: "unstable", dashed: true},
  ...(nonlinear.branches.some((b) => b.verdict.includes("?")) ? [{text: "undecided", colour: "undecided", dashed: true}] : [])] : []);
const branchWords = () => {
  if (!nonlinear) return "";
  const marks = [nonlinear.folds.length ? "dots: folds, where a motion turns back in speed" : "", nonlinear.bifurcations.length ? "circles: other bifurcations" : ""].filter(Boolean);
  return `Coloured: motions without linearisation along ${nonlinear.branches.length === 1 ? "their branch" : `${nonlinear.branches.length} branches`}${marks.length ? "; " + marks.join("; ") : ""}. Grey: the linear theory.`;
};

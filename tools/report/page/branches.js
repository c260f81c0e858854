// Branches of nonlinear motions over the speed: along their arc, so that folds stay folds.
const branchCurves = (rod, component) => ((report.sweep && report.sweep.branches) || []).map((branch) => {
  const own = branch.rods && branch.rods[rod];
  const x = report.axis.kind === "omega" ? branch.omega : branch.rpm;
  return {x, y: own && own.max_abs ? own.max_abs.map((q) => (q ? q[component] : NaN)) : [], verdict: branch.verdict || []};
}).filter((branch) => branch.y.length > 1);

// Solid where stable, dashed elsewhere; each piece has the verdict of both its ends.
const drawBranches = (branches) => (pen, area, chart) => {
  for (const branch of branches) {
    for (let k = 1; k < branch.x.length; ++k) {
      if (!(branch.y[k - 1] > 0 && branch.y[k] > 0)) continue;
      const same = branch.verdict[k - 1] === branch.verdict[k] ? branch.verdict[k] : "undecided";
      pen.strokeStyle = colours[same] || colours.ink;
      pen.setLineDash(same === "stable" || same === "bounded" ? [] : [5, 4]);
      pen.lineWidth = 2.2;
      pen.beginPath();
      pen.moveTo(chart.toDomXCoord(branch.x[k - 1]), chart.toDomYCoord(branch.y[k - 1]));
      pen.lineTo(chart.toDomXCoord(branch.x[k]), chart.toDomYCoord(branch.y[k]));
      pen.stroke();
    }
  }
  pen.setLineDash([]);
};
const branchLegend = (branches) => (branches.length === 0 ? [] : [{text: "branch, stable (q₁)", colour: "stable"}, {text: "branch, unstable", colour: "unstable", dashed: true}]);

// What a reader should know first: shortfalls, warnings, thinning, and speeds beyond linear theory.
const setUpNotes = () => {
  const host = document.getElementById("notes");
  const note = (words, warning) => host.append(element("div", {class: warning ? "note warning" : "note"}, [].concat(words).map((w) => (w instanceof Node ? w : element("p", {}, w)))));
  // The first ones at once, the rest on request: the mechanism stays in sight.
  const limit = (list) => {
    const lines = [...list].map((w) => element("p", {}, w)), most = 2;
    if (lines.length <= most + 1) return lines;
    return [...lines.slice(0, most), element("details", {}, element("summary", {}, `and ${lines.length - most} more`), lines.slice(most))];
  };
  const problems = (report.sweep && report.sweep.problems) || [];
  const missed = report.status !== "reached";
  if ((report.notes || []).length) note([missed ? "Tolerance not reached:" : "Known less well than usual:", ...limit(report.notes)], missed);
  const warnings = [...new Set(report.warnings || [])], ofLinear = isNonlinear ? warnings.filter((w) => /beyond (the linear theory|small deflections)/.test(w)) : [];
  const rest = warnings.filter((w) => !ofLinear.includes(w));
  if (rest.length) note(limit(rest), true);
  if (ofLinear.length) note(["Of the linear theory, which is drawn in grey here:", ...limit(ofLinear)]);
  if (problems.length) note(`${problems.length} of ${points.count} points have no answer; the first: ${problems[0].reason}`, true);
  if (report.thinned) note(report.thinned);
  if (isNonlinear && nonlinear) {
    const lost = [...(report.verdicts[""] || "")].length ? nonlinear.followed.filter((branch) => branch === null).length : 0;
    note("Motions without linearisation, all elastic links together: every speed shows the motion of the branch followed from the first one." + (lost ? ` It does not come to ${lost} of the ${points.count} speeds: these show the linear theory and say so.` : ""));
  } else if (isNonlinear) note("The motion without linearisation, all elastic links together.");
};

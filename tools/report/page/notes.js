// What a reader should know first: shortfalls, warnings, thinning, and speeds beyond linear theory.
const setUpNotes = () => {
  const host = document.getElementById("notes");
  const note = (words, warning) => host.append(element("div", {class: warning ? "note warning" : "note"}, [].concat(words).map((w) => element("p", {}, w))));
  const limit = (list) => (list.length > 6 ? [...list.slice(0, 6), `… and ${list.length - 6} more`] : list);
  const problems = (report.sweep && report.sweep.problems) || [];
  if ((report.notes || []).length) note(["Tolerance not reached:", ...limit(report.notes)], true);
  if ((report.warnings || []).length) note(limit(report.warnings), true);
  if (problems.length) note(`${problems.length} of ${points.count} points have no answer; the first: ${problems[0].reason}`, true);
  if (report.thinned) note(report.thinned);
};

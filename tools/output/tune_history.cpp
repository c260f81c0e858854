#include <cmath>

#include "tools/output/tune_output.hpp"

namespace hb::tools {

CsvFile history_csv(const TuneTask& task, const TuneResult& result) {
  CsvFile file;
  file.name = "history.csv";
  file.comment = {
      "Designs in the order tried; goal nan: no such design.",
      "excess: how far the value, with the room kept for its error, is beyond the bound (> 0: not met),",
      "over the bound (margins: over the larger of bound and margin at the start); of all rods the largest"};
  for (const TuneVariable& variable : task.variables) file.columns.push_back(variable.path);
  file.columns.push_back("goal");
  for (const Keep& keep : task.keeps) file.columns.push_back("excess of " + keep.text);
  const auto n = static_cast<Eigen::Index>(task.variables.size()), m = static_cast<Eigen::Index>(task.keeps.size());
  file.rows =
      Eigen::MatrixXd::Constant(static_cast<Eigen::Index>(result.design.trials.size()), n + 1 + m, std::nan(""));
  for (std::size_t k = 0; k < result.design.trials.size(); ++k) {
    const DesignTrial& trial = result.design.trials[k];
    auto row = file.rows.row(static_cast<Eigen::Index>(k));
    row.head(n) = trial.x.transpose();
    if (!trial.values) continue;
    row(n) = (task.goal.maximise ? -1 : 1) * trial.values->goal;
    for (std::size_t j = 0; j < result.condition_of.size(); ++j) {
      double& excess = row(n + 1 + static_cast<Eigen::Index>(result.condition_of[j]));
      excess = std::fmax(excess, trial.values->conditions(static_cast<Eigen::Index>(j)));  // NaN at first
    }
  }
  return file;
}

}  // namespace hb::tools

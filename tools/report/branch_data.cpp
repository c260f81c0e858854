#include "tools/report/branch_data.hpp"

#include <nlohmann/json.hpp>

#include "tools/output/json.hpp"
#include "tools/report/page_values.hpp"

namespace hb::tools {
namespace {

// max |q_i| of each rod shown, a column for each mode.
Json peak_columns(const NonlinearSweep& sweep, const NonlinearBranch& branch, ByteBlock& block) {
  Json rods = Json::object();
  for (std::size_t r = 0; r < sweep.rods.size(); ++r) {
    if (!sweep.reported[r]) continue;
    Json columns = Json::array();
    for (std::size_t i = 0; i < branch.points.front().max_abs[r].size(); ++i) {
      std::vector<double> column;
      for (const NonlinearPoint& point : branch.points) column.push_back(point.max_abs[r][i]);
      columns.push_back(block.floats(column));
    }
    rods[sweep.rods[r]] = std::move(columns);
  }
  return rods;
}

// Events in their order, each with max |q_i| of the rods shown.
Json events(Json list, const std::vector<NonlinearEvent>& from, const NonlinearSweep& sweep) {
  for (std::size_t k = 0; k < from.size(); ++k)
    for (std::size_t r = 0; r < sweep.rods.size(); ++r)
      if (sweep.reported[r]) list[k]["max_abs"][sweep.rods[r]] = from[k].max_abs[r];
  return list;
}

}  // namespace

Json branch_data(Json& sweep, const NonlinearSweep& branches, ByteBlock& block) {
  Json own;
  own["branches"] = Json::array();
  for (std::size_t b = 0; b < branches.branches.size(); ++b) {
    const Json& from = sweep["branches"][b];
    Json branch = {{"period", from["period"]}, {"end", from["end"]}, {"why", from.value("why", std::string())}};
    branch["x"] = block.doubles(numbers(from["x"]));
    for (const char* key : {"growth_rate", "growth_error"}) branch[key] = block.floats(numbers(from[key]));
    branch["verdict"] = letters(from["verdict"]);
    branch["rods"] = peak_columns(branches, branches.branches[b], block);
    own["branches"].push_back(std::move(branch));
  }
  own["folds"] = events(std::move(sweep["fold_details"]), branches.folds, branches);
  own["bifurcations"] = events(std::move(sweep["bifurcations"]), branches.bifurcations, branches);
  own["jumps"] = std::move(sweep["jumps"]);
  own["followed"] = std::move(sweep["system"]["branch"]);
  return own;
}

}  // namespace hb::tools

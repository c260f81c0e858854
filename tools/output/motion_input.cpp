#include "tools/output/motion_input.hpp"

#include <fmt/core.h>

#include "tools/output/json.hpp"

namespace hb::tools {
namespace {

[[noreturn]] void refuse(const std::string& name, const std::string& what) {
  throw RequestError("start", fmt::format("{}, {}", name, what),
                     "the steady.json of hb steady --theory nonlinear of this scene, with all its elastic links");
}

// Rows of one rod's fourier, [[re, im], ..] for each mode.
void add_rows(const nlohmann::json& fourier, FourierSeries& q, Eigen::Index& row) {
  for (const nlohmann::json& mode : fourier) {
    for (std::size_t k = 0; k < mode.size(); ++k)
      q.c(row, static_cast<Eigen::Index>(k)) = {mode.at(k).at(0).get<double>(), mode.at(k).at(1).get<double>()};
    ++row;
  }
}

}  // namespace

BranchStart motion_from_json(const std::string& text, const std::string& name, const SweepScene& scene) {
  if (scene.axis().kind == Axis::Kind::parameter)
    throw RequestError("start", fmt::format("{} with @x {}", name, scene.axis().path), "a sweep along the speed");
  const nlohmann::json json = nlohmann::json::parse(text, nullptr, false);
  if (!json.is_object() || json.value("theory", "") != "nonlinear" || !json.value("found", false))
    refuse(name, "no motion without linearisation");
  try {
    BranchStart start;
    start.x = json.at(scene.axis().kind == Axis::Kind::rpm ? "rpm" : "omega").get<double>();
    start.turns = json.at("period").get<int>();
    Eigen::Index rows = 0;
    std::size_t columns = 1;
    for (const RodModel& rod : scene.first().rods) {
      if (!json.at("rods").contains(rod.name)) refuse(name, "nothing of " + rod.name);
      const nlohmann::json& fourier = json.at("rods").at(rod.name).at("q").at("fourier");
      if (static_cast<Eigen::Index>(fourier.size()) != rod.system.num_modes())
        refuse(name, fmt::format("{} modes of {}, {} asked for", fourier.size(), rod.name, rod.system.num_modes()));
      for (const nlohmann::json& mode : fourier) columns = std::max(columns, mode.size());
      rows += rod.system.num_modes();
    }
    start.q = FourierSeries(rows, static_cast<Eigen::Index>(columns) - 1);
    Eigen::Index row = 0;
    for (const RodModel& rod : scene.first().rods)
      add_rows(json.at("rods").at(rod.name).at("q").at("fourier"), start.q, row);
    return start;
  } catch (const Json::exception&) {
    refuse(name, "an incomplete document");
  }
}

}  // namespace hb::tools

#include "tools/report/design_page.hpp"

#include <fmt/core.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "tools/output/output_units.hpp"
#include "tools/output/tune_output.hpp"
#include "tools/pictures/tune_pictures.hpp"
#include "tools/report/report_data.hpp"

namespace hb::tools {

std::string design_page(const TuneTask& task, const TuneResult& result, const Scene& before,
                        const nlohmann::ordered_json& document, Work& work, PageText text) {
  constexpr int points = 49;
  const SpeedSpan& span = result.span_after;
  const SceneFamily tuned = task.family.with(numbers_at(task, result.tuned));
  const Scene after = tuned.scene();
  ReportData data(after);
  if (span.from < span.to) {
    Axis axis;
    axis.kind = task.in_rpm ? Axis::Kind::rpm : Axis::Kind::omega;
    axis.path = task.in_rpm ? "rpm" : "omega";
    axis.values = evenly(span.from / task.speed_unit, span.to / task.speed_unit, points);
    // Speeds as one would ask for them, without the last digits of the conversion.
    for (double& value : axis.values) value = std::stod(fmt::format("{:.12g}", value));
    const SweepScene along(tuned, task.settings, axis, span.from, axis.values.front());
    data.add_sweep(along, run_sweep(along, work), places_along(along, work));
  } else {
    const auto model = std::make_shared<const SceneModel>(make_model(after, task.settings));
    data.add_speed({model, analyse(*model, span.from, task.settings), "", {}}, task.settings);
  }
  std::vector<ReportData::DesignCurve> curves;
  if (result.curves_before && result.curves_after) {
    const auto speeds = [&](const DesignCurves& design) {
      std::vector<double> x;
      for (const double speed : design.speed) x.push_back(speed / task.speed_unit);
      return x;
    };
    const auto values = [](const auto& column) {
      const Eigen::VectorXd list = column;
      return std::vector<double>(list.begin(), list.end());
    };
    const DesignCurves &first = *result.curves_before, &last = *result.curves_after;
    const OutputUnits units = output_units(before);
    for (std::size_t r = 0; r < last.rods.size(); ++r) {
      const auto column = static_cast<Eigen::Index>(r);
      curves.push_back({"Largest deflection of " + last.rods[r], units.response, speeds(first),
                        values(first.deflection.col(column)), speeds(last), values(last.deflection.col(column))});
    }
    curves.push_back({"Growth rate, largest of the links", units.rate, speeds(first), values(first.growth),
                      speeds(last), values(last.growth)});
  }
  data.add_design(document, tune_table(task, result, before), before, curves);
  return data.page(std::move(text));
}

}  // namespace hb::tools

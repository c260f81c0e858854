#include "tools/pictures/sweep_range.hpp"

#include <algorithm>
#include <cmath>

namespace hb::tools {
namespace {

// No rod is bent by more than its length, as linear responses are beside an end of a band.
bool is_imaginable(const SweepScene& scene, const SweepPoint& point) {
  const Linkage* linkage = scene.first().linkage();
  if (linkage == nullptr) return true;
  for (std::size_t r = 0; r < point.rods.size(); ++r) {
    const std::vector<double>& peaks = point.rods[r].max_abs;
    if (!peaks.empty() && !(peaks.front() <= body_at(*linkage, scene.first().rods[r].link)->length)) return false;
  }
  return true;
}

}  // namespace

std::vector<double> finite(const CsvFile& csv, int column) {
  std::vector<double> values;
  for (Eigen::Index k = 0; k < csv.rows.rows(); ++k)
    if (std::isfinite(csv.rows(k, column - 1))) values.push_back(csv.rows(k, column - 1));
  return values;
}

double median(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

std::vector<double> where_stable(const SweepScene& scene, const SweepResult& result, const CsvFile& csv, int column) {
  const std::vector<const SweepPoint*> points = all_points(result);
  std::vector<double> values;
  for (std::size_t k = 0; k < points.size(); ++k) {
    const bool stable = std::all_of(points[k]->rods.begin(), points[k]->rods.end(), [](const RodPoint& rod) {
      return !rod.stability || rod.stability->stability.verdict <= Verdict::bounded;
    });
    const double value = csv.rows(static_cast<Eigen::Index>(k), column - 1);
    if (stable && is_imaginable(scene, *points[k]) && std::isfinite(value)) values.push_back(value);
  }
  return values.empty() ? finite(csv, column) : values;
}

std::vector<double> without_spikes(std::vector<double> values) {
  if (values.empty()) return values;
  constexpr double many = 4;
  std::vector<double> sizes;
  for (const double value : values) sizes.push_back(std::abs(value));
  const auto ninth = sizes.begin() + static_cast<std::ptrdiff_t>(0.9 * static_cast<double>(sizes.size() - 1));
  std::nth_element(sizes.begin(), ninth, sizes.end());
  const double limit = many * *ninth;
  std::erase_if(values, [&](double value) { return std::abs(value) > limit; });
  return values;
}

double largest(const std::vector<double>& values) {
  return values.empty() ? 0 : *std::max_element(values.begin(), values.end());
}

}  // namespace hb::tools

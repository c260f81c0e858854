// A stability map as it was asked for on the command line: checked first, then computed.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "hb/analysis/map_result.hpp"
#include "hb/analysis/work.hpp"
#include "tools/command/common_flags.hpp"
#include "tools/command/scene_input.hpp"
#include "tools/output/map_output.hpp"

namespace hb::tools {

struct AxisRange {
  PlaneAxis axis;
  std::vector<double> values;
};

struct DampingFactors {
  double low, high;
};

// As written on the command line.
struct BoundaryFlags {
  bool none = false;  // --no-boundaries
  std::string tolerance;  // --boundary-tol
};

class AskedMap {
 public:
  // `x`, `y` and `damping_range` (may be empty) as written; throws UsageError, RequestError or SceneError. Both `input`
  // and `work`, which makes the geometry ready, outlive the object.
  AskedMap(const CommonFlags& flags, const std::string& x, const std::string& y, const std::string& damping_range,
           const BoundaryFlags& boundaries, const SceneInput& input, const Work& work);

  // Of everything that the answer depends on.
  [[nodiscard]] std::uint64_t key() const;
  void compute(Work& work);

  [[nodiscard]] const MapResult& result() const { return result_; }
  [[nodiscard]] MapDocument document() const;
  [[nodiscard]] std::string evidence() const;  // one sentence, for --stats

 private:
  void compute_all(Work& work);
  [[nodiscard]] ScenePlane plane_with(const std::vector<Override>& further) const;

  const SceneInput& input_;
  AxisRange x_, y_;
  std::optional<DampingFactors> factors_;
  std::vector<Override> set_;
  Scene scene_;
  Settings settings_;
  PlaneOptions plane_options_;
  MapOptions search_;
  std::optional<ScenePlane> plane_;
  MapResult result_;
  bool complete_ = true;
};

}  // namespace hb::tools

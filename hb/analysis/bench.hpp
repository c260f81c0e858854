// Error against run time of the periodic state of a scene at one speed, for every method.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "hb/analysis/bench_rod.hpp"
#include "hb/analysis/nonlinear/nonlinear_steady.hpp"
#include "hb/analysis/request.hpp"
#include "hb/analysis/theory_error.hpp"

namespace hb {

// What is asked of tolerance, quantities and stability changes nothing: every method has its own list of tolerances.
struct BenchRequest : Request {
  double case_limit = 5;  // seconds for each case
  std::function<void(std::size_t done, std::size_t total)> told = {};  // after each case, of `total` at most
};

struct Bench {
  Speed given;  // the speed as it was asked for
  Settings settings;
  std::shared_ptr<const SceneModel> model;
  bool nonlinear = false;
  double geometry_seconds = 0;  // once for all speeds
  std::vector<RodBench> rods;  // reported ones; without linearisation all together
  // Of the linear theory, of all elastic links whichever are measured; without linearisation of all together by the
  // reference, empty where there was none.
  std::vector<std::pair<std::string, std::optional<Verdict>>> verdicts;
  std::optional<TheoryErrors> theory;  // of the linear theory of a linkage, in the order of `verdicts`

  [[nodiscard]] bool complete() const;  // a reference was found for each
};

// Throw RequestError.
[[nodiscard]] Bench bench(const Scene& scene, const BenchRequest& request = {});
// The motion without linearisation.
[[nodiscard]] Bench nonlinear_bench(const Scene& scene, const BenchRequest& request, const NonlinearOptions& motion);

}  // namespace hb

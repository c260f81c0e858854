// The motion without linearisation of a scene, along a number of it, and checked, by a request. All throw RequestError
// for what cannot be asked, and SceneError for what cannot be.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "hb/analysis/analyses.hpp"
#include "hb/analysis/nonlinear/nonlinear_check.hpp"
#include "hb/analysis/nonlinear/nonlinear_steady.hpp"
#include "hb/analysis/nonlinear/nonlinear_sweep.hpp"
#include "hb/analysis/sensitivity_band.hpp"

namespace hb {

// request.only of a steady state as in the linear theory; `options` see there.
struct NonlinearSteady : NonlinearResult {
  Speed given;  // the speed as it was asked for
  Settings settings;
  std::shared_ptr<const SceneModel> model;
};
[[nodiscard]] NonlinearSteady nonlinear_steady(const Scene& scene, const Request& request = {},
                                               const NonlinearOptions& options = {});

// The same with the links' numbers at both ends of a band, without slopes.
struct NonlinearBand {
  BandRequest asked;
  NonlinearSteady low, high;
};
// Throws RequestError.
[[nodiscard]] std::vector<NonlinearBand> nonlinear_bands(const Scene& scene, const Request& request,
                                                         const NonlinearOptions& options,
                                                         const std::vector<BandRequest>& bands);

// The linear sweep and the branches over the same values.
struct NonlinearAlong {
  Sweep linear;
  NonlinearSweep branches;
};
[[nodiscard]] NonlinearAlong nonlinear_sweep(const SceneFamily& family, const SweepRequest& request,
                                             const NonlinearSweepOptions& options, Work& work);
[[nodiscard]] NonlinearAlong nonlinear_sweep(const SceneFamily& family, const SweepRequest& request,
                                             const NonlinearSweepOptions& options = {});

struct NonlinearChecks {
  Settings settings;
  std::shared_ptr<const SceneModel> model;
  std::vector<NonlinearCheck> speeds;

  [[nodiscard]] bool agrees() const;  // in everything that could be compared
  [[nodiscard]] bool reached() const;  // nothing missed its tolerance, all was compared
};
// Without `march`, and not by collocation.
[[nodiscard]] NonlinearChecks nonlinear_check(const Scene& scene, const CheckRequest& request,
                                              const NonlinearOptions& options, const Work& work);
[[nodiscard]] NonlinearChecks nonlinear_check(const Scene& scene, const CheckRequest& request = {},
                                              const NonlinearOptions& options = {});

}  // namespace hb

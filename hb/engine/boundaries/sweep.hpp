// Stability of one system along one parameter x (its speed, or any other number): unstable bands with both ends, also
// those that lie between two samples. They start from parametric resonances, so that is where they are looked for:
//     k Omega = omega_i + omega_j,   k Omega = |omega_i - omega_j|       (i = j: 2 omega_i/k)
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "hb/engine/boundaries/mode_tracks.hpp"
#include "hb/engine/system/scaled_system.hpp"
#include "hb/engine/exponents/stability.hpp"

namespace hb {

// What is known at one x.
struct StabilitySample {
  double x = 0;
  double speed = 0;  // rad per unit time
  Stability stability;
};

// The system at x, in the solvers' coordinates; empty where there is none (a linkage that does not close). Same x, same
// result.
using SystemAt = std::function<std::optional<ScaledSystem>(double x)>;

// With options.leading_only: all exponents all the same where the leading ones alone give no bound.
[[nodiscard]] std::optional<StabilitySample> stability_sample(const SystemAt& at, double x,
                                                              const StabilityOptions& options);

// How strongly order k of a parametric resonance couples one mode with each mode, 1/time: column k - 1, k = 1..orders.
// An estimate from above: all paths of harmonics that add up to k, without cancellation.
[[nodiscard]] Eigen::MatrixXd parametric_coupling(const ScaledSystem& system, Eigen::Index mode, Eigen::Index orders);

// Bound, with a margin, on the growth that order k of modes i and j can reach between two places; computed when asked.
class ResonanceStrength {
 public:
  ResonanceStrength(const SystemAt& at, double a, double b, int max_order)
      : at_(at), a_(a), b_(b), orders_(max_order) {}
  double operator()(std::size_t i, std::size_t j, double k);

 private:
  const SystemAt& at_;
  double a_, b_;
  int orders_;
  std::optional<ScaledSystem> first_, last_;
  std::vector<Eigen::MatrixXd> of_mode_;
};

// The exponent that gives the growth rate is known well enough to tell how it leaves.
[[nodiscard]] bool leading_resolved(const Stability& stability);

// How the leading exponent leaves: multiplier +1, -1 (half the crank's speed), or a complex pair.
enum class BoundaryKind { plus_one, minus_one, complex };
[[nodiscard]] BoundaryKind boundary_kind(const Stability& stability, double speed);
[[nodiscard]] const char* to_string(BoundaryKind kind);  // "+1", "-1", "complex"

struct StabilityBoundary {
  double x = 0;
  double error = 0;  // half of the bracket that is left, and what the growth rate's error bound moves
  BoundaryKind kind = BoundaryKind::complex;
  bool unstable_above = false;
  bool converged = false;  // error within 1e-10 of x
};

struct SweepOptions {
  double tolerance = 1e-11;  // bracket of a boundary, relative to |x|
  double least_growth = 1e-9;  // a weaker instability, relative to the speed, is not looked for
  int max_order = 128;  // nor one of higher order k
  StabilityOptions stability;
};

// Samples inside (a.x, b.x) that show a change of verdict which a and b do not: one for each parametric resonance that
// crosses the interval and is strong enough. `modes_a`, `modes_b`: tracked states at both ends. Ascending in x.
[[nodiscard]] std::vector<StabilitySample> look_between(const SystemAt& at, const StabilitySample& a,
                                                        const StabilitySample& b, const std::vector<ModeState>& modes_a,
                                                        const std::vector<ModeState>& modes_b,
                                                        const SweepOptions& options = {});

// Where the verdict changes between a and b, one of which is unstable: ITP bracketing on the growth rate.
[[nodiscard]] StabilityBoundary locate_boundary(const SystemAt& at, const StabilitySample& a, const StabilitySample& b,
                                                const SweepOptions& options = {});

struct UnstableBand {
  double from = 0, to = 0;
  double error_from = 0, error_to = 0;
  bool open_from = false, open_to = false;  // the sweep ends inside the band, or has no answer beyond
  BoundaryKind kind_from = BoundaryKind::complex, kind_to = BoundaryKind::complex;
  double fastest = 0;  // largest growth rate sampled inside, 1/time
  double fastest_x = 0;
};

// From samples in ascending order (null: no system there) and the boundaries between them.
[[nodiscard]] std::vector<UnstableBand> unstable_bands(const std::vector<const StabilitySample*>& samples,
                                                       const std::vector<StabilityBoundary>& boundaries);

[[nodiscard]] inline bool is_unstable(const StabilitySample& sample) {
  return sample.stability.verdict == Verdict::unstable;
}

}  // namespace hb

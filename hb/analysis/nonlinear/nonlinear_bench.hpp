// Error against run time of the motion without linearisation: harmonic balance beside integration in time.
#pragma once

#include "hb/analysis/bench_rod.hpp"
#include "hb/analysis/nonlinear/nonlinear_steady.hpp"

namespace hb {

// All rods together, named "system". Every method starts from the first harmonics of the motion that nonlinear_steady
// finds; the reference is by shooting at the tightest tolerance. No marching: its transients take hundreds of turns.
[[nodiscard]] RodBench bench_motion(const SceneModel& model, double speed, const Settings& settings,
                                    const BenchOptions& options, const NonlinearOptions& motion = {});
// Cases, at most.
[[nodiscard]] std::size_t motion_bench_cases();

}  // namespace hb

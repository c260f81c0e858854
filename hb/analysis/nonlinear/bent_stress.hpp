// Stress of the bent rods of a motion: axial force along the bent rod (T4) and moment EJ kappa, hb/analysis/README.md.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "hb/analysis/rod_stress.hpp"
#include "hb/analysis/stress_cycle.hpp"
#include "lib/exact/rod_tension.hpp"

namespace hb {

// Samples of all rods' motion over its turns T.
class BentStresses {
 public:
  // q by rod; harmonic k is k Omega/T.
  BentStresses(const ExactModel& exact, double speed, int turns, std::vector<FourierSeries> q,
               Eigen::Index num_samples);

  // `bending_moment`: the largest EJ kappa over rod and motion, `moment_error` its error. `rod` counts as those of the
  // model; `coefficients` are over the T turns, with powers of Omega/T. The error of the axial force is twice what the
  // motions `better` change, infinite without any.
  [[nodiscard]] RodStress largest(std::size_t rod, const RodCoefficients& coefficients, double bending_moment,
                                  std::optional<double> moment_error, const std::vector<BentStresses>& better) const;
  // Crank angles of what is found in it are 1/T of those of the motion. `coefficients` outlives it. Needs
  // elastic.section_height.
  [[nodiscard]] StressField field(std::size_t rod, const RodCoefficients& coefficients) const;

 private:
  struct Samples {
    Linkage linkage;
    std::vector<int> links;
    double base = 0;  // Omega/T
    std::vector<FourierSeries> q;
    Eigen::Index N = 0;
    std::vector<RodTension> tension;
  };
  std::shared_ptr<const Samples> samples_;
};

// Samples enough for motions of these.
[[nodiscard]] Eigen::Index stress_samples(Eigen::Index num_harmonics, int turns);

// EJ kappa from EJ w'' at the place found, kappa = w''/cos psi, with the slope sin psi = w' of the modes kept.
void bend(RodPeak& moment, const FourierSeries& q, double length);

// The cycle of one rod, crank angles over the T turns; its error is twice what the motions `better` (more harmonics,
// more modes) change, infinite without any. Empty without a section.
[[nodiscard]] std::optional<StressCycle> bent_cycle(const Body& link, const BentStresses& stresses, std::size_t rod,
                                                    const RodCoefficients& coefficients, Eigen::Index num_modes,
                                                    int turns, const std::vector<BentStresses>& better);

}  // namespace hb

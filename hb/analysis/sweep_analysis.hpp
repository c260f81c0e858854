// A scene along one parameter: everything at the points asked for, and what lies between them: resonance peaks and
// unstable bands, both located.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "hb/analysis/sweep/sweep_point.hpp"
#include "hb/analysis/sweep/sweep_scene.hpp"
#include "hb/analysis/work.hpp"
#include "hb/engine/boundaries/interval_search.hpp"
#include "hb/engine/boundaries/mode_tracks.hpp"
#include "hb/engine/boundaries/sweep.hpp"
#include "hb/engine/steady/response_peak.hpp"

namespace hb {

// A local maximum of a rod's largest |q_i|.
struct CriticalPoint {
  std::size_t rod = 0;
  int component = 0;  // i - 1: the q_i that peaks
  int mode = -1;  // whose frequency is met; -1 if not known (stability not asked for)
  int order = 0;  // n = omega/Omega, rounded; 0 if not known
  double frequency = 0;  // of that mode there, rad per unit time
  double damping = 0;  // its decay rate, 1/time
  double speed = 0;
  double prominence = 0;  // height above the higher of the two valleys beside it, relative to the peak
  ResponsePeak peak;
};

struct SweepRod {
  std::string name;
  bool reported = true;  // false: solved only because joint forces need it
  int num_modes = 0;
  int num_unknowns = 0;  // of its system
  std::vector<StabilityBoundary> boundaries;
  std::vector<UnstableBand> bands;
  std::vector<std::array<double, 2>> not_excluded;  // where a band or a gap may have been missed, ascending
};

struct SweepResult {
  Only computed;
  std::vector<SweepRod> rods;
  std::vector<SweepPoint> points;  // as asked for
  std::vector<SweepPoint> refined;  // between them: at peaks with their flanks, and at boundaries; ascending
  std::vector<CriticalPoint> critical;  // by rod, then ascending x
  std::vector<std::string> joint_components;  // "AB.0 x"
  std::vector<std::string> shortfalls;  // tolerances asked for that were not reached
  std::vector<std::string> notes;  // what is known less well than usual, though no tolerance was asked for it
  std::vector<Stage> stages;
  bool searched_bands = true, searched_peaks = true;  // between the points
};

[[nodiscard]] SweepResult run_sweep(const SweepScene& scene, Work& work);

// Points and refined points together, ascending.
[[nodiscard]] std::vector<const SweepPoint*> all_points(const SweepResult& result);
// Tracked modes of one rod at these points.
[[nodiscard]] std::vector<std::vector<ModeState>> tracks(const SweepResult& result, std::size_t rod,
                                                         const std::vector<const SweepPoint*>& points);

}  // namespace hb

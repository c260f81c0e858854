// What is asked of a scene, and what is refused. No files, streams, flags or threads: those are the caller's.
#pragma once

#include <optional>
#include <stdexcept>
#include <string>
#include <variant>
#include <vector>

#include "hb/analysis/modes.hpp"
#include "hb/engine/exponents/stability.hpp"
#include "hb/engine/steady/steady_state.hpp"
#include "lib/scene/scene.hpp"

namespace hb {

// A request that cannot be met. what() is "field: found ..., allowed: ..."; `sentence` is what stands behind the field,
// where "@name" stands for another field of the request (what() leaves the mark out).
class RequestError : public std::runtime_error {
 public:
  RequestError(std::string field, std::string found, std::string allowed);
  // In other words than "found FOUND, allowed: ALLOWED".
  RequestError(std::string field, std::string found, std::string allowed, std::string sentence);

  std::string field, found, allowed, sentence;
};

// A speed of the crank as it was given: the other number is converted from it.
struct Speed {
  double omega = 0;  // rad per the scene's unit of time
  double rpm = 0;
  bool in_rpm = true;  // rpm is the one that was given

  [[nodiscard]] static Speed from_rpm(double rpm, const Units& units);
  [[nodiscard]] static Speed from_omega(double omega, const Units& units);
};

// What is wanted; only that is computed.
struct Only {
  bool steady = true;  // Fourier coefficients and peaks of q
  bool stability = true;  // exponents and verdict
  bool reactions = true;  // joint forces and driving torque
  bool shape = true;  // deflection and bending moment
  bool verdict = false;  // of stability the verdict alone, from bounds where they prove it
  bool growth = false;  // of stability the growth rate and the verdict: the leading exponents alone

  // The periodic motion, or what follows from it.
  [[nodiscard]] bool response() const { return steady || reactions || shape; }
  // Frequencies and modes are known.
  [[nodiscard]] bool all_exponents() const { return stability && !verdict && !growth; }
};

// Of "steady", "stability", "growth", "verdict", "reactions", "shape"; of growth, verdict and stability the one that
// contains the others counts. Throws RequestError, field "only".
[[nodiscard]] Only only_of(const std::vector<std::string>& names);

// What is left open is taken from the scene's [analysis].
struct Request {
  std::optional<double> rpm, omega;  // one of them; omega in rad per the scene's unit of time
  std::optional<Modes> modes;  // Ritz terms per elastic link
  std::optional<double> tolerance;  // relative error wanted
  std::vector<std::string> rods;  // names of elastic links; empty: all
  Only only;
  SteadyMethod steady_method = SteadyMethod::automatic;
  SteadyBound bound = SteadyBound::estimated;
  StabilityMethod stability_method = StabilityMethod::automatic;
  bool search = true;  // sweep: also what lies between the points (bands, resonance peaks)
  bool boundaries = true;  // map: the curves where the verdict changes, beside the grid
  std::optional<double> boundary_tolerance;  // map: of their points, relative; else from the tolerance
};

// A request with nothing left open but the speed.
struct Settings {
  Modes modes = 5;
  double tolerance = 1e-10;
  bool tolerance_asked = false;  // by the request, not the scene
  std::vector<std::string> rods;
  Only only;
  SteadyMethod steady_method = SteadyMethod::automatic;
  SteadyBound bound = SteadyBound::estimated;
  StabilityMethod stability_method = StabilityMethod::automatic;
  bool search = true, boundaries = true;
  double boundary_tolerance = 1e-11;
};

// Throw RequestError for what cannot be: modes beyond 1 to 60 (a [hill] scene has its own number), a tolerance beyond
// 1e-14 to 0.1, one of boundaries beyond 1e-14 to 0.01, no speed or two or one that is not positive.
[[nodiscard]] Settings settings_of(const Request& request, const Scene& scene);
[[nodiscard]] Speed speed_of(const Request& request, const Scene& scene);

}  // namespace hb

#include "hb/analysis/expected_memory.hpp"

#include <algorithm>
#include <complex>

#include "hb/analysis/modes.hpp"
#include "lib/linkage/balance.hpp"

namespace hb {
namespace {

double bytes_of(const HillSystem& system) {
  Eigen::Index numbers = 0;
  for (const FourierSeries& part : system.stiffness) numbers += part.c.size();
  for (const FourierSeries& part : system.load) numbers += part.c.size();
  return static_cast<double>(sizeof(std::complex<double>)) * static_cast<double>(numbers);
}

// One stiffness of n unknowns with as many harmonics as the system's.
double bytes_of_stiffness(const HillSystem& system, double n) {
  Eigen::Index columns = 0;
  for (const FourierSeries& part : system.stiffness) columns = std::max(columns, part.c.cols());
  return static_cast<double>(sizeof(std::complex<double>)) * static_cast<double>(columns) * n * n;
}

// The table of influence coefficients, and a coarser one while it grows, at as many crank angles as the geometry and
// the applied forces need: at most five joints a dyad and one of the crank, two components each, torque and three of
// the frame, for three powers of the speed, an applied force a dyad and three loads a rod.
double bytes_of_influence(const SceneModel& model) {
  const Linkage& linkage = *model.linkage();
  const auto dyads = static_cast<double>(linkage.dyads.size()), rods = static_cast<double>(model.rods.size());
  const double quantities = 2 * (5 * dyads + 1) + 4, loads = 3 + dyads + 3 * rods;
  const Eigen::Index angles = std::max(
      {Eigen::Index(64), Eigen::Index(model.coefficients.num_samples), 4 * slider_force_harmonics(linkage) + 4});
  return 1.5 * sizeof(double) * quantities * loads * static_cast<double>(angles);
}

}  // namespace

double bytes_of(const SceneModel& model) {
  double bytes = 0;
  for (const RodModel& rod : model.rods) bytes += bytes_of(rod.system) + bytes_of(rod.finer);
  return bytes;
}

// The stiffness of the finer system ten times over (scaled, weighted, at two numbers of nodes, with the directions of
// GMRES), that of the system fourteen times for the exponents (at the nodes, in cells), and 3500 bytes for every mode
// and crank angle of a shape, most of which its description takes. Rods follow each other. Peaks of `hb steady` with 3
// to 60 unknowns and 128 to 4096 crank angles were 0.6 to 1.4 of it with the model and 8 MB.
double expected_bytes(const SceneModel& model, const Settings& settings) {
  constexpr double for_response = 10, for_exponents = 14, for_shape = 3500;
  const Only only = available(model, settings.only);
  double most = 0;
  for (const RodModel& rod : model.rods) {
    const auto unknowns = static_cast<double>(rod.system.num_modes());
    const auto finer = static_cast<double>(comparison_modes(rod.num_modes));
    const double more = rod.link >= 0 ? finer / static_cast<double>(rod.num_modes) : 1;
    double bytes = 0;
    if (only.response()) bytes = for_response * bytes_of_stiffness(rod.system, unknowns * more);
    if (only.stability) bytes = std::max(bytes, for_exponents * bytes_of_stiffness(rod.system, unknowns));
    if (only.shape && rod.reported) bytes += for_shape * static_cast<double>(model.coefficients.num_samples) * finer;
    most = std::max(most, bytes);
  }
  if (only.reactions) most += bytes_of_influence(model);
  return most;
}

// Measured of sweeps over 1000 points of two rods with 2 to 20 modes each: 5 to 41 kB a point, 0.8 to 1.3 of it.
double expected_bytes_of_points(const SceneModel& model, const Settings& settings, std::size_t points, bool documents) {
  constexpr double of_a_point = 1000, of_forces_and_shapes = 5000, of_a_response = 100, of_exponents = 300;
  const Only only = available(model, settings.only);
  double bytes = of_a_point + (only.reactions || only.shape ? of_forces_and_shapes : 0);
  for (const RodModel& rod : model.rods)
    bytes += static_cast<double>(rod.num_modes) *
             ((only.response() ? of_a_response : 0) + (only.stability ? of_exponents : 0));
  return static_cast<double>(points) * bytes * (documents ? 2 : 1);
}

}  // namespace hb

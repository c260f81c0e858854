#include "tools/output/hill_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>
#include <vector>

#include "lib/dense.hpp"
#include "lib/scene/scene_keys.hpp"
#include "tools/output/json.hpp"

namespace hb::tools {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

constexpr Index most_shown = 6;  // rows of a matrix, frequencies

Index highest_harmonic(const std::array<FourierSeries, 3>& powers) {
  Index highest = 0;
  for (const FourierSeries& series : powers) highest = std::max(highest, series.num_harmonics());
  return highest;
}

// Mean over the period of one power of Omega; empty if the scene gives none.
MatrixXd mean_of(const HillSystem& system, std::size_t power) {
  const FourierSeries& series = system.stiffness[power];
  if (series.c.size() == 0) return {};
  const Eigen::VectorXd mean = series.c.col(0).real();
  return Eigen::Map<const MatrixXd>(mean.data(), system.num_modes(), system.num_modes());
}

// max |A - A^T| over max |A|, over the whole period for series.
double asymmetry(const MatrixXd& A) {
  const double largest = A.cwiseAbs().maxCoeff();
  return largest > 0 ? (A - A.transpose()).cwiseAbs().maxCoeff() / largest : 0;
}

double asymmetry(const std::array<FourierSeries, 3>& powers, Index n) {
  double largest = 0, difference = 0;
  for (const FourierSeries& series : powers) {
    for (Index k = 0; k < series.c.cols(); ++k) {
      const Eigen::VectorXcd column = series.c.col(k);
      const auto C = Eigen::Map<const Eigen::MatrixXcd>(column.data(), n, n);
      largest = std::max(largest, C.cwiseAbs().maxCoeff());
      difference = std::max(difference, (C - C.transpose()).cwiseAbs().maxCoeff());
    }
  }
  return largest > 0 ? difference / largest : 0;
}

std::string symmetry_text(double asymmetry) {
  return asymmetry <= 1e-14 ? "symmetric"
                            : fmt::format("NOT symmetric, by up to {:.2g} of its largest entry", asymmetry);
}

// The first speed that [analysis] gives; matters where the stiffness depends on it.
std::optional<double> scene_speed(const Scene& scene) {
  if (scene.analysis.omega) return scene.analysis.omega->from;
  if (scene.analysis.rpm) return speed_from_rpm(scene.analysis.rpm->from, scene.units);
  return std::nullopt;
}

bool depends_on_speed(const HillSystem& system) {
  return system.stiffness[1].c.size() > 0 || system.stiffness[2].c.size() > 0;
}

// det(C - omega^2 M) = 0 of the mean system: omega^2, ascending by real part.
struct MeanFrequencies {
  std::vector<std::complex<double>> squares;
  std::optional<double> speed;  // where the mean stiffness depends on it
};
MeanFrequencies mean_frequencies(const HillSystem& system, const Scene& scene) {
  MeanFrequencies result;
  const Index n = system.num_modes();
  MatrixXd C = MatrixXd::Zero(n, n);
  const std::optional<double> speed = scene_speed(scene);
  const bool at_speed = depends_on_speed(system) && speed;
  for (std::size_t p = 0; p < (at_speed ? 3u : 1u); ++p) {
    const MatrixXd mean = mean_of(system, p);
    if (mean.size() > 0) C += mean * std::pow(speed.value_or(1), static_cast<double>(p));
  }
  if (at_speed) result.speed = speed;
  const auto pairs = dense::eigenpairs(dense::Lu<double>(system.mass).solve(C));
  if (!pairs) return result;
  for (const std::complex<double>& square : pairs->values) result.squares.push_back(square);
  std::ranges::sort(result.squares, {}, [](std::complex<double> z) { return z.real(); });
  return result;
}

std::string frequency_text(std::complex<double> square) {
  if (std::abs(square.imag()) > 1e-12 * std::abs(square))
    return fmt::format("none (omega^2 = {:.6g}{:+.6g}i)", square.real(), square.imag());
  if (square.real() < 0) return fmt::format("none (omega^2 = {:.6g})", square.real());
  return fmt::format("{:.6g}", std::sqrt(square.real()));
}

}  // namespace

std::string hill_table(const HillSystem& system, const Scene& scene) {
  fmt::memory_buffer text;
  const auto out = std::back_inserter(text);
  const Index n = system.num_modes();
  fmt::format_to(out, "linear periodic system of {} {}: stiffness with {}, load with {}\n", n,
                 n == 1 ? "unknown" : "unknowns", counted(highest_harmonic(system.stiffness), "harmonic"),
                 counted(highest_harmonic(system.load), "harmonic"));
  constexpr const char* factors[] = {"", " (times Omega)", " (times Omega^2)"};
  for (std::size_t p = 0; p < 3; ++p) {
    const MatrixXd mean = mean_of(system, p);
    if (mean.size() == 0) continue;
    fmt::format_to(out, "mean stiffness{}{}:\n", factors[p],
                   n > most_shown ? fmt::format(", the first {} of {} rows and columns", most_shown, n) : "");
    for (Index i = 0; i < std::min(n, most_shown); ++i) {
      fmt::format_to(out, " ");
      for (Index k = 0; k < std::min(n, most_shown); ++k) fmt::format_to(out, " {:>13.6g}", mean(i, k));
      fmt::format_to(out, "\n");
    }
  }
  const MeanFrequencies frequencies = mean_frequencies(system, scene);
  fmt::format_to(out, "natural frequencies of the mean system{}, rad/{}:",
                 frequencies.speed ? fmt::format(" at omega = {:.6g}", *frequencies.speed) : "", scene.units.time);
  for (std::size_t i = 0; i < std::min<std::size_t>(frequencies.squares.size(), 2 * most_shown); ++i)
    fmt::format_to(out, "{} {}", i ? "," : "", frequency_text(frequencies.squares[i]));
  fmt::format_to(out, "{}\n", frequencies.squares.size() > 2 * most_shown ? ", ..." : "");
  fmt::format_to(out, "mass {}; damping {}; stiffness {}\n", symmetry_text(asymmetry(system.mass)),
                 system.damping.isZero(0) ? "zero" : symmetry_text(asymmetry(system.damping)),
                 symmetry_text(asymmetry(system.stiffness, n)));
  return fmt::to_string(text);
}

Json hill_json(const HillSystem& system, const Scene& scene) {
  Json json = {{"unknowns", system.num_modes()},
               {"stiffness_harmonics", highest_harmonic(system.stiffness)},
               {"load_harmonics", highest_harmonic(system.load)}};
  Json& means = json["mean_stiffness"] = Json::array();  // by power of Omega
  for (std::size_t p = 0; p < 3; ++p) {
    const MatrixXd mean = mean_of(system, p);
    Json rows = mean.size() == 0 ? Json(nullptr) : Json::array();
    for (Index i = 0; i < mean.rows(); ++i) {
      Json row = Json::array();
      for (Index k = 0; k < mean.cols(); ++k) row.push_back(mean(i, k));
      rows.push_back(std::move(row));
    }
    means.push_back(std::move(rows));
  }
  const MeanFrequencies frequencies = mean_frequencies(system, scene);
  if (frequencies.speed) json["natural_frequencies_at_omega"] = *frequencies.speed;
  Json& squares = json["natural_frequencies"] = Json::array();  // null: none, the square is negative or complex
  for (const std::complex<double>& square : frequencies.squares) {
    const bool real = std::abs(square.imag()) <= 1e-12 * std::abs(square) && square.real() >= 0;
    squares.push_back(real ? Json(std::sqrt(square.real())) : Json(nullptr));
  }
  json["asymmetry"] = {{"mass", asymmetry(system.mass)},
                       {"damping", asymmetry(system.damping)},
                       {"stiffness", asymmetry(system.stiffness, system.num_modes())}};
  return json;
}

}  // namespace hb::tools

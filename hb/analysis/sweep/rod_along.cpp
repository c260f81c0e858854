#include "hb/analysis/sweep/rod_along.hpp"

#include <utility>

#include "hb/analysis/accuracy.hpp"
#include "hb/analysis/rod_steady.hpp"

namespace hb {

std::optional<ScaledSystem> RodAlong::system(double x) const {
  ++evaluations_;
  const ScenePlace place = scene_.at(x);
  if (!place.model) return std::nullopt;
  return scale_system(place.model->rods[rod_].system, place.speed);
}

Eigen::VectorXd RodAlong::mean_frequencies(double x) const {
  ++evaluations_;
  const ScenePlace place = scene_.at(x);
  if (!place.model) return {};
  return squared_frequencies(place.model->rods[rod_].system, place.speed).cwiseSqrt();
}

std::optional<SteadyState> RodAlong::solved(double x, const SteadyOptions& options) const {
  ++evaluations_;
  const ScenePlace place = scene_.at(x);
  if (!place.model) return std::nullopt;
  const RodModel& rod = place.model->rods[rod_];
  SteadyState state = solve_rod(rod.system, rod.num_modes, place.speed, options);
  if (state.status == SteadyStatus::singular || !state.q.c.allFinite()) return std::nullopt;
  return state;
}

std::optional<FourierSeries> RodAlong::rough_response(double x) const {
  const double accuracy = peak_accuracy(settings()).rough;
  const ScenePlace place = scene_.at(x);
  if (!place.model) return std::nullopt;
  const RodModel& rod = place.model->rods[rod_];
  if (std::optional<FourierSeries> q = rough_rod(rod.system, rod.num_modes, place.speed, accuracy)) {
    ++evaluations_;
    return q;
  }
  std::optional<SteadyState> state = solved(x, {.tolerance = accuracy, .method = settings().steady_method});
  if (!state) return std::nullopt;
  return std::move(state->q);
}

std::optional<PeakResponses> RodAlong::responses(int component, double about) const {
  constexpr double more_harmonics = 1.25, part_of_residual = 0.01;  // which a response may amplify
  const auto alone = [this, component](const SteadyOptions& options) -> ResponseAt {
    return [this, component, options](double x) -> std::optional<FourierSeries> {
      const std::optional<SteadyState> state = solved(x, options);
      if (!state) return std::nullopt;
      return FourierSeries(Eigen::MatrixXcd(state->q.c.row(component)));
    };
  };
  const PeakAccuracy accuracy = peak_accuracy(settings());
  const SteadyOptions sure{.tolerance = accuracy.fine, .method = settings().steady_method};
  SteadyOptions rough = sure, fine = sure;
  rough.tolerance = part_of_residual * accuracy.rough;
  fine.tolerance = part_of_residual * accuracy.fine;
  rough.without_bound = fine.without_bound = true;
  // What is interpolated has one number of harmonics, those needed here and some more.
  const std::optional<SteadyState> state = solved(about, fine);
  if (!state) return std::nullopt;
  fine.num_harmonics = static_cast<int>(more_harmonics * state->num_harmonics);
  return PeakResponses{alone(rough), alone(fine), alone(sure), accuracy.rough, accuracy.fine};
}

}  // namespace hb

// The search for a design: designs tried, the best one confirmed on more speeds, with more modes and with room for the
// errors of its values.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "hb/analysis/tune/tune_problem.hpp"

namespace hb {

class TuneSearch {
 public:
  static constexpr int verification = 4;  // times the speeds of the search
  static constexpr double verification_tolerance = 1e-6;  // of goal and conditions, relative

  // Keeps references to both. Throws RequestError and SceneError for what cannot be at the start.
  TuneSearch(const TuneTask& task, const Work& work);
  TuneSearch(const TuneSearch&) = delete;
  TuneSearch& operator=(const TuneSearch&) = delete;

  // The best design found and what confirms it.
  void run(TuneResult& result);

  // Designs by any numbers, with the same aims and settings.
  [[nodiscard]] DesignSpace space_of(DesignSpace::At numbers, DesignSpace::SpanAt span);
  [[nodiscard]] DesignProblem problem_over(DesignSpace& space, const std::vector<double>& start,
                                           const std::vector<double>& lower, const std::vector<double>& upper,
                                           bool with_gradient);

  const TuneTask& task() const { return task_; }
  const DesignAims& aims() const { return *aims_; }
  DesignSpace& space() { return *space_; }
  const DesignProblem& problem() const { return problem_; }
  [[nodiscard]] Scene scene_at(const std::vector<double>& x) const;
  int num_modes() const;
  const TuneCounts& counts() const { return counts_; }
  const TuneCounts& searched() const { return searched_; }  // until the search had ended
  const std::vector<MetricValue>& confirmed() const { return confirmed_; }  // of the best design, by metric
  // What each condition could have alone, of all designs tried (those for slopes are not); empty: none had a response.
  const std::vector<double>& best() const { return best_; }
  int without_response() const { return without_response_; }  // designs tried
  double confirmation_seconds() const { return confirmation_seconds_; }

 private:
  bool auto_modes() const;
  int modes_needed(const std::vector<double>& x, std::vector<double> speeds) const;
  DesignResult first_search();
  void confirm(TuneResult& result);
  bool go_on(const std::vector<MetricValue>& values, int modes, TuneResult& result);
  void note_trials(const DesignResult& found);
  void note_best(const std::vector<double>& numbers);

  const TuneTask& task_;
  const Work& work_;
  Settings settings_;
  std::vector<double> start_;
  std::unique_ptr<DesignAims> aims_;
  TuneCounts counts_, searched_;
  std::optional<DesignSpace> space_;
  DesignProblem problem_;
  std::vector<MetricValue> confirmed_;
  std::vector<double> best_;
  int without_response_ = 0;
  double confirmation_seconds_ = 0;
};

}  // namespace hb

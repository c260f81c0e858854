// A scene at one speed with everything that the answer was computed from, as Python holds it.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "hb/analysis/nonlinear/nonlinear_analyses.hpp"
#include "hb/analysis/sensitivity_band.hpp"
#include "hb/analysis/steady.hpp"
#include "tools/python/bindings.hpp"

namespace hb::python {

struct Answer {
  std::shared_ptr<const SceneModel> model;
  Settings settings;
  SpeedResult result;  // of a motion without linearisation in the form of a linear answer
  std::optional<NonlinearResult> nonlinear;
  std::vector<SensitivityBand> bands;
  std::vector<NonlinearBand> nonlinear_bands;  // instead

  int turns() const { return nonlinear ? nonlinear->turns : 1; }
  std::string json() const;  // as the command prints it
};

// One elastic link of an answer, which the Python object keeps alive.
struct RodView {
  py::object owner;
  const Answer* answer;
  std::size_t rod;

  const RodResult& result() const { return answer->result.rods[rod]; }
};

// By the linear theory; `arguments`: time_limit.
[[nodiscard]] std::shared_ptr<Answer> linear_answer(const Scene& scene, const Request& request,
                                                    const py::dict& arguments);
[[nodiscard]] RodView rod_of(const py::object& answer, std::size_t rod);

}  // namespace hb::python

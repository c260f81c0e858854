// What exponents and verdicts mean, in words and in rows of tables.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "hb/analysis/disturbance.hpp"
#include "hb/analysis/linkage_analysis.hpp"
#include "lib/scene/scene.hpp"

namespace hb::tools {

// Frequencies of disturbances as shown: in Hz, of a [hill] scene as angular frequency in its own unit.
struct FrequencyUnit {
  double factor = 1;  // on rad per unit time
  std::string name;  // "Hz", "rad/s"
};
[[nodiscard]] FrequencyUnit frequency_unit(const Scene& scene);

// What the verdict means for a disturbance, with the time to halve or to grow tenfold; `lines`: of the leading one,
// where they are known.
[[nodiscard]] std::string verdict_sentence(const Stability& stability, double speed, const Scene& scene,
                                           const std::vector<DisturbanceLine>& lines = {});

// The verdict of each elastic link; empty: not looked at.
using NamedVerdicts = std::vector<std::pair<std::string, std::optional<Verdict>>>;
[[nodiscard]] NamedVerdicts named_verdicts(const std::vector<RodResult>& rods);
// Of all together: "UNSTABLE because of AB", "stable (AB, CD)", and which were not looked at; empty where none was.
[[nodiscard]] std::string mechanism_verdict(const NamedVerdicts& verdicts);
// The worst of them; empty where none was looked at.
[[nodiscard]] std::optional<Verdict> worst_of(const NamedVerdicts& verdicts);
// Of each link the worst over several points, of which some may lack links; where some were looked at, those count.
[[nodiscard]] NamedVerdicts worst_of_each(const std::vector<NamedVerdicts>& points);
// Of several points: "UNSTABLE because of AB at 2 of 5 speeds"; `points` is what they are called.
[[nodiscard]] std::string verdict_at_points(const std::vector<NamedVerdicts>& points, const std::string& what);
// The same, short, for titles of pictures: "stable", "UNSTABLE because of AB", "stability undecided (AB)".
[[nodiscard]] std::string title_verdict(const NamedVerdicts& verdicts);

// Rows of growth rate, frequency (Exponent::frequency), damping ratio and error; of a conjugate pair one. Those not
// resolved to a part in 10^6 are marked with ?.
[[nodiscard]] std::string exponents_rows(const Stability& stability, Eigen::Index unresolved, double speed,
                                         const Scene& scene);
// Rows of e^(lambda 2 pi/Omega): all of them.
[[nodiscard]] std::string multipliers_rows(const Stability& stability, double speed, const Scene& scene);

}  // namespace hb::tools

#include "hb/analysis/tune/tune_metric.hpp"

#include <fmt/core.h>

#include <charconv>
#include <cmath>

#include "hb/analysis/request.hpp"
#include "lib/scene/scene_keys.hpp"

namespace hb {
namespace {

constexpr const char* metric_words =
    "deflection[:ROD], stress[:ROD], total-stress[:ROD], safety[:ROD], force[:JOINT], torque-ripple, mass[:ROD], "
    "theory[:ROD], frequency[:ROD], stable, clearance[:N], speed-range";

const std::vector<std::string> metric_names = {"deflection", "stress",        "total-stress", "safety",
                                               "force",      "torque-ripple", "mass",         "theory",
                                               "frequency",  "stable",        "clearance",    "speed-range"};

constexpr const char* small_words =
    "deflection[:ROD], stress[:ROD], total-stress[:ROD], force[:JOINT], torque-ripple, mass[:ROD], theory[:ROD]";
constexpr const char* large_words = "stable (the margin), safety[:ROD], frequency[:ROD], clearance[:N], speed-range";

// What may stand in a field of the request.
const char* words_of(const std::string& field) {
  return field == "minimise" ? small_words : field == "maximise" ? large_words : metric_words;
}

constexpr double largest_weight = 1e100;  // so that no sum overflows

[[noreturn]] void refuse(const char* field, const std::string& text, const std::string& why,
                         const std::string& allowed) {
  throw RequestError(field, fmt::format("\"{}\"", text), allowed,
                     fmt::format("found \"{}\", {}; allowed: {}", text, why, allowed));
}

std::optional<double> number(const std::string& text) {
  double value = 0;
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || stop != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

std::string without_blanks(const std::string& text) {
  std::string result;
  for (const char c : text)
    if (c != ' ' && c != '\t') result += c;
  return result;
}

Metric parse_metric(const char* field, const std::string& whole, const std::string& text) {
  const std::size_t colon = text.find(':');
  const std::string word = text.substr(0, colon);
  Metric metric;
  metric.text = text;
  if (colon != std::string::npos) {
    metric.name = text.substr(colon + 1);
    if (metric.name.empty()) refuse(field, whole, "with nothing behind the colon", words_of(field));
  }
  bool named = true;
  if (word == "deflection") {
    metric.kind = MetricKind::deflection;
  } else if (word == "stress") {
    metric.kind = MetricKind::stress;
  } else if (word == "total-stress") {
    metric.kind = MetricKind::total_stress;
  } else if (word == "safety") {
    metric.kind = MetricKind::safety;
  } else if (word == "force") {
    metric.kind = MetricKind::force;
  } else if (word == "mass") {
    metric.kind = MetricKind::mass;
  } else if (word == "theory") {
    metric.kind = MetricKind::theory;
  } else if (word == "frequency") {
    metric.kind = MetricKind::frequency;
  } else if (word == "torque-ripple") {
    metric.kind = MetricKind::torque_ripple;
    named = false;
  } else if (word == "stable") {
    metric.kind = MetricKind::margin;
    named = false;
  } else if (word == "speed-range") {
    metric.kind = MetricKind::speed_range;
    named = false;
  } else if (word == "clearance") {
    metric.kind = MetricKind::clearance;
    if (!metric.name.empty()) {
      const std::optional<double> orders = number(metric.name);
      if (!orders || *orders != std::floor(*orders) || !(*orders >= 1 && *orders <= 100))
        refuse(field, whole, "whose orders are no integer from 1 to 100", "clearance:N");
      metric.orders = static_cast<int>(*orders);
      metric.name.clear();
    }
  } else {
    {
      const std::string near = nearest_name(word, metric_names);
      refuse(field, whole, fmt::format("where \"{}\" is unknown{}", word, near.empty() ? "" : " (" + near + " meant?)"),
             words_of(field));
    }
  }
  if (!named && !metric.name.empty())
    refuse(field, whole, fmt::format("where \"{}\" stands behind {}", metric.name, word), words_of(field));
  return metric;
}

}  // namespace

Goal parse_goal(const std::string& text) {
  Goal goal;
  goal.text = text;
  const std::string dense = without_blanks(text);
  std::size_t begin = 0;
  while (begin <= dense.size()) {
    // A '+' that belongs to an exponent (1e+3*mass) does not part terms.
    std::size_t end = dense.find('+', begin);
    while (end != std::string::npos && end >= 2 && (dense[end - 1] == 'e' || dense[end - 1] == 'E') &&
           std::string_view("0123456789.").find(dense[end - 2]) != std::string_view::npos) {
      end = dense.find('+', end + 1);
    }
    const std::string part = dense.substr(begin, end == std::string::npos ? end : end - begin);
    GoalTerm term;
    const std::size_t star = part.find('*');
    if (star != std::string::npos) {
      const std::optional<double> weight = number(part.substr(0, star));
      if (!weight || !(*weight >= 1 / largest_weight && *weight <= largest_weight))
        refuse("minimise", text, "with a weight that is no number from 1e-100 to 1e100", "0.7*deflection+0.3*mass");
      term.weight = *weight;
      goal.weighted = true;
    }
    if (part.empty()) refuse("minimise", text, "with an empty term", small_words);
    term.metric = parse_metric("minimise", text, part.substr(star == std::string::npos ? 0 : star + 1));
    if (better_large(term.metric.kind))
      refuse(
          "minimise", text, fmt::format("where {} is better large", term.metric.text),
          "deflection, stress, total-stress, force, torque-ripple, mass, theory; the others behind @maximise or @keep");
    goal.terms.push_back(std::move(term));
    if (end == std::string::npos) break;
    begin = end + 1;
  }
  if (goal.terms.size() > 1) goal.weighted = true;
  return goal;
}

Goal parse_largest_goal(const std::string& text) {
  Goal goal;
  goal.text = text;
  goal.maximise = true;
  goal.terms.push_back({1, parse_metric("maximise", text, without_blanks(text))});
  if (!better_large(goal.terms[0].metric.kind))
    refuse("maximise", text, "which is better small",
           "stable (the margin), safety, frequency, clearance, speed-range; the others behind @minimise");
  return goal;
}

Keep parse_keep(const std::string& text) {
  Keep keep;
  keep.text = text;
  const std::string dense = without_blanks(text);
  const std::size_t less = dense.find("<="), more = dense.find(">=");
  const std::size_t sign = std::min(less, more);
  if (const std::size_t strict = dense.find_first_of("<>="); sign == std::string::npos && strict != sign) {
    const std::string name = dense.substr(0, strict);
    const bool least =
        dense[strict] == '>' || (dense[strict] == '=' && better_large(parse_metric("keep", text, name).kind));
    refuse("keep", text, "with a sign that is not <= or >=",
           fmt::format("{}{}{}", name, least ? ">=" : "<=", dense.substr(dense.find_first_not_of("<>=", strict))));
  }
  keep.metric = parse_metric("keep", text, dense.substr(0, sign));
  keep.at_least = more < less;
  if (sign == std::string::npos) {
    if (keep.metric.kind != MetricKind::margin)
      refuse("keep", text, "without a bound", "stable, or QUANTITY<=NUMBER, QUANTITY>=NUMBER");
    keep.at_least = true;
    return keep;
  }
  std::string bound = dense.substr(sign + 2);
  if (keep.metric.kind == MetricKind::margin && bound.ends_with("/turn")) {
    keep.metric.kind = MetricKind::margin_per_turn;
    keep.metric.text = "stable/turn";
    bound.resize(bound.size() - 5);
  }
  const std::optional<double> value = number(bound);
  const bool may_be_zero = is_margin(keep.metric) || keep.metric.kind == MetricKind::clearance;
  if (!value || !(may_be_zero ? *value >= 0 : *value > 0))
    refuse("keep", text, fmt::format("with \"{}\"", bound), may_be_zero ? "a number >= 0" : "a number > 0");
  if (better_large(keep.metric.kind) != keep.at_least) {
    const std::string quantity = dense.substr(0, sign);
    const bool large = better_large(keep.metric.kind);
    refuse("keep", text, fmt::format("but {} is better {}", quantity, large ? "large" : "small"),
           fmt::format("{}{}{}", quantity, large ? ">=" : "<=", dense.substr(sign + 2)));
  }
  keep.bound = *value;
  return keep;
}

bool better_large(MetricKind kind) {
  return kind == MetricKind::frequency || kind == MetricKind::margin || kind == MetricKind::margin_per_turn ||
         kind == MetricKind::clearance || kind == MetricKind::speed_range || kind == MetricKind::safety;
}

bool needs_forces(const Metric& metric) {
  return metric.kind == MetricKind::force || metric.kind == MetricKind::torque_ripple;
}

bool is_whole_stress(const Metric& metric) {
  return metric.kind == MetricKind::total_stress || metric.kind == MetricKind::safety;
}

bool is_margin(const Metric& metric) {
  return metric.kind == MetricKind::margin || metric.kind == MetricKind::margin_per_turn;
}

bool depends_on_speed(MetricKind kind) { return kind != MetricKind::mass && kind != MetricKind::frequency; }

std::string unit_of(MetricKind kind, const Scene& scene) {
  const Units& units = scene.units;
  switch (kind) {
    case MetricKind::deflection:
      return std::holds_alternative<Linkage>(scene.model) ? units.length : "";
    case MetricKind::stress:
    case MetricKind::total_stress:
      return "MPa";
    case MetricKind::force:
      return "N";
    case MetricKind::torque_ripple:
      return "N m";
    case MetricKind::mass:
      return units.mass;
    case MetricKind::frequency:
      return "Hz";
    case MetricKind::margin:
      return "1/" + units.time;
    case MetricKind::margin_per_turn:
      return "per turn";
    case MetricKind::theory:
    case MetricKind::clearance:
    case MetricKind::safety:
      return "";
    case MetricKind::speed_range:
      return "rpm";
  }
  return "";
}

}  // namespace hb

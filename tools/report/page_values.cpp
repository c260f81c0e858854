#include "tools/report/page_values.hpp"

#include <limits>
#include <nlohmann/json.hpp>

#include "tools/output/json.hpp"
#include "tools/output/path_unit.hpp"

namespace hb::tools {

char letter(const Json& verdict) {
  if (!verdict.is_string()) return '-';
  const std::string name = verdict.get<std::string>();
  return name == "undecided" || name.empty() ? '?' : name.front();
}

std::string letters(const Json& verdicts) {
  std::string text;
  for (const Json& verdict : verdicts) text += letter(verdict);
  return text;
}

std::vector<double> numbers(const Json& array) {
  std::vector<double> values;
  values.reserve(array.size());
  for (const Json& value : array)
    values.push_back(value.is_number() ? value.get<double>() : std::numeric_limits<double>::quiet_NaN());
  return values;
}

Json axis_json(const std::string& path, const Units& units) {
  if (path == "rpm")
    return {{"kind", "rpm"}, {"path", path}, {"label", "crank speed"}, {"unit", "rpm"}, {"symbol", "rpm"}};
  if (path == "omega")
    return {{"kind", "omega"}, {"path", path}, {"label", "Ω"}, {"unit", "rad/" + units.time}, {"symbol", "Ω"}};
  return {{"kind", "parameter"}, {"path", path}, {"label", path}, {"unit", path_unit(path, units)}, {"symbol", path}};
}

}  // namespace hb::tools

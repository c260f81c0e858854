#include "lib/scene/path_quantity.hpp"

#include <optional>

#include "lib/scene/scene_parts.hpp"
#include "lib/scene/scene_paths.hpp"

namespace hb {

namespace {

Quantity measured(std::string_view text, const std::optional<Measure>& measure, const Units& units) {
  if (!measure) return {std::nullopt, "a number with a unit; allowed: plain numbers, this one has no unit"};
  Quantity quantity = parse_quantity(text, *measure, units);
  const std::string example = example_of(measure->dimension);
  if (!quantity.value) quantity.problem += "; allowed: plain numbers" + (example.empty() ? "" : " or " + example);
  return quantity;
}

}  // namespace

Quantity length_quantity(std::string_view text, const Units& units) {
  return measured(text, Measure{dimension::length}, units);
}

Quantity speed_quantity(std::string_view text, bool in_rpm, const Units& units) {
  return measured(text, Measure{dimension::speed, in_rpm ? Measure::Base::rpm : Measure::Base::radian}, units);
}

Quantity quantity_at(const SceneSource& source, const std::string& path, std::string_view text) {
  toml::table tree = parse_toml(source.text_with({}), "");
  Problems problems("");
  const Units units = read_units(TableView(tree, "", problems));
  if (path == "rpm" || path == "omega") return speed_quantity(text, path == "rpm", units);
  const std::vector<Slot> slots = resolve(tree, path);
  if (slots.empty()) (void)source.value(path);  // throws, with the nearest name
  return measured(text, slots.at(0).measure, units);
}

}  // namespace hb

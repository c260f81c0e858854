#include "tools/report/packed_numbers.hpp"

#include <limits>

#include "tools/output/json.hpp"

namespace hb::tools {
namespace {

enum Leaf { number_mark = 0, word = 1, truth = 2 };

std::string dumped(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }

}  // namespace

Json PackedNumbers::shape_of(const Json& part) {
  if (part.is_object() || part.is_array()) {
    Json whole = part.is_object() ? Json::object() : Json::array();
    for (auto item = part.begin(); item != part.end(); ++item) {
      if (part.is_object()) {
        whole[item.key()] = shape_of(*item);
      } else {
        whole.push_back(shape_of(*item));
      }
    }
    return whole;
  }
  if (part.is_string()) {
    const auto [known, fresh] = known_words_.emplace(part.get<std::string>(), words_.size());
    if (fresh) words_.push_back(known->first);
    numbers_.push_back(static_cast<double>(known->second));
    return word;
  }
  if (part.is_boolean()) {
    numbers_.push_back(part.get<bool>() ? 1 : 0);
    return truth;
  }
  numbers_.push_back(part.is_number() ? part.get<double>() : std::numeric_limits<double>::quiet_NaN());
  return number_mark;
}

PackedNumbers::Place PackedNumbers::add(const Json& document) {
  Place place;
  place.first = numbers_.size();
  Json shape = shape_of(document);
  const auto [known, fresh] = known_shapes_.emplace(dumped(shape), shapes_.size());
  if (fresh) shapes_.push_back(std::move(shape));
  place.shape = known->second;
  return place;
}

}  // namespace hb::tools

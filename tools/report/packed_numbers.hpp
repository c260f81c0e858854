// JSON documents of one kind, packed: each becomes a list of doubles, and the shape that they share is kept once. In a
// shape 0 stands for a number (NaN: null), 1 for the index of a text, 2 for a truth value; keys and lengths stand as
// they are.
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace hb::tools {

class PackedNumbers {
 public:
  struct Place {
    std::size_t shape = 0;  // index in shapes()
    std::size_t first = 0;  // of its numbers in numbers()
  };
  Place add(const nlohmann::ordered_json& document);

  [[nodiscard]] const std::vector<nlohmann::ordered_json>& shapes() const { return shapes_; }
  [[nodiscard]] const std::vector<std::string>& words() const { return words_; }
  [[nodiscard]] const std::vector<double>& numbers() const { return numbers_; }

 private:
  nlohmann::ordered_json shape_of(const nlohmann::ordered_json& part);

  std::vector<nlohmann::ordered_json> shapes_;
  std::vector<std::string> words_;
  std::vector<double> numbers_;
  std::map<std::string, std::size_t> known_shapes_, known_words_;
};

}  // namespace hb::tools

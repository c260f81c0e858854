// Members of a map's JSON document: grids go into the text number by number.
#pragma once

#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "hb/engine/boundaries/stability_map.hpp"
#include "tools/output/json.hpp"
#include "tools/output/json_digits.hpp"
#include "tools/output/printable.hpp"

namespace hb::tools {

inline bool missing(const MapPoint& point) { return point.source == MapSource::missing; }

// Rows along x, one per y.
template <class Value>
void write_grid(const std::vector<MapPoint>& points, std::size_t nx, const Value& value, TextPieces& pieces) {
  const ValueText none(std::nan(""));
  pieces.add("[");
  pieces.add_rows(points.size() / nx, nx * (1 + ValueText::longest) + 2,
                  [&](std::size_t first, std::size_t last, char* at) {
                    RepeatedText<decltype(value(points[0]))> texts;
                    for (std::size_t row = first; row < last; ++row) {
                      if (row > 0) *at++ = ',';
                      for (std::size_t p = row * nx; p < (row + 1) * nx; ++p) {
                        *at++ = p > row * nx ? ',' : '[';
                        at = (missing(points[p]) ? none : texts.of(value(points[p]))).copy(at);
                      }
                      *at++ = ']';
                    }
                    return at;
                  });
  pieces.add("]");
}

// The members of an object in their order. Grids, which have millions of values, go into the text without becoming
// values of a document before.
class Members {
 public:
  void add(const std::string& key, Json value) { members_.push_back({key, std::move(value), {}}); }
  void add(const std::string& key, const Members& object) {
    members_.push_back({key, {}, [object](TextPieces& pieces) { object.write(pieces); }});
  }
  // `map` and `points` outlive the object.
  template <class Value>
  void add_grid(const std::string& key, const StabilityMap& map, const std::vector<MapPoint>& points, Value value) {
    members_.push_back(
        {key, {}, [nx = map.x.size(), &points, value](TextPieces& pieces) { write_grid(points, nx, value, pieces); }});
  }
  // One that is said again: `kept` has the pieces of its text from the first time on.
  template <class Value>
  void add_grid(const std::string& key, const StabilityMap& map, const std::vector<MapPoint>& points, Value value,
                std::vector<std::string>& kept) {
    members_.push_back({key, {}, [nx = map.x.size(), &points, value, &kept](TextPieces& pieces) {
                          if (kept.empty()) {
                            const TextSink keep = [&](std::string_view piece) { kept.emplace_back(piece); };
                            TextPieces own(keep, pieces.num_threads());
                            write_grid(points, nx, value, own);
                            own.hand_on();
                          }
                          for (const std::string& piece : kept) pieces.add(piece);
                        }});
  }
  void write(TextPieces& pieces) const {
    const char* before = "{";
    for (const Member& member : members_) {
      pieces.add(before);
      before = ",";
      pieces.add(printable(Json(member.key).dump()) + ":");
      if (member.write)
        member.write(pieces);
      else
        pieces.add(printable(member.value.dump(-1, ' ', false, Json::error_handler_t::replace)));
    }
    pieces.add("}");
  }

 private:
  struct Member {
    std::string key;
    Json value;
    std::function<void(TextPieces&)> write;  // instead of the value
  };
  std::vector<Member> members_;
};

}  // namespace hb::tools

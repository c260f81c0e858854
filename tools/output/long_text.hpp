// Texts too long to be held in memory: handed on in pieces.
#pragma once

#include <functional>
#include <string>
#include <string_view>

namespace hb::tools {

using TextSink = std::function<void(std::string_view)>;

// Says the whole text to a sink, the same each time.
using LongText = std::function<void(const TextSink&)>;

// Gathers small pieces to large ones.
class TextPieces {
 public:
  explicit TextPieces(const TextSink& sink) : sink_(sink) { text_.reserve(2 * piece); }
  TextPieces(const TextPieces&) = delete;
  TextPieces& operator=(const TextPieces&) = delete;

  // To be appended to; `end_row` now and then, `hand_on` at the end.
  std::string& text() { return text_; }
  void end_row() {
    if (text_.size() >= piece) hand_on();
  }
  void hand_on() {
    if (!text_.empty()) sink_(text_);
    text_.clear();
  }

 private:
  static constexpr std::size_t piece = std::size_t{1} << 20;
  const TextSink& sink_;
  std::string text_;
};

}  // namespace hb::tools

// Texts too long to be held in memory: handed on in pieces.
#pragma once

#include <algorithm>
#include <functional>
#include <memory>
#include <string_view>

namespace hb::tools {

using TextSink = std::function<void(std::string_view)>;

// Says the whole text to a sink, the same each time.
using LongText = std::function<void(const TextSink&)>;

// Gathers small pieces to large ones.
class TextPieces {
 public:
  explicit TextPieces(const TextSink& sink) : sink_(sink) {}
  TextPieces(const TextPieces&) = delete;
  TextPieces& operator=(const TextPieces&) = delete;

  void add(std::string_view text) {
    if (text.size() > room_) {
      hand_on();
      return sink_(text);
    }
    add(text.size(), [&](char* at) { return std::ranges::copy(text, at).out; });
  }
  // What `write` puts at the place it is given, at most so many characters; it returns their end.
  template <class Write>
  void add(std::size_t most, const Write& write) {
    if (size_ + most > room_) hand_on();
    if (most > room_) {
      room_ = most;
      text_ = std::make_unique_for_overwrite<char[]>(room_);
    }
    size_ = static_cast<std::size_t>(write(text_.get() + size_) - text_.get());
  }
  // At the end.
  void hand_on() {
    if (size_ > 0) sink_({text_.get(), size_});
    size_ = 0;
  }

 private:
  const TextSink& sink_;
  std::size_t size_ = 0, room_ = std::size_t{1} << 20;
  std::unique_ptr<char[]> text_ = std::make_unique_for_overwrite<char[]>(room_);
};

}  // namespace hb::tools

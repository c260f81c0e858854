// Texts too long to be held in memory: handed on in pieces.
#pragma once

#include <algorithm>
#include <functional>
#include <memory>
#include <string_view>
#include <vector>

#include "tools/work/parallel_for.hpp"

namespace hb::tools {

using TextSink = std::function<void(std::string_view)>;

// Says the whole text to a sink, the same each time.
using LongText = std::function<void(const TextSink&)>;

// Gathers small pieces to large ones.
class TextPieces {
 public:
  explicit TextPieces(const TextSink& sink, int num_threads = 1) : sink_(sink), num_threads_(num_threads) {}
  TextPieces(const TextPieces&) = delete;
  TextPieces& operator=(const TextPieces&) = delete;

  void add(std::string_view text) {
    constexpr std::size_t large = std::size_t{1} << 16;
    if (text.size() >= large) {
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
  // `count` rows of at most `most` characters each: write(first, last, at) puts those from first to before last at the
  // place it is given and returns their end. All threads write, some rows each.
  template <class Write>
  void add_rows(std::size_t count, std::size_t most, const Write& write) {
    constexpr std::size_t characters = std::size_t{1} << 20, most_blocks = 8;  // of each thread
    const std::size_t rows = std::max<std::size_t>(1, characters / most);
    if (num_threads_ <= 1 || count <= rows) {
      for (std::size_t first = 0; first < count; first += rows) {
        const std::size_t last = std::min(first + rows, count);
        add((last - first) * most, [&](char* at) { return write(first, last, at); });
      }
      return;
    }
    struct Block {
      std::unique_ptr<char[]> text;
      std::size_t size = 0;
    };
    const std::size_t per_thread = std::clamp<std::size_t>(most_blocks * characters / (rows * most), 1, most_blocks);
    std::vector<Block> blocks(per_thread * static_cast<std::size_t>(num_threads_));
    for (std::size_t done = 0; done < count; done += rows * blocks.size()) {
      const std::size_t ready = std::min(blocks.size(), (count - done + rows - 1) / rows);
      parallel_for(ready, num_threads_, [&](std::size_t k) {
        Block& block = blocks[k];
        const std::size_t first = done + k * rows, last = std::min(first + rows, count);
        if (!block.text) block.text = std::make_unique_for_overwrite<char[]>(rows * most);
        block.size = static_cast<std::size_t>(write(first, last, block.text.get()) - block.text.get());
      });
      hand_on();
      for (std::size_t k = 0; k < ready; ++k) sink_({blocks[k].text.get(), blocks[k].size});
    }
  }
  int num_threads() const { return num_threads_; }
  // At the end.
  void hand_on() {
    if (size_ > 0) sink_({text_.get(), size_});
    size_ = 0;
  }

 private:
  const TextSink& sink_;
  int num_threads_;
  std::size_t size_ = 0, room_ = std::size_t{1} << 20;
  std::unique_ptr<char[]> text_ = std::make_unique_for_overwrite<char[]>(room_);
};

}  // namespace hb::tools

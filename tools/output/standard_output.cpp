#include "tools/output/standard_output.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdio>

#include "tools/output/printable.hpp"

namespace hb::tools {
namespace {

int first_error = 0;

// Cells at the end of a row are filled with blanks.
std::string without_trailing_blanks(std::string text) {
  if (text.find(" \n") == std::string::npos) return text;
  std::string kept;
  kept.reserve(text.size());
  for (const char c : text) {
    if (c == '\n') kept.erase(kept.find_last_not_of(' ') + 1);
    kept += c;
  }
  return kept;
}

}  // namespace

void print_out(const std::string& text) {
  // In pieces, cut before a character: answers have up to hundreds of megabytes.
  constexpr std::size_t piece = std::size_t{1} << 20;
  errno = 0;
  bool written = true;
  for (std::size_t from = 0; from < text.size() && written;) {
    std::size_t to = std::min(from + piece, text.size());
    while (to < text.size() && (static_cast<unsigned char>(text[to]) & 0xc0) == 0x80) ++to;
    const std::string shown = without_trailing_blanks(printable(text.substr(from, to - from)));
    written = std::fwrite(shown.data(), 1, shown.size(), stdout) == shown.size();
    from = to;
  }
  written = std::fflush(stdout) == 0 && written;
  if (!written && first_error == 0) first_error = errno != 0 ? errno : EIO;
}

void print_piece(std::string_view piece) {
  errno = 0;
  if (std::fwrite(piece.data(), 1, piece.size(), stdout) != piece.size() && first_error == 0)
    first_error = errno != 0 ? errno : EIO;
}

int standard_output_error() {
  print_out("");
  return first_error;
}

}  // namespace hb::tools

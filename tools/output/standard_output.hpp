// What the subcommands print on standard output.
#pragma once

#include <string>
#include <string_view>

namespace hb::tools {

// Printable text; what could not be written is remembered, not thrown: files come first.
void print_out(const std::string& text);

// A piece of a text that is printable as it is: JSON.
void print_piece(std::string_view piece);

// Reason why something did not reach its reader (errno); 0: everything did.
[[nodiscard]] int standard_output_error();

}  // namespace hb::tools

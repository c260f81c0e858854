// The library fmt inside the program `hb`, compiled from its headers: nothing of it has to be bound at every start.
#define FMT_HEADER_ONLY

#include <fmt/core.h>
#include <fmt/format-inl.h>
#include <fmt/format.h>

#include <cstdint>
#include <cstdio>
#include <string>

namespace hb::tools {

// What the compiler would otherwise leave out here, since nothing here calls it.
extern const void* const called_elsewhere[];
[[gnu::used]] const void* const called_elsewhere[] = {
    reinterpret_cast<const void*>(static_cast<std::string (*)(fmt::string_view, fmt::format_args)>(fmt::vformat)),
    reinterpret_cast<const void*>(static_cast<void (*)(fmt::string_view, fmt::format_args)>(fmt::vprint)),
    reinterpret_cast<const void*>(static_cast<void (*)(std::FILE*, fmt::string_view, fmt::format_args)>(fmt::vprint)),
    reinterpret_cast<const void*>(static_cast<bool (*)(std::uint32_t)>(fmt::detail::is_printable)),
    reinterpret_cast<const void*>(fmt::detail::thousands_sep_impl<char>),
    reinterpret_cast<const void*>(fmt::detail::decimal_point_impl<char>)};

}  // namespace hb::tools

// The text of a scene that is written to another folder.
#pragma once

#include <filesystem>
#include <string>

namespace hb::tools {

// Relative paths of further files lead from the folder `to` instead of `from` (both absolute): the values of keys
// called `file`, file = "..." or '...'. Anything else (comments, longer names, "" or '\'\'') stays.
[[nodiscard]] std::string in_folder(const std::string& text, const std::filesystem::path& from,
                                    const std::filesystem::path& to);

}  // namespace hb::tools

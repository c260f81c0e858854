// Scenes that `hb new` writes: the .toml files of this folder, embedded when the program is built.
#pragma once

#include <span>
#include <string_view>

namespace hb::tools {

struct SceneTemplate {
  std::string_view name, text;
};

[[nodiscard]] std::span<const SceneTemplate> scene_templates();

}  // namespace hb::tools

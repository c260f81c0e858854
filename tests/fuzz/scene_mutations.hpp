// What must hold of any text taken as a scene: it is refused by SceneError with a message, or what comes out is sound.
#pragma once

#include <string>

namespace hb::fuzz {

// Reads `text` as a scene. Empty if all is well, else what is wrong. `folder` holds further files. `accepted` tells
// whether the text is a scene.
[[nodiscard]] std::string check_scene_text(const std::string& text, const std::string& folder, bool& accepted);

}  // namespace hb::fuzz

// A scene as Python holds it: its text, and what was read from it. Immutable.
#pragma once

#include <filesystem>
#include <string>

#include "lib/scene/scene.hpp"
#include "tools/output/provenance.hpp"

namespace hb::python {

struct SceneCore {
  SceneCore(std::string text, std::string name, std::filesystem::path folder);

  std::string text, name;
  std::filesystem::path folder;
  SceneSource source;
  Scene scene;

  // Of a file that `call` made of this scene.
  [[nodiscard]] tools::Provenance provenance(const std::string& call) const;
};

// Radians for one of the scene's units of angle.
[[nodiscard]] double angle_unit(const Units& units);

}  // namespace hb::python

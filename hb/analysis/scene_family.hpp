// Scenes that differ in some numbers: those of a file, by the paths of its numbers, or of a function that builds them.
// From numbers to a scene, or to the reason why there is none.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "lib/scene/scene.hpp"

namespace hb {

// A number of a scene by its path ("AB.J"), or by the name that a function's maker gave it.
struct Number {
  std::string path;
  double value = 0;
};
using Numbers = std::vector<Number>;

// A scene, or why there is none.
struct FamilyMember {
  std::optional<Scene> scene;
  std::string why_not;
  int dyad = -1;  // that does not let the linkage turn through; -1: a number that cannot be
};

// Immutable; free to share by threads if the function given is.
class SceneFamily {
 public:
  SceneFamily(Scene scene);  // NOLINT: a family of one, in which nothing but the speed varies
  // Every number that the text gives, or may give; those of `set` replaced first.
  SceneFamily(SceneSource source, std::vector<Override> set = {});  // NOLINT
  // `build` gets the values of all `numbers`, in their order; each is what it is here unless something else is asked.
  // It may throw SceneError. `units` are what the numbers are written in.
  using Build = std::function<std::variant<Linkage, HillSystem>(const std::vector<double>& values)>;
  SceneFamily(Numbers numbers, Build build, Units units = {});

  // Throws SceneError, ObstructedLinkage where the linkage does not turn through.
  [[nodiscard]] Scene scene(const Numbers& numbers = {}) const;
  // The same, or the reason why there is none.
  [[nodiscard]] FamilyMember at(const Numbers& numbers) const;

  [[nodiscard]] std::vector<std::string> paths() const;
  // Those that damping is proportional to: internal damping of elastic links, the damping of a [hill] scene. A function
  // has none that are known.
  [[nodiscard]] std::vector<std::string> damping_paths() const;
  [[nodiscard]] double value(const std::string& path) const;  // throws SceneError
  // The same family with these numbers replaced.
  [[nodiscard]] SceneFamily with(const Numbers& numbers) const;

 private:
  struct Kind;
  explicit SceneFamily(std::shared_ptr<const Kind> kind);
  std::shared_ptr<const Kind> kind_;
};

// A scene of a mechanism or a system that was built in code: no file, no defaults of its own. Throws ObstructedLinkage
// for a linkage that does not turn through, std::invalid_argument for a system that is none.
[[nodiscard]] Scene scene_of(std::variant<Linkage, HillSystem> model, const Units& units = {});

}  // namespace hb

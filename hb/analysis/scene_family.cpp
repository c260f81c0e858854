#include "hb/analysis/scene_family.hpp"

#include <fmt/core.h>
#include <fmt/format.h>

#include <algorithm>

#include "lib/linkage/kinematics.hpp"

namespace hb {

// Where the scenes come from.
struct SceneFamily::Kind {
  Kind() = default;
  virtual ~Kind() = default;
  Kind(const Kind&) = delete;
  Kind& operator=(const Kind&) = delete;

  virtual Scene scene(const Numbers& numbers) const = 0;
  virtual std::vector<std::string> paths() const = 0;
  virtual std::vector<std::string> damping_paths() const { return {}; }
  virtual double value(const std::string& path) const = 0;
  virtual std::shared_ptr<const Kind> with(const Numbers& numbers) const = 0;
};

namespace {

[[noreturn]] void refuse_path(const std::string& path, const std::vector<std::string>& paths) {
  throw SceneError(fmt::format("{}: found no such number, allowed {}", path,
                               paths.empty() ? "none: the scene is a single one, not read from a source"
                                             : fmt::format("{}", fmt::join(paths, ", "))));
}

}  // namespace

SceneFamily::SceneFamily(std::shared_ptr<const Kind> kind) : kind_(std::move(kind)) {}

SceneFamily::SceneFamily(Scene scene) {
  struct Single : Kind {
    explicit Single(Scene given) : scene_(std::move(given)) {}
    Scene scene(const Numbers& numbers) const override {
      for (const Number& number : numbers) refuse_path(number.path, {});
      return scene_;
    }
    std::vector<std::string> paths() const override { return {}; }
    double value(const std::string& path) const override { refuse_path(path, {}); }
    std::shared_ptr<const Kind> with(const Numbers& numbers) const override {
      return std::make_shared<Single>(scene(numbers));
    }
    Scene scene_;
  };
  kind_ = std::make_shared<Single>(std::move(scene));
}

SceneFamily::SceneFamily(SceneSource source, std::vector<Override> set) {
  struct FromText : Kind {
    FromText(SceneSource text, std::vector<Override> overrides) : text_(std::move(text)), set_(std::move(overrides)) {}
    Scene scene(const Numbers& numbers) const override {
      std::vector<Override> all = set_;
      for (const Number& number : numbers) all.push_back(value_override(number.path, number.value));
      return text_.with(all);
    }
    std::vector<std::string> paths() const override { return text_.numeric_paths(); }
    std::vector<std::string> damping_paths() const override {
      std::vector<std::string> of_hill = text_.numeric_paths();
      std::erase_if(of_hill, [](const std::string& path) { return !path.starts_with("hill.damping."); });
      return of_hill.empty() ? text_.damping_paths() : of_hill;
    }
    double value(const std::string& path) const override {
      return set_.empty() ? text_.value(path) : SceneSource(text_.text_with(set_), "scene", ".").value(path);
    }
    std::shared_ptr<const Kind> with(const Numbers& numbers) const override {
      std::vector<Override> all = set_;
      for (const Number& number : numbers) all.push_back(value_override(number.path, number.value));
      return std::make_shared<FromText>(text_, std::move(all));
    }
    SceneSource text_;
    std::vector<Override> set_;
  };
  kind_ = std::make_shared<FromText>(std::move(source), std::move(set));
}

SceneFamily::SceneFamily(Numbers numbers, Build build, Units units) {
  struct FromFunction : Kind {
    FromFunction(Numbers given, Build function, Units written_in)
        : numbers_(std::move(given)), build_(std::move(function)), units_(std::move(written_in)) {}
    Scene scene(const Numbers& numbers) const override {
      std::vector<double> values;
      for (const Number& number : numbers_) values.push_back(number.value);
      for (const Number& number : numbers) values[place_of(number.path)] = number.value;
      return scene_of(build_(values), units_);
    }
    std::vector<std::string> paths() const override {
      std::vector<std::string> names;
      for (const Number& number : numbers_) names.push_back(number.path);
      return names;
    }
    double value(const std::string& path) const override { return numbers_[place_of(path)].value; }
    std::shared_ptr<const Kind> with(const Numbers& numbers) const override {
      Numbers replaced = numbers_;
      for (const Number& number : numbers) replaced[place_of(number.path)].value = number.value;
      return std::make_shared<FromFunction>(std::move(replaced), build_, units_);
    }
    std::size_t place_of(const std::string& path) const {
      const auto found = std::ranges::find(numbers_, path, &Number::path);
      if (found == numbers_.end()) refuse_path(path, paths());
      return static_cast<std::size_t>(found - numbers_.begin());
    }
    Numbers numbers_;
    Build build_;
    Units units_;
  };
  kind_ = std::make_shared<FromFunction>(std::move(numbers), std::move(build), std::move(units));
}

Scene SceneFamily::scene(const Numbers& numbers) const { return kind_->scene(numbers); }

FamilyMember SceneFamily::at(const Numbers& numbers) const {
  try {
    return {kind_->scene(numbers), "", -1};
  } catch (const ObstructedLinkage& error) {
    return {std::nullopt, error.what(), error.dyad};
  } catch (const SceneError& error) {
    return {std::nullopt, error.what(), -1};
  }
}

std::vector<std::string> SceneFamily::paths() const { return kind_->paths(); }
std::vector<std::string> SceneFamily::damping_paths() const { return kind_->damping_paths(); }
double SceneFamily::value(const std::string& path) const { return kind_->value(path); }
SceneFamily SceneFamily::with(const Numbers& numbers) const { return SceneFamily(kind_->with(numbers)); }

Scene scene_of(std::variant<Linkage, HillSystem> model, const Units& units) {
  Scene scene;
  scene.units = units;
  scene.model = std::move(model);
  if (const auto* hill = std::get_if<HillSystem>(&scene.model)) {
    validate(*hill);
    scene.analysis.modes = static_cast<int>(hill->num_modes());
  } else if (const auto obstruction = find_obstruction(std::get<Linkage>(scene.model))) {
    throw ObstructedLinkage(
        fmt::format("dyad.{}: found {}, allowed a linkage that turns through", obstruction->dyad, obstruction->message),
        obstruction->dyad, obstruction->crank_angle);
  }
  return scene;
}

}  // namespace hb

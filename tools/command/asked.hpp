// What the common flags ask for beside a scene's [analysis]: flags win.
#pragma once

#include <string>
#include <vector>

#include "hb/analysis/request.hpp"
#include "hb/analysis/sensitivity_band.hpp"
#include "lib/scene/scene.hpp"
#include "tools/command/common_flags.hpp"

namespace hb::tools {

// A refused request in the words of the command line: fields as flags.
[[nodiscard]] std::string in_flags(const RequestError& error);

// --set as overrides; throws UsageError unless each is PATH=VALUE.
[[nodiscard]] std::vector<Override> overrides(const CommonFlags& flags);

// What the flags ask for, without a speed; throws UsageError naming the flag, the value found and what is allowed.
[[nodiscard]] Request asked_request(const CommonFlags& flags, const Scene& scene);
// With what they leave open taken from the scene; throws RequestError too.
[[nodiscard]] Settings settings(const CommonFlags& flags, const Scene& scene);
struct SpeedRange;
void set_speed(Request& request, const SpeedRange& speed);  // the first of the range

// Of --band, as written.
[[nodiscard]] std::vector<BandRequest> bands_of(const std::vector<std::string>& texts);

}  // namespace hb::tools

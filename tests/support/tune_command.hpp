// `hb tune` on an engine whose rod is to be as light as it may.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/support/run_command.hpp"

namespace hb {

using Json = nlohmann::json;

// A slider-crank whose rod is a steel rectangle; m, kg, s.
inline constexpr const char* engine = R"(title = "Engine"
gravity = 0
[crank]
pivot = [0, 0]
length = 0.03  # m
[[dyad]]
on = "crank"
coupler = { name = "rod", length = 0.12, elastic = { E = 2.1e11, density = 7850, damping_internal = 1e-5, section = { shape = "rectangle", width = 0.006, height = 0.006 } } }
slider = { name = "piston", mass = 0.2, guide = [0, 0], force = { cos = [-800, -300, -100] } }
branch = 1
[analysis]
modes = 2
tolerance = 1e-8
)";

class Tune : public CommandTest {
 protected:
  Tune() { std::ofstream(folder_ / "engine.toml") << engine; }

  Json document(const std::string& arguments, int expected_status = 0) const {
    const CommandResult result = hb("tune engine.toml --json --speeds 6 " + arguments);
    EXPECT_EQ(result.status, expected_status) << result.err << result.out;
    return Json::parse(result.out, nullptr, false);
  }
  Json steady(const std::string& arguments) const {
    const CommandResult result = hb("steady " + arguments + " --json");
    EXPECT_EQ(result.status, 0) << result.err;
    return Json::parse(result.out, nullptr, false);
  }
  std::string refusal(const std::string& arguments) const {
    const CommandResult result = hb("tune engine.toml " + arguments + " --out written");
    EXPECT_EQ(result.status, 2) << arguments << result.out;
    EXPECT_FALSE(std::filesystem::exists(folder_ / "written")) << arguments;
    EXPECT_EQ(result.out, "");
    return result.err;
  }
};

inline const std::string least_mass =
    "--minimise mass --vary rod.section.height=0.002:0.02 --keep 'deflection<=5e-5' --over rpm=1000:9000 ";

}  // namespace hb

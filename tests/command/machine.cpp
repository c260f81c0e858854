// What `hb steady` says for a machine's design beside joint forces: document, table, files and pictures agree.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/support/run_command.hpp"

namespace {

using Json = nlohmann::json;
namespace fs = std::filesystem;

class Machine : public CommandTest {
 protected:
  Json document(const std::string& arguments) const {
    const CommandResult result = hb("steady " + arguments + " --json");
    EXPECT_EQ(result.status, 0) << result.err;
    return Json::parse(result.out, nullptr, false);
  }
  // Largest and smallest number of a column of a CSV file.
  std::pair<double, double> column(const fs::path& file, const std::string& name) const {
    std::istringstream lines(read(file));
    std::string line;
    std::size_t place = std::string::npos;
    double low = HUGE_VAL, high = -HUGE_VAL;
    while (std::getline(lines, line)) {
      if (line.starts_with("#")) continue;
      std::istringstream cells(line);
      std::string cell;
      for (std::size_t k = 0; std::getline(cells, cell, ','); ++k) {
        if (place == std::string::npos && cell == name) place = k;
        if (place == k && cell != name) low = std::min(low, std::stod(cell)), high = std::max(high, std::stod(cell));
      }
    }
    EXPECT_NE(place, std::string::npos) << name;
    return {low, high};
  }
};

const std::string crank_with_flywheel = " --rpm 2500 --modes 2";

TEST_F(Machine, TheDocumentHasBearingsFrameDriveAndSliders) {
  const Json found = document(scene("slider_crank") + crank_with_flywheel);
  for (const auto& [name, joint] : found["joints"].items()) {
    const Json& bearing = found["bearings"][name];
    double component = 0;
    for (const char* c : {"x", "y", "n"})
      if (joint.contains(c))
        component = std::max({component, joint[c]["max"].get<double>(), -joint[c]["min"].get<double>()});
    EXPECT_GE(bearing["max"].get<double>(), (1 - 1e-12) * component) << name;
    EXPECT_LE(bearing["max"].get<double>(), std::sqrt(2.0) * component * (1 + 1e-12)) << name;
    EXPECT_LE(bearing["mean"].get<double>(), bearing["rms"].get<double>()) << name;
    EXPECT_LE(bearing["rms"].get<double>(), bearing["max"].get<double>()) << name;
  }
  const double omega = found["omega"];
  EXPECT_NEAR(found["power"]["mean"].get<double>(), omega * found["torque"]["mean"].get<double>(), 1e-9);
  EXPECT_GT(found["torque"]["rms"].get<double>(), std::abs(found["torque"]["mean"].get<double>()));
  const double energy = found["flywheel"]["energy_fluctuation"], inertia = found["flywheel"]["inertia"];
  // The crank of the scene: a mass of 1.2 kg 8 mm off the pivot, without inertia of its own.
  EXPECT_NEAR(inertia, 1.2 * 64, 1e-9);
  EXPECT_NEAR(found["flywheel"]["speed_fluctuation"].get<double>(), energy / (inertia * omega * omega), 1e-12);
  const Json many = document(scene("slider_crank") + " --rpm 2500 --modes 20");
  EXPECT_LE(std::abs(many["flywheel"]["energy_fluctuation"].get<double>() - energy),
            found["flywheel"]["energy_fluctuation_error"].get<double>());
  EXPECT_LT(found["flywheel"]["energy_fluctuation_error"], 0.1 * energy);
  const Json most = document(scene("slider_crank") + " --rpm 100 --modes 60 --only shape");
  EXPECT_NEAR(most["rods"]["rod"]["static_deflection"]["max_abs"].get<double>(),
              many["rods"]["rod"]["static_deflection"]["max_abs"].get<double>(),
              many["rods"]["rod"]["static_deflection"]["error"].get<double>());
  const Json heavy = document(scene("slider_crank") + crank_with_flywheel + " --set crank.inertia=5000");
  EXPECT_NEAR(heavy["flywheel"]["inertia"].get<double>(), 5076.8, 1e-6);
  EXPECT_NEAR(heavy["flywheel"]["energy_fluctuation"].get<double>(), energy, 1e-9 * energy);
  const Json& piston = found["sliders"]["piston"];
  EXPECT_NEAR(piston["position"]["max"].get<double>() - piston["position"]["min"].get<double>(), 80, 0.2);
  EXPECT_GT(found["frame"]["max"].get<double>(), 0);
  EXPECT_GE(found["frame"]["force_error"].get<double>(), 0);
  EXPECT_LT(found["frame"]["force_error"].get<double>(), 0.01 * found["frame"]["max"].get<double>());
  EXPECT_GT(found["rods"]["rod"]["static_deflection"]["max_abs"].get<double>(), 0);
  // Only where forces and shapes were asked for.
  const Json little = document(scene("slider_crank") + crank_with_flywheel + " --only stability");
  for (const char* key : {"bearings", "frame", "power", "flywheel", "sliders"})
    EXPECT_FALSE(little.contains(key)) << key;
  EXPECT_FALSE(little["rods"]["rod"].contains("static_deflection"));
}

TEST_F(Machine, StressIsThatOfBothTogetherWhereASectionIsGiven) {
  const Json with = document(scene("slider_crank_units") + " --rpm 3000 --modes 3")["rods"]["rod"]["stress"];
  const double both = with["axial"].get<double>() + with["bending"].get<double>();
  EXPECT_LE(with["max_abs"].get<double>(), both * (1 + 1e-9));
  EXPECT_GE(with["max_abs"].get<double>(), std::max(with["axial"].get<double>(), 0.5 * with["bending"].get<double>()));
  EXPECT_LE(std::abs(with["mean"].get<double>()) + with["amplitude"].get<double>(),
            with["max_abs"].get<double>() * (1 + 1e-6));
  EXPECT_GE(with["error"].get<double>(), 0);
  EXPECT_FALSE(document(scene("slider_crank") + crank_with_flywheel)["rods"]["rod"]["stress"].contains("max_abs"));
}

const std::string strengths =
    " --set rod.yield=\"350 MPa\" --set rod.tensile=\"520 MPa\" --set rod.endurance=\"200 MPa\"";

TEST_F(Machine, SafetiesAreThoseOfTheStressesShown) {
  const std::string arguments = scene("slider_crank_units") + " --rpm 3000 --modes 3";
  const Json plain = document(arguments)["rods"]["rod"]["stress"];
  for (const char* key : {"yield_safety", "fatigue_safety", "fatigue_line"}) EXPECT_FALSE(plain.contains(key)) << key;
  const Json stress = document(arguments + strengths)["rods"]["rod"]["stress"];
  EXPECT_EQ(stress["max_abs"], plain["max_abs"]);
  EXPECT_NEAR(stress["yield_safety"].get<double>(), 350e6 / stress["max_abs"].get<double>(), 1e-9);
  EXPECT_EQ(stress["fatigue_line"], "Goodman");
  const double usage =
      stress["fatigue_amplitude"].get<double>() / 200e6 + std::max(0.0, stress["fatigue_mean"].get<double>()) / 520e6;
  EXPECT_NEAR(stress["fatigue_safety"].get<double>(), 1 / usage, 1e-9 / usage);
  EXPECT_GT(stress["fatigue_safety_error"].get<double>(), 0);
  const Json soderberg =
      document(arguments + " --set rod.yield=350e6 --set rod.endurance=200e6")["rods"]["rod"]["stress"];
  EXPECT_EQ(soderberg["fatigue_line"], "Soderberg");
  EXPECT_LE(soderberg["fatigue_safety"].get<double>(), stress["fatigue_safety"].get<double>());
  const std::string table = hb("steady " + arguments + strengths).out;
  for (const char* part : {"against yielding  safety", "of 350 MPa", "against fatigue   safety", "Goodman line"})
    EXPECT_NE(table.find(part), std::string::npos) << part << "\n" << table;
  const Json bent = document(arguments + strengths + " --theory nonlinear");
  const Json& of_bent = bent["rods"]["rod"]["stress"];
  EXPECT_NEAR(of_bent["yield_safety"].get<double>(), 350e6 / of_bent["max_abs"].get<double>(), 1e-9);
  EXPECT_EQ(of_bent["fatigue_line"], "Goodman");
  EXPECT_LT(of_bent["max_abs"].get<double>(), of_bent["axial"].get<double>() + of_bent["bending"].get<double>());
  EXPECT_GT(bent["frame"]["max"], 0);
  EXPECT_LT(bent["frame"]["force_error"].get<double>(), 1e-3 * bent["frame"]["max"].get<double>());
}

// Beside the unbounded resonances of unstable speeds the linear model has forces without bound: 1e16 N were listed.
TEST_F(Machine, TheLargestLoadsOfASweepAreThoseAMachineCanHave) {
  const std::string range = "sweep " + scene("six_link") + " --modes 2 --rpm ";
  const CommandResult wide = hb(range + "200:3000:100");
  ASSERT_EQ(wide.status, 0) << wide.err;
  EXPECT_NE(wide.out.find("Largest where stable and within the linear theory"), std::string::npos) << wide.out;
  const auto loads = [](const std::string& text) { return text.substr(text.find("  resultant at")); };
  const auto rows = [&](const std::string& text) { return loads(text).substr(0, loads(text).find("\n\n")); };
  const std::string bounded = rows(wide.out);
  EXPECT_EQ(bounded.find("e+"), std::string::npos) << bounded;
  EXPECT_EQ(bounded.find("at 1909"), std::string::npos) << bounded;
  const CommandResult slow = hb(range + "200:1000:100");
  EXPECT_NE(slow.out.find("Largest of all points"), std::string::npos) << slow.out;
}

// At each speed what `hb steady` says there.
TEST_F(Machine, ASweepHasWhatOneSpeedHas) {
  const std::string about = scene("slider_crank_units") + strengths + " --modes 3";
  const CommandResult result = hb("sweep " + about + " --rpm 1000:3000:1000 --no-search --out out");
  ASSERT_EQ(result.status, 0) << result.err;
  for (const char* part : {"largest stress of all points", "smallest safety against yielding", "against fatigue",
                           "Largest of all points", "resultant at rod.0", "rms torque", "at 3000 rpm"})
    EXPECT_NE(result.out.find(part), std::string::npos) << part << "\n" << result.out;
  const Json sweep = Json::parse(read(folder_ / "out/sweep.json"));
  const auto near = [](const Json& along, const Json& at, double relative) {
    EXPECT_NEAR(along[1].get<double>(), at.get<double>(), relative * std::abs(at.get<double>())) << along << at;
  };
  const Json one = document(about + " --rpm 2000");
  for (const char* key : {"axial", "bending", "max_abs", "mean", "amplitude", "yield_safety", "fatigue_safety"})
    near(sweep["rods"]["rod"]["stress"][key], one["rods"]["rod"]["stress"][key], 1e-6);
  for (const char* key : {"x", "crank_angle"})
    near(sweep["rods"]["rod"]["stress"][key], one["rods"]["rod"]["stress"][key], 1e-3);
  // Errors by a coarser solution with more modes.
  for (const char* key : {"error", "yield_safety_error", "fatigue_safety_error"})
    near(sweep["rods"]["rod"]["stress"][key], one["rods"]["rod"]["stress"][key], 0.05);
  for (const auto& [name, bearing] : one["bearings"].items())
    near(sweep["bearings"][name]["max"], bearing["max"], 1e-9);
  near(sweep["frame"]["max"], one["frame"]["max"], 1e-9);
  near(sweep["frame"]["moment"]["min"], one["frame"]["moment"]["min"], 1e-9);
  near(sweep["torque"]["rms"], one["torque"]["rms"], 1e-9);
  for (const char* key : {"min", "max", "rms"}) near(sweep["power"][key], one["power"][key], 1e-9);
  near(sweep["flywheel"]["energy_fluctuation"], one["flywheel"]["energy_fluctuation"], 1e-9);
  const auto [least, most] = column(folder_ / "out/sweep_rod.csv", "yield safety");
  EXPECT_NEAR(most, sweep["rods"]["rod"]["stress"]["yield_safety"][0].get<double>(), 1e-9 * most);
  EXPECT_LT(least, most);
  const auto [low, high] = column(folder_ / "out/sweep_machine.csv", "shaking force [N]");
  EXPECT_NEAR(high, sweep["frame"]["max"][2].get<double>(), 1e-9 * high);
  EXPECT_LT(low, high);
}

TEST_F(Machine, TheErrorOfAStressAlongASweepCoversTheModesLeftOut) {
  const auto stress = [&](const char* modes) {
    const CommandResult result = hb("sweep " + scene("slider_crank_units") + strengths +
                                    " --rpm 1000:3000:1000 --only shape --no-search --json --modes " + modes);
    EXPECT_EQ(result.status, 0) << result.err;
    return Json::parse(result.out)["rods"]["rod"]["stress"];
  };
  const Json few = stress("2"), many = stress("20");
  for (std::size_t k = 0; k < 3; ++k) {
    for (const char* key : {"max_abs", "amplitude"}) {
      const double off = std::abs(few[key][k].get<double>() - many[key][k].get<double>());
      EXPECT_LE(off, few["error"][k].get<double>()) << key << " " << k;
    }
    EXPECT_LE(few["error"][k].get<double>(), 0.1 * few["max_abs"][k].get<double>());
    EXPECT_LE(std::abs(few["fatigue_safety"][k].get<double>() - many["fatigue_safety"][k].get<double>()),
              few["fatigue_safety_error"][k].get<double>());
  }
}

TEST_F(Machine, EveryModeHasItsFrequencyInHertzAndItsDampingRatio) {
  const Json found = document(scene("slider_crank_units") + " --rpm 2000 --modes 2"), rod = found["rods"]["rod"];
  ASSERT_EQ(rod["damping_ratios"].size(), rod["exponents"].size());
  for (std::size_t k = 0; k < rod["exponents"].size(); ++k) {
    const double re = rod["exponents"][k][0], omega = rod["frequencies"][k], error = rod["exponent_errors"][k];
    EXPECT_NEAR(rod["frequencies_hz"][k], omega / (2 * M_PI), 1e-12 * omega);
    EXPECT_NEAR(rod["damping_ratios"][k], -re / std::hypot(re, omega), 1e-15);
    EXPECT_DOUBLE_EQ(rod["frequencies_hz_errors"][k], error / (2 * M_PI));
    EXPECT_DOUBLE_EQ(rod["damping_ratio_errors"][k], error / std::hypot(re, omega));
  }
  // damping_ratio = 0.005 of the first mode at rest.
  EXPECT_NEAR(rod["damping_ratios"][0].get<double>(), 0.005, 0.001);
}

TEST_F(Machine, StrengthsThatCannotBeAreRefused) {
  const std::string about = "steady " + scene("slider_crank_units") + " --rpm 1000";
  const CommandResult above = hb(about + " --set rod.yield=600e6 --set rod.tensile=500e6");
  EXPECT_EQ(above.status, 2);
  EXPECT_NE(above.err.find("yield"), std::string::npos) << above.err;
  EXPECT_NE(above.err.find("tensile strength"), std::string::npos) << above.err;
  EXPECT_EQ(hb(about + " --set rod.endurance=-1").status, 2);
  EXPECT_EQ(hb(about + " --set rod.yield=\"250 mm\"").status, 2);
  // MPa taken for Pa, and a rod whose height is not known: said, not refused.
  EXPECT_NE(hb(about + " --set rod.yield=250").out.find("250 MPa if the number was in MPa"), std::string::npos);
  const CommandResult flat = hb("steady " + scene("slider_crank") + " --rpm 1000 --set rod.yield=\"250 MPa\"");
  EXPECT_EQ(flat.status, 0) << flat.err;
  EXPECT_NE(flat.out.find("section = "), std::string::npos) << flat.out;
}

// Two turns or one: the bearings and the drive of the motion without linearisation are those of its forces.
TEST_F(Machine, AMotionWithoutLinearisationHasBearingsAndDrive) {
  const std::string about = scene("slider_crank") + " --rpm 800 --modes 2";
  const Json bent = document(about + " --theory nonlinear"), linear = document(about);
  for (const auto& [name, bearing] : linear["bearings"].items())
    EXPECT_NEAR(bent["bearings"][name]["max"].get<double>(), bearing["max"].get<double>(),
                0.02 * bearing["max"].get<double>())
        << name;
  EXPECT_NEAR(bent["power"]["rms"].get<double>(), linear["power"]["rms"].get<double>(),
              0.02 * linear["power"]["rms"].get<double>());
  EXPECT_NEAR(bent["flywheel"]["energy_fluctuation"].get<double>(),
              linear["flywheel"]["energy_fluctuation"].get<double>(),
              0.02 * linear["flywheel"]["energy_fluctuation"].get<double>());
}

TEST_F(Machine, TheStressPictureHoldsTheLargestStress) {
  ASSERT_EQ(hb("steady " + scene("slider_crank_units") + " --rpm 3000 --modes 3 --out out").status, 0);
  const Json stress = Json::parse(read(folder_ / "out/steady.json"))["rods"]["rod"]["stress"];
  double largest = 0;
  for (const char* name :
       {"right smallest [MPa]", "right largest [MPa]", "left smallest [MPa]", "left largest [MPa]"}) {
    const auto [low, high] = column(folder_ / "out/stress_rod.csv", name);
    largest = std::max({largest, -low, high});
  }
  EXPECT_NEAR(largest, 1e-6 * stress["max_abs"].get<double>(), 0.01 * largest);
  EXPECT_GT(fs::file_size(folder_ / "out/stress_rod.svg"), 5000u);
}

TEST_F(Machine, TableFilesAndDocumentAgree) {
  const CommandResult result = hb("steady " + scene("slider_crank") + crank_with_flywheel + " --out out");
  ASSERT_EQ(result.status, 0) << result.err;
  for (const char* part : {"largest resultant [N]", "shaking force on the frame", "shaking moment", "mean", "rms", " W",
                           "flywheel", "piston: stroke 80.0", "  at rest  "})
    EXPECT_NE(result.out.find(part), std::string::npos) << part << "\n" << result.out;
  const Json found = Json::parse(read(folder_ / "out/steady.json"));
  const double newton = found["units"]["force_in_newton"];
  const auto [low, high] = column(folder_ / "out/frame_forces.csv", "x [N]");
  EXPECT_NEAR(low, newton * found["frame"]["x"]["min"].get<double>(), 1e-3 * (high - low));
  EXPECT_NEAR(high, newton * found["frame"]["x"]["max"].get<double>(), 1e-3 * (high - low));
  const auto [slow, fast] = column(folder_ / "out/slider_piston.csv", "velocity [mm/s]");
  EXPECT_NEAR(fast, found["sliders"]["piston"]["velocity"]["max"].get<double>(), 1e-3 * fast);
  EXPECT_LT(slow, 0);
  for (const char* picture : {"polar_rod", "polar_crank"})
    EXPECT_GT(fs::file_size(folder_ / "out" / (std::string(picture) + ".svg")), 5000u) << picture;
}

// One peak of 1e16 N beside a limit of stability left a flat line of all other speeds.
TEST_F(Machine, SharpPeaksDoNotFlattenTheForcesOfASweep) {
  const CommandResult result = hb("sweep " + scene("six_link") + " --rpm 1500:2000:50 --modes 1 --rods AB --out out");
  ASSERT_EQ(result.status, 0) << result.err;
  std::istringstream script(read(folder_ / "out/sweep.gp"));
  std::string line;
  bool forces = false;
  int ranges = 0;
  while (std::getline(script, line)) {
    forces = forces || line.find("joints of") != std::string::npos;
    if (!forces || !line.starts_with("set yrange [") || line.find('*') != std::string::npos) continue;
    const double top = std::stod(line.substr(line.find(':') + 1));
    EXPECT_LT(std::abs(top), 1e5) << line;
    ++ranges;
  }
  EXPECT_GE(ranges, 8);
}

// Each end is what the scene with that number gives; slopes are those of small steps.
TEST_F(Machine, BandsAreTheAnswersAtTheirEnds) {
  const std::string about = scene("slider_crank") + " --rpm 2500 --modes 2";
  const Json found = document(about + " --band damping=0.5:2 --band E=0.9:1.1 --band mass=0.99:1.01");
  ASSERT_EQ(found["bands"].size(), 3u);
  const auto quantity = [](const Json& band, const std::string& of, const std::string& name) {
    for (const Json& one : band["quantities"])
      if (one["of"] == of && one["name"] == name) return one;
    ADD_FAILURE() << of << " " << name;
    return Json();
  };
  const Json& damping = found["bands"][0];
  const Json rod = document(about)["rods"]["rod"];
  const Json growth = quantity(damping, "rod", "growth rate");
  EXPECT_EQ(growth["nominal"], rod["growth_rate"]);
  const Json low = quantity(found["bands"][1], "rod", "deflection");
  const Json scene_read = Json::parse(hb("scene " + scene("slider_crank") + " --json").out);
  const double E = scene_read["linkage"]["dyads"][0]["coupler"]["elastic"]["E"];
  std::ostringstream softer;
  softer.precision(17);
  softer << 0.9 * E;
  const Json soft = document(about + " --set rod.E=" + softer.str())["rods"]["rod"];
  EXPECT_NEAR(low["from"].get<double>(), soft["deflection"]["max_abs"].get<double>(), 1e-9 * low["from"].get<double>());
  EXPECT_EQ(damping["verdict"], "stable");
  EXPECT_EQ(damping["verdict_to"], "stable");
  // One per cent both ways: the difference of the ends is the derivative.
  const Json& mass = found["bands"][2];
  for (const char* name : {"deflection", "growth rate"}) {
    const Json of = quantity(mass, "rod", name);
    const double secant = std::log(of["to"].get<double>() / of["from"].get<double>()) / std::log(1.01 / 0.99);
    EXPECT_NEAR(of["slope"].get<double>(), secant, 2e-3 + 0.02 * std::abs(secant)) << of;
    EXPECT_TRUE(of["straight"].get<bool>()) << of;
  }
  const Json bearing = quantity(mass, "bearings", "rod.0");
  const double secant = std::log(bearing["to"].get<double>() / bearing["from"].get<double>()) / std::log(1.01 / 0.99);
  EXPECT_NEAR(bearing["slope"].get<double>(), secant, 2e-3 + 0.02 * std::abs(secant)) << bearing;
  const std::string table = hb("steady " + about + " --band damping=0.5:2").out;
  for (const char* part : {"damping of the elastic links times 0.5 to 2", "growth rate", "verdict: stable at 0.5"})
    EXPECT_NE(table.find(part), std::string::npos) << part << "\n" << table;
}

TEST_F(Machine, BandsThatCannotBeAreRefused) {
  for (const char* band : {"damping=2:0.5", "E=0:1", "stiffness=0.5:2", "E", "E=1", "mass=-1:1", "damping=0.5:x"}) {
    const CommandResult result = hb("steady " + scene("slider_crank") + " --rpm 2500 --band " + band);
    EXPECT_EQ(result.status, 2) << band;
    EXPECT_NE(result.err.find("--band"), std::string::npos) << result.err;
  }
  EXPECT_EQ(hb("steady " + scene("mathieu") + " --omega 1 --band E=0.9:1.1").status, 2);
  EXPECT_EQ(hb("steady " + scene("mathieu") + " --omega 1 --band damping=0.5:2").status, 0);
  EXPECT_EQ(hb("sweep " + scene("slider_crank") + " --rpm 800:900:100 --theory nonlinear --band E=0.9:1.1").status, 2);
}

// A measurement that is made up: milliseconds and micrometres, one column of two.
TEST_F(Machine, FitGivesTheDampingThatADecayWasMadeWith) {
  std::ostringstream text;
  text << "time [ms], noise [V], rod [um]\n";
  constexpr double zeta = 0.008, omega = 2 * 3.14159265358979323846 * 620;
  for (int k = 0; k < 400; ++k) {
    const double t = 2e-4 * k;
    text << 1e3 * t << ", 1, "
         << 5 + 80 * std::exp(-zeta * omega * t) * std::cos(omega * std::sqrt(1 - zeta * zeta) * t) << "\n";
  }
  std::ofstream(folder_ / "decay.csv") << text.str();
  const std::string about = "fit " + scene("slider_crank") + " --decay decay.csv";
  const CommandResult result = hb(about + " --column rod --out out");
  ASSERT_EQ(result.status, 0) << result.err;
  for (const char* part : {"damping of rod, mode 1", "the scene has 628", "damping_ratio = 0.008", "+/-"})
    EXPECT_NE(result.out.find(part), std::string::npos) << part << "\n" << result.out;
  const Json found = Json::parse(read(folder_ / "out/fit.json"));
  EXPECT_NEAR(found["damping_ratio"].get<double>(), zeta, 1e-5);
  EXPECT_NEAR(found["frequency"].get<double>(), 620, 1e-3);
  EXPECT_LT(found["residual"].get<double>(), 1e-3);
  const auto [low, high] = column(folder_ / "out/fit.csv", "fitted rod [um]");
  EXPECT_NEAR(high, 85, 0.1);
  EXPECT_LT(low, -60);
  EXPECT_GT(fs::file_size(folder_ / "out/fit.svg"), 5000u);
  // Where it goes it is understood.
  EXPECT_EQ(hb(about).status, 2);  // which column?
  EXPECT_EQ(hb(about + " --column rod --rod piston").status, 2);
  EXPECT_EQ(hb(about + " --column rod --peak decay.csv").status, 2);
  EXPECT_EQ(hb("fit " + scene("slider_crank") + " --peak decay.csv --column rod").status, 2);  // ms are no frequency
  EXPECT_EQ(hb("fit " + scene("mathieu") + " --decay decay.csv --column rod").status, 2);
  EXPECT_EQ(hb("fit " + scene("slider_crank") + " --decay none.csv").status, 2);
}

// Two scenes, or a folder of results beside a scene.
TEST_F(Machine, CompareSaysWhatDiffersAndWhatIsTheSame) {
  const CommandResult result = hb("compare " + scene("six_link") + " " + scene("six_link") +
                                  " --rpm 900 --modes 2 --set-b AB.J=60 --out out --json");
  ASSERT_EQ(result.status, 0) << result.err;
  const Json found = Json::parse(result.out);
  EXPECT_EQ(found["a"]["verdict"], "stable");
  const Json one = document(scene("six_link") + " --rpm 900 --modes 2"),
             other = document(scene("six_link") + " --rpm 900 --modes 2 --set AB.J=60");
  bool deflection = false, untouched = false;
  std::vector<std::string> order;
  for (const Json& quantity : found["quantities"]) {
    if (order.empty() || order.back() != quantity["of"]) order.push_back(quantity["of"]);
    if (quantity["of"] == "AB" && quantity["name"] == "deflection") {
      deflection = true;
      EXPECT_EQ(quantity["unit"], "mm");
      EXPECT_EQ(quantity["a"], one["rods"]["AB"]["deflection"]["max_abs"]);
      EXPECT_EQ(quantity["b"], other["rods"]["AB"]["deflection"]["max_abs"]);
      EXPECT_LT(quantity["change"].get<double>(), -0.2);
      EXPECT_EQ(quantity["same"], false);
    }
    // Rods do not feel each other's bending.
    if (quantity["of"] == "CD" && quantity["name"] == "deflection") untouched = quantity["same"];
  }
  EXPECT_TRUE(deflection);
  EXPECT_TRUE(untouched);
  EXPECT_EQ(order, (std::vector<std::string>{"AB", "CD", "bearings", "frame", "drive"}));
  EXPECT_GT(fs::file_size(folder_ / "out/compare_AB.svg"), 5000u);
  EXPECT_NE(read(folder_ / "out/compare_AB.svg").find("AB.J=60"), std::string::npos);

  ASSERT_EQ(hb("steady " + scene("six_link") + " --rpm 2400 --modes 2 --no-plots --out before").status, 0);
  const CommandResult text = hb("compare before " + scene("six_link") + " --rpm 2400 --modes 2 --set-b AB.J=2000");
  ASSERT_EQ(text.status, 0) << text.err;
  EXPECT_TRUE(text.out.starts_with("A  Six-link mechanism, 2400 rpm (before): UNSTABLE because of AB\nB  "))
      << text.out;
  EXPECT_NE(text.out.find("--set AB.J=2000): stable\n"), std::string::npos) << text.out;
  EXPECT_NE(text.out.find("same\n"), std::string::npos) << text.out;
}

TEST_F(Machine, CompareOfSweepsSaysWhatEachHasAndWhere) {
  const std::string range = scene("slider_crank_units") + strengths + " --modes 3 ";
  ASSERT_EQ(hb("sweep " + range + "--rpm 1000:3000:500 --no-plots --out a").status, 0);
  ASSERT_EQ(hb("sweep " + range + "--rpm 2000:4000:500 --set piston.mass=0.6 --no-plots --out b").status, 0);
  const CommandResult result = hb("compare a b --json --out out");
  ASSERT_EQ(result.status, 0) << result.err;
  const Json found = Json::parse(result.out);
  EXPECT_EQ(found["along"], Json({{"path", "rpm"}, {"from", 2000.0}, {"to", 3000.0}}));
  const Json a = Json::parse(read(folder_ / "a/sweep.json")), b = Json::parse(read(folder_ / "b/sweep.json"));
  bool stress = false, safety = false, shaking = false;
  for (const Json& quantity : found["quantities"]) {
    if (quantity["name"] == "stress, together") {
      stress = true;
      // Both grow with the speed: at 3000 rpm, point 4 of A and 2 of B.
      EXPECT_EQ(quantity["at_a"], 3000.0);
      EXPECT_NEAR(quantity["a"], a["rods"]["rod"]["stress"]["max_abs"][4].get<double>() * 1e-6, 1e-6);
      EXPECT_NEAR(quantity["b"], b["rods"]["rod"]["stress"]["max_abs"][2].get<double>() * 1e-6, 1e-6);
      EXPECT_NEAR(quantity["error_b"], b["rods"]["rod"]["stress"]["error"][2].get<double>() * 1e-6, 1e-6);
      EXPECT_EQ(quantity["same"], false);
    }
    if (quantity["name"] == "safety, fatigue") {
      safety = true;
      EXPECT_EQ(quantity["a"], a["rods"]["rod"]["stress"]["fatigue_safety"][4]);
    }
    if (quantity["name"] == "shaking force") {
      shaking = true;
      EXPECT_NEAR(quantity["b"], b["frame"]["max"][2].get<double>(), 1e-9 * quantity["b"].get<double>());
    }
  }
  EXPECT_TRUE(stress && safety && shaking);
  EXPECT_GT(fs::file_size(folder_ / "out/compare_sweep_rod.svg"), 5000u);
  EXPECT_GT(fs::file_size(folder_ / "out/compare_sweep_machine.svg"), 5000u);
  // The same of scenes as of their folders.
  const CommandResult computed = hb("compare a " + range + "--rpm 2000:4000:500 --set-b piston.mass=0.6 --json");
  ASSERT_EQ(computed.status, 0) << computed.err;
  EXPECT_EQ(Json::parse(computed.out)["quantities"], found["quantities"]);
  const CommandResult text = hb("compare a b");
  for (const char* part : {"compared from 2000 to 3000 rpm", "unstable bands: A none; B none", "resonance peaks"})
    EXPECT_NE(text.out.find(part), std::string::npos) << text.out;
}

TEST_F(Machine, CompareOfSweepsRefusesRangesThatDoNotMeet) {
  const std::string range = "sweep " + scene("slider_crank_units") + " --modes 1 --only shape --no-search --no-plots ";
  ASSERT_EQ(hb(range + "--rpm 1000:1500:500 --out a").status, 0);
  ASSERT_EQ(hb(range + "--rpm 2000:2500:500 --out b").status, 0);
  ASSERT_EQ(hb(range + "--rpm 2000 --x piston.mass=0.4:0.6:0.1 --out c").status, 0);
  ASSERT_EQ(hb("steady " + scene("slider_crank_units") + " --rpm 1000 --modes 1 --no-plots --out d").status, 0);
  for (const auto& [sides, said] :
       {std::pair("a b", "a part in common"), {"a c", "along one number"}, {"a/sweep.json d", "d/sweep.json"}}) {
    const CommandResult result = hb(std::string("compare ") + sides);
    EXPECT_EQ(result.status, 2) << sides;
    EXPECT_NE(result.err.find(said), std::string::npos) << result.err;
  }
}

TEST_F(Machine, CompareRefusesWhatCannotBeCompared) {
  fs::create_directory(folder_ / "empty");
  std::ofstream(folder_ / "other.json") << "{\"rods\": 3}";
  for (const auto& [arguments, said] :
       {std::pair("empty " + scene("six_link"), "empty/steady.json"),
        std::pair(scene("six_link") + " other.json", "no answer of hb steady or hb sweep in other.json"),
        std::pair(scene("six_link") + " " + scene("mathieu") + " --omega 10", "two of one kind"),
        std::pair(scene("six_link"), "B is required"),
        std::pair(scene("six_link") + " empty --rpm 300 --modes 1 --set-b AB.J=3", "--set-b")}) {
    const CommandResult result = hb("compare " + arguments);
    EXPECT_EQ(result.status, 2) << arguments;
    EXPECT_NE(result.err.find(said), std::string::npos) << result.err;
    EXPECT_TRUE(result.out.empty()) << result.out;
  }
}

}  // namespace

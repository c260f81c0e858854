#include "tools/command/tune_flags.hpp"

#include <CLI/CLI.hpp>

#include "tools/command/common_flags.hpp"
#include "tools/command/theory_flags.hpp"

namespace hb::tools {

void add_tune_flags(CLI::App& command, TuneFlags& flags) {
  add_scene_flags(command, flags);
  add_linear_theory_flag(command, flags.theory);
  add_analysis_flags(command, flags);
  command.get_option("--only")->group("");  // refused: goal and conditions say what is computed
  add_html_flag(command, flags);
  const auto repeatable = [&](const char* name, std::vector<std::string>& values, const char* help, const char* type) {
    command.add_option(name, values, help)
        ->type_name(type)
        ->expected(1)
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  };
  command
      .add_option("--minimise,--minimize", flags.minimise,
                  "deflection, stress, total-stress, force (each :NAME for one rod or joint), torque-ripple (largest "
                  "minus smallest "
                  "torque), mass, theory (the theory error), or a sum such as "
                  "0.7*deflection+0.3*mass of parts over their start values")
      ->type_name("GOAL");
  command
      .add_option("--maximise,--maximize", flags.maximise,
                  "instead: stable (the margin), safety, frequency, clearance:N or speed-range")
      ->type_name("GOAL");
  repeatable("--vary", flags.vary,
             "a scene number to choose within bounds, as in AB.J=20:200, or an end of the speed range, over.from or "
             "over.to; repeatable",
             "PATH=A:B");
  repeatable("--tie", flags.tie, "a scene number that follows a varied one, as in CD.J=AB.J or CD.J=0.5*AB.J",
             "PATH=PATH");
  repeatable(
      "--keep", flags.keep,
      "stable, stable>=M (1/time) or M/turn, deflection<=, stress<= (MPa, of bending), total-stress<= (MPa), safety>= "
      "(against "
      "yielding and fatigue), theory<=, force:JOINT<= (N), torque-ripple<= "
      "(N m), mass<=, frequency>= (Hz), clearance:N>= (least |omega_1/(n Omega) - 1| over speeds, rods and n = 1..N)",
      "CONDITION");
  command.add_option("--over", flags.over, "speeds over which the worst case counts")->type_name("rpm=A:B");
  repeatable("--height", flags.height,
             "height of a rod's section in the plane of motion, for stresses and safety; * for all", "ROD=H");
  command.add_option("--algorithm", flags.algorithm, "automatic, direct, mlsl, cobyla, bobyqa, slsqp or mma (NLopt)")
      ->type_name("NAME");
  command.add_option("--seed", flags.seed, "of mlsl")->type_name("N");
  command.add_option("--analyses", flags.analyses, "designs analysed at most, confirmations included")->type_name("N");
  command.add_option("--speeds", flags.speeds, "speeds sampled before the worst case is refined; default 24")
      ->type_name("N");
}

}  // namespace hb::tools

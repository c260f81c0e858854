// The processes that mpirun started together, each with a share of the work; one alone without it.
#pragma once

#include <vector>

namespace hb::tools {

class Ranks {
 public:
  virtual ~Ranks() = default;
  virtual int size() const { return 1; }
  virtual int rank() const { return 0; }
  // What every rank gives, in the order of ranks; all have to call it.
  virtual std::vector<std::vector<double>> gathered(const std::vector<double>& own) const { return {own}; }

  bool first() const { return rank() == 0; }
};

[[nodiscard]] const Ranks& ranks();

// Once, at the start; `all` has to live as long as the program.
void set_ranks(const Ranks& all);

// Thrown by all ranks but the first when their share is done: the first one writes the answer.
struct ShareDone {};

// Thrown where another rank failed, which says why.
struct OtherRankFailed {};

}  // namespace hb::tools

// Who does long work, and how: one part after the other here. Threads, files of what is finished and several processes
// are implementations of it elsewhere. The answer has the same bits whoever does it.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "hb/engine/boundaries/part.hpp"

namespace hb {

class Work {
 public:
  Work() = default;
  virtual ~Work() = default;
  Work(const Work&) = delete;
  Work& operator=(const Work&) = delete;

  // Calls task(0) .. task(count - 1), each once, in any order, perhaps from several threads: results belong into places
  // of their own, by index. An exception ends the rest and is thrown on.
  virtual void for_each(std::size_t count, const std::function<void(std::size_t)>& task) const {
    for (std::size_t k = 0; k < count; ++k) task(k);
  }

  // Whoever does the work has to end soon: what is not computed yet stays so, and the answer says that.
  [[nodiscard]] virtual bool ends_early() const { return false; }

  // A long step, `what` in words: all parts are there when it returns, computed or known from elsewhere.
  virtual void step(const std::string& what, const Parts& parts) {
    (void)what;
    for_each(parts.count, parts.compute);
  }

  // A step by its results, which visit(visitor, result) writes and reads as numbers where they have to leave the
  // process. `kind`, `ahead`, `together`: as of Parts.
  template <class Result, class Visit>
  std::vector<Result> results(const std::string& what, std::size_t count,
                              const std::function<Result(std::size_t)>& compute, const Visit& visit,
                              const std::string& kind = {}, const PartsAhead& ahead = {}, std::size_t together = 1) {
    const PartsOf parts = [&](const Parts& given) {
      Parts all = given;
      all.ahead = ahead;
      all.together = together;
      step(what, all);
    };
    return computed_parts<Result>(parts, count, compute, visit, kind);
  }

  // For those who only know steps.
  PartsOf of(std::string what) {
    return [this, what = std::move(what)](const Parts& parts) { step(what, parts); };
  }
};

}  // namespace hb

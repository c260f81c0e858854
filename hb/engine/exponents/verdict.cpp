#include "hb/engine/exponents/verdict.hpp"

namespace hb {

Verdict worst(std::span<const Verdict> verdicts) {
  Verdict result = Verdict::stable;
  for (const Verdict verdict : verdicts) result = worst(result, verdict);
  return result;
}

const char* to_string(Verdict verdict) {
  switch (verdict) {
    case Verdict::stable:
      return "stable";
    case Verdict::bounded:
      return "bounded";
    case Verdict::undecided:
      return "undecided";
    case Verdict::unstable:
      return "unstable";
  }
  return "";
}

}  // namespace hb

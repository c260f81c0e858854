#include "tools/attack/kept_references.hpp"

#include <array>
#include <exception>

namespace hb::attack {

namespace {

// Digits enough for 113 bits.
std::string text_of(Quad value) {
  std::array<char, 64> text{};
  quadmath_snprintf(text.data(), text.size(), "%.36Qe", value);
  return text.data();
}

}  // namespace

KeptReferences::KeptReferences(const std::string& file) {
  if (file.empty()) return;
  // family number count, then real part, imaginary part, error of each
  std::ifstream in(file);
  std::string family, re, im;
  std::uint64_t number = 0;
  std::size_t count = 0;
  while (in >> family >> number >> count) {
    std::vector<ReferenceExponent> exponents(count);
    for (ReferenceExponent& e : exponents) {
      in >> re >> im >> e.error;
      e.s = {strtoflt128(re.c_str(), nullptr), strtoflt128(im.c_str(), nullptr)};
    }
    if (in) known_[{family, number}] = std::move(exponents);  // not a last one that was cut off
  }
  file_.open(file, std::ios::app);
}

std::vector<ReferenceExponent> KeptReferences::of(Family family, std::uint64_t number, const Case& what) {
  const std::string name = names[std::size_t(family)];
  if (const auto found = known_.find({name, number}); found != known_.end()) return found->second;
  std::vector<ReferenceExponent> exponents;
  try {
    exponents = reference_exponents(what.system, what.speed);
  } catch (const std::exception&) {  // the sweeps do not settle, or too many steps
  }
  if (file_.is_open()) {
    file_ << name << ' ' << number << ' ' << exponents.size() << '\n';
    for (const ReferenceExponent& e : exponents)
      file_ << text_of(e.s.re) << ' ' << text_of(e.s.im) << ' ' << e.error << '\n';
    file_.flush();
  }
  return exponents;
}

}  // namespace hb::attack

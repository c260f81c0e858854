// The page's block of bytes: number columns and Fourier series for which decimal text would be too long. JSON refers to
// them as [byte offset, count] (columns) or [byte offset, [harmonics of each component]] (series); little endian.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>

#include "lib/fourier/fourier.hpp"

namespace hb::tools {

class ByteBlock {
 public:
  // NaN stands for "no number".
  [[nodiscard]] nlohmann::ordered_json doubles(std::span<const double> values);
  [[nodiscard]] nlohmann::ordered_json floats(std::span<const double> values);
  // Pairs (re, im) of c_0 .. c_H as floats, each component as far as its coefficients exceed `relative` of its largest.
  [[nodiscard]] nlohmann::ordered_json series(const FourierSeries& series, double relative = 1e-5);

  [[nodiscard]] std::string base64() const;

 private:
  template <class Number>
  void append(Number value);
  void align();  // to the start of the next double

  std::string bytes_;
};

}  // namespace hb::tools

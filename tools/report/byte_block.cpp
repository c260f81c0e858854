#include "tools/report/byte_block.hpp"

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>

#include "tools/output/json.hpp"
#include "tools/report/base64.hpp"

namespace hb::tools {
namespace {

// Beyond a float's range: no number, rather than infinity.
float as_float(double value) {
  return std::abs(value) <= std::numeric_limits<float>::max() ? static_cast<float>(value)
                                                              : std::numeric_limits<float>::quiet_NaN();
}

}  // namespace

template <class Number>
void ByteBlock::append(Number value) {
  using Bits = std::conditional_t<sizeof(Number) == 8, std::uint64_t, std::uint32_t>;
  const auto bits = std::bit_cast<Bits>(value);
  for (std::size_t k = 0; k < sizeof(Number); ++k) bytes_.push_back(static_cast<char>((bits >> (8 * k)) & 0xff));
}

void ByteBlock::align() { bytes_.resize((bytes_.size() + 7) / 8 * 8, '\0'); }

Json ByteBlock::doubles(std::span<const double> values) {
  align();
  const std::size_t offset = bytes_.size();
  for (const double value : values) append(value);
  return {offset, values.size()};
}

Json ByteBlock::floats(std::span<const double> values) {
  align();
  const std::size_t offset = bytes_.size();
  for (const double value : values) append(as_float(value));
  return {offset, values.size()};
}

Json ByteBlock::series(const FourierSeries& series, double relative) {
  align();
  const std::size_t offset = bytes_.size();
  Json harmonics = Json::array();
  for (Eigen::Index i = 0; i < series.num_components(); ++i) {
    Eigen::Index H = series.num_harmonics();
    const double largest = H >= 0 ? series.c.row(i).cwiseAbs().maxCoeff() : 0;
    while (H > 0 && std::abs(series.c(i, H)) <= relative * largest) --H;
    for (Eigen::Index n = 0; n <= H; ++n) {
      append(as_float(series.c(i, n).real()));
      append(as_float(series.c(i, n).imag()));
    }
    harmonics.push_back(H);
  }
  return {offset, std::move(harmonics)};
}

std::string ByteBlock::base64() const { return tools::base64(bytes_); }

}  // namespace hb::tools

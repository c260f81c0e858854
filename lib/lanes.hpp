// Numbers side by side, as many as a vector register of the machine holds: an operation serves them all.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wignored-attributes"  // of vector types as arguments of templates

namespace hb {

class Lanes {
  using Packet = Eigen::internal::packet_traits<double>::type;

 public:
  static constexpr Eigen::Index width = Eigen::internal::packet_traits<double>::size;
  using Values = std::array<double, static_cast<std::size_t>(width)>;

  Lanes() : Lanes(0.0) {}
  Lanes(double all) : packet_(Eigen::internal::pset1<Packet>(all)) {}  // NOLINT(google-explicit-constructor)

  // `width` numbers one after the other, wherever they begin.
  static Lanes load(const double* numbers) { return {Eigen::internal::ploadu<Packet>(numbers), Taken()}; }
  void store(double* numbers) const { Eigen::internal::pstoreu(numbers, packet_); }
  // value(lane) in each.
  template <class Value>
  static Lanes of(const Value& value) {
    Values values;
    for (std::size_t lane = 0; lane < values.size(); ++lane) values[lane] = value(static_cast<Eigen::Index>(lane));
    return load(values.data());
  }
  Values values() const {
    Values values;
    store(values.data());
    return values;
  }

  friend Lanes operator-(const Lanes& a) { return {Eigen::internal::pnegate(a.packet_), Taken()}; }
  friend Lanes operator+(const Lanes& a, const Lanes& b) {
    return {Eigen::internal::padd(a.packet_, b.packet_), Taken()};
  }
  friend Lanes operator-(const Lanes& a, const Lanes& b) {
    return {Eigen::internal::psub(a.packet_, b.packet_), Taken()};
  }
  friend Lanes operator*(const Lanes& a, const Lanes& b) {
    return {Eigen::internal::pmul(a.packet_, b.packet_), Taken()};
  }
  friend Lanes operator/(const Lanes& a, const Lanes& b) {
    return {Eigen::internal::pdiv(a.packet_, b.packet_), Taken()};
  }
  friend Lanes sqrt(const Lanes& a) { return {Eigen::internal::psqrt(a.packet_), Taken()}; }
  friend Lanes abs(const Lanes& a) { return {Eigen::internal::pabs(a.packet_), Taken()}; }
  // Of each lane the larger one; a where either is not a number.
  friend Lanes max(const Lanes& a, const Lanes& b) { return {Eigen::internal::pmax(a.packet_, b.packet_), Taken()}; }
  Lanes& operator+=(const Lanes& b) { return *this = *this + b; }
  Lanes& operator-=(const Lanes& b) { return *this = *this - b; }
  Lanes& operator*=(const Lanes& b) { return *this = *this * b; }

  // Of `width` rows.
  friend void transpose(Lanes* rows) {
    Eigen::internal::PacketBlock<Packet, static_cast<int>(width)> block;
    for (Eigen::Index i = 0; i < width; ++i) block.packet[i] = rows[i].packet_;
    Eigen::internal::ptranspose(block);
    for (Eigen::Index i = 0; i < width; ++i) rows[i].packet_ = block.packet[i];
  }

 private:
  struct Taken {};
  Lanes(Packet packet, Taken) : packet_(packet) {}

  Packet packet_;
};

}  // namespace hb

#pragma GCC diagnostic pop

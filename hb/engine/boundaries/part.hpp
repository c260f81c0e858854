// Results as lists of numbers, so that a part of long work can be kept in a file or come from another process.
#pragma once

#include <complex>
#include <cstddef>
#include <functional>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "hb/engine/boundaries/interval_search.hpp"

namespace hb {

using Part = std::vector<double>;

// Parts to come, by their kind and about how many: those of one kind take alike.
using PartsAhead = std::vector<std::pair<std::string, double>>;

// The parts of one step. They may be computed in any order and by several threads, each once, or be taken from
// elsewhere: each depends on its index alone.
struct Parts {
  std::size_t count = 0;
  std::function<void(std::size_t)> compute;
  std::function<Part(std::size_t)> numbers;  // of a part that is there
  std::function<void(std::size_t, const Part&)> take;  // instead of computing it; throws std::out_of_range
  std::string kind = {};  // for who says beforehand how long it takes; empty: like no others
  PartsAhead ahead = {};  // after this step
  std::size_t together = 1;  // so many, from the first on, share work
};

// Has all parts computed or taken.
using PartsOf = std::function<void(const Parts&)>;

// Calls task(0) .. task(count - 1), perhaps from several threads: what is too short to be kept or sent elsewhere.
// Empty: one after the other.
using ForEach = std::function<void(std::size_t count, const std::function<void(std::size_t)>& task)>;

inline void do_each(const ForEach& for_each, std::size_t count, const std::function<void(std::size_t)>& task) {
  if (for_each) return for_each(count, task);
  for (std::size_t k = 0; k < count; ++k) task(k);
}

// Writes numbers one after the other, reads them in the same order. One function for both directions keeps them alike.
class PartWriter {
 public:
  void operator()(double& value) { numbers.push_back(value); }
  Part numbers;
};

class PartReader {
 public:
  explicit PartReader(const Part& numbers) : numbers_(numbers) {}
  void operator()(double& value) {
    if (next_ == numbers_.size()) throw std::out_of_range("part of a result: too short");
    value = numbers_[next_++];
  }
  bool at_end() const { return next_ == numbers_.size(); }

 private:
  const Part& numbers_;
  std::size_t next_ = 0;
};

template <class Visit, class Number>
void visit_as_number(Visit& visit, Number& value) {
  auto number = static_cast<double>(value);
  visit(number);
  value = static_cast<Number>(number);
}

template <class Visit>
void visit_complex(Visit& visit, std::complex<double>& value) {
  double re = value.real(), im = value.imag();
  visit(re);
  visit(im);
  value = {re, im};
}

// The size, then each element by `each`.
template <class Visit, class Container, class Each>
void visit_elements(Visit& visit, Container& container, Each&& each) {
  auto size = static_cast<double>(container.size());
  visit(size);
  if (!(size >= 0 && size <= 1e6)) throw std::out_of_range("part of a result: a list of impossible size");
  container.resize(static_cast<std::size_t>(size));
  for (auto& element : container) each(element);
}

template <class Visit, class Value, class Each>
void visit_if_there(Visit& visit, std::optional<Value>& value, Each&& each) {
  double there = value ? 1 : 0;
  visit(there);
  if (there == 0) {
    value.reset();
  } else {
    if (!value) value.emplace();
    each(*value);
  }
}

// Without what was done to get it (method, kept modes, evidence).
template <class Visit>
void visit_sample(Visit& visit, StabilitySample& sample) {
  Stability& stability = sample.stability;
  visit(sample.x);
  visit(sample.speed);
  for (std::vector<Exponent>* list : {&stability.exponents, &stability.uncertain}) {
    visit_elements(visit, *list, [&](Exponent& exponent) {
      visit_complex(visit, exponent.value);
      visit(exponent.error);
      visit_as_number(visit, exponent.mode);
      visit(exponent.frequency);
    });
  }
  visit_elements(visit, sample.mean, [&](MeanExponent& exponent) {
    visit_complex(visit, exponent.value);
    visit(exponent.coupling);
    visit(exponent.modulation);
    visit(exponent.drift);
    visit(exponent.frozen);
  });
  visit(sample.growth_bound);
  visit(stability.growth_rate);
  visit(stability.growth_error);
  visit(stability.growth_low);
  visit(stability.growth_high);
  visit(stability.others_below);
  visit_as_number(visit, stability.verdict);
  visit_as_number(visit, stability.converged);
}

template <class Visit>
void visit_boundary(Visit& visit, StabilityBoundary& boundary) {
  visit(boundary.x);
  visit(boundary.error);
  visit_as_number(visit, boundary.kind);
  visit_as_number(visit, boundary.unstable_above);
  visit_as_number(visit, boundary.converged);
}

template <class Visit>
void visit_interval(Visit& visit, SearchedInterval& interval) {
  visit_elements(visit, interval.boundaries, [&](StabilityBoundary& boundary) { visit_boundary(visit, boundary); });
  visit_elements(visit, interval.samples, [&](StabilitySample& sample) { visit_sample(visit, sample); });
  visit_elements(visit, interval.not_excluded, [&](std::array<double, 2>& piece) {
    visit(piece[0]);
    visit(piece[1]);
  });
  visit_as_number(visit, interval.evaluations);
}

// part(0) .. part(count - 1) by `parts` (empty: one after the other) of results that visit(visitor, result) writes and
// reads as numbers.
template <class Result, class Visit>
std::vector<Result> computed_parts(const PartsOf& parts, std::size_t count,
                                   const std::function<Result(std::size_t)>& compute, const Visit& visit,
                                   const std::string& kind = {}) {
  static_assert(!std::is_same_v<Result, bool>, "elements of a vector of bool share bytes");
  std::vector<Result> found(count);
  const auto result = [&](std::size_t k) { found[k] = compute(k); };
  if (!parts) {
    for (std::size_t k = 0; k < count; ++k) result(k);
    return found;
  }
  const auto numbers = [&](std::size_t k) {
    PartWriter writer;
    visit(writer, found[k]);
    return std::move(writer.numbers);
  };
  const auto take = [&](std::size_t k, const Part& known) {
    PartReader reader(known);
    Result read{};
    visit(reader, read);
    found[k] = std::move(read);
  };
  parts({count, result, numbers, take, kind, {}});
  return found;
}

// Results of things, in their order; of those with one key one is computed.
template <class Result, class Key, class Compute, class Visit>
std::vector<Result> shared_parts(const PartsOf& parts, const std::vector<std::size_t>& things, const Key& key_of,
                                 const Compute& compute, const Visit& visit, const std::string& kind = {}) {
  std::map<decltype(key_of(std::size_t{})), std::size_t> number_of_key;
  std::vector<std::size_t> computed, number;
  for (const std::size_t thing : things) {
    const auto [place, is_new] = number_of_key.emplace(key_of(thing), computed.size());
    if (is_new) computed.push_back(thing);
    number.push_back(place->second);
  }
  const std::vector<Result> found = computed_parts<Result>(
      parts, computed.size(), [&](std::size_t k) { return compute(computed[k]); }, visit, kind);
  std::vector<Result> all;
  for (const std::size_t k : number) all.push_back(found[k]);
  return all;
}

}  // namespace hb

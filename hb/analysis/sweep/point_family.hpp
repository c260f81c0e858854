// Neighbouring points of a sweep share work: a few of each block of points are solved from nothing, a few more begin
// roughly with what polynomials through these foretell, all others with what those through both do. Each point depends
// on the sweep's values alone, so that neither threads nor the order in which points are asked for matter.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "hb/analysis/sweep/sweep_point.hpp"

namespace hb {

class PointFamily {
 public:
  // The scene and its values have to stay.
  PointFamily(const SweepScene& scene, const Only& only);

  // Of values[k]; may be asked by several threads at once.
  [[nodiscard]] SweepPoint at(std::size_t k);
  // Points of a block: they share work, and what they share is kept until all were asked for. 1 where there is nothing
  // to share: slaving serves all exponents of several modes.
  [[nodiscard]] std::size_t block_size() const { return block_size_; }

 private:
  struct Node {
    enum class State { untouched, under_way, there };
    State state = State::untouched;
    SweepPoint point;
    PointSolution solution;
  };
  struct Block {
    std::vector<std::size_t> places;  // of the nodes among all values, ascending
    std::vector<Node> nodes;
    std::vector<std::size_t> coarse, fine;  // nodes solved from nothing, and those that begin with what these foretell
    std::size_t left = 0;  // points that were not asked for yet
  };

  [[nodiscard]] std::shared_ptr<Block> block_of(std::size_t k);
  // Has these nodes of the block solved, by this thread or by others; `begun`: after the coarse ones, from these.
  void solve(Block& block, std::span<const std::size_t> which, bool begun);
  // By these nodes.
  [[nodiscard]] PointSolution foretold(const Block& block, std::span<const std::size_t> by, double x) const;

  const SweepScene& scene_;
  const Only only_;
  const std::vector<double>& values_;
  std::size_t block_size_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<std::shared_ptr<Block>> blocks_;
};

}  // namespace hb

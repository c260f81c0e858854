#include "hb/analysis/sweep/point_family.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include "lib/lanes.hpp"

namespace hb {
namespace {

// Nodes of a block, every fourth point of a full one, and those of them that are solved from nothing.
constexpr std::size_t num_nodes = 8, num_coarse = 4, most_points = 4 * (num_nodes - 1) + 1;
// Fewer points are all nodes.
constexpr std::size_t fewest_points = 12;

// Numbers at x from those at the nodes: sum_j w_j f_j; what leaving out the farthest node changes, sum_j d_j f_j, tells
// how good that is.
struct Weights {
  std::vector<double> w, d;
  std::size_t above = 0;  // first node beyond x
};

// Lagrange: w_j = prod_(i != j) (x - x_i)/(x_j - x_i), without `left_out`.
std::vector<double> lagrange(const std::vector<double>& nodes, double x, std::size_t left_out) {
  std::vector<double> w(nodes.size(), 0);
  for (std::size_t j = 0; j < nodes.size(); ++j) {
    if (j == left_out) continue;
    w[j] = 1;
    for (std::size_t i = 0; i < nodes.size(); ++i)
      if (i != j && i != left_out) w[j] *= (x - nodes[i]) / (nodes[j] - nodes[i]);
  }
  return w;
}

Weights weights(const std::vector<double>& nodes, double x) {
  const std::size_t farthest = std::abs(x - nodes.front()) > std::abs(x - nodes.back()) ? 0 : nodes.size() - 1;
  Weights weights{lagrange(nodes, x, nodes.size()), lagrange(nodes, x, farthest),
                  static_cast<std::size_t>(std::ranges::upper_bound(nodes, x) - nodes.begin())};
  weights.above = std::clamp<std::size_t>(weights.above, 1, nodes.size() - 1);
  for (std::size_t j = 0; j < nodes.size(); ++j) weights.d[j] = weights.w[j] - weights.d[j];
  return weights;
}

// No solution where the nodes do not agree on the number of harmonics, or foretell nothing; a rough one where
// corrections with twice the samples would not be few.
SlavingStart interpolated(const Weights& weights, const std::vector<const SlavingStart*>& nodes) {
  constexpr double near = 1e-4, rough = 0.1;
  const Eigen::Index size = nodes.front()->solution.size();
  SlavingStart start;
  start.modes = nodes.front()->modes;
  start.diverges = nodes[weights.above - 1]->diverges && nodes[weights.above]->diverges;
  for (const SlavingStart* node : nodes) {
    if (size < Lanes::width || node->solution.size() != size || node->modes != nodes.front()->modes) return start;
    start.amplification = std::max(start.amplification, node->amplification);
    start.change = std::max(start.change, node->change);
  }
  Eigen::VectorXd solution(size);
  Lanes largest, doubt;
  // Sums of as many registers as there are k, from `first` on.
  const auto sums = [&]<std::size_t... k>(std::index_sequence<k...>, Eigen::Index first) {
    std::array<Lanes, sizeof...(k)> sum, change;
    const auto add = [](const Lanes& w, const Lanes& d, const Lanes& x, Lanes& its_sum, Lanes& its_change) {
      its_sum += w * x;
      its_change += d * x;
    };
    for (std::size_t j = 0; j < nodes.size(); ++j) {
      const double* numbers = nodes[j]->solution.data() + first;
      (add(weights.w[j], weights.d[j], Lanes::load(numbers + Lanes::width * Eigen::Index(k)), sum[k], change[k]), ...);
    }
    ((largest = max(largest, abs(sum[k])), doubt = max(doubt, abs(change[k])),
      sum[k].store(solution.data() + first + Lanes::width * Eigen::Index(k))),
     ...);
  };
  constexpr Eigen::Index together = 4 * Lanes::width;
  Eigen::Index first = 0;
  for (; first + together <= size; first += together) sums(std::make_index_sequence<4>(), first);
  // The last ones over what stands before them where fewer numbers are left.
  for (; first < size; first += Lanes::width) sums(std::make_index_sequence<1>(), std::min(first, size - Lanes::width));
  const double off = std::ranges::max(doubt.values()), size_of_all = std::ranges::max(largest.values());
  if (!(off <= rough * size_of_all && solution.allFinite())) return start;
  start.rough = !(off <= near * size_of_all);
  start.solution = std::move(solution);
  return start;
}

// What others are measured by is solved for, however near its start, and where the coarse ones diverge, too.
PointSolution roughly(PointSolution start) {
  for (auto& rod : start)
    for (SlavingStart& mode : rod) {
      mode.rough = true;
      mode.diverges = false;
    }
  return start;
}

}  // namespace

PointFamily::PointFamily(const SweepScene& scene, const Only& only)
    : scene_(scene), only_(only), values_(scene.axis().values) {
  const bool shares = only.all_exponents() && std::ranges::any_of(scene.first().rods, [](const RodModel& rod) {
                        return rod.system.num_modes() > 1;
                      });
  const std::size_t count = values_.size(), most = shares ? most_points : 1, blocks = (count + most - 1) / most;
  block_size_ = (count + blocks - 1) / blocks;
  blocks_.resize((count + block_size_ - 1) / block_size_);
}

SweepPoint PointFamily::at(std::size_t k) {
  if (block_size_ == 1) return analyse_point(scene_, values_[k], only_);
  const std::shared_ptr<Block> block = block_of(k);
  const auto place = std::ranges::find(block->places, k);
  SweepPoint point;
  if (place != block->places.end()) {
    const auto n = static_cast<std::size_t>(place - block->places.begin());
    const bool begun = std::ranges::find(block->coarse, n) == block->coarse.end();
    if (begun) solve(*block, block->coarse, false);
    solve(*block, std::span(&n, 1), begun);
    point = block->nodes[n].point;
  } else {
    solve(*block, block->coarse, false);
    solve(*block, block->fine, true);
    std::vector<std::size_t> all(block->nodes.size());
    std::iota(all.begin(), all.end(), std::size_t(0));
    const PointSolution start = foretold(*block, all, values_[k]);
    point = analyse_point(scene_, values_[k], only_, {.start = &start});
  }
  const std::lock_guard lock(mutex_);
  if (--block->left == 0) blocks_[k / block_size_].reset();
  return point;
}

std::shared_ptr<PointFamily::Block> PointFamily::block_of(std::size_t k) {
  const std::lock_guard lock(mutex_);
  std::shared_ptr<Block>& block = blocks_[k / block_size_];
  if (block) return block;
  block = std::make_shared<Block>();
  const std::size_t first = k / block_size_ * block_size_, size = std::min(block_size_, values_.size() - first);
  block->left = size;
  const std::size_t count = size < fewest_points ? size : num_nodes;
  for (std::size_t j = 0; j < count; ++j)
    block->places.push_back(first + (count > 1 ? (j * (size - 1) + (count - 1) / 2) / (count - 1) : 0));
  block->nodes.resize(count);
  for (std::size_t j = 0, next = 0; j < count; ++j) {
    const bool coarse = count < num_nodes || j == (next * (count - 1) + num_coarse / 2) / (num_coarse - 1);
    if (coarse) ++next;
    (coarse ? block->coarse : block->fine).push_back(j);
  }
  return block;
}

void PointFamily::solve(Block& block, std::span<const std::size_t> which, bool begun) {
  std::unique_lock lock(mutex_);
  const auto is = [&block](Node::State state) {
    return [&block, state](std::size_t n) { return block.nodes[n].state == state; };
  };
  for (;;) {
    const auto next = std::ranges::find_if(which, is(Node::State::untouched));
    if (next == which.end()) {
      if (std::ranges::all_of(which, is(Node::State::there))) return;
      changed_.wait(lock);
      continue;
    }
    Node* const node = &block.nodes[*next];
    node->state = Node::State::under_way;
    const double x = values_[block.places[*next]];
    lock.unlock();
    PointSolution solution;
    try {
      PointSolution start;
      if (begun) start = roughly(foretold(block, block.coarse, x));
      node->point = analyse_point(scene_, x, only_, {.start = begun ? &start : nullptr, .solution = &solution});
    } catch (...) {
      lock.lock();
      node->state = Node::State::untouched;
      changed_.notify_all();
      throw;
    }
    lock.lock();
    node->solution = std::move(solution);
    node->state = Node::State::there;
    changed_.notify_all();
  }
}

PointSolution PointFamily::foretold(const Block& block, std::span<const std::size_t> by, double x) const {
  std::vector<double> places;
  std::size_t rods = block.nodes[by.front()].solution.size();
  for (const std::size_t j : by) {
    places.push_back(values_[block.places[j]]);
    rods = std::min(rods, block.nodes[j].solution.size());
  }
  const Weights weighted = weights(places, x);
  PointSolution start(rods);
  for (std::size_t r = 0; r < rods; ++r) {
    std::size_t modes = block.nodes[by.front()].solution[r].size();
    for (const std::size_t j : by) modes = std::min(modes, block.nodes[j].solution[r].size());
    for (std::size_t g = 0; g < modes; ++g) {
      std::vector<const SlavingStart*> nodes;
      for (const std::size_t j : by) nodes.push_back(&block.nodes[j].solution[r][g]);
      start[r].push_back(interpolated(weighted, nodes));
    }
  }
  return start;
}

}  // namespace hb

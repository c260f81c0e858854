#include "hb/analysis/sweep/point_family.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "lib/lanes.hpp"

namespace hb {
namespace {

// Nodes of a block, every fourth point of a full one.
constexpr std::size_t num_nodes = 8, most_points = 4 * (num_nodes - 1) + 1;
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
  for (std::size_t j = 0; j < nodes.size(); ++j) weights.d[j] = weights.w[j] - weights.d[j];
  return weights;
}

// No solution where the nodes do not agree on the number of harmonics, or foretell too little: corrections with twice
// the samples have to be few.
SlavingStart interpolated(const Weights& weights, const std::vector<const SlavingStart*>& nodes) {
  constexpr double foretold = 1e-4;
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
  for (; first < size; first += Lanes::width)
    sums(std::make_index_sequence<1>(), std::min(first, size - Lanes::width));
  const bool near = std::ranges::max(doubt.values()) <= foretold * std::ranges::max(largest.values());
  if (near && solution.allFinite()) start.solution = std::move(solution);
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
    solve(*block, n, 1);
    point = block->nodes[n].point;
  } else {
    solve(*block, 0, block->nodes.size());
    const PointSolution start = foretold(*block, values_[k]);
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
  return block;
}

void PointFamily::solve(Block& block, std::size_t first, std::size_t count) {
  std::unique_lock lock(mutex_);
  const auto begin = block.nodes.begin() + static_cast<std::ptrdiff_t>(first),
             end = begin + static_cast<std::ptrdiff_t>(count);
  for (;;) {
    const auto node = std::find_if(begin, end, [](const Node& n) { return n.state == Node::State::untouched; });
    if (node == end) {
      if (std::all_of(begin, end, [](const Node& n) { return n.state == Node::State::there; })) return;
      changed_.wait(lock);
      continue;
    }
    node->state = Node::State::under_way;
    const std::size_t k = block.places[static_cast<std::size_t>(node - block.nodes.begin())];
    lock.unlock();
    PointSolution solution;
    try {
      node->point = analyse_point(scene_, values_[k], only_, {.solution = &solution});
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

PointSolution PointFamily::foretold(const Block& block, double x) const {
  std::vector<double> places;
  std::size_t rods = block.nodes.front().solution.size();
  for (std::size_t j = 0; j < block.nodes.size(); ++j) {
    places.push_back(values_[block.places[j]]);
    rods = std::min(rods, block.nodes[j].solution.size());
  }
  const Weights by = weights(places, x);
  PointSolution start(rods);
  for (std::size_t r = 0; r < rods; ++r) {
    std::size_t modes = block.nodes.front().solution[r].size();
    for (const Node& node : block.nodes) modes = std::min(modes, node.solution[r].size());
    for (std::size_t g = 0; g < modes; ++g) {
      std::vector<const SlavingStart*> nodes;
      for (const Node& node : block.nodes) nodes.push_back(&node.solution[r][g]);
      start[r].push_back(interpolated(by, nodes));
    }
  }
  return start;
}

}  // namespace hb

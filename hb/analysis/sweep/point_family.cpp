#include "hb/analysis/sweep/point_family.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <span>

namespace hb {
namespace {

// Nodes of a block that are solved from nothing, every fourth point of a full one.
constexpr std::size_t num_nodes = 8, most_points = 4 * (num_nodes - 1) + 1;
// Fewer points are all nodes.
constexpr std::size_t fewest_points = 12;
// Of a polynomial.
constexpr std::size_t most_places = 8, fewest_places = 4;

// Numbers at x from those at the nodes: sum_j w_j f_j; what leaving out the farthest node changes, sum_j d_j f_j, tells
// how good that is.
struct Weights {
  std::vector<double> w, d;
};

// Lagrange: w_j = prod_(i != j) (x - x_i)/(x_j - x_i), without `left_out`.
std::vector<double> lagrange(std::span<const double> nodes, double x, std::size_t left_out) {
  std::vector<double> w(nodes.size(), 0);
  for (std::size_t j = 0; j < nodes.size(); ++j) {
    if (j == left_out) continue;
    w[j] = 1;
    for (std::size_t i = 0; i < nodes.size(); ++i)
      if (i != j && i != left_out) w[j] *= (x - nodes[i]) / (nodes[j] - nodes[i]);
  }
  return w;
}

Weights weights(std::span<const double> nodes, double x) {
  const std::size_t farthest = std::abs(x - nodes.front()) > std::abs(x - nodes.back()) ? 0 : nodes.size() - 1;
  Weights weights{lagrange(nodes, x, nodes.size()), lagrange(nodes, x, farthest)};
  for (std::size_t j = 0; j < nodes.size(); ++j) weights.d[j] = weights.w[j] - weights.d[j];
  return weights;
}

struct KnownStart {
  double x;
  const SlavingStart* start;
};

// The nearest of `known`, ascending, that are alike: slaved to the same modes, with as many harmonics. Fewer than two
// where the neighbours of x are not.
std::span<const KnownStart> alike_beside(std::span<const KnownStart> known, double x) {
  const auto above = static_cast<std::size_t>(std::ranges::upper_bound(known, x, {}, &KnownStart::x) - known.begin());
  const SlavingStart& below = *known[above - 1].start;
  const auto alike = [&](const KnownStart& node) {
    return node.start->solution.size() == below.solution.size() && node.start->modes == below.modes;
  };
  if (below.solution.size() == 0 || !alike(known[above])) return {};
  std::size_t first = above - 1, last = above + 1;
  while (last - first < most_places) {
    const bool down = first > 0 && alike(known[first - 1]), up = last < known.size() && alike(known[last]);
    if (!down && !up) break;
    if (down && (!up || x - known[first - 1].x <= known[last].x - x))
      --first;
    else
      ++last;
  }
  return known.subspan(first, last - first);
}

// No solution where the nodes foretell too little: corrections with twice the samples have to be few.
SlavingStart interpolated(std::span<const KnownStart> known, double x) {
  constexpr double foretold = 1e-4;
  const auto above = std::ranges::upper_bound(known, x, {}, &KnownStart::x);
  SlavingStart start;
  start.modes = above->start->modes;
  start.diverges = std::prev(above)->start->diverges && above->start->diverges;
  const std::span<const KnownStart> nodes = alike_beside(known, x);
  if (nodes.size() < fewest_places) return start;
  std::vector<double> places;
  for (const KnownStart& node : nodes) places.push_back(node.x);
  const Weights by = weights(places, x);
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(nodes.front().start->solution.size()), doubt = sum;
  for (std::size_t j = 0; j < nodes.size(); ++j) {
    const SlavingStart& node = *nodes[j].start;
    sum += by.w[j] * node.solution;
    doubt += by.d[j] * node.solution;
    start.amplification = std::max(start.amplification, node.amplification);
    start.change = std::max(start.change, node.change);
  }
  if (doubt.cwiseAbs().maxCoeff() <= foretold * sum.cwiseAbs().maxCoeff()) start.solution = std::move(sum);
  return start;
}

// Changes that the next ones may have: no larger ones from level to level.
void keep_changes(PointSolution& solution, const PointSolution& start) {
  for (std::size_t r = 0; r < std::min(solution.size(), start.size()); ++r)
    for (std::size_t g = 0; g < std::min(solution[r].size(), start[r].size()); ++g)
      if (start[r][g].solution.size() > 0) solution[r][g].change = std::min(solution[r][g].change, start[r][g].change);
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
  const std::shared_ptr<Block> block = block_of(k);
  SweepPoint point;
  bool is_node = false;
  for (std::size_t level = 0; level < block->levels.size() && !is_node; ++level) {
    const std::vector<Node>& nodes = block->levels[level];
    const auto node = std::ranges::find(nodes, k, &Node::place);
    is_node = node != nodes.end();
    solve(*block, level, is_node ? static_cast<std::size_t>(node - nodes.begin()) : 0, is_node ? 1 : nodes.size());
    if (is_node) point = node->point;
  }
  if (!is_node) {
    const PointSolution start = foretold(*block, block->levels.size(), values_[k]);
    point = analyse_point(scene_, values_[k], only_, &start);
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
  const auto node_at = [](std::size_t place) {
    Node node;
    node.place = place;
    return node;
  };
  auto& [from_nothing, half_way] = block->levels;
  for (std::size_t j = 0; j < count; ++j)
    from_nothing.push_back(node_at(first + (count > 1 ? (j * (size - 1) + (count - 1) / 2) / (count - 1) : 0)));
  for (std::size_t j = 0; j + 1 < count; ++j)
    if (const std::size_t a = from_nothing[j].place, b = from_nothing[j + 1].place; b - a > 2)
      half_way.push_back(node_at((a + b) / 2));
  return block;
}

void PointFamily::solve(Block& block, std::size_t level, std::size_t first, std::size_t count) {
  std::unique_lock lock(mutex_);
  const auto begin = block.levels[level].begin() + static_cast<std::ptrdiff_t>(first),
             end = begin + static_cast<std::ptrdiff_t>(count);
  for (;;) {
    const auto node = std::find_if(begin, end, [](const Node& n) { return n.state == Node::State::untouched; });
    if (node == end) {
      if (std::all_of(begin, end, [](const Node& n) { return n.state == Node::State::there; })) return;
      changed_.wait(lock);
      continue;
    }
    node->state = Node::State::under_way;
    const double x = values_[node->place];
    lock.unlock();
    PointSolution solution;
    try {
      const PointSolution start = level > 0 ? foretold(block, level, x) : PointSolution();
      node->point = analyse_point(scene_, x, only_, &start, &solution);
      keep_changes(solution, start);
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

PointSolution PointFamily::foretold(const Block& block, std::size_t levels, double x) const {
  std::vector<const Node*> nodes;
  for (std::size_t level = 0; level < levels; ++level)
    for (const Node& node : block.levels[level]) nodes.push_back(&node);
  std::ranges::sort(nodes, {}, &Node::place);
  const auto least = [&](const auto& size) {
    return size(**std::ranges::min_element(nodes, {}, [&](const Node* node) { return size(*node); }));
  };
  PointSolution start(least([](const Node& node) { return node.solution.size(); }));
  std::vector<KnownStart> known(nodes.size());
  for (std::size_t r = 0; r < start.size(); ++r) {
    const std::size_t modes = least([r](const Node& node) { return node.solution[r].size(); });
    for (std::size_t g = 0; g < modes; ++g) {
      std::ranges::transform(nodes, known.begin(), [&](const Node* node) {
        return KnownStart{values_[node->place], &node->solution[r][g]};
      });
      start[r].push_back(interpolated(known, x));
    }
  }
  return start;
}

}  // namespace hb

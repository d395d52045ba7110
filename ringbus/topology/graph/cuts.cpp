#include "ringbus/topology/graph/cuts.h"

#include <algorithm>
#include <bit>
#include <utility>

namespace carousel::ringbus {

namespace {

using config::Graph;

constexpr std::size_t kExact = 20;  // nodes
constexpr std::uint32_t kStarts = 16;

struct Neighbour {
  std::uint32_t node;
  std::int64_t bytes;
};
using Neighbours = std::vector<std::vector<Neighbour>>;

/// A graph in two parts, and the bytes between them.
class Halves {
 public:
  explicit Halves(const Graph& graph) : neighbours_(graph.nodes.size()), resources_(graph.resources) {
    for (const Graph::Link& link : graph.links) {
      neighbours_[link.from].push_back({link.to, link.bytes_per_cycle});
      neighbours_[link.to].push_back({link.from, link.bytes_per_cycle});
    }
    sides_.resize(graph.nodes.size());
  }

  std::int64_t bytes() const { return bytes_; }
  const std::vector<bool>& sides() const { return sides_; }
  /// By how much the cut gets narrower if the node changes sides.
  std::int64_t gain(std::uint32_t node) const {
    std::int64_t sum = 0;
    for (const Neighbour& other : neighbours_[node])
      sum += sides_[other.node] != sides_[node] ? other.bytes : -other.bytes;
    return sum;
  }
  void flip(std::uint32_t node) {
    bytes_ -= gain(node);
    sides_[node] = !sides_[node];
  }
  std::int64_t between(std::uint32_t a, std::uint32_t b) const {
    std::int64_t sum = 0;
    for (const Neighbour& other : neighbours_[a])
      if (other.node == b) sum += other.bytes;
    return sum;
  }
  /// The first half of the resources that a search in breadth from a node meets on one side, all else on the other.
  void begin_at(std::uint32_t start) {
    std::fill(sides_.begin(), sides_.end(), true);
    std::vector<std::uint32_t> open{start};
    std::vector<bool> seen(sides_.size());
    seen[start] = true;
    std::uint32_t taken = 0;
    for (std::size_t i = 0; i < open.size() && taken < resources_ / 2; ++i) {
      sides_[open[i]] = false;
      if (open[i] < resources_) ++taken;
      for (const Neighbour& next : neighbours_[open[i]])
        if (!seen[next.node]) {
          seen[next.node] = true;
          open.push_back(next.node);
        }
    }
    count();
  }
  void begin_by_number() {
    for (std::uint32_t node = 0; node < sides_.size(); ++node) sides_[node] = node >= resources_ / 2;
    count();
  }
  /// Changes sides as long as that narrows the cut.
  void narrow() {
    while (move_router() || swap_pair()) {
    }
  }

 private:
  void count() {
    bytes_ = 0;
    for (std::uint32_t node = 0; node < sides_.size(); ++node)
      for (const Neighbour& other : neighbours_[node])
        if (other.node > node && sides_[other.node] != sides_[node]) bytes_ += other.bytes;
  }
  bool move_router() {
    for (std::uint32_t node = resources_; node < sides_.size(); ++node)
      if (gain(node) > 0) {
        flip(node);
        return true;
      }
    return false;
  }
  bool swap_pair() {
    std::vector<std::int64_t> gains;
    for (std::uint32_t node = 0; node < resources_; ++node) gains.push_back(gain(node));
    std::pair<std::uint32_t, std::uint32_t> best;
    std::int64_t most = 0;
    for (std::uint32_t a = 0; a < resources_; ++a)
      for (std::uint32_t b = a + 1; b < resources_; ++b)
        if (sides_[a] != sides_[b] && gains[a] + gains[b] > most)
          if (const std::int64_t both = gains[a] + gains[b] - 2 * between(a, b); both > most) {
            most = both;
            best = {a, b};
          }
    if (most == 0) return false;
    flip(best.first);
    flip(best.second);
    return true;
  }

  Neighbours neighbours_;
  std::uint32_t resources_;
  std::vector<bool> sides_;  // by node
  std::int64_t bytes_ = 0;
};

/// Tries all halves, each a node away from the one before (Gray's code). The last node stays on its side.
std::vector<bool> best_of_all(Halves& halves, std::uint32_t resources) {
  const std::size_t nodes = halves.sides().size();
  std::vector<bool> best;
  std::int64_t least = 0;
  std::uint32_t there = 0;  // resources on the other side
  for (std::uint64_t i = 1;; ++i) {
    if (there == resources / 2 || there == resources - resources / 2)
      if (best.empty() || halves.bytes() < least) {
        best = halves.sides();
        least = halves.bytes();
      }
    const auto node = static_cast<std::uint32_t>(std::countr_zero(i));
    if (node + 1 >= nodes) return best;
    halves.flip(node);
    if (node < resources) there += halves.sides()[node] ? 1u : ~0u;
  }
}

}  // namespace

Cut narrowest_halves(const Graph& graph) {
  Cut cut;
  if (graph.resources < 2) return cut;
  Halves halves(graph);
  std::vector<bool> best;
  if (graph.nodes.size() <= kExact) {
    best = best_of_all(halves, graph.resources);
  } else {
    cut.exact = false;
    std::int64_t least = 0;
    for (std::uint32_t start = 0; start <= std::min(kStarts, graph.resources); ++start) {
      if (start == 0)
        halves.begin_by_number();
      else
        halves.begin_at((start - 1) * graph.resources / std::min(kStarts, graph.resources));
      halves.narrow();
      if (!best.empty() && halves.bytes() >= least) continue;
      best = halves.sides();
      least = halves.bytes();
    }
  }
  for (std::uint32_t link = 0; link < graph.links.size(); ++link) {
    if (best[graph.links[link].from] == best[graph.links[link].to]) continue;
    cut.links.push_back(link);
    cut.bytes_per_cycle += static_cast<std::uint64_t>(graph.links[link].bytes_per_cycle);
  }
  return cut;
}

}  // namespace carousel::ringbus

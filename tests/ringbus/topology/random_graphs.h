#pragma once

#include <cstdint>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

namespace carousel::ringbus::graph_test {

/// A random connected graph of 8 to 32 nodes with two to four links each, as those of the data of BookSim2
/// (tests/data/README.md) were drawn: a tree, then a link for each leaf, then a few more.
class RandomGraph {
 public:
  explicit RandomGraph(std::uint64_t seed) : x_(seed) {
    const std::uint64_t n = 8 + draw(25);
    links_of_.resize(n);
    for (std::uint64_t i = 1; i < n; ++i) {
      std::uint64_t p = draw(i);
      while (links_of_[p] == 3) p = draw(i);
      add(p, i);
    }
    for (std::uint64_t i = 0; i < n; ++i) {
      if (links_of_[i] != 1) continue;
      std::uint64_t j = draw(n);
      while (j == i || linked(i, j) || links_of_[j] == 4) j = draw(n);
      add(i, j);
    }
    for (std::uint64_t more = draw(n / 2 + 1); more > 0; --more) {
      const std::uint64_t a = draw(n), b = draw(n);
      if (a != b && !linked(a, b) && links_of_[a] < 4 && links_of_[b] < 4) add(a, b);
    }
  }

  std::size_t nodes() const { return links_of_.size(); }
  /// The lists `nodes` and `links` of a configuration. The last nodes are as many routers, which have the keys given.
  std::string text(std::size_t routers = 0, const std::string& keys = "") const {
    const std::size_t resources = nodes() - routers;
    std::string out = fmt::format("  nodes:\n    - {{name: r, count: {}}}\n", resources);
    if (routers > 0) out += fmt::format("    - {{name: x, kind: router, count: {}{}}}\n", routers, keys);
    out += "  links:\n";
    const auto name = [&](std::uint64_t node) {
      return node < resources ? fmt::format("r[{}]", node) : fmt::format("x[{}]", node - resources);
    };
    for (const Link& link : links_)
      out += fmt::format("    - {{from: '{}', to: '{}', latency_cycles: {}, both: true}}\n", name(link.from),
                         name(link.to), link.latency);
    return out;
  }
  std::uint64_t draw(std::uint64_t many) {
    x_ = 6364136223846793005ull * x_ + 1442695040888963407ull;
    return (x_ >> 33) % many;
  }

  struct Link {
    std::uint64_t from, to, latency;
  };
  const std::vector<Link>& links() const { return links_; }

 private:
  bool linked(std::uint64_t a, std::uint64_t b) const { return ends_.contains({std::min(a, b), std::max(a, b)}); }
  void add(std::uint64_t a, std::uint64_t b) {
    links_.push_back({a, b, 1 + draw(8)});
    ends_.emplace(std::min(a, b), std::max(a, b));
    ++links_of_[a];
    ++links_of_[b];
  }

  std::uint64_t x_;
  std::vector<Link> links_;
  std::vector<int> links_of_;  // by node
  std::set<std::pair<std::uint64_t, std::uint64_t>> ends_;
};

}  // namespace carousel::ringbus::graph_test

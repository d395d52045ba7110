#include "report/html/machine_places.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <string>

#include "report/html/html.h"

namespace carousel::report::html {

namespace {

using Links = std::vector<std::pair<std::size_t, std::size_t>>;
using Places = std::vector<Place>;

constexpr double kTurn = 2 * std::numbers::pi;

/// The i-th of n places on a circle, clockwise from `from`.
Place on_circle(std::size_t n, std::size_t i, double radius, Place middle = {}, double from = -kTurn / 4) {
  const double angle = from + kTurn * static_cast<double>(i) / static_cast<double>(n);
  return {middle.x + radius * std::cos(angle), middle.y + radius * std::sin(angle)};
}

/// A long ring in rows: to and fro over the rows, and back along the first column, so that neighbours stay neighbours
/// and there is room for the number of each.
Places meander(std::size_t n) {
  const auto rows = std::max<std::size_t>(2, 2 * static_cast<std::size_t>(std::lround(std::sqrt(double(n)) / 2)));
  const std::size_t in_rows = n - rows;  // without the first column
  Places out;
  for (std::size_t r = 0; r < rows; ++r) {
    const std::size_t count = in_rows / rows + (r < in_rows % rows ? 1 : 0);
    for (std::size_t c = 0; c < count; ++c) {
      const std::size_t column = 1 + (r % 2 == 0 ? c : count - 1 - c);
      out.push_back({static_cast<double>(column), static_cast<double>(r)});
    }
  }
  for (std::size_t r = rows; r-- > 0;) out.push_back({0, static_cast<double>(r)});
  return out;
}

Places ring_places(std::size_t n) {
  constexpr std::size_t kMostOnCircle = 24;
  if (n > kMostOnCircle) return meander(n);
  Places out;
  for (std::size_t i = 0; i < n; ++i) out.push_back(on_circle(n, i, 1));
  return out;
}

Places row_places(std::size_t n) {
  const auto across = static_cast<std::size_t>(std::ceil(std::sqrt(2 * static_cast<double>(n))));
  Places out;
  for (std::size_t i = 0; i < n; ++i) out.push_back({double(i % across), double(i / across)});
  return out;
}

/// Above and below a bus, which is one place in the middle.
Places bus_places(std::size_t n) {
  const std::size_t above = (n + 1) / 2;
  Places out;
  for (std::size_t i = 0; i < n; ++i)
    out.push_back(i < above ? Place{double(i), -1} : Place{double(i - above) + (n % 2 != 0 ? 0.5 : 0), 1});
  out.push_back({(double(above) - 1) / 2, 0});
  return out;
}

/// Rings of rings: each with its bridge towards the middle. The rings keep as far from one another as their members do.
Places rings_of_rings(std::size_t n, std::size_t groups) {
  Places out(n + groups);
  const auto first = [&](std::size_t g) { return (g * n + groups - 1) / groups; };
  const double members = static_cast<double>(n) / static_cast<double>(groups) + 1;
  const double apart = groups > 1 ? 2 * std::sin(kTurn / 2 / static_cast<double>(groups)) : 2;
  const double step = 2 * std::sin(kTurn / 2 / members);  // between members, of the radius
  const double radius = groups > 1 ? apart / (2 + step) : 1;
  for (std::size_t g = 0; g < groups; ++g) {
    const Place middle = groups > 1 ? on_circle(groups, g, 1) : Place{};
    const double inward = std::atan2(-middle.y, -middle.x);
    const std::size_t count = first(g + 1) - first(g);
    out[n + g] = on_circle(count + 1, 0, radius, middle, inward);
    for (std::size_t k = 0; k < count; ++k) out[first(g) + k] = on_circle(count + 1, k + 1, radius, middle, inward);
  }
  return out;
}

/// A graph whose nodes have no places: as far from one another as there are links between them, as well as that goes in
/// a plane (E. Gansner, Y. Koren, S. North, Graph drawing by stress majorization, Graph Drawing 2004). It begins with
/// the distances from nodes that are far apart, so that it is the same each time.
Places spread_places(std::size_t count, const Links& links) {
  std::vector<std::vector<std::size_t>> beside(count);
  for (const auto& [a, b] : links) beside[a].push_back(b), beside[b].push_back(a);
  std::vector<std::vector<double>> far(count, std::vector<double>(count, double(count)));
  for (std::size_t start = 0; start < count; ++start) {
    std::vector<std::size_t> open{start};
    far[start][start] = 0;
    for (std::size_t i = 0; i < open.size(); ++i)
      for (const std::size_t next : beside[open[i]])
        if (far[start][next] == double(count)) far[start][next] = far[start][open[i]] + 1, open.push_back(next);
  }
  const auto best = [&](const auto& value) {
    std::size_t top = 0;
    for (std::size_t i = 1; i < count; ++i)
      if (value(i) > value(top)) top = i;
    return top;
  };
  const std::size_t a = best([&](std::size_t i) { return far[0][i]; });
  const std::size_t b = best([&](std::size_t i) { return far[a][i]; });
  const std::size_t c =
      best([&](std::size_t i) { return std::min(far[a][i], far[b][i]) - std::abs(far[a][i] - far[b][i]); });
  const std::size_t d = best([&](std::size_t i) { return far[c][i] - std::abs(far[a][i] - far[b][i]); });
  Places at(count);
  for (std::size_t i = 0; i < count; ++i) {
    const Place beside_it = on_circle(count, i, 0.05);
    at[i] = {far[a][i] - far[b][i] + beside_it.x, far[c][i] - far[d][i] + beside_it.y};
  }
  const auto size = static_cast<double>(count);
  const int rounds = static_cast<int>(std::clamp(std::round(6e6 / (size * size)), 10.0, 300.0));
  for (int round = 0; round < rounds; ++round) {
    Places next(count);
    for (std::size_t i = 0; i < count; ++i) {
      double sum = 0;
      for (std::size_t j = 0; j < count; ++j) {
        if (i == j) continue;
        const double dx = at[i].x - at[j].x, dy = at[i].y - at[j].y, weight = 1 / (far[i][j] * far[i][j]);
        const double by = far[i][j] / std::max(1e-6, std::hypot(dx, dy));
        sum += weight;
        next[i].x += weight * (at[j].x + dx * by);
        next[i].y += weight * (at[j].y + dy * by);
      }
      next[i] = sum > 0 ? Place{next[i].x / sum, next[i].y / sum} : at[i];
    }
    at = std::move(next);
  }
  return at;
}

/// The places of a drawn network, if all nodes have them, y upwards.
Places drawn_places(const Json& nodes) {
  Places out;
  for (const Json& node : nodes) {
    if (!node.contains("x_mm") || !node.contains("y_mm")) return {};
    out.push_back({number_at(node, "x_mm"), -number_at(node, "y_mm")});
  }
  return out;
}

}  // namespace

double MachinePlaces::least_gap() const {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < at.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) least = std::min(least, std::hypot(at[i].x - at[j].x, at[i].y - at[j].y));
  return std::isfinite(least) && least > 0 ? least : 1;
}

MachinePlaces machine_places(const Json& report) {
  MachinePlaces out;
  const Json* resources = find(report, "resources");
  out.resources =
      resources && !resources->empty()
          ? resources->size()
          : static_cast<std::size_t>(std::clamp(number_at(report, "config.topology.resources"), 0.0, 65536.0));
  std::size_t all = out.resources;
  if (const Json* links = find(report, "links"))
    for (const Json& link : *links) {
      const auto from = static_cast<std::size_t>(number_at(link, "from")),
                 to = static_cast<std::size_t>(number_at(link, "to"));
      out.links.emplace_back(from, to);
      all = std::max({all, from + 1, to + 1});
    }
  const std::size_t n = out.resources, hubs = all - n;
  const std::string shape = text_at(report, "config.topology.shape", "ring");
  if (const Json* nodes = find(report, "drawing")) out.at = drawn_places(*nodes);
  if (out.at.size() >= all && all > 0) return out;
  const bool like_a_ring = hubs == 0 && std::all_of(out.links.begin(), out.links.end(), [&](const auto& link) {
                             return (link.first + 1) % n == link.second || (link.second + 1) % n == link.first;
                           });
  if (shape == "graph" && !like_a_ring)
    out.at = spread_places(all, out.links);
  else if (shape == "independent" || (shape == "graph" && out.links.empty()))
    out.at = row_places(n);
  else if (shape == "bus" && hubs == 1)
    out.at = bus_places(n);
  else if (shape == "hierarchical" && hubs > 0)
    out.at = rings_of_rings(n, hubs);
  else if (shape == "point_to_point" && n > 24)
    out.at = spread_places(n, out.links);
  else
    out.at = ring_places(n);
  for (std::size_t h = out.at.size() - std::min(out.at.size(), n); h < hubs; ++h)
    out.at.push_back(hubs == 1 ? Place{} : on_circle(hubs, h, 0.4));
  return out;
}

}  // namespace carousel::report::html

#include "accel/traverse/plain_tree.h"

#include <algorithm>
#include <cmath>

namespace carousel::accel {

namespace {

constexpr double kEps = 0x1p-53;
constexpr std::size_t kLeafItems = 4;

}  // namespace

void WideBox::extend(const WideBox& other) {
  for (int a = 0; a < 3; ++a) {
    lo[a] = std::min(lo[a], other.lo[a]);
    hi[a] = std::max(hi[a], other.hi[a]);
  }
}

WideBox WideBox::placed(const scene::Affine& m) const {
  WideBox out;
  for (int row = 0; row < 3; ++row) {
    double at = m.translation[row], reach = 0, terms = std::fabs(at);
    for (int c = 0; c < 3; ++c) {
      const double centre = (lo[c] + hi[c]) / 2, half = (hi[c] - lo[c]) / 2, factor = m.linear[c][row];
      at += factor * centre;
      reach += std::fabs(factor) * half;
      terms += std::fabs(factor) * (std::fabs(centre) + half);
    }
    reach += 16 * kEps * terms;  // about ten roundings
    out.lo[row] = at - reach;
    out.hi[row] = at + reach;
  }
  return out;
}

bool WideBox::meets(const Ray& ray, double tmax, double& entry) const {
  double near = ray.tmin, far = tmax;
  for (int a = 0; a < 3; ++a) {
    const double o = ray.origin[a], d = ray.direction[a];
    if (d == 0) {
      if (o < lo[a] || o > hi[a]) return false;
      continue;
    }
    const double t0 = (lo[a] - o) / d, t1 = (hi[a] - o) / d;
    const double first = std::min(t0, t1), last = std::max(t0, t1);
    near = std::max(near, first - 4 * kEps * std::fabs(first));
    far = std::min(far, last + 4 * kEps * std::fabs(last));
  }
  entry = near;
  return near <= far;
}

PlainTree::PlainTree(std::span<const WideBox> boxes) : order_(boxes.size()) {
  if (boxes.empty()) return;
  for (std::uint32_t i = 0; i < order_.size(); ++i) order_[i] = i;
  nodes_.push_back({{}, 0, static_cast<std::uint32_t>(boxes.size())});
  for (std::size_t at = 0; at < nodes_.size(); ++at) {
    const std::uint32_t first = nodes_[at].first, count = nodes_[at].count;
    WideBox box;
    for (std::uint32_t i = first; i < first + count; ++i) box.extend(boxes[order_[i]]);
    nodes_[at].box = box;
    if (count <= kLeafItems) continue;
    int longest = 0;
    for (int a = 1; a < 3; ++a)
      if (box.hi[a] - box.lo[a] > box.hi[longest] - box.lo[longest]) longest = a;
    const auto begin = order_.begin() + first;
    const auto middle = begin + count / 2;
    std::nth_element(begin, middle, begin + count, [&](std::uint32_t a, std::uint32_t b) {
      return boxes[a].lo[longest] + boxes[a].hi[longest] < boxes[b].lo[longest] + boxes[b].hi[longest];
    });
    nodes_[at].first = static_cast<std::uint32_t>(nodes_.size());
    nodes_[at].count = 0;
    nodes_.push_back({{}, first, count / 2});
    nodes_.push_back({{}, first + count / 2, count - count / 2});
  }
}

}  // namespace carousel::accel

#include "report/accuracy/accuracy_plot.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "report/accuracy/free_place.h"

namespace carousel::report {

namespace {

constexpr double kWidth = 1180, kHeight = 520, kTop = 64, kBottom = 84;
constexpr double kPanelWidth = 330, kFirstPanel = 84, kPanelGap = 40, kList = kFirstPanel + 2 * kPanelWidth + 70;
constexpr const char *kSafe = "#1a8a5a", *kSafeButSlivers = "#2a6fc0", *kUnsafe = "#d06020";

double parts_per_million(const AccuracyRow& row) {
  std::uint64_t rays = row.scene.rays;
  for (const HitErrors& errors : row.hard) rays += errors.rays;
  return rays == 0 ? 0 : 1e6 * static_cast<double>(row.wrong()) / static_cast<double>(rays);
}

const char* color(const AccuracyRow& row) {
  return row.safe ? kSafe : row.safe_but_slivers ? kSafeButSlivers : kUnsafe;
}

std::string text(double x, double y, const std::string& words, const std::string& more = "") {
  return fmt::format("<text x='{:.1f}' y='{:.1f}' {}>{}</text>\n", x, y, more, words);
}

/// Errors upwards by powers of ten; the lowest power stands for none at all.
class ErrorAxis {
 public:
  explicit ErrorAxis(const std::vector<AccuracyRow>& rows) {
    double most = 1, least = 0;
    for (const AccuracyRow& row : rows) {
      const double errors = parts_per_million(row);
      most = std::max(most, errors);
      if (errors > 0 && (least == 0 || errors < least)) least = errors;
    }
    least_power_ = (least > 0 ? std::floor(std::log10(least)) : 0) - 1;  // where none stand
    most_power_ = std::ceil(std::log10(most) + 0.3);
  }
  double y(const AccuracyRow& row) const {
    const double errors = parts_per_million(row);
    return y_of_power(errors > 0 ? std::log10(errors) : least_power_);
  }
  std::string lines(double left) const {
    std::string out;
    for (double power = least_power_; power <= most_power_ + 0.5; ++power)
      out += fmt::format("<line x1='{:.0f}' y1='{:.1f}' x2='{:.0f}' y2='{:.1f}' stroke='#ddd'/>\n", left,
                         y_of_power(power), left + kPanelWidth, y_of_power(power));
    return out;
  }
  std::string labels() const {
    std::string out;
    for (double power = least_power_; power <= most_power_ + 0.5; ++power)
      out += text(kFirstPanel - 8, y_of_power(power) + 4,
                  power == least_power_ ? std::string("none") : fmt::format("{:g}", std::pow(10.0, power)),
                  "text-anchor='end'");
    return out;
  }

 private:
  /// The foot lies a little above the panel's, so that dots there are whole.
  double y_of_power(double power) const {
    return kHeight - kBottom - 14 -
           (kHeight - kTop - kBottom - 14) * (power - least_power_) / (most_power_ - least_power_);
  }
  double least_power_ = 0, most_power_ = 1;
};

/// One clock.
class Panel {
 public:
  Panel(const Accuracy& accuracy, Clock clock, double left, const ErrorAxis& errors)
      : rows_(accuracy.rows), clock_(clock), left_(left), errors_(errors) {
    for (const AccuracyRow& row : rows_)
      if (const auto cost = row.cost(clock_)) most_ = std::max(most_, 1.12 * cost->median);
    if (most_ <= 0) most_ = 1;
  }

  std::string draw() const {
    const bool host = clock_ == Clock::kHost;
    std::string out = errors_.lines(left_) + ticks();
    out += text(left_, kTop - 12, host ? "on this host" : "on hardware, where its testers limit", "font-weight='bold'");
    out += text(left_ + kPanelWidth / 2, kHeight - kBottom + 40, host ? "ns a ray" : "cycles a ray",
                "text-anchor='middle'");
    out += frontier();
    FreePlace places({left_, kTop, left_ + kPanelWidth, kHeight - kBottom});
    for (const AccuracyRow& row : rows_)
      if (const auto cost = row.cost(clock_)) places.take_dot(x(cost->median), errors_.y(row));
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      const std::optional<Spread> cost = rows_[i].cost(clock_);
      if (!cost) continue;
      const double at = x(cost->median), y = errors_.y(rows_[i]);
      if (host)
        out += fmt::format("<line x1='{:.1f}' y1='{:.1f}' x2='{:.1f}' y2='{:.1f}' stroke='#888'/>\n", x(cost->least), y,
                           x(cost->most), y);
      const Place label = places.near(at, y);
      const double way = std::hypot(label.x - at, label.y - y), part = std::max(0.0, 1 - 8 / way);  // up to the number
      out += fmt::format("<line x1='{:.1f}' y1='{:.1f}' x2='{:.1f}' y2='{:.1f}' stroke='#bbb'/>\n", at, y,
                         at + part * (label.x - at), y + part * (label.y - y));
      out += fmt::format("<circle cx='{:.1f}' cy='{:.1f}' r='4.5' fill='{}' stroke='#333'/>\n", at, y, color(rows_[i]));
      out += fmt::format("<text class='number' x='{:.1f}' y='{:.1f}' text-anchor='middle' fill='{}'>{}</text>\n",
                         label.x, label.y + 4, color(rows_[i]), i + 1);
    }
    return out;
  }

 private:
  /// A cost beyond the right edge is drawn at the edge.
  double x(double cost) const { return left_ + kPanelWidth * std::min(1.0, cost / most_); }

  std::string ticks() const {
    const double power = std::pow(10.0, std::floor(std::log10(most_ / 2)));
    const double step = most_ / power > 10 ? 5 * power : most_ / power > 4 ? 2 * power : power;
    std::string out;
    for (double cost = 0; cost <= most_; cost += step)
      out += fmt::format("<line x1='{0:.1f}' y1='{1:.0f}' x2='{0:.1f}' y2='{2:.0f}' stroke='#eee'/>\n", x(cost), kTop,
                         kHeight - kBottom) +
             text(x(cost), kHeight - kBottom + 18, fmt::format("{:g}", cost), "text-anchor='middle'");
    return out;
  }

  std::string frontier() const {
    std::vector<std::pair<double, double>> points;
    for (const AccuracyRow& row : rows_)
      if (row.on_frontier(clock_)) points.emplace_back(x(row.cost(clock_)->median), errors_.y(row));
    std::sort(points.begin(), points.end());
    std::string list;
    for (const auto& [at, y] : points) list += fmt::format("{:.1f},{:.1f} ", at, y);
    return fmt::format("<polyline points='{}' fill='none' stroke='#c40' stroke-width='1.5'/>\n", list);
  }

  const std::vector<AccuracyRow>& rows_;
  Clock clock_;
  double left_, most_ = 0;
  const ErrorAxis& errors_;
};

std::string list(const Accuracy& accuracy) {
  double y = kTop + 4;
  std::string out = text(kList, kTop - 12, "triangle + box + transform", "font-weight='bold'");
  for (std::size_t i = 0; i < accuracy.rows.size(); ++i, y += 18) {
    const AccuracyRow& row = accuracy.rows[i];
    out += text(kList + 14, y, std::to_string(i + 1), fmt::format("text-anchor='end' fill='{}'", color(row)));
    out += text(kList + 22, y, fmt::format("{} + {} + {}", row.triangle, row.box, row.transform));
  }
  y += 12;
  for (const auto& [fill, words] : {std::pair{kSafe, "loses nothing, hard cases included"},
                                    {kSafeButSlivers, "loses slivers only"},
                                    {kUnsafe, "loses rays"}}) {
    out += fmt::format("<rect x='{:.1f}' y='{:.1f}' width='9' height='9' fill='{}' stroke='#333'/>", kList + 5, y - 9,
                       fill);
    out += text(kList + 22, y, words);
    y += 18;
  }
  out += fmt::format("<line x1='{0:.0f}' y1='{2:.0f}' x2='{1:.0f}' y2='{2:.0f}' stroke='#c40' stroke-width='1.5'/>",
                     kList, kList + 18, y - 4);
  return out + text(kList + 22, y, "the frontier");
}

}  // namespace

std::string accuracy_plot(const Accuracy& accuracy) {
  const ErrorAxis errors(accuracy.rows);
  std::string out = fmt::format(
      "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 {0:.0f} {1:.0f}' width='{0:.0f}' height='{1:.0f}' "
      "font-family='sans-serif' font-size='12'>\n<rect width='100%' height='100%' fill='white'/>\n",
      kWidth, kHeight);
  out += text(kFirstPanel, 26, fmt::format("The cost of accuracy: {}", accuracy.scene), "font-size='16'");
  out += errors.labels();
  out += fmt::format(
      "<text transform='translate(20 {:.0f}) rotate(-90)' text-anchor='middle'>wrong answers in a million rays, "
      "hard cases included</text>\n",
      (kTop + kHeight - kBottom) / 2);
  double left = kFirstPanel;
  for (const Clock clock : kClocks) {
    out += Panel(accuracy, clock, left, errors).draw();
    left += kPanelWidth + kPanelGap;
  }
  return out + list(accuracy) + "</svg>\n";
}

}  // namespace carousel::report

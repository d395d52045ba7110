#include "report/accuracy/accuracy_plot.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace carousel::report {

namespace {

constexpr double kWidth = 980, kHeight = 560, kLeft = 90, kRight = 300, kTop = 50, kBottom = 70;

double parts_per_million(const AccuracyRow& row) {
  std::uint64_t rays = row.scene.rays;
  for (const HitErrors& errors : row.hard) rays += errors.rays;
  return rays == 0 ? 0 : 1e6 * static_cast<double>(row.wrong()) / static_cast<double>(rays);
}

/// Time to the right, errors upwards by powers of ten; the lowest power stands for none at all.
class Axes {
 public:
  explicit Axes(const std::vector<AccuracyRow>& rows) {
    double most_errors = 1;
    for (const AccuracyRow& row : rows) {
      most_time_ = std::max(most_time_, row.ns_per_ray.median);
      most_errors = std::max(most_errors, parts_per_million(row));
      if (const double errors = parts_per_million(row); errors > 0)
        least_power_ = std::min(least_power_, std::floor(std::log10(errors)));
    }
    most_time_ *= 1.2;
    least_power_ -= 1;  // where none stand
    most_power_ = std::ceil(std::log10(most_errors) + 0.1);
  }
  /// A point beyond the right edge is drawn at the edge.
  double x(double time) const { return kLeft + (kWidth - kLeft - kRight) * std::min(1.0, time / most_time_); }
  double y_of_power(double power) const {
    return kHeight - kBottom - (kHeight - kTop - kBottom) * (power - least_power_) / (most_power_ - least_power_);
  }
  double y(double errors) const { return y_of_power(errors > 0 ? std::log10(errors) : least_power_); }

  std::string frame() const {
    std::string out;
    for (double power = least_power_; power <= most_power_ + 0.5; ++power) {
      const double at = y_of_power(power);
      out += fmt::format("<line x1='{:.0f}' y1='{:.1f}' x2='{:.0f}' y2='{:.1f}' stroke='#ddd'/>", kLeft, at,
                         kWidth - kRight, at);
      out += fmt::format("<text x='{:.0f}' y='{:.1f}' text-anchor='end'>{}</text>\n", kLeft - 8, at + 4,
                         power == least_power_ ? std::string("none") : fmt::format("{:g}", std::pow(10.0, power)));
    }
    const double step = std::pow(10.0, std::floor(std::log10(most_time_ / 2)));
    const double wide = most_time_ / step > 10 ? 5 * step : most_time_ / step > 4 ? 2 * step : step;
    for (double time = 0; time <= most_time_; time += wide)
      out += fmt::format(
          "<line x1='{0:.1f}' y1='{1:.0f}' x2='{0:.1f}' y2='{2:.0f}' stroke='#eee'/><text x='{0:.1f}' y='{3:.0f}' "
          "text-anchor='middle'>{4:g}</text>\n",
          x(time), kTop, kHeight - kBottom, kHeight - kBottom + 18, time);
    return out;
  }

 private:
  double most_time_ = 1, least_power_ = 0, most_power_ = 1;
};

/// Names beside the dots, one below the other where they would touch.
std::vector<double> label_heights(const std::vector<AccuracyRow>& rows, const Axes& axes) {
  std::vector<std::size_t> order(rows.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    const double left = axes.y(parts_per_million(rows[a])), right = axes.y(parts_per_million(rows[b]));
    return left != right ? left < right : rows[a].ns_per_ray.median < rows[b].ns_per_ray.median;
  });
  std::vector<double> heights(rows.size());
  const double lowest = kHeight - kBottom;
  double last = lowest + 13;
  for (std::size_t i = order.size(); i-- > 0;) {  // from the foot upwards
    const double wanted = axes.y(parts_per_million(rows[order[i]]));
    last = heights[order[i]] = std::min(wanted, last - 13);
  }
  return heights;
}

}  // namespace

std::string accuracy_plot(const Accuracy& accuracy) {
  const Axes axes(accuracy.rows);
  std::string out = fmt::format(
      "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 {0:.0f} {1:.0f}' width='{0:.0f}' height='{1:.0f}' "
      "font-family='sans-serif' font-size='11'>\n<rect width='100%' height='100%' fill='white'/>\n"
      "<text x='{2:.0f}' y='24' font-size='15'>What accuracy costs in time: {3}</text>\n",
      kWidth, kHeight, kLeft, accuracy.scene);
  out += axes.frame();
  out += fmt::format("<text x='{:.0f}' y='{:.0f}' text-anchor='middle'>ns a ray, depth-first on one thread</text>\n",
                     (kLeft + kWidth - kRight) / 2, kHeight - 24);
  out += fmt::format(
      "<text transform='translate(24 {:.0f}) rotate(-90)' text-anchor='middle'>wrong answers in a million rays, "
      "hard cases included</text>\n",
      kHeight / 2);

  std::vector<const AccuracyRow*> frontier;
  for (const AccuracyRow& row : accuracy.rows)
    if (row.frontier) frontier.push_back(&row);
  std::sort(frontier.begin(), frontier.end(),
            [](const AccuracyRow* a, const AccuracyRow* b) { return a->ns_per_ray.median < b->ns_per_ray.median; });
  std::string points;
  for (const AccuracyRow* row : frontier)
    points += fmt::format("{:.1f},{:.1f} ", axes.x(row->ns_per_ray.median), axes.y(parts_per_million(*row)));
  out += fmt::format("<polyline points='{}' fill='none' stroke='#c40' stroke-width='1.5'/>\n", points);

  const std::vector<double> heights = label_heights(accuracy.rows, axes);
  for (std::size_t i = 0; i < accuracy.rows.size(); ++i) {
    const AccuracyRow& row = accuracy.rows[i];
    const double x = axes.x(row.ns_per_ray.median), y = axes.y(parts_per_million(row));
    out += fmt::format("<line x1='{:.1f}' y1='{:.1f}' x2='{:.1f}' y2='{:.1f}' stroke='#999'/>",
                       axes.x(row.ns_per_ray.least), y, axes.x(row.ns_per_ray.most), y);
    out += fmt::format("<line x1='{:.1f}' y1='{:.1f}' x2='{:.1f}' y2='{:.1f}' stroke='#ccc' stroke-dasharray='2 2'/>",
                       x, y, kWidth - kRight + 6, heights[i]);
    out += fmt::format("<circle cx='{:.1f}' cy='{:.1f}' r='4.5' fill='{}' stroke='#333'/>", x, y,
                       row.safe       ? "#2a8"
                       : row.frontier ? "#c40"
                                      : "#bbb");
    out += fmt::format("<text x='{:.0f}' y='{:.1f}'>{} + {} + {}</text>\n", kWidth - kRight + 10, heights[i] + 4,
                       row.triangle, row.box, row.transform);
  }
  out += fmt::format(
      "<text x='{:.0f}' y='{:.0f}' fill='#2a8'>green: safe for this scene</text>"
      "<text x='{:.0f}' y='{:.0f}' fill='#c40'>line: the frontier</text>\n</svg>\n",
      kWidth - kRight + 10, kHeight - 40, kWidth - kRight + 10, kHeight - 24);
  return out;
}

}  // namespace carousel::report

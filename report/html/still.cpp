#include "report/html/still.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include <fmt/format.h>

#include "report/html/machine_places.h"
#include "report/run/report_json.h"
#include "report/text/number_text.h"

namespace carousel::report::html {

namespace {

constexpr std::size_t kHues = 12;  // of web/src/page.css

/// A row of bars: its name, a drawing, and a text behind it.
Html bar_row(const std::string& name, const Html& drawing, const std::string& text) {
  return markup("<div class=\"bar\"><span>{}</span>{}<span>{}</span></div>\n", name, drawing, text);
}

/// A drawing of 1000 by 10 units, as wide as there is room. It is told in words beside it.
Html strip(const Html& pieces) {
  return markup("<svg viewBox=\"0 0 1000 10\" preserveAspectRatio=\"none\" aria-hidden=\"true\">{}</svg>", pieces);
}

Html piece(double from, double to, const std::string& kind) {
  const double width = std::max(0.0, 1000 * (to - from));
  return width <= 0 ? Html()
                    : markup("<rect x=\"{}\" width=\"{}\" height=\"10\" class=\"{}\"/>", std::round(10000 * from) / 10,
                             std::round(10 * width) / 10, kind);
}

std::string hue(std::size_t i) {
  return fmt::format("k{}", i % kHues);
}

std::string more_text(std::size_t left_out) {
  return left_out == 1 ? "1 more row stands in the table" : fmt::format("{} more rows stand in the table", left_out);
}

/// From nothing to full: the stops of cividis (Nunez et al., 2018), dark blue to yellow. Red, green and blue to 255.
struct Colour {
  double r = 0, g = 0, b = 0;
  std::string text() const { return fmt::format("#{:02x}{:02x}{:02x}", int(r + 0.5), int(g + 0.5), int(b + 0.5)); }
  bool light() const { return 0.299 * r + 0.587 * g + 0.114 * b > 128; }
};
Colour scale_colour(double part) {
  constexpr Colour kStops[] = {{0, 32, 77},     {49, 68, 107},   {102, 104, 112},
                               {149, 143, 120}, {203, 186, 105}, {255, 234, 70}};
  const double at = std::clamp(part, 0.0, 0.99999) * (std::size(kStops) - 1);
  const Colour &a = kStops[static_cast<std::size_t>(at)], &b = kStops[static_cast<std::size_t>(at) + 1];
  const double t = at - std::floor(at);
  return {a.r + t * (b.r - a.r), a.g + t * (b.g - a.g), a.b + t * (b.b - a.b)};
}

/// The least round maximum above all shares, so that faint differences are seen too.
double round_most(const std::vector<double>& shares) {
  double most = 0;
  for (const double s : shares) most = std::max(most, s);
  for (const double round : {0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0})
    if (most <= round) return round;
  return most;
}

constexpr double kBox = 34, kText = 13;  // units of the drawing

Html box(double x, double y, double width, const std::string& name, const std::string& value, const Colour* colour) {
  const char* ink = colour == nullptr ? "var(--ink)" : colour->light() ? "#000" : "#fff";
  const std::string fill = colour == nullptr ? "var(--panel)" : colour->text();
  const double size = std::min(kText, 1.6 * width / static_cast<double>(std::max<std::size_t>(1, name.size())));
  Html out = markup(
      "<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{}\" rx=\"5\" style=\"fill:{};stroke:var(--soft)\"/>",
      x - width / 2, y - kBox / 2, width, kBox, fill);
  out += markup("<text x=\"{:.1f}\" y=\"{:.1f}\" font-size=\"{:.1f}\" style=\"fill:{}\">{}</text>", x,
                value.empty() ? y + 0.36 * size : y - 2, size, ink, name);
  if (!value.empty())
    out += markup("<text x=\"{:.1f}\" y=\"{:.1f}\" font-size=\"10.5\" style=\"fill:{}\">{}</text>", x, y + 11.5, ink,
                  value);
  return out;
}

/// A link from one box to another, a little to the left, so that there is room for the one back.
Html arrow(Place from, Place to, double beside, const Colour& colour, double width) {
  const double dx = to.x - from.x, dy = to.y - from.y, length = std::hypot(dx, dy);
  if (length < 1e-9) return {};
  const double ux = dx / length, uy = dy / length, reach = 0.5 * kBox / std::max(std::abs(ux), std::abs(uy)) + 1;
  if (length <= 2 * reach + 4) return {};
  const double x0 = from.x + ux * reach - uy * beside, y0 = from.y + uy * reach + ux * beside;
  const double x1 = to.x - ux * (reach + 5) - uy * beside, y1 = to.y - uy * (reach + 5) + ux * beside;
  const double tip = 2 + width;
  return markup(
      "<path d=\"M{:.1f} {:.1f}L{:.1f} {:.1f}\" style=\"stroke:{};stroke-width:{:.1f}\"/>"
      "<path d=\"M{:.1f} {:.1f}L{:.1f} {:.1f}L{:.1f} {:.1f}Z\" style=\"fill:{}\"/>",
      x0, y0, x1, y1, colour.text(), width, x1 + 5 * ux, y1 + 5 * uy, x1 - tip * uy, y1 + tip * ux, x1 + tip * uy,
      y1 - tip * ux, colour.text());
}

/// The scale below a drawing.
Html scale_bar(double most) {
  Html pieces;
  constexpr int kSteps = 24;
  for (int i = 0; i < kSteps; ++i)
    pieces += markup("<rect x=\"{}\" width=\"9\" height=\"10\" style=\"fill:{}\"/>", 8 * i,
                     scale_colour((i + 0.5) / kSteps).text());
  return markup(
      "<p class=\"scale\"><span>not used</span><svg viewBox=\"0 0 192 10\" preserveAspectRatio=\"none\" "
      "aria-hidden=\"true\">{}</svg><span>{}</span></p>\n",
      pieces, percent(most));
}

Html drawing(double left, double top, double width, double height, const Html& pieces, const std::string& label) {
  return markup(
      "<svg class=\"machine\" viewBox=\"{:.1f} {:.1f} {:.1f} {:.1f}\" role=\"img\" aria-label=\"{}\">{}</svg>\n", left,
      top, width, height, label, pieces);
}

struct Part {
  std::string name;
  double use = 0;
};

/// A machine with one collection buffer: the buffer in the middle, around it what works for it.
Html central_machine(const Json& report) {
  const double cycles = number_at(report, "engine.cycles");
  std::vector<Part> parts;
  const Json& resources = report.at("resources");
  if (resources.size() == 1) {
    for (const auto& [kind, unit] : resources.front().at("units").items())
      if (unit.is_object() && number_at(unit, "busy") > 0)
        parts.push_back({words(kind), number_at(unit, "busy") / cycles});
  } else {
    const std::vector<double> uses = uses_of_resources(report);
    for (std::size_t i = 0; i < uses.size(); ++i) parts.push_back({std::to_string(i), uses[i]});
  }
  if (const Json* caches = find(report, "memory.caches"); caches && !caches->empty())
    parts.push_back({"L2", number_at(caches->front(), "port_utilisation")});
  parts.push_back({"DRAM", number_at(report, "memory.dram_utilisation")});
  parts.push_back({"shaders", number_at(report, "shading.utilisation")});
  std::vector<double> uses;
  for (const Part& part : parts) uses.push_back(part.use);
  const double most = round_most(uses);
  constexpr double kWide = 92;
  const double radius = std::max(110.0, 15.0 * static_cast<double>(parts.size()));
  Html lines, boxes;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const double angle =
        6.283185307179586 * static_cast<double>(i) / static_cast<double>(parts.size()) - 1.5707963267948966;
    const double x = 1.25 * radius * std::cos(angle), y = radius * std::sin(angle);
    const Colour colour = scale_colour(parts[i].use / most);
    lines += markup("<path d=\"M0 0L{:.1f} {:.1f}\" style=\"stroke:var(--soft);stroke-width:2\"/>", x, y);
    boxes += box(x, y, kWide, parts[i].name, percent(parts[i].use), &colour);
  }
  boxes += box(0, 0, kWide + 8, "collections", "", nullptr);
  const double w = 2.5 * radius + kWide + 12, h = 2 * radius + kBox + 12;
  return drawing(-w / 2, -h / 2, w, h, lines + boxes,
                 "The machine: one buffer of collections in the middle, and the parts that work for it.") +
         scale_bar(most);
}

}  // namespace

double use_of_resource(const Json& resource, double cycles, double most_tested) {
  const Json* units = find(resource, "units");
  if (!units) return most_tested > 0 ? number_at(resource, "rays_tested") / most_tested : 0;
  double busy = 0;
  for (const auto& [kind, unit] : units->items())
    if (unit.is_object()) busy = std::max(busy, number_at(unit, "busy"));
  return cycles > 0 ? busy / cycles : 0;
}

std::vector<double> uses_of_resources(const Json& report) {
  std::vector<double> out;
  const Json* resources = find(report, "resources");
  if (!resources) return out;
  double most_tested = 0;
  for (const Json& r : *resources) most_tested = std::max(most_tested, number_at(r, "rays_tested"));
  const std::size_t testing = resources_with_units(report.value("config", Json::object()), resources->size());
  for (std::size_t i = 0; i < testing; ++i)
    out.push_back(use_of_resource((*resources)[i], number_at(report, "engine.cycles"), most_tested));
  return out;
}

Html still_bars(const Table& table, std::size_t value, std::size_t most) {
  double greatest = 0;
  for (const auto& row : table.rows)
    if (row[value].number.is_number()) greatest = std::max(greatest, row[value].number.get<double>());
  if (greatest <= 0) return {};
  Html out;
  std::size_t shown = 0;
  for (const auto& row : table.rows) {
    if (!row[value].number.is_number() || shown == most) continue;
    ++shown;
    out += bar_row(row[0].text, strip(piece(0, row[value].number.get<double>() / greatest, "k0")), row[value].text);
  }
  if (table.rows.size() > shown && shown == most) out += markup("<p>{}.</p>\n", more_text(table.rows.size() - shown));
  return markup("<div class=\"bars\">\n{}</div>\n", out);
}

Html still_stack(const Table& table, std::size_t most) {
  std::vector<std::string> kinds(table.columns.size());
  Html legend, out;
  std::size_t hues = 0;
  for (std::size_t c = 1; c < table.columns.size(); ++c) {
    double greatest = 0;
    for (const auto& row : table.rows)
      if (row[c].number.is_number()) greatest = std::max(greatest, row[c].number.get<double>());
    if (greatest <= 0) continue;
    kinds[c] = table.columns[c].title == "nothing to do" ? "k-idle" : hue(hues++);
    legend +=
        markup("<span><i class=\"{}\"></i>{}</span>", kinds[c],
               table.rows.size() == 1 ? table.columns[c].title + " " + table.rows[0][c].text : table.columns[c].title);
  }
  for (std::size_t r = 0; r < std::min(most, table.rows.size()); ++r) {
    Html pieces;
    double at = 0;
    for (std::size_t c = 1; c < table.columns.size(); ++c) {
      if (kinds[c].empty() || !table.rows[r][c].number.is_number()) continue;
      const double part = table.rows[r][c].number.get<double>();
      pieces += piece(at, at + part, kinds[c]);
      at += part;
    }
    out += bar_row(table.rows[r][0].text, strip(pieces), table.rows.size() == 1 ? "" : table.rows[r][1].text);
  }
  if (table.rows.size() > most) out += markup("<p>{}.</p>\n", more_text(table.rows.size() - most));
  return markup("<div class=\"bars\">\n<p class=\"legend\">{}</p>\n{}</div>\n", legend, out);
}

Html still_gains(const std::vector<StillGain>& gains) {
  double most = 0.01, least = 0;
  for (const StillGain& g : gains) most = std::max({most, g.high, g.gain}), least = std::min({least, g.low, g.gain});
  least = std::max(least, -0.5 * most);  // what loses more is cut
  const double span = most - least;
  const auto at = [&](double gain) { return (std::clamp(gain, least, most) - least) / span; };
  Html out;
  for (const StillGain& g : gains) {
    const bool better = g.gain >= 0;
    Html pieces = piece(std::min(at(0), at(g.gain)), std::max(at(0), at(g.gain)), better ? "better" : "worse");
    pieces += markup("<rect x=\"{:.1f}\" y=\"4\" width=\"{:.1f}\" height=\"2\" class=\"whisker\"/>", 1000 * at(g.low),
                     std::max(1.0, 1000 * (at(g.high) - at(g.low))));
    pieces += markup("<rect x=\"{:.1f}\" width=\"1.5\" height=\"10\" class=\"zero\"/>", 1000 * at(0));
    out += bar_row(g.name, strip(pieces), g.text + (g.low < least || g.gain < least ? " (cut)" : ""));
  }
  return markup("<div class=\"bars wide\">\n{}</div>\n", out);
}

Html still_machine(const Json& report) {
  const Json* resources = find(report, "resources");
  if (!resources || resources->empty()) return {};
  if (text_at(report, "config.topology.shape") == "central" && resources->front().contains("units"))
    return central_machine(report);
  const MachinePlaces places = machine_places(report);
  constexpr std::size_t kMost = 400;
  if (places.at.size() < 2 || places.at.size() > kMost) return {};
  const std::vector<double> uses = uses_of_resources(report);
  const Json* links = find(report, "links");
  const bool timed = links && !links->empty() && links->front().contains("utilisation");
  double carried = 0;
  if (links)
    for (const Json& link : *links) carried = std::max(carried, number_at(link, "packets"));
  std::vector<double> link_uses;
  if (links)
    for (const Json& link : *links)
      link_uses.push_back(timed ? number_at(link, "utilisation")
                                : (carried > 0 ? number_at(link, "packets") / carried : 0));
  std::vector<double> both = uses;
  both.insert(both.end(), link_uses.begin(), link_uses.end());
  const double most = round_most(both);
  const bool bus = text_at(report, "config.topology.shape") == "bus" && places.at.size() == places.resources + 1;
  const double scale = kBox / 0.58 / places.least_gap();
  double x0 = 1e30, y0 = 1e30, x1 = -1e30, y1 = -1e30;
  std::vector<Place> at;
  for (const Place& place : places.at) {
    at.push_back({scale * place.x, scale * place.y});
    x0 = std::min(x0, at.back().x), x1 = std::max(x1, at.back().x);
    y0 = std::min(y0, at.back().y), y1 = std::max(y1, at.back().y);
  }
  Html lines, boxes;
  const double width = places.links.size() > 200 ? 1 : 2.5;
  for (std::size_t i = 0; i < places.links.size(); ++i) {
    const auto [a, b] = places.links[i];
    Place from = at[a], to = at[b];
    if (bus && a >= places.resources) from.x = to.x;
    if (bus && b >= places.resources) to.x = from.x;
    const double beside =
        4 + 5 * static_cast<double>(std::count(places.links.begin(),
                                               places.links.begin() + static_cast<std::ptrdiff_t>(i), places.links[i]));
    lines += arrow(from, to, beside, scale_colour(link_uses[i] / most), width);
  }
  const Json* names = find(report, "drawing");
  const bool valued = uses.size() <= 100;
  for (std::size_t i = 0; i < at.size(); ++i) {
    const bool hub = i >= places.resources;
    std::string name = hub ? fmt::format("B{}", i - places.resources) : std::to_string(i);
    if (names && i < names->size()) name = text_at((*names)[i], "name", name);
    const bool tests = i < uses.size();  // not a hub, nor a packet process that serves others
    const Colour colour = scale_colour(tests ? uses[i] / most : 0);
    if (hub && bus)
      boxes += box((x0 + x1) / 2, at[i].y, x1 - x0 + kBox, "bus", "", nullptr);
    else
      boxes += box(at[i].x, at[i].y, kBox, name, tests && valued ? fmt::format("{:.0f} %", 100 * uses[i]) : "",
                   tests ? &colour : nullptr);
  }
  const double margin = kBox / 2 + 6, w = std::max(x1 - x0 + 2 * margin, 240.0), h = y1 - y0 + 2 * margin;
  return drawing((x0 + x1 - w) / 2, y0 - margin, w, h, lines + boxes,
                 "Drawing of the machine. The table of resources has the use of each part.") +
         scale_bar(most);
}

}  // namespace carousel::report::html

#include "bench/rays/tables.h"

#include <algorithm>
#include <set>

#include <fmt/format.h>

#include "bench/rays/contestants.h"

namespace carousel::bench {

std::string Table::text() const {
  std::vector<std::size_t> widths(rows_[0].size(), 3);
  for (const auto& row : rows_)
    for (std::size_t c = 0; c < row.size(); ++c) widths[c] = std::max(widths[c], row[c].size());
  std::string out;
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    out += "|";
    for (std::size_t c = 0; c < widths.size(); ++c)
      out +=
          c == 0 ? fmt::format(" {:<{}} |", rows_[r][c], widths[c]) : fmt::format(" {:>{}} |", rows_[r][c], widths[c]);
    out += "\n";
    if (r > 0) continue;
    out += "|";
    for (std::size_t c = 0; c < widths.size(); ++c) out += std::string(widths[c] + 1, '-') + (c == 0 ? "-|" : ":|");
    out += "\n";
  }
  return out;
}

std::string spread_text(const Spread& spread) {
  return fmt::format("{:.2f} ({:.2f} to {:.2f})", spread.median, spread.min, spread.max);
}

double wall_rate(const SetResult& set, const std::string& contestant, int threads) {
  const Measurement* m = find(set, contestant, threads);
  return m == nullptr ? 0 : m->wall.median;
}

double cpu_rate(const SetResult& set, const std::string& contestant, int threads) {
  const Measurement* m = find(set, contestant, threads);
  return m == nullptr ? 0 : m->cpu.median;
}

std::string ratio_text(double a, double b) {
  return a > 0 && b > 0 ? fmt::format("{:.2f}", a / b) : "";
}

namespace {

std::vector<int> thread_counts(const SetResult& set) {
  std::set<int> counts;
  for (const Measurement& m : set.measurements) counts.insert(m.threads);
  return {counts.begin(), counts.end()};
}

std::string threads_text(int threads) {
  return std::to_string(threads) + (threads == 1 ? " thread" : " threads");
}

}  // namespace

std::string set_table(const SetResult& set) {
  const std::vector<int> counts = thread_counts(set);
  std::vector<std::string> header{"Mrays/s"};
  for (const int t : counts) {
    header.insert(header.end(), {threads_text(t), "per CPU s", "/ Embree", "/ depth-first"});
    if (t != counts.front()) header.push_back("/ " + threads_text(counts.front()));
  }
  Table table(std::move(header));
  std::vector<std::string> names;
  for (const Measurement& m : set.measurements)
    if (std::find(names.begin(), names.end(), m.contestant) == names.end()) names.push_back(m.contestant);
  for (const std::string& name : names) {
    std::vector<std::string> row{name};
    for (const int t : counts) {
      const Measurement* m = find(set, name, t);
      row.insert(row.end(), {m == nullptr ? "" : spread_text(m->wall) + (m->work.given_up_after > 0 ? " *" : ""),
                             m == nullptr ? "" : fmt::format("{:.2f}", m->cpu.median),
                             ratio_text(cpu_rate(set, name, t), cpu_rate(set, kEmbreeRobust, t)),
                             ratio_text(cpu_rate(set, name, t), cpu_rate(set, kDepthFirst, t))});
      if (t != counts.front()) row.push_back(ratio_text(wall_rate(set, name, t), wall_rate(set, name, counts.front())));
    }
    table.add(std::move(row));
  }
  return table.text();
}

std::string work_table(const SetResult& set) {
  Table table({"a ray", "box tests", "triangle tests", "collections joined", "rays a packet"});
  bool any = false;
  for (const Measurement& m : set.measurements) {
    if (m.threads != set.measurements.front().threads || m.work.box_tests == 0) continue;
    any = true;
    table.add({m.contestant, fmt::format("{:.1f}", m.work.box_tests), fmt::format("{:.1f}", m.work.triangle_tests),
               fmt::format("{:.1f}", m.work.memberships), fmt::format("{:.1f}", m.work.packet_rays)});
  }
  return any ? table.text() : "";
}

std::string build_table(const std::vector<SceneResult>& scenes) {
  std::vector<std::string> header{"Mtriangles/s"};
  std::set<int> counts;
  for (const SceneResult& scene : scenes)
    for (const BuildResult& build : scene.builds) counts.insert(build.threads);
  for (const int t : counts) header.push_back(threads_text(t));
  header.insert(header.end(), {"bytes a triangle", "s to the first packet"});
  Table table(std::move(header));
  for (const SceneResult& scene : scenes) {
    std::vector<std::string> builders;
    for (const BuildResult& build : scene.builds)
      if (std::find(builders.begin(), builders.end(), build.builder) == builders.end())
        builders.push_back(build.builder);
    for (const std::string& builder : builders) {
      std::vector<std::string> row{scene.name + ", " + builder};
      std::string bytes;
      for (const int t : counts) {
        std::string cell;
        for (const BuildResult& build : scene.builds) {
          if (build.builder != builder || build.threads != t) continue;
          cell = spread_text(build.mtris);
          bytes = fmt::format("{:.0f}", build.bytes_per_triangle);
        }
        row.push_back(cell);
      }
      row.push_back(bytes);
      row.push_back(builder == builders.front() ? fmt::format("{:.3f}", scene.to_first_packet_seconds) : "");
      table.add(std::move(row));
    }
  }
  return table.text();
}

}  // namespace carousel::bench

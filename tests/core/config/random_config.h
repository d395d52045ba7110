#pragma once

#include <random>

#include "core/config/config.h"

namespace carousel {

/// A visitor that gives every field a value inside its range, often one of the ends.
class RandomFiller : public config::RowVisitor<RandomFiller> {
 public:
  explicit RandomFiller(std::uint64_t seed) : random_(seed) {}

  template <class T>
  void fill(T& value) {
    config::describe(*this, value);
  }

  void on_field(std::string_view, std::int64_t& value, config::IntRange range, const char*, const char*) {
    switch (pick(4)) {
      case 0:
        value = range.min;
        break;
      case 1:
        value = range.max;
        break;
      default:
        value = std::uniform_int_distribution<std::int64_t>(range.min, range.max)(random_);
    }
  }
  void on_field(std::string_view, float& value, config::RealRange range, const char*, const char*) {
    value = static_cast<float>(real(range));
  }
  void on_field(std::string_view, double& value, config::RealRange range, const char*, const char*) {
    value = real(range);
  }
  void on_field(std::string_view, Vec3& value, config::RealRange range, const char*, const char*) {
    for (int axis = 0; axis < 3; ++axis) value[axis] = static_cast<float>(real(range));
  }
  void on_field(std::string_view, GraphPoint& value, config::RealRange range, const char*, const char*) {
    value = {};
    if (pick(2) == 1) value = {real(range), real(range), true};
  }
  void on_field(std::string_view, GridSize& value, config::IntRange range, const char*, const char*) {
    value = {};
    if (pick(2) == 1) {
      field("", value.columns, range, "", "");
      field("", value.rows, range, "", "");
    }
  }
  void on_field(std::string_view, bool& value, const char*, const char*) { value = pick(2) == 1; }
  void on_field(std::string_view, std::string& value, const char*, const char*) {
    static const char* const kTexts[] = {"a.glb",
                                         "true",
                                         "12",
                                         "null",
                                         "with space",
                                         "q\"uote\\",
                                         "# no comment",
                                         "\xc3\xa9t\xc3\xa9",
                                         "line\nbreak\ttab",
                                         "- a",
                                         "a: b",
                                         "0x1f",
                                         "[",
                                         " "};
    value = kTexts[pick(std::size(kTexts))];
  }
  void on_field_or_auto(std::string_view, std::optional<std::int64_t>& value, config::IntRange range, const char*,
                        const char*) {
    value.reset();
    if (pick(2) == 1) field("", value.emplace(), range, "", "");
  }
  template <class T>
  void on_field_or_auto(std::string_view, std::optional<T>& value, config::RealRange range, const char*, const char*) {
    value.reset();
    if (pick(2) == 1) field("", value.emplace(), range, "", "");
  }
  template <class E>
  void on_choice(std::string_view, E& value, const char*) {
    value = kEnumNames<E>[pick(kEnumNames<E>.size())].value;
  }
  template <class E>
  void on_choice(std::string_view, std::optional<E>& value, const char*) {
    value.reset();
    if (pick(2) == 1) choice("", value.emplace(), "");
  }
  template <class T>
  void section(std::string_view, T& value, const char*) {
    fill(value);
  }
  template <class T>
  void section(std::string_view, std::optional<T>& value, const char*) {
    value.reset();
    if (pick(2) == 1) fill(value.emplace());
  }
  void on_section_or_number(std::string_view, TesterUnits& value, const char*) { fill(value); }
  template <class T>
  void section_or_choice(std::string_view, T& value, const char*) {
    fill(value);
  }
  template <class T>
  void section_or_text(std::string_view, T& value, const char*) {
    fill(value);
    if (value.standard.empty()) value.standard = "constant";  // an empty text is not written
  }
  template <class T>
  void list(std::string_view, std::vector<T>& value, const char*) {
    value.resize(pick(3));
    for (T& item : value) fill(item);
  }
  template <class E>
  void choices(std::string_view, std::vector<E>& value, const char*) {
    value.resize(pick(3));
    for (E& item : value) choice("", item, "");
  }
  void texts(std::string_view, std::vector<std::string>& value, const char*) { value.clear(); }  // which are opened
  void effects(std::string_view, ShadingConfig::Effects& value, const char*) {
    using Choice = ShadingConfig::Effects::Choice;
    value.choice = std::array{Choice::kAuto, Choice::kAll, Choice::kList}[pick(3)];
    value.names.clear();
    if (value.choice == Choice::kList) value.names = {"sky", "clearcoat"};
  }
  void workload(std::string_view, WorkloadConfig& value, const char*) {
    using Kind = WorkloadConfig::Kind;
    value = {};
    value.kind = std::array{Kind::kRays, Kind::kRaysFrom, Kind::kTraffic}[pick(3)];
    if (value.kind == Kind::kRaysFrom) field("", value.rays_from, "", "");
    if (value.kind == Kind::kTraffic) fill(value.traffic);
  }
  void others(std::map<std::string, std::int64_t>& value, config::IntRange range, const char*, const char*) {
    value.clear();
    if (pick(2) == 1) value = {{"far", range.min}, {"slow_link", range.max}};
  }
  void others(std::map<std::string, double>& value, config::RealRange range, const char*, const char*) {
    value.clear();
    if (pick(2) == 1) value = {{"big", real(range)}, {"small", real(range)}};
  }
  template <class T>
  void members(std::map<std::string, T>& value, const char*) {
    value.clear();
    if (pick(2) == 1) fill(value["one"]);
  }
  void vary(std::string_view, std::map<std::string, std::vector<std::string>>& value, const char*) {
    value.clear();
    if (pick(2) == 1) value = {{"packets.rays", {"1", "2..8*2"}}, {"verify,engine.kind", {"(none,native)"}}};
  }

 private:
  std::size_t pick(std::size_t count) { return std::uniform_int_distribution<std::size_t>(0, count - 1)(random_); }
  double real(config::RealRange range) {
    switch (pick(4)) {
      case 0:
        return range.above_min ? range.max : range.min;
      case 1:
        return range.max;
      case 2:
        return range.min + (range.max - range.min) * 1e-9 * double(1 + pick(1000));
      default:
        return range.min + (range.max - range.min) * (double(1 + pick(1000)) / 1000);
    }
  }

  std::mt19937_64 random_;
};

/// Every field in its range and exactly one scene; the rules across fields need not hold.
inline Config random_config(std::uint64_t seed) {
  Config config;
  RandomFiller(seed).fill(config);
  if (config.scene.builtin) config.scene.file.clear();
  return config;
}

}  // namespace carousel

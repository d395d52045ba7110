#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "core/config/fields/field.h"
#include "core/config/fields/shading.h"
#include "core/config/fields/testers.h"
#include "core/config/fields/topology.h"
#include "core/config/fields/workload.h"
#include "core/config/tree/tree.h"
#include "core/types/added_names.h"
#include "core/types/vec.h"

namespace carousel::config {

/// The visitor that fills a Config from a tree. Nothing is thrown: what is wrong becomes an issue, and the
/// field keeps its default.
class Reader : public RowVisitor<Reader> {
 public:
  /// `plugins`: the files of plugins whose names count.
  Reader(std::vector<ConfigIssue>& issues, const TestersConfig& base, Origins plugins = {})
      : issues_(issues), base_testers_(base), plugins_(plugins) {}

  /// Reads the whole struct from `node`.
  template <class T>
  void read(const Node& node, T& value) {
    if (node.kind != Node::Kind::kMap) return wrong(node, "a map");
    scopes_.push_back({&node, {}});
    describe(*this, value);
    report_unknown(scopes_.back());
    scopes_.pop_back();
  }

  void on_field(std::string_view key, std::int64_t& value, IntRange range, const char* unit, const char*);
  void on_field(std::string_view key, float& value, RealRange range, const char* unit, const char*);
  void on_field(std::string_view key, double& value, RealRange range, const char* unit, const char*);
  void on_field(std::string_view key, Vec3& value, RealRange range, const char* unit, const char*);
  void on_field(std::string_view key, GridSize& value, IntRange range, const char* unit, const char*);
  void on_field(std::string_view key, GraphPoint& value, RealRange range, const char* unit, const char*);
  void on_field(std::string_view key, bool& value, const char*, const char*);
  void on_field(std::string_view key, std::string& value, const char*, const char*);
  void on_field_or_auto(std::string_view key, std::optional<std::int64_t>& value, IntRange range, const char* unit,
                        const char*);
  void on_field_or_auto(std::string_view key, std::optional<float>& value, RealRange range, const char* unit,
                        const char*);
  void on_field_or_auto(std::string_view key, std::optional<Vec3>& value, RealRange range, const char* unit,
                        const char*);

  template <class E>
  void on_choice(std::string_view key, E& value, const char*) {
    const Visit visit(*this, key);
    if (!visit.node) return;
    if (const auto chosen = choose<E>(*visit.node)) value = *chosen;
  }
  template <class E>
  void on_choice(std::string_view key, std::optional<E>& value, const char* meaning) {
    E chosen{};
    const std::size_t before = issues_.size();
    on_choice(key, chosen, meaning);
    if (issues_.size() == before && scopes_.back().node->find(key)) value = chosen;
  }

  template <class T>
  void section(std::string_view key, T& value, const char*) {
    const Visit visit(*this, key);
    if (visit.node) read(*visit.node, value);
  }
  template <class T>
  void section(std::string_view key, std::optional<T>& value, const char*) {
    const Visit visit(*this, key);
    if (!visit.node) return;
    T& made = value.emplace();
    if constexpr (std::is_same_v<T, TestersConfig>) made = base_testers_;
    read(*visit.node, made);
  }
  template <class Key, class T>
  Row own_key(const Key& row, T& value) {
    scopes_.back().own = true;
    on_field_or_auto(row.name, value, row.range, row.unit, row.meaning);
    return {};
  }

  void on_section_or_number(std::string_view key, TesterUnits& value, const char*);
  template <class T>
  void section_or_choice(std::string_view key, T& value, const char*) {
    const Visit visit(*this, key);
    if (!visit.node) return;
    if (visit.node->kind == Node::Kind::kMap) return read(*visit.node, value);
    if (const auto chosen = choose<decltype(value.hits)>(*visit.node)) value.hits = *chosen;
  }
  template <class T>
  void section_or_text(std::string_view key, T& value, const char* meaning) {
    const Node* const node = scopes_.back().node->find(key);
    if (node != nullptr && node->kind == Node::Kind::kMap) return section(key, value, meaning);
    on_field(key, value.standard, "", meaning);
  }
  template <class T>
  void list(std::string_view key, std::vector<T>& value, const char*) {
    const Visit visit(*this, key);
    if (!visit.node) return;
    if (visit.node->kind != Node::Kind::kSeq) return wrong(*visit.node, "a list");
    value.clear();
    for (const Node& item : visit.node->items) {
      path_.push_back(std::to_string(value.size()));
      T& made = value.emplace_back();
      if constexpr (std::is_same_v<T, ResourceOverride>) made.testers = base_testers_;
      require(item, T::kRequired);
      read(item, made);
      path_.pop_back();
    }
  }
  template <class E>
  void choices(std::string_view key, std::vector<E>& value, const char*) {
    const Visit visit(*this, key);
    if (!visit.node) return;
    if (visit.node->kind != Node::Kind::kSeq) return wrong(*visit.node, "a list");
    value.clear();
    for (const Node& item : visit.node->items)
      if (const auto chosen = choose<E>(item)) value.push_back(*chosen);
  }
  void texts(std::string_view key, std::vector<std::string>& value, const char*);
  void effects(std::string_view key, ShadingConfig::Effects& value, const char*);
  void workload(std::string_view key, WorkloadConfig& value, const char*);
  void vary(std::string_view key, std::map<std::string, std::vector<std::string>>& value, const char*);
  void others(std::map<std::string, std::int64_t>& value, IntRange range, const char* unit, const char*);
  void others(std::map<std::string, double>& value, RealRange range, const char* unit, const char*);
  template <class T>
  void members(std::map<std::string, T>& value, const char*) {
    const Node* const node = scopes_.back().node;
    for (const Member& member : node->members) {
      const Visit visit(*this, member.key);
      read(member.value, value[member.key]);
    }
  }

 private:
  struct Scope {
    const Node* node;
    std::vector<std::string> known;  ///< keys asked for
    bool own = false;                ///< it says in what a resource differs
  };

  /// Looks a key up in the innermost map and extends the path while its value is read.
  struct Visit {
    Visit(Reader& r, std::string_view key);
    ~Visit() { reader.path_.pop_back(); }
    Visit(const Visit&) = delete;
    Visit& operator=(const Visit&) = delete;
    Reader& reader;
    const Node* node;  ///< null when the key is not given
  };

  /// The value of the enum that a node names.
  template <class E>
  std::optional<E> choose(const Node& node) {
    const auto values = named_values<E>(plugins_);
    std::vector<std::string> names;
    names.reserve(values.size());
    for (const auto& [name, value] : values) names.push_back(name);
    const auto index = choose(node, names);
    return index ? std::optional(values[*index].second) : std::nullopt;
  }

  template <class Real>
  void real(std::string_view key, Real& value, RealRange range, const char* unit);
  /// True if the key says auto.
  bool is_auto(std::string_view key) const;
  void own_workload(WorkloadConfig& value);
  void vector(std::string_view key, Vec3& value, RealRange range, const char* unit, const char* expected);
  std::optional<std::size_t> choose(const Node& node, const std::vector<std::string>& names);
  void report_unknown(const Scope& frame);
  static std::optional<std::string> shared_text(const std::string& key);
  /// A map has the key, unless that is empty.
  void require(const Node& node, std::string_view key);
  void wrong(const Node& node, const std::string& expected, const std::string& hint = "");
  std::string path() const;

  std::vector<ConfigIssue>& issues_;
  TestersConfig base_testers_;  ///< values that an override of the testers starts from
  Origins plugins_;
  std::vector<Scope> scopes_;
  std::vector<std::string> path_;
};

}  // namespace carousel::config

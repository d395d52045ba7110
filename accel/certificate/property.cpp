#include "accel/certificate/property.h"

#include "core/config/fields/accuracy.h"
#include "core/types/enum_names.h"

namespace carousel::accel {

namespace {

/// Calls `body` with the member of `level` that a key names.
template <class Body>
void with_key(AccuracyKey key, AccuracyConfig& level, const Body& body) {
  switch (key) {
    case AccuracyKey::kTriangle:
      return body(level.triangle);
    case AccuracyKey::kBox:
      return body(level.box);
    case AccuracyKey::kTransform:
      return body(level.transform);
    case AccuracyKey::kSpawn:
      return body(level.spawn);
  }
}

}  // namespace

std::vector<AccuracyConfig> levels_of(const Property& property) {
  std::vector<AccuracyConfig> levels{AccuracyConfig{}};
  for (const AccuracyKey key : property.keys) {
    std::vector<AccuracyConfig> more;
    for (AccuracyConfig level : levels)
      with_key(key, level, [&]<class E>(E& value) {
        for (const auto& name : kEnumNames<E>) {
          value = name.value;
          more.push_back(level);
        }
      });
    levels = std::move(more);
  }
  return levels;
}

std::string level_name(const Property& property, const AccuracyConfig& level) {
  std::string text;
  AccuracyConfig copy = level;
  for (const AccuracyKey key : property.keys)
    with_key(key, copy, [&](const auto& value) { text += (text.empty() ? "" : "/") + std::string(enum_name(value)); });
  return text;
}

}  // namespace carousel::accel

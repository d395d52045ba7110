#pragma once

#include <string>
#include <vector>

namespace carousel::scene {

struct SchemaRule;
using Schema = std::vector<SchemaRule>;

enum class SchemaKind {
  kBoolean,
  kString,
  kStrings,     ///< array of strings
  kName,        ///< one of `names`
  kInteger,     ///< in [min, max]
  kChoice,      ///< one of `choices`
  kNumber,      ///< finite in single precision, in [min, max]
  kNumbers,     ///< array of `length` such numbers (0: any)
  kIndex,       ///< into the array at JSON path `refers_to`
  kIndices,     ///< array of such
  kIndexMap,    ///< object of such
  kIndexMaps,   ///< array of such objects
  kIntegerMap,  ///< object of integers in [min, max]
  kObject,      ///< with the rules of `child`
  kObjects,     ///< array of such
  kExtras,      ///< with the rules of `child` if it is an object; other values belong to other programs and are ignored
};

/// The rule for one key of a JSON object.
struct SchemaRule {
  const char* key;
  SchemaKind kind;
  bool required = false;
  bool posed_only = false;  ///< read where a pose is shown; otherwise the key may hold anything, and is left out
  double min = -3.4028234663852886e38, max = 3.4028234663852886e38;
  std::size_t length = 0;
  const char* refers_to = nullptr;
  std::vector<std::string> names = {};
  std::vector<int> choices = {};
  const Schema* child = nullptr;
};

/// The rules of a whole glTF 2.0 file: the specification's schema, as far as the importer reads it.
const Schema& gltf_schema();

}  // namespace carousel::scene

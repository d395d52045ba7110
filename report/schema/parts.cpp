#include "report/schema/parts.h"

#include "report/schema/checksum.h"

namespace carousel::report::schema {

using Json = nlohmann::ordered_json;

namespace {

Json described(Json schema, const char* meaning) {
  if (*meaning) schema["description"] = meaning;
  return schema;
}

}  // namespace

Json typed(const char* type, const char* meaning, const char* unit) {
  Json out{{"type", type}};
  if (*unit) out["unit"] = unit;
  return described(std::move(out), meaning);
}

Json count(const char* meaning, const char* unit) {
  Json out{{"type", "integer"}, {"minimum", 0}, {"maximum", kMostCount}};
  if (*unit) out["unit"] = unit;
  return described(std::move(out), meaning);
}

Json scalar(const char* meaning, bool may_be_null) {
  Json types{"string", "number", "boolean"};
  if (may_be_null) types.push_back("null");
  return described({{"type", std::move(types)}}, meaning);
}

Json list(Json items, const char* meaning) {
  return described({{"type", "array"}, {"items", std::move(items)}}, meaning);
}

Json map(Json values, const char* meaning) {
  return described({{"type", "object"}, {"additionalProperties", std::move(values)}}, meaning);
}

Json object(std::initializer_list<Key> keys, const char* meaning) {
  Json properties = Json::object(), required = Json::array();
  for (const Key& key : keys) {
    properties[key.name] = key.schema;
    if (key.required) required.push_back(key.name);
  }
  return described({{"type", "object"},
                    {"properties", std::move(properties)},
                    {"required", std::move(required)},
                    {"additionalProperties", false}},
                   meaning);
}

Key checksum(bool required) {
  return {"checksum", typed("string", kChecksumMeaning), required};
}

}  // namespace carousel::report::schema

#pragma once

#include <cstdint>
#include <initializer_list>
#include <string>

#include <nlohmann/json.hpp>

namespace carousel::report::schema {

// Pieces of JSON Schema (draft 2020-12) for documents that are written without a description of structs.

/// The greatest whole number that every reader of JSON holds exactly.
inline constexpr std::int64_t kMostCount = (std::int64_t{1} << 53) - 1;

/// A value of a type: string, boolean, number, integer.
nlohmann::ordered_json typed(const char* type, const char* meaning, const char* unit = "");
/// A whole number from 0 on.
nlohmann::ordered_json count(const char* meaning, const char* unit = "");
/// A number, a text or a switch; null as well, where there may be none.
nlohmann::ordered_json scalar(const char* meaning, bool may_be_null = false);
nlohmann::ordered_json list(nlohmann::ordered_json items, const char* meaning);
/// An object with any keys, all of whose values are of one kind.
nlohmann::ordered_json map(nlohmann::ordered_json values, const char* meaning);

struct Key {
  std::string name;
  nlohmann::ordered_json schema;
  bool required = true;
};
/// An object with these keys and no others.
nlohmann::ordered_json object(std::initializer_list<Key> keys, const char* meaning = "");

/// The last key of a document (report/read/document.h).
Key checksum(bool required = false);

}  // namespace carousel::report::schema

#pragma once

#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

#include "report/markup/markup.h"

namespace carousel::report::html {

/// RFC 4648.
std::string base64(std::string_view bytes);

/// The file format of RFC 1952, as DecompressionStream("gzip") reads it.
std::string gzipped(std::string_view bytes);

/// The script elements with the time series of a report: a head in JSON, and all samples in one block, gzipped, in
/// base64. A row is `samples` words of 32 bits, each the difference from the word before it (modulo 2^32), with the
/// lowest bytes of all words first, then the next ones: equal bytes then stand together. The words are whole numbers
/// (`int`) if all of the row are, otherwise floats (`float`). web/src/series.js unpacks it. The elements are `id`-head
/// and `id`-words; any head with `samples` and `rows` that have `values` may be packed so.
Html packed_series(const nlohmann::ordered_json& time_series, const char* id = "series");

}  // namespace carousel::report::html

#include "report/html/packed_series.h"

#include <bit>
#include <cmath>
#include <cstdint>
#include <vector>

#include <boost/archive/iterators/base64_from_binary.hpp>
#include <boost/archive/iterators/transform_width.hpp>
#include <zlib.h>

#include "core/system/error.h"

namespace carousel::report::html {

namespace {

using Json = nlohmann::ordered_json;

bool whole(const std::vector<double>& values) {
  for (const double v : values)
    if (v != std::floor(v) || std::abs(v) > 2147483647.0) return false;
  return true;
}

void append_row(std::string& block, const std::vector<double>& values, bool ints) {
  const std::size_t n = values.size(), begin = block.size();
  block.resize(begin + 4 * n);
  std::uint32_t last = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const std::uint32_t word = ints ? static_cast<std::uint32_t>(static_cast<std::int32_t>(values[i]))
                                    : std::bit_cast<std::uint32_t>(static_cast<float>(values[i]));
    const std::uint32_t step = word - last;
    for (std::size_t b = 0; b < 4; ++b) block[begin + b * n + i] = static_cast<char>(step >> (8 * b));
    last = word;
  }
}

}  // namespace

std::string base64(std::string_view bytes) {
  using namespace boost::archive::iterators;
  using Iterator = base64_from_binary<transform_width<std::string::const_iterator, 6, 8>>;
  const std::size_t padding = (3 - bytes.size() % 3) % 3;
  std::string padded(bytes);
  padded.append(padding, '\0');
  std::string out(Iterator(padded.cbegin()), Iterator(padded.cend()));
  out.replace(out.size() - padding, padding, padding, '=');
  return out;
}

std::string gzipped(std::string_view bytes) {
  constexpr int kWindow = 15 + 16;  // + 16: with gzip's header
  z_stream stream{};
  if (deflateInit2(&stream, 6, Z_DEFLATED, kWindow, 9, Z_DEFAULT_STRATEGY) != Z_OK)
    throw SimulationError("zlib cannot begin to compress");
  std::string out(deflateBound(&stream, bytes.size()), '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  const int status = deflate(&stream, Z_FINISH);
  out.resize(stream.total_out);
  deflateEnd(&stream);
  if (status != Z_STREAM_END) throw SimulationError("zlib did not compress to the end");
  return out;
}

Html packed_series(const Json& time_series, const char* id) {
  Json head = time_series;
  std::string block;
  for (Json& row : head["rows"]) {
    const std::vector<double> values = row["values"].get<std::vector<double>>();
    const bool ints = whole(values);
    append_row(block, values, ints);
    row.erase("values");
    row["words"] = ints ? "int" : "float";
  }
  return json_script(std::string(id) + "-head", head) +
         markup("<script type=\"application/octet-stream\" id=\"{}-words\">{}</script>\n", id, base64(gzipped(block)));
}

}  // namespace carousel::report::html

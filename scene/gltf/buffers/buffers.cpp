#include "scene/gltf/buffers/buffers.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstring>
#include <fstream>
#include <string_view>

namespace carousel::scene {

namespace {

constexpr std::uint64_t kMostImageBytes = 0x7fffffff;  // tinygltf passes image sizes as int

std::string percent_decoded(std::string_view text) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto digit = [&](std::size_t at) {
      return at < text.size() && std::isxdigit(static_cast<unsigned char>(text[at])) != 0;
    };
    if (text[i] == '%' && digit(i + 1) && digit(i + 2)) {
      out += static_cast<char>(std::stoi(std::string(text.substr(i + 1, 2)), nullptr, 16));
      i += 2;
    } else {
      out += text[i];
    }
  }
  return out;
}

/// "http" of "http://..."; also the drive letter of a Windows path.
std::string_view scheme_of(std::string_view uri) {
  const std::size_t end = uri.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789+.-");
  return end != std::string_view::npos && end > 0 && uri[end] == ':' ? uri.substr(0, end) : std::string_view{};
}

std::string shown(const std::string& uri) {
  return uri.size() <= 80 ? uri : uri.substr(0, 77) + "...";
}

}  // namespace

std::optional<Bytes> decode_base64(std::string_view text, std::uint64_t most_bytes) {
  static const std::array<signed char, 256> values = [] {
    std::array<signed char, 256> table;
    table.fill(-1);
    constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (std::size_t i = 0; i < kDigits.size(); ++i) {
      table[static_cast<unsigned char>(kDigits[i])] = static_cast<signed char>(i);
    }
    return table;
  }();
  for (int padding = 0; padding < 2 && text.ends_with('='); ++padding) text.remove_suffix(1);
  if (text.size() % 4 == 1) return std::nullopt;
  Bytes out;
  out.reserve(std::min<std::uint64_t>(text.size() / 4 * 3 + 2, most_bytes));
  std::uint32_t bits = 0;
  int held = 0;
  for (const char c : text) {
    const int value = values[static_cast<unsigned char>(c)];
    if (value < 0) return std::nullopt;
    bits = bits << 6 | static_cast<std::uint32_t>(value);
    held += 6;
    if (held < 8) continue;
    held -= 8;
    if (out.size() < most_bytes) out.push_back(static_cast<unsigned char>(bits >> held));
  }
  return out;
}

std::optional<Bytes> GltfResources::buffer(std::size_t index) const {
  const Json& buffer = document_.json["buffers"][index];
  const std::string path = json_path("/buffers", index);
  const auto length = buffer["byteLength"].get<std::uint64_t>();
  Bytes bytes;
  if (buffer.contains("uri")) {
    bytes = read_uri(buffer["uri"].get_ref<const std::string&>(), json_path(path, "uri"), length);
  } else if (index == 0 && document_.is_glb && !document_.binary_chunk.empty()) {
    const auto* first = reinterpret_cast<const unsigned char*>(document_.binary_chunk.data());
    bytes.assign(first, first + std::min<std::uint64_t>(length, document_.binary_chunk.size()));
  } else {
    return std::nullopt;
  }
  if (bytes.size() < length) {
    document_.fail(json_path(path, "byteLength"),
                   std::to_string(length) + " bytes are announced, the data has " + std::to_string(bytes.size()));
  }
  budget_.take(bytes.size(), path, "the buffer");
  return bytes;
}

Bytes GltfResources::image(std::size_t index) const {
  const std::string path = json_path(json_path("/images", index), "uri");
  Bytes bytes = read_uri(document_.json["images"][index]["uri"].get_ref<const std::string&>(), path, kMostImageBytes);
  if (bytes.empty()) document_.fail(path, "holds no data");
  return bytes;
}

Bytes GltfResources::read_uri(const std::string& uri, const std::string& path, std::uint64_t most_bytes) const {
  if (!uri.starts_with("data:")) return read_file(uri, path, most_bytes);
  const std::size_t comma = uri.find(',');
  if (comma == std::string::npos || !std::string_view(uri).substr(0, comma).ends_with(";base64")) {
    document_.fail(path, "expected a data: URI in base64");
  }
  const auto loan = budget_.lend(std::min<std::uint64_t>(uri.size() / 4 * 3, most_bytes), path, "the data");
  std::optional<Bytes> bytes = decode_base64(std::string_view(uri).substr(comma + 1), most_bytes);
  if (!bytes) document_.fail(path, "the data: URI is not proper base64");
  return std::move(*bytes);
}

Bytes GltfResources::read_file(const std::string& uri, const std::string& path, std::uint64_t most_bytes) const {
  if (const std::string_view scheme = scheme_of(uri); !scheme.empty()) {
    document_.fail(path, "'" + shown(uri) + "': " + std::string(scheme) +
                             ": addresses are not fetched; expected a data: URI or a relative path");
  }
  const std::string name = percent_decoded(uri);
  if (name.empty() || name.find('\0') != std::string::npos) document_.fail(path, "expected the path of a file");
  if (name[0] == '/' || name[0] == '\\') {
    document_.fail(path, "'" + shown(uri) + "': absolute paths are refused; expected a path relative to the glTF file");
  }
  const std::filesystem::path relative = std::filesystem::path(name).lexically_normal();
  if (std::ranges::count(relative, std::filesystem::path("..")) > 2) {
    document_.fail(path, "'" + shown(uri) + "': leads more than two folders above the glTF file");
  }
  if (!folder_) document_.fail(path, "'" + shown(uri) + "': a scene in memory cannot refer to other files");
  const std::filesystem::path full = *folder_ / relative;
  std::error_code error;
  // Only plain files: a pipe or a device would never end.
  if (!std::filesystem::is_regular_file(full, error)) document_.fail(path, "'" + shown(uri) + "': no such file");
  const std::uintmax_t size = std::filesystem::file_size(full, error);
  std::ifstream stream(full, std::ios::binary);
  if (error || !stream) document_.fail(path, "'" + shown(uri) + "': cannot be read");
  const auto loan = budget_.lend(std::min<std::uintmax_t>(size, most_bytes), path, "the file");
  Bytes bytes(static_cast<std::size_t>(std::min<std::uintmax_t>(size, most_bytes)));
  stream.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  if (static_cast<std::size_t>(stream.gcount()) != bytes.size())
    document_.fail(path, "'" + shown(uri) + "': reading failed");
  return bytes;
}

}  // namespace carousel::scene

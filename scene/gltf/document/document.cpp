#include "scene/gltf/document/document.h"

#include <algorithm>
#include <cstring>
#include <stdexcept>
#include <vector>

#include "core/system/error.h"

namespace carousel::scene {

namespace {

constexpr std::size_t kDeepestNesting = 128;
constexpr std::uint32_t kGlbMagic = 0x46546c67;  // "glTF"
constexpr std::uint32_t kJsonChunk = 0x4e4f534a, kBinaryChunk = 0x004e4942;

std::uint32_t read_u32(std::span<const std::byte> bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (int i = 3; i >= 0; --i)
    value = value << 8 | std::to_integer<std::uint32_t>(bytes[at + static_cast<std::size_t>(i)]);
  return value;
}

/// Finds values that are nested too deeply, without recursion, in any text, valid JSON or not.
class NestingScan {
 public:
  NestingScan(const GltfDocument& document, std::string_view text) : document_(document), text_(text) {}

  void run() {
    for (at_ = 0; at_ < text_.size(); ++at_) {
      switch (text_[at_]) {
        case '"':
          skip_string();
          break;
        case '{':
        case '[':
          open();
          break;
        case '}':
        case ']':
          if (!levels_.empty()) levels_.pop_back();
          break;
        case ':':
          if (!levels_.empty()) levels_.back().key = last_string_;
          break;
        case ',':
          if (!levels_.empty()) ++levels_.back().index;
          break;
        default:
          break;
      }
    }
  }

 private:
  struct Level {
    bool is_array;
    std::size_t index;
    std::string_view key;
  };

  void skip_string() {
    const std::size_t first = ++at_;
    while (at_ < text_.size() && text_[at_] != '"') at_ += text_[at_] == '\\' ? 2 : 1;
    last_string_ = text_.substr(std::min(first, text_.size()), at_ - first);
  }

  void open() {
    if (levels_.size() == kDeepestNesting) {
      std::string path;
      for (std::size_t i = 0; i < 6; ++i) {  // enough to find the place
        path = levels_[i].is_array ? json_path(path, levels_[i].index) : json_path(path, levels_[i].key.substr(0, 64));
      }
      document_.fail(path, "nested more than 128 levels deep (at byte " + std::to_string(at_) + ")");
    }
    levels_.push_back({text_[at_] == '[', 0, {}});
  }

  const GltfDocument& document_;
  std::string_view text_, last_string_;
  std::size_t at_ = 0;
  std::vector<Level> levels_;
};

std::string_view split_glb(GltfDocument& document, std::span<const std::byte> bytes) {
  if (bytes.size() < 12)
    document.fail("", "GLB header is cut off: 12 bytes expected, " + std::to_string(bytes.size()) + " found");
  const std::uint32_t version = read_u32(bytes, 4), length = read_u32(bytes, 8);
  if (version != 2) document.fail("", "GLB container version " + std::to_string(version) + "; only version 2 is read");
  if (length > bytes.size()) {
    document.fail("", "GLB header gives a length of " + std::to_string(length) + " bytes, the file has " +
                          std::to_string(bytes.size()));
  }
  document.is_glb = true;
  std::string_view text;
  std::size_t at = 12;
  for (int chunk = 0; at < length; ++chunk) {
    if (length - at < 8) document.fail("", "GLB chunk header at byte " + std::to_string(at) + " is cut off");
    const std::uint32_t size = read_u32(bytes, at), type = read_u32(bytes, at + 4);
    at += 8;
    if (size > length - at) {
      document.fail("", "GLB chunk at byte " + std::to_string(at - 8) + " says " + std::to_string(size) + " bytes, " +
                            std::to_string(length - at) + " are left");
    }
    if (chunk == 0 && type != kJsonChunk) document.fail("", "the first GLB chunk is not JSON");
    if (chunk == 0) text = {reinterpret_cast<const char*>(bytes.data()) + at, size};
    if (chunk == 1 && type == kBinaryChunk) document.binary_chunk = bytes.subspan(at, size);
    at += size;
  }
  if (text.empty()) document.fail("", "GLB without a JSON chunk");
  return text;
}

void check_version(const GltfDocument& document) {
  const Json& json = document.json;
  const auto asset = json.find("asset");
  if (asset == json.end() || !asset->is_object()) document.fail("/asset", "missing: this is not a glTF 2.0 file");
  const auto check = [&](const char* key, bool required) {
    const std::string path = json_path("/asset", key);
    const auto entry = asset->find(key);
    if (entry == asset->end()) {
      if (required) document.fail(path, "missing: this is not a glTF 2.0 file");
      return;
    }
    if (!entry->is_string()) document.fail(path, "expected a string such as \"2.0\"");
    const auto& text = entry->get_ref<const std::string&>();
    const bool readable = required ? text.starts_with("2.") : text == "2.0";
    if (!readable) document.fail(path, "glTF version \"" + text.substr(0, 32) + "\"; only 2.0 is read");
  };
  check("version", true);
  check("minVersion", false);
}

}  // namespace

std::string json_path(const std::string& path, std::string_view key) {
  std::string out = path + '/';
  for (const char c : key) {
    if (c == '~')
      out += "~0";
    else if (c == '/')
      out += "~1";
    else
      out += c;
  }
  return out;
}

std::string json_path(const std::string& path, std::size_t index) {
  return path + '/' + std::to_string(index);
}

void GltfDocument::fail(const std::string& path, const std::string& message) const {
  throw SceneError(file, path, message);
}

bool lists_extension(const GltfDocument& document, const char* list, const char* extension) {
  const auto entry = document.json.find(list);
  return entry != document.json.end() && std::ranges::find(*entry, Json(extension)) != entry->end();
}

MemoryBudget::Loan ImportBudget::lend(std::uint64_t bytes, const std::string& path, const std::string& what) const {
  try {
    return memory_.lend(bytes);
  } catch (const std::length_error& error) {
    document_.fail(path, what + " " + error.what());
  }
}

void ImportBudget::take(std::uint64_t bytes, const std::string& path, const std::string& what) const {
  try {
    memory_.take(bytes);
  } catch (const std::length_error& error) {
    document_.fail(path, what + " " + error.what());
  }
}

GltfDocument parse_document(std::span<const std::byte> bytes, const std::string& file) {
  GltfDocument document;
  document.file = file;
  if (bytes.empty()) document.fail("", "the file is empty");
  const bool glb = bytes.size() >= 4 && read_u32(bytes, 0) == kGlbMagic;
  const std::string_view text =
      glb ? split_glb(document, bytes) : std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  NestingScan(document, text).run();
  try {
    document.json = Json::parse(text);
  } catch (const Json::exception& e) {
    // nlohmann's text starts with its own error name and number in brackets.
    const std::string what = e.what();
    const std::size_t end = what.find("] ");
    document.fail("", "not a glTF file: " + (end == std::string::npos ? what : what.substr(end + 2)));
  }
  if (!document.json.is_object()) document.fail("", "expected a JSON object");
  check_version(document);
  return document;
}

}  // namespace carousel::scene

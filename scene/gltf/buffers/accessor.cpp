#include "scene/gltf/buffers/accessor.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>
#include <utility>

#include "core/system/error.h"
#include "scene/gltf/document/uses.h"

namespace carousel::scene {

namespace {

int components_of(const std::string& type) {
  if (type == "SCALAR") return 1;
  const int n = type.back() - '0';  // VECn or MATn
  return type[0] == 'V' ? n : n * n;
}

/// Columns of matrices of small components start at multiples of 4 bytes (specification, 3.6.2.4).
std::size_t element_size(const std::string& type, Component component) {
  if (type[0] != 'M') return static_cast<std::size_t>(components_of(type)) * size_of(component);
  const auto n = static_cast<std::size_t>(type.back() - '0');
  return n * ((n * size_of(component) + 3) / 4 * 4);
}

template <class T>
T load(const unsigned char* from) {  // glTF and the machines we build for are little-endian
  T value;
  std::memcpy(&value, from, sizeof value);
  return value;
}

float to_float(const unsigned char* from, Component component, bool normalized) {
  switch (component) {
    case Component::kByte: {
      const float v = load<std::int8_t>(from);
      return normalized ? std::max(v / 127.0f, -1.0f) : v;
    }
    case Component::kUnsignedByte: {
      const float v = load<std::uint8_t>(from);
      return normalized ? v / 255.0f : v;
    }
    case Component::kShort: {
      const float v = load<std::int16_t>(from);
      return normalized ? std::max(v / 32767.0f, -1.0f) : v;
    }
    case Component::kUnsignedShort: {
      const float v = load<std::uint16_t>(from);
      return normalized ? v / 65535.0f : v;
    }
    case Component::kUnsignedInt:
      return static_cast<float>(load<std::uint32_t>(from));
    case Component::kFloat:
      return load<float>(from);
  }
  return 0;
}

std::uint32_t to_integer(const unsigned char* from, Component component) {
  switch (component) {
    case Component::kUnsignedByte:
      return load<std::uint8_t>(from);
    case Component::kUnsignedShort:
      return load<std::uint16_t>(from);
    default:
      return load<std::uint32_t>(from);
  }
}

}  // namespace

std::size_t size_of(Component component) {
  switch (component) {
    case Component::kByte:
    case Component::kUnsignedByte:
      return 1;
    case Component::kShort:
    case Component::kUnsignedShort:
      return 2;
    case Component::kUnsignedInt:
    case Component::kFloat:
      return 4;
  }
  return 4;
}

namespace {

/// The bytes of a buffer view, which check_links found to lie inside its buffer; none where that has no data.
std::span<const unsigned char> bytes_of(const Json& view, const GltfModel& model) {
  const auto buffer = view["buffer"].get<std::size_t>();
  if (!model.buffer_has_data[buffer]) return {};
  return std::span<const unsigned char>(model.model.buffers[buffer].data)
      .subspan(static_cast<std::size_t>(view.value("byteOffset", std::uint64_t{0})),
               static_cast<std::size_t>(view["byteLength"].get<std::uint64_t>()));
}

}  // namespace

AccessorTable::AccessorTable(const GltfDocument& document, const GltfModel& model,
                             const std::map<std::size_t, Bytes>& unpacked, const ImportBudget& budget,
                             const WarningSink& warn)
    : document_(document), budget_(budget) {
  const Json& json = document.json;
  const std::size_t views = json.contains("bufferViews") ? json["bufferViews"].size() : 0;
  for (std::size_t i = 0; i < views; ++i) {
    const auto entry = unpacked.find(i);
    views_.push_back(entry != unpacked.end() ? std::span<const unsigned char>(entry->second)
                                             : bytes_of(json["bufferViews"][i], model));
  }
  quantized_ = lists_extension(document, "extensionsUsed", "KHR_mesh_quantization");
  if (!json.contains("accessors")) return;
  const Json& accessors = json["accessors"];
  const Uses uses = uses_of(json, document.posing);
  accessors_.reserve(accessors.size());
  for (std::size_t i = 0; i < accessors.size(); ++i) {
    try {
      accessors_.push_back(parse(accessors[i], json_path("/accessors", i)));
    } catch (const SceneError& error) {
      if (uses.accessors[i]) throw;
      accessors_.emplace_back();
      if (warn) warn(std::string(error.what()) + "; ignored, since nothing that is shown uses it");
    }
  }
}

AccessorTable::Accessor AccessorTable::parse(const Json& json, const std::string& path) const {
  Accessor out;
  out.count = json["count"].get<std::uint64_t>();
  out.component = static_cast<Component>(json["componentType"].get<int>());
  out.type = json["type"].get<std::string>();
  out.components = components_of(out.type);
  out.normalized = json.value("normalized", false);
  const std::size_t size = element_size(out.type, out.component);
  if (json.contains("bufferView")) {
    out.views.push_back(json["bufferView"].get<std::size_t>());
    out.base = locate(out.views.back(), json.value("byteOffset", std::uint64_t{0}), out.count, size, true, path);
  }
  if (!json.contains("sparse")) return out;
  const Json& sparse = json["sparse"];
  Sparse parsed;
  parsed.count = sparse["count"].get<std::uint64_t>();
  if (parsed.count > out.count) {
    document_.fail(
        json_path(json_path(path, "sparse"), "count"),
        "expected at most the accessor's " + std::to_string(out.count) + ", found " + std::to_string(parsed.count));
  }
  parsed.index_component = static_cast<Component>(sparse["indices"]["componentType"].get<int>());
  const auto part = [&](const char* key, std::size_t part_size) {
    const Json& entry = sparse[key];
    out.views.push_back(entry["bufferView"].get<std::size_t>());
    return locate(out.views.back(), entry.value("byteOffset", std::uint64_t{0}), parsed.count, part_size, false,
                  json_path(json_path(path, "sparse"), key));
  };
  parsed.indices = part("indices", size_of(parsed.index_component));
  parsed.values = part("values", size);
  out.sparse = parsed;
  return out;
}

AccessorTable::Strided AccessorTable::locate(std::size_t view, std::uint64_t offset, std::uint64_t count,
                                             std::size_t size, bool may_stride, const std::string& path) const {
  const Json& json = document_.json["bufferViews"][view];
  const auto length = json["byteLength"].get<std::uint64_t>();
  const auto stride = may_stride ? json.value("byteStride", size) : size;
  if (stride < size) {
    document_.fail(path, "elements of " + std::to_string(size) + " bytes do not fit the stride of " +
                             std::to_string(stride) + " of buffer view " + std::to_string(view));
  }
  // count is at least 1 and everything below 2^53, so only the product could wrap: divide instead.
  if (offset > length || length - offset < size || (count - 1) > (length - offset - size) / stride) {
    document_.fail(path, std::to_string(count) + " elements of " + std::to_string(size) + " bytes, " +
                             std::to_string(stride) + " bytes apart, from byte " + std::to_string(offset) +
                             " on reach outside buffer view " + std::to_string(view) + ", which has " +
                             std::to_string(length) + " bytes");
  }
  if (views_[view].empty()) return {nullptr, stride};
  return {views_[view].data() + offset, stride};
}

void AccessorTable::replace(std::size_t index, Bytes bytes) {
  Accessor& accessor = accessors_[index];
  replacements_.push_back(std::move(bytes));
  accessor.base = {replacements_.back().data(), element_size(accessor.type, accessor.component)};
  accessor.sparse.reset();
  accessor.views.clear();
  accessor.replaced = true;
}

std::size_t AccessorTable::add_like(std::size_t index) {
  Accessor copy = accessors_[index];
  copy.base.reset();
  copy.sparse.reset();
  copy.views.clear();
  copy.replaced = false;
  accessors_.push_back(std::move(copy));
  return accessors_.size() - 1;
}

std::vector<std::uint32_t> AccessorTable::sparse_indices(std::size_t index) const {
  const Accessor& accessor = accessors_[index];
  const Sparse& sparse = *accessor.sparse;
  const std::string path = json_path(json_path("/accessors", index), "sparse") + "/indices";
  std::vector<std::uint32_t> out(static_cast<std::size_t>(sparse.count));
  for (std::size_t i = 0; i < out.size(); ++i) {
    out[i] = to_integer(sparse.indices.first + i * sparse.indices.stride, sparse.index_component);
    if (out[i] >= accessor.count) {
      document_.fail(path, "index " + std::to_string(out[i]) + " at position " + std::to_string(i) +
                               " is beyond the accessor's " + std::to_string(accessor.count) + " elements");
    }
    if (i > 0 && out[i] <= out[i - 1]) {
      document_.fail(path, "position " + std::to_string(i) + ": sparse indices must increase");
    }
  }
  return out;
}

template <class T, class Convert>
std::vector<T> AccessorTable::read(std::size_t index, const std::string& path, const Convert& convert) const {
  const Accessor& accessor = accessors_[index];
  const auto width = static_cast<std::size_t>(accessor.components);
  const std::size_t size = size_of(accessor.component);
  // The caller makes vectors of the numbers, and then forgets these.
  const auto loan = budget_.lend(2 * accessor.count * width * sizeof(T), path,
                                 "accessor " + std::to_string(index) + " asks for " + std::to_string(accessor.count) +
                                     " elements and " + "stores " +
                                     std::to_string(accessor.base     ? accessor.count
                                                    : accessor.sparse ? accessor.sparse->count
                                                                      : 0) +
                                     ", and");
  std::vector<T> out(static_cast<std::size_t>(accessor.count) * width);  // zero where there is no base
  const auto put = [&](const Strided& where, std::uint64_t from, std::size_t to) {
    const unsigned char* at = where.first + where.stride * static_cast<std::size_t>(from);
    for (std::size_t c = 0; c < width; ++c) out[to * width + c] = convert(at + c * size, accessor);
  };
  if (accessor.base) {
    for (std::size_t i = 0; i < accessor.count; ++i) put(*accessor.base, i, i);
  }
  if (accessor.sparse) {
    const std::vector<std::uint32_t> targets = sparse_indices(index);
    for (std::size_t i = 0; i < targets.size(); ++i) put(accessor.sparse->values, i, targets[i]);
  }
  return out;
}

std::vector<float> AccessorTable::floats(std::size_t index, const std::string& path) const {
  std::vector<float> out = read<float>(index, path, [](const unsigned char* from, const Accessor& accessor) {
    return to_float(from, accessor.component, accessor.normalized);
  });
  const auto bad = std::ranges::find_if(out, [](float v) { return !std::isfinite(v); });
  if (bad != out.end()) {
    const auto at = static_cast<std::size_t>(bad - out.begin());
    const auto width = static_cast<std::size_t>(accessors_[index].components);
    document_.fail(path, "component " + std::to_string(at % width) + " of element " + std::to_string(at / width) +
                             " of accessor " + std::to_string(index) + " is " +
                             (std::isnan(*bad) ? "NaN" : "infinite"));
  }
  return out;
}

double AccessorTable::last_scalar(std::size_t index) const {
  const Accessor& accessor = accessors_[index];
  float last = 0;
  const auto take = [&](const Strided& where, std::uint64_t element) {
    if (where.first == nullptr) return;
    last = to_float(where.first + where.stride * static_cast<std::size_t>(element), accessor.component,
                    accessor.normalized);
  };
  if (accessor.base && accessor.count > 0) take(*accessor.base, accessor.count - 1);
  if (const auto& sparse = accessor.sparse; sparse && sparse->count > 0 && sparse->indices.first != nullptr) {
    const unsigned char* const at =
        sparse->indices.first + sparse->indices.stride * static_cast<std::size_t>(sparse->count - 1);
    if (to_integer(at, sparse->index_component) + std::uint64_t{1} == accessor.count)
      take(sparse->values, sparse->count - 1);
  }
  return std::isfinite(last) ? last : 0;
}

std::vector<std::uint32_t> AccessorTable::integers(std::size_t index, const std::string& path) const {
  return read<std::uint32_t>(index, path, [](const unsigned char* from, const Accessor& accessor) {
    return to_integer(from, accessor.component);
  });
}

}  // namespace carousel::scene

// KHR_draco_mesh_compression. The stream's beginning is read here as well, by the Draco bitstream specification 2.2
// (google.github.io/draco/spec, 3 Draco decoder, 4.2 sequential and 5 edgebreaker connectivity), because the decoder
// allocates memory for the sizes that the stream declares.
#include "scene/gltf/buffers/draco.h"

#include <algorithm>
#include <cstring>
#include <exception>
#include <memory>
#include <new>
#include <optional>

#include <draco/compression/config/compression_shared.h>
#include <draco/compression/decode.h>
#include <draco/core/varint_decoding.h>
#include <draco/metadata/metadata_decoder.h>

#include "core/system/error.h"

namespace carousel::scene {

namespace {

constexpr std::int64_t kIndices = -1;
/// The memory that the decoder takes for connectivity, measured at its peak (docs/reference/gltf.md), and for each
/// component of an attribute: the decoded integer, the value and its copy.
constexpr std::uint64_t kBytesPerFace = 100, kBytesPerVertex = 80, kBytesPerComponent = 12;

using Stream = std::span<const unsigned char>;

/// The sizes that the stream declares; empty if it is no mesh of bitstream 2.2, the only kind that glTF allows.
struct Announced {
  std::uint32_t faces = 0, vertices = 0;
};
std::optional<Announced> announced(Stream bytes) {
  constexpr std::size_t kHeader = 11;
  constexpr unsigned char kMesh = 1, kSequential = 0, kMetadata = 0x80;
  if (bytes.size() < kHeader || std::memcmp(bytes.data(), "DRACO", 5) != 0) return std::nullopt;
  if (bytes[5] != 2 || bytes[6] != 2 || bytes[7] != kMesh) return std::nullopt;
  draco::DecoderBuffer in;
  in.Init(reinterpret_cast<const char*>(bytes.data()) + kHeader, bytes.size() - kHeader, 0x0202);
  if ((bytes[10] & kMetadata) != 0) {
    draco::GeometryMetadata ignored;
    if (!draco::MetadataDecoder().DecodeGeometryMetadata(&in, &ignored)) return std::nullopt;
  }
  Announced out;
  if (bytes[8] == kSequential) {
    if (!draco::DecodeVarint(&out.faces, &in) || !draco::DecodeVarint(&out.vertices, &in)) return std::nullopt;
    return out;
  }
  std::uint8_t traversal;
  if (!in.Decode(&traversal)) return std::nullopt;
  if (!draco::DecodeVarint(&out.vertices, &in) || !draco::DecodeVarint(&out.faces, &in)) return std::nullopt;
  return out;
}

/// `components` are those of all attributes that are wanted of the stream.
std::unique_ptr<draco::Mesh> decode_stream(const GltfDocument& document, const ImportBudget& budget,
                                           std::uint64_t components, Stream bytes, const std::string& path) {
  const auto broken = [&](const std::string& why) { document.fail(path, "the compressed data is broken: " + why); };
  try {
    const auto counts = announced(bytes);
    if (!counts) broken("not a mesh of Draco bitstream 2.2");
    const auto loan = budget.lend(
        counts->faces * kBytesPerFace + counts->vertices * (kBytesPerVertex + components * kBytesPerComponent), path,
        "the stream announces " + std::to_string(counts->faces) + " triangles and " + std::to_string(counts->vertices) +
            " vertices, and");
    draco::DecoderBuffer in;
    in.Init(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    auto result = draco::Decoder().DecodeMeshFromBuffer(&in);
    if (!result.ok()) broken(result.status().error_msg_string());
    return std::move(result).value();
  } catch (const SceneError&) {
    throw;
  } catch (const std::bad_alloc&) {
    broken("it asks for too much memory");
  } catch (const std::exception& e) {
    broken(e.what());
  }
  return nullptr;
}

template <class T>
bool copy_values(const draco::PointAttribute& from, std::size_t points, int width, Bytes& out) {
  out.resize(points * static_cast<std::size_t>(width) * sizeof(T));
  if (!from.is_mapping_identity() && from.indices_map_size() < points) return false;
  T value[4];
  for (std::size_t i = 0; i < points; ++i) {
    const auto at = from.mapped_index(draco::PointIndex(static_cast<std::uint32_t>(i)));
    if (at.value() >= from.size() || !from.ConvertValue<T>(at, static_cast<std::int8_t>(width), value)) return false;
    std::memcpy(out.data() + i * static_cast<std::size_t>(width) * sizeof(T), value,
                static_cast<std::size_t>(width) * sizeof(T));
  }
  return true;
}

bool copy_attribute(const draco::PointAttribute& from, std::size_t points, int width, Component component, Bytes& out) {
  switch (component) {
    case Component::kByte:
      return copy_values<std::int8_t>(from, points, width, out);
    case Component::kUnsignedByte:
      return copy_values<std::uint8_t>(from, points, width, out);
    case Component::kShort:
      return copy_values<std::int16_t>(from, points, width, out);
    case Component::kUnsignedShort:
      return copy_values<std::uint16_t>(from, points, width, out);
    case Component::kUnsignedInt:
      return copy_values<std::uint32_t>(from, points, width, out);
    case Component::kFloat:
      return copy_values<float>(from, points, width, out);
  }
  return false;
}

/// False when a vertex's number needs more room than the component has. Little-endian, as glTF is.
bool copy_indices(const draco::Mesh& from, Component component, Bytes& out) {
  const std::size_t size = size_of(component);
  const std::uint64_t end = std::uint64_t{1} << (8 * size);
  out.resize(std::size_t{from.num_faces()} * 3 * size);
  unsigned char* to = out.data();
  for (draco::FaceIndex f(0); f < from.num_faces(); ++f) {
    for (const draco::PointIndex& corner : from.face(f)) {
      const std::uint32_t index = corner.value();
      if (index >= end) return false;
      std::memcpy(to, &index, size);
      to += size;
    }
  }
  return true;
}

}  // namespace

DracoReader::DracoReader(const GltfDocument& document, AccessorTable& accessors, const ImportBudget& budget)
    : document_(document),
      accessors_(accessors),
      budget_(budget),
      required_(lists_extension(document, "extensionsRequired", "KHR_draco_mesh_compression")) {}

void DracoReader::decode(std::size_t mesh, tinygltf::Mesh& model) {
  const Json& primitives = document_.json["meshes"][mesh]["primitives"];
  for (std::size_t p = 0; p < primitives.size(); ++p) {
    if (!primitives[p].contains(Json::json_pointer("/extensions/KHR_draco_mesh_compression"))) continue;
    decode_primitive(primitives[p], json_path(json_path(json_path("/meshes", mesh), "primitives"), p),
                     model.primitives[p]);
  }
}

/// The accessor that gets the data of `source` where the file names `named`: another one where that has its data from
/// elsewhere.
std::size_t DracoReader::accessor_for(std::size_t named, const Source& source) {
  const auto [entry, fresh] = sources_.try_emplace(named, source);
  if (fresh || entry->second == source) return named;
  const auto [other, made] = others_.try_emplace({named, source}, 0);
  if (made) other->second = accessors_.add_like(named);
  return other->second;
}

void DracoReader::decode_primitive(const Json& primitive, const std::string& path, tinygltf::Primitive& model) {
  constexpr int kTriangles = 4;
  const std::string where = path + "/extensions/KHR_draco_mesh_compression";
  const Json& extension = primitive["extensions"]["KHR_draco_mesh_compression"];
  const auto view = extension["bufferView"].get<std::size_t>();
  if (primitive.value("mode", kTriangles) != kTriangles) {
    document_.fail(json_path(path, "mode"), "expected triangles (4) beside KHR_draco_mesh_compression");
  }
  if (!primitive.contains("indices")) document_.fail(json_path(path, "indices"), "missing");

  struct Target {
    std::size_t accessor;
    std::int64_t id;
    std::string path;
    std::string name;  ///< name of the attribute; empty: indices
  };
  std::vector<Target> targets{{primitive["indices"].get<std::size_t>(), kIndices, json_path(path, "indices"), ""}};
  for (const auto& [name, id] : extension["attributes"].items()) {
    const auto accessor = primitive["attributes"].find(name);
    const std::string at = json_path(json_path(where, "attributes"), name);
    if (accessor == primitive["attributes"].end()) document_.fail(at, "the primitive has no such attribute");
    targets.push_back({accessor->get<std::size_t>(), id.get<std::int64_t>(), at, name});
  }
  // A primitive whose accessors all have data in the file needs no stream, unless the file requires the extension.
  const bool needed = required_ || std::any_of(targets.begin(), targets.end(), [&](const Target& target) {
                        return sources_.contains(target.accessor) || !accessors_.stored(target.accessor);
                      });
  if (!needed) return;
  bool decoded = true;
  for (Target& target : targets) {
    target.accessor = accessor_for(target.accessor, {view, target.id});
    decoded = decoded && accessors_.replaced(target.accessor);
    if (target.name.empty())
      model.indices = static_cast<int>(target.accessor);
    else
      model.attributes[target.name] = static_cast<int>(target.accessor);
  }
  if (decoded) return;

  const Stream bytes = accessors_.view(view);
  if (bytes.empty()) document_.fail(json_path(where, "bufferView"), "the buffer holds no data");
  std::uint64_t components = 0;
  for (const Target& target : targets)
    if (target.id != kIndices) components += static_cast<std::uint64_t>(accessors_.components(target.accessor));
  const std::unique_ptr<draco::Mesh> mesh = decode_stream(document_, budget_, components, bytes, where);
  for (const Target& target : targets) {
    const bool indices = target.id == kIndices;
    const std::size_t found = indices ? std::size_t{mesh->num_faces()} * 3 : mesh->num_points();
    const std::string name = "accessor " + std::to_string(target.accessor);
    if (accessors_.count(target.accessor) != found) {
      document_.fail(target.path, name + " has " + std::to_string(accessors_.count(target.accessor)) +
                                      " elements, the compressed data " + std::to_string(found));
    }
    const Component component = accessors_.component(target.accessor);
    const int width = accessors_.components(target.accessor);
    budget_.take(found * static_cast<std::uint64_t>(width) * size_of(component), target.path, name);
    Bytes data;
    if (indices) {
      accessors_.check_type(target.accessor, AccessorUse::kIndices, target.path);
      if (!copy_indices(*mesh, component, data)) {
        document_.fail(target.path, name + " has " + name_of(component) + " elements, too small for " +
                                        std::to_string(mesh->num_points()) + " vertices");
      }
    } else {
      const draco::PointAttribute* attribute =
          target.id > 0xffffffff ? nullptr : mesh->GetAttributeByUniqueId(static_cast<std::uint32_t>(target.id));
      if (attribute == nullptr) {
        document_.fail(target.path, "the compressed data has no attribute " + std::to_string(target.id));
      }
      if (width > 4 || attribute->num_components() != width) {
        document_.fail(target.path, name + " has " + std::to_string(width) + " components, the compressed data " +
                                        std::to_string(attribute->num_components()));
      }
      if (!copy_attribute(*attribute, mesh->num_points(), width, component, data)) {
        document_.fail(target.path,
                       "the compressed data does not fit " + std::string(name_of(component)) + " elements");
      }
    }
    accessors_.replace(target.accessor, std::move(data));
  }
}

}  // namespace carousel::scene

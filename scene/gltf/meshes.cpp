#include "scene/gltf/meshes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>
#include <string>
#include <utility>

#include <glm/geometric.hpp>

#include "core/system/error.h"
#include "scene/gltf/document/uses.h"
#include "scene/gltf/gaussians.h"

namespace carousel::scene {

/// The attributes of one primitive; empty where an attribute is absent.
struct MeshReader::Attributes {
  std::vector<Vec3> positions, normals;
  std::vector<Vec2> uv0, uv1;
  std::vector<Vec4> colors;

  std::uint64_t bytes() const {
    return (positions.size() + normals.size()) * sizeof(Vec3) + (uv0.size() + uv1.size()) * sizeof(Vec2) +
           colors.size() * sizeof(Vec4);
  }
};

namespace {

template <class V>
std::vector<V> as_vectors(const std::vector<float>& values) {
  std::vector<V> out(values.size() / static_cast<std::size_t>(V::length()));
  for (std::size_t i = 0; i < out.size(); ++i) {
    for (int c = 0; c < V::length(); ++c) {
      out[i][c] = values[i * static_cast<std::size_t>(V::length()) + static_cast<std::size_t>(c)];
    }
  }
  return out;
}

/// glTF specification, 3.7.2.1: topology types.
std::vector<std::uint32_t> as_triangle_list(int mode, const std::vector<std::uint32_t>& v) {
  if (mode == TINYGLTF_MODE_TRIANGLES) return v;
  std::vector<std::uint32_t> out;
  out.reserve(3 * v.size());
  for (std::size_t i = 0; i + 2 < v.size(); ++i) {
    if (mode == TINYGLTF_MODE_TRIANGLE_STRIP) {
      out.insert(out.end(), {v[i], v[i + 1 + i % 2], v[i + 2 - i % 2]});
    } else {
      out.insert(out.end(), {v[i + 1], v[i + 2], v[0]});
    }
  }
  return out;
}

/// A unit vector along a, in double so that long and tiny vectors survive; nothing when a is zero.
std::optional<Vec3> unit(const DVec3& a) {
  const double length = glm::length(a);
  if (!(length > 0) || !std::isfinite(length)) return std::nullopt;
  return Vec3(a / length);
}

DVec3 face_normal(const std::vector<Vec3>& positions, const std::uint32_t* t) {
  const DVec3 a(positions[t[0]]), b(positions[t[1]]), c(positions[t[2]]);
  return glm::cross(b - a, c - a);
}

/// Makes all normals unit vectors; a zero normal becomes the mean of the faces around it.
void repair_normals(Mesh& mesh) {
  std::map<std::uint32_t, DVec3> broken;
  for (std::size_t i = 0; i < mesh.normals.size(); ++i) {
    if (const auto n = unit(DVec3(mesh.normals[i]))) {
      mesh.normals[i] = *n;
    } else {
      broken.emplace(static_cast<std::uint32_t>(i), DVec3(0));
    }
  }
  if (broken.empty()) return;
  for (std::size_t i = 0; i < mesh.indices.size(); ++i) {
    if (const auto entry = broken.find(mesh.indices[i]); entry != broken.end()) {
      entry->second += face_normal(mesh.positions, &mesh.indices[i - i % 3]);
    }
  }
  for (const auto& [v, sum] : broken) mesh.normals[v] = unit(sum).value_or(Vec3(0, 0, 1));
}

template <class T>
std::vector<T> pick(const std::vector<T>& values, const std::vector<std::uint32_t>& vertices) {
  std::vector<T> out;
  if (values.empty()) return out;
  out.reserve(vertices.size());
  for (const std::uint32_t v : vertices) out.push_back(values[v]);
  return out;
}

template <class T>
void append(std::vector<T>& to, const std::vector<T>& from, std::size_t before, std::size_t after, T filler) {
  if (to.empty() && from.empty()) return;
  to.resize(before, filler);
  to.insert(to.end(), from.begin(), from.end());
  to.resize(after, filler);
}

}  // namespace

namespace {

/// The accessors that a primitive's vertices come from.
struct VertexKey {
  std::map<std::string, int> attributes;
  std::vector<std::map<std::string, int>> targets;  ///< empty without a pose
  friend auto operator<=>(const VertexKey&, const VertexKey&) = default;
};

VertexKey key_of(const tinygltf::Primitive& primitive, const Bend* bend) {
  return {primitive.attributes, bend != nullptr ? primitive.targets : std::vector<std::map<std::string, int>>{}};
}

}  // namespace

struct MeshReader::Cache {
  VertexKey key;
  bool bent = false;            ///< the vertices are those of one node
  std::array<bool, 2> reads{};  ///< the material's sets of texture coordinates
  Attributes attributes;
  MemoryBudget::Loan loan;  ///< for the attributes
};

MeshReader::MeshReader(const GltfDocument& document, const tinygltf::Model& model, const AccessorTable& accessors,
                       const ImportBudget& budget, MaterialId default_material, WarningSink warn)
    : document_(document),
      model_(model),
      accessors_(accessors),
      budget_(budget),
      default_material_(default_material),
      warn_(std::move(warn)),
      cache_(std::make_unique<Cache>()) {}

MeshReader::~MeshReader() = default;

const MeshReader::Attributes& MeshReader::attributes_of(const tinygltf::Primitive& primitive, const std::string& path,
                                                        const Bend* bend) {
  const Json* material =
      primitive.material >= 0 ? &document_.json["materials"][static_cast<std::size_t>(primitive.material)] : nullptr;
  const std::array reads{material && reads_tex_coords(*material, 0), material && reads_tex_coords(*material, 1)};
  const VertexKey key = key_of(primitive, bend);
  if (cache_->key != key || cache_->reads != reads) {
    cache_->key = {};
    cache_->attributes = {};
    cache_->loan = {};
    cache_->attributes = read_attributes(primitive, path, reads);
    cache_->loan = budget_.lend(cache_->attributes.bytes(), path, "the primitive");
    if (bend != nullptr) {
      bend_vertices(document_, accessors_, budget_, primitive, path, *bend, cache_->attributes.positions,
                    cache_->attributes.normals);
    }
    cache_->key = key;
    cache_->reads = reads;
  }
  return cache_->attributes;
}

MeshReader::Attributes MeshReader::picked(const Attributes& from, const std::vector<std::uint32_t>& vertices) {
  return {pick(from.positions, vertices), pick(from.normals, vertices), pick(from.uv0, vertices),
          pick(from.uv1, vertices), pick(from.colors, vertices)};
}

MeshReader::Attributes MeshReader::read_attributes(const tinygltf::Primitive& primitive, const std::string& path,
                                                   const std::array<bool, 2>& reads) const {
  const std::string attributes = json_path(path, "attributes");
  const auto vertices = accessors_.count(static_cast<std::size_t>(primitive.attributes.at("POSITION")));
  const auto read = [&](const char* name, AccessorUse use, int& width) -> std::vector<float> {
    const auto entry = primitive.attributes.find(name);
    if (entry == primitive.attributes.end()) return {};
    const auto accessor = static_cast<std::size_t>(entry->second);
    const std::string where = json_path(attributes, name);
    accessors_.check_use(accessor, use, where);
    if (accessors_.count(accessor) != vertices) {
      document_.fail(where, "accessor " + std::to_string(accessor) + " has " +
                                std::to_string(accessors_.count(accessor)) + " elements, POSITION has " +
                                std::to_string(vertices));
    }
    width = accessors_.components(accessor);
    return accessors_.floats(accessor, where);
  };
  Attributes out;
  int width = 0;
  out.positions = as_vectors<Vec3>(read("POSITION", AccessorUse::kPosition, width));
  out.normals = as_vectors<Vec3>(read("NORMAL", AccessorUse::kNormal, width));
  const auto tex_coords = [&](const char* name, bool used) -> std::vector<Vec2> {
    try {
      return as_vectors<Vec2>(read(name, AccessorUse::kTexCoord, width));
    } catch (const SceneError& error) {
      if (used) throw;
      if (warn_) warn_(std::string(error.what()) + "; ignored, since no texture of the material reads it");
      return {};
    }
  };
  out.uv0 = tex_coords("TEXCOORD_0", reads[0]);
  out.uv1 = tex_coords("TEXCOORD_1", reads[1]);
  const std::vector<float> colors = read("COLOR_0", AccessorUse::kColor, width);
  if (!colors.empty() && width == 3) {
    for (const Vec3& c : as_vectors<Vec3>(colors)) out.colors.emplace_back(c, 1.0f);
  } else {
    out.colors = as_vectors<Vec4>(colors);
  }
  return out;
}

void MeshReader::add_vertices(Mesh& mesh, const Attributes& more, std::uint64_t& taken, const std::string& path) const {
  const std::size_t before = mesh.positions.size(), after = before + more.positions.size();
  const auto width = [](const auto& a, const auto& b) { return a.empty() && b.empty() ? 0 : sizeof a[0]; };
  const std::uint64_t bytes = after * (sizeof(Vec3) + width(mesh.normals, more.normals) + width(mesh.uv0, more.uv0) +
                                       width(mesh.uv1, more.uv1) + width(mesh.colors, more.colors));
  budget_.take(bytes - taken, path, "the mesh of " + std::to_string(after) + " vertices");
  taken = bytes;
  mesh.positions.insert(mesh.positions.end(), more.positions.begin(), more.positions.end());
  append(mesh.normals, more.normals, before, after, Vec3(0, 0, 1));
  append(mesh.uv0, more.uv0, before, after, Vec2(0));
  append(mesh.uv1, more.uv1, before, after, Vec2(0));
  append(mesh.colors, more.colors, before, after, Vec4(1));
}

std::vector<std::uint32_t> MeshReader::read_triangles(const tinygltf::Primitive& primitive, std::uint64_t vertices,
                                                      const std::string& path) {
  std::vector<std::uint32_t> order;
  const bool indexed = primitive.indices >= 0;
  const std::string where = indexed ? json_path(path, "indices") : json_path(json_path(path, "attributes"), "POSITION");
  // A triangle has three indices, which are here and then in the mesh, and a material.
  const auto take = [&](std::uint64_t corners) {
    const std::uint64_t triangles = primitive.mode == TINYGLTF_MODE_TRIANGLES ? corners / 3 : corners;
    budget_.take(triangles * (2 * 3 * sizeof(std::uint32_t) + sizeof(MaterialId)), where,
                 std::to_string(triangles) + " triangles: the primitive");
  };
  if (indexed) {
    const auto accessor = static_cast<std::size_t>(primitive.indices);
    accessors_.check_use(accessor, AccessorUse::kIndices, where);
    take(accessors_.count(accessor));
    order = accessors_.integers(accessor, where);
    for (std::size_t i = 0; i < order.size(); ++i) {
      if (order[i] >= vertices) {
        document_.fail(where, "index " + std::to_string(order[i]) + " at position " + std::to_string(i) +
                                  " is beyond the " + std::to_string(vertices) + " positions");
      }
    }
  } else {
    take(vertices);
    order.resize(static_cast<std::size_t>(vertices));
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = static_cast<std::uint32_t>(i);
  }
  if (primitive.mode == TINYGLTF_MODE_TRIANGLES && order.size() % 3 != 0) {
    document_.fail(where, "a list of triangles needs a multiple of 3 vertices, found " + std::to_string(order.size()));
  }
  return as_triangle_list(primitive.mode, order);
}

Mesh MeshReader::read(std::size_t index, const Bend* bend) {
  if (bend != nullptr || cache_->bent) cache_->key = {};
  cache_->bent = bend != nullptr;
  const tinygltf::Mesh& source = model_.meshes[index];
  Mesh mesh;
  mesh.name = source.name;
  const auto usable = [](const tinygltf::Primitive& p) {
    return p.mode >= TINYGLTF_MODE_TRIANGLES && p.attributes.contains("POSITION");
  };
  const bool any_normals = std::ranges::any_of(
      source.primitives, [&](const tinygltf::Primitive& p) { return usable(p) && p.attributes.contains("NORMAL"); });
  std::uint64_t taken = 0;
  std::map<VertexKey, std::uint32_t> bases;  // first vertex of those taken as a whole
  for (std::size_t p = 0; p < source.primitives.size(); ++p) {
    const tinygltf::Primitive& primitive = source.primitives[p];
    const std::string path = json_path(json_path(json_path("/meshes", index), "primitives"), p);
    if (!usable(primitive)) {
      skipped_ += !has_gaussians(primitive);
      continue;
    }
    const Attributes& whole = attributes_of(primitive, path, bend);
    std::vector<std::uint32_t> triangles = read_triangles(primitive, whole.positions.size(), path);
    const std::size_t before = mesh.positions.size();
    std::uint32_t base = static_cast<std::uint32_t>(before);
    if (any_normals && whole.normals.empty()) {  // flat: every corner a vertex of its own
      const auto loan =
          budget_.lend(triangles.size() / std::max<std::size_t>(whole.positions.size(), 1) * whole.bytes() +
                           triangles.size() * sizeof(Vec3),
                       path, "the primitive");
      Attributes flat = picked(whole, triangles);
      std::iota(triangles.begin(), triangles.end(), 0u);
      for (std::size_t t = 0; t < triangles.size(); t += 3) {
        const Vec3 n = unit(face_normal(flat.positions, &triangles[t])).value_or(Vec3(0, 0, 1));
        flat.normals.insert(flat.normals.end(), 3, n);
      }
      add_vertices(mesh, flat, taken, path);
    } else if (whole.positions.size() / 2 > triangles.size()) {  // a few out of many: only those it uses
      std::vector<std::uint32_t> used = triangles;
      std::ranges::sort(used);
      used.erase(std::unique(used.begin(), used.end()), used.end());
      for (std::uint32_t& v : triangles) {
        v = static_cast<std::uint32_t>(std::ranges::lower_bound(used, v) - used.begin());
      }
      add_vertices(mesh, picked(whole, used), taken, path);
    } else if (const auto [entry, fresh] = bases.try_emplace(key_of(primitive, bend), base); fresh) {
      add_vertices(mesh, whole, taken, path);
    } else {
      base = entry->second;
    }
    if (mesh.positions.size() > 0xffffffffu) document_.fail(path, "the mesh has more than 2^32 vertices");
    for (std::uint32_t& v : triangles) v += base;
    mesh.indices.insert(mesh.indices.end(), triangles.begin(), triangles.end());
    mesh.triangle_materials.resize(
        mesh.triangle_count(),
        primitive.material >= 0 ? MaterialId(static_cast<std::uint32_t>(primitive.material)) : default_material_);
  }
  repair_normals(mesh);
  return mesh;
}

}  // namespace carousel::scene

#include "modules/scenes/read_scene.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <sstream>
#include <stdexcept>
#include <utility>
#include <vector>

#include <assimp/DefaultLogger.hpp>
#include <assimp/Importer.hpp>
#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include "core/numeric/trigonometry.h"
#include "modules/scenes/material_map.h"
#include "modules/scenes/motion.h"
#include "modules/scenes/source_files.h"

namespace carousel::scenes {

namespace {

using scene::Imported;
using scene::ImportQuestion;
using scene::Mesh;
using scene::PunctualLight;

/// Collects what Assimp warns of.
class Listener : public Assimp::Logger {
 public:
  explicit Listener(std::vector<std::string>& out) : Logger(NORMAL), out_(out) {}
  bool attachStream(Assimp::LogStream*, unsigned int) override { return true; }
  bool detachStream(Assimp::LogStream*, unsigned int) override { return true; }

 protected:
  void OnDebug(const char*) override {}
  void OnVerboseDebug(const char*) override {}
  void OnInfo(const char*) override {}
  void OnWarn(const char* message) override { add(message); }
  void OnError(const char* message) override { add(message); }

 private:
  void add(const std::string& message) {
    // Missing files are told with their places.
    if (message.find("material file") != message.npos || !told_.insert(message).second) return;
    if (told_.size() <= kMost) out_.push_back("Assimp: " + message);
  }

  static constexpr std::size_t kMost = 8;
  std::vector<std::string>& out_;
  std::set<std::string> told_;
};

/// Assimp's logger for as long as the object lives.
class Listening {
 public:
  explicit Listening(std::vector<std::string>& out) { Assimp::DefaultLogger::set(new Listener(out)); }
  ~Listening() { Assimp::DefaultLogger::kill(); }
  Listening(const Listening&) = delete;
  Listening& operator=(const Listening&) = delete;
};

Vec3 vector_of(const aiVector3D& v) {
  return {v.x, v.y, v.z};
}

class SceneReader {
 public:
  SceneReader(const aiScene& from, bool posed, Imported& to) : from_(from), posed_(posed), to_(to) {}

  void read() {
    for (const Visit& visit : nodes_in_order()) add(*visit.node, visit.parent);
    for (unsigned i = 0; i < from_.mNumCameras; ++i) add(*from_.mCameras[i]);
    for (unsigned i = 0; i < from_.mNumLights; ++i) add(*from_.mLights[i]);
    list_motion(from_, to_);
    if (posed_) read_animations(from_, named_, to_);
    if (skipped_ > 0) to_.warnings.push_back(std::to_string(skipped_) + " points and lines skipped");
    if (further_sets_) to_.warnings.push_back("further sets of texture coordinates or colours are ignored");
  }

 private:
  struct Visit {
    const aiNode* node;
    std::int64_t parent;
  };

  /// Parents first; names them. Without recursion: a file may nest its nodes as deep as it likes.
  std::vector<Visit> nodes_in_order() {
    std::vector<Visit> out, stack;
    if (from_.mRootNode != nullptr) stack.push_back({from_.mRootNode, -1});
    while (!stack.empty()) {
      const Visit visit = stack.back();
      stack.pop_back();
      const auto index = static_cast<std::int64_t>(out.size());
      named_.try_emplace(visit.node->mName.C_Str(), index);
      out.push_back(visit);
      for (unsigned i = visit.node->mNumChildren; i-- > 0;) stack.push_back({visit.node->mChildren[i], index});
    }
    return out;
  }

  void add(const aiNode& from, std::int64_t parent) {
    Imported::Node node;
    node.name = from.mName.C_Str();
    node.parent = parent;
    const aiMatrix4x4& m = from.mTransformation;
    for (unsigned c = 0; c < 4; ++c)
      for (unsigned r = 0; r < 4; ++r) node.local[4 * c + r] = m[r][c];
    if (from.mNumMeshes > 0) node.mesh = mesh_of({from.mMeshes, from.mMeshes + from.mNumMeshes}, node.name);
    to_.nodes.push_back(std::move(node));
  }

  /// One mesh for all that a node shows: Assimp divides a mesh by materials.
  std::int64_t mesh_of(const std::vector<unsigned>& parts, const std::string& name) {
    const auto [entry, fresh] = meshes_.try_emplace(parts, static_cast<std::int64_t>(to_.meshes.size()));
    if (!fresh) return entry->second;
    Mesh out;
    out.name = name;
    for (const unsigned part : parts) append(*from_.mMeshes[part], out);
    to_.meshes.push_back(std::move(out));
    return entry->second;
  }

  void append(const aiMesh& from, Mesh& to) {
    const std::size_t before = to.positions.size(), count = from.mNumVertices;
    const std::size_t faces_before = to.indices.size();
    for (unsigned f = 0; f < from.mNumFaces; ++f) {
      const aiFace& face = from.mFaces[f];
      if (face.mNumIndices != 3) {
        ++skipped_;
        continue;
      }
      for (unsigned i = 0; i < 3; ++i) to.indices.push_back(static_cast<std::uint32_t>(before + face.mIndices[i]));
    }
    if (to.indices.size() == faces_before) return;
    to.triangle_materials.resize(to.triangle_count(), MaterialId(from.mMaterialIndex));
    if (posed_) append_bones(from, named_, static_cast<std::uint32_t>(to_.meshes.size()), before, to_);
    for (std::size_t v = 0; v < count; ++v) to.positions.push_back(vector_of(from.mVertices[v]));
    const auto fill = [&](auto& values, bool there, auto filler, auto value) {
      if (!there && values.empty()) return;
      values.resize(before, filler);
      for (std::size_t v = 0; v < count; ++v) values.push_back(there ? value(v) : filler);
    };
    if (from.HasNormals() || !to.normals.empty()) add_normals(from, to, before);
    const auto uv = [&](unsigned set) {
      return [&from, set](std::size_t v) { return Vec2(from.mTextureCoords[set][v].x, from.mTextureCoords[set][v].y); };
    };
    fill(to.uv0, from.HasTextureCoords(0), Vec2(0), uv(0));
    fill(to.uv1, from.HasTextureCoords(1), Vec2(0), uv(1));
    fill(to.colors, from.HasVertexColors(0), Vec4(1), [&](std::size_t v) {
      const aiColor4D& c = from.mColors[0][v];
      return Vec4(c.r, c.g, c.b, c.a);
    });
    further_sets_ |= from.GetNumUVChannels() > 2 || from.GetNumColorChannels() > 1;
  }

  /// Parts without normals get those of their faces, summed up around each vertex.
  void add_normals(const aiMesh& from, Mesh& to, std::size_t before) const {
    if (to.normals.size() < before) {
      to.normals.resize(before, Vec3(0));
      add_face_normals(to, 0, before);
    }
    to.normals.resize(to.positions.size(), Vec3(0));
    if (from.HasNormals())
      for (std::size_t v = before; v < to.normals.size(); ++v) to.normals[v] = vector_of(from.mNormals[v - before]);
    else
      add_face_normals(to, before, to.normals.size());
  }

  static void add_face_normals(Mesh& mesh, std::size_t begin, std::size_t end) {
    for (std::size_t t = 0; t < mesh.indices.size(); t += 3) {
      const std::uint32_t* const i = &mesh.indices[t];
      if (i[0] < begin || i[0] >= end) continue;
      const Vec3 a = mesh.positions[i[1]] - mesh.positions[i[0]], b = mesh.positions[i[2]] - mesh.positions[i[0]];
      const Vec3 normal(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
      for (int corner = 0; corner < 3; ++corner) mesh.normals[i[corner]] += normal;
    }
  }

  std::optional<std::int64_t> node_of(const aiString& name) const {
    const auto entry = named_.find(name.C_Str());
    if (entry == named_.end()) return std::nullopt;
    return entry->second;
  }

  static std::array<double, 3> array_of(const aiVector3D& v) { return {v.x, v.y, v.z}; }

  void add(const aiCamera& from) {
    const auto node = node_of(from.mName);
    if (!node) return to_.warnings.push_back("a camera without a node is ignored");
    Imported::Camera to;
    to.node = *node;
    to.name = from.mName.C_Str();
    to.position = array_of(from.mPosition);
    to.direction = array_of(from.mLookAt);
    to.up = array_of(from.mUp);
    to.aspect = from.mAspect;
    to.half_width = from.mOrthographicWidth;
    to.znear = from.mClipPlaneNear;
    // Assimp 5.2 does not read the angle of a COLLADA file, and takes its default of 45 degrees for radians.
    constexpr float kLost = 0.0138f;
    if (from.mOrthographicWidth == 0 && from.mHorizontalFOV < kLost) {
      to_.warnings.push_back("the angle of view of the camera \"" + to.name +
                             "\" cannot be read; camera.field_of_view gives it one");
      to.yfov = 0;
      return to_.cameras.push_back(to);
    }
    // The importers give the whole angle, though the header speaks of half of it.
    constexpr double kTurn = 6.28318530717958647693;
    const SinCos64 half = sin_cos(0.5 * double{from.mHorizontalFOV});
    to.yfov = from.mAspect > 0
                  ? static_cast<float>(2 * kTurn * angle_in_turns(half.sin, half.cos * double{from.mAspect}))
                  : from.mHorizontalFOV;
    to_.cameras.push_back(to);
  }

  void add(const aiLight& from) {
    const auto node = node_of(from.mName);
    if (!node) return to_.warnings.push_back("a light without a node is ignored");
    Imported::Light to;
    to.node = *node;
    switch (from.mType) {
      case aiLightSource_DIRECTIONAL:
        to.kind = PunctualLight::Kind::kDirectional;
        break;
      case aiLightSource_POINT:
        to.kind = PunctualLight::Kind::kPoint;
        break;
      case aiLightSource_SPOT:
        to.kind = PunctualLight::Kind::kSpot;
        break;
      default:
        return to_.warnings.push_back(std::string("the light \"") + from.mName.C_Str() +
                                      "\" is ambient or an area, and is ignored");
    }
    to.intensity = {from.mColorDiffuse.r, from.mColorDiffuse.g, from.mColorDiffuse.b};
    to.position = array_of(from.mPosition);
    if (to.kind != PunctualLight::Kind::kPoint) to.direction = array_of(from.mDirection);
    to.inner = 0.5f * from.mAngleInnerCone;
    to.outer = 0.5f * from.mAngleOuterCone;
    to_.lights.push_back(to);
  }

  const aiScene& from_;
  const bool posed_;
  Imported& to_;
  std::map<std::vector<unsigned>, std::int64_t> meshes_;
  NodesByName named_;
  std::size_t skipped_ = 0;
  bool further_sets_ = false;
};

}  // namespace

Imported read_scene(const ImportQuestion& question) {
  const std::string& file = question.file;
  Imported out;
  SourceFiles files(file);
  const Listening listening(out.warnings);
  Assimp::Importer importer;
  importer.SetIOHandler(new SourceFileSystem(files));
  importer.SetPropertyBool(AI_CONFIG_IMPORT_FBX_PRESERVE_PIVOTS, false);
  const aiScene* const scene =
      importer.ReadFile(file, aiProcess_Triangulate | aiProcess_FlipUVs | aiProcess_JoinIdenticalVertices |
                                  aiProcess_GenUVCoords | aiProcess_FindInvalidData | aiProcess_ValidateDataStructure |
                                  aiProcess_RemoveRedundantMaterials);  // Assimp adds one that nothing has
  const std::vector<SourceFiles::Missing> missing = files.missing();
  if (scene == nullptr) {
    std::string message = importer.GetErrorString();
    for (const SourceFiles::Missing& each : missing)
      message += "; " + each.place + ": '" + each.name + "' is not there";
    throw std::runtime_error("cannot be read: Assimp: " + message);
  }
  for (const SourceFiles::Missing& each : missing)
    out.warnings.push_back(each.place + ": the file '" + each.name +
                           "' is not there, or is outside the model's folder and the two above it");
  out.files = files.all();
  MaterialMap(*scene, files, out).map_all();
  if (question.files_only) {
    Imported files_alone;
    files_alone.files = std::move(out.files);
    return files_alone;
  }
  SceneReader(*scene, question.posed, out).read();
  return out;
}

const char* endings() {
  static const std::string all = [] {
    std::string list;
    Assimp::Importer().GetExtensionList(list);  // "*.3ds;*.obj;..."
    std::set<std::string> names;
    std::istringstream in(list);
    for (std::string each; std::getline(in, each, ';');)
      if (each.starts_with("*.") && each != "*.gltf" && each != "*.glb") names.insert(each.substr(2));
    std::string out;
    for (const std::string& name : names) out += (out.empty() ? "" : " ") + name;
    return out;
  }();
  return all.c_str();
}

}  // namespace carousel::scenes

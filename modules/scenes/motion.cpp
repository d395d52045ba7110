#include "modules/scenes/motion.h"

#include <cstddef>
#include <utility>
#include <vector>

#include <assimp/anim.h>
#include <assimp/mesh.h>

namespace carousel::scenes {

namespace {

using scene::Imported;

double ticks_per_second(const aiAnimation& animation) {
  return animation.mTicksPerSecond > 0 ? animation.mTicksPerSecond : 1;
}

void append(const aiVector3D& v, std::vector<float>& out) {
  out.insert(out.end(), {v.x, v.y, v.z});
}

void append(const aiQuaternion& q, std::vector<float>& out) {
  out.insert(out.end(), {q.x, q.y, q.z, q.w});
}

template <class Key>
void read_keys(const Key* keys, unsigned count, double rate, std::vector<float>& times, std::vector<float>& values) {
  for (unsigned i = 0; i < count; ++i) {
    const auto time = static_cast<float>(keys[i].mTime / rate);
    if (!times.empty() && !(time > times.back())) continue;
    times.push_back(time);
    append(keys[i].mValue, values);
  }
}

}  // namespace

void list_motion(const aiScene& from, Imported& to) {
  for (unsigned i = 0; i < from.mNumAnimations; ++i) {
    const aiAnimation& animation = *from.mAnimations[i];
    to.motion.clips.push_back({animation.mName.C_Str(), animation.mDuration / ticks_per_second(animation),
                               animation.mNumChannels + animation.mNumMeshChannels + animation.mNumMorphMeshChannels});
  }
  for (unsigned i = 0; i < from.mNumMeshes; ++i) {
    to.motion.skins += from.mMeshes[i]->HasBones() ? 1 : 0;
    to.motion.morph_targets += from.mMeshes[i]->mNumAnimMeshes;
  }
}

void read_animations(const aiScene& from, const NodesByName& nodes, Imported& to) {
  std::size_t lost = 0;
  for (unsigned i = 0; i < from.mNumAnimations; ++i) {
    const aiAnimation& animation = *from.mAnimations[i];
    const double rate = ticks_per_second(animation);
    std::vector<Imported::Channel>& channels = to.animations.emplace_back();
    for (unsigned c = 0; c < animation.mNumChannels; ++c) {
      const aiNodeAnim& moves = *animation.mChannels[c];
      const auto node = nodes.find(moves.mNodeName.C_Str());
      if (node == nodes.end()) {
        ++lost;
        continue;
      }
      Imported::Channel& out = channels.emplace_back();
      out.node = node->second;
      read_keys(moves.mPositionKeys, moves.mNumPositionKeys, rate, out.translation_times, out.translations);
      read_keys(moves.mRotationKeys, moves.mNumRotationKeys, rate, out.rotation_times, out.rotations);
      read_keys(moves.mScalingKeys, moves.mNumScalingKeys, rate, out.scale_times, out.scales);
    }
  }
  if (lost > 0) to.warnings.push_back(std::to_string(lost) + " channels of animations name no node, and are ignored");
}

void append_bones(const aiMesh& from, const NodesByName& nodes, std::uint32_t mesh, std::size_t first, Imported& to) {
  if (!from.HasBones()) return;
  if (to.skins.empty() || to.skins.back().mesh != mesh) to.skins.push_back({mesh, {}});
  for (unsigned b = 0; b < from.mNumBones; ++b) {
    const aiBone& bone = *from.mBones[b];
    const auto node = nodes.find(bone.mName.C_Str());
    if (node == nodes.end()) {
      to.warnings.push_back(std::string("the bone \"") + bone.mName.C_Str() + "\" names no node, and moves nothing");
      continue;
    }
    Imported::Bone out;
    out.node = node->second;
    const aiMatrix4x4& m = bone.mOffsetMatrix;
    for (unsigned c = 0; c < 4; ++c)
      for (unsigned r = 0; r < 4; ++r) out.bone_from_mesh[4 * c + r] = m[r][c];
    for (unsigned w = 0; w < bone.mNumWeights; ++w) {
      out.vertices.push_back(static_cast<std::uint32_t>(first + bone.mWeights[w].mVertexId));
      out.weights.push_back(bone.mWeights[w].mWeight);
    }
    to.skins.back().bones.push_back(std::move(out));
  }
}

}  // namespace carousel::scenes

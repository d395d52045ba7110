#pragma once

#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "accel/builders/clusters.h"
#include "accel/structure/accel.h"
#include "core/config/fields/image.h"
#include "ringbus/cycle/shapes/shape_memory.h"

namespace carousel::ringbus::cycle {

/// Where the builder finds what it reads beside the structure.
class BuilderSources {
 public:
  static constexpr std::uint32_t kPositionBytes = 36;  // three vertices
  static constexpr std::uint32_t kMatrixBytes = 48;
  static constexpr std::uint32_t kRecordBytes = BuilderConfig::kRecordBytes;
  static constexpr std::uint32_t kNumberBytes = 4;  // of a primitive of a cluster, or of a child

  BuilderSources(const accel::Accel& accel, const ShapeMemory& memory) {
    std::uint64_t primitives = 0;
    for (const accel::InstanceNode& instance : accel.instances)
      if (instance.triangles > 0 && first_.emplace(instance.root.bits(), primitives).second)
        primitives += instance.triangles;
    constexpr std::uint64_t kPage = 4096;
    const auto behind = [](std::uint64_t at, std::uint64_t bytes) { return (at + bytes + kPage - 1) / kPage * kPage; };
    positions_ = behind(memory.size_bytes(), 0);
    matrices_ = behind(positions_, primitives * kPositionBytes);
    records_ = behind(matrices_, accel.instances.size() * kMatrixBytes);
    top_records_ = records_ + primitives * kRecordBytes;
    micromaps_ = behind(top_records_, accel.instances.size() * kRecordBytes);
  }
  BuilderSources(const accel::Accel& accel, const ShapeMemory& memory, const accel::TreeClusters& clusters)
      : BuilderSources(accel, memory) {
    std::uint64_t count = 0, primitives = 0, children = 0;
    for (const accel::MeshClusters& mesh : clusters.meshes) {
      first_cluster_.push_back(count);
      for (const accel::Cluster& cluster : mesh.clusters) {
        first_number_.push_back(primitives);
        primitives += cluster.primitives;
        ++count;
      }
      first_list_.push_back(lists_.size());
      for (const std::uint32_t node : mesh.above) {
        lists_.push_back(children);
        children += static_cast<std::uint64_t>(accel.nodes[node].count);
      }
    }
    bits_ = micromaps_;  // where there are clusters there are none
    cluster_records_ = bits_ + (count + 511) / 512 * 64;
    numbers_ = cluster_records_ + count * kRecordBytes;
    children_ = numbers_ + primitives * kNumberBytes;
  }

  /// Number of the first primitive of the mesh below a root among all of them.
  std::uint64_t first(accel::NodeRef root) const { return first_.at(root.bits()); }
  ShapeSpan positions(std::uint64_t primitive, std::uint64_t count = 1) const {
    return {positions_ + primitive * kPositionBytes, static_cast<std::uint32_t>(count * kPositionBytes)};
  }
  ShapeSpan matrix(std::uint32_t instance) const {
    return {matrices_ + instance * std::uint64_t{kMatrixBytes}, kMatrixBytes};
  }
  ShapeSpan records(std::uint64_t first, std::uint64_t count, bool top) const {
    return {(top ? top_records_ : records_) + first * kRecordBytes, static_cast<std::uint32_t>(count * kRecordBytes)};
  }

  /// Of a number of clusters of a mesh; meshes and clusters are those of TreeClusters.
  ShapeSpan cluster_bits(std::size_t mesh, std::uint64_t count) const {
    const std::uint64_t first = first_cluster_[mesh] / 8, end = (first_cluster_[mesh] + count + 7) / 8;
    return {bits_ + first, static_cast<std::uint32_t>(end - first)};
  }
  ShapeSpan cluster_records(std::size_t mesh, std::uint64_t first, std::uint64_t count) const {
    return {cluster_records_ + (first_cluster_[mesh] + first) * kRecordBytes,
            static_cast<std::uint32_t>(count * kRecordBytes)};
  }
  ShapeSpan numbers(std::size_t mesh, std::uint64_t cluster, std::uint32_t primitives) const {
    return {numbers_ + first_number_[first_cluster_[mesh] + cluster] * kNumberBytes, primitives * kNumberBytes};
  }

  /// The children of a node above clusters, by its number in MeshClusters::above.
  ShapeSpan children(std::size_t mesh, std::size_t number, std::uint32_t count) const {
    return {children_ + lists_[first_list_[mesh] + number] * kNumberBytes, count * kNumberBytes};
  }

  /// Of the triangles of a leaf; no bytes if they have none.
  ShapeSpan micromaps(const accel::Accel& accel, accel::NodeRef leaf) const {
    return {micromaps_ + accel.micromaps.places.before(leaf.first_block()), accel.micromaps.places.of(leaf)};
  }

 private:
  std::unordered_map<std::uint32_t, std::uint64_t> first_;
  std::uint64_t positions_ = 0, matrices_ = 0, records_ = 0, top_records_ = 0, micromaps_ = 0;
  std::vector<std::uint64_t> first_cluster_, first_number_;  // by mesh and by cluster
  std::vector<std::uint64_t> first_list_, lists_;            // by mesh, and by node above its clusters
  std::uint64_t bits_ = 0, cluster_records_ = 0, numbers_ = 0, children_ = 0;
};

}  // namespace carousel::ringbus::cycle

#pragma once

#include <optional>

#include "core/config/fields/engine_kind.h"
#include "core/config/fields/field.h"

namespace carousel {

enum class TriangleLevel { kFast, kWatertight, kDouble, kExact };
template <>
inline constexpr auto kEnumNames<TriangleLevel> = [] {
  using enum TriangleLevel;
  return names<TriangleLevel>({{kFast, "fast"}, {kWatertight, "watertight"}, {kDouble, "double"}, {kExact, "exact"}});
}();

enum class BoxLevel { kPlain, kConservative, kDouble };
template <>
inline constexpr auto kEnumNames<BoxLevel> = [] {
  using enum BoxLevel;
  return names<BoxLevel>({{kPlain, "plain"}, {kConservative, "conservative"}, {kDouble, "double"}});
}();

enum class TransformLevel { kInverseMatrix, kTwoStep, kTwoStepDouble, kTransposeIfRotation };
template <>
inline constexpr auto kEnumNames<TransformLevel> = [] {
  using enum TransformLevel;
  return names<TransformLevel>({{kInverseMatrix, "inverse_matrix"},
                                {kTwoStep, "two_step"},
                                {kTwoStepDouble, "two_step_double"},
                                {kTransposeIfRotation, "transpose_if_rotation"}});
}();

enum class SpawnOffset { kEpsilon, kUlp, kBound };
template <>
inline constexpr auto kEnumNames<SpawnOffset> = [] {
  using enum SpawnOffset;
  return names<SpawnOffset>({{kEpsilon, "epsilon"}, {kUlp, "ulp"}, {kBound, "bound"}});
}();

struct AccuracyConfig {
  TriangleLevel triangle = TriangleLevel::kWatertight;
  BoxLevel box = BoxLevel::kConservative;
  TransformLevel transform = TransformLevel::kTwoStep;
  SpawnOffset spawn = SpawnOffset::kBound;
  // These describe the hardware of the cycle engine; no hit depends on them.
  enum class Products { kSeparate, kFused } products = Products::kSeparate;
  enum class TransformedRay { kRecompute, kStore } transformed_ray = TransformedRay::kRecompute;
  enum class InstanceData { kForward, kRt, kInverse };
  std::optional<InstanceData> instance_data;  ///< absent: as `transform` reads
  enum class Invert { kBuild, kVisit };
  std::optional<Invert> invert;  ///< absent: as `instance_data` needs
};

template <>
inline constexpr auto kEnumNames<AccuracyConfig::Products> = [] {
  using enum AccuracyConfig::Products;
  return names<AccuracyConfig::Products>({{kSeparate, "separate"}, {kFused, "fused"}});
}();

template <>
inline constexpr auto kEnumNames<AccuracyConfig::TransformedRay> = [] {
  using enum AccuracyConfig::TransformedRay;
  return names<AccuracyConfig::TransformedRay>({{kRecompute, "recompute"}, {kStore, "store"}});
}();

template <>
inline constexpr auto kEnumNames<AccuracyConfig::InstanceData> = [] {
  using enum AccuracyConfig::InstanceData;
  return names<AccuracyConfig::InstanceData>({{kForward, "forward"}, {kRt, "rt"}, {kInverse, "inverse"}});
}();

template <>
inline constexpr auto kEnumNames<AccuracyConfig::Invert> = [] {
  using enum AccuracyConfig::Invert;
  return names<AccuracyConfig::Invert>({{kBuild, "build"}, {kVisit, "visit"}});
}();

namespace config {

template <class V>
void describe(V& v, AccuracyConfig& c) {
  v.choice(
      "triangle", c.triangle,
      "The test of a ray against a triangle: fast leaks at shared edges, watertight does not, double is watertight "
      "in 64 bits, exact decides without rounding.");
  v.choice("box", c.box,
           "The test of a ray against a box: plain loses some boxes that rays graze, conservative widens boxes and "
           "loses none, double does so in 64 bits.");
  v.choice(
      "transform", c.transform,
      "The way of a ray from world to model space: by one inverse matrix; by subtracting the translation first "
      "(two_step); by two steps in 64 bits that are rounded once; or by two steps that take a rotation's transpose "
      "for its inverse.");
  v.choice("spawn", c.spawn,
           "The distance of a new ray's origin from its surface: 1e-4 scene units (epsilon), 256 ulp (Waechter, Binder "
           "2019), or as far as rounding can reach (bound).");
  v.choice(
       "products", c.products,
       "The units have multipliers and adders (separate), or add where they multiply if the method allows it (fused): "
       "joules and areas differ, hits and cycles do not.")
      .only(EngineKind::kCycle, "price of fused products", AccuracyConfig::Products::kFused);
  v.choice("transformed_ray", c.transformed_ray,
           "A ray is brought to model space at each visit, or once for an instance and kept there (24 bytes).")
      .only(EngineKind::kCycle, "choice of where model-space rays are kept", AccuracyConfig::TransformedRay::kStore);
  v.choice("instance_data", c.instance_data,
           "The data of an instance in memory: its matrix (forward), the inverse of the linear part beside the "
           "translation (rt), or the inverse matrix. Without this key it is as the transform reads it.")
      .only(EngineKind::kCycle, "choice of stored matrices");
  v.choice("invert", c.invert,
           "A stored matrix is inverted when the tree is built or at a visit. Without this key it is at a visit if the "
           "matrix is stored forward.")
      .only(EngineKind::kCycle, "choice of stored matrices");
}

}  // namespace config
}  // namespace carousel

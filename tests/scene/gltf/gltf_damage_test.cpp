// Every class of malformed file, made from two correct files: a model as an exporter writes it, and one that uses every
// feature. The importer must name the place of the error.
#include "tests/scene/gltf/gltf_damage.h"

#include <filesystem>
#include <set>

#include <unistd.h>

#include "tests/scene/gltf/guarded_load.h"
#include "tests/scene/gltf/packed_model.h"
#include "tests/scene/gltf/rich_model.h"

namespace carousel::scene {
namespace {

using End = LoadOutcome::End;

class GltfDamage : public testing::Test {
 protected:
  GltfDamage() { std::filesystem::create_directories(folder_); }
  ~GltfDamage() override { std::filesystem::remove_all(folder_); }

  /// Loads the model from files of its own.
  Scene load(const ModelFiles& model) const {
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
    model.write(folder_);
    return load_gltf(folder_ / "model.gltf");
  }

  const std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / ("carousel-damage-" + std::to_string(::getpid()));
  struct Model {
    const char* name;
    ModelFiles files;
  };
  const std::vector<Model> models_{{"sample", sample_model()}, {"rich model", rich_model()}};
};

TEST_F(GltfDamage, TheUndamagedModelsLoad) {
  EXPECT_EQ(load(models_[0].files).instanced_triangle_count(), 24u);
  EXPECT_GT(load(models_[1].files).instanced_triangle_count(), 8000u);
}

TEST_F(GltfDamage, EveryKindIsRefusedAtItsPlace) {
  std::vector<Damage> damages = structure_damages();
  for (const Damage& d : data_damages()) damages.push_back(d);
  std::set<std::string> planted;
  for (const Model& model : models_) {
    std::vector<Damage> possible;
    std::vector<Damage::Verdict> expected;
    for (const Damage& d : damages) {
      ModelFiles copy = model.files;
      const auto verdict = d.plant(copy);
      if (!verdict) continue;
      possible.push_back(d);
      expected.push_back(*verdict);
      planted.insert(d.name);
    }
    const std::vector<LoadOutcome> outcomes = load_guarded(possible.size(), [&](std::size_t i) {
      ModelFiles copy = model.files;
      possible[i].plant(copy);
      return load(copy);
    });
    for (std::size_t i = 0; i < possible.size(); ++i) {
      SCOPED_TRACE(std::string(model.name) + ": " + possible[i].name);
      EXPECT_EQ(outcomes[i].end, End::kRefused) << outcomes[i];
      EXPECT_EQ(outcomes[i].path, expected[i].path) << outcomes[i];
      EXPECT_NE(outcomes[i].message.find(expected[i].message), std::string::npos) << outcomes[i];
    }
  }
  EXPECT_EQ(planted.size(), damages.size()) << "some damage found no place in any model";
}

/// Every pointer into a JSON value, itself not included.
void collect_pointers(const Json& value, const Json::json_pointer& at, std::vector<Json::json_pointer>& out) {
  const auto visit = [&](const Json& child, const Json::json_pointer& where) {
    out.push_back(where);
    collect_pointers(child, where, out);
  };
  if (value.is_object())
    for (const auto& [key, child] : value.items()) visit(child, at / key);
  if (value.is_array())
    for (std::size_t i = 0; i < value.size(); ++i) visit(value[i], at / i);
}

GltfBuilder damaged(GltfBuilder file, const Json::json_pointer& at, std::size_t way) {
  Json& value = file.json[at];
  Json& parent = file.json[at.parent_pointer()];
  if (way == 0)
    value = value.is_object() ? Json("wrong") : Json{{"wrong", true}};
  else if (way == 1)
    value = 4000000000u;
  else if (parent.is_object())
    parent.erase(at.back());
  return file;
}

// Every value in turn gets the wrong type, becomes an index or number far too large, or loses its key.
TEST_F(GltfDamage, EveryValueIsCheckedWhereItStands) {
  struct Packed {
    const char* name;
    GltfBuilder file;
  };
  std::vector<Packed> packed{{"every extension", every_extension()}};
  for (const Model& model : models_) packed.push_back({model.name, model.files.packed()});
  for (const Packed& model : packed) {
    GltfBuilder good = model.file;
    good.json["buffers"] = Json::array({{{"byteLength", good.binary.size()}}});
    std::vector<Json::json_pointer> places;
    collect_pointers(good.json, Json::json_pointer(), places);
    const std::vector<LoadOutcome> outcomes = load_guarded(3 * places.size(), [&](std::size_t i) {
      return load_gltf_from_memory(damaged(good, places[i / 3], i % 3).glb(), "damaged.glb");
    });
    std::size_t refused = 0;
    for (std::size_t i = 0; i < outcomes.size(); ++i) {
      const std::string at = places[i / 3].to_string();
      SCOPED_TRACE(std::string(model.name) + ": " + at + " damaged in way " + std::to_string(i % 3));
      EXPECT_NE(outcomes[i].end, End::kFault) << outcomes[i];
      if (outcomes[i].end != End::kRefused) continue;  // a key that is optional or not read
      ++refused;
      if (i % 3 == 0) {
        EXPECT_EQ(outcomes[i].path, at) << outcomes[i];
      }
    }
    EXPECT_GT(refused, places.size());
  }
}

// Files truncated anywhere, as text and as a container.
TEST_F(GltfDamage, EveryTruncationIsRefused) {
  for (const Model& model : models_) {
    const std::string text = model.files.json.dump();
    const std::vector<std::byte> glb = model.files.packed().glb();
    constexpr std::size_t kCuts = 500;
    const std::vector<LoadOutcome> outcomes = load_guarded(2 * kCuts, [&](std::size_t i) {
      if (i < kCuts) return GltfBuilder::load_text(text.substr(0, i * text.size() / kCuts));
      return load_gltf_from_memory(std::span(glb).first((i - kCuts) * glb.size() / kCuts), "cut.glb");
    });
    for (std::size_t i = 0; i < outcomes.size(); ++i)
      EXPECT_EQ(outcomes[i].end, End::kRefused) << model.name << ", cut " << i << ": " << outcomes[i];
  }
}

}  // namespace
}  // namespace carousel::scene

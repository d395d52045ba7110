// Scene files of other formats, run as a user runs them.
#include <cstdlib>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "app/sweep/plan/content.h"
#include "core/module/module.h"
#include "tests/app/support/program.h"
#include "tests/scene/gltf/gltf_builder.h"
#include "tests/scene/import/moving_files.h"

namespace carousel::import_run_test {
namespace {

using Json = nlohmann::json;
using testing::HasSubstr;

/// A roof of two squares over a floor, in both formats, with the same triangles in the same order.
const char* const kRoof =
    "mtllib roof.mtl\no Roof\nv -1 0 0\nv 0 1 0\nv 0 1 2\nv -1 0 2\nv 1 0 0\nv 1 0 2\nusemtl m\n"
    "f 1 2 3\nf 1 3 4\nf 2 5 6\nf 2 6 3\nf 1 4 6\nf 1 6 5\n";

std::string roof_as_gltf() {
  scene::GltfBuilder b;
  const int positions = b.floats({-1, 0, 0, 0, 1, 0, 0, 1, 2, -1, 0, 2, 1, 0, 0, 1, 0, 2}, "VEC3", 3);
  const int indices = b.accessor(
      b.view(std::vector<std::uint16_t>{0, 1, 2, 0, 2, 3, 1, 4, 5, 1, 5, 2, 0, 3, 5, 0, 5, 4}), 5123, 18, "SCALAR");
  b.push("materials", {{"doubleSided", true},
                       {"pbrMetallicRoughness",
                        {{"baseColorFactor", {0.5, 0.25, 0.75, 1}}, {"metallicFactor", 0}, {"roughnessFactor", 1}}}});
  b.mesh({{"POSITION", positions}}, indices, {{"material", 0}});
  return b.text();
}

class ImportRun : public testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(module_folder() / "scenes.so")) GTEST_SKIP() << "built without libassimp-dev";
    program_.write("roof.obj", kRoof);
    program_.write("roof.mtl", "newmtl m\nKd 0.5 0.25 0.75\n");
    program_.write("roof.gltf", roof_as_gltf());
    program_.write("roof.yaml",
                   "scene: {file: roof.gltf}\nimage: {width: 24, height: 16, samples: 2, max_depth: 4}\n"
                   "camera: {eye: [2, 3, 6], target: [0, 0.5, 1]}\n");
  }

  Program program_;
};

TEST_F(ImportRun, ObjAndGltfOfOneModelGiveTheSameHitsAndPicture) {
  ASSERT_EQ(program_.run({"run", "roof.yaml", "--hits", "--out", "gltf"}).status, 0);
  const Outcome obj = program_.run({"run", "roof.yaml", "--hits", "--set", "scene.file=roof.obj", "--out", "obj"});
  ASSERT_EQ(obj.status, 0) << obj.err;
  EXPECT_GT(program_.read("gltf/hits.csv").size(), 10000u);
  EXPECT_EQ(program_.read("gltf/hits.csv"), program_.read("obj/hits.csv"));
  EXPECT_EQ(program_.read("gltf/image.png"), program_.read("obj/image.png"));
}

TEST_F(ImportRun, InspectListsAndFramesOtherFormatsToo) {
  const Json listing = Json::parse(program_.run({"inspect", "roof.obj", "--json"}).out);
  EXPECT_EQ(listing["scene"]["triangles"], 6);
  EXPECT_EQ(listing["scene"]["materials"], 1);
  EXPECT_EQ(listing["bounds"]["max"], Json({1, 1, 2}));
  const Outcome framed = program_.run({"inspect", "roof.obj", "--frame", "Roof"});
  EXPECT_EQ(framed.status, 0) << framed.err;
  EXPECT_THAT(framed.out, HasSubstr("camera:\n  eye: ["));
}

TEST_F(ImportRun, FaultsEndWithStatus2AndTheFile) {
  program_.write("bad.ply", "ply\nformat ascii 1.0\nelement vertex 2\n");
  const Outcome bad = program_.run({"run", "roof.yaml", "--set", "scene.file=bad.ply"});
  EXPECT_EQ(bad.status, 2);
  EXPECT_THAT(bad.err, HasSubstr("bad.ply: "));
  const Outcome moment = program_.run({"run", "roof.yaml", "--set", "scene={file: roof.obj, time: 1}", "--out", "o"});
  EXPECT_EQ(moment.status, 0) << moment.err;
  EXPECT_THAT(moment.err, HasSubstr("roof.obj: has no animations, skins or morph targets; scene.time changes nothing"));
}

// The triangle of moving_collada() at 1 s: (2, 0), (2, 1) and (1, 0).
TEST_F(ImportRun, AMomentOfAColladaFileIsHitWhereItIs) {
  program_.write("vane.dae", scene::moving_collada());
  program_.write("rays.csv",
                 "ray,kind,ox,oy,oz,dx,dy,dz,tmin,tmax\n"
                 "0,camera,0.25,0.25,5,0,0,-1,0,inf\n"
                 "1,camera,1.75,0.25,5,0,0,-1,0,inf\n");
  const auto hits = [&](const std::string& scene) {
    const Outcome outcome = program_.run({"run", "roof.yaml", "--hits", "--force", "--out", "vane", "--set", scene,
                                          "--set", "workload={rays_from: rays.csv}"});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    const std::string csv = program_.read("vane/hits.csv");
    std::string out;
    for (std::size_t line = csv.find('\n'); line + 1 < csv.size(); line = csv.find('\n', line + 1)) {
      std::size_t at = line + 1;
      for (int comma = 0; comma < 10; ++comma) at = csv.find(',', at) + 1;
      out += csv[at];
    }
    return out;
  };
  EXPECT_EQ(hits("scene={file: vane.dae}"), "10");
  EXPECT_EQ(hits("scene={file: vane.dae, time: 1}"), "01");
  const Outcome listing = program_.run({"inspect", "vane.dae"});
  EXPECT_THAT(listing.out, HasSubstr("2 s, "));
}

TEST_F(ImportRun, CheckNamesTheModuleThatIsMissingWithKeyAndPackage) {
  std::filesystem::create_directory(program_.folder() / "none");
  program_.write("roof_obj.yaml", "scene:\n  file: roof.obj\n");
  program_.write("tiff.yaml", "scene: {builtin: cornell}\nimage:\n  files: [tiff]\n");
  program_.write("mpi.yaml", "scene: {builtin: cornell}\nengine:\n  transport: mpi\n");
  program_.write("wood.tga", std::string("\0\0\2\0\0\0\0\0\0\0\0\0\1\0\1\0\x18\x20\3\2\1", 21));
  scene::GltfBuilder b = scene::GltfBuilder::square();
  b.push("images", {{"uri", "wood.tga"}});
  b.push("textures", {{"source", 0}});
  b.push("materials", {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}});
  b.json["meshes"][0]["primitives"][0]["material"] = 0;
  b.json["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] = b.floats({0, 0, 1, 0, 1, 1, 0, 1}, "VEC2", 2);
  program_.write("wood.gltf", b.text());
  program_.write("wood.yaml", "scene: {file: wood.gltf}\n");
  const auto check = [&](const char* file) { return program_.run({"check", file}); };
  EXPECT_EQ(check("wood.yaml").status, 0) << check("wood.yaml").err;
  setenv("CAROUSEL_MODULES", (program_.folder() / "none").c_str(), 1);
  const Outcome obj = check("roof_obj.yaml"), tiff = check("tiff.yaml"), mpi = check("mpi.yaml"),
                wood = check("wood.yaml");
  unsetenv("CAROUSEL_MODULES");
  for (const Outcome& outcome : {obj, tiff, mpi, wood}) EXPECT_EQ(outcome.status, 2) << outcome.err;
  EXPECT_THAT(obj.err,
              HasSubstr("roof_obj.yaml:2:9: scene.file: roof.obj is no glTF file, and the module scenes is not "
                        "there: "));
  EXPECT_THAT(obj.err, HasSubstr("carousel-scenes"));
  EXPECT_THAT(tiff.err, HasSubstr("tiff.yaml:3:10: image.files: the module pictures is not there: "));
  EXPECT_THAT(tiff.err, HasSubstr("carousel-pictures"));
  EXPECT_THAT(mpi.err, HasSubstr("mpi.yaml:3:14: engine.transport: the module mpi is not there: "));
  EXPECT_THAT(mpi.err, HasSubstr("carousel-mpi"));
  EXPECT_THAT(wood.err, HasSubstr("wood.gltf: /images/0: the image is TGA, neither PNG nor JPEG nor WebP, and "
                                  "the module pictures is not there: "));
}

// A sweep goes by the content of files: those that a model names count as the model does.
TEST_F(ImportRun, DigestsCountMaterialFilesAndPictures) {
  const auto digest = [&] {
    SceneConfig config;
    config.file = "roof.obj";
    return app::ContentDigests(program_.folder()).of({}, config, {}, {});
  };
  const std::string first = digest();
  EXPECT_EQ(digest(), first);
  program_.write("roof.mtl", "newmtl m\nKd 0.5 0.25 0.75\nmap_Kd wood.png\n");
  const std::string no_picture = digest();
  EXPECT_NE(no_picture, first);
  program_.write("wood.png", "one");
  const std::string picture = digest();
  EXPECT_NE(picture, no_picture);
  program_.write("wood.png", "two");
  EXPECT_NE(digest(), picture);
  program_.write("other.png", "beside the model, and not of it");
  program_.write("wood.png", "one");
  EXPECT_EQ(digest(), picture);
}

TEST_F(ImportRun, WithoutTheModuleTheErrorNamesThePackage) {
  std::filesystem::create_directory(program_.folder() / "none");
  setenv("CAROUSEL_MODULES", (program_.folder() / "none").c_str(), 1);
  const Outcome outcome = program_.run({"run", "roof.yaml", "--set", "scene.file=roof.obj"});
  const Outcome gltf = program_.run({"run", "roof.yaml", "--out", "out"});
  unsetenv("CAROUSEL_MODULES");
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(outcome.err, HasSubstr("the module scenes is not there"));
  EXPECT_THAT(outcome.err, HasSubstr("libassimp-dev"));
  EXPECT_EQ(gltf.status, 0) << "glTF needs no module";
}

}  // namespace
}  // namespace carousel::import_run_test

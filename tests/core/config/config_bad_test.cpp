// Configurations that cannot be read, with message and position.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/core/config/bad_config.h"

namespace carousel {
namespace {

class ConfigBad : public testing::TestWithParam<BadConfig> {};

TEST_P(ConfigBad, IsRefusedWithPositionAndExpectation) {
  EXPECT_THAT(texts(issues_of(GetParam().text)), testing::ElementsAre(GetParam().message));
}

#define SCENE "scene: {builtin: cornell}\n"

INSTANTIATE_TEST_SUITE_P(
    Reading, ConfigBad,
    testing::Values(
        BadConfig{"UnknownKey", SCENE "image:\n  widht: 5\n",
                  "test.yaml:3:3: image.widht: unknown key; did you mean 'width'?"},
        BadConfig{"KeyOfAnotherSection", SCENE "placement: balanced\n",
                  "test.yaml:2:1: placement: unknown key; did you mean 'rays.placement'?"},
        BadConfig{"EyeOfText", SCENE "camera: {eye: here, target: [0, 0, 5]}\n",
                  "test.yaml:2:15: camera.eye: expected auto or a list of 3 numbers, found 'here'"},
        BadConfig{"FieldOfViewOfNothing", SCENE "camera: {field_of_view: 0}\n",
                  "test.yaml:2:25: camera.field_of_view: expected auto or a number above 0 to 179 (degrees), found 0"},
        BadConfig{"KeyLikeNothing", SCENE "camera: {zzzzzzzz: 1}\n",
                  "test.yaml:2:10: camera.zzzzzzzz: unknown key; known here: eye, target, up, field_of_view, aperture, "
                  "focus_distance"},
        BadConfig{"DuplicateKey", SCENE "image:\n  width: 5\n  width: 6\n",
                  "test.yaml:4:3: image.width: duplicate key; first given at line 3, column 3"},
        BadConfig{"DuplicateSection", "scene: {builtin: cornell}\nscene: {builtin: sliver}\n",
                  "test.yaml:2:1: scene: duplicate key; first given at line 1, column 1"},
        BadConfig{"SecondDocument", SCENE "---\n" SCENE,
                  "test.yaml:2:1: a second document; a configuration is one YAML document"},
        BadConfig{"Syntax", SCENE "image: {width: 5\n", "test.yaml:3:1: end of map flow not found"},
        BadConfig{"NotAMap", "- 1\n- 2\n", "test.yaml:1:1: expected a map, found a list"},
        BadConfig{"SchemaVersion", "schema_version: 2\n" SCENE, "test.yaml:1:17: schema_version: expected 1, found 2"},
        BadConfig{"SectionIsText", SCENE "image: big\n", "test.yaml:2:8: image: expected a map, found 'big'"},
        BadConfig{"SectionIsEmpty", SCENE "image:\n", "test.yaml:2:1: image: expected a map, found nothing"},
        BadConfig{"FractionForInteger", SCENE "image: {width: 2.5}\n",
                  "test.yaml:2:16: image.width: expected an integer from 1 to 16384 (pixels), found 2.5"},
        BadConfig{"QuotedNumber", SCENE "image: {width: '25'}\n",
                  "test.yaml:2:16: image.width: expected an integer from 1 to 16384 (pixels), found '25'"},
        BadConfig{"HugeNumber", SCENE "image: {width: 99999999999999999999999}\n",
                  "test.yaml:2:16: image.width: expected an integer from 1 to 16384 (pixels), found "
                  "99999999999999999999999"},
        BadConfig{"Negative", SCENE "image: {seed: -1}\n",
                  "test.yaml:2:15: image.seed: expected an integer from 0 to 9223372036854775807, found -1"},
        BadConfig{"RealOutOfRange", SCENE "camera: {focus_distance: 0}\n",
                  "test.yaml:2:26: camera.focus_distance: expected a number above 0 to 1e+09 (scene units), "
                  "found 0"},
        BadConfig{
            "RasterWithALens", SCENE "primary: raster\ncamera: {aperture: 0.5}\n",
            "test.yaml:3:20: camera.aperture: primary: raster needs a pinhole; expected 0, or primary: rays, found "
            "0.5"},
        BadConfig{"RasterWithoutACamera", SCENE "primary: raster\nworkload: {rays_from: a.csv}\n",
                  "test.yaml:2:10: primary: this workload has no camera; expected rays, found raster"},
        BadConfig{"NotANumber", SCENE "camera: {aperture: .nan}\n",
                  "test.yaml:2:20: camera.aperture: expected a number from 0 to 1e+06 (scene units), found nan"},
        BadConfig{"Infinite", SCENE "camera: {aperture: .inf}\n",
                  "test.yaml:2:20: camera.aperture: expected a number from 0 to 1e+06 (scene units), found inf"},
        BadConfig{"OldStyleSwitch", SCENE "cull_planes: {shared_normals: yes}\n",
                  "test.yaml:2:31: cull_planes.shared_normals: expected true or false, found 'yes'"},
        BadConfig{"EnumName", SCENE "topology: {shape: rign}\n",
                  "test.yaml:2:19: topology.shape: expected one of ring, bidirectional, multi_ring, hierarchical, "
                  "point_to_point, bus, central, independent, graph, found 'rign'; did you mean 'ring'?"},
        BadConfig{"Threads", SCENE "engine: {threads: many}\n",
                  "test.yaml:2:19: engine.threads: expected auto or an integer from 1 to 1024 (threads), "
                  "found 'many'"},
        BadConfig{"ColorOfTwo", "scene: {builtin: cornell, sky: {color: [1, 2]}}\n",
                  "test.yaml:1:40: scene.sky.color: expected a list of 3 numbers, found a list"},
        BadConfig{"ColorNegative", "scene: {builtin: cornell, sky: {color: [1, 2, -3]}}\n",
                  "test.yaml:1:47: scene.sky.color: expected a number from 0 to 1e+06 (linear RGB), found -3"},
        BadConfig{"BareUnits", SCENE "testers: {triangle: 0}\n",
                  "test.yaml:2:21: testers.triangle: expected a map or an integer from 1 to 1024 (units), found 0"},
        BadConfig{"OverrideWithoutResource", SCENE "topology: {overrides: [{testers: {box: 2}}]}\n",
                  "test.yaml:2:24: topology.overrides.0: expected the key 'resource', or 'nodes' for those of a graph"},
        BadConfig{"OverridesIsMap", SCENE "topology: {overrides: {resource: 1}}\n",
                  "test.yaml:2:23: topology.overrides: expected a list, found a map"},
        BadConfig{"EmptyFileName", "scene: {file: ''}\n",
                  "test.yaml:1:15: scene.file: expected a text that is not empty, found ''"},
        BadConfig{"WorkloadName", SCENE "workload: ray\n",
                  "test.yaml:2:11: workload: expected rays, {rays_from: FILE}, {memory_trace: FILE}, {traffic: {...}} "
                  "or {plugin: NAME, options: {...}}, found 'ray'"},
        BadConfig{"WorkloadBoth", SCENE "workload: {rays_from: a.csv, traffic: {}}\n",
                  "test.yaml:2:11: workload: expected rays, {rays_from: FILE}, {memory_trace: FILE}, {traffic: {...}} "
                  "or {plugin: NAME, options: {...}}"},
        BadConfig{"WorkloadKey", SCENE "workload: {ray_from: a.csv, rays_from: b.csv}\n",
                  "test.yaml:2:12: workload.ray_from: unknown key; did you mean 'rays_from'?"},
        BadConfig{"Effects", SCENE "shading: {effects: 3}\n",
                  "test.yaml:2:20: shading.effects: expected auto, all or a list of effects, found 3"},
        BadConfig{"Tag", SCENE "image: !!set {width: 5}\n",
                  "test.yaml:2:8: tag 'tag:yaml.org,2002:set' has no meaning here"},
        BadConfig{"ListAsKey", SCENE "? [a, b]\n: 1\n",
                  "test.yaml:2:3: expected a name as the key, found a list (or is a bracket not "
                  "closed?)"},
        BadConfig{"AliasOfItself", SCENE "image: &i {width: *i}\n",
                  "test.yaml:2:19: an alias inside of what it stands for"},
        BadConfig{"NotUtf8", "scene: {file: \"\xff\"}\n", "test.yaml:1:16: not UTF-8 text"}),
    [](const auto& bad) { return bad.param.name; });

}  // namespace
}  // namespace carousel

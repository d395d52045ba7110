#include "report/csv/ray_csv.h"

#include <bit>
#include <fstream>
#include <random>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "core/system/error.h"

namespace carousel::report {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

const std::string kHeader = "ray,kind,ox,oy,oz,dx,dy,dz,tmin,tmax\n";

std::filesystem::path temporary(const char* name) {
  return std::filesystem::path(testing::TempDir()) / (std::to_string(getpid()) + name);
}

std::string content(const std::filesystem::path& path) {
  std::ifstream in(path);
  return {std::istreambuf_iterator<char>(in), {}};
}

std::vector<std::string> problems(const std::string& text) {
  std::istringstream in(text);
  std::vector<std::string> out;
  try {
    read_rays_csv(in, "r.csv");
  } catch (const ConfigError& error) {
    for (const ConfigIssue& issue : error.issues()) out.push_back(issue.text());
  }
  return out;
}

HitRow row(std::uint32_t pixel, std::uint32_t sample, RayKind kind, std::uint8_t bounce, bool hit) {
  HitRow out;
  out.pixel = pixel;
  out.sample = sample;
  out.result.tag.kind = kind;
  out.result.tag.bounce = bounce;
  out.result.ray.origin = {1, 0.1f, -2.5f};
  if (hit) out.result.hit = {1.5f, 0.25f, 0.5f, 3, 7};
  return out;
}

TEST(RayCsv, ListsHaveABound) {
  const std::string ray = "0,camera,0,0,0,0,0,1,0,inf\n";
  std::istringstream enough(kHeader + ray + ray), more(kHeader + ray + ray + ray);
  EXPECT_EQ(read_rays_csv(enough, "r.csv", 2).size(), 2u);
  try {
    read_rays_csv(more, "r.csv", 2);
    FAIL();
  } catch (const ConfigError& error) {
    EXPECT_EQ(error.issues().at(0).text(), "r.csv:4: expected at most 2 rays, found more");
  }
}

/// Writes a list with one of the two functions.
template <class Write>
void write_list(const Write& write, const std::filesystem::path& path, const std::vector<HitRow>& rows,
                bool complete = true) {
  AtomicFile file(path);
  write(file, rows, complete);
  file.commit();
}

TEST(RayCsv, WritesTheColumnsOfTheContract) {
  const auto path = temporary("hits.csv");
  write_list(write_hits_csv, path,
             {row(0, 0, RayKind::kCamera, 0, true), row(0, 0, RayKind::kBounce, 1, false),
              row(0, 0, RayKind::kShadow, 1, true)});
  EXPECT_EQ(content(path),
            "ray,kind,ox,oy,oz,dx,dy,dz,tmin,tmax,hit,t,instance,primitive,u,v\n"
            "0,camera,1,0.1,-2.5,0,0,1,0,inf,1,1.5,3,7,0.25,0.5\n"
            "1,bounce,1,0.1,-2.5,0,0,1,0,inf,0,inf,,,,\n"
            "2,shadow,1,0.1,-2.5,0,0,1,0,inf,1,,,,,\n");
  std::filesystem::remove(path);
}

TEST(RayCsv, SortsByPixelSampleBounceKindAndIndex) {
  std::vector<HitRow> rows{row(1, 0, RayKind::kCamera, 0, true), row(0, 1, RayKind::kCamera, 0, true),
                           row(0, 0, RayKind::kShadow, 0, true), row(0, 0, RayKind::kBounce, 1, true),
                           row(0, 0, RayKind::kCamera, 0, true)};
  sort_rows(rows);
  std::vector<int> kinds;
  for (const HitRow& r : rows) kinds.push_back(static_cast<int>(r.result.tag.kind));
  EXPECT_THAT(kinds, ElementsAre(0, 2, 1, 0, 0));
  EXPECT_EQ(rows[3].sample, 1u);
  EXPECT_EQ(rows[4].pixel, 1u);
}

TEST(RayCsv, RaysReadBackToTheSameBits) {
  std::mt19937 random(1);
  std::vector<HitRow> rows;
  const auto any_float = [&] {
    for (;;) {
      const float value = std::bit_cast<float>(static_cast<std::uint32_t>(random()));
      if (std::isfinite(value) && value != 0) return value;
    }
  };
  for (std::uint32_t i = 0; i < 2000; ++i) {
    HitRow r = row(i, 0, static_cast<RayKind>(i % 3), 0, false);
    r.result.ray = {{any_float(), any_float(), any_float()},
                    std::abs(any_float()),
                    {any_float(), any_float(), any_float()},
                    kInfinity};
    rows.push_back(r);
  }
  const auto path = temporary("rays.csv");
  for (const auto write : {write_rays_csv, write_hits_csv}) {
    write_list(write, path, rows);
    const RayBatch rays = read_rays_csv(path);
    ASSERT_EQ(rays.size(), rows.size());
    for (std::size_t i = 0; i < rays.size(); ++i) {
      EXPECT_EQ(rays[i].tag.path, i);
      EXPECT_EQ(rays[i].tag.kind, rows[i].result.tag.kind);
      EXPECT_EQ(rays[i].ray.origin, rows[i].result.ray.origin);
      EXPECT_EQ(rays[i].ray.direction, rows[i].result.ray.direction);
      EXPECT_EQ(rays[i].ray.tmin, rows[i].result.ray.tmin);
      EXPECT_EQ(rays[i].ray.tmax, kInfinity);
    }
  }
  std::filesystem::remove(path);
}

TEST(RayCsv, ReadsWindowsLinesAndNoLastNewline) {
  std::istringstream in(
      "ray,kind,ox,oy,oz,dx,dy,dz,tmin,tmax\r\n0,camera,0,0,0,0,0,1,0,inf\r\n\r\n1,shadow,0,0,0,0,1e-60,1,0,"
      "1");
  EXPECT_EQ(read_rays_csv(in, "r.csv").size(), 2u);
}

// Others reported this kind of fault: tinybvh 156.
TEST(RayCsv, RefusesBadRowsAllTogether) {
  EXPECT_THAT(problems(kHeader + "0,camera,0,0,0,0,0,1,0,inf\n"
                                 "1,primary,0,x,0,0,0,1,0,inf\n"
                                 "2,camera,0,0,0,0,0,0,0,inf\n"
                                 "3,camera,0,0,0,0,0,1,2,1\n"
                                 "4,camera,0,0\n"
                                 "5,camera,0,0,inf,0,0,1,0,nan\n"
                                 "6,camera,0,0,0,0,0,1e99,0,1\n"),
              ElementsAre("r.csv:3:3: expected camera, bounce or shadow, found 'primary'",
                          "r.csv:3:13: expected a finite number for oy, found 'x'",
                          "r.csv:4:16: expected a direction, found 0,0,0",
                          "r.csv:5:22: expected 0 <= tmin <= tmax, found 2 and 1",
                          "r.csv:6:1: expected at least 10 values, found 4",
                          "r.csv:7:14: expected a finite number for oz, found 'inf'",
                          "r.csv:7:26: expected a number for tmax, found 'nan'",
                          "r.csv:8:20: expected a finite number for dz, found '1e99'"));
}

TEST(RayCsv, EachRayHasItsFlags) {
  std::vector<HitRow> rows(4, row(0, 0, RayKind::kCamera, 0, true));
  rows[1].result.tag.flags = kRayCullFront | kRayForceOpaque | kRayDone;
  rows[2].result.tag.flags = kRayCullBack;
  const auto path = temporary("flags.csv");
  for (const auto write : {write_rays_csv, write_hits_csv}) {
    write_list(write, path, rows);
    EXPECT_THAT(content(path), HasSubstr(",flags\n"));
    EXPECT_THAT(content(path), HasSubstr(",cull_front+force_opaque\n"));
    const RayBatch rays = read_rays_csv(path);
    ASSERT_EQ(rays.size(), 4u);
    EXPECT_EQ(rays[0].tag.flags, 0);
    EXPECT_EQ(rays[1].tag.flags, kRayCullFront | kRayForceOpaque);
    EXPECT_EQ(rays[2].tag.flags, kRayCullBack);
    EXPECT_EQ(rays[3].tag.flags, 0);
  }
  std::filesystem::remove(path);
  EXPECT_THAT(problems("ray,kind,ox,oy,oz,dx,dy,dz,tmin,tmax,more,flags\n"
                       "0,camera,0,0,0,0,0,1,0,inf,x,cull_back+cull\n"
                       "1,camera,0,0,0,0,0,1,0,inf,x\n"
                       "2,camera,0,0,0,0,0,1,0,inf,cull,\n"
                       "3,camera,0,0,0,0,0,1,0,inf,x,cull_back+\n"),
              ElementsAre("r.csv:2:40: expected cull_back, cull_front or force_opaque, joined by +, found 'cull'",
                          "r.csv:5:40: expected cull_back, cull_front or force_opaque, joined by +, found ''"));
  EXPECT_THAT(problems("ray,kind,ox,oy,oz,dx,dy,dz,tmin,tmax,flags,flags\n"),
              ElementsAre("r.csv:1:44: there is a column flags already"));
}

TEST(RayCsv, TheLastLineOfAListCountsItsRays) {
  const auto path = temporary("counted.csv");
  const std::vector<HitRow> rows(3, row(0, 0, RayKind::kCamera, 0, true));
  write_list(write_rays_csv, path, rows);
  const std::string whole = content(path);
  EXPECT_TRUE(whole.ends_with("\n# rows: 3\n")) << whole;
  const std::size_t second = whole.find("\n1,") + 1;
  EXPECT_THAT(problems(whole.substr(0, second) + whole.substr(whole.find("\n2,") + 1)),
              ElementsAre("r.csv:4:1: this line says that the list holds 3 rays; expected as many, found 2"));
  EXPECT_THAT(problems(whole + "3,camera,0,0,0,0,0,1,0,inf\n"),
              ElementsAre("r.csv:6:1: expected no ray behind the line that counts them"));
  EXPECT_THAT(problems(kHeader), ElementsAre(HasSubstr("expected at least one ray, found none")));
  EXPECT_THAT(problems(kHeader + "# rows: 0\n"), ElementsAre(HasSubstr("expected at least one ray, found none")));
  for (const auto write : {write_rays_csv, write_hits_csv}) {
    write_list(write, path, rows, false);
    EXPECT_THAT(problems(content(path)),
                ElementsAre(HasSubstr("r.csv:5:1: the run that wrote this list was interrupted")));
  }
  std::filesystem::remove(path);
}

TEST(RayCsv, RefusesAMissingHeader) {
  EXPECT_THAT(problems(""), ElementsAre(HasSubstr("r.csv:1: expected the header ray,kind,")));
  EXPECT_THAT(problems("0,camera,0,0,0,0,0,1,0,inf\n"), ElementsAre(HasSubstr("r.csv:1:1: expected the header")));
  EXPECT_THAT(problems("ray,kind,ox,oy,oz,dx,dz,dy,tmin,tmax\n"), ElementsAre(HasSubstr("r.csv:1:22: expected")));
}

TEST(RayCsv, StopsAfterTheFirstProblems) {
  std::string text = kHeader;
  for (int i = 0; i < 1000; ++i) text += "x\n";
  EXPECT_EQ(problems(text).size(), 20u);
}

TEST(RayCsv, RefusesFilesThatCannotBeRead) {
  EXPECT_THROW(read_rays_csv("/nonexistent/rays.csv"), FileError);
  EXPECT_THROW(read_rays_csv(testing::TempDir()), FileError);
}

}  // namespace
}  // namespace carousel::report

#include "shading/camera/path_sample.h"

#include <map>
#include <set>

#include <gtest/gtest.h>

namespace carousel::shading {
namespace {

std::vector<std::uint64_t> ordinals(const PathSample& sample) {
  std::vector<std::uint64_t> out;
  for (std::uint64_t i = 0; i < sample.count(); ++i) out.push_back(sample.ordinal(i));
  return out;
}

TEST(PathSample, GivesTheRunsOneAfterAnother) {
  const PathSample sample({{10, 2}, {100, 1}, {30, 2}});
  EXPECT_EQ(sample.count(), 5u);
  EXPECT_EQ(ordinals(sample), (std::vector<std::uint64_t>{10, 11, 100, 30, 31}));
}

TEST(PathSample, TileBeginsAreWhereTheOrderEntersATile) {
  for (const auto& [width, height, samples] : {std::tuple{64u, 40u, 1u}, {61u, 43u, 3u}, {5u, 3u, 2u}}) {
    const PixelOrder order(width, height, samples);
    std::uint64_t all = 0;
    for (std::uint64_t row = 0; row < order.tile_rows(); ++row) {
      for (std::uint64_t column = 0; column < order.tile_columns(); ++column) {
        EXPECT_EQ(order.tile_begin(column, row), all);
        const PixelSample first = order.at(order.tile_begin(column, row));
        EXPECT_EQ(first.x, 8 * column);
        EXPECT_EQ(first.y, 8 * row);
        EXPECT_EQ(first.sample, 0u);
        all += samples * order.tile_pixels(column, row);
      }
    }
    EXPECT_EQ(all, order.count());
  }
}

// Before issue 16 the pilot was the first paths: the top of the picture.
TEST(PathSample, IsDrawnOverTheWholePicture) {
  const PixelOrder order(320, 240, 2);
  const PathSample sample = draw_tiles(order, 8192, 512, 1);
  EXPECT_NEAR(static_cast<double>(sample.count()), 8192, 0.1 * 8192);
  const std::vector<std::uint64_t> chosen = ordinals(sample);
  EXPECT_EQ(std::set(chosen.begin(), chosen.end()).size(), chosen.size()) << "no path twice";
  int bands[4] = {}, halves[2] = {};
  for (const std::uint64_t ordinal : chosen) {
    const PixelSample at = order.at(ordinal);
    ++bands[at.y / 60];
    ++halves[at.x / 160];
  }
  for (const int paths : bands) EXPECT_NEAR(paths, 2048, 1024);
  for (const int paths : halves) EXPECT_NEAR(paths, 4096, 1536);
  // The upper part comes first, and a whole tile's pixels at a time.
  EXPECT_LT(order.at(chosen.front()).y, 64u);
  EXPECT_GE(order.at(chosen.back()).y, 176u);
  for (std::size_t i = 0; i < chosen.size(); i += 64)
    for (std::size_t k = 1; k < 64; ++k) ASSERT_EQ(chosen[i + k], chosen[i] + k);
}

// Sixteen places are few for a large sample: their mix is not the picture's.
TEST(PathSample, HasMorePlacesTheMorePathsThereAre) {
  const PixelOrder order(640, 480, 1);
  const auto places = [&](std::uint64_t paths, std::uint64_t together) {
    const std::vector<std::uint64_t> chosen = ordinals(draw_tiles(order, paths, together, 1));
    int found = 0;
    std::uint64_t before = order.count();
    for (const std::uint64_t ordinal : chosen) {
      found += ordinal != before + 1;
      before = ordinal;
    }
    return found;
  };
  EXPECT_NEAR(places(16384, 16384), 16, 8);
  EXPECT_NEAR(places(65536, 512), 128, 40);
}

TEST(PathSample, TheSeedChoosesTheTiles) {
  const PixelOrder order(320, 240, 1);
  EXPECT_EQ(ordinals(draw_tiles(order, 2000, 512, 1)), ordinals(draw_tiles(order, 2000, 512, 1)));
  EXPECT_NE(ordinals(draw_tiles(order, 2000, 512, 1)), ordinals(draw_tiles(order, 2000, 512, 2)));
}

TEST(PathSample, EveryTileIsAsLikely) {
  const PixelOrder order(104, 72, 1);  // 13 x 9 tiles, in rectangles of unequal numbers of them
  std::vector<double> times(13 * 9);
  constexpr int kDraws = 4000;
  double all = 0;
  for (int draw = 0; draw < kDraws; ++draw) {
    const PathSample sample = draw_tiles(order, 30 * 64, 512, 7, static_cast<std::uint64_t>(draw));
    for (std::uint64_t i = 0; i < sample.count(); i += 64, ++all) {
      const PixelSample at = order.at(sample.ordinal(i));
      ++times[at.y / 8 * 13 + at.x / 8];
    }
  }
  const double mean = all / static_cast<double>(times.size());
  for (const double count : times) EXPECT_NEAR(count, mean, 0.2 * mean);
}

TEST(PathSample, FitsSmallPictures) {
  for (const std::uint64_t paths : {1u, 64u, 1000u, 100000u}) {
    const PixelOrder order(9, 17, 3);
    const PathSample sample = draw_tiles(order, paths, 512, 3);
    EXPECT_GE(sample.count(), 1u);
    const std::vector<std::uint64_t> chosen = ordinals(sample);
    EXPECT_EQ(std::set(chosen.begin(), chosen.end()).size(), chosen.size());
    EXPECT_LT(*std::max_element(chosen.begin(), chosen.end()), order.count());
  }
}

// A tenth of 40 x 30 tiles in 30 places: every place has 4 tiles of a row, with all samples, in a rectangle of its own.
TEST(PathSample, PlacesAreNeighboursWithAllTheirSamples) {
  const PixelOrder order(320, 240, 4);
  const PathSample sample = draw_places(order, order.count() / 10, 30, 4, 1);
  EXPECT_NEAR(static_cast<double>(sample.count()), static_cast<double>(order.count()) / 10, 0.03 * 307200);
  std::map<std::uint32_t, std::set<std::uint64_t>> places;
  for (const PathSample::Run& run : sample.runs()) {
    EXPECT_EQ(run.count, 4u * 64u);
    EXPECT_EQ(run.first % (4 * 64), 0u);
    places[run.place].insert(run.first / (4 * 64));
  }
  EXPECT_NEAR(static_cast<double>(places.size()), 30, 6);
  for (const auto& [place, tiles] : places) {
    EXPECT_EQ(*tiles.rbegin() - *tiles.begin() + 1, tiles.size()) << place;
    EXPECT_EQ(*tiles.rbegin() / 40, *tiles.begin() / 40) << place;
  }
  std::set<std::uint64_t> bands;
  for (const auto& [place, tiles] : places) bands.insert(*tiles.begin() / 40 / 10);
  EXPECT_EQ(bands.size(), 3u) << "all over the picture";
}

// The further paths are others, of the lower end of the picture, and keep the order of the frame.
TEST(PathSample, IsFollowedByOtherPathsOfTheEnd) {
  const PixelOrder order(320, 240, 1);
  const PathSample own = draw_tiles(order, 4096, 512, 1, 0), others = draw_tiles(order, 4096, 512, 1, 1),
                   all = followed_by(own, others, 1000);
  const std::vector<std::uint64_t> first = ordinals(own), chosen = ordinals(all);
  EXPECT_TRUE(std::equal(first.begin(), first.end(), chosen.begin()));
  EXPECT_GE(all.count(), own.count() + 1000);
  EXPECT_LT(all.count(), own.count() + 1000 + 512);
  EXPECT_EQ(std::set(chosen.begin(), chosen.end()).size(), chosen.size());
  for (std::uint64_t i = own.count(); i < all.count(); ++i) EXPECT_GT(order.at(all.ordinal(i)).y, 120u);
  for (std::size_t i = 1; i < all.runs().size(); ++i) EXPECT_GE(all.runs()[i].place, all.runs()[i - 1].place);
  EXPECT_EQ(followed_by(own, own, 1000).count(), own.count()) << "its own paths begin once";
}

TEST(PathSample, OfAListIsDrawnOverAllOfIt) {
  const PathSample sample = draw_list(10000, 1024, 5);
  EXPECT_NEAR(static_cast<double>(sample.count()), 1024, 64);
  const std::vector<std::uint64_t> chosen = ordinals(sample);
  EXPECT_TRUE(std::is_sorted(chosen.begin(), chosen.end()));
  EXPECT_EQ(std::set(chosen.begin(), chosen.end()).size(), chosen.size());
  EXPECT_LT(chosen.front(), 640u);
  EXPECT_GE(chosen.back(), 9300u);
  EXPECT_LT(chosen.back(), 10000u);
}

}  // namespace
}  // namespace carousel::shading

#include "cli/run/palette.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

namespace regrasp::run {
namespace {

constexpr int kWidth = 256, kHeight = 128;

/// Red rises to the right and green downwards: more colours than a palette has.
std::vector<std::uint8_t> Ramps() {
  std::vector<std::uint8_t> bgr;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x)
      for (const int value : {40, 2 * y, x}) bgr.push_back(static_cast<std::uint8_t>(value));
  return bgr;
}

TEST(Palette, AFewColoursStayWhatTheyAre) {
  std::vector<std::uint8_t> bgr;
  const std::vector<Bgr> colours = {{255, 255, 255}, {0, 0, 0}, {178, 114, 0}, {0, 94, 213}};
  for (int i = 0; i < kWidth * kHeight; ++i)
    for (const std::uint8_t value : colours[static_cast<std::size_t>(i * i / 7 % 4)])
      bgr.push_back(value);
  const std::vector<Bgr> palette = PaletteOf(bgr);
  EXPECT_EQ(palette.size(), colours.size());
  const std::vector<std::uint8_t> indices = Dithered(bgr, kWidth, palette);
  ASSERT_EQ(indices.size() * 3, bgr.size());
  for (std::size_t i = 0; i < indices.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k) ASSERT_EQ(palette[indices[i]][k], bgr[3 * i + k]) << i;
}

TEST(Palette, ShadesKeepTheirMean) {
  const std::vector<std::uint8_t> bgr = Ramps();
  const std::vector<Bgr> palette = PaletteOf(bgr);
  EXPECT_EQ(palette.size(), 256u);
  const std::vector<std::uint8_t> indices = Dithered(bgr, kWidth, palette);
  constexpr int kBlock = 16;
  for (int y = 0; y < kHeight; y += kBlock)
    for (int x = 0; x < kWidth; x += kBlock)
      for (std::size_t k = 0; k < 3; ++k) {
        double off = 0;
        for (int i = 0; i < kBlock * kBlock; ++i) {
          const auto at = static_cast<std::size_t>((y + i / kBlock) * kWidth + x + i % kBlock);
          off += palette[indices[at]][k] - bgr[3 * at + k];
        }
        // A pixel is off by 11 levels or less, as 256 colours divide a square of 256 levels. Only
        // what crosses the 64 pixels of the block's border is lost to it: some 64 * 11 / 256.
        EXPECT_LT(std::abs(off) / (kBlock * kBlock), 3) << x << " " << y << " " << k;
      }
}

}  // namespace
}  // namespace regrasp::run

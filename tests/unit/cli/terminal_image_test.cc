// Pictures as text: each encoding is read back by an independent reader.

#include "cli/print/terminal_image.h"

#include <gtest/gtest.h>
#include <png.h>

#include <array>
#include <cmath>
#include <map>

#include "cli/client/errors.h"

namespace regrasp::cli {
namespace {

Image Gradient(int width, int height) {
  Image image{width, height, {}};
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (const int value : {255 * x / width, 255 * y / height, 128})
        image.rgb.push_back(static_cast<std::uint8_t>(value));
  return image;
}

std::string Png(const Image& image) {
  png_image header = {};
  header.version = PNG_IMAGE_VERSION;
  header.width = static_cast<png_uint_32>(image.width);
  header.height = static_cast<png_uint_32>(image.height);
  header.format = PNG_FORMAT_RGB;
  png_alloc_size_t size = 0;
  png_image_write_to_memory(&header, nullptr, &size, 0, image.rgb.data(), 0, nullptr);
  std::string bytes(size, '\0');
  png_image_write_to_memory(&header, bytes.data(), &size, 0, image.rgb.data(), 0, nullptr);
  bytes.resize(size);
  return bytes;
}

/// A reader of sixel after DEC's manual, for what a terminal would show.
Image ReadSixel(const std::string& text) {
  Image image;
  std::map<int, std::array<int, 3>> colors;
  int color = 0, x = 0, top = 0;
  std::size_t i = text.find('q') + 1;
  const auto number = [&] {
    int value = 0;
    for (; text[i] >= '0' && text[i] <= '9'; ++i) value = 10 * value + (text[i] - '0');
    return value;
  };
  const auto paint = [&](char sixel, int count) {
    for (; count > 0; --count, ++x)
      for (int bit = 0; bit < 6; ++bit)
        if (((sixel - '?') >> bit & 1) != 0)
          for (std::size_t c = 0; c < 3; ++c)
            image.rgb.at(3 * static_cast<std::size_t>((top + bit) * image.width + x) + c) =
                static_cast<std::uint8_t>(std::lround(colors.at(color)[c] * 2.55));
  };
  while (text[i] != '\x1b') {
    const char command = text[i++];
    if (command == '"') {
      number(), ++i, number(), ++i;
      image.width = number(), ++i;
      image.height = number();
      image.rgb.assign(3 * static_cast<std::size_t>(image.width * image.height), 1);
    } else if (command == '#') {
      color = number();
      if (text[i] != ';') continue;
      ++i, number();
      for (auto& channel : colors[color]) ++i, channel = number();
    } else if (command == '!') {
      const int count = number();
      paint(text[i++], count);
    } else if (command == '$') {
      x = 0;
    } else if (command == '-') {
      x = 0, top += 6;
    } else {
      paint(command, 1);
    }
  }
  return image;
}

int LargestDifference(const Image& a, const Image& b) {
  EXPECT_EQ(a.rgb.size(), b.rgb.size());
  int largest = 0;
  for (std::size_t i = 0; i < a.rgb.size(); ++i)
    largest = std::max(largest, std::abs(a.rgb[i] - b.rgb[i]));
  return largest;
}

TEST(TerminalImage, PngIsDecodedBitForBit) {
  const Image image = Gradient(31, 17);
  const Image read = DecodePng(Png(image), "x.png");
  EXPECT_EQ(read.width, 31);
  EXPECT_EQ(read.rgb, image.rgb);
}

TEST(TerminalImage, WhatIsNoPngIsRefusedByName) {
  const std::string png = Png(Gradient(31, 17));
  for (const std::string& bytes :
       {std::string(), std::string("hello"), png.substr(0, png.size() / 2)}) {
    try {
      DecodePng(bytes, "x.png");
      ADD_FAILURE() << bytes.size();
    } catch (const CliError& error) {
      EXPECT_EQ(error.code, kIo);
      EXPECT_NE(std::string(error.what()).find("x.png"), std::string::npos);
    }
  }
}

TEST(TerminalImage, ResizingKeepsTheMean) {
  const Image image = Gradient(120, 60);
  const Image small = Resize(image, 20, 10);
  const auto mean = [](const Image& i) {
    double sum = 0;
    for (const auto v : i.rgb) sum += v;
    return sum / static_cast<double>(i.rgb.size());
  };
  EXPECT_NEAR(mean(small), mean(image), 0.5);  // rounding of each pixel
  EXPECT_EQ(LargestDifference(Resize(image, 120, 60), image), 0);
}

TEST(TerminalImage, FitKeepsTheShapeAndNeverEnlarges) {
  const Image image = Gradient(200, 100);
  EXPECT_EQ(Fit(image, 50, 1000).height, 25);
  EXPECT_EQ(Fit(image, 1000, 10).width, 20);
  EXPECT_EQ(Fit(image, 1000, 1000).width, 200);
  EXPECT_EQ(Fit(image, 1, 1).height, 1);
}

TEST(TerminalImage, SixelReadsBackAsThePicture) {
  // A height that is no multiple of 6, and few enough colours (5 bits a channel) to keep all: 1 %
  // of the range for sixel's percentages, 8 levels for the bins.
  const Image image = Resize(Gradient(120, 61), 15, 11);
  EXPECT_LE(LargestDifference(ReadSixel(Sixel(image)), image), 8 + 3);
  Image flat{40, 7, std::vector<std::uint8_t>(3 * 280, 255)};
  EXPECT_EQ(LargestDifference(ReadSixel(Sixel(flat)), flat), 0);
}

TEST(TerminalImage, SixelOfManyColoursStaysNear) {
  const Image image = Gradient(96, 96);
  // 32 x 32 bins in 255 boxes: 2 x 3 bins of 8 levels; to the mean of a box at most the box's side.
  EXPECT_LE(LargestDifference(ReadSixel(Sixel(image)), image), 24);
}

TEST(TerminalImage, KittyCarriesTheFile) {
  const std::string png = Png(Gradient(200, 150));
  std::string data;
  const std::string text = Kitty(png, 33);
  EXPECT_TRUE(text.starts_with("\x1b_Ga=T,f=100,q=2,c=33,m="));
  for (std::size_t at = text.find("\x1b_G"); at != std::string::npos;
       at = text.find("\x1b_G", at + 1)) {
    const auto begin = text.find(';', at) + 1, end = text.find("\x1b\\", at);
    EXPECT_LE(end - begin, 4096u);
    const bool last = text.find("\x1b_G", end) == std::string::npos;
    EXPECT_NE(text.substr(at, begin - at).find(last ? "m=0" : "m=1"), std::string::npos);
    data += text.substr(begin, end - begin);
  }
  EXPECT_EQ(data, Base64(png));
}

TEST(TerminalImage, Base64KnowsItsRfc) {
  // RFC 4648, section 10.
  EXPECT_EQ(Base64(""), "");
  EXPECT_EQ(Base64("f"), "Zg==");
  EXPECT_EQ(Base64("fo"), "Zm8=");
  EXPECT_EQ(Base64("foo"), "Zm9v");
  EXPECT_EQ(Base64("foobar"), "Zm9vYmFy");
}

TEST(TerminalImage, HalfBlocksHoldTwoRowsACell) {
  Image image{2, 3, {255, 0, 0, 255, 0, 0, 0, 0, 255, 0, 0, 255, 1, 2, 3, 1, 2, 3}};
  EXPECT_EQ(HalfBlocks(image, true),
            "\x1b[38;2;255;0;0;48;2;0;0;255m▀▀\x1b[0m\n\x1b[38;2;1;2;3;49m▀▀\x1b[0m\n");
  EXPECT_EQ(HalfBlocks(image, false),
            "\x1b[38;5;196;48;5;21m▀▀\x1b[0m\n\x1b[38;5;16;49m▀▀\x1b[0m\n");
}

TEST(TerminalImage, DotsShowWhatDiffersFromTheBackground) {
  Image image{4, 4, std::vector<std::uint8_t>(48, 250)};
  for (std::size_t c = 0; c < 3; ++c) image.rgb[c] = 10;
  EXPECT_EQ(Dots(image), "⠁\n");
  EXPECT_EQ(Dots(Image{4, 4, std::vector<std::uint8_t>(48, 250)}), "\n");
}

}  // namespace
}  // namespace regrasp::cli
